//! Commands of a calibration run: segments of constant rates about the platform axes, reached at a limited slew.
//!
//! The command is the tumbling rate plus the Earth rate in the commanded frame, so that an error-free platform tumbles exactly as told;
//! it is held over each interval. The default programme tumbles for 900 s: 12 segments of 75 s, 1 deg/s an axis, reached at 0.5 deg/s^2.

use nalgebra::{Matrix3, Vector3};
use stillrate::ConfigError;
use stillrate::error::positive;
use stillrate::gimbal::Model;

/// Rates of the default segments in units of the rate limit.
pub const DEFAULT_SEGMENTS: [[f64; 3]; 12] = [
    [1.0, 0.0, 0.0],
    [0.0, 0.0, -1.0],
    [1.0, -1.0, 1.0],
    [-1.0, -1.0, 0.0],
    [-1.0, 1.0, -1.0],
    [-1.0, 1.0, 1.0],
    [1.0, 0.0, -1.0],
    [-1.0, 0.0, 1.0],
    [-1.0, 0.0, 0.0],
    [1.0, -1.0, -1.0],
    [0.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
];

/// A tumbling programme.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// Rate of each segment about each platform axis, deg/s.
    pub segments_deg_s: Vec<[f64; 3]>,
    /// Length of each segment, s.
    pub segment_s: f64,
    /// Slew limit about each axis, deg/s^2.
    pub slew_deg_s2: f64,
    /// Time for which a command is held, s.
    pub interval_s: f64,
}

impl Default for Trajectory {
    fn default() -> Self {
        Self { segments_deg_s: DEFAULT_SEGMENTS.to_vec(), segment_s: 75.0, slew_deg_s2: 0.5, interval_s: 0.25 }
    }
}

impl Trajectory {
    /// The commands (rad/s), one an interval.
    ///
    /// # Errors
    /// [`ConfigError`] if a duration or the slew limit is not positive, or a run would exceed ten million intervals.
    ///
    /// # Example
    /// ```
    /// use stillrate::gimbal::Model;
    /// use stillrate_lab::gimbal::Trajectory;
    /// let commands = Trajectory::default().commands(&Model::new(9.8, 0.7).unwrap()).unwrap();
    /// assert_eq!(commands.len(), 3600);
    /// ```
    pub fn commands(&self, model: &Model) -> Result<Vec<[f64; 3]>, ConfigError> {
        positive("segment_s", self.segment_s, "s")?;
        positive("interval_s", self.interval_s, "s")?;
        positive("slew_deg_s2", self.slew_deg_s2, "deg/s^2")?;
        let per_segment = (self.segment_s / self.interval_s).round();
        if per_segment * self.segments_deg_s.len() as f64 > 1e7 {
            return Err(ConfigError::new("segment_s", self.segment_s, "s", "shorter (at most 10 million intervals)"));
        }
        let degree = core::f64::consts::PI / 180.0;
        let change = self.slew_deg_s2 * self.interval_s;
        let earth_rate = model.earth_rate();
        let mut frame = Matrix3::identity();
        let mut rate = [0.0_f64; 3];
        let mut commands = Vec::new();
        for target in &self.segments_deg_s {
            for _ in 0..per_segment as usize {
                for axis in 0..3 {
                    rate[axis] += (target[axis] - rate[axis]).clamp(-change, change);
                }
                let command = Vector3::from(rate) * degree + frame * earth_rate;
                frame = model.commanded_step(&frame, &command, &earth_rate, self.interval_s);
                commands.push(command.into());
            }
        }
        Ok(commands)
    }
}
