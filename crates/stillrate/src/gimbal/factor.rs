//! Square root of a covariance: P = U U^T with U upper triangular, kept triangular through prediction and update.
//!
//! What it covers stays constant (see [`Carried`](super::carried::Carried)), so a prediction costs nothing; process noise on the first three
//! numbers touches only the leading 3x3 block, which plane rotations make triangular again. A scalar measurement is taken in by Carlson's
//! update (N. A. Carlson, "Fast triangular formulation of the square root filter", AIAA Journal 11(9), 1973): half the work of Potter's and
//! the same accuracy. In `f32` the square root carries what a covariance would need twice the digits for. Columns are walked in groups
//! of four rows, the zeros below the diagonal included: what the compiler turns into vector code, in the same order at any width.

use nalgebra::SMatrix;

use crate::real::Real;

/// Rows that are computed side by side.
const GROUP: usize = 4;

/// Upper-triangular square root of the covariance of up to `N` numbers, stored by columns.
///
/// # Example
/// ```
/// use stillrate::gimbal::Factor;
/// let mut factor = Factor::<f64, 4>::unit(4);
/// let mut row = [0.0; 4];
/// row[3] = 1.0;
/// factor.absorb(&row); // a measurement of number 3 with variance 1 halves its variance
/// assert!((factor.variance(3) - 0.5).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factor<T, const N: usize> {
    root: SMatrix<T, N, N>,
    count: usize,
}

/// What a scalar measurement of variance 1 did.
///
/// # Example
/// ```
/// let gain = stillrate::gimbal::Factor::<f64, 3>::unit(3).absorb(&[2.0, 0.0, 0.0]);
/// assert_eq!((gain.covariance, gain.variance), ([2.0, 0.0, 0.0], 5.0)); // P h^T and h P h^T + 1
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain<T, const N: usize> {
    /// Gain times the innovation variance: the covariance of the state with the measurement.
    pub covariance: [T; N],
    /// Innovation variance h P h^T + 1.
    pub variance: T,
}

/// Rotates columns `a`, `b` of three rows so that `b` takes all of row `row`.
#[inline(always)]
fn rotate<T: Real>(a: &mut [T; 3], b: &mut [T; 3], row: usize) {
    let (p, q) = (a[row], b[row]);
    let length = (p * p + q * q).root();
    if length > T::ZERO {
        let (cosine, sine) = (q / length, p / length);
        for r in 0..3 {
            let (u, v) = (a[r], b[r]);
            a[r] = cosine * u - sine * v;
            b[r] = sine * u + cosine * v;
        }
        a[row] = T::ZERO;
    }
}

impl<T: Real, const N: usize> Factor<T, N> {
    /// The identity for the first `count` numbers (no more than `N`, no fewer than 3 where `N` allows).
    #[must_use]
    pub fn unit(count: usize) -> Self {
        let count = if count > N { N } else { count };
        Self { root: SMatrix::from_fn(|i, j| T::select(i == j && j < count, T::ONE, T::ZERO)), count }
    }

    /// Entry of U.
    #[inline(always)]
    pub(super) fn entry(&self, i: usize, j: usize) -> T {
        self.root.data.0.get(j).and_then(|column| column.get(i)).copied().unwrap_or(T::ZERO)
    }

    /// Whether all entries are finite.
    pub(super) fn finite(&self) -> bool {
        self.root.data.0.iter().take(self.count).flatten().all(|x| x.finite())
    }

    /// Adds process noise of the given deviation to each of the first three numbers.
    #[inline]
    pub(super) fn spread(&mut self, noise: [T; 3]) {
        let columns = &mut self.root.data.0;
        let top = |c: &[T; N]| [c[0], c[1], c[2]];
        let (mut a, mut b, mut c) = (top(&columns[0]), top(&columns[1]), top(&columns[2]));
        for axis in 0..3 {
            if noise[axis] > T::ZERO {
                let mut extra = [T::ZERO; 3];
                extra[axis] = noise[axis];
                rotate(&mut extra, &mut c, 2);
                rotate(&mut extra, &mut b, 1);
                rotate(&mut extra, &mut a, 0);
            }
        }
        for (column, rotated) in columns.iter_mut().zip([a, b, c]) {
            column[..3].copy_from_slice(&rotated);
        }
    }

    /// Takes in a scalar measurement with unit variance.
    #[inline(always)]
    pub fn absorb(&mut self, row: &[T; N]) -> Gain<T, N> {
        let count = self.count;
        let sigma = self.project(row);
        // alpha_j = 1 + sigma_0^2 + ... + sigma_j^2; column j is scaled by sqrt(alpha_{j-1} / alpha_j).
        let mut alpha = T::ONE;
        let mut before = [T::ONE; N];
        let mut after = [T::ONE; N];
        for ((b, a), s) in before.iter_mut().zip(&mut after).zip(&sigma) {
            *b = alpha;
            alpha += *s * *s;
            *a = alpha;
        }
        let mut keep = [T::ZERO; N];
        let mut take = [T::ZERO; N];
        for j in 0..N {
            let inverse = T::ONE / (before[j] * after[j]).root();
            keep[j] = before[j] * inverse;
            take[j] = sigma[j] * inverse;
        }
        let mut covariance = [T::ZERO; N];
        let (sums, last_sums) = covariance.as_chunks_mut::<GROUP>();
        for (j, column) in self.root.data.0.iter_mut().enumerate().take(count) {
            let (s, e, z) = (sigma[j], keep[j], take[j]);
            let (rows, last_rows) = column.as_chunks_mut::<GROUP>();
            for (u, b) in rows.iter_mut().zip(sums.iter_mut()).take(j / GROUP + 1) {
                for l in 0..GROUP {
                    let old = u[l];
                    u[l] = e * old - z * b[l];
                    b[l] += s * old;
                }
            }
            for (u, b) in last_rows.iter_mut().zip(last_sums.iter_mut()) {
                let old = *u;
                *u = e * old - z * *b;
                *b += s * old;
            }
        }
        Gain { covariance, variance: alpha }
    }

    /// U^T h.
    #[inline(always)]
    fn project(&self, row: &[T; N]) -> [T; N] {
        let mut sigma = [T::ZERO; N];
        let (h, last_h) = row.as_chunks::<GROUP>();
        for (j, (sum, column)) in sigma.iter_mut().zip(&self.root.data.0).enumerate().take(self.count) {
            let (u, last_u) = column.as_chunks::<GROUP>();
            let mut sums = [T::ZERO; GROUP];
            for (h, u) in h.iter().zip(u).take(j / GROUP + 1) {
                for l in 0..GROUP {
                    sums[l] += h[l] * u[l];
                }
            }
            *sum = (sums[0] + sums[2]) + (sums[1] + sums[3]);
            for (h, u) in last_h.iter().zip(last_u) {
                *sum += *h * *u;
            }
        }
        sigma
    }

    /// |U^T h|^2 of three rows, their variances, in one walk over the columns.
    #[inline(always)]
    pub(super) fn variances_along(&self, rows: &[[T; N]; 3]) -> [T; 3] {
        let mut squares = [T::ZERO; 3];
        for (j, column) in self.root.data.0.iter().enumerate().take(self.count) {
            let (u, last_u) = column.as_chunks::<GROUP>();
            for (square, row) in squares.iter_mut().zip(rows) {
                let (h, last_h) = row.as_chunks::<GROUP>();
                let mut sums = [T::ZERO; GROUP];
                for (h, u) in h.iter().zip(u).take(j / GROUP + 1) {
                    for l in 0..GROUP {
                        sums[l] += h[l] * u[l];
                    }
                }
                let mut sum = (sums[0] + sums[2]) + (sums[1] + sums[3]);
                for (h, u) in last_h.iter().zip(last_u) {
                    sum += *h * *u;
                }
                *square += sum * sum;
            }
        }
        squares
    }

    /// U s.
    fn times(&self, s: &[f64; N]) -> [f64; N] {
        let mut sum = [0.0; N];
        for (column, s) in self.root.data.0.iter().zip(s).take(self.count) {
            for (t, u) in sum.iter_mut().zip(column) {
                *t += u.widen() * s;
            }
        }
        sum
    }

    /// P g, in double precision whatever `T` is.
    pub(super) fn weigh(&self, g: &[f64; N]) -> [f64; N] {
        let mut across = [0.0; N];
        for (sum, column) in across.iter_mut().zip(&self.root.data.0).take(self.count) {
            for (u, g) in column.iter().zip(g) {
                *sum += u.widen() * g;
            }
        }
        self.times(&across)
    }

    /// Variances of all numbers (sums of the squares of the rows).
    #[inline(always)]
    pub(super) fn variances(&self) -> [T; N] {
        let mut sums = [T::ZERO; N];
        for column in self.root.data.0.iter().take(self.count) {
            for (s, u) in sums.iter_mut().zip(column) {
                *s += *u * *u;
            }
        }
        sums
    }

    /// Variance of one number (sum of the squares of its row).
    #[must_use]
    pub fn variance(&self, i: usize) -> T {
        self.covariance(i, i)
    }

    /// Covariance of two numbers.
    fn covariance(&self, i: usize, k: usize) -> T {
        let mut sum = T::ZERO;
        if i < N && k < N {
            for column in self.root.data.0.iter().take(self.count) {
                sum += column[i] * column[k];
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SMatrix;

    fn covariance(f: &Factor<f64, 6>) -> SMatrix<f64, 6, 6> {
        SMatrix::from_fn(|i, k| f.covariance(i, k))
    }

    #[test]
    fn covers_no_more_numbers_than_there_is_room_for() {
        assert_eq!(Factor::<f64, 4>::unit(9).count, 4);
        assert_eq!(Factor::<f64, 4>::unit(3).variances(), [1.0, 1.0, 1.0, 0.0]);
    }

    #[test]
    fn noise_and_update_equal_the_literal_covariance_forms() {
        let mut f = Factor::<f64, 6>::unit(6);
        let mut p = covariance(&f);
        for n in 0..50 {
            let t = f64::from(n) * 0.1;
            let noise = [0.01, 0.02, 0.0];
            f.spread(noise);
            for r in 0..3 {
                p[(r, r)] += noise[r] * noise[r];
            }
            assert!((covariance(&f) - p).abs().max() < 1e-12 * p.abs().max());
            let row = [0.3, 1.0 + t, -0.5, t * t, 0.0, 2.0];
            let gain = f.absorb(&row);
            let h = SMatrix::<f64, 1, 6>::from(row.map(|x| [x]));
            let s = (h * p * h.transpose())[0] + 1.0;
            let ph = p * h.transpose();
            assert!((gain.variance - s).abs() < 1e-12 * s);
            for i in 0..6 {
                assert!((gain.covariance[i] - ph[i]).abs() < 1e-12 * ph.abs().max());
            }
            let before = p.abs().max();
            p -= ph * ph.transpose() / s;
            assert!((covariance(&f) - p).abs().max() < 1e-12 * before);
            let weighed = f.weigh(&row);
            for i in 0..6 {
                assert!((weighed[i] - (p * h.transpose())[i]).abs() < 1e-12 * before);
                assert!((f.variances()[i] - f.variance(i)).abs() < 1e-14 * before);
            }
        }
    }
}
