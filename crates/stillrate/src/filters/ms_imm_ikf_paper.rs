//! MS-IMM-IKF as published: two modified Singer models with alpha as a state, interacting, with a fading factor.
//!
//! Per sample: mix -> predict with r, s, Q at the mixed alpha -> fade P^- = lambda F P F' + Q -> update -> weigh -> fuse. State
//! (rate, acceleration, alpha), H = (1, 0, 0), sigma_w^2 = 2 alpha sigma_m^2, sigma_m^2 = A_max^2 / 3.
//!
//! Erratum (eq. 23): the printed P(k|k-1) stands for x(k|k-1) = F x0. Erratum: lambda >= 1 on all of P multiplies the variance of
//! alpha, which no measurement reduces, so the printed filter overflows by itself; that is reported by
//! [`Flags::DIVERGED`], and the filter starts anew at that sample. Where lambda leaves alpha alone, it is bounded so that this cannot
//! happen. What the paper leaves open is a setting.

use crate::filter::{Estimate, Filter, Flags, ModelTrace, Observer, Sample};
use crate::gaussian::Gaussian3;
use crate::imm::{interact, mix3, weigh2};
use crate::kalman::{Reading, update3};
use crate::models::modified_singer::{Parameter, alpha_of, predict_modified};
use crate::plain;
use crate::real::Real;
use crate::reals;
use crate::sound;

plain! {
    /// One model of the pair.
    ///
    /// # Example
    /// ```
    /// use stillrate::{GyroNoise, Settings, filters::MsImmIkfPaperSettings};
    /// let noise = GyroNoise::from_standard_deviation_at_rate(0.1074, 50.0);
    /// let [rest, motion] = MsImmIkfPaperSettings::defaults(50.0, noise).build::<f64>()?.model;
    /// assert_eq!((rest.parameter, motion.parameter), (0.001, 0.01)); // alpha, 1/s
    /// assert_eq!((rest.acceleration_variance, motion.acceleration_variance), (0.75, 300.0)); // A_max^2 / 3
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct PaperModel<T> {
        /// alpha (or its logarithm) at the start.
        pub parameter: T,
        /// sigma_m^2.
        pub acceleration_variance: T,
        /// R.
        pub measurement_variance: T,
        /// Density of the third state's random walk.
        pub alpha_noise: T,
        /// Variances of the three states at the first sample.
        pub start_variance: [T; 3],
    }
}

impl<T: Real> PaperModel<T> {
    pub(crate) const NONE: Self = Self {
        parameter: T::ZERO,
        acceleration_variance: T::ONE,
        measurement_variance: T::ONE,
        alpha_noise: T::ZERO,
        start_variance: [T::ONE; 3],
    };
}

plain! {
    /// The published filter; build it from [`MsImmIkfPaperSettings`](super::MsImmIkfPaperSettings).
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, Flags, GyroNoise, Sample, Settings, filters::MsImmIkfPaperSettings};
    /// let noise = GyroNoise::from_standard_deviation_at_rate(0.1074, 50.0);
    /// let filter = MsImmIkfPaperSettings::defaults(50.0, noise).build::<f64>()?;
    /// let mut state = filter.start();
    /// let estimate = filter.step(&mut state, Sample { value: 0.03, dt: 0.02 });
    /// assert!(estimate.rate.is_finite() && !estimate.flags.has(Flags::DIVERGED));
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct MsImmIkfPaper<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// The two models.
        pub model: [PaperModel<T>; 2],
        /// Transition probabilities `[from][to]` a sample.
        pub transition: [[T; 2]; 2],
        /// The same while rest is declared.
        pub static_transition: [[T; 2]; 2],
        /// Probabilities before the first sample.
        pub start_probability: [T; 2],
        /// alpha3.
        pub static_alpha: T,
        /// Factor of the square in Delta.
        pub fading_scale: T,
        /// Forgetting factor of the windowed form.
        pub fading_memory: T,
        /// Softening of R in the windowed form.
        pub fading_softening: T,
        /// Values beyond this magnitude count as missing.
        pub limit: T,
        /// 1 where alpha is mixed.
        pub shares_alpha: u32,
        /// 1 where lambda multiplies the third row and column.
        pub fades_alpha: u32,
        /// 1 where the Jacobian knows how the prediction depends on alpha.
        pub exact_jacobian: u32,
        /// 1 where the third state is the logarithm of alpha.
        pub logarithmic: u32,
        /// How lambda is computed: 0 not at all, 1 with |C|, else with C.
        pub form: u32,
        /// What Delta is made of: 0 the measurement, 1 the innovation, else its windowed mean square.
        pub source: u32,
        /// When lambda acts: 0 always, 1 while moving, else in the second model while moving.
        pub gate: u32,
    }
}

reals! {
    /// State of [`MsImmIkfPaper`].
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::MsImmIkfPaperSettings};
    /// let noise = GyroNoise::from_standard_deviation_at_rate(0.1074, 50.0);
    /// let filter = MsImmIkfPaperSettings::defaults(50.0, noise).build::<f64>()?;
    /// let mut state = filter.start();
    /// for k in 0..200 {
    ///     filter.step(&mut state, Sample { value: 20.0 * (0.1 * f64::from(k)).sin(), dt: 0.02 });
    /// }
    /// assert!((state.probability[0] + state.probability[1] - 1.0).abs() < 1e-12);
    /// assert_eq!(state.model[1].mean[2], 0.01); // no measurement ever moves the printed alpha
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct MsImmIkfPaperState {
        /// Both models.
        pub model: [Gaussian3<T>; 2],
        /// Their probabilities.
        pub probability: [T; 2],
        /// Windowed innovation squares; below 0 before the first.
        pub window: [T; 2],
        /// 1 once a sample has been seen.
        pub started: T,
    }
}

impl<T: Real> MsImmIkfPaper<T> {
    /// How the third state acts.
    #[inline(always)]
    fn parameter(&self) -> Parameter {
        Parameter { exact_jacobian: self.exact_jacobian == 1, logarithmic: self.logarithmic == 1 }
    }

    fn start_at(&self, rate: T) -> MsImmIkfPaperState<T> {
        MsImmIkfPaperState {
            model: self.model.map(|model| Gaussian3 {
                mean: [rate, T::ZERO, model.parameter],
                covariance: [
                    model.start_variance[0],
                    T::ZERO,
                    T::ZERO,
                    model.start_variance[1],
                    T::ZERO,
                    model.start_variance[2],
                ],
            }),
            probability: self.start_probability,
            window: [-T::ONE; 2],
            started: T::ZERO,
        }
    }

    /// Mixes for target `i`; a private alpha keeps its own row and column.
    #[inline(always)]
    fn mix(&self, models: &[Gaussian3<T>; 2], weight: T, i: usize) -> Gaussian3<T> {
        let mixed = mix3(weight, &models[0], &models[1]);
        if self.shares_alpha == 1 {
            return mixed;
        }
        let own = &models[i];
        let [m0, m1, _] = mixed.mean;
        let [p00, p01, _, p11, _, _] = mixed.covariance;
        let [_, _, p02, _, p12, p22] = own.covariance;
        Gaussian3 { mean: [m0, m1, own.mean[2]], covariance: [p00, p01, p02, p11, p12, p22] }
    }

    /// The whole cycle with a usable time step; `present` says whether there is a value.
    #[inline(always)]
    fn cycle(&self, s: &mut MsImmIkfPaperState<T>, value: T, present: bool, dt: T) -> [ModelTrace<T>; 2] {
        let alpha = |i: usize, models: &[Gaussian3<T>; 2]| alpha_of(models[i].mean[2], self.parameter(), dt);
        let mean_alpha = s.probability[0] * alpha(0, &s.model) + s.probability[1] * alpha(1, &s.model);
        let at_rest = mean_alpha <= self.static_alpha;
        let transition = if at_rest { &self.static_transition } else { &self.transition };
        let (prior, weight) = interact(transition, &s.probability);
        let models = s.model;
        let (mut exponent, mut factor) = ([T::ZERO; 2], [T::ONE; 2]);
        let mut traces = [ModelTrace::default(); 2];
        for i in 0..2 {
            let model = &self.model[i];
            let mixed = self.mix(&models, weight[i], i);
            let prediction =
                predict_modified(&mixed, self.parameter(), model.acceleration_variance, model.alpha_noise, dt);
            let fading = self.fading(i, &prediction, (value, present), at_rest, &mut s.window[i]);
            let predicted = prediction.faded(fading, self.fades_alpha == 1);
            let (updated, evidence) = update3(&predicted, &Reading::plain(value, model.measurement_variance));
            let kept = if present { updated } else { predicted };
            s.model[i] = Gaussian3 { mean: kept.mean.map(Real::flushed), covariance: kept.covariance };
            exponent[i] = evidence.exponent;
            factor[i] = evidence.factor;
            traces[i] = ModelTrace {
                probability: T::ZERO,
                innovation: T::select(present, evidence.innovation, T::of(f64::NAN)),
                innovation_variance: evidence.innovation_variance,
                fading,
                alpha: T::select(self.logarithmic == 1, alpha(i, &s.model), s.model[i].mean[2]),
                rate: s.model[i].mean[0],
            };
        }
        s.probability = weigh2(&prior, &exponent, &factor, present).map(Real::flushed);
        traces[0].probability = s.probability[0];
        traces[1].probability = s.probability[1];
        traces
    }
}

impl<T: Real> Filter<T> for MsImmIkfPaper<T> {
    type State = MsImmIkfPaperState<T>;
    const SIDE_BY_SIDE: bool = false;

    fn start(&self) -> Self::State {
        self.start_at(T::ZERO)
    }

    fn accepts(&self, state: &Self::State) -> bool {
        state.model.iter().all(|model| sound::finite(&model.mean, &model.covariance, &[0, 3, 5]))
            && sound::probabilities(state.probability.into_iter())
            && state.window.iter().all(|&mean_square| sound::within(mean_square, -T::ONE, T::LARGEST))
            && sound::flag(state.started)
    }

    fn period(&self) -> T {
        self.period_s
    }

    fn models(&self) -> usize {
        2
    }

    #[inline(always)]
    fn observe<O: Observer<T>>(&self, state: &mut Self::State, sample: Sample<T>, observer: &mut O) -> Estimate<T> {
        let checked = sample.check(self.limit, self.period_s);
        state.started = checked.known(state.started);
        let mut flags = checked.flags;
        let mut next = *state;
        if checked.present && (state.started == T::ZERO || checked.restart) {
            next = self.start_at(checked.value);
            next.started = T::ONE;
        }
        let mut fused = mix3(next.probability[0], &next.model[0], &next.model[1]);
        if checked.moves && next.started != T::ZERO {
            let dt = T::select(checked.restart, self.period_s, checked.dt);
            let mut traces = self.cycle(&mut next, checked.value, checked.present, dt);
            fused = mix3(next.probability[0], &next.model[0], &next.model[1]);
            let finite = fused.mean.iter().chain(&fused.covariance).all(|number| number.finite());
            let sound = finite && fused.covariance[0] >= T::ZERO;
            if !sound {
                // The best that is left is the sample itself, or the last rate where there is none.
                let last = mix3(state.probability[0], &state.model[0], &state.model[1]).mean[0];
                next = self.start_at(T::select(checked.present, checked.value, last));
                next.started = T::ONE;
                fused = mix3(next.probability[0], &next.model[0], &next.model[1]);
                flags = flags.with(Flags::DIVERGED);
                for (i, trace) in traces.iter_mut().enumerate() {
                    *trace = ModelTrace {
                        probability: next.probability[i],
                        fading: T::ONE,
                        rate: next.model[i].mean[0],
                        alpha: T::ZERO,
                        ..ModelTrace::default()
                    };
                }
            }
            for (i, trace) in traces.into_iter().enumerate() {
                observer.model(i, trace);
            }
        }
        *state = next;
        Estimate {
            rate: fused.mean[0],
            acceleration: fused.mean[1],
            variance: fused.covariance[0],
            flags: flags.with(Flags::NO_DATA_YET.when(state.started == T::ZERO)),
        }
    }
}
