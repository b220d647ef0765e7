//! Training: Nguyen and Widrow's start, random split, Levenberg-Marquardt epochs, early stopping.
//!
//! D. Nguyen and B. Widrow, "Improving the learning speed of 2-layer neural networks by choosing initial values of the
//! adaptive weights" (1990): rows of W1 of length 0.7 H^(1/I) in random directions, biases spread so that the units' active
//! regions tile -1..1. Damping starts at 1e-3, falls tenfold after a step that helps and rises tenfold after one that does not.

use stillrate::Real;

use crate::random::{Generator, SplitMix64};
use crate::rate_table::levenberg::{self, Samples};
use crate::rate_table::network::{Network, Shape};

/// First damping.
const FIRST_DAMPING: f64 = 1e-3;
/// Beyond this damping no step helps any more.
const LARGEST_DAMPING: f64 = 1e10;
/// Gradients below this length are a minimum.
const SMALLEST_GRADIENT: f64 = 1e-7;
/// Raw samples a parameter must have at least.
const SAMPLES_A_PARAMETER: usize = 10;

/// How to train.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::{network::Shape, training::Training};
/// let rows: Vec<f64> = (0..=400).map(|k| f64::from(k) / 200.0 - 1.0).collect();
/// let targets: Vec<f64> = rows.iter().map(|x| 0.5 * x * x).collect();
/// let shape = Shape { inputs: 1, hidden: 4, linear: true };
/// let training = Training { shape, decay: 0.0, ..Training::published(1) };
/// let trained = training.train(&rows, &targets)?;
/// assert!((trained.network.output(&[0.6]) - 0.18).abs() < 0.01);
/// // Fewer than ten samples a parameter would be memorised.
/// assert!(Training::published(1).train(&rows[..309], &targets[..309]).unwrap_err().contains("must be at least 310"));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Training {
    /// Shape of the network.
    pub shape: Shape,
    /// Weight decay (lam).
    pub decay: f64,
    /// Most epochs.
    pub epochs: usize,
    /// Stop after this many epochs in a row without a better validation error; 0: no validation set, no test set.
    pub patience: usize,
    /// Seed of the start and of the split.
    pub seed: u64,
}

impl Training {
    /// The published network: 1-10-1, no decay, 1000 epochs, patience 6, split 70/15/15.
    #[must_use]
    pub const fn published(seed: u64) -> Self {
        let shape = Shape { inputs: 1, hidden: 10, linear: false };
        Self { shape, decay: 0.0, epochs: 1000, patience: 6, seed }
    }

    /// Trains on raw (already scaled) samples: rows of inputs one after the other, a target each.
    ///
    /// # Errors
    /// A sentence if there are fewer than ten samples a parameter, counts do not fit, the shape is too large, or anything is not finite.
    pub fn train(&self, rows: &[f64], targets: &[f64]) -> Result<Trained, String> {
        self.shape.check()?;
        if !(self.decay.is_finite() && self.decay >= 0.0) {
            return Err(format!("decay = {} (must be finite and >= 0)", self.decay));
        }
        let parameters = self.shape.parameters();
        if targets.len() < SAMPLES_A_PARAMETER * parameters {
            return Err(format!(
                "{} samples for {parameters} parameters (must be at least {})",
                targets.len(),
                SAMPLES_A_PARAMETER * parameters
            ));
        }
        fit(self, rows, targets, &[])
    }
}

/// A trained network and how it went.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::{network::Shape, training::Training};
/// let rows: Vec<f64> = (0..=400).map(|k| f64::from(k) / 200.0 - 1.0).collect();
/// let targets: Vec<f64> = rows.iter().map(|x| 0.3 - 0.2 * x).collect();
/// let shape = Shape { inputs: 1, hidden: 1, linear: true };
/// let trained = Training { shape, decay: 0.0, epochs: 20, patience: 0, seed: 1 }.train(&rows, &targets)?;
/// let [learnt, validated, tested] = trained.mean_square;
/// assert!(learnt < 1e-6 && validated.is_nan() && tested.is_nan()); // without patience nothing is held back
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Trained {
    /// The network with the best validation error (the last one without validation).
    pub network: Network,
    /// Epochs run.
    pub epochs: usize,
    /// Mean squares on the training, validation and test part, in scaled units (NaN for an empty part).
    pub mean_square: [f64; 3],
}

/// Trains like [`Training::train`] but on averaged points, where weight decay and not the number of samples keeps the network in check.
pub(crate) fn fit(training: &Training, rows: &[f64], targets: &[f64], weights: &[f64]) -> Result<Trained, String> {
    let inputs = training.shape.inputs;
    if rows.len() != targets.len() * inputs {
        return Err(format!("{} inputs for {} targets of {inputs} inputs each", rows.len(), targets.len()));
    }
    if let Some(k) = rows.iter().chain(targets).position(|v| !v.is_finite()) {
        return Err(format!("number {k} of the training data is not finite"));
    }
    let mut generator = SplitMix64::new(training.seed);
    let network = nguyen_widrow(training.shape, &mut generator);
    let parts = if training.patience > 0 {
        split(targets.len(), &mut generator)
    } else {
        [(0..targets.len()).collect(), vec![], vec![]]
    };
    let gathered = parts.map(|part| gather(&part, inputs, rows, targets, weights));
    let [learn, validate, test] = gathered.each_ref().map(Part::samples);
    let (network, epochs) = descend(training, network, learn, validate);
    let mean_square = [learn, validate, test].map(|part| levenberg::mean_square(&network, part));
    if !mean_square[0].is_finite() {
        return Err("training diverged".into());
    }
    Ok(Trained { network, epochs, mean_square })
}

/// Epochs until patience, damping, gradient or count end them.
fn descend(training: &Training, start: Network, learn: Samples<'_>, validate: Samples<'_>) -> (Network, usize) {
    let mask = training.shape.decay_mask();
    let validation = |network: &Network| {
        if validate.targets.is_empty() { f64::INFINITY } else { levenberg::mean_square(network, validate) }
    };
    let mut network = start;
    let mut mu = FIRST_DAMPING;
    let (mut best, mut best_value) = (network.clone(), validation(&network));
    let mut rises = 0;
    for epoch in 0..training.epochs {
        let normal = levenberg::normal(&network, learn);
        let gradient = levenberg::gradient(&network, &normal, &mask, training.decay);
        if gradient.dot(&gradient).root() < SMALLEST_GRADIENT {
            return (if best_value.is_finite() { best } else { network }, epoch);
        }
        loop {
            match levenberg::step(&network, learn, &normal, &mask, training.decay, mu) {
                Some(step) if step.after < step.before => {
                    network = step.network;
                    mu *= 0.1;
                    break;
                }
                _ => mu *= 10.0,
            }
            if mu > LARGEST_DAMPING {
                return (if best_value.is_finite() { best } else { network }, epoch);
            }
        }
        let now = validation(&network);
        if now < best_value {
            (best, best_value) = (network.clone(), now);
            rises = 0;
        } else {
            rises += 1;
        }
        if training.patience > 0 && rises >= training.patience {
            return (best, epoch + 1);
        }
    }
    (if best_value.is_finite() { best } else { network }, training.epochs)
}

/// Starting weights.
pub(crate) fn nguyen_widrow(shape: Shape, generator: &mut SplitMix64) -> Network {
    let Shape { inputs, hidden, linear } = shape;
    let mut symmetric = || 2.0 * generator.uniform() - 1.0;
    // 0.7 H^(1/I)
    let length = 0.7 * ((hidden.max(1) as f64).logarithm() / inputs as f64).exponential();
    let mut w1 = Vec::with_capacity(hidden * inputs);
    for _ in 0..hidden {
        let row: Vec<f64> = (0..inputs).map(|_| symmetric()).collect();
        let norm = row.iter().map(|v| v * v).sum::<f64>().root().most(f64::EPSILON);
        w1.extend(row.iter().map(|v| length * v / norm));
    }
    let b1: Vec<f64> = (0..hidden)
        .map(|h| {
            let place = if hidden > 1 { 2.0 * h as f64 / (hidden - 1) as f64 - 1.0 } else { 0.0 };
            let sign = if w1[h * inputs] < 0.0 { -1.0 } else { 1.0 };
            length * place * sign
        })
        .collect();
    let output = (0..hidden + 1 + if linear { inputs } else { 0 }).map(|_| 0.5 * symmetric());
    let parameters: Vec<f64> = w1.iter().copied().chain(b1).chain(output).collect();
    Network::new(shape, parameters).unwrap_or_else(|why| unreachable!("{why}"))
}

/// Indices of a random 70/15/15 split (Fisher and Yates).
fn split(count: usize, generator: &mut SplitMix64) -> [Vec<usize>; 3] {
    let mut order: Vec<usize> = (0..count).collect();
    for i in (1..count).rev() {
        order.swap(i, generator.below(i as u64 + 1) as usize);
    }
    let validate = count * 15 / 100;
    let learn = count - 2 * validate;
    [order[..learn].to_vec(), order[learn..learn + validate].to_vec(), order[learn + validate..].to_vec()]
}

struct Part {
    rows: Vec<f64>,
    targets: Vec<f64>,
    weights: Vec<f64>,
}

impl Part {
    fn samples(&self) -> Samples<'_> {
        Samples { rows: &self.rows, targets: &self.targets, weights: &self.weights }
    }
}

fn gather(part: &[usize], inputs: usize, rows: &[f64], targets: &[f64], weights: &[f64]) -> Part {
    Part {
        rows: part.iter().flat_map(|&n| rows[n * inputs..(n + 1) * inputs].iter().copied()).collect(),
        targets: part.iter().map(|&n| targets[n]).collect(),
        weights: part.iter().filter_map(|&n| weights.get(n).copied()).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_or_decay_that_cannot_be_trained_is_refused() {
        let samples = vec![0.1; 70_000];
        let shape = Shape { inputs: 1, hidden: 2, linear: false };
        let training = Training { shape, ..Training::published(1) };
        for (unfit, why) in [
            (Training { shape: Shape { hidden: 1025, ..shape }, ..training }, "1025 units"),
            (Training { shape: Shape { inputs: 17, ..shape }, ..training }, "17 inputs"),
            (Training { decay: f64::NAN, ..training }, "decay = NaN"),
            (Training { decay: -1.0, ..training }, "decay = -1"),
        ] {
            let refused = unfit.train(&samples, &samples).unwrap_err();
            assert!(refused.contains(why), "{refused}");
        }
    }
}
