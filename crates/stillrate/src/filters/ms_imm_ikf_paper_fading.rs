//! How the published MS-IMM-IKF fades: what its settings make of the fading factor, and how far it may go.

use super::ms_imm_ikf_paper::MsImmIkfPaper;
use crate::adaptive::fading::{FadingForm, FadingGate, FadingSource, fading_factor};
use crate::models::modified_singer::Prediction3;
use crate::real::Real;

/// The choices are stored as numbers, so that no bit pattern from another language can be invalid.
impl<T: Real> MsImmIkfPaper<T> {
    #[inline(always)]
    fn form(&self) -> FadingForm {
        match self.form {
            0 => FadingForm::None,
            1 => FadingForm::Absolute,
            _ => FadingForm::Signed,
        }
    }

    #[inline(always)]
    fn source(&self) -> FadingSource {
        match self.source {
            0 => FadingSource::Measurement,
            1 => FadingSource::Innovation,
            _ => FadingSource::Windowed,
        }
    }

    #[inline(always)]
    fn gate(&self) -> FadingGate {
        match self.gate {
            0 => FadingGate::Always,
            1 => FadingGate::WhileMoving,
            _ => FadingGate::SecondModelWhileMoving,
        }
    }

    /// lambda of model `i` at a sample; 1 where there is none. The windowed form keeps its mean square in `window`.
    #[inline(always)]
    pub(super) fn fading(
        &self,
        i: usize,
        prediction: &Prediction3<T>,
        (value, present): (T, bool),
        at_rest: bool,
        window: &mut T,
    ) -> T {
        let variance = self.model[i].measurement_variance;
        let (delta, softened) = match self.source() {
            FadingSource::Measurement => (value * value, variance),
            FadingSource::Innovation => (square(value - prediction.mean[0]), variance),
            FadingSource::Windowed => {
                // A missing sample has no innovation.
                let followed = self.windowed(*window, square(value - prediction.mean[0]));
                *window = T::select(present, followed, *window);
                (*window, self.fading_softening * variance)
            }
        };
        let delta = self.fading_scale * delta;
        let wanted = fading_factor(self.form(), delta, prediction.carried[0], prediction.noise[0], softened);
        let acts = present && self.gate().opens(at_rest, i);
        T::select(acts, self.bounded(wanted, prediction.carried[3]), T::ONE)
    }

    /// The mean square with one more square; below 0 before the first.
    #[inline(always)]
    fn windowed(&self, mean_square: T, now: T) -> T {
        let followed = (self.fading_memory * mean_square + now) / (T::ONE + self.fading_memory);
        T::select(mean_square < T::ZERO, now, followed)
    }

    /// A fading factor that leaves the acceleration within a swing from rail to rail in one period. Fading acts on what a measurement of the
    /// rate hardly reduces; a row of wild samples would otherwise make it overflow. Not where it also multiplies the variance of alpha:
    /// that is the filter as printed.
    #[inline(always)]
    fn bounded(&self, wanted: T, acceleration_variance: T) -> T {
        let swing = self.limit / self.period_s;
        let most = T::select(self.fades_alpha == 1, T::LARGEST, swing * swing / acceleration_variance);
        wanted.least(most.most(T::ONE))
    }
}

#[inline(always)]
fn square<T: Real>(x: T) -> T {
    x * x
}
