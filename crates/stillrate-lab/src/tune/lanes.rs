//! Many candidates of one small Kalman filter over one record, side by side, with the gain frozen once it has settled.
//!
//! The gain does not depend on the data, so after a few time constants a candidate costs one multiply and two adds a sample.
//! Candidates stand next to each other in arrays of `W` numbers and every loop runs over them innermost, which the compiler turns into
//! vector code; each candidate sees the same operations at any `W`, hence the same bits. A gap moves the gain, so it
//! is followed again afterwards until it settles.

use stillrate::Real;

/// A gain that moves by no more than this fraction of itself has settled.
const SETTLED: f64 = 1e-15;
/// Innovation variances are multiplied up over this many samples before one logarithm is taken: 1e17^16 stays finite.
const LOG_EVERY: usize = 16;
/// Innovation variances (in units of R) beyond this are held, see [`LOG_EVERY`].
const LARGEST_VARIANCE: f64 = 1e17;

/// `W` filters with measurement variance 1.
pub(crate) trait Candidates<const W: usize>: Sized {
    /// Starts all filters at the first usable sample.
    fn start(process_noise: &[f64; W], period_s: f64, first: f64) -> Self;
    /// Predicts the covariances and takes the gains of those that have not settled yet.
    fn gain(&mut self);
    /// Predicts over a missing sample and lets the gains move again.
    fn coast(&mut self);
    /// Predicts and updates the states with the present gains; gives the innovations.
    fn update(&mut self, value: f64) -> [f64; W];
    /// Variances of the innovations.
    fn innovations(&self) -> &Innovations<W>;
    /// Estimated rates.
    fn rate(&self) -> &[f64; W];
}

/// Variances of the innovations of `W` filters, followed until the gain has settled.
pub(crate) struct Innovations<const W: usize> {
    /// Innovation variances.
    pub(crate) variance: [f64; W],
    /// Their reciprocals.
    pub(crate) information: [f64; W],
    /// 1 where the gain has settled, else 0.
    pub(crate) settled: [f64; W],
}

impl<const W: usize> Innovations<W> {
    /// At the first sample.
    #[inline(always)]
    pub(crate) fn start() -> Self {
        Self { variance: [1.0; W], information: [1.0; W], settled: [0.0; W] }
    }

    /// Takes the variance of filter `l` unless its gain had settled before, which it returns; `still` says that it settles now.
    #[inline(always)]
    pub(crate) fn take(&mut self, l: usize, variance: f64, information: f64, still: bool) -> bool {
        let held = self.settled[l] == 1.0;
        self.settled[l] = f64::select(held || still, 1.0, 0.0);
        self.variance[l] = f64::select(held, self.variance[l], variance);
        self.information[l] = f64::select(held, self.information[l], information);
        held
    }
}

/// What a run over one record adds up, for `W` candidates: the innovations, or with a truth only the errors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sums<const W: usize> {
    /// Innovations that were counted.
    pub(crate) count: usize,
    /// Sum of squared innovations over their variance.
    pub(crate) weighted_square: [f64; W],
    /// Sum of the logarithms of the innovation variances.
    pub(crate) log_variance: [f64; W],
    /// Estimates compared with the truth.
    pub(crate) compared: usize,
    /// Sum of squared differences to the truth.
    pub(crate) square_error: [f64; W],
}

/// Runs `W` candidates over a record, with the widest vectors of this machine.
pub(crate) fn run<M: Candidates<W>, const W: usize>(
    process_noise: &[f64; W],
    period_s: f64,
    measured: &[f64],
    truth: Option<&[f64]>,
) -> Sums<W> {
    #[cfg(target_arch = "x86_64")]
    if W > 1 {
        if std::arch::is_x86_feature_detected!("avx512f") {
            // SAFETY: the feature was just detected.
            return unsafe { run_avx512::<M, W>(process_noise, period_s, measured, truth) };
        }
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the feature was just detected.
            return unsafe { run_avx2::<M, W>(process_noise, period_s, measured, truth) };
        }
    }
    run_plain::<M, W>(process_noise, period_s, measured, truth)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn run_avx512<M: Candidates<W>, const W: usize>(q: &[f64; W], dt: f64, z: &[f64], truth: Option<&[f64]>) -> Sums<W> {
    run_plain::<M, W>(q, dt, z, truth)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2<M: Candidates<W>, const W: usize>(q: &[f64; W], dt: f64, z: &[f64], truth: Option<&[f64]>) -> Sums<W> {
    run_plain::<M, W>(q, dt, z, truth)
}

#[inline(always)]
fn run_plain<M: Candidates<W>, const W: usize>(q: &[f64; W], dt: f64, z: &[f64], truth: Option<&[f64]>) -> Sums<W> {
    let mut tally = Tally::new();
    let Some(first) = z.iter().position(|v| v.is_finite()) else { return tally.sums };
    let mut filters = M::start(q, dt, z[first]);
    tally.compare(filters.rate(), truth, first);
    let mut settled = false;
    let mut k = first + 1;
    while k < z.len() {
        if !z[k].is_finite() {
            tally.close(&filters.innovations().variance);
            filters.coast();
            settled = false;
        } else if !settled {
            filters.gain();
            let innovation = filters.update(z[k]);
            if truth.is_none() {
                tally.add(&innovation, &filters);
            }
            settled = filters.innovations().settled.iter().sum::<f64>() == W as f64;
        } else {
            let end = z[k..].iter().position(|v| !v.is_finite()).map_or(z.len(), |gap| k + gap);
            tally.add_settled(&mut filters, z, truth, k..end);
            k = end;
            continue;
        }
        tally.compare(filters.rate(), truth, k);
        k += 1;
    }
    tally.close(&filters.innovations().variance);
    tally.sums
}

/// Sums under way. Whether a candidate's neighbours have settled changes nothing in its own order of operations.
struct Tally<const W: usize> {
    sums: Sums<W>,
    /// Product of innovation variances whose logarithm is still to be taken (1 while settled).
    product: [f64; W],
    pending: usize,
    /// Samples at the settled innovation variance.
    at_settled: [f64; W],
}

impl<const W: usize> Tally<W> {
    #[inline(always)]
    fn new() -> Self {
        let sums =
            Sums { count: 0, weighted_square: [0.0; W], log_variance: [0.0; W], compared: 0, square_error: [0.0; W] };
        Self { sums, product: [1.0; W], pending: 0, at_settled: [0.0; W] }
    }

    #[inline(always)]
    fn add<M: Candidates<W>>(&mut self, innovation: &[f64; W], filters: &M) {
        let Innovations { variance, information, settled } = filters.innovations();
        for l in 0..W {
            self.sums.weighted_square[l] += innovation[l] * innovation[l] * information[l];
            self.product[l] *= f64::select(settled[l] == 1.0, 1.0, variance[l].least(LARGEST_VARIANCE));
            self.at_settled[l] += settled[l];
        }
        self.sums.count += 1;
        self.pending += 1;
        if self.pending == LOG_EVERY {
            self.take_logarithm();
        }
    }

    #[inline(always)]
    fn add_settled<M: Candidates<W>>(
        &mut self,
        filters: &mut M,
        z: &[f64],
        truth: Option<&[f64]>,
        range: core::ops::Range<usize>,
    ) {
        if truth.is_some() {
            for k in range {
                filters.update(z[k]);
                self.compare(filters.rate(), truth, k);
            }
            return;
        }
        let information = filters.innovations().information;
        let mut square = self.sums.weighted_square;
        let count = range.len();
        for &value in &z[range] {
            let innovation = filters.update(value);
            for l in 0..W {
                square[l] += innovation[l] * innovation[l] * information[l];
            }
        }
        self.sums.weighted_square = square;
        self.sums.count += count;
        self.at_settled.iter_mut().for_each(|n| *n += count as f64);
    }

    #[inline(always)]
    fn compare(&mut self, rate: &[f64; W], truth: Option<&[f64]>, k: usize) {
        let Some(truth) = truth else { return };
        for l in 0..W {
            let error = rate[l] - truth[k];
            self.sums.square_error[l] += error * error;
        }
        self.sums.compared += 1;
    }

    fn take_logarithm(&mut self) {
        for l in 0..W {
            self.sums.log_variance[l] += self.product[l].logarithm();
        }
        self.product = [1.0; W];
        self.pending = 0;
    }

    /// Takes all outstanding logarithms, before the innovation variance changes or at the end.
    fn close(&mut self, variance: &[f64; W]) {
        self.take_logarithm();
        for l in 0..W {
            if self.at_settled[l] > 0.0 {
                self.sums.log_variance[l] += self.at_settled[l] * variance[l].least(LARGEST_VARIANCE).logarithm();
            }
        }
        self.at_settled = [0.0; W];
    }
}

/// Whether a gain moved by no more than the precision allows.
#[inline(always)]
pub(crate) fn has_settled(before: f64, now: f64) -> bool {
    (now - before).magnitude() <= SETTLED * now.magnitude()
}

/// Runs candidates sample by sample and shows the rates after each from the first usable sample on. The objectives use [`run`], which
/// executes the same operations.
pub(crate) fn watch<M: Candidates<W>, const W: usize>(
    q: &[f64; W],
    period_s: f64,
    z: &[f64],
    show: &mut dyn FnMut(usize, &[f64; W]),
) {
    let Some(first) = z.iter().position(|v| v.is_finite()) else { return };
    let mut filters = M::start(q, period_s, z[first]);
    show(first, filters.rate());
    for (k, value) in z.iter().enumerate().skip(first + 1) {
        if value.is_finite() {
            filters.gain();
            filters.update(*value);
        } else {
            filters.coast();
        }
        show(k, filters.rate());
    }
}
