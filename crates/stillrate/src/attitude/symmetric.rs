//! Eigenvalues of a small symmetric matrix, by Jacobi's cyclic rotations: fixed size, no failure, no allocation.
//!
//! Jacobi (1846); Golub and Van Loan, Matrix Computations, section 8.5. Rows and columns that are zero off the
//! diagonal are never touched, so an unused parameter keeps its place among the eigenvalues.

use crate::real::Real;

/// Sweeps after which even a badly scaled 16 x 16 matrix has converged (usually six to eight).
const SWEEPS: usize = 30;

/// Eigenvalues (unsorted) and eigenvectors (in columns: `vectors[row][k]`) of a symmetric matrix.
pub(super) fn eigen<T: Real, const N: usize>(mut a: [[T; N]; N]) -> ([T; N], [[T; N]; N]) {
    let mut vectors = [[T::ZERO; N]; N];
    for i in 0..N {
        vectors[i][i] = T::ONE;
    }
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..N {
            for q in (p + 1)..N {
                rotated |= annihilate(&mut a, &mut vectors, p, q);
            }
        }
        if !rotated {
            break;
        }
    }
    (core::array::from_fn(|i| a[i][i]), vectors)
}

/// Rotates the plane (p, q) so that `a[p][q]` vanishes; false where it is already negligible.
fn annihilate<T: Real, const N: usize>(a: &mut [[T; N]; N], vectors: &mut [[T; N]; N], p: usize, q: usize) -> bool {
    let (app, aqq, apq) = (a[p][p], a[q][q], a[p][q]);
    // Relative to the two diagonal entries, not to the norm: small eigenvalues keep their digits.
    let negligible = T::EPSILON * (app.magnitude().root() * aqq.magnitude().root());
    if apq.magnitude() <= negligible || !apq.finite() {
        return false;
    }
    let theta = (aqq - app) / (T::TWO * apq);
    let sign = T::select(theta < T::ZERO, -T::ONE, T::ONE);
    let t = sign / (theta.magnitude() + (theta * theta + T::ONE).root());
    let cosine = T::ONE / (t * t + T::ONE).root();
    let sine = t * cosine;
    for k in 0..N {
        let (akp, akq) = (a[k][p], a[k][q]);
        a[k][p] = cosine * akp - sine * akq;
        a[k][q] = sine * akp + cosine * akq;
    }
    for k in 0..N {
        let (apk, aqk) = (a[p][k], a[q][k]);
        a[p][k] = cosine * apk - sine * aqk;
        a[q][k] = sine * apk + cosine * aqk;
    }
    for row in vectors {
        let (vp, vq) = (row[p], row[q]);
        row[p] = cosine * vp - sine * vq;
        row[q] = sine * vp + cosine * vq;
    }
    a[p][q] = T::ZERO;
    a[q][p] = T::ZERO;
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_sum_and_the_difference_of_two_equal_neighbours() {
        let (values, _) = eigen([[2.0, 1.0], [1.0, 2.0]]);
        assert!((values[0] - 1.0_f64).abs() < 1e-15 && (values[1] - 3.0).abs() < 1e-15);
    }

    #[test]
    fn rebuilds_a_badly_scaled_matrix() {
        // Scales from 1e-6 to 1e6 with correlations of a half: the small eigenvalue is still right to ten digits.
        let scale = [1e-6, 1e-3, 1.0, 1e6];
        let mut a = [[0.0_f64; 4]; 4];
        for i in 0..4 {
            for j in 0..4 {
                a[i][j] = scale[i] * scale[j] * if i == j { 1.0 } else { 0.5 };
            }
        }
        let (values, vectors) = eigen(a);
        for i in 0..4 {
            for j in 0..4 {
                let rebuilt: f64 = (0..4).map(|k| vectors[i][k] * values[k] * vectors[j][k]).sum();
                assert!((rebuilt - a[i][j]).abs() <= 1e-10 * (a[i][i] * a[j][j]).sqrt(), "{i} {j}");
            }
        }
        // det = prod scale^2 * det(correlation) = 1e-6 * 5/16
        let product: f64 = values.iter().product();
        assert!((product / (1e-6 * 0.3125) - 1.0).abs() < 1e-10);
    }
}
