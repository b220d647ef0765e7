//! The plant alone: what it does under given voltages.

use stillrate::ConfigError;

use super::base::Base;
use super::kernel::Kernel;
use super::plant::{Plant, State};

/// Steps that a period may have: what it takes in memory stays within a few megabytes.
const MOST_STEPS: usize = 100_000;

/// States at the start and after every period, each of `steps` integration steps of `dt_s` (s) under one of the voltages (V). Times are
/// counted from the start of `base`; the states (SI, rad) are those of [`plant`](super::plant).
///
/// A start that twists the coupling far (a drive angle that is not the platform's less the base's) throws the drive to rates beyond the
/// supply's, for which the step was not checked: what follows may not be finite.
///
/// # Errors
/// [`ConfigError`] naming the field of plant, base motion or step that is out of range.
///
/// # Example
/// ```
/// use stillrate_lab::servo::{base::Base, open_loop::open_loop, plant::Plant};
/// let still = Base::Constant { angle_rad: 0.0 };
/// // 3 V for 40 ms: the current loop (2 ms) has settled, less what the turning motor induces.
/// let states = open_loop(&Plant::platform_30kg(), &still, &[3.0, 3.0], [0.0; 7], 1e-3, 20)?;
/// let (rate, current) = (states[2][3], states[2][4]);
/// assert!(states.len() == 3 && rate > 0.0 && current > 0.0 && current < 3.0);
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
pub fn open_loop(
    plant: &Plant,
    base: &Base,
    voltage_v: &[f64],
    start: State,
    dt_s: f64,
    steps: usize,
) -> Result<Vec<State>, ConfigError> {
    plant.check(dt_s)?;
    base.check()?;
    if !(1..=MOST_STEPS).contains(&steps) {
        return Err(ConfigError::new("steps", steps as f64, "", "from 1 to 100000"));
    }
    let kernel = Kernel::new(plant);
    let mut motion = vec![(0.0, 0.0); 2 * steps + 1];
    let mut state = start;
    let mut states = vec![start];
    for (k, voltage) in voltage_v.iter().enumerate() {
        base.fill((k * steps) as f64 * dt_s, 0.5 * dt_s, &mut motion);
        kernel.run(&mut state, |_| *voltage, &motion, dt_s);
        states.push(state);
    }
    Ok(states)
}
