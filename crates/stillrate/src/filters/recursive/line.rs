//! A straight line through everything so far, old samples weighing less: level and slope without lag on a ramp.
//!
//! With a the age of a sample in nominal periods and Lambda(a) what its weight has shrunk to, S_k = sum Lambda(a) a^k. One period later
//! S2 <- lambda (S2 + 2 S1 + S0), S1 <- lambda (S1 + S0), S0 <- lambda S0 + 1; then D = S0 S2 - S1^2, g1 = S2/D, g2 = S1/D and, with the
//! prediction p = l + s and e = x - p, l <- p + g1 e, s <- s + g2 e: the exponentially weighted least-squares line, exactly.
//! A step of u periods ages by u instead of 1, so irregular samples stay exact as well. Sums of Lambda(a)^2 a^k beside them
//! give the variance of the level in white noise, exactly too.
//! Source: DOI 10.7690/bgzdh.2019.03.009 (order 2); steady state as Brown's double exponential smoothing.

use crate::filter::{Checked, Estimate, Flags, LONGEST_GAP_S};
use crate::real::Real;
use crate::reals;
use crate::sound;

reals! {
    /// State of a weighted line.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::RecursiveLeastSquaresSettings};
    /// let noise = GyroNoise::from_density_two_sided(0.01);
    /// let settings = RecursiveLeastSquaresSettings { order: 2.0, ..Settings::defaults(200.0, noise) };
    /// let filter = settings.build::<f64>()?;
    /// let mut state = filter.start();
    /// for k in 0..50 {
    ///     filter.step(&mut state, Sample { value: 0.5 * f64::from(k), dt: 0.005 });
    /// }
    /// let line = state.line;
    /// assert!((line.level - 24.5).abs() < 1e-11); // a ramp without lag
    /// assert!((line.slope - 0.5).abs() < 1e-12); // a period, not a second
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct LineState {
        /// Level now (of the fitted line, gaps included).
        pub level: T,
        /// Slope per nominal period.
        pub slope: T,
        /// S0, S1, S2.
        pub moments: [T; 3],
        /// The same with squared weights.
        pub squared: [T; 3],
        /// Seconds since the last usable sample.
        pub silent_s: T,
    }
}

/// The two gains of a sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gains<T> {
    pub(crate) level: T,
    pub(crate) slope: T,
    /// Whether a present sample found a line; otherwise there is only a level.
    line: bool,
}

/// What the time before a sample means.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passage<T> {
    /// Nominal periods to move on by.
    pub(crate) periods: T,
    /// Whether everything before was forgotten.
    pub(crate) restart: bool,
}

/// sum a^k one step of `u` periods later, the weights shrunk by `keep`.
#[inline(always)]
fn aged<T: Real>(sums: [T; 3], u: T, keep: T) -> [T; 3] {
    let [s0, s1, s2] = sums;
    [keep * s0, keep * (s1 + u * s0), keep * (s2 + T::TWO * u * s1 + u * u * s0)]
}

impl<T: Real> LineState<T> {
    /// Before the first sample.
    pub(crate) fn start() -> Self {
        let none = [T::ZERO; 3];
        Self { level: T::ZERO, slope: T::ZERO, moments: none, squared: none, silent_s: T::ZERO }
    }

    /// Whether nothing has been seen yet.
    #[inline(always)]
    pub(crate) fn empty(&self) -> bool {
        self.moments[0] == T::ZERO
    }

    /// Whether steps can have left this behind.
    pub(crate) fn sound(&self, period: T) -> bool {
        let [s0, s1, s2] = self.moments;
        let [u0, u1, u2] = self.squared;
        let ages = |[weight, age, square]: [T; 3]| {
            sound::variance(weight)
                && sound::variance(square)
                && sound::within(age, T::ZERO, T::LARGEST)
                && sound::covariance(age, weight, square)
        };
        let longest = T::of(2.001) * T::of(LONGEST_GAP_S).most(T::of(3.0) * period);
        let least = T::TINY.root();
        let seen = s0 >= least && s0 <= T::of(1e18) && u0 >= T::TINY && u0 <= T::of(1.001) * s0.most(s0 * s0);
        // What a line may be carried on to in a gap: its level is a number with as much room as that takes.
        sound::at_most(self.level, T::LARGEST * T::of(1e-10))
            && sound::at_most(self.slope, T::LARGEST.root())
            && ages([s0, s1, s2])
            && ages([u0, u1, u2])
            && (seen || [s0, s1, s2, u0, u1, u2] == [T::ZERO; 6])
            && sound::within(self.silent_s, T::ZERO, longest)
    }

    /// Lets time pass: the periods to move on by, and whether the silence was so long that everything is forgotten.
    #[inline(always)]
    pub(crate) fn pass(&mut self, checked: &Checked<T>, period: T) -> Passage<T> {
        let longest = T::of(LONGEST_GAP_S).most(T::of(3.0) * period);
        let step = T::select(checked.moves, checked.dt, T::ZERO);
        // Nobody follows a line beyond twice the longest gap: time stands still there, whatever dt claims.
        let left = (T::TWO * longest - self.silent_s).most(T::ZERO);
        let nominal = checked.moves && checked.dt == period && left >= period;
        let periods = if nominal { T::ONE } else { step.least(left) / period };
        self.silent_s += step.least(left);
        let restart = checked.present && self.silent_s > longest && !self.empty();
        // The held output stays until the new sample replaces it.
        self.moments = self.moments.map(|sum| T::select(restart, T::ZERO, sum));
        self.squared = self.squared.map(|sum| T::select(restart, T::ZERO, sum));
        self.slope = T::select(restart, T::ZERO, self.slope);
        Passage { periods, restart }
    }

    /// Moves the line on by `u` periods with every old weight multiplied by `keep`.
    #[inline(always)]
    pub(crate) fn age(&mut self, u: T, keep: T) {
        let flushed = |sums: [T; 3]| sums.map(Real::flushed);
        let alive = self.moments[0] > T::ZERO;
        let (moments, squared) = (aged(self.moments, u, keep), aged(self.squared, u, keep * keep));
        // The weight of a filter that has seen data never quite vanishes (see `empty`), nor does its square: what is left of a line
        // that is forgotten is a level as good as one sample.
        let least = T::TINY.root();
        let forgotten = alive && (moments[0] < least || squared[0] < T::TINY);
        let left = |sums: [T; 3], weight: T| {
            let [s0, s1, s2] = flushed(sums);
            [T::select(forgotten, weight, s0), T::select(forgotten, T::ZERO, s1), T::select(forgotten, T::ZERO, s2)]
        };
        self.moments = left(moments, least);
        self.squared = left(squared, T::TINY);
        self.level += u * self.slope;
    }

    /// Takes a sample with innovation `x - level` (the line already moved on to it).
    #[inline(always)]
    pub(crate) fn correct(&mut self, value: T, present: bool) -> Gains<T> {
        let one = T::select(present, T::ONE, T::ZERO);
        self.moments[0] += one;
        self.squared[0] += one;
        let gains = self.gains(present);
        let innovation = value - self.level;
        self.level = (self.level + gains.level * innovation).flushed();
        let slope = (self.slope + gains.slope * innovation).flushed();
        self.slope = T::select(present && !gains.line, T::ZERO, slope);
        self.silent_s = T::select(present, T::ZERO, self.silent_s);
        gains
    }

    /// g1 = S2/D and g2 = S1/D; (1, 0) for a first sample, nothing for a missing one.
    #[inline(always)]
    fn gains(&self, present: bool) -> Gains<T> {
        let [s0, s1, s2] = self.moments;
        let determinant = s0 * s2 - s1 * s1;
        // One sample, or all the others forgotten: no line, only a level.
        let line = s0 > T::ONE && determinant > T::of(16.0) * T::EPSILON * s0 * s2;
        let level = T::select(line, s2 / determinant, T::ONE / s0);
        let slope = T::select(line, s1 / determinant, T::ZERO);
        Gains { level: T::select(present, level, T::ZERO), slope: T::select(present, slope, T::ZERO), line }
    }

    /// Variance of the level over that of one sample, for a straight line in white noise.
    #[inline(always)]
    pub(crate) fn noise_gain(&self) -> T {
        let [s0, s1, s2] = self.moments;
        let inverse = T::ONE / T::select(self.empty(), T::ONE, s0);
        // Mean age and mean square age: all sums over the weight, which may be next to nothing.
        let (age, square) = (s1 * inverse, s2 * inverse);
        let [u0, u1, u2] = self.squared.map(|sum| sum * inverse * inverse);
        let spread = square - age * age;
        let line = spread > T::of(16.0) * T::EPSILON * square;
        let inverse_spread = T::ONE / T::select(line, spread, T::ONE);
        let (by_level, by_slope) = (square * inverse_spread, age * inverse_spread);
        let fitted = by_level * by_level * u0 - T::TWO * by_level * by_slope * u1 + by_slope * by_slope * u2;
        // As weights fall with age, a line is never surer of its end than the mean; rounding may say otherwise.
        T::select(self.empty(), T::ZERO, T::select(line, fitted.most(u0), u0))
    }

    /// The estimate after a sample: the line is followed through a gap for one memory length, then held.
    #[inline(always)]
    pub(crate) fn estimate(
        &self,
        sample_variance: T,
        tau_s: T,
        period: T,
        checked: &Checked<T>,
        restart: bool,
    ) -> Estimate<T> {
        let overdue = (self.silent_s - tau_s).most(T::ZERO) / period;
        let held = self.level - self.slope * overdue;
        let coasting = overdue > T::ZERO;
        Estimate {
            rate: T::select(coasting, held, self.level),
            acceleration: T::select(coasting, T::ZERO, self.slope / period),
            variance: self.noise_gain() * sample_variance,
            flags: Flags(checked.flags.0 & !Flags::RESTARTED.0)
                .with(Flags::RESTARTED.when(restart))
                .with(Flags::NO_DATA_YET.when(self.empty())),
        }
    }
}
