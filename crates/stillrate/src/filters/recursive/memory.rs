//! How long the past counts: `tau_s` in seconds or `forgetting_factor` a sample, always both and always consistent.
//!
//! lambda = exp(-T / tau) with T the sample period; lambda = 1 is an endless memory (tau infinite).

use crate::error::ConfigError;
use crate::filter::Checked;
use crate::ranges::FORGETTING_FACTOR;
use crate::real::Real;
use crate::settings::Visit;

/// A memory, as a user may give it: by `tau_s`, by `forgetting_factor`, or by both if they agree.
#[derive(Debug)]
pub(crate) struct Memory<'a> {
    pub(crate) sample_rate_hz: f64,
    pub(crate) tau_s: &'a mut f64,
    pub(crate) forgetting_factor: &'a mut f64,
}

/// lambda of a memory of `tau_s` seconds at a sample rate.
pub(crate) fn factor_of(tau_s: f64, sample_rate_hz: f64) -> f64 {
    (-1.0 / (tau_s * sample_rate_hz)).exponential()
}

/// tau in seconds of a forgetting factor at a sample rate.
pub(crate) fn tau_of(forgetting_factor: f64, sample_rate_hz: f64) -> f64 {
    if forgetting_factor == 1.0 { f64::INFINITY } else { -1.0 / (forgetting_factor.logarithm() * sample_rate_hz) }
}

/// Whether lambda is a forgetting factor: above 0 and at most 1.
fn usable(forgetting_factor: f64) -> bool {
    forgetting_factor > 0.0 && forgetting_factor <= 1.0
}

/// Shows both to a visitor; where it changes only one, the other follows.
pub(crate) fn visit_memory<V: Visit>(visitor: &mut V, memory: &mut Memory<'_>) {
    let (tau_before, factor_before) = (*memory.tau_s, *memory.forgetting_factor);
    visitor.number("tau_s", memory.tau_s);
    visitor.number("forgetting_factor", memory.forgetting_factor);
    let tau_given = *memory.tau_s != tau_before;
    let factor_given = *memory.forgetting_factor != factor_before;
    if factor_given && !tau_given && usable(*memory.forgetting_factor) {
        *memory.tau_s = tau_of(*memory.forgetting_factor, memory.sample_rate_hz);
    } else if tau_given && !factor_given && *memory.tau_s > 0.0 {
        *memory.forgetting_factor = factor_of(*memory.tau_s, memory.sample_rate_hz);
    }
}

/// How fast a running filter forgets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Forgetting<T> {
    /// Nominal sample period, s.
    pub(crate) period_s: T,
    /// 1 - lambda over that period.
    pub(crate) loss: T,
    /// Memory, s.
    pub(crate) tau_s: T,
}

impl<T: Real> Forgetting<T> {
    /// 1 - lambda over the step that passed, which with `NOMINAL` is the nominal one; 0 where no time did.
    #[inline(always)]
    pub(crate) fn loss_over<const NOMINAL: bool>(&self, checked: &Checked<T>) -> T {
        let loss = if NOMINAL || checked.dt == self.period_s {
            self.loss
        } else {
            -(-checked.dt / self.tau_s).exponential_less_one()
        };
        T::select(checked.moves, loss, T::ZERO)
    }
}

/// Checks both against each other; gives lambda.
pub(crate) fn check_memory(tau_s: f64, forgetting_factor: f64, sample_rate_hz: f64) -> Result<f64, ConfigError> {
    let factor = FORGETTING_FACTOR.check("forgetting_factor", forgetting_factor)?;
    // What remains after rounding either to nine digits.
    let disagreement = (factor_of(tau_s, sample_rate_hz) - factor).abs();
    if disagreement <= 1e-9 {
        Ok(factor)
    } else {
        let range = "exp(-1 / (tau_s * sample_rate_hz)): give one of the two, or both in agreement";
        Err(ConfigError::new("forgetting_factor", forgetting_factor, "", range))
    }
}
