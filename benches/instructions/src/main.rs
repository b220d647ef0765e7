//! Runs every filter over a fixed signal, so that callgrind can count the instructions of a step.
//!
//! Each case calls [`counted`] once, on a tile of [`ROWS`] rows after a warm-up. Under
//! `valgrind --tool=callgrind --toggle-collect='*counted*' --dump-after='*counted*'` every call leaves one dump, in the
//! order in which the cases are printed. With the argument `time` the cases are timed instead (minimum of many runs).

use std::hint::black_box;
use std::time::Instant;

use stillrate::{Filter, GyroNoise, Real, Reals, Settings, block, filters};

/// Rows that are counted.
const ROWS: usize = 1024;
/// Rows before.
const WARM_UP: usize = 256;
/// Sample rate of the recommended settings, Hz.
const RATE_HZ: f64 = 1000.0;

/// What callgrind looks for.
#[inline(never)]
fn counted(work: &mut dyn FnMut()) {
    work();
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

fn case<T: Real, F: Filter<T>, const W: usize>(method: &str, form: &str, filter: &F, timed: bool) {
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
    if !timed {
        let mut tile = rows.to_vec();
        counted(&mut || run(&mut lanes, black_box(&mut tile)));
        println!("{method}\t{form}\t{}", ROWS * W);
        return;
    }
    let mut best = f64::MAX;
    for _ in 0..30 {
        let mut tile = rows.to_vec();
        let start = Instant::now();
        run(&mut lanes, black_box(&mut tile));
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("{method}\t{form}\t{:.2} ns", best * 1e9 / (ROWS * W) as f64);
}

fn forms<S: Settings>(timed: bool, only: Option<&str>) {
    forms_of(S::METHOD, &S::defaults(RATE_HZ, noise()), timed, only);
}

fn noise() -> GyroNoise {
    GyroNoise::from_density_two_sided(0.015).with_rate_random_walk(0.003)
}

fn forms_of<S: Settings>(method: &str, settings: &S, timed: bool, only: Option<&str>) {
    if only.is_some_and(|only| only != method) {
        return;
    }
    let double = settings.build::<f64>().expect("defaults are valid");
    let single = settings.build::<f32>().expect("defaults are valid");
    case::<f64, _, 1>(method, "f64 x 1", &double, timed);
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        case::<f64, _, 8>(method, "f64 x 8 avx2", &double, timed);
        case::<f32, _, 16>(method, "f32 x 16 avx2", &single, timed);
    }
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let timed = arguments.next().is_some_and(|mode| mode == "time");
    let only = arguments.next();
    macro_rules! every {
        ($($name:ident),* $(,)?) => { $(forms::<filters::$name>(timed, only.as_deref());)* };
    }
    stillrate::methods!(every);
}
