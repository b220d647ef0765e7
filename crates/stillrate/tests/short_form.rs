//! The short form that tiles of simple filters take gives the bits of the full step, wherever the record needs care.

use stillrate::filters::{
    BiquadSettings, FirLowPassSettings, Pt1Settings, RandomWalkKfSettings, RecursiveLeastSquaresSettings,
};
use stillrate::{Filter, GyroNoise, Real, Reals, Sample, Settings, block};

const RATE_HZ: f64 = 1000.0;

/// Noise, then silence in which everything decays, then noise with holes, spikes, infinities and a jump.
fn record<T: Real>(channel: u64) -> Vec<T> {
    let mut seed = 99 + channel;
    let mut noise = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f64 / f64::from(1_u32 << 24) - 0.5
    };
    (0..60_000_u64)
        .map(|k| {
            let x = noise();
            T::of(match k {
                0 => -0.0,
                20_000..52_000 => 0.0,
                52_000.. if (k + channel).is_multiple_of(97) => f64::NAN,
                52_000.. if (k + channel).is_multiple_of(1013) => f64::INFINITY,
                52_000.. if (k + channel).is_multiple_of(1511) => 1e300,
                56_000.. => 100.0 + x,
                _ => x,
            })
        })
        .collect()
}

fn check<T: Real, F: Filter<T>, const W: usize>(filter: &F) {
    let records: Vec<Vec<T>> = (0..W as u64).map(record).collect();
    let mut lanes = vec![[T::ZERO; W]; <F::State as Reals<T>>::COUNT];
    for c in 0..W {
        block::store(&filter.start(), &mut lanes, c);
    }
    let mut tile: Vec<[T; W]> = (0..records[0].len()).map(|k| core::array::from_fn(|c| records[c][k])).collect();
    for part in tile.chunks_mut(100) {
        filter.tile(&mut lanes, part, filter.period());
    }
    for (c, record) in records.iter().enumerate() {
        let mut state = filter.start();
        for (k, &value) in record.iter().enumerate() {
            let full = filter.step(&mut state, Sample { value, dt: filter.period() }).rate;
            assert_eq!(full.to_little_endian(), tile[k][c].to_little_endian(), "sample {k} of channel {c} of {W}");
        }
        assert_eq!(state, block::load::<T, F::State, W>(&lanes, c), "the state of channel {c} of {W}");
    }
}

fn check_widths<S: Settings>(settings: &S) {
    let (single, double) = (settings.build::<f32>().unwrap(), settings.build::<f64>().unwrap());
    check::<f64, _, 1>(&double);
    check::<f32, _, 1>(&single);
    check::<f64, _, 3>(&double);
    check::<f32, _, 5>(&single);
}

fn noise() -> GyroNoise {
    GyroNoise::from_density_two_sided(0.01)
}

#[test]
fn a_first_order_low_pass_gives_the_bits_of_its_full_step() {
    check_widths(&Pt1Settings::defaults(RATE_HZ, noise()));
}

#[test]
fn a_biquad_gives_the_bits_of_its_full_step() {
    check_widths(&BiquadSettings::defaults(RATE_HZ, noise()));
}

#[test]
fn recursive_least_squares_give_the_bits_of_their_full_step() {
    check_widths(&RecursiveLeastSquaresSettings::defaults(RATE_HZ, noise()));
    let all = RecursiveLeastSquaresSettings {
        tau_s: f64::INFINITY,
        forgetting_factor: 1.0,
        ..Settings::defaults(RATE_HZ, noise())
    };
    check_widths(&all);
}

#[test]
fn a_random_walk_filter_gives_the_bits_of_its_full_step() {
    check_widths(&RandomWalkKfSettings { variance_ratio: 0.05, ..Settings::defaults(RATE_HZ, noise()) });
}

#[test]
fn a_weighted_mean_gives_the_bits_of_its_full_step() {
    for length in [1.0, 9.0, 128.0] {
        check_widths(&FirLowPassSettings { length, ..Settings::defaults(RATE_HZ, noise()) });
    }
}
