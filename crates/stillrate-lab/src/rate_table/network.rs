//! A network of one hidden tanh layer, e = b2 + W2 tanh(W1 x + b1) [+ c.x], with the derivatives that training needs.
//!
//! Parameter order: W1 row by row (hidden x inputs), b1, W2, b2 and, where there is one, c. The published model is 1-10-1 without c: 31 parameters.
//! Inputs and output are in scaled units here; [`Scaling`] is the map to deg/s.

use stillrate::Real;

/// Shape of a network.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::network::Shape;
/// assert_eq!(Shape { inputs: 1, hidden: 10, linear: false }.parameters(), 31); // the published one
/// let small = Shape { inputs: 1, hidden: 1, linear: true };
/// assert_eq!(small.decay_mask(), [1.0, 1.0, 1.0, 0.0, 0.0]); // W1, b1, W2 decay; b2 and c are free
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Number of inputs.
    pub inputs: usize,
    /// Number of hidden units.
    pub hidden: usize,
    /// Whether a straight line stands beside the hidden layer.
    pub linear: bool,
}

/// A network: its shape and parameters.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::network::{Network, Shape};
/// // e = 0.5 + 2 tanh(3 x + 0)
/// let network = Network::new(Shape { inputs: 1, hidden: 1, linear: false }, vec![3.0, 0.0, 2.0, 0.5])?;
/// assert_eq!((network.output(&[0.0]), network.slope(&[0.0])), (0.5, 6.0)); // steepest in the middle: W2 W1
/// let mut gradient = vec![0.0; network.shape().parameters()];
/// assert_eq!(network.gradient(&[0.0], &mut gradient), 0.5);
/// assert_eq!(gradient, [0.0, 2.0, 0.0, 1.0]); // in W1, b1, W2, b2
/// assert!(Network::new(network.shape(), network.parameters()[1..].to_vec()).is_err());
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    shape: Shape,
    /// W1 row by row, b1, W2, b2, [c].
    parameters: Vec<f64>,
}

impl Shape {
    /// Number of parameters.
    #[must_use]
    pub const fn parameters(self) -> usize {
        self.hidden * (self.inputs + 2) + 1 + if self.linear { self.inputs } else { 0 }
    }

    /// Refuses what is no network, or too large for one.
    pub(crate) fn check(self) -> Result<(), String> {
        if self.inputs == 0 || self.inputs > 16 || self.hidden > 1024 {
            return Err(format!(
                "network of {} inputs and {} units (must be 1..=16 and <= 1024)",
                self.inputs, self.hidden
            ));
        }
        Ok(())
    }

    /// 1 for the parameters that weight decay acts on (W1, b1, W2), 0 for b2 and c.
    #[must_use]
    pub fn decay_mask(self) -> Vec<f64> {
        let penalised = self.hidden * (self.inputs + 2);
        (0..self.parameters()).map(|i| if i < penalised { 1.0 } else { 0.0 }).collect()
    }
}

impl Network {
    /// A network of given parameters.
    ///
    /// # Errors
    /// A sentence if the shape is empty or does not fit the parameters, or a parameter is not finite.
    pub fn new(shape: Shape, parameters: Vec<f64>) -> Result<Self, String> {
        shape.check()?;
        if parameters.len() != shape.parameters() {
            return Err(format!("{} parameters (must be {} for this shape)", parameters.len(), shape.parameters()));
        }
        match parameters.iter().position(|p| !p.is_finite()) {
            Some(i) => Err(format!("parameter {i} is {} (must be finite)", parameters[i])),
            None => Ok(Self { shape, parameters }),
        }
    }

    /// The shape.
    #[must_use]
    pub const fn shape(&self) -> Shape {
        self.shape
    }

    /// The parameters in the order of the module's first lines.
    #[must_use]
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// The same network moved by a step in parameter space.
    pub(crate) fn moved(&self, step: &[f64]) -> Self {
        Self { shape: self.shape, parameters: self.parameters.iter().zip(step).map(|(p, d)| p + d).collect() }
    }

    /// W1, b1, W2, b2, c.
    pub(crate) fn split(&self) -> (&[f64], &[f64], &[f64], f64, &[f64]) {
        let Shape { inputs, hidden, .. } = self.shape;
        let (w1, rest) = self.parameters.split_at(hidden * inputs);
        let (b1, rest) = rest.split_at(hidden);
        let (w2, rest) = rest.split_at(hidden);
        (w1, b1, w2, rest[0], &rest[1..])
    }

    /// Output for one sample of inputs.
    #[must_use]
    pub fn output(&self, x: &[f64]) -> f64 {
        let (w1, b1, w2, b2, c) = self.split();
        let mut sum = b2;
        for h in 0..self.shape.hidden {
            sum += w2[h] * (dot(&w1[h * x.len()..(h + 1) * x.len()], x) + b1[h]).tangent_hyperbolic();
        }
        sum + dot(c, x)
    }

    /// Derivative of the output in the first input.
    #[must_use]
    pub fn slope(&self, x: &[f64]) -> f64 {
        let (w1, b1, w2, _, c) = self.split();
        let mut sum = c.first().copied().unwrap_or(0.0);
        for h in 0..self.shape.hidden {
            let t = (dot(&w1[h * x.len()..(h + 1) * x.len()], x) + b1[h]).tangent_hyperbolic();
            sum += w2[h] * (1.0 - t * t) * w1[h * x.len()];
        }
        sum
    }

    /// Output and its gradient in the parameters, written to `gradient`.
    pub fn gradient(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let Shape { inputs, hidden, .. } = self.shape;
        let (w1, b1, w2, b2, c) = self.split();
        let mut sum = b2;
        for h in 0..hidden {
            let t = (dot(&w1[h * inputs..(h + 1) * inputs], x) + b1[h]).tangent_hyperbolic();
            sum += w2[h] * t;
            let inner = w2[h] * (1.0 - t * t);
            for i in 0..inputs {
                gradient[h * inputs + i] = inner * x[i];
            }
            gradient[hidden * inputs + h] = inner;
            gradient[hidden * (inputs + 1) + h] = t;
        }
        gradient[hidden * (inputs + 2)] = 1.0;
        gradient[hidden * (inputs + 2) + 1..].copy_from_slice(&x[..c.len()]);
        sum + dot(c, x)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The map between physical units and a network's -1..1:
/// xn = 2 (x - low)/range - 1 for each input, e = low + (en + 1)/2 range for the output.
///
/// # Example
/// ```
/// use stillrate_lab::rate_table::{candidate::from_network, network::{Network, Scaling, Shape}};
/// let nothing = Network::new(Shape { inputs: 1, hidden: 1, linear: false }, vec![0.0; 4])?;
/// let scaling = Scaling { inputs: vec![(-6.0, 12.0)], output: (0.02, 0.04) }; // smallest value and range
/// let curve = from_network(&nothing, &scaling, 1);
/// assert!((curve.error([3.0, 0.0, 0.0]).0 - 0.04).abs() < 1e-15); // 0 inside is the middle of the range outside
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Scaling {
    /// Smallest value and range of each input.
    pub inputs: Vec<(f64, f64)>,
    /// Smallest value and range of the output.
    pub output: (f64, f64),
}

impl Scaling {
    /// The scaling that spans given samples; a range of zero becomes 1.
    pub(crate) fn spanning(rows: &[f64], inputs: usize, targets: &[f64]) -> Self {
        let span = |values: &mut dyn Iterator<Item = f64>| {
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            (low, if high > low { high - low } else { 1.0 })
        };
        Self {
            inputs: (0..inputs).map(|i| span(&mut rows.iter().skip(i).step_by(inputs).copied())).collect(),
            output: span(&mut targets.iter().copied()),
        }
    }

    /// Scales rows of inputs.
    pub(crate) fn inward(&self, rows: &[f64]) -> Vec<f64> {
        rows.iter().zip(self.inputs.iter().cycle()).map(|(x, (low, range))| 2.0 * (x - low) / range - 1.0).collect()
    }

    /// Scales targets.
    pub(crate) fn target_inward(&self, targets: &[f64]) -> Vec<f64> {
        targets.iter().map(|e| 2.0 * (e - self.output.0) / self.output.1 - 1.0).collect()
    }

    /// Output in physical units.
    pub(crate) fn outward(&self, output: f64) -> f64 {
        self.output.0 + f64::midpoint(output, 1.0) * self.output.1
    }
}
