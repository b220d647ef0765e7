//! The overlapping Allan variance of a record, with or without gaps, in one pass a cluster length.
//!
//! With the running sum x of the samples, the variance at m samples is the mean of (x[k+2m] - 2 x[k+m] + x[k])^2 over
//! 2 m^2 (IEEE Std 952-2020, annex C; NIST SP 1065, eq. 11). The mean is taken off first, so that the running sum stays
//! small however long the record. With gaps, means are taken over the samples present in each cluster, which must be at
//! least half of it; white noise then appears larger by the mean of (m/c1 + m/c2)/2, which is returned for the fit.

/// One point of the curve, in samples and squared units of the record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    /// Cluster length m, samples.
    pub(crate) cluster: usize,
    /// Half the mean squared difference of neighbouring cluster means.
    pub(crate) variance: f64,
    /// How many differences were averaged.
    pub(crate) terms: usize,
    /// How much larger missing samples make white noise appear (1 without gaps).
    pub(crate) thinning: f64,
}

/// Running sums of a record, ready for any cluster length.
pub(crate) struct Phase {
    sum: Vec<f64>,
    /// Running count of present samples; empty when none is missing.
    present: Vec<u32>,
    finite: usize,
}

impl Phase {
    pub(crate) fn new(z: &[f64]) -> Self {
        let finite = z.iter().filter(|x| x.is_finite()).count();
        let offset = mean(z, finite);
        let mut sum = Vec::with_capacity(z.len() + 1);
        let mut total = 0.0;
        sum.push(total);
        sum.extend(z.iter().map(|x| {
            total += if x.is_finite() { x - offset } else { 0.0 };
            total
        }));
        let mut present = Vec::new();
        if finite < z.len() {
            let mut count = 0;
            present.push(count);
            present.extend(z.iter().map(|x| {
                count += u32::from(x.is_finite());
                count
            }));
        }
        Self { sum, present, finite }
    }

    pub(crate) fn finite(&self) -> usize {
        self.finite
    }

    /// Longest cluster of which two fit into the record.
    pub(crate) fn longest(&self) -> usize {
        (self.sum.len() - 1) / 2
    }

    /// The variance at cluster length `m`, or `None` if no pair of clusters is full enough.
    pub(crate) fn point(&self, m: usize) -> Option<Point> {
        let terms = self.sum.len().checked_sub(m.saturating_mul(2)).filter(|n| *n > 0 && m > 0)?;
        if !self.present.is_empty() {
            return self.point_with_gaps(m, terms);
        }
        let squares = squared_second_differences(&self.sum[..terms], &self.sum[m..m + terms], &self.sum[2 * m..]);
        let length = m as f64;
        let variance = squares / (2.0 * length * length * terms as f64);
        Some(Point { cluster: m, variance, terms, thinning: 1.0 })
    }

    fn point_with_gaps(&self, m: usize, candidates: usize) -> Option<Point> {
        let (mut squares, mut thinning, mut terms) = (0.0, 0.0, 0_usize);
        for k in 0..candidates {
            let first = self.present[k + m] - self.present[k];
            let second = self.present[k + 2 * m] - self.present[k + m];
            if 2 * first as usize >= m && 2 * second as usize >= m {
                let (a, b) = (1.0 / f64::from(first), 1.0 / f64::from(second));
                let d = (self.sum[k + 2 * m] - self.sum[k + m]) * b - (self.sum[k + m] - self.sum[k]) * a;
                squares += d * d;
                thinning += a + b;
                terms += 1;
            }
        }
        let count = terms as f64;
        (terms > 0).then(|| Point {
            cluster: m,
            variance: squares / (2.0 * count),
            terms,
            thinning: thinning * m as f64 / (2.0 * count),
        })
    }
}

/// Mean of the finite samples about the first of them, so that a large offset costs no digits.
fn mean(z: &[f64], finite: usize) -> f64 {
    let first = z.iter().copied().find(|x| x.is_finite()).unwrap_or(0.0);
    let sum: f64 = z.iter().filter(|x| x.is_finite()).map(|x| x - first).sum();
    if finite > 0 { first + sum / finite as f64 } else { 0.0 }
}

/// Partial sums kept side by side: the loop vectorises and the order of additions is the same at any width.
const LANES: usize = 8;

fn squared_second_differences(a: &[f64], b: &[f64], c: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    let (mut a8, mut b8, mut c8) = (a.chunks_exact(LANES), b.chunks_exact(LANES), c.chunks_exact(LANES));
    for ((a, b), c) in (&mut a8).zip(&mut b8).zip(&mut c8) {
        for lane in 0..LANES {
            let d = (c[lane] - b[lane]) - (b[lane] - a[lane]);
            lanes[lane] += d * d;
        }
    }
    let rest = a8.remainder().iter().zip(b8.remainder()).zip(c8.remainder());
    let tail: f64 = rest.map(|((a, b), c)| ((c - b) - (b - a)) * ((c - b) - (b - a))).sum();
    lanes.iter().sum::<f64>() + tail
}

#[cfg(test)]
mod tests {
    use super::Phase;
    use crate::random::Random;

    /// The definition, cluster mean by cluster mean.
    fn literal(z: &[f64], m: usize) -> f64 {
        let mean = |k: usize| z[k..k + m].iter().sum::<f64>() / m as f64;
        let terms = z.len() + 1 - 2 * m;
        (0..terms).map(|k| (mean(k + m) - mean(k)).powi(2)).sum::<f64>() / (2.0 * terms as f64)
    }

    #[test]
    fn equals_its_definition_for_every_cluster_length() {
        let z: Vec<f64> = Random::new(1, 0).normals(203).iter().map(|x| x + 1e3).collect();
        let phase = Phase::new(&z);
        for m in 1..=phase.longest() {
            let point = phase.point(m).unwrap();
            assert!((point.variance / literal(&z, m) - 1.0).abs() < 1e-9, "{m}");
        }
        assert!(phase.point(102).is_none());
    }

    #[test]
    fn a_large_offset_and_a_long_record_cost_no_digits() {
        let z: Vec<f64> = (0..2_000_000).map(|k| 1e6 + if k % 2 == 0 { 1e-3 } else { -1e-3 }).collect();
        // 1e6 is stored to 1e-10, a part in 1e7 of the alternation.
        let variance = Phase::new(&z).point(1).unwrap().variance;
        assert!((variance / 2e-6 - 1.0).abs() < 1e-6, "{variance}");
    }

    #[test]
    fn gaps_bias_white_noise_by_the_stated_factor_only() {
        let full = Random::new(4, 0).normals(400_000);
        let mut pick = Random::new(4, 1).normals(400_000);
        let z: Vec<f64> = full.iter().zip(&mut pick).map(|(x, p)| if *p > 1.0 { f64::NAN } else { *x }).collect();
        let phase = Phase::new(&z);
        for m in [4, 64] {
            let point = phase.point(m).unwrap();
            let ratio = point.variance / point.thinning * m as f64;
            // Some 4e5/m independent terms.
            assert!((ratio - 1.0).abs() < 5.0 * (m as f64 * 2.0 / 4e5).sqrt(), "{m} {ratio}");
        }
    }

    #[test]
    fn a_long_gap_leaves_the_rest_usable() {
        let mut z = Random::new(6, 0).normals(10_000);
        z[4000..5000].fill(f64::INFINITY);
        let phase = Phase::new(&z);
        assert_eq!(phase.finite(), 9000);
        let point = phase.point(16).unwrap();
        assert!((point.variance * 16.0 / point.thinning - 1.0).abs() < 0.2);
        assert!(point.terms < 10_000 - 1000);
    }
}
