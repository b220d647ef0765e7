//! Settings anywhere in their ranges, extremes first, with the worst samples: every filter in both precisions stays finite and states
//! no variance below zero.

use std::collections::BTreeMap;

use stillrate::ranges::range_of;
use stillrate::settings::Visit;
use stillrate::{Filter, GyroNoise, Real, Sample, Settings};

struct Dice(u64);

impl Dice {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    fn below(&mut self, count: usize) -> usize {
        (self.bits() >> 33) as usize % count
    }
    fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Draws every setting: as it is, at an end of its range, or between, evenly in the logarithm.
struct Draw<'a> {
    method: &'static str,
    dice: &'a mut Dice,
    found: BTreeMap<&'static str, f64>,
}

impl Draw<'_> {
    fn draw(&mut self, name: &'static str, value: f64) -> f64 {
        let range = range_of(self.method, name).expect("every setting has a range");
        let low = if range.low > 0.0 { range.low } else { 1e-9 * range.high };
        match self.dice.below(6) {
            0 | 1 => value,
            2 => range.low,
            3 if !range.open => range.high,
            4 => range.also.unwrap_or(value),
            _ => low * (range.high / low).powf(self.dice.uniform()),
        }
    }
}

impl Visit for Draw<'_> {
    fn number(&mut self, name: &'static str, value: &mut f64) {
        // A memory follows from the factor, an order is 1 or 2, a length whole.
        *value = match name {
            "tau_s" => *value,
            "order" => 1.0 + self.dice.below(2) as f64,
            "length" => 1.0 + self.dice.below(128) as f64,
            _ => self.draw(name, *value),
        };
        self.found.insert(name, *value);
    }
    fn list(&mut self, name: &'static str, values: &mut [f64], count: &mut usize) {
        if name == "taps" && self.dice.below(2) == 0 {
            return;
        }
        if name == "taps" || name == "oscillators" || name == "ladder_hz" || name == "coefficients" {
            *count = 1 + self.dice.below(values.len());
        }
        if name == "transition" || name == "initial_probability" {
            for pair in values.chunks_exact_mut(2) {
                let stay = [0.0, 0.5, 0.95, 1.0, 1e-9, 1e-30][self.dice.below(6)];
                pair.copy_from_slice(&[stay, 1.0 - stay]);
            }
            return;
        }
        let scale = if name == "coefficients" { 1.0 / *count as f64 } else { 1.0 };
        for value in values.iter_mut().take(*count) {
            *value = match name {
                "coefficients" => scale * (2.0 * self.dice.uniform() - 1.0) * 1.2,
                _ => self.draw(name, *value),
            };
            self.found.insert(name, *value);
        }
    }
    fn choice(&mut self, _: &'static str, words: &'static [&'static str], chosen: &mut usize) {
        *chosen = self.dice.below(words.len());
    }
}

/// A stream that swings between the largest values a filter uses, with dropouts and gaps just short of a new start.
fn samples(dice: &mut Dice, sigma: f64, rate_hz: f64, count: usize) -> Vec<(f64, f64)> {
    let period = 1.0 / rate_hz;
    let longest = 10.0_f64.max(3.0 * period);
    let mut mood = 0;
    (0..count)
        .map(|k| {
            if k % 50 == 0 {
                mood = dice.below(9);
            }
            let sign = if dice.below(2) == 0 { 1.0 } else { -1.0 };
            let most = (1.99e8 * sigma).least(0.99e12);
            let most = if dice.below(2) == 0 { most } else { most.least(0.99e14 / rate_hz) };
            let size = ([1.0, 1e3, 1e6, 1.99e8][dice.below(4)] * sigma).least(most);
            let value = match mood {
                0 => sign * sigma * dice.uniform(),
                1 => sign * most,
                2 | 7 => f64::NAN,
                3 => sign * 9.9e9,
                4 => most,
                5 if k % 7 != 0 => f64::NAN,
                _ => sign * size,
            };
            let dt = match dice.below(12) {
                0 => 0.99 * longest,
                1 if mood == 2 => 0.99 * longest,
                _ if mood == 7 => 0.99 * longest,
                1..=5 if mood == 8 => 2e-6 * period,
                2 => [1.01 * longest, 3e38][dice.below(2)],
                3 => 1e-5 * period,
                4 => period * dice.uniform(),
                _ => period,
            };
            (value, dt)
        })
        .collect()
}

fn run<S: Settings, T: Real>(settings: &S, samples: &[(f64, f64)]) -> bool {
    let Ok(filter) = settings.build::<T>() else { return false };
    let mut state = filter.start();
    for (k, &(value, dt)) in samples.iter().enumerate() {
        let before = state;
        let estimate = filter.step(&mut state, Sample { value: T::of(value), dt: T::of(dt) });
        let finite = estimate.rate.finite() && estimate.acceleration.finite() && estimate.variance.finite();
        let sound = finite && estimate.variance >= T::ZERO;
        let precision = core::any::type_name::<T>();
        assert!(sound, "{precision}, sample {k} ({value}, {dt}): {estimate:?}\n{settings:?}\nbefore: {before:?}");
    }
    true
}

fn stays_finite<S: Settings>(draws: usize) {
    let mut dice = Dice(0x5eed);
    let mut built = 0;
    for _ in 0..draws {
        let mut draw = Draw { method: S::METHOD, dice: &mut dice, found: BTreeMap::new() };
        let pick = |range: &stillrate::ranges::Range, u: f64| range.low * (range.high / range.low).powf(u);
        let rate_range = range_of(S::METHOD, "sample_rate_hz").unwrap();
        let rate_hz =
            [rate_range.low, rate_range.high, 50.0, pick(rate_range, draw.dice.uniform())][draw.dice.below(4)];
        let density = pick(range_of(S::METHOD, "noise.density_dps_sqrt_hz").unwrap(), draw.dice.uniform());
        let mut settings = S::defaults(rate_hz, GyroNoise::from_density_two_sided(density));
        let keep = settings.clone();
        settings.visit(&mut draw);
        // All drawn anew are seldom possible together; so are the ones that follow from the rate.
        let settings = if draw.dice.below(8) == 0 { keep } else { settings };
        let found = draw.found.clone();
        let sigma = found.get("measurement_variance").or(found.get("measurement_variance_dps2")).map_or_else(
            || {
                let density = found.get("noise.density_dps_sqrt_hz").copied().unwrap_or(density);
                density * found.get("sample_rate_hz").copied().unwrap_or(rate_hz).root()
            },
            |variance| variance.root(),
        );
        let rate_hz = found.get("sample_rate_hz").copied().unwrap_or(rate_hz);
        let length = if dice.below(50) == 0 { 5000 } else { 400 };
        let samples = samples(&mut dice, sigma, rate_hz, length);
        built += usize::from(run::<S, f64>(&settings, &samples));
        built += usize::from(run::<S, f32>(&settings, &samples));
    }
    assert!(built * 10 >= draws, "only {built} of {draws} were built");
}

macro_rules! for_every_method {
    ($($name:ident),* $(,)?) => { $(
        #[test]
        #[allow(non_snake_case)]
        fn $name() {
            stays_finite::<stillrate::filters::$name>(if cfg!(debug_assertions) { 100 } else { 2000 });
        }
    )* };
}
stillrate::methods!(for_every_method);

macro_rules! long_for_every_method {
    ($($name:ident),* $(,)?) => {
        /// The same with a hundred times the draws.
        #[test]
        #[ignore = "takes minutes"]
        fn stays_finite_for_many_settings() {
            $(stays_finite::<stillrate::filters::$name>(100_000);)*
        }
    };
}
stillrate::methods!(long_for_every_method);
