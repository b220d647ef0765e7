//! Runs every filter over a fixed signal, so that callgrind can count the instructions of a step.
//!
//! `list` prints the cases. `count CASE`, under `valgrind --tool=callgrind --toggle-collect='*counted*'`, calls [`counted`]
//! once, on a tile of [`ROWS`] rows after a warm-up. `time` times every case instead (minimum of many runs).

use std::hint::black_box;
use std::time::Instant;

use stillrate::{Filter, GyroNoise, Real, Reals, Settings, block, filters};

/// Rows that are counted.
const ROWS: usize = 1024;
/// Rows before: enough for every memory of the default settings to settle.
const WARM_UP: usize = 8192;
/// Sample rate of the recommended settings, Hz.
const RATE_HZ: f64 = 1000.0;

/// What is asked for.
enum Job {
    List,
    Count(String),
    Time,
}

/// What callgrind looks for.
#[inline(never)]
fn counted(work: &mut dyn FnMut()) {
    work();
    // Something to return to: a tail call would leave the function before the work.
    black_box(());
}

/// A tile at the instructions that every x86-64 has.
#[inline(never)]
fn tile_portable<T: Real, F: Filter<T>, const W: usize>(filter: &F, lanes: &mut [[T; W]], tile: &mut [[T; W]]) {
    filter.tile(lanes, tile, filter.period());
}

/// A tile with AVX2.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
#[inline(never)]
fn tile_avx2<T: Real, F: Filter<T>, const W: usize>(filter: &F, lanes: &mut [[T; W]], tile: &mut [[T; W]]) {
    filter.tile(lanes, tile, filter.period());
}

/// A slow wave with noise, a different one in each channel.
fn signal<T: Real, const W: usize>(rows: usize) -> Vec<[T; W]> {
    let mut seed = 1_u64;
    (0..rows)
        .map(|k| {
            core::array::from_fn(|_| {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let noise = (seed >> 33) as f64 / f64::from(1_u32 << 31) - 0.5;
                T::of(5.0 * ((k % 400) as f64 / 200.0 - 1.0) + 0.3 * noise)
            })
        })
        .collect()
}

fn case<T: Real, F: Filter<T>, const W: usize>(method: &str, form: &str, filter: &F, job: &Job) {
    let name = format!("{method}, {form}");
    match job {
        Job::List => return println!("{name}\t{}", ROWS * W),
        Job::Count(only) if *only != name => return,
        _ => {}
    }
    let mut lanes = vec![[T::ZERO; W]; <F::State as Reals<T>>::COUNT];
    for c in 0..W {
        block::store(&filter.start(), &mut lanes, c);
    }
    let run = |lanes: &mut [[T; W]], tile: &mut [[T; W]]| {
        #[cfg(target_arch = "x86_64")]
        if form.ends_with("avx2") {
            // SAFETY: cases with AVX2 run only where it was detected.
            unsafe { tile_avx2(filter, lanes, tile) };
            return;
        }
        tile_portable(filter, lanes, tile);
    };
    let samples = signal::<T, W>(WARM_UP + ROWS);
    let (before, rows) = samples.split_at(WARM_UP);
    run(&mut lanes, &mut before.to_vec());
    if let Job::Count(_) = job {
        let mut tile = rows.to_vec();
        counted(&mut || run(&mut lanes, black_box(&mut tile)));
        return;
    }
    let mut best = f64::MAX;
    for _ in 0..30 {
        let mut tile = rows.to_vec();
        let start = Instant::now();
        run(&mut lanes, black_box(&mut tile));
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("{name}\t{:.2} ns", best * 1e9 / (ROWS * W) as f64);
}

fn forms<S: Settings>(job: &Job) {
    forms_of(S::METHOD, &S::defaults(RATE_HZ, noise()), job);
}

fn noise() -> GyroNoise {
    GyroNoise::from_density_two_sided(0.015).with_rate_random_walk(0.003)
}

fn forms_of<S: Settings>(method: &str, settings: &S, job: &Job) {
    let double = settings.build::<f64>().expect("defaults are valid");
    let single = settings.build::<f32>().expect("defaults are valid");
    case::<f64, _, 1>(method, "f64 x 1", &double, job);
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        case::<f64, _, 8>(method, "f64 x 8 avx2", &double, job);
        case::<f32, _, 16>(method, "f32 x 16 avx2", &single, job);
    }
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let job = match (arguments.next().as_deref(), arguments.next()) {
        (Some("count"), Some(case)) => Job::Count(case),
        (Some("time"), _) => Job::Time,
        _ => Job::List,
    };
    macro_rules! every {
        ($($name:ident),* $(,)?) => { $(forms::<filters::$name>(&job);)* };
    }
    stillrate::methods!(every);
    let light = filters::MsImmIkfSettings { oscillator_count: 0, ..Settings::defaults(RATE_HZ, noise()) };
    forms_of("ms-imm-ikf, light", &light, &job);
}
