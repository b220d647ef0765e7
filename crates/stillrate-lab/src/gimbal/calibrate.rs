//! One calibration of one record by any method: the widest instructions, one function a method.

use stillrate::gimbal::{
    COUNT, Coefficients, Estimator, FirstOrder, Innovation, JointFilter, Record, Relinearised, Selection, TwoLoop,
};
use stillrate::{ConfigError, Real};

use super::batch::batch;
use super::literal::literal_angle;
use super::outcome::{Outcome, Watch};
use super::settings::{Method, Settings};

/// Calibrates from a record, by any method; what the command line and Python call.
///
/// # Errors
/// [`ConfigError`] if the settings do not fit together.
///
/// # Example
/// ```
/// use stillrate::gimbal::{DEFAULT_SCALE, Model, Record};
/// use stillrate_lab::gimbal::{Disturbance, Method, Settings, Trajectory, calibrate, disturb, draw, outputs};
/// let model = Model::new(9.8, 0.7).unwrap();
/// let commands = Trajectory::default().commands(&model).unwrap();
/// let truth = draw(&DEFAULT_SCALE, 10.0, 1);
/// let clean = outputs(&model, &truth, &commands, 0.25, 5, 1, 0.0, 1);
/// let samples = disturb(&clean, &Disturbance::default(), 2).unwrap();
/// let record = Record::new(&commands, &samples, 0.25, 1e-6).unwrap();
/// let outcome = calibrate(&record, Method::Relinearised, &Settings::new(model)).unwrap();
/// assert!((outcome.coefficients[3] / truth[3] - 1.0).abs() < 1e-3);
/// ```
pub fn calibrate(record: &Record<'_>, method: Method, settings: &Settings) -> Result<Outcome, ConfigError> {
    let count = settings.indices()?.len();
    match (count <= BASIC, settings.single) {
        (true, false) => widest::<f64, BASIC>(record, method, settings),
        (true, true) => widest::<f32, BASIC>(record, method, settings),
        (false, false) => widest::<f64, ALL>(record, method, settings),
        (false, true) => widest::<f32, ALL>(record, method, settings),
    }
}

/// Capacity for the 30 observable coefficients, in whole groups of four rows of the square root.
const BASIC: usize = 32;
/// Capacity for everything.
const ALL: usize = 44;

/// [`run`] compiled for the instructions that this machine has: the operations are the same, and so are the bits.
fn widest<T: Real, const N: usize>(record: &Record<'_>, method: Method, s: &Settings) -> Result<Outcome, ConfigError> {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the feature was just detected.
        return unsafe { run_avx2::<T, N>(record, method, s) };
    }
    run::<T, N>(record, method, s)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2<T: Real, const N: usize>(
    record: &Record<'_>,
    method: Method,
    s: &Settings,
) -> Result<Outcome, ConfigError> {
    run::<T, N>(record, method, s)
}

#[inline(always)]
fn run<T: Real, const N: usize>(record: &Record<'_>, method: Method, s: &Settings) -> Result<Outcome, ConfigError> {
    let selection = Selection::<N>::for_triads(s.gauge, s.options, &s.model.triads)?;
    let mut estimator = Estimator::<T, N>::new(s.model, selection, &s.scale, s.angle_random_walk_deg_sqrt_h)?
        .with_cut_off(s.cut_off_rad)?;
    if !s.robust {
        estimator = estimator.with_plain_windows();
    }
    let mut outcome = Outcome::prior(s, selection.indices());
    let mut watch = Watch::over(record, s.every);
    match method {
        Method::Relinearised => relinearised(estimator, record, s, &mut watch, &mut outcome),
        Method::OnLine => on_line(estimator, record, s, &mut watch, &mut outcome)?,
        Method::FirstOrder => first_order(estimator, record, s, &mut watch, &mut outcome),
        Method::Batch => batch(record, s, &mut outcome),
        Method::TwoStage | Method::TwoLoop => two_loops::<T>(method, record, s, &mut watch, &mut outcome)?,
        Method::Literal => {
            outcome.coefficients = literal_angle(record, s, |epoch, coefficients| {
                watch.estimate(epoch, || (*coefficients, [0.0; COUNT]));
            });
        }
    }
    Ok(outcome.conclude(watch, record, method, s))
}

#[inline(always)]
fn relinearised<T: Real, const N: usize>(
    estimator: Estimator<T, N>,
    record: &Record<'_>,
    s: &Settings,
    watch: &mut Watch,
    outcome: &mut Outcome,
) {
    let method = Relinearised { estimator, reference: s.reference };
    let mut under_way = 0;
    let solution = method.run(record, &s.prior, |number, pass, innovations: &[Innovation; 3]| {
        if number != under_way {
            watch.forget_innovations();
            under_way = number;
        }
        watch.innovations(innovations);
        watch.estimate(pass.epoch, || (method.estimate(pass), method.standard_deviation(pass)));
    });
    outcome.coefficients = solution.coefficients;
    outcome.deviation = solution.deviation;
    outcome.diverged = solution.diverged;
}

#[inline(always)]
fn on_line<T: Real, const N: usize>(
    estimator: Estimator<T, N>,
    record: &Record<'_>,
    s: &Settings,
    watch: &mut Watch,
    outcome: &mut Outcome,
) -> Result<(), ConfigError> {
    let filter = JointFilter::new(estimator, s.second_order)?;
    let mut state = filter.start(&s.prior);
    for k in 0..record.epochs() {
        watch.innovations(&filter.epoch(&mut state, record, k, s.reference));
        watch.estimate(k + 1, || (filter.attitude_and_coefficients(&state), filter.standard_deviation(&state)));
    }
    outcome.coefficients = filter.attitude_and_coefficients(&state);
    outcome.deviation = filter.standard_deviation(&state);
    Ok(())
}

#[inline(always)]
fn first_order<T: Real, const N: usize>(
    estimator: Estimator<T, N>,
    record: &Record<'_>,
    s: &Settings,
    watch: &mut Watch,
    outcome: &mut Outcome,
) {
    let filter = FirstOrder { estimator };
    let mut state = filter.start(&s.prior);
    for k in 0..record.epochs() {
        watch.innovations(&filter.epoch(&mut state, record, k));
        watch.estimate(k + 1, || (state.coefficients, filter.standard_deviation(&state)));
    }
    outcome.coefficients = state.coefficients;
    outcome.deviation = filter.standard_deviation(&state);
}

#[inline(always)]
fn two_loops<T: Real>(
    method: Method,
    record: &Record<'_>,
    s: &Settings,
    watch: &mut Watch,
    outcome: &mut Outcome,
) -> Result<(), ConfigError> {
    let mut two = TwoLoop::<T>::new(s.model, &s.scale)?;
    if !s.robust {
        two = two.with_plain_windows();
    }
    let observe = |epoch: usize, coefficients: &Coefficients| {
        watch.estimate(epoch, || (*coefficients, [0.0; COUNT]));
    };
    (outcome.coefficients, outcome.deviation) = if method == Method::TwoStage {
        two.two_stage(record, &s.prior, observe)
    } else {
        two.cascade(record, &s.prior, observe)
    };
    Ok(())
}
