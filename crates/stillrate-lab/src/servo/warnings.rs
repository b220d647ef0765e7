//! What a user should know before a run, from figures that cost nothing to work out.

use super::DEGREES;
use super::base::Base;
use super::discrete::Discrete;
use super::linear::LinearLoop;
use super::platform::Platform;

/// What a loop is warned of: a base that the drive cannot follow, an angle beyond the range, an unstable loop.
///
/// The number that shows it is in the text. `filter` is what
/// [`linear_equivalent`](super::chain::linear_equivalent) makes of the loop's filter.
///
/// # Example
/// ```
/// use stillrate_lab::servo::{base::Base, controller::Controller, discrete::Discrete, plant::Plant};
/// use stillrate_lab::servo::{platform::Platform, warnings::warnings};
/// let axis = Platform::new(Plant::platform_30kg(), Controller::default(), 50.0, 1e-3, 5e-3).unwrap();
/// let far = Base::Tilt { amplitude_rad: 30_f64.to_radians(), duration_s: 2.0 };
/// let told = warnings(&axis, &far, &(Discrete::None, true), 20.0);
/// assert_eq!(told, ["the base tilts to 30.0 deg, the range is 20.0 deg"]);
/// ```
#[must_use]
pub fn warnings(axis: &Platform, base: &Base, (filter, whole): &(Discrete, bool), range_deg: f64) -> Vec<String> {
    let mut found = Vec::new();
    let (angle, rate) = base.extremes();
    let has = axis.plant.rate_limit_rad_s();
    if rate > has {
        found.push(format!(
            "unreachable: the base needs {:.1} deg/s, the drive has {:.1} deg/s (voltage_max_v / (motor_constant_v_s gear_ratio))",
            rate * DEGREES,
            has * DEGREES
        ));
    }
    if angle * DEGREES > range_deg * (1.0 + 1e-9) {
        found.push(format!("the base tilts to {:.1} deg, the range is {range_deg:.1} deg", angle * DEGREES));
    }
    let radius = LinearLoop::new(axis, filter).spectral_radius();
    // One eigenvalue is 1 by nature: an angle that comes from a gyro alone has no absolute reference.
    if radius > 1.0 + 1e-6 {
        found.push(if *whole {
            format!("the loop is unstable: its linearised spectral radius is {radius:.4} (must be at most 1)")
        } else {
            format!("with its filter fully open the loop would be unstable (linearised spectral radius {radius:.4}): watch its rest after a tilt")
        });
    }
    found
}
