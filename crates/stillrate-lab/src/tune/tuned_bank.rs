//! Tunes the noise of the recommended bank on records without a truth: white density from the two-state filter's innovations, then
//! the rate random walk by the bank's own likelihood.
//!
//! The bank's models span all bandwidths, so there is no motion to tune for: only the two noise figures are sought, and constant
//! records are as good as moving ones.

use stillrate::{GyroNoise, Real, Settings, filters::MsImmIkfSettings};

use crate::tune::bank_likelihood::BankLikelihood;
use crate::tune::brent::Brent;
use crate::tune::gain_ratio::{Criterion, LN_10, Walk};
use crate::tune::minimise::{Method, MinimiseError, Objective, Progress, minimise};
use crate::tune::records::Record;
use crate::tune::tuned::{TuneError, tune};

/// The walk is sought from a density-thousandth a second to ten times the density, in decades over the density.
const WALK_DECADES: (f64, f64) = (-3.0, 1.5);
/// Grid and tolerance of that search: the likelihood is flat, a twentieth of a decade changes nothing.
const WALK_SEARCH: Brent = Brent { grid: 7, tolerance: 0.05, iterations: 12 };

/// Tuned noise of the bank.
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

/// Finds the bank's noise.
///
/// # Errors
/// [`TuneError`].
pub fn tune_bank(
    records: &[Record<'_>],
    period_s: f64,
    progress: &mut dyn FnMut(&Progress) -> bool,
) -> Result<TunedBank, TuneError> {
    let white = Method::Brent(Brent::default());
    let two_state = tune(records, period_s, Walk::RateAcceleration, Criterion::Innovation, &white, false, progress)?;
    let density = (two_state.measurement_variance * period_s).root();
    let noise = GyroNoise::from_density_two_sided(density);
    let settings = MsImmIkfSettings::defaults(1.0 / period_s, noise);
    let built = settings.build::<f64>();
    built.map_err(|error| TuneError::Minimise(MinimiseError::Setting(error.to_string())))?;
    let log10_density = density.logarithm() / LN_10;
    let mut over = OverWalk { bank: BankLikelihood { records, settings, walk_share: 0.0 }, log10_density };
    let (low, high) = WALK_DECADES;
    let best = minimise(&mut over, &[low], &[high], &Method::Brent(WALK_SEARCH), progress)?;
    let noise = over.bank.noise(&[log10_density, log10_density + best.point[0]]);
    Ok(TunedBank { noise, value: best.value, evaluations: best.evaluations })
}
