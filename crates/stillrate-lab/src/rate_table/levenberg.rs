//! Levenberg and Marquardt's steps for the network, with weight decay and the mean (not the sum) of squares.
//!
//! A = J'J/N + lam D, g = J'e/N + lam D p, dp = -(A + mu I)^-1 g, e = output - target; the objective is mse + lam p'Dp. J'J/N and
//! J'e/N are summed over fixed chunks of samples, so the sum does not depend on the number of threads.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::rate_table::network::Network;

/// Samples whose gradients are held at once; their products are summed in vector code.
const BLOCK: usize = 64;
/// Samples a thread takes at a time.
const CHUNK: usize = 4096;
/// Partial sums of a product, enough for the widest vectors.
const LANES: usize = 8;

/// Scaled samples: rows of inputs one after the other, one target (and weight) a row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Samples<'a> {
    /// Inputs, row after row.
    pub(crate) rows: &'a [f64],
    /// Targets.
    pub(crate) targets: &'a [f64],
    /// Weights of the squares, mean 1; empty for equal weights.
    pub(crate) weights: &'a [f64],
}

/// J'J/N, J'e/N and mse of a network on samples.
#[derive(Clone, Debug)]
pub(crate) struct Normal {
    /// J'J/N.
    pub(crate) matrix: DMatrix<f64>,
    /// J'e/N.
    pub(crate) gradient: DVector<f64>,
    /// Mean of e^2.
    pub(crate) mse: f64,
}

/// Mean squared error.
pub(crate) fn mean_square(network: &Network, samples: Samples<'_>) -> f64 {
    let inputs = network.shape().inputs;
    let chunk = |k: usize| {
        let range = k * CHUNK..samples.targets.len().min((k + 1) * CHUNK);
        range
            .map(|n| {
                let e = network.output(&samples.rows[n * inputs..(n + 1) * inputs]) - samples.targets[n];
                e * e * samples.weights.get(n).copied().unwrap_or(1.0)
            })
            .sum::<f64>()
    };
    let chunks: Vec<f64> = (0..samples.targets.len().div_ceil(CHUNK)).into_par_iter().map(chunk).collect();
    chunks.iter().sum::<f64>() / samples.targets.len() as f64
}

/// The normal equations at the network's parameters.
pub(crate) fn normal(network: &Network, samples: Samples<'_>) -> Normal {
    let count = network.shape().parameters();
    let chunks: Vec<(Vec<f64>, f64)> =
        (0..samples.targets.len().div_ceil(CHUNK)).into_par_iter().map(|k| sum_chunk(network, samples, k)).collect();
    let n = samples.targets.len() as f64;
    let mut packed = vec![0.0; (count + 1) * count];
    let mut square = 0.0;
    for (part, part_square) in &chunks {
        packed.iter_mut().zip(part).for_each(|(sum, p)| *sum += p);
        square += part_square;
    }
    let matrix = DMatrix::from_fn(count, count, |i, j| packed[i.max(j) * count + i.min(j)] / n);
    let gradient = DVector::from_fn(count, |i, _| packed[count * count + i] / n);
    Normal { matrix, gradient, mse: square / n }
}

/// Lower triangle of J'J, then J'e, and e'e of one chunk.
fn sum_chunk(network: &Network, samples: Samples<'_>, chunk: usize) -> (Vec<f64>, f64) {
    let inputs = network.shape().inputs;
    let count = network.shape().parameters();
    let end = samples.targets.len().min((chunk + 1) * CHUNK);
    let mut sums = vec![[0.0; LANES]; (count + 1) * count];
    let mut columns = vec![[0.0; BLOCK]; count + 1];
    let mut gradient = vec![0.0; count];
    let mut square = 0.0;
    let mut first = chunk * CHUNK;
    while first < end {
        let used = BLOCK.min(end - first);
        for s in 0..BLOCK {
            if s < used {
                let n = first + s;
                let e =
                    network.gradient(&samples.rows[n * inputs..(n + 1) * inputs], &mut gradient) - samples.targets[n];
                let weight = samples.weights.get(n).copied().unwrap_or(1.0);
                let root = stillrate::Real::root(weight);
                square += e * e * weight;
                columns[count][s] = e * root;
                gradient.iter().zip(&mut columns).for_each(|(g, column)| column[s] = g * root);
            } else {
                for column in &mut columns {
                    column[s] = 0.0;
                }
            }
        }
        for i in 0..=count {
            for j in 0..count.min(i + 1) {
                let (a, b) = (columns[i], &columns[j]);
                let sum = &mut sums[i * count + j];
                for part in 0..BLOCK / LANES {
                    for l in 0..LANES {
                        sum[l] += a[part * LANES + l] * b[part * LANES + l];
                    }
                }
            }
        }
        first += used;
    }
    (sums.iter().map(|lanes| lanes.iter().sum()).collect(), square)
}

/// A trial step of the training, whether or not it would be taken, and where it starts from.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::{levenberg::Trial, network::{Network, Shape}};
/// // One straight line: e = b2 + c x with the parameters W1, b1, W2, b2, c. Only b2 and c matter while W2 is 0.
/// let line = Network::new(Shape { inputs: 1, hidden: 1, linear: true }, vec![1.0, 0.0, 0.0, 0.0, 0.0])?;
/// let trial = Trial::of(&line, &[-1.0, 0.0, 1.0], &[1.0, 2.0, 3.0], 0.0, None, 1e-9).unwrap();
/// assert!((trial.mse - 14.0 / 3.0).abs() < 1e-12);
/// assert!((trial.gradient[3] + 4.0).abs() < 1e-12); // -2 mean(target)
/// assert!(trial.before == trial.mse && trial.after < 1e-9); // least squares in one step
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Mean square of output less target before the step.
    pub mse: f64,
    /// Its gradient in the parameters.
    pub gradient: Vec<f64>,
    /// dp.
    pub step: Vec<f64>,
    /// Objective before: mean square plus decay.
    pub before: f64,
    /// Objective after the step.
    pub after: f64,
}

impl Trial {
    /// The step of a network on scaled samples (rows of inputs one after the other, a target each), with weight decay on the parameters
    /// that `mask` marks with 1 (by default all weights but b2 and c) and damping mu; none if the damped matrix has no Cholesky factor.
    #[must_use]
    pub fn of(
        network: &Network,
        rows: &[f64],
        targets: &[f64],
        decay: f64,
        mask: Option<&[f64]>,
        damping: f64,
    ) -> Option<Self> {
        let samples = Samples { rows, targets, weights: &[] };
        let usual = network.shape().decay_mask();
        let normal = normal(network, samples);
        let Step { change, before, after, .. } =
            step(network, samples, &normal, mask.unwrap_or(&usual), decay, damping)?;
        let gradient = normal.gradient.iter().map(|g| 2.0 * g).collect();
        Some(Self { mse: normal.mse, gradient, step: change, before, after })
    }
}

/// One trial step.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    /// dp.
    pub(crate) change: Vec<f64>,
    /// Objective before.
    pub(crate) before: f64,
    /// Objective after the step, whether or not it is taken.
    pub(crate) after: f64,
    /// The network after the step.
    pub(crate) network: Network,
}

/// lam p'Dp.
pub(crate) fn penalty(network: &Network, mask: &[f64], decay: f64) -> f64 {
    decay * network.parameters().iter().zip(mask).map(|(p, d)| d * p * p).sum::<f64>()
}

/// The step at damping `mu`; none if the damped matrix has no Cholesky factor.
pub(crate) fn step(
    network: &Network,
    samples: Samples<'_>,
    normal: &Normal,
    mask: &[f64],
    decay: f64,
    mu: f64,
) -> Option<Step> {
    let mut matrix = normal.matrix.clone();
    let mut gradient = gradient(network, normal, mask, decay);
    for (i, d) in mask.iter().enumerate() {
        matrix[(i, i)] += decay * d + mu;
    }
    gradient.neg_mut();
    let solution = matrix.cholesky()?.solve(&gradient);
    let change: Vec<f64> = solution.iter().copied().collect();
    let moved = network.moved(&change);
    let before = normal.mse + penalty(network, mask, decay);
    let after = mean_square(&moved, samples) + penalty(&moved, mask, decay);
    Some(Step { change, before, after, network: moved })
}

/// g = J'e/N + lam D p (half the gradient of the objective).
pub(crate) fn gradient(network: &Network, normal: &Normal, mask: &[f64], decay: f64) -> DVector<f64> {
    let p = network.parameters();
    DVector::from_fn(p.len(), |i, _| normal.gradient[i] + decay * mask[i] * p[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rate_table::network::Shape;

    #[test]
    fn the_mean_square_is_that_of_the_normal_equations() {
        let network = Network::new(
            Shape { inputs: 1, hidden: 2, linear: true },
            (0..8).map(|k| 0.3 * f64::from(k) - 1.0).collect(),
        );
        let rows: Vec<f64> = (0..5000).map(|k| f64::from(k) / 2500.0 - 1.0).collect();
        let targets: Vec<f64> = rows.iter().map(|x| x * x).collect();
        let weights: Vec<f64> = (0..5000).map(|k| if k % 2 == 0 { 0.5 } else { 1.5 }).collect();
        let network = network.unwrap();
        for weights in [&[] as &[f64], &weights] {
            let samples = Samples { rows: &rows, targets: &targets, weights };
            let (square, normal) = (mean_square(&network, samples), normal(&network, samples));
            // Sums of 5000 terms in another order.
            assert!((square / normal.mse - 1.0).abs() < 1e-12);
        }
    }
}
