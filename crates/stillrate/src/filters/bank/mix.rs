//! Interaction of the models in time linear in their number (Blom and Bar-Shalom 1988, for a row-uniform transition matrix).
//!
//! With one dwell time a model, pi_ii = 1 - e_i and pi_ij = e_i / (n - 1) = u_i. The mixed moments of target j are then one common sum
//! over all models with weights g_i = mu_i u_i, plus the model's own with the extra weight (1 - e_j) mu_j - g_j. Sums are
//! centred on the fused mean, so that the spread of the means does not cancel.
//!
//! Singer rungs and the random walk lack the higher derivatives: there they are zero with a given variance. For
//! oscillator targets the acceleration of all other sources is capped (specification 4.3a).

use crate::real::Real;
use crate::reals;

reals! {
    /// A mean and a packed covariance (00 01 02 03 11 12 13 22 23 33) of a four-component state.
    pub struct Moments4 {
        /// Mean.
        pub mean: [T; 4],
        /// Packed covariance.
        pub covariance: [T; 10],
    }
}

reals! {
    /// A mean and a packed covariance (00 01 11) of rate and acceleration.
    pub struct Moments2 {
        /// Mean.
        pub mean: [T; 2],
        /// Packed covariance.
        pub covariance: [T; 3],
    }
}

reals! {
    /// Weighted sums over sources of deviations from the centre and of second moments about it.
    pub struct Sums4 {
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
    pub struct Sums2 {
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
    pub(crate) fn add(&mut self, weight: T, source: &Moments2<T>, centre: [T; 4]) {
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
    pub(crate) fn mixed(&self, extra: T, own: &Moments2<T>, centre: [T; 4]) -> (T, Moments2<T>) {
        let mut sum = *self;
        sum.add(extra, own, centre);
        let inverse = T::ONE / sum.weight;
        let m0 = sum.first[0] * inverse;
        let m1 = sum.first[1] * inverse;
        let moments = Moments2 {
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
    pub(crate) fn add(&mut self, weight: T, source: &Moments4<T>, centre: [T; 4]) {
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
    pub(crate) fn mixed(&self, extra: T, own: &Moments4<T>, centre: [T; 4]) -> (T, Moments4<T>) {
        let mut sum = *self;
        sum.add(extra, own, centre);
        let inverse = T::ONE / sum.weight;
        let m = sum.first.map(|value| value * inverse);
        let products = outer(m, m);
        let moments = Moments4 {
            mean: core::array::from_fn(|k| centre[k] + m[k]),
            covariance: core::array::from_fn(|k| sum.second[k] * inverse - products[k]),
        };
        (sum.weight, moments)
    }
}

/// Upper triangle of a b', packed.
#[inline(always)]
fn outer<T: Real>(a: [T; 4], b: [T; 4]) -> [T; 10] {
    [
        a[0] * b[0],
        a[0] * b[1],
        a[0] * b[2],
        a[0] * b[3],
        a[1] * b[1],
        a[1] * b[2],
        a[1] * b[3],
        a[2] * b[2],
        a[2] * b[3],
        a[3] * b[3],
    ]
}

/// A source whose acceleration is pulled towards the fused one until its second moment fits `cap` (4.3a).
#[inline(always)]
pub(crate) fn capped<T: Real>(source: &Moments2<T>, fused_acceleration: T, cap: T) -> Moments2<T> {
    let deviation = source.mean[1] - fused_acceleration;
    let moment = source.covariance[2] + deviation * deviation;
    let square = T::select(cap < moment, cap / moment, T::ONE);
    let shrink = square.root();
    Moments2 {
        mean: [source.mean[0], fused_acceleration + shrink * deviation],
        covariance: [source.covariance[0], shrink * source.covariance[1], square * source.covariance[2]],
    }
}
