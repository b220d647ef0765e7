//! 60 s of one axis with PT1 in the loop, timed: `cargo run --release --example platform_speed`.
use std::time::Instant;

use stillrate_lab::servo::base::Base;
use stillrate_lab::servo::controller::Controller;
use stillrate_lab::servo::discrete::Discrete;
use stillrate_lab::servo::plant::{Curves, Plant};
use stillrate_lab::servo::platform::{GyroErrors, Platform};

fn main() {
    for curves in [Curves::Algebraic, Curves::Transcendental] {
        let plant = Plant { curves, ..Plant::platform_30kg() };
        let axis = Platform::new(plant, Controller::default(), 50.0, 1e-3, 5e-3).expect("default platform");
        let base = Base::Sine { amplitude_rad: 0.1745, frequency_hz: 1.0, ramp_s: 1.0 };
        let gyro = GyroErrors { white_sigma_rad_s: 1.9e-3, ..GyroErrors::default() };
        let mut filter = Discrete::pt1(50.0, 5.3).expect("a cut-off below 25 Hz");
        let mut best = f64::INFINITY;
        let mut sum = 0.0;
        for _ in 0..30 {
            let start = Instant::now();
            let record = axis.run(&mut filter, &base, &gyro, 0.0, 60.0).expect("a stable loop");
            best = best.min(start.elapsed().as_secs_f64());
            sum += record.last_state[0];
        }
        println!("{curves:?}: {:.2} ms for 60 s (best of 30; {sum:.3e})", 1e3 * best);
    }
}
