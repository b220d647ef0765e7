//! The rate controller with its angle loop, one tick at a time.
//!
//! With y the gyro sample (rad/s), w = F(y) the filtered rate and T the control period:
//! angle estimate th += T (y_k + y_(k-1))/2 from the RAW rate (or from w), plus T/tau_i (inclinometer - th) where there is one;
//! demand r = clamp(Ko (th_ref - th), +-rmax); e = r - w;
//! us = Ke n [kappa (e + I) - kd (w_k - w_(k-1))/T]; u = clamp(us, +-Vmax); I += T Kvi e unless u is at a limit and us e >= 0.
//! Integrating an adaptive filter's output as the only angle source loses slow motion; the raw rate is the default.

use stillrate::error::{ConfigError, not_negative, positive};

/// Gains and limits.
///
/// # Example
/// ```
/// use stillrate_lab::servo::{controller::Controller, plant::Plant, platform::Platform};
/// let gains = Controller { kvi_per_s: -1.0, ..Controller::default() };
/// let refused = Platform::new(Plant::platform_30kg(), gains, 50.0, 1e-3, 5e-3).unwrap_err();
/// assert!(refused.to_string().contains("kvi_per_s = -1"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller {
    /// kappa: gain of the rate loop at DC, relative to Ke n.
    pub kappa: f64,
    /// Ko: angle gain, 1/s.
    pub ko_per_s: f64,
    /// Kvi: gain of the rate integral, 1/s.
    pub kvi_per_s: f64,
    /// kd: rate derivative, s.
    pub kd_s: f64,
    /// Largest rate demand, rad/s.
    pub rate_demand_max_rad_s: f64,
    /// Whether the angle is integrated from the filtered rate (default: from the raw rate).
    pub angle_from_filtered: bool,
    /// Time constant of the correction by an inclinometer, s (0: none).
    pub inclinometer_time_s: f64,
}

impl Default for Controller {
    /// Gains for the 30 kg platform without a filter at 50 Hz.
    fn default() -> Self {
        Self {
            kappa: 0.179,
            ko_per_s: 0.3,
            kvi_per_s: 72.7,
            kd_s: 0.65e-3,
            rate_demand_max_rad_s: 1.2,
            angle_from_filtered: false,
            inclinometer_time_s: 0.0,
        }
    }
}

/// What the controller remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ControllerState {
    /// Estimated angle, rad.
    pub(crate) angle: f64,
    /// I, rad/s.
    integral: f64,
    last_raw: f64,
    last_filtered: f64,
    started: bool,
}

impl ControllerState {
    /// At the start: the angle is known, everything else is 0.
    pub(crate) fn at_angle(angle: f64) -> Self {
        Self { angle, ..Self::default() }
    }
}

impl Controller {
    /// Checks gains and limits.
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        not_negative("kappa", self.kappa, "")?;
        not_negative("ko_per_s", self.ko_per_s, "1/s")?;
        not_negative("kvi_per_s", self.kvi_per_s, "1/s")?;
        not_negative("kd_s", self.kd_s, "s")?;
        positive("rate_demand_max_rad_s", self.rate_demand_max_rad_s, "rad/s")?;
        not_negative("inclinometer_time_s", self.inclinometer_time_s, "s")?;
        Ok(())
    }

    /// The same with proportional and derivative gain times `factor`: the gain margin's test.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self { kappa: self.kappa * factor, kd_s: self.kd_s * factor, ..self }
    }

    /// One tick: raw and filtered rate (rad/s) in, voltage (V) out. `inclination` (rad) is used where an inclinometer is configured.
    #[inline]
    pub(crate) fn tick(
        &self,
        state: &mut ControllerState,
        raw: f64,
        filtered: f64,
        inclination: f64,
        drive: Drive,
        period_s: f64,
    ) -> f64 {
        if !state.started {
            (state.last_raw, state.last_filtered) = (raw, filtered);
        } else if self.angle_from_filtered {
            state.angle += period_s * 0.5 * (filtered + state.last_filtered);
        } else {
            state.angle += period_s * 0.5 * (raw + state.last_raw);
        }
        state.started = true;
        if self.inclinometer_time_s > 0.0 {
            state.angle += period_s / self.inclinometer_time_s * (inclination - state.angle);
        }
        let limit = self.rate_demand_max_rad_s;
        let demand = (self.ko_per_s * (drive.angle_reference_rad - state.angle)).max(-limit).min(limit);
        let error = demand - filtered;
        let damping = self.kd_s * (filtered - state.last_filtered) / period_s;
        let wanted = drive.volts_per_rate * (self.kappa * (error + state.integral) - damping);
        let voltage = wanted.max(-drive.voltage_max_v).min(drive.voltage_max_v);
        if voltage == wanted || wanted * error < 0.0 {
            state.integral += period_s * self.kvi_per_s * error;
        }
        (state.last_raw, state.last_filtered) = (raw, filtered);
        voltage
    }
}

/// What the controller knows of the drive, and its task.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drive {
    /// Ke n: volts for 1 rad/s.
    pub(crate) volts_per_rate: f64,
    /// Voltage limit.
    pub(crate) voltage_max_v: f64,
    /// Angle to hold, rad.
    pub(crate) angle_reference_rad: f64,
}
