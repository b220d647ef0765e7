//! The Gauss-Newton iteration, and what it says about its own result.

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::normal::{Interval, Normal};
use super::span::Record;
use super::{BiasEstimate, BiasSettings, Fix, Iteration, UNKNOWNS, Unknowns};
use crate::attitude::so3;
use crate::attitude::symmetric::eigen;
use crate::error::ConfigError;
use crate::real::Real;

/// Steps below this many standard deviations of the result change nothing that matters: converged, even if a lag that crosses
/// sample boundaries keeps the iteration from settling to the last digit.
const SETTLED_SIGMAS: f64 = 1e-3;

/// Lags are looked for within this many prior standard deviations.
const LAG_RANGE: f64 = 5.0;

/// Finds the bias (and, if asked for, mounting, lag and scale factors) that makes the record meet the fixes.
///
/// `start` is where the iteration begins, also the centre of the priors. `watch` sees every iteration.
///
/// # Errors
/// [`ConfigError`] for settings out of range, fewer than two fixes, fixes not in ascending order or outside the record, a rate
/// that is not finite, a time step that is not above 0.
///
/// # Example
/// Half a degree a second that the reference does not show:
/// ```
/// use stillrate::attitude::reference_bias::{BiasSettings, Fix, Record, Steps, Unknowns, solve};
/// use stillrate::attitude::Rotation;
/// let rates = vec![[0.0, 0.0, 0.5_f64.to_radians()]; 200];
/// let record = Record { rates: &rates, steps: Steps::Uniform(0.005) };
/// let still = Rotation::identity();
/// let fixes = [Fix { index: 0, attitude: still }, Fix { index: 200, attitude: still }];
/// let found = solve(record, &fixes, &BiasSettings::default(), Unknowns::default(), |_| ())?;
/// assert!((found.unknowns.bias.z.to_degrees() - 0.5).abs() < 1e-12 && found.observable());
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
pub fn solve<T: Real>(
    record: Record<'_, T>,
    fixes: &[Fix<T>],
    settings: &BiasSettings,
    start: Unknowns<T>,
    mut watch: impl FnMut(&Iteration<T>),
) -> Result<BiasEstimate<T>, ConfigError> {
    settings.check()?;
    record.check()?;
    check_fixes(fixes, record.rates.len())?;
    let priors = settings.priors::<T>();
    let mut unknowns = start;
    let mut iterations = 0;
    let mut settled = false;
    while iterations < settings.max_iterations {
        let normal = linearise(record, fixes, settings, &unknowns, &mut watch)?;
        let spectrum = Spectrum::new(&normal, &priors);
        let step = spectrum.step(&normal, &priors, settings.use_prior.then(|| departure(&start, &unknowns)));
        apply(&mut unknowns, &step, T::of(LAG_RANGE * settings.prior_lag_s));
        iterations += 1;
        let size = relative(&step, &priors);
        settled = size <= spectrum.smallest_sigma(settings.use_prior) * T::of(SETTLED_SIGMAS);
        if size <= T::of(settings.tolerance) || !size.finite() {
            break;
        }
    }
    let normal = linearise(record, fixes, settings, &unknowns, &mut |_| ())?;
    let mut estimate = Spectrum::new(&normal, &priors).conclude(&normal, &priors, settings.use_prior, unknowns);
    estimate.iterations = iterations;
    estimate.converged = settled && inside_basin(record, fixes, &unknowns);
    Ok(estimate)
}

fn check_fixes<T: Real>(fixes: &[Fix<T>], samples: usize) -> Result<(), ConfigError> {
    if fixes.len() < 2 {
        return Err(ConfigError::new("fixes", fixes.len() as f64, "", "at least 2"));
    }
    for (before, after) in fixes.iter().zip(fixes.iter().skip(1)) {
        if after.index <= before.index {
            let range = "above the fix before it, with at least one gyro sample between (t1 > t0)";
            return Err(ConfigError::new("fix_index", after.index as f64, "", range));
        }
        if after.index > samples {
            return Err(ConfigError::new("fix_index", after.index as f64, "", "at most the number of gyro samples"));
        }
    }
    Ok(())
}

/// Residuals and derivatives of all intervals at `unknowns`.
fn linearise<T: Real>(
    record: Record<'_, T>,
    fixes: &[Fix<T>],
    settings: &BiasSettings,
    unknowns: &Unknowns<T>,
    watch: &mut impl FnMut(&Iteration<T>),
) -> Result<Normal<T>, ConfigError> {
    let (walk, sigma) = (T::of(settings.angle_random_walk_rad_sqrt_s), T::of(settings.reference_sigma_rad));
    let mut normal = Normal::new(walk * walk, sigma * sigma);
    let reach =
        if settings.estimate_lag { T::of(LAG_RANGE * settings.prior_lag_s) } else { unknowns.lag_s.magnitude() };
    // A fix whose lag window leaves the record is used at no lag at all, so that every iteration has the same data.
    let usable = |fix: &Fix<T>| record.moment(fix.index, reach).is_some() && record.moment(fix.index, -reach).is_some();
    for (before, after) in fixes.iter().zip(fixes.iter().skip(1)) {
        let ends = (record.moment(before.index, unknowns.lag_s), record.moment(after.index, unknowns.lag_s));
        let ((Some(from), Some(to)), true) = (ends, usable(before) && usable(after)) else {
            normal.cut();
            continue;
        };
        let span = record.span(from, to, unknowns, settings.estimate_scale);
        let reference = before.attitude.matrix().transpose() * after.attitude.matrix();
        let turn = unknowns.mounting * reference * unknowns.mounting.transpose();
        let residual = so3::log(&(turn.transpose() * span.turn.rotation));
        let mut rows = SMatrix::<T, 3, UNKNOWNS>::zeros();
        rows.fixed_view_mut::<3, 3>(0, 0).copy_from(&span.turn.bias_jacobian);
        if settings.estimate_mounting {
            rows.fixed_view_mut::<3, 3>(0, 3).copy_from(&(Matrix3::identity() - turn.transpose()));
        }
        if settings.estimate_lag {
            let by_lag = span.turn.rotation.transpose() * span.first_rate - span.last_rate;
            rows.fixed_view_mut::<3, 1>(0, 6).copy_from(&by_lag);
        }
        if settings.estimate_scale {
            rows.fixed_view_mut::<3, 3>(0, 7).copy_from(&span.turn.scale_jacobian);
        }
        if normal.intervals == 0 {
            let (rotation, jacobian) = (span.turn.rotation, span.turn.bias_jacobian);
            watch(&Iteration { bias: unknowns.bias, rotation, jacobian, delta: residual });
        }
        normal.add(&Interval { rows, residual, turn, time_s: span.turn.time_s });
    }
    if normal.intervals == 0 {
        return Err(ConfigError::new("fixes", 0.0, "", "at least 2 whose lag window lies inside the record"));
    }
    Ok(normal)
}

/// How far the unknowns have moved from the start: what the priors pull at.
fn departure<T: Real>(start: &Unknowns<T>, now: &Unknowns<T>) -> [T; UNKNOWNS] {
    let bias = start.bias - now.bias;
    let turned = so3::log(&(now.mounting * start.mounting.transpose()));
    let scale = start.scale - now.scale;
    let lag = start.lag_s - now.lag_s;
    [bias.x, bias.y, bias.z, turned.x, turned.y, turned.z, lag, scale.x, scale.y, scale.z]
}

fn apply<T: Real>(unknowns: &mut Unknowns<T>, step: &[T; UNKNOWNS], lag_max: T) {
    unknowns.bias += Vector3::new(step[0], step[1], step[2]);
    unknowns.mounting = so3::exp(&Vector3::new(-step[3], -step[4], -step[5])) * unknowns.mounting;
    unknowns.lag_s =
        if step[6] == T::ZERO { unknowns.lag_s } else { (unknowns.lag_s + step[6]).limited(-lag_max, lag_max) };
    unknowns.scale += Vector3::new(step[7], step[8], step[9]);
}

/// Largest component of a step in units of the priors.
fn relative<T: Real>(step: &[T; UNKNOWNS], priors: &[T; UNKNOWNS]) -> T {
    step.iter().zip(priors).fold(T::ZERO, |largest, (&s, &p)| {
        let size = if p > T::ZERO { (s / p).magnitude() } else { T::ZERO };
        if size.finite() { largest.most(size) } else { T::of(f64::NAN) }
    })
}

/// Share of pi up to which |b| T is trusted: b and b - 2 pi/T explain two fixes equally well, and near pi neither is likelier.
const TRUSTED_SHARE: f64 = 0.9;

/// Whether |b| T stays clear of pi over every interval.
fn inside_basin<T: Real>(record: Record<'_, T>, fixes: &[Fix<T>], unknowns: &Unknowns<T>) -> bool {
    let rate = so3::squared(&unknowns.bias).root();
    fixes.iter().zip(fixes.iter().skip(1)).all(|(before, after)| {
        let nothing = Unknowns { lag_s: T::ZERO, ..*unknowns };
        let ends = (record.moment(before.index, T::ZERO), record.moment(after.index, T::ZERO));
        let (Some(from), Some(to)) = ends else { return true };
        rate * record.span(from, to, &nothing, false).turn.time_s < T::of(TRUSTED_SHARE * core::f64::consts::PI)
    })
}

/// The information matrix in units of the priors, taken apart.
struct Spectrum<T> {
    values: [T; UNKNOWNS],
    vectors: [[T; UNKNOWNS]; UNKNOWNS],
    dimension: usize,
}

impl<T: Real> Spectrum<T> {
    fn new(normal: &Normal<T>, priors: &[T; UNKNOWNS]) -> Self {
        let scaled = core::array::from_fn(|i| core::array::from_fn(|j| priors[i] * normal.matrix[(i, j)] * priors[j]));
        let (values, vectors) = eigen(scaled);
        Self {
            values: values.map(|value| value.most(T::ZERO)),
            vectors,
            dimension: priors.iter().filter(|&&p| p > T::ZERO).count(),
        }
    }

    /// What a direction's information is divided by: the data alone where it beats the prior, both where it does not.
    fn divisor(&self, k: usize, use_prior: bool) -> T {
        let value = self.values[k];
        if use_prior || value < T::ONE { value + T::ONE } else { value }
    }

    /// Standard deviation of the best-known direction, in units of the prior.
    fn smallest_sigma(&self, use_prior: bool) -> T {
        let most = (0..UNKNOWNS).fold(T::ONE, |most, k| most.most(self.divisor(k, use_prior)));
        T::ONE / most.root()
    }

    fn step(&self, normal: &Normal<T>, priors: &[T; UNKNOWNS], departure: Option<[T; UNKNOWNS]>) -> [T; UNKNOWNS] {
        let right: [T; UNKNOWNS] = core::array::from_fn(|i| {
            let pull = match departure {
                Some(from_start) if priors[i] > T::ZERO => from_start[i] / priors[i],
                _ => T::ZERO,
            };
            priors[i] * normal.right[i] + pull
        });
        let along: [T; UNKNOWNS] = core::array::from_fn(|k| {
            let projected = (0..UNKNOWNS).fold(T::ZERO, |sum, i| sum + self.vectors[i][k] * right[i]);
            projected / self.divisor(k, departure.is_some())
        });
        core::array::from_fn(|i| priors[i] * (0..UNKNOWNS).fold(T::ZERO, |sum, k| sum + self.vectors[i][k] * along[k]))
    }

    fn conclude(
        &self,
        normal: &Normal<T>,
        priors: &[T; UNKNOWNS],
        use_prior: bool,
        unknowns: Unknowns<T>,
    ) -> BiasEstimate<T> {
        let mut order: [usize; UNKNOWNS] = core::array::from_fn(|k| k);
        // Insertion sort, largest first; unused unknowns have no information and go last.
        let key = |k: usize| if priors[k] > T::ZERO || self.values[k] > T::ZERO { self.values[k] } else { -T::ONE };
        for i in 1..UNKNOWNS {
            let mut j = i;
            while j > 0 && key(order[j - 1]) < key(order[j]) {
                order.swap(j - 1, j);
                j -= 1;
            }
        }
        let quadratic = |i: usize, j: usize, divisor: &dyn Fn(usize) -> T| {
            let sum = (0..UNKNOWNS).fold(T::ZERO, |sum, k| sum + self.vectors[i][k] * self.vectors[j][k] / divisor(k));
            priors[i] * sum * priors[j]
        };
        let kept = |k: usize| self.divisor(k, use_prior);
        let bayes = |k: usize| self.divisor(k, true);
        let rank = (0..UNKNOWNS).filter(|&k| self.values[k] >= T::ONE).count();
        BiasEstimate {
            unknowns,
            covariance: core::array::from_fn(|i| core::array::from_fn(|j| quadratic(i, j, &kept))),
            singular_values: order.map(|k| self.values[k].root()),
            directions: core::array::from_fn(|i| core::array::from_fn(|k| self.vectors[i][order[k]])),
            posterior_over_prior: core::array::from_fn(|i| {
                if priors[i] > T::ZERO { quadratic(i, i, &bayes).root() / priors[i] } else { T::ZERO }
            }),
            dimension: self.dimension,
            rank,
            chi_square: normal.chi_square,
            degrees_of_freedom: (3 * normal.intervals).saturating_sub(rank),
            iterations: 0,
            converged: false,
        }
    }
}
