//! Tunes the noise of the recommended bank on records without a truth: white density from the two-state filter's innovations, then
//! the rate random walk by the bank's own likelihood.
//!
//! The bank's models span all bandwidths, so there is no motion to tune for: only the two noise figures are sought, and constant
//! records are as good as moving ones.

use stillrate::{GyroNoise, Real, Settings, filters::MsImmIkfSettings};

use crate::tune::bank_likelihood::{BankLikelihood, noise_at};
use crate::tune::brent::Brent;
use crate::tune::gain_ratio::{Criterion, GainRatio, LN_10, Walk};
use crate::tune::minimise::{Method, minimise};
use crate::tune::objective::{MinimiseError, Objective, Progress};
use crate::tune::records::Record;
use crate::tune::tuned::TuneError;

/// The walk is sought from a density-thousandth a second to ten times the density, in decades over the density.
const WALK_DECADES: (f64, f64) = (-3.0, 1.5);
/// Grid and tolerance of that search: the likelihood is flat, a twentieth of a decade changes nothing.
const WALK_SEARCH: Brent = Brent { grid: 7, tolerance: 0.05, iterations: 12 };

/// Tuned noise of the bank.
///
/// # Example
/// ```
/// use stillrate_lab::{simulate::GyroNoiseModel, tune::records::Record, tune::tuned_bank::tune_bank};
/// let model = GyroNoiseModel { density_dps_sqrt_hz: 0.02, ..GyroNoiseModel::perfect() };
/// let still = model.record(&[0.0; 3000], 50.0, 1).unwrap().measured_dps;
/// let tuned = tune_bank(&[Record { measured: &still, truth: None }], 0.02, &mut |_| true)?;
/// // The walk cannot be told from none: it stands at the least share of the density that is searched.
/// assert!(tuned.noise.rate_random_walk_dps_sqrt_s < 0.1 * tuned.noise.density_dps_sqrt_hz);
/// assert!(tuned.evaluations >= 7); // the grid over the walk
/// # Ok::<(), stillrate_lab::tune::tuned::TuneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TunedBank {
    /// Density and walk.
    pub noise: GyroNoise,
    /// The bank's objective there.
    pub value: f64,
    /// Runs of the bank.
    pub evaluations: usize,
}

/// The bank's objective over the walk alone.
struct OverWalk<'a> {
    bank: BankLikelihood<'a>,
    log10_density: f64,
}

impl Objective for OverWalk<'_> {
    fn values(&mut self, points: &[f64], _dimensions: usize) -> Vec<f64> {
        let pairs: Vec<f64> = points.iter().flat_map(|w| [self.log10_density, w + self.log10_density]).collect();
        self.bank.values(&pairs, 2)
    }
}

/// Finds the bank's noise from records sampled every `period_s` seconds.
///
/// # Errors
/// [`TuneError`].
///
/// # Example
/// ```
/// use stillrate_lab::{simulate::{BedKind, BedSettings}, tune::records::Record, tune::tuned_bank::tune_bank};
/// let bed = BedSettings::new(BedKind::Static, 50.0, 1).simulate().unwrap();
/// let tuned = tune_bank(&[Record { measured: &bed.measured_dps, truth: None }], 0.02, &mut |_| true)?;
/// assert!((tuned.noise.density_dps_sqrt_hz / 0.0151 - 1.0).abs() < 0.05); // deg/s/sqrt(Hz), as simulated
/// # Ok::<(), stillrate_lab::tune::tuned::TuneError>(())
/// ```
pub fn tune_bank(
    records: &[Record<'_>],
    period_s: f64,
    progress: &mut dyn FnMut(&Progress) -> bool,
) -> Result<TunedBank, TuneError> {
    let (walk, criterion) = (Walk::RateAcceleration, Criterion::Innovation);
    let two_state = GainRatio { records, walk, criterion, period_s }.tune(&Method::default(), false, progress)?;
    let density = (two_state.measurement_variance * period_s).root();
    let noise = GyroNoise::from_density_two_sided(density);
    let settings = MsImmIkfSettings::defaults(1.0 / period_s, noise);
    let built = settings.build::<f64>();
    built.map_err(|error| TuneError::Minimise(MinimiseError::Setting(error.to_string())))?;
    let log10_density = density.logarithm() / LN_10;
    let mut over = OverWalk { bank: BankLikelihood { records, settings }, log10_density };
    let (low, high) = WALK_DECADES;
    let best = minimise(&mut over, &[low], &[high], &Method::Brent(WALK_SEARCH), progress)?;
    let noise = noise_at(&[log10_density, log10_density + best.point[0]]);
    Ok(TunedBank { noise, value: best.value, evaluations: best.evaluations })
}
