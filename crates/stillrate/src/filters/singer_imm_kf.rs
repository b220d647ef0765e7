//! Singer-IMM-KF: two Singer models, one for rest and one for motion, interacting (Blom and Bar-Shalom 1988).
//!
//! The defaults are those that reproduce the published static figures: alpha .001 and .01 /s, largest acceleration 1.5
//! and 30 deg/s^2, sigma_m^2 = A_max^2 / 3, probability of staying .95 a sample.

use super::singer_imm_model::SingerImmModel;
use crate::block;
use crate::filter::{Checked, Estimate, Filter, Flags, LONGEST_GAP_S, ModelTrace, Observer, Sample};
use crate::gaussian::Gaussian2;
use crate::imm::{judged, mix2, normalised, prior2, shares};
use crate::kalman::{Reading, mix_ahead, update2};
use crate::models::SingerCoefficients;
use crate::plain;
use crate::real::Real;
use crate::reals;
use crate::reals::{Lane, Lanes, Reals};
use crate::sound;

plain! {
    /// Two interacting Singer models.
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::SingerImmKfSettings};
    /// let noise = GyroNoise::from_density_two_sided(0.015);
    /// let filter = SingerImmKfSettings::defaults(50.0, noise).build::<f64>()?;
    /// let mut state = filter.start();
    /// for k in 0..500 {
    ///     filter.step(&mut state, Sample { value: if k % 2 == 0 { 0.1 } else { -0.1 }, dt: 0.02 });
    /// }
    /// assert!(state.weight[0] > state.weight[1]); // at rest
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct SingerImmKf<T> {
        /// Nominal sample period, s.
        pub period_s: T,
        /// The two models.
        pub model: [SingerImmModel<T>; 2],
        /// Probabilities of leaving each model for the other, a sample.
        pub leave: [T; 2],
        /// Probability of the first model before the first sample.
        pub start_probability: T,
        /// Values beyond this magnitude count as missing.
        pub limit: T,
    }
}

reals! {
    /// State of [`SingerImmKf`].
    ///
    /// # Example
    /// ```
    /// use stillrate::{Filter, GyroNoise, Sample, Settings, filters::SingerImmKfSettings};
    /// let filter = SingerImmKfSettings::defaults(50.0, GyroNoise::from_density_two_sided(0.015)).build::<f64>()?;
    /// let mut state = filter.start();
    /// let mut estimate = Default::default();
    /// for value in [0.0, 0.1, -0.1] {
    ///     estimate = filter.step(&mut state, Sample { value, dt: 0.02 });
    /// }
    /// let [rest, motion] = state.weight;
    /// let mean = (rest * state.model[0].mean[0] + motion * state.model[1].mean[0]) / (rest + motion);
    /// assert!((estimate.rate - mean).abs() < 1e-15);
    /// # Ok::<(), stillrate::ConfigError>(())
    /// ```
    pub struct SingerImmKfState {
        /// Rate and acceleration of both models.
        pub model: [Gaussian2<T>; 2],
        /// Their weights: probabilities once divided by their sum.
        pub weight: [T; 2],
        /// 1 once a sample has been seen.
        pub started: T,
    }
}

impl<T: Real> Filter<T> for SingerImmKf<T> {
    type State = SingerImmKfState<T>;

    fn start(&self) -> Self::State {
        SingerImmKfState {
            model: self.model.map(|model| Gaussian2 {
                mean: [T::ZERO; 2],
                covariance: [model.start_variance[0], T::ZERO, model.start_variance[1]],
            }),
            weight: [self.start_probability, T::ONE - self.start_probability],
            started: T::ZERO,
        }
    }

    fn accepts(&self, state: &Self::State) -> bool {
        // What one model gathers the other may carry on.
        let reach = sound::reach(self.model[0].alpha.least(self.model[1].alpha));
        let [first, second] = state.weight;
        state.model.iter().all(|model| sound::gaussian2(model, reach))
            && [first, second].iter().all(|&weight| sound::within(weight, T::ZERO, T::ONE / T::TINY))
            && first + second >= T::TINY
            && sound::flag(state.started)
            && sound::goes_on(self, state, self.limit)
    }

    fn period(&self) -> T {
        self.period_s
    }

    fn models(&self) -> usize {
        2
    }

    #[inline(always)]
    fn step(&self, state: &mut Self::State, sample: Sample<T>) -> Estimate<T> {
        if cfg!(target_arch = "arm") { self.compact(state, sample) } else { self.observe(state, sample, &mut ()) }
    }

    #[inline(always)]
    fn observe<O: Observer<T>>(&self, state: &mut Self::State, sample: Sample<T>, observer: &mut O) -> Estimate<T> {
        let tempo = self.tempo(sample.dt);
        if tempo.ordinary && self.ordinary(state.started, sample.value) {
            self.advance::<true, O>(state, sample, &tempo, observer)
        } else {
            self.advance::<false, O>(state, sample, &tempo, observer)
        }
    }

    #[inline(always)]
    fn tile<const W: usize>(&self, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
        // Without room for the state there is nothing to go on from: the samples are left alone.
        let tile = if lanes.len() < <Self::State as Reals<T>>::COUNT { &mut [] } else { tile };
        let tempo = self.tempo(dt);
        let mut state: SingerImmKfState<Lane<T, W>> = block::load_wide(lanes);
        for row in tile {
            let mut ordinary = tempo.ordinary;
            for c in 0..W {
                ordinary &= self.ordinary(state.started.0[c], row[c]);
            }
            if ordinary {
                self.row::<true, W>(&mut state, row, dt, &tempo);
            } else {
                self.row::<false, W>(&mut state, row, dt, &tempo);
            }
        }
        block::store_wide(&state, lanes);
    }
}

/// What follows from the length of a step alone: the same for every channel.
#[derive(Clone, Copy)]
struct Tempo<T> {
    /// Coefficients of both models.
    step: [SingerCoefficients<T>; 2],
    /// Transition probabilities `[from][to]`.
    transition: [[T; 2]; 2],
    /// Whether time moves by a usable step.
    ordinary: bool,
}

impl<T: Real> SingerImmKf<T> {
    #[inline(always)]
    fn tempo(&self, dt: T) -> Tempo<T> {
        let [first, second] = self.leave;
        let transition = [[T::ONE - first, first], [second, T::ONE - second]];
        if dt == self.period_s {
            return Tempo {
                step: [self.model[0].step, self.model[1].step],
                transition,
                ordinary: dt <= T::of(LONGEST_GAP_S),
            };
        }
        let checked = Sample { value: T::ZERO, dt }.check(self.limit, self.period_s);
        let dt = T::select(checked.restart, self.period_s, checked.dt);
        Tempo { transition, step: self.model.map(|model| model.over(dt)), ordinary: checked.moves && !checked.restart }
    }

    /// Whether nothing needs care: the filter runs and the sample is usable.
    #[inline(always)]
    fn ordinary(&self, started: T, value: T) -> bool {
        (started != T::ZERO) & (value.magnitude() <= self.limit)
    }

    #[inline(always)]
    fn row<const ORDINARY: bool, const W: usize>(
        &self,
        state: &mut SingerImmKfState<Lane<T, W>>,
        row: &mut [T; W],
        dt: T,
        tempo: &Tempo<T>,
    ) {
        for c in 0..W {
            let mut one = state.lane(c);
            row[c] = self.advance::<ORDINARY, ()>(&mut one, Sample { value: row[c], dt }, tempo, &mut ()).rate;
            state.set_lane(c, one);
        }
    }

    /// One sample; free of branches, so that a loop over channels becomes vector instructions. `ORDINARY` promises
    /// that nothing needs care: every select is then decided at compile time.
    #[inline(always)]
    fn advance<const ORDINARY: bool, O: Observer<T>>(
        &self,
        state: &mut SingerImmKfState<T>,
        sample: Sample<T>,
        tempo: &Tempo<T>,
        observer: &mut O,
    ) -> Estimate<T> {
        let mut checked = sample.check(self.limit, self.period_s);
        if ORDINARY {
            let Sample { value, dt } = sample;
            checked = Checked { value, present: true, moves: true, dt, restart: false, flags: Flags::NONE };
        }
        if !ORDINARY {
            state.started = checked.known(state.started);
        }
        let started = ORDINARY || state.started != T::ZERO;
        let begins = checked.present && (!started || checked.restart);
        let start = self.start();
        let models: [Gaussian2<T>; 2] = core::array::from_fn(|i| {
            let (old, new) = (&state.model[i], &start.model[i]);
            Gaussian2 {
                mean: [T::select(begins, checked.value, old.mean[0]), T::select(begins, T::ZERO, old.mean[1])],
                covariance: core::array::from_fn(|k| T::select(begins, new.covariance[k], old.covariance[k])),
            }
        });
        let weight: [T; 2] = core::array::from_fn(|i| T::select(begins, start.weight[i], state.weight[i]));
        let share = shares(&tempo.transition, &weight);
        let prior = prior2(&tempo.transition, &normalised(&weight));
        let mut next = models;
        let (mut exponent, mut factor) = ([T::ZERO; 2], [T::ONE; 2]);
        let mut traces = [ModelTrace::default(); 2];
        for i in 0..2 {
            let model = &self.model[i];
            let predicted = mix_ahead([share[i], T::ONE - share[i]], &models[0], &models[1], &tempo.step[i]);
            let (updated, evidence) = update2(&predicted, &Reading::plain(checked.value, model.measurement_variance));
            next[i] = Gaussian2 {
                mean: core::array::from_fn(|k| {
                    T::select(checked.present, updated.mean[k], predicted.mean[k]).flushed()
                }),
                covariance: core::array::from_fn(|k| {
                    T::select(checked.present, updated.covariance[k], predicted.covariance[k])
                }),
            };
            // A missing sample leaves the prior.
            exponent[i] = T::select(checked.present, evidence.exponent, T::ZERO);
            factor[i] = T::select(checked.present, evidence.factor, T::ONE);
            traces[i] = ModelTrace {
                probability: T::ZERO,
                innovation: T::select(checked.present, evidence.innovation, T::of(f64::NAN)),
                innovation_variance: evidence.innovation_variance,
                fading: T::ONE,
                alpha: model.alpha,
                rate: next[i].mean[0],
            };
        }
        let posterior = judged(&prior, &exponent, &factor);
        let runs = checked.moves && (begins || started);
        for i in 0..2 {
            let (new, old) = (&next[i], state.model[i]);
            state.model[i] = Gaussian2 {
                mean: core::array::from_fn(|k| T::select(runs, new.mean[k], old.mean[k])),
                covariance: core::array::from_fn(|k| T::select(runs, new.covariance[k], old.covariance[k])),
            };
            state.weight[i] = T::select(runs, posterior[i], state.weight[i]);
        }
        let probability = normalised(&state.weight);
        for i in 0..2 {
            observer.model(i, ModelTrace { probability: probability[i], ..traces[i] });
        }
        state.started = T::select(begins, T::ONE, state.started);
        let fused = mix2(probability[0], &state.model[0], &state.model[1]);
        Estimate {
            rate: fused.mean[0],
            acceleration: fused.mean[1],
            variance: fused.covariance[0],
            flags: checked.flags.with(Flags::NO_DATA_YET.when(!started && !begins)),
        }
    }
}
