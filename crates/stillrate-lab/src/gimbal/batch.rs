//! Batch Gauss-Newton: the anchor of the recursive methods.
//!
//! All epochs at once about one trajectory: QR of the scaled, whitened sensitivities with the prior as extra rows, the step added, and again
//! until the largest scaled change is below 1e-7; if the cost rises the columns are damped (Levenberg-Marquardt).

use nalgebra::{DMatrix, DVector, Matrix3};
use stillrate::Real;
use stillrate::gimbal::rotation::{exponential, logarithm};
use stillrate::gimbal::window::{against_model, commanded};
use stillrate::gimbal::{Coefficients, Linearisation, Measurement, Record, Reference};

use super::bound::sensitivities;
use super::outcome::Outcome;
use super::settings::Settings;
use super::triangle::Triangle;

/// Largest scaled change that still counts as movement.
const TOLERANCE: f64 = 1e-7;
const ITERATIONS_MAX: usize = 15;

/// Solves for the estimated coefficients of an outcome, which holds the prior.
pub(super) fn batch(record: &Record<'_>, s: &Settings, outcome: &mut Outcome) {
    let n = outcome.indices.len();
    let problem = Problem::new(record, s);
    let mut point = Linearisation::of(&s.prior);
    let mut best = (f64::INFINITY, point);
    let mut damping = 0.0;
    for _ in 0..ITERATIONS_MAX {
        let Rows { root, cost, observations } = problem.rows(&outcome.indices, &point);
        let total = root[(n, n)] * root[(n, n)] + root.view((0, n), (n, 1)).norm_squared();
        if total > best.0 * (1.0 + 1e-12) && outcome.steps.last().is_some_and(|s| *s > 1e-4) {
            // Worse than before: back, and a shorter step.
            damping = if damping == 0.0 { 1e-3 } else { damping * 10.0 };
            point = best.1;
            if damping > 1e6 {
                break;
            }
        } else {
            best = (total, point);
            outcome.cost = cost;
            outcome.observations = observations;
        }
        let square = root.view((0, 0), (n, n)).into_owned();
        let side: DVector<f64> = root.view((0, n), (n, 1)).column(0).into_owned();
        let step = solve(&square, &side, damping);
        let Some(step) = step else { break };
        point = moved(&point, &outcome.indices, &s.scale, &step);
        let largest = step.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        outcome.steps.push(largest);
        if let Some(inverse) = square.solve_upper_triangular(&DMatrix::identity(n, n)) {
            for (row, &index) in outcome.indices.iter().enumerate() {
                outcome.deviation[index] = inverse.row(row).dot(&inverse.row(row)).root() * s.scale[index];
            }
        }
        if largest < TOLERANCE {
            break;
        }
    }
    outcome.coefficients = point.coefficients();
}

/// A record with what of it stays the same in every iteration.
struct Problem<'a> {
    record: &'a Record<'a>,
    settings: &'a Settings,
    commands: Vec<[f64; 3]>,
    /// Measurements about the commanded motion; those about the model move with it.
    commanded: Vec<Measurement>,
}

/// The equations about one trajectory.
struct Rows {
    /// R of [J, r], whitened and scaled, with the prior as rows.
    root: DMatrix<f64>,
    /// Sum of squared whitened residuals without the prior.
    cost: f64,
    /// Number of scalar measurements.
    observations: usize,
}

impl<'a> Problem<'a> {
    fn new(record: &'a Record<'a>, settings: &'a Settings) -> Self {
        let model = &settings.model;
        let commands: Vec<[f64; 3]> = (0..record.epochs()).map(|k| record.command(k)).collect();
        let earth_rate = model.earth_rate();
        let mut frame = Matrix3::identity();
        let mut measurements = vec![Measurement::NONE];
        for (k, command) in commands.iter().enumerate() {
            frame = model.commanded_step(&frame, &(*command).into(), &earth_rate, record.interval_s());
            measurements.push(commanded(model, record, k + 1, &frame, &earth_rate, settings.robust));
        }
        Self { record, settings, commands, commanded: measurements }
    }

    fn rows(&self, indices: &[usize], point: &Linearisation) -> Rows {
        let Settings { model, prior, scale, reference, robust, .. } = self.settings;
        let n = indices.len();
        let at = point.coefficients();
        let mut triangle = Triangle::new(n + 1);
        let phi = -logarithm(&(Linearisation::of(prior).rotation * point.rotation.transpose()));
        for (row, &index) in indices.iter().enumerate() {
            let difference = if index < 3 { phi[index] } else { prior[index] - at[index] };
            let unit = (0..n).map(|i| if i == row { 1.0 } else { 0.0 });
            triangle.push(unit.chain([difference / scale[index]]));
        }
        let (mut cost, mut observations) = (0.0, 0);
        sensitivities(model, &at, &self.commands, self.record.interval_s(), |k, geometry, rotation, value, rows| {
            if k == 0 {
                return;
            }
            let (measured, known) = match reference {
                Reference::Commanded => (self.commanded[k], *value),
                Reference::Model => (against_model(geometry, model, self.record, k, rotation, *robust), [0.0; 3]),
            };
            for axis in 0..3 {
                if measured.variance[axis].is_finite() {
                    let weight = 1.0 / measured.variance[axis].root();
                    let residual = (measured.value[axis] - known[axis]) * weight;
                    cost += residual * residual;
                    observations += 1;
                    triangle.push(indices.iter().map(|&i| rows[axis][i] * scale[i] * weight).chain([residual]));
                }
            }
        });
        Rows { root: triangle.finish(), cost, observations }
    }
}

fn solve(square: &DMatrix<f64>, side: &DVector<f64>, damping: f64) -> Option<DVector<f64>> {
    if damping == 0.0 {
        return square.solve_upper_triangular(side);
    }
    let normal = square.transpose() * square;
    let damped = &normal + DMatrix::from_diagonal(&(normal.diagonal() * damping));
    damped.cholesky().map(|c| c.solve(&(square.transpose() * side)))
}

fn moved(point: &Linearisation, indices: &[usize], scale: &Coefficients, step: &DVector<f64>) -> Linearisation {
    let mut next = *point;
    let mut phi = nalgebra::Vector3::zeros();
    for (d, &index) in step.iter().zip(indices) {
        if index < 3 {
            phi[index] = d * scale[index];
        } else {
            next.coefficients[index] += d * scale[index];
        }
    }
    next.rotation = exponential(&-phi) * point.rotation;
    next
}
