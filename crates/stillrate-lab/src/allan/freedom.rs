//! How uncertain an Allan variance is: the covariance of the estimates at two cluster lengths for a mixture of white
//! noise, flicker and random walk of the rate.
//!
//! An overlapping Allan variance is a mean of squares of second differences z_k of the running sum, Gaussian and
//! correlated: cov(v_i, v_j) = 2 sum_kl r_ij(l - k)^2 / (4 m_i^2 m_j^2 n_i n_j), with r_ij their covariance. That
//! follows from the generalised covariance s(t) of the running sum (Greenhall and Riley, "Uncertainty of stability
//! variances based on finite differences", PTTI 2003): -|t|/2 for white noise of variance 1 a sample, t^2 ln|t| / (2 pi)
//! for flicker of floor 1, |t|^3 / 12 for a walk of variance 1 a step. The equivalent degrees of freedom are
//! 2 v^2 / var(v). Sums over long stretches between the kinks of r are integrals by Gauss-Legendre quadrature.

use core::f64::consts::PI;

use stillrate::Real;

use super::deviation::Point;

/// Squared strengths per sample: white variance, squared flicker floor, walk variance a step.
pub(crate) type Mixture = [f64; 3];

/// Allan variance at `m` samples of each component with unit strength: 1/m, 2 ln 2 / pi, m/3.
pub(crate) fn unit_variances(m: usize) -> Mixture {
    let m = m as f64;
    [1.0 / m, 2.0 * core::f64::consts::LN_2 / PI, m / 3.0]
}

/// Generalised covariance of the running sum at distance t samples, of each component with unit strength.
fn generalised(t: f64) -> Mixture {
    let t = t.magnitude();
    let flicker = if t > 0.0 { t * t * t.logarithm() / (2.0 * PI) } else { 0.0 };
    [-0.5 * t, flicker, t * t * t / 12.0]
}

/// Coefficients of a second difference.
const SECOND: [f64; 3] = [1.0, -2.0, 1.0];

/// Covariance of the second difference of length `a` at k and that of length `b` at k + `d`, of each component.
fn difference_covariance(a: f64, b: f64, d: f64) -> Mixture {
    let mut sum = [0.0; 3];
    for (i, ci) in SECOND.iter().enumerate() {
        for (j, cj) in SECOND.iter().enumerate() {
            let s = generalised(d + j as f64 * b - i as f64 * a);
            for component in 0..3 {
                sum[component] += ci * cj * s[component];
            }
        }
    }
    sum
}

/// A quadratic form in the strengths of the components, by its coefficients: the covariance of two Allan variances.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Quadratic([[f64; 3]; 3]);

impl Quadratic {
    /// The covariance under a mixture.
    pub(crate) fn at(&self, mixture: &Mixture) -> f64 {
        let row = |i: usize| (0..3).map(|j| self.0[i][j] * mixture[j]).sum::<f64>();
        (0..3).map(|i| mixture[i] * row(i)).sum()
    }

    /// Constant, linear and square coefficient in the strength of component `i`, the others as in `mixture`.
    pub(crate) fn in_component(&self, i: usize, mixture: &Mixture) -> [f64; 3] {
        let mut others = *mixture;
        others[i] = 0.0;
        let linear = (0..3).map(|j| (self.0[i][j] + self.0[j][i]) * others[j]).sum();
        [self.at(&others), linear, self.0[i][i]]
    }

    /// Adds `scale` times another form.
    pub(crate) fn add(&mut self, scale: f64, other: &Self) {
        for (row, from) in self.0.iter_mut().zip(&other.0) {
            for (x, y) in row.iter_mut().zip(from) {
                *x += scale * y;
            }
        }
    }
}

/// Nodes and weights of 4-point Gauss-Legendre quadrature on -1..1.
const NODES: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_86),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_86),
];
/// Stretches up to this many terms are summed one by one.
const SHORT: i64 = 12;

/// Adds the sum of f over the whole numbers from..to: Euler and Maclaurin's first correction to the integral.
fn add_between(sum: &mut Quadratic, from: i64, to: i64, f: &impl Fn(f64) -> Quadratic) {
    if to - from <= SHORT {
        (from..to).for_each(|d| sum.add(1.0, &f(d as f64)));
        return;
    }
    let (a, b) = (from as f64, to as f64);
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    for (x, w) in &NODES {
        sum.add(w * half, &f(middle + half * x));
    }
    sum.add(0.5, &f(a));
    sum.add(-0.5, &f(b));
}

/// Covariance of the Allan variances at two points, for any mixture.
pub(crate) fn covariance(first: &Point, second: &Point) -> Quadratic {
    let (a, b) = (first.cluster as i64, second.cluster as i64);
    let (na, nb) = (first.terms as i64, second.terms as i64);
    let mut breaks = vec![0, nb - na, 1 - na, nb];
    for i in 0..3 {
        for j in 0..3 {
            breaks.push(i * a - j * b);
        }
    }
    // Beyond the kinks only flicker is left, which fades smoothly: stretches that double.
    let (mut step, low, high) = (a.max(b), -2 * b, 2 * a);
    while step < na.max(nb) {
        breaks.extend([low - step, high + step]);
        step *= 2;
    }
    breaks.retain(|d| (1 - na..=nb).contains(d));
    breaks.sort_unstable();
    breaks.dedup();
    let (ma, mb) = (a as f64, b as f64);
    let scale = 2.0 / (4.0 * ma * ma * mb * mb * na as f64 * nb as f64);
    let term = |d: f64| {
        let pairs = ((nb as f64).min(na as f64 + d) - d.max(0.0)).max(0.0) * scale;
        let r = difference_covariance(ma, mb, d);
        Quadratic(core::array::from_fn(|i| core::array::from_fn(|j| pairs * r[i] * r[j])))
    };
    let mut sum = Quadratic::default();
    breaks.windows(2).for_each(|w| add_between(&mut sum, w[0], w[1], &term));
    sum
}

/// Equivalent degrees of freedom of a point whose variance has the given covariance with itself; at least 1.
pub(crate) fn freedom(mixture: &Mixture, point: &Point, own: &Quadratic) -> f64 {
    let variance = expected(mixture, point.cluster);
    let spread = own.at(mixture);
    if spread > 0.0 { (2.0 * variance * variance / spread).max(1.0) } else { 1.0 }
}

/// Allan variance that a mixture leads one to expect.
pub(crate) fn expected(mixture: &Mixture, cluster: usize) -> f64 {
    unit_variances(cluster).iter().zip(mixture).map(|(u, s)| u * s).sum()
}

#[cfg(test)]
mod tests {
    use super::{covariance, freedom};
    use crate::allan::deviation::{Phase, Point};
    use crate::random::Random;

    fn point(cluster: usize, samples: usize) -> Point {
        Point { cluster, variance: 1.0, terms: samples + 1 - 2 * cluster, thinning: 1.0 }
    }

    #[test]
    fn degrees_of_freedom_follow_the_tables_of_nist_sp_1065() {
        // Table 5 there (approximations, good to some 5 %), N = 1025 phase points.
        let n = 1025.0_f64;
        for m in [1_usize, 4, 32, 128] {
            let x = m as f64;
            let white = (3.0 * (n - 1.0) / (2.0 * x) - 2.0 * (n - 2.0) / n) * 4.0 * x * x / (4.0 * x * x + 5.0);
            let walk =
                (n - 2.0) / x * ((n - 1.0) * (n - 1.0) - 3.0 * x * (n - 1.0) + 4.0 * x * x) / ((n - 3.0) * (n - 3.0));
            let p = point(m, 1024);
            assert!((freedom(&[1.0, 0.0, 0.0], &p, &covariance(&p, &p)) / white - 1.0).abs() < 0.06, "white {m}");
            assert!(
                (freedom(&[0.0, 0.0, 1.0], &p, &covariance(&p, &p)) / walk - 1.0).abs()
                    < if m == 1 { 0.3 } else { 0.08 },
                "walk {m}"
            );
        }
    }

    #[test]
    fn long_stretches_sum_as_term_by_term() {
        let mixture = [1.0, 0.01, 1e-4];
        for (a, b) in [(64, 64), (8, 256), (128, 512)] {
            let (pa, pb) = (point(a, 4096), point(b, 4096));
            let (na, nb) = (pa.terms as i64, pb.terms as i64);
            let mut sum = 0.0;
            for d in 1 - na..nb {
                let pairs = nb.min(na + d) - d.max(0);
                let r: f64 = super::difference_covariance(a as f64, b as f64, d as f64)
                    .iter()
                    .zip(&mixture)
                    .map(|(r, s)| r * s)
                    .sum();
                sum += pairs as f64 * r * r;
            }
            let literal = 2.0 * sum / (4.0 * (a * a * b * b) as f64 * (na * nb) as f64);
            assert!((covariance(&pa, &pb).at(&mixture) / literal - 1.0).abs() < 0.02, "{a} {b}");
        }
    }

    #[test]
    fn estimates_scatter_and_correlate_as_predicted() {
        let (runs, n) = (3000, 256);
        let (mut s, mut ss) = ([0.0; 2], [0.0; 3]);
        let mut points = [point(4, n); 2];
        for seed in 0..runs {
            let phase = Phase::new(&Random::new(seed, 0).normals(n));
            points = [phase.point(4).unwrap(), phase.point(16).unwrap()];
            let v = [points[0].variance, points[1].variance];
            s = [s[0] + v[0], s[1] + v[1]];
            ss = [ss[0] + v[0] * v[0], ss[1] + v[1] * v[1], ss[2] + v[0] * v[1]];
        }
        let r = runs as f64;
        let moment = |ab: f64, a: f64, b: f64| ab / r - a / r * b / r;
        let white = [1.0, 0.0, 0.0];
        let predicted = |i: usize, j: usize| covariance(&points[i], &points[j]).at(&white);
        for (i, j, measured) in
            [(0, 0, moment(ss[0], s[0], s[0])), (1, 1, moment(ss[1], s[1], s[1])), (0, 1, moment(ss[2], s[0], s[1]))]
        {
            // Four standard errors of a sample covariance; 1.5 for tails heavier than normal.
            let error = ((predicted(i, i) * predicted(j, j) + predicted(i, j) * predicted(i, j)) / r).sqrt();
            assert!((measured - predicted(i, j)).abs() < 6.0 * error, "{measured} {}", predicted(i, j));
        }
    }
}
