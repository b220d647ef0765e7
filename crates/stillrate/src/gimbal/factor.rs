//! Square root of a covariance: P = U U^T with U upper triangular, kept triangular through prediction and update.
//!
//! The attitude comes first, so a prediction touches only its three rows (U_psi <- Phi U_psi + Gamma U_theta) and process noise
//! on the attitude only the leading 3x3 block, which plane rotations make triangular again. A scalar measurement is taken in by Carlson's
//! update (N. A. Carlson, "Fast triangular formulation of the square root filter", AIAA Journal 11(9), 1973): half the work of Potter's and
//! the same accuracy. In `f32` the square root carries what a covariance would need twice the digits for.

use nalgebra::SMatrix;

use crate::real::Real;

/// Upper-triangular square root of the covariance of up to `N` numbers, stored by columns.
///
/// # Example
/// ```
/// use stillrate::gimbal::Factor;
/// let mut factor = Factor::<f64, 4>::unit(4);
/// let mut row = [0.0; 4];
/// row[3] = 1.0;
/// factor.absorb(&row, &[3]); // a measurement of number 3 with variance 1 halves its variance
/// assert!((factor.variance(3) - 0.5).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factor<T, const N: usize> {
    root: SMatrix<T, N, N>,
    count: usize,
}

/// What a scalar measurement of variance 1 did.
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

    /// A diagonal square root.
    #[must_use]
    pub fn diagonal(deviation: &[T; N], count: usize) -> Self {
        let mut factor = Self::unit(count);
        for (j, column) in factor.root.data.0.iter_mut().enumerate().take(factor.count) {
            column[j] = deviation[j];
        }
        factor
    }

    /// How many numbers it covers.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// Entry of U.
    #[must_use]
    #[inline(always)]
    pub fn entry(&self, i: usize, j: usize) -> T {
        self.root.data.0.get(j).and_then(|column| column.get(i)).copied().unwrap_or(T::ZERO)
    }

    /// Whether all entries are finite.
    #[must_use]
    pub fn finite(&self) -> bool {
        self.root.data.0.iter().take(self.count).flatten().all(|x| x.finite())
    }

    /// Prediction: attitude rows 0..3 <- `transition` (columns) times them + `turning` (one column a number, 3..`turns`) times the rest.
    #[inline]
    pub fn carry(&mut self, transition: &[[T; 3]; 3], turning: &[[T; 4]; N], turns: usize) {
        let columns = &mut self.root.data.0;
        for (j, column) in columns.iter_mut().enumerate().take(self.count) {
            let (a, b, c) = (column[0], column[1], column[2]);
            let mut top = [T::ZERO; 4];
            for r in 0..3 {
                top[r] = transition[0][r] * a + transition[1][r] * b + transition[2][r] * c;
            }
            let end = if j < turns { j + 1 } else { turns };
            // Exact slices, not adapters: these loops are what the compiler turns into vector code.
            if let (Some(gammas), Some(values)) = (turning.get(3..end), column.get(3..end)) {
                for (gamma, &value) in gammas.iter().zip(values) {
                    for r in 0..4 {
                        top[r] += gamma[r] * value;
                    }
                }
            }
            column[0] = top[0];
            column[1] = top[1];
            column[2] = top[2];
        }
    }

    /// Makes the leading block triangular again after [`Factor::carry`], with process noise of the given deviation on each axis.
    #[inline]
    pub fn settle(&mut self, noise: [T; 3]) {
        let columns = &mut self.root.data.0;
        let top = |c: &[T; N]| [c[0], c[1], c[2]];
        let (mut a, mut b, mut c) = (top(&columns[0]), top(&columns[1]), top(&columns[2]));
        rotate(&mut a, &mut c, 2);
        rotate(&mut b, &mut c, 2);
        rotate(&mut a, &mut b, 1);
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

    /// Takes in a scalar measurement with unit variance; only the entries of `row` named by `support` may be other than 0.
    #[inline]
    pub fn absorb(&mut self, row: &[T; N], support: &[usize]) -> Gain<T, N> {
        let count = self.count;
        let columns = &mut self.root.data.0;
        let mut sigma = [T::ZERO; N];
        for &i in support {
            if i < N {
                let h = row[i];
                // Row i of the triangle begins at column i.
                if let (Some(sums), Some(right)) = (sigma.get_mut(i..count), columns.get(i..count)) {
                    for (s, column) in sums.iter_mut().zip(right) {
                        *s += h * column[i];
                    }
                }
            }
        }
        // alpha_j = 1 + sigma_0^2 + ... + sigma_j^2; column j is scaled by sqrt(alpha_{j-1} / alpha_j).
        let mut alpha = T::ONE;
        let mut before = [T::ONE; N];
        let mut after = [T::ONE; N];
        for j in 0..count {
            before[j] = alpha;
            alpha += sigma[j] * sigma[j];
            after[j] = alpha;
        }
        let mut keep = [T::ZERO; N];
        let mut take = [T::ZERO; N];
        for j in 0..N {
            let inverse = T::ONE / (before[j] * after[j]).root();
            keep[j] = before[j] * inverse;
            take[j] = sigma[j] * inverse;
        }
        let mut covariance = [T::ZERO; N];
        for j in 0..count {
            let (s, e, z) = (sigma[j], keep[j], take[j]);
            if let (Some(column), Some(sums)) = (columns[j].get_mut(..=j), covariance.get_mut(..=j)) {
                for (u, b) in column.iter_mut().zip(sums) {
                    let old = *u;
                    *u = e * old - z * *b;
                    *b += s * old;
                }
            }
        }
        Gain { covariance, variance: alpha }
    }

    /// Variance of one number (sum of the squares of its row).
    #[must_use]
    pub fn variance(&self, i: usize) -> T {
        self.covariance(i, i)
    }

    /// Covariance of two numbers.
    #[must_use]
    pub fn covariance(&self, i: usize, k: usize) -> T {
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
    fn prediction_and_update_equal_the_literal_covariance_forms() {
        let mut f = Factor::<f64, 6>::unit(6);
        let mut p = covariance(&f);
        for n in 0..50 {
            let t = f64::from(n) * 0.1;
            let transition = [[0.9, 0.1 + t * 0.01, 0.0], [-0.1, 0.9, 0.2], [0.05, -0.2, 0.95]];
            let mut turning = [[0.0; 4]; 6];
            turning[3] = [0.3, -t, 0.1, 0.0];
            turning[4] = [0.2, 0.5, t, 0.0];
            let noise = [0.01, 0.02, 0.0];
            f.carry(&transition, &turning, 5);
            f.settle(noise);
            let mut big = SMatrix::<f64, 6, 6>::identity();
            for r in 0..3 {
                for c in 0..3 {
                    big[(r, c)] = transition[c][r];
                    big[(r, 3 + c)] = turning[3 + c][r];
                }
            }
            p = big * p * big.transpose();
            for r in 0..3 {
                p[(r, r)] += noise[r] * noise[r];
            }
            assert!((covariance(&f) - p).abs().max() < 1e-12 * p.abs().max());
            let row = [0.0, 1.0 + t, -0.5, 0.0, 0.0, 2.0];
            let gain = f.absorb(&row, &[1, 2, 5]);
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
        }
    }
}
