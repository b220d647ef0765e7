//! The candidate curves of a calibration and how each is fitted to points: offset, polynomials, line plus a small network.

use nalgebra::{DMatrix, DVector};
use stillrate::correction::{ErrorCurve, HIDDEN, INPUTS, TERMS, term_powers};

use crate::rate_table::network::{Network, Scaling, Shape};
use crate::rate_table::points::Point;
use crate::rate_table::training::{self, Training};

/// Hidden units of the small network.
const UNITS: usize = 4;
/// Most epochs of its training.
const EPOCHS: usize = 200;
/// Trainings from different starts, of which the best objective is kept.
const STARTS: u64 = 3;

/// A class of error curves.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::candidate::Candidate;
/// let names = Candidate::ALL.map(Candidate::name);
/// assert_eq!(names[..5], ["offset", "line", "quadratic", "cubic", "line + network (decay 1e-1)"]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Candidate {
    /// All monomials of rate (and temperature) up to a total degree: 0 offset, 1 line, 2, 3.
    Polynomial(u8),
    /// Straight line plus four tanh units, with a weight decay.
    Network(f64),
}

impl Candidate {
    /// Every candidate, simplest first.
    pub const ALL: [Self; 9] = [
        Self::Polynomial(0),
        Self::Polynomial(1),
        Self::Polynomial(2),
        Self::Polynomial(3),
        Self::Network(1e-1),
        Self::Network(1e-2),
        Self::Network(1e-3),
        Self::Network(1e-4),
        Self::Network(1e-5),
    ];

    /// Its name in reports and files.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Polynomial(0) => "offset".into(),
            Self::Polynomial(1) => "line".into(),
            Self::Polynomial(2) => "quadratic".into(),
            Self::Polynomial(_) => "cubic".into(),
            Self::Network(decay) => format!("line + network (decay {decay:e})"),
        }
    }

    /// Fewest distinct rates it may be fitted to.
    pub(crate) const fn fewest_rates(self) -> usize {
        match self {
            Self::Polynomial(0) => 2,
            Self::Polynomial(1) => 3,
            _ => 5,
        }
    }
}

/// Fits a candidate to points; the curve's range is that of the points. None if the points do not determine it.
pub(crate) fn fit(candidate: Candidate, points: &[Point], seed: u64) -> Option<ErrorCurve<f64>> {
    let inputs = if points.first()?.temperature.is_some() { 2 } else { 1 };
    let rows: Vec<f64> = points.iter().flat_map(|p| core::iter::once(p.rate).chain(p.temperature)).collect();
    let targets: Vec<f64> = points.iter().map(|p| p.error).collect();
    let total: f64 = points.iter().map(weight).sum();
    let weights: Vec<f64> = points.iter().map(|p| weight(p) * points.len() as f64 / total).collect();
    let scaling = Scaling::spanning(&rows, inputs, &targets);
    let scaled = scaling.inward(&rows);
    match candidate {
        Candidate::Polynomial(degree) => {
            let terms = polynomial(degree, inputs, &scaled, &targets, &weights)?;
            let unscaled = Scaling { output: (-1.0, 2.0), ..scaling };
            Some(assemble(&unscaled, terms, None, 3))
        }
        Candidate::Network(decay) => {
            let targets = scaling.target_inward(&targets);
            let shape = Shape { inputs, hidden: UNITS, linear: true };
            let best = (0..STARTS)
                .filter_map(|start| {
                    let training =
                        Training { shape, decay, epochs: EPOCHS, patience: 0, seed: seed.wrapping_add(start) };
                    let trained = training::fit(&training, &scaled, &targets, &weights).ok()?;
                    let penalty = crate::rate_table::levenberg::penalty(&trained.network, &shape.decay_mask(), decay);
                    Some((trained.mean_square[0] + penalty, trained.network))
                })
                .min_by(|a, b| a.0.total_cmp(&b.0))?;
            Some(from_network(&best.1, &scaling, 3))
        }
    }
}

/// Weight of a point: its length. Standard errors of single segments are too uncertain to weigh with, and noise and drift average
/// with length alike in all segments.
fn weight(point: &Point) -> f64 {
    point.samples as f64
}

/// Weighted least squares on the monomials of a total degree; coefficients in the order of the core's terms.
fn polynomial(degree: u8, inputs: usize, rows: &[f64], targets: &[f64], weights: &[f64]) -> Option<[f64; TERMS]> {
    let used: Vec<(usize, [u8; INPUTS])> = term_powers()
        .into_iter()
        .enumerate()
        .filter(|(_, p)| p.iter().sum::<u8>() <= degree && p[inputs..].iter().all(|&q| q == 0))
        .collect();
    if targets.len() < used.len() {
        return None;
    }
    let power = |x: f64, p: u8| (0..p).fold(1.0, |a, _| a * x);
    let monomial = |row: &[f64], p: [u8; INPUTS]| row.iter().zip(p).map(|(x, q)| power(*x, q)).product::<f64>();
    let root = |n: usize| stillrate::Real::root(weights[n]);
    let design = DMatrix::from_fn(targets.len(), used.len(), |n, j| {
        root(n) * monomial(&rows[n * inputs..(n + 1) * inputs], used[j].1)
    });
    let right = DVector::from_fn(targets.len(), |n, _| root(n) * targets[n]);
    let normal = design.tr_mul(&design);
    // Scaled inputs keep a cubic's normal equations at a condition below 1e4; a worse one means that the points do not determine it.
    let solution = normal.clone().cholesky()?.solve(&design.tr_mul(&right));
    let smallest = normal.symmetric_eigenvalues().min();
    if smallest < 1e-9 * normal.trace() {
        return None;
    }
    let mut terms = [0.0; TERMS];
    used.iter().zip(solution.iter()).for_each(|((k, _), c)| terms[*k] = *c);
    Some(terms)
}

/// The run-time curve of a network in its scaling. `steps` as in [`ErrorCurve::steps`].
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::{candidate::from_network, network::{Network, Scaling, Shape}};
/// let line = Network::new(Shape { inputs: 1, hidden: 0, linear: true }, vec![0.0, 1.0])?;
/// let scaling = Scaling { inputs: vec![(-6.0, 12.0)], output: (-0.06, 0.12) };
/// let curve = from_network(&line, &scaling, 1);
/// assert!((curve.slope([1.0, 0.0, 0.0]) - 0.01).abs() < 1e-15); // 0.12 deg/s of error over 12 deg/s of rate
/// assert_eq!(curve.error([9.0, 0.0, 0.0]).0, curve.error([6.0, 0.0, 0.0]).0); // the edge is held
/// # Ok::<(), String>(())
/// ```
#[must_use]
pub fn from_network(network: &Network, scaling: &Scaling, steps: u32) -> ErrorCurve<f64> {
    let (_, _, _, b2, c) = network.split();
    let mut terms = [0.0; TERMS];
    terms[0] = b2;
    terms[1..=c.len()].copy_from_slice(c);
    assemble(scaling, terms, Some(network), steps)
}

fn assemble(scaling: &Scaling, terms: [f64; TERMS], network: Option<&Network>, steps: u32) -> ErrorCurve<f64> {
    let mut curve = ErrorCurve {
        inputs: scaling.inputs.len() as u32,
        hidden: 0,
        steps,
        cubic: u32::from(terms[4..].iter().any(|t| *t != 0.0)),
        low: [0.0; INPUTS],
        high: [0.0; INPUTS],
        centre: [0.0; INPUTS],
        scale: [1.0; INPUTS],
        terms,
        input_weights: [[0.0; INPUTS]; HIDDEN],
        hidden_bias: [0.0; HIDDEN],
        output_weights: [0.0; HIDDEN],
        output_offset: scaling.output.0 + 0.5 * scaling.output.1,
        output_scale: 0.5 * scaling.output.1,
    };
    for (i, (low, range)) in scaling.inputs.iter().enumerate() {
        curve.low[i] = *low;
        curve.high[i] = low + range;
        curve.centre[i] = low + 0.5 * range;
        curve.scale[i] = 2.0 / range;
    }
    if let Some(network) = network {
        let (w1, b1, w2, ..) = network.split();
        let inputs = scaling.inputs.len();
        curve.hidden = b1.len() as u32;
        for h in 0..b1.len().min(HIDDEN) {
            curve.input_weights[h][..inputs].copy_from_slice(&w1[h * inputs..(h + 1) * inputs]);
            curve.hidden_bias[h] = b1[h];
            curve.output_weights[h] = w2[h];
        }
    }
    curve
}
