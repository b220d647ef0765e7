//! 900 s of a gimbal calibration by every filter of the core, timed: `cargo run --release --example gimbal_speed [method] [rounds]`.
//!
//! With the name of one method and one round it is what `valgrind --tool=callgrind` wants to see.
use std::time::Instant;

use stillrate::gimbal::{DEFAULT_SCALE, Model, Record, Reference};
use stillrate_lab::gimbal::{Disturbance, Method, Settings, Trajectory, calibrate, disturb, draw, outputs};

fn main() -> Result<(), stillrate::ConfigError> {
    let mut arguments = std::env::args().skip(1);
    let wanted = arguments.next().unwrap_or_default();
    let rounds: usize = arguments.next().and_then(|n| n.parse().ok()).unwrap_or(20);
    let model = Model::new(9.8, 40_f64.to_radians())?;
    let commands = Trajectory::default().commands(&model)?;
    let clean = outputs(&model, &draw(&DEFAULT_SCALE, 1.0, 1), &commands, 0.25, 5, 1, 0.0, 1);
    let samples = disturb(&clean, &Disturbance::default(), 2)?;
    let record = Record::new(&commands, &samples, 0.25, 1e-6)?;
    for (name, method) in Method::NAMED {
        for (reference, single) in [(Reference::Model, false), (Reference::Model, true), (Reference::Commanded, false)]
        {
            if method == Method::Batch || !(wanted.is_empty() || wanted == name) {
                continue;
            }
            let settings = Settings { reference, single, every: usize::MAX, ..Settings::new(model) };
            let mut best = f64::INFINITY;
            for _ in 0..rounds {
                let start = Instant::now();
                std::hint::black_box(calibrate(&record, method, &settings)?);
                best = best.min(start.elapsed().as_secs_f64());
            }
            let number = if single { "f32" } else { "f64" };
            println!("{name:14} {reference:?} {number}: {:7.2} ms (best of {rounds})", 1e3 * best);
        }
    }
    Ok(())
}
