//! Kalman filter on an autoregressive model of the signal.
//!
//! x_k = phi_1 x_(k-1) + ... + phi_p x_(k-p) + w_k, z_k = x_k + v_k, with variances Q and R: state (x_k, ..., x_(k-p+1)), companion
//! transition, measurement of the first component. Coefficients come from Yule-Walker or Burg fits (`stillrate_lab::tune`).
//!
//! The default is fitted to a published comparison (MEMS gyro denoising with a modified Singer model): at rest the order
//! criterion picks p = 1 with phi = 0.0004, and R = 0.768 Q reproduces its noise reduction of 1.77. That filter is
//! output = K z with K = 0.566: it attenuates true motion exactly as much as noise. It is there to be compared with.

use crate::filter::{Estimate, Filter, Observer, Sample};
use crate::plain;
use crate::real::Real;
use crate::reals;
use crate::sound;

/// Highest order of [`ArKf`].
pub const HIGHEST_ORDER: usize = 8;
/// Sample periods that a gap is predicted over at most; a stationary model has little left to say by then.
const LONGEST_PREDICTION: usize = 64;

plain! {
    /// Kalman filter on a stationary autoregressive model of order 1 to 8; the first sample starts it.
    ///
    /// A missing sample is predicted over. An irregular time step counts as the nearest whole number of sample periods (at least
    /// one, at most 64), because the coefficients are tied to the sample rate.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::ArKfSettings};
    /// let filter = ArKfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015)).build::<f64>()?;
    /// let mut state = filter.start();
    /// for _ in 0..100 {
    ///     filter.step(&mut state, Sample { value: 1.0, dt: 0.02 });
    /// }
    /// assert!((state.lags[0] * filter.unit - 0.566).abs() < 0.001); // the published preset is a plain gain
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct ArKf<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// phi_1, phi_2, ...; zero beyond the order.
        pub coefficients: [T; HIGHEST_ORDER],
        /// Q / R.
        pub drive: T,
        /// Square root of R, deg/s: the unit that the state is kept in.
        pub unit: T,
        /// Values beyond this magnitude count as missing.
        pub limit: T,
    }
}

reals! {
    /// State of [`ArKf`], in units of the measurement standard deviation.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::ArKfSettings};
    /// let mut settings = ArKfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015));
    /// settings.coefficients[0] = 0.9;
    /// let filter = settings.build::<f64>()?;
    /// let mut state = filter.start();
    /// filter.step(&mut state, Sample { value: 1.0, dt: 0.02 });
    /// let known = state;
    /// for _ in 0..10 {
    ///     filter.step(&mut state, Sample { value: f64::NAN, dt: 0.02 });
    /// }
    /// assert!((state.lags[0] / known.lags[0] - 0.9_f64.powi(10)).abs() < 1e-12); // back to the mean, phi a period
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct ArKfState {
        /// x_k, x_(k-1), ...
        pub lags: [T; HIGHEST_ORDER],
        /// Covariance, symmetric.
        pub covariance: [[T; HIGHEST_ORDER]; HIGHEST_ORDER],
        /// 1 once a sample has been seen.
        pub started: T,
    }
}

impl<T: Real> ArKf<T> {
    /// Lags and covariance one sample period later: everything moves down a place, the first row is the model's.
    #[inline(always)]
    fn predict(&self, state: &ArKfState<T>) -> ArKfState<T> {
        let dot = |row: &[T; HIGHEST_ORDER]| {
            let mut sum = T::ZERO;
            for (&coefficient, &number) in self.coefficients.iter().zip(row) {
                sum += coefficient * number;
            }
            sum
        };
        let of_rows: [T; HIGHEST_ORDER] = core::array::from_fn(|i| dot(&state.covariance[i]));
        let mut next = *state;
        for i in 1..HIGHEST_ORDER {
            next.lags[i] = state.lags[i - 1];
            next.covariance[0][i] = of_rows[i - 1];
            next.covariance[i][0] = of_rows[i - 1];
            for j in 1..HIGHEST_ORDER {
                next.covariance[i][j] = state.covariance[i - 1][j - 1];
            }
        }
        next.lags[0] = dot(&state.lags);
        next.covariance[0][0] = dot(&of_rows) + self.drive;
        next
    }

    /// Update with a measurement of the first lag (Joseph's form).
    #[inline(always)]
    fn update(state: &ArKfState<T>, value: T) -> ArKfState<T> {
        let first = state.covariance[0];
        let innovation_variance = first[0] + T::ONE;
        let innovation = value - state.lags[0];
        let gain: [T; HIGHEST_ORDER] = core::array::from_fn(|i| first[i] / innovation_variance);
        let mut next = *state;
        for i in 0..HIGHEST_ORDER {
            next.lags[i] = (state.lags[i] + gain[i] * innovation).flushed();
            for j in i..HIGHEST_ORDER {
                let both = gain[i] * first[j] + gain[j] * first[i];
                let number = (state.covariance[i][j] - both + gain[i] * gain[j] * innovation_variance).flushed();
                next.covariance[i][j] = number;
                next.covariance[j][i] = number;
            }
        }
        next
    }

    /// Every lag at `value`, uncorrelated, as uncertain as one measurement.
    #[inline(always)]
    fn at(value: T, started: T) -> ArKfState<T> {
        let mut covariance = [[T::ZERO; HIGHEST_ORDER]; HIGHEST_ORDER];
        for i in 0..HIGHEST_ORDER {
            covariance[i][i] = T::ONE;
        }
        ArKfState { lags: [value; HIGHEST_ORDER], covariance, started }
    }
}

/// One state or the other, number by number.
#[inline(always)]
fn choose<T: Real>(condition: bool, yes: &ArKfState<T>, no: &ArKfState<T>) -> ArKfState<T> {
    ArKfState {
        lags: core::array::from_fn(|i| T::select(condition, yes.lags[i], no.lags[i])),
        covariance: core::array::from_fn(|i| {
            core::array::from_fn(|j| T::select(condition, yes.covariance[i][j], no.covariance[i][j]))
        }),
        started: T::select(condition, yes.started, no.started),
    }
}

impl<T: Real> Filter<T> for ArKf<T> {
    type State = ArKfState<T>;
    const SIDE_BY_SIDE: bool = false;

    fn start(&self) -> ArKfState<T> {
        Self::at(T::ZERO, T::ZERO)
    }

    fn accepts(&self, state: &ArKfState<T>) -> bool {
        let p = &state.covariance;
        let pairs = (0..HIGHEST_ORDER).all(|i| {
            (0..i).all(|j| p[i][j] == p[j][i] && sound::covariance(p[i][j], p[i][i], p[j][j]))
                && sound::variance(p[i][i] * (self.unit * self.unit).most(T::ONE))
        });
        let lags = state.lags.iter().all(|&lag| sound::mean(lag * self.unit.most(T::ONE)));
        pairs && lags && sound::flag(state.started)
    }

    fn period(&self) -> T {
        self.period_s
    }

    #[inline(always)]
    fn observe<O: Observer<T>>(&self, state: &mut ArKfState<T>, sample: Sample<T>, _observer: &mut O) -> Estimate<T> {
        let checked = sample.check(self.limit, self.period_s);
        state.started = checked.known(state.started);
        let value = checked.value / self.unit;
        // The time step is the same for every channel, so this loop does not part them.
        let mut predicted = self.predict(state);
        let mut covered = self.period_s * T::of(1.5);
        for _ in 1..LONGEST_PREDICTION {
            if checked.dt < covered {
                break;
            }
            predicted = self.predict(&predicted);
            covered += self.period_s;
        }
        let updated = Self::update(&predicted, value);

        let mut sum = T::ZERO;
        for i in 0..HIGHEST_ORDER {
            sum += updated.lags[i] + predicted.lags[i];
            for j in 0..HIGHEST_ORDER {
                sum += updated.covariance[i][j] + predicted.covariance[i][j];
            }
        }
        let sound = sum.finite();
        let fresh = state.started == T::ZERO || checked.restart;
        let present = choose(fresh || !sound, &Self::at(value, T::ONE), &updated);
        let coasted = choose(checked.moves && !fresh, &predicted, state);
        let absent = choose(sound, &coasted, &self.start());
        *state = choose(checked.present, &present, &absent);
        Estimate {
            rate: state.lags[0] * self.unit,
            acceleration: T::ZERO,
            variance: state.covariance[0][0] * self.unit * self.unit,
            flags: checked.flags_after(state.started, sound),
        }
    }
}
