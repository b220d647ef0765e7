//! Interacting multiple models: mixing, prior and posterior probabilities (Blom and Bar-Shalom, IEEE Trans. AC-33, 1988).
//!
//! Two forms of mixing stand here: for two models with any transition matrix, and for any number of models in time linear in it.
//!
//! With one dwell time a model, pi_ii = 1 - e_i and pi_ij = e_i / (n - 1) = u_i. The mixed moments of target j are then one common sum
//! over all models with weights g_i = mu_i u_i, plus the model's own with the extra weight (1 - e_j) mu_j - g_j. Sums are
//! centred on the fused mean, so that the spread of the means does not cancel.
//!
//! Singer rungs and the random walk lack the higher derivatives: there they are zero with a given variance. For
//! oscillator targets the acceleration of all other sources is capped (`derivative_cap` of the recommended bank).

use crate::gaussian::{Gaussian2, Gaussian3, Gaussian4, outer};
use crate::real::Real;
use crate::reals;

reals! {
    /// Weighted sums over sources of deviations from the centre and of second moments about it.
    pub(crate) struct Sums4 {
        /// Sum of the weights.
        pub weight: T,
        /// Weighted deviations from the centre.
        pub first: [T; 4],
        /// Weighted second moments about the centre.
        pub second: [T; 10],
    }
}

reals! {
    /// [`Sums4`] for rate and acceleration only.
    pub(crate) struct Sums2 {
        /// Sum of the weights.
        pub weight: T,
        /// Weighted deviations from the centre.
        pub first: [T; 2],
        /// Weighted second moments about the centre.
        pub second: [T; 3],
    }
}

impl<T: Real> Sums2<T> {
    /// Adds a source.
    #[inline(always)]
    pub(crate) fn add(&mut self, weight: T, source: &Gaussian2<T>, centre: [T; 4]) {
        let d0 = source.mean[0] - centre[0];
        let d1 = source.mean[1] - centre[1];
        let (w0, w1) = (weight * d0, weight * d1);
        self.weight += weight;
        self.first[0] += w0;
        self.first[1] += w1;
        self.second[0] += weight * source.covariance[0] + w0 * d0;
        self.second[1] += weight * source.covariance[1] + w0 * d1;
        self.second[2] += weight * source.covariance[2] + w1 * d1;
    }

    /// Adds a source to `self`, and to `pulled` the same source with its acceleration pulled towards the fused one until its
    /// second moment about that fits `cap`. Pulling scales deviation and standard deviation alike, so that the pulled
    /// source's terms are the plain ones times the shrinkage or its square.
    #[inline(always)]
    pub(crate) fn add_and_pull(&mut self, pulled: &mut Self, weight: T, source: &Gaussian2<T>, centre: [T; 4], cap: T) {
        let d0 = source.mean[0] - centre[0];
        let d1 = source.mean[1] - centre[1];
        let (w0, w1) = (weight * d0, weight * d1);
        let moment = source.covariance[2] + d1 * d1;
        let square = T::select(cap < moment, cap / moment, T::ONE);
        let shrink = square.root();
        let rates = weight * source.covariance[0] + w0 * d0;
        let crossed = weight * source.covariance[1] + w0 * d1;
        let accelerations = weight * moment;
        self.weight += weight;
        self.first[0] += w0;
        self.first[1] += w1;
        self.second[0] += rates;
        self.second[1] += crossed;
        self.second[2] += accelerations;
        pulled.weight += weight;
        pulled.first[0] += w0;
        pulled.first[1] += shrink * w1;
        pulled.second[0] += rates;
        pulled.second[1] += shrink * crossed;
        pulled.second[2] += square * accelerations;
    }

    /// Both sums together.
    #[inline(always)]
    pub(crate) fn with(&self, other: &Sums4<T>) -> Self {
        Self {
            weight: self.weight + other.weight,
            first: [self.first[0] + other.first[0], self.first[1] + other.first[1]],
            second: [
                self.second[0] + other.second[0],
                self.second[1] + other.second[1],
                self.second[2] + other.second[4],
            ],
        }
    }

    /// The mixed moments of a target that adds itself with an extra weight, and its prior probability.
    #[inline(always)]
    pub(crate) fn mixed(&self, extra: T, own: &Gaussian2<T>, centre: [T; 4]) -> (T, Gaussian2<T>) {
        let mut sum = *self;
        sum.add(extra, own, centre);
        let inverse = T::ONE / sum.weight;
        let m0 = sum.first[0] * inverse;
        let m1 = sum.first[1] * inverse;
        let moments = Gaussian2 {
            mean: [centre[0] + m0, centre[1] + m1],
            covariance: [
                sum.second[0] * inverse - m0 * m0,
                sum.second[1] * inverse - m0 * m1,
                sum.second[2] * inverse - m1 * m1,
            ],
        };
        (sum.weight, moments)
    }

    /// The same sources seen with the derivatives they lack: zero, with variances `lacking`.
    #[inline(always)]
    pub(crate) fn widened(&self, lacking: [T; 2], centre: [T; 4]) -> Sums4<T> {
        let w = self.weight;
        let (d2, d3) = (-centre[2], -centre[3]);
        Sums4 {
            weight: w,
            first: [self.first[0], self.first[1], w * d2, w * d3],
            second: [
                self.second[0],
                self.second[1],
                self.first[0] * d2,
                self.first[0] * d3,
                self.second[2],
                self.first[1] * d2,
                self.first[1] * d3,
                w * (lacking[0] + d2 * d2),
                w * d2 * d3,
                w * (lacking[1] + d3 * d3),
            ],
        }
    }
}

impl<T: Real> Sums4<T> {
    /// Adds a source.
    #[inline(always)]
    pub(crate) fn add(&mut self, weight: T, source: &Gaussian4<T>, centre: [T; 4]) {
        let d: [T; 4] = core::array::from_fn(|k| source.mean[k] - centre[k]);
        let w = d.map(|value| weight * value);
        self.weight += weight;
        for k in 0..4 {
            self.first[k] += w[k];
        }
        let products = outer(w, d);
        for k in 0..10 {
            self.second[k] += weight * source.covariance[k] + products[k];
        }
    }

    /// Both sums together.
    #[inline(always)]
    pub(crate) fn with(&self, other: &Self) -> Self {
        Self {
            weight: self.weight + other.weight,
            first: core::array::from_fn(|k| self.first[k] + other.first[k]),
            second: core::array::from_fn(|k| self.second[k] + other.second[k]),
        }
    }

    /// The mixed moments of a target that adds itself with an extra weight, and its prior probability.
    #[inline(always)]
    pub(crate) fn mixed(&self, extra: T, own: &Gaussian4<T>, centre: [T; 4]) -> (T, Gaussian4<T>) {
        let mut sum = *self;
        sum.add(extra, own, centre);
        let inverse = T::ONE / sum.weight;
        let m = sum.first.map(|value| value * inverse);
        let products = outer(m, m);
        let moments = Gaussian4 {
            mean: core::array::from_fn(|k| centre[k] + m[k]),
            covariance: core::array::from_fn(|k| sum.second[k] * inverse - products[k]),
        };
        (sum.weight, moments)
    }
}

/// Prior probabilities c_j = sum_i pi_ij mu_i of two models, and the weights pi_0j mu_0 / c_j of the first source.
#[inline(always)]
pub(crate) fn interact<T: Real>(transition: &[[T; 2]; 2], probability: &[T; 2]) -> ([T; 2], [T; 2]) {
    let prior = prior2(transition, probability);
    // A target that no source reaches keeps an even mixture, not 0/0.
    let share = |j: usize| {
        let reachable = prior[j] > T::ZERO;
        let weight = transition[0][j] * probability[0] / T::select(reachable, prior[j], T::ONE);
        T::select(reachable, weight, T::HALF)
    };
    (prior, [share(0), share(1)])
}

/// Two weights as probabilities.
#[inline(always)]
pub(crate) fn normalised<T: Real>(weight: &[T; 2]) -> [T; 2] {
    let inverse = T::ONE / (weight[0] + weight[1]);
    [(weight[0] * inverse).flushed(), (weight[1] * inverse).flushed()]
}

/// Prior probabilities of two models, as [`interact`] has them.
#[inline(always)]
pub(crate) fn prior2<T: Real>(transition: &[[T; 2]; 2], probability: &[T; 2]) -> [T; 2] {
    [
        transition[0][0] * probability[0] + transition[1][0] * probability[1],
        transition[0][1] * probability[0] + transition[1][1] * probability[1],
    ]
}

/// The shares of the first source in both targets, from weights that need not be probabilities: one division lies between the last
/// sample's evidence and the next mixture instead of two.
#[inline(always)]
pub(crate) fn shares<T: Real>(transition: &[[T; 2]; 2], weight: &[T; 2]) -> [T; 2] {
    core::array::from_fn(|j| {
        // A target that no source reaches takes the first one, not 0/0.
        let first = (transition[0][j] * weight[0]).most(T::TINY);
        first / (first + transition[1][j] * weight[1])
    })
}

/// Posterior weights of two models, not normalised: prior times likelihood, in units of what the first one's exponential is.
///
/// Erratum: see [`weigh2`].
#[inline(always)]
pub(crate) fn judged<T: Real>(prior: &[T; 2], exponent: &[T; 2], factor: &[T; 2]) -> [T; 2] {
    [prior[0] * factor[0], prior[1] * factor[1] * (exponent[1] - exponent[0]).doubling()]
}

/// Mixture of two states, the first with weight `w`.
#[inline(always)]
pub(crate) fn mix2<T: Real>(w: T, a: &Gaussian2<T>, b: &Gaussian2<T>) -> Gaussian2<T> {
    let v = T::ONE - w;
    let d: [T; 2] = core::array::from_fn(|k| a.mean[k] - b.mean[k]);
    let spread = w * v;
    let products = [d[0] * d[0], d[0] * d[1], d[1] * d[1]];
    Gaussian2 {
        mean: core::array::from_fn(|k| w * a.mean[k] + v * b.mean[k]),
        covariance: core::array::from_fn(|k| w * a.covariance[k] + v * b.covariance[k] + spread * products[k]),
    }
}

/// Mixture of two states with a parameter, the first with weight `w`.
#[inline(always)]
pub(crate) fn mix3<T: Real>(w: T, a: &Gaussian3<T>, b: &Gaussian3<T>) -> Gaussian3<T> {
    let v = T::ONE - w;
    let d: [T; 3] = core::array::from_fn(|k| a.mean[k] - b.mean[k]);
    let spread = w * v;
    let products = [d[0] * d[0], d[0] * d[1], d[0] * d[2], d[1] * d[1], d[1] * d[2], d[2] * d[2]];
    Gaussian3 {
        mean: core::array::from_fn(|k| w * a.mean[k] + v * b.mean[k]),
        covariance: core::array::from_fn(|k| w * a.covariance[k] + v * b.covariance[k] + spread * products[k]),
    }
}

/// Posterior probabilities of two models: one exponential serves both. Missing evidence leaves the prior.
///
/// Erratum: eq. 28 of the source paper misses the exponent's division by S and the normalisation; used is
/// mu_i = c_i (2 pi S_i)^-1/2 exp(-nu_i^2 / (2 S_i)) / sum.
#[inline(always)]
pub(crate) fn weigh2<T: Real>(prior: &[T; 2], exponent: &[T; 2], factor: &[T; 2], used: bool) -> [T; 2] {
    let difference = exponent[1] - exponent[0];
    let lesser = (-difference.magnitude()).doubling();
    let first = prior[0] * factor[0] * T::select(difference > T::ZERO, lesser, T::ONE);
    let second = prior[1] * factor[1] * T::select(difference > T::ZERO, T::ONE, lesser);
    let inverse = T::ONE / (first + second);
    [T::select(used, first * inverse, prior[0]), T::select(used, second * inverse, prior[1])]
}
