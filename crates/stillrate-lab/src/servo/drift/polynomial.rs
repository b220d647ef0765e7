//! Polynomials in s and their ratios, coefficients in descending powers.

use super::DriftError;

/// Product of two polynomials.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::multiply;
/// assert_eq!(multiply(&[1.0, 2.0], &[1.0, -2.0]), [1.0, 0.0, -4.0]);
/// ```
#[must_use]
pub fn multiply(p: &[f64], q: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; (p.len() + q.len()).saturating_sub(1)];
    for (i, a) in p.iter().enumerate() {
        for (j, b) in q.iter().enumerate() {
            product[i + j] += a * b;
        }
    }
    product
}

/// Sum of two polynomials.
pub(crate) fn add(p: &[f64], q: &[f64]) -> Vec<f64> {
    let n = p.len().max(q.len());
    let at = |r: &[f64], i: usize| if i + r.len() >= n { r[i + r.len() - n] } else { 0.0 };
    (0..n).map(|i| at(p, i) + at(q, i)).collect()
}

/// A rational transfer function `numerator / denominator`.
///
/// # Example
/// ```
/// use stillrate_lab::servo::drift::TransferFunction;
/// let g = TransferFunction::new(&[20.0], &[1.0, 20.0]).unwrap();
/// assert_eq!(g.power_gain(0.0), 1.0);
/// assert!((g.power_gain(20.0) - 0.5).abs() < 1e-15); // omega in rad/s: half the power at the corner
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TransferFunction {
    /// Numerator, descending powers, no leading zeros.
    pub numerator: Vec<f64>,
    /// Denominator, descending powers, first coefficient positive.
    pub denominator: Vec<f64>,
}

impl TransferFunction {
    /// A ratio of polynomials (descending powers); leading zeros are dropped.
    ///
    /// # Errors
    /// [`DriftError::BadPolynomial`] for an empty or zero denominator or a non-finite coefficient.
    pub fn new(numerator: &[f64], denominator: &[f64]) -> Result<Self, DriftError> {
        if !numerator.iter().chain(denominator).all(|c| c.is_finite()) {
            return Err(DriftError::BadPolynomial("a coefficient of the transfer function is not finite"));
        }
        let stripped = |p: &[f64]| p.iter().copied().skip_while(|c| *c == 0.0).collect::<Vec<_>>();
        let (mut numerator, mut denominator) = (stripped(numerator), stripped(denominator));
        let Some(first) = denominator.first().copied() else {
            return Err(DriftError::BadPolynomial("the denominator of the transfer function is zero"));
        };
        if first < 0.0 {
            numerator.iter_mut().chain(denominator.iter_mut()).for_each(|c| *c = -*c);
        }
        Ok(Self { numerator, denominator })
    }

    /// Degree of the denominator.
    pub(crate) fn order(&self) -> usize {
        self.denominator.len() - 1
    }

    /// Whether the numerator's degree is below the denominator's.
    fn strictly_proper(&self) -> bool {
        self.numerator.len() < self.denominator.len()
    }

    /// This times another.
    pub(crate) fn times(&self, other: &Self) -> Self {
        Self {
            numerator: multiply(&self.numerator, &other.numerator),
            denominator: multiply(&self.denominator, &other.denominator),
        }
    }

    /// The same ratio without common factors of s (a zero at 0 that meets a pole at 0).
    pub(crate) fn without_common_zeros_at_origin(&self) -> Self {
        let mut reduced = self.clone();
        while reduced.denominator.len() > 1
            && reduced.denominator.last() == Some(&0.0)
            && reduced.numerator.last().is_none_or(|c| *c == 0.0)
        {
            reduced.denominator.pop();
            reduced.numerator.pop();
        }
        reduced
    }

    /// Refuses a numerator that is not of lower degree.
    pub(crate) fn check_proper(&self) -> Result<(), DriftError> {
        if self.strictly_proper() {
            return Ok(());
        }
        Err(DriftError::InfiniteVariance {
            numerator_degree: self.numerator.len() - 1,
            denominator_degree: self.order(),
        })
    }

    /// `H(j omega)` as (real, imaginary).
    pub(crate) fn response(&self, omega: f64) -> (f64, f64) {
        divide(at(&self.numerator, omega), at(&self.denominator, omega))
    }

    /// `|H(j omega)|^2`.
    #[must_use]
    pub fn power_gain(&self, omega: f64) -> f64 {
        let (n, d) = (at(&self.numerator, omega), at(&self.denominator, omega));
        (n.0 * n.0 + n.1 * n.1) / (d.0 * d.0 + d.1 * d.1)
    }
}

/// Horner's rule at `j omega`.
pub(crate) fn at(p: &[f64], omega: f64) -> (f64, f64) {
    p.iter().fold((0.0, 0.0), |(re, im), c| (c - im * omega, re * omega))
}

/// Quotient of two complex numbers.
pub(crate) fn divide(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    let size = b.0 * b.0 + b.1 * b.1;
    ((a.0 * b.0 + a.1 * b.1) / size, (a.1 * b.0 - a.0 * b.1) / size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_joins_the_lowest_powers() {
        assert_eq!(add(&[1.0, 0.0, 0.0], &[2.0]), [1.0, 0.0, 2.0]);
    }
}
