//! Batch Gauss-Newton: the anchor of the recursive methods.
//!
//! All epochs at once about one trajectory: QR of the scaled, whitened sensitivities with the prior as extra rows, the step added, and again
//! until the largest scaled change is below 1e-7; if the cost rises the columns are damped (Levenberg-Marquardt).

use nalgebra::{DMatrix, DVector, Matrix3};
use stillrate::Real;
use stillrate::gimbal::rotation::{exponential, logarithm};
use stillrate::gimbal::window::{against_model, commanded};
use stillrate::gimbal::{COUNT, Coefficients, Linearisation, Measurement, Model, Record, Reference};

use super::bound::sensitivities;
use super::triangle::Triangle;

/// Result of the batch solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// All coefficients, attitude at the start.
    pub coefficients: Coefficients,
    /// Standard deviations with the prior; 0 where not estimated.
    pub deviation: Coefficients,
    /// Largest scaled change of each iteration.
    pub steps: Vec<f64>,
    /// Sum of squared whitened residuals without the prior.
    pub cost: f64,
    /// Number of scalar measurements.
    pub observations: usize,
}

/// Largest scaled change that still counts as movement.
const TOLERANCE: f64 = 1e-7;
const ITERATIONS_MAX: usize = 15;

/// Solves for the coefficients `indices` (attitude first) with the prior mean `prior` and deviations `scale`.
#[must_use]
pub fn batch(
    model: &Model,
    record: &Record<'_>,
    indices: &[usize],
    prior: &Coefficients,
    scale: &Coefficients,
    reference: Reference,
    robust: bool,
) -> Batch {
    let n = indices.len();
    let commands: Vec<[f64; 3]> = (0..record.epochs()).map(|k| record.command(k)).collect();
    let fixed = commanded_measurements(model, record, &commands, robust);
    let mut point = Linearisation::of(prior);
    let mut best = (f64::INFINITY, point);
    let mut damping = 0.0;
    let mut result =
        Batch { coefficients: *prior, deviation: [0.0; COUNT], steps: Vec::new(), cost: f64::NAN, observations: 0 };
    for _ in 0..ITERATIONS_MAX {
        let at = point.coefficients();
        let (root, cost, observations) =
            accumulate(model, record, &commands, indices, &at, &point, prior, scale, reference, robust, &fixed);
        let total = root[(n, n)] * root[(n, n)] + root.view((0, n), (n, 1)).norm_squared();
        if total > best.0 * (1.0 + 1e-12) && result.steps.last().is_some_and(|s| *s > 1e-4) {
            // Worse than before: back, and a shorter step.
            damping = if damping == 0.0 { 1e-3 } else { damping * 10.0 };
            point = best.1;
            if damping > 1e6 {
                break;
            }
        } else {
            best = (total, point);
            result.cost = cost;
            result.observations = observations;
        }
        let square = root.view((0, 0), (n, n)).into_owned();
        let side: DVector<f64> = root.view((0, n), (n, 1)).column(0).into_owned();
        let step = solve(&square, &side, damping);
        let Some(step) = step else { break };
        point = moved(&point, indices, scale, &step);
        let largest = step.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        result.steps.push(largest);
        if let Some(inverse) = square.solve_upper_triangular(&DMatrix::identity(n, n)) {
            for (row, &index) in indices.iter().enumerate() {
                result.deviation[index] = inverse.row(row).dot(&inverse.row(row)).root() * scale[index];
            }
        }
        if largest < TOLERANCE {
            break;
        }
    }
    result.coefficients = point.coefficients();
    result
}

fn commanded_measurements(model: &Model, record: &Record<'_>, commands: &[[f64; 3]], robust: bool) -> Vec<Measurement> {
    let earth_rate = model.earth_rate();
    let mut frame = Matrix3::identity();
    let mut list = vec![Measurement::NONE];
    for (k, command) in commands.iter().enumerate() {
        frame = model.commanded_step(&frame, &(*command).into(), &earth_rate, record.interval_s());
        list.push(commanded(model, record, k + 1, &frame, &earth_rate, robust));
    }
    list
}

/// R of [J, r] with the prior rows, cost without the prior, number of measurements.
fn accumulate(
    model: &Model,
    record: &Record<'_>,
    commands: &[[f64; 3]],
    indices: &[usize],
    at: &Coefficients,
    point: &Linearisation,
    prior: &Coefficients,
    scale: &Coefficients,
    reference: Reference,
    robust: bool,
    fixed: &[Measurement],
) -> (DMatrix<f64>, f64, usize) {
    let n = indices.len();
    let mut triangle = Triangle::new(n + 1);
    let phi = -logarithm(&(Linearisation::of(prior).rotation * point.rotation.transpose()));
    for (row, &index) in indices.iter().enumerate() {
        let difference = if index < 3 { phi[index] } else { prior[index] - at[index] };
        let unit = (0..n).map(|i| if i == row { 1.0 } else { 0.0 });
        triangle.push(unit.chain([difference / scale[index]]));
    }
    let (mut cost, mut observations) = (0.0, 0);
    sensitivities(model, at, commands, record.interval_s(), |k, geometry, rotation, value, rows| {
        if k == 0 {
            return;
        }
        let (measured, known) = match reference {
            Reference::Commanded => (fixed[k], *value),
            Reference::Model => (against_model(geometry, model, record, k, rotation, robust), [0.0; 3]),
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
    (triangle.finish(), cost, observations)
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
