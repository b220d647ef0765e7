//! First loop of the two-loop filter: accelerometer coefficients from the length of the specific force alone.
//!
//! At rest |f| = g in any attitude. With u_i = (z_i - ka0_i) / (1 + ka1_i) and f_e = A_a^-1 u the scalar residual g - |f_e| depends on
//! the nine coefficients ka0, ka1, thp_y, thp_z, tho_z only: no attitude, no gyro. H = f_hat^T df_e with b_i = A_a^-1 e_i:
//! df_e/dka0_i = -b_i / (1 + ka1_i), df_e/dka1_i = -b_i u_i / (1 + ka1_i), df_e/dth = -b_i (da_i/dth . f_e). Source: our
//! reconstruction of DOI 10.3873/j.issn.1000-1328.2017.06.009 (the published loops, fed with each other's point
//! estimates, never converge).

use nalgebra::{Matrix3, Vector3};

use super::coefficients::{COUNT, Coefficients, FORCE_ABOUT_OUTPUT, FORCE_ABOUT_PENDULOUS, FORCE_BIAS, FORCE_SCALE};
use super::factor::Factor;
use super::geometry::ForceAxis;
use super::joint::SECOND_ORDER;
use super::model::Model;
use super::record::Measurement;
use super::rotation::{apply, inverse_of_rows};
use crate::error::ConfigError;
use crate::real::Real;

/// How many coefficients this loop has.
pub const NORM_COUNT: usize = 9;
const ANGLES: [usize; 3] = [FORCE_ABOUT_PENDULOUS + 1, FORCE_ABOUT_PENDULOUS + 2, FORCE_ABOUT_OUTPUT + 2];

/// Place of each number of this loop in [`Coefficients`].
pub const NORM_INDICES: [usize; NORM_COUNT] = [
    FORCE_BIAS,
    FORCE_BIAS + 1,
    FORCE_BIAS + 2,
    FORCE_SCALE,
    FORCE_SCALE + 1,
    FORCE_SCALE + 2,
    ANGLES[0],
    ANGLES[1],
    ANGLES[2],
];

/// Settings of the norm loop (accelerometer gauge, cyclic triads).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NormLoop<T> {
    model: Model,
    scale: [f64; NORM_COUNT],
    number: core::marker::PhantomData<T>,
}

/// State of the norm loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NormState<T> {
    /// All coefficients; this loop changes its nine.
    pub(super) coefficients: Coefficients,
    /// Scaled square root of the covariance.
    pub(super) factor: Factor<T, NORM_COUNT>,
}

/// Specific force found from the outputs, and its derivatives by the nine coefficients (scaled).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FoundForce {
    /// f_e, m/s^2.
    pub(super) force: Vector3<f64>,
    /// df_e/d(coefficient / scale).
    pub(super) derivative: [Vector3<f64>; NORM_COUNT],
}

impl<T: Real> NormState<T> {
    /// State at the prior.
    pub(super) fn at(prior: &Coefficients) -> Self {
        Self { coefficients: *prior, factor: Factor::unit(NORM_COUNT) }
    }

    /// D P D^T: how uncertain a found force is because of the nine coefficients, (m/s^2)^2.
    pub(super) fn force_covariance(&self, derivative: &[Vector3<f64>; NORM_COUNT]) -> Matrix3<f64> {
        let mut covariance = Matrix3::zeros();
        for j in 0..NORM_COUNT {
            let mut column = Vector3::zeros();
            for (i, d) in derivative.iter().enumerate() {
                column += d * self.factor.entry(i, j).widen();
            }
            covariance += column * column.transpose();
        }
        covariance
    }
}

impl<T: Real> NormLoop<T> {
    /// Loop with the given prior standard deviations.
    ///
    /// # Errors
    /// [`ConfigError`] if a scale is not positive.
    pub(super) fn new(model: Model, scale: &Coefficients) -> Result<Self, ConfigError> {
        let mut picked = [0.0; NORM_COUNT];
        for (slot, index) in picked.iter_mut().zip(NORM_INDICES) {
            *slot = crate::error::positive(super::coefficients::NAMES[index], scale[index], "")?;
        }
        Ok(Self { model, scale: picked, number: core::marker::PhantomData })
    }

    /// f_e = A_a^-1 u and its derivatives.
    pub(super) fn found(&self, coefficients: &Coefficients, value: &[f64; 3]) -> FoundForce {
        let x = coefficients;
        let axes: [ForceAxis; 3] = core::array::from_fn(|i| {
            ForceAxis::new(&self.model.triads.accelerometer[i], x[FORCE_ABOUT_PENDULOUS + i], x[FORCE_ABOUT_OUTPUT + i])
        });
        let inverse = inverse_of_rows(axes.each_ref().map(|axis| &axis.input));
        let slope: [f64; 3] = core::array::from_fn(|i| 1.0 + x[FORCE_SCALE + i]);
        let u = Vector3::from_fn(|i, _| (value[i] - x[FORCE_BIAS + i]) / slope[i]);
        let force = apply(&inverse, &u);
        let column = |i: usize| -> Vector3<f64> { inverse.column(i).into() };
        let mut derivative = [Vector3::zeros(); NORM_COUNT];
        for i in 0..3 {
            derivative[i] = column(i) * (-self.scale[i] / slope[i]);
            derivative[3 + i] = column(i) * (-self.scale[3 + i] * u[i] / slope[i]);
        }
        derivative[6] = column(1) * (-self.scale[6] * axes[1].by_pendulous_angle.dot(&force));
        derivative[7] = column(2) * (-self.scale[7] * axes[2].by_pendulous_angle.dot(&force));
        derivative[8] = column(2) * (-self.scale[8] * axes[2].by_output_angle.dot(&force));
        FoundForce { force, derivative }
    }

    /// Takes in one measurement of the outputs; nothing happens unless all three axes are there. Returns what it found before the update.
    pub(super) fn step(&self, state: &mut NormState<T>, measurement: &Measurement) -> Option<FoundForce> {
        let usable = measurement.value.iter().zip(&measurement.variance).all(|(z, r)| z.finite() && r.finite());
        if !usable {
            return None;
        }
        let before = self.found(&state.coefficients, &measurement.value);
        let length = before.force.dot(&before.force).root();
        if !(length.finite() && length > 0.0) {
            return None;
        }
        let direction = before.force / length;
        // The second-order terms: products of angles (thp_y, thp_z, tho_z) and of scale errors.
        let spread = (3..NORM_COUNT)
            .map(|i| state.factor.variance(i).widen() * self.scale[i] * self.scale[i])
            .fold(0.0, |a, b| a + b);
        let second = self.model.gravity_m_s2 * spread;
        let variance = measurement.variance[0] + SECOND_ORDER * second * second;
        let weight = 1.0 / variance.root();
        let row = before.derivative.map(|d| T::of(d.dot(&direction) * weight));
        let gain = state.factor.absorb(&row);
        let factor = (self.model.gravity_m_s2 - length) * weight / gain.variance.widen();
        for ((index, p), s) in NORM_INDICES.into_iter().zip(gain.covariance).zip(self.scale) {
            state.coefficients[index] += p.widen() * factor * s;
        }
        Some(before)
    }

    /// Standard deviations of the nine coefficients (SI), 0 elsewhere.
    pub(super) fn standard_deviation(&self, state: &NormState<T>) -> Coefficients {
        let mut deviation = [0.0; COUNT];
        for (i, index) in NORM_INDICES.into_iter().enumerate() {
            deviation[index] = state.factor.variance(i).widen().root() * self.scale[i];
        }
        deviation
    }
}

#[cfg(test)]
mod tests {
    use super::super::coefficients::DEFAULT_SCALE;
    use super::*;

    #[test]
    fn too_long_a_specific_force_is_a_positive_bias() {
        let norm = NormLoop::<f64>::new(Model::new(9.8, 0.7).unwrap(), &DEFAULT_SCALE).unwrap();
        let mut state = NormState::at(&[0.0; COUNT]);
        norm.step(&mut state, &Measurement { value: [0.0, 9.81, 0.0], variance: [2e-13; 3] });
        assert!(state.coefficients[FORCE_BIAS + 1] > 0.0);
    }
}
