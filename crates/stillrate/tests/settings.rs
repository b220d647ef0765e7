//! What every method does with its settings: shows all of them, takes them back, refuses what cannot be, and runs many channels as one.

use std::collections::BTreeMap;

use stillrate::settings::Visit;
use stillrate::{ConfigError, Filter, GyroNoise, Outline, Plain, Real, Reals, Sample, Settings, block, filters};

/// Every field as its method shows it.
#[derive(Clone, Debug, Default, PartialEq)]
struct Shown {
    numbers: BTreeMap<&'static str, f64>,
    lists: BTreeMap<&'static str, Vec<f64>>,
    words: BTreeMap<&'static str, usize>,
}

impl Visit for Shown {
    fn number(&mut self, name: &'static str, value: &mut f64) {
        assert!(self.numbers.insert(name, *value).is_none(), "{name} is shown twice");
    }
    fn list(&mut self, name: &'static str, values: &mut [f64], count: &mut usize) {
        self.lists.insert(name, values[..*count].to_vec());
    }
    fn choice(&mut self, name: &'static str, words: &'static [&'static str], chosen: &mut usize) {
        assert!(*chosen < words.len(), "{name}");
        self.words.insert(name, *chosen);
    }
}

/// Changes fields by name; the others stay.
#[derive(Clone, Debug, Default)]
struct Changes(Shown);

impl Visit for Changes {
    fn number(&mut self, name: &'static str, value: &mut f64) {
        *value = self.0.numbers.get(name).copied().unwrap_or(*value);
    }
    fn list(&mut self, name: &'static str, values: &mut [f64], count: &mut usize) {
        if let Some(given) = self.0.lists.get(name) {
            values[..given.len()].copy_from_slice(given);
            *count = given.len();
        }
    }
    fn choice(&mut self, name: &'static str, _: &'static [&'static str], chosen: &mut usize) {
        *chosen = self.0.words.get(name).copied().unwrap_or(*chosen);
    }
}

fn noise() -> GyroNoise {
    GyroNoise::from_density_two_sided(0.015).with_rate_random_walk(0.003)
}

fn shown<S: Settings>(settings: &S) -> Shown {
    let mut seen = Shown::default();
    settings.clone().visit(&mut seen);
    seen
}

fn with<S: Settings>(number: &'static str, value: f64) -> S {
    let mut changes = Changes::default();
    changes.0.numbers.insert(number, value);
    let mut settings = S::defaults(200.0, noise());
    settings.visit(&mut changes);
    settings
}

fn refusal<S: Settings>(settings: &S) -> ConfigError {
    settings.build::<f64>().map(|_| ()).expect_err(S::METHOD)
}

/// What is shown, put into the defaults for another rate and another gyro, gives the first settings again.
fn shows_all_of_itself<S: Settings + PartialEq>() {
    let first = S::defaults(200.0, noise());
    let mut second = S::defaults(60.0, GyroNoise::from_density_two_sided(0.1));
    second.visit(&mut Changes(shown(&first)));
    assert_eq!(first, second, "{}", S::METHOD);
}

/// Every number is looked at: what is none is refused by its own name.
fn refuses_what_is_no_number<S: Settings>() {
    // The noise has a check of its own, and some methods take none of it.
    let used = |name: &&str| !name.starts_with("noise.");
    for name in shown(&S::defaults(200.0, noise())).numbers.into_keys().filter(used) {
        let error = refusal(&with::<S>(name, f64::NAN));
        let pair = ["tau_s", "forgetting_factor"];
        let named = error.field == name || (pair.contains(&name) && pair.contains(&error.field));
        assert!(named, "{}: {name} = NaN gives {error}", S::METHOD);
        assert!(error.to_string().contains("must be"), "{error}");
    }
}

/// Tiles of four channels give the bits of one channel at a time: regular and odd steps, missing and absurd samples.
fn four_channels_have_the_bits_of_one<S: Settings, T: Real>() {
    const CHANNELS: usize = 4;
    let filter = S::defaults(200.0, noise()).build::<T>().unwrap();
    let sample = |k: usize, c: usize| {
        let wave = 3.0 * (0.05 * k as f64 + c as f64).sine_cosine().0;
        T::of(match (k * CHANNELS + c) % 41 {
            7 => f64::NAN,
            11 => f64::INFINITY,
            13 => 1e30,
            _ => wave + 0.2 * ((k * 7919 + c * 104_729) % 1000) as f64 / 1000.0,
        })
    };
    let mut lanes = vec![[T::ZERO; CHANNELS]; <<S::Filter<T> as Filter<T>>::State as Reals<T>>::COUNT];
    (0..CHANNELS).for_each(|c| block::store(&filter.start(), &mut lanes, c));
    let mut single = [filter.start(); CHANNELS];
    for part in 0..40 {
        let nominal = filter.period();
        let dt = if part % 4 == 3 { nominal * T::of(1.5) } else { nominal };
        let mut tile: Vec<[T; CHANNELS]> =
            (0..25).map(|k| core::array::from_fn(|c| sample(25 * part + k, c))).collect();
        let raw = tile.clone();
        filter.tile(&mut lanes, &mut tile, dt);
        for (row, out) in raw.iter().zip(&tile) {
            for c in 0..CHANNELS {
                let alone = filter.step(&mut single[c], Sample { value: row[c], dt }).rate;
                assert_eq!(alone.widen().to_bits(), out[c].widen().to_bits(), "{} channel {c}", S::METHOD);
            }
        }
    }
    for (c, state) in single.iter().enumerate() {
        let wide: <S::Filter<T> as Filter<T>>::State = block::load(&lanes, c);
        assert_eq!(&wide, state, "{} channel {c}", S::METHOD);
    }
    assert!(filter.models() >= 1 && filter.models() <= 15);
}

macro_rules! for_every_method {
    ($($name:ident),* $(,)?) => {
        #[test]
        fn settings_that_are_shown_and_taken_back_are_the_same() {
            $(shows_all_of_itself::<filters::$name>();)*
        }
        #[test]
        fn a_setting_that_is_no_number_is_refused_by_its_name() {
            $(refuses_what_is_no_number::<filters::$name>();)*
        }
        #[test]
        fn a_tile_of_four_channels_has_the_bits_of_one_in_double_precision() {
            $(four_channels_have_the_bits_of_one::<filters::$name, f64>();)*
        }
        #[test]
        fn a_tile_of_four_channels_has_the_bits_of_one_in_single_precision() {
            $(four_channels_have_the_bits_of_one::<filters::$name, f32>();)*
        }
    };
}
stillrate::methods!(for_every_method);

#[test]
fn a_memory_given_either_way_is_the_same() {
    use filters::RecursiveLeastSquaresSettings as Rls;
    let (by_factor, by_time) = (with::<Rls>("forgetting_factor", 0.95), with::<Rls>("tau_s", 0.5));
    assert!((by_factor.tau_s - -0.005 / 0.95_f64.ln()).abs() < 1e-12);
    assert!((by_time.forgetting_factor - (-0.01_f64).exp()).abs() < 1e-15);
    assert_eq!(with::<Rls>("forgetting_factor", 1.0).tau_s, f64::INFINITY);
    let both = Rls { tau_s: 0.5, forgetting_factor: 0.5, ..Rls::defaults(200.0, noise()) };
    assert_eq!(refusal(&both).field, "forgetting_factor");
    assert_eq!(refusal(&with::<Rls>("order", 1.5)).field, "order");
}

#[test]
fn one_value_of_a_pair_serves_both_models_and_three_serve_none() {
    use filters::SingerImmKfSettings as SingerImm;
    let change = |values: Vec<f64>| {
        let mut changes = Changes::default();
        changes.0.lists.insert("alpha_per_s", values);
        let mut settings = SingerImm::defaults(200.0, noise());
        settings.visit(&mut changes);
        settings
    };
    assert_eq!(change(vec![0.02]).pair.alpha_per_s, [0.02; 2]);
    assert_eq!(change(vec![0.02, 0.03]).pair.alpha_per_s, [0.02, 0.03]);
    assert_eq!(refusal(&change(vec![])).field, "alpha_per_s");
    let odd = [[1.5, -0.5, 0.05, 0.95], [0.9, 0.2, 0.05, 0.95], [0.95, 0.05, 0.05, f64::NAN]];
    for transition in odd {
        let mut settings = SingerImm::defaults(200.0, noise());
        settings.pair.transition = transition;
        assert_eq!(refusal(&settings).field, "transition");
    }
    let mut unsure = SingerImm::defaults(200.0, noise());
    unsure.pair.initial_probability = [0.5, 0.4];
    assert_eq!(refusal(&unsure).field, "initial_probability");
}

#[test]
fn a_choice_sets_the_settings_that_follow_from_it() {
    use filters::{MsImmIkfPaperSettings as Paper, VariableForgettingSettings as Variable};
    for (mode, fading, noise_density) in [(0, 2, 0.0), (1, 1, 1e-6), (2, 0, 1e-6), (3, 0, 0.01)] {
        let mut changes = Changes::default();
        changes.0.words.insert("mode", mode);
        let mut settings = Paper::defaults(200.0, noise());
        settings.visit(&mut changes);
        assert_eq!((settings.fading, settings.alpha_noise_density[1]), (fading, noise_density), "mode {mode}");
        assert!(settings.build::<f64>().is_ok());
    }
    let mut changes = Changes::default();
    changes.0.words.insert("fading_source", 1);
    let mut settings = Paper::defaults(200.0, noise());
    settings.visit(&mut changes);
    assert_eq!(settings.fading_scale, 1.0);
    assert_eq!(with::<Variable>("order", 2.0).forgetting_factor_max, 0.98);
}

#[test]
fn settings_that_contradict_each_other_are_refused_by_name() {
    use filters::{
        CusumForgettingSettings as Cusum, FirLowPassSettings as Fir, MsImmIkfPaperSettings as Paper,
        MsImmIkfSettings as Bank, VariableForgettingSettings as Variable,
    };
    let paper = Paper::defaults(200.0, noise());
    assert_eq!(refusal(&Paper { jacobian: 1, ..paper.clone() }).field, "jacobian");
    assert_eq!(refusal(&Paper { static_stay_probability: 1.5, ..paper.clone() }).field, "static_stay_probability");
    assert_eq!(refusal(&Paper { fading_memory: 1.0, ..paper }).field, "fading_memory");
    assert_eq!(refusal(&with::<Variable>("forgetting_factor_min", 0.99)).field, "forgetting_factor_min");
    assert_eq!(refusal(&with::<Cusum>("samples_kept", 0.5)).field, "samples_kept");
    assert_eq!(refusal(&Bank { ladder_count: 0, ..Bank::defaults(200.0, noise()) }).field, "ladder_hz");
    assert_eq!(refusal(&with::<Bank>("outlier_probability", 0.5)).field, "outlier_probability");
    assert_eq!(refusal(&with::<Bank>("sample_rate_hz", 1e6)).field, "sample_rate_hz");
    let silent = Bank::defaults(200.0, GyroNoise::from_density_two_sided(1e-14));
    assert_eq!(refusal(&silent).field, "noise.density_dps_sqrt_hz");
    let fir = Fir::defaults(200.0, noise());
    // Hann and Blackman windows of two taps are all zeros, the one exactly and the other but for rounding.
    for window in [1, 3] {
        assert_eq!(refusal(&Fir { window, length: 2.0, ..fir.clone() }).field, "length");
    }
    assert_eq!(refusal(&Fir { cutoff_hz: 100.0, ..fir.clone() }).field, "cutoff_hz");
    let mut taps = fir;
    taps.tap_count = 2;
    taps.taps[1] = f64::INFINITY;
    assert_eq!(refusal(&taps).field, "taps");
}

/// Counts what a plain value consists of.
#[derive(Debug, Default)]
struct Counted {
    numbers: Vec<f64>,
    counts: usize,
    fields: Vec<&'static str>,
    depth: isize,
}

impl Outline for Counted {
    fn number(&mut self, value: f64) {
        self.numbers.push(value);
    }
    fn count(&mut self, _: u32) {
        self.counts += 1;
    }
    fn array(&mut self, length: usize) {
        assert!(length > 0);
        self.depth += 1;
    }
    fn end_array(&mut self) {
        self.depth -= 1;
    }
    fn open(&mut self, name: &'static str, about: &[&'static str]) {
        assert!(!about.is_empty(), "{name} has no description");
        self.depth += 1;
    }
    fn field(&mut self, name: &'static str, about: &[&'static str]) {
        assert!(!about.is_empty(), "{name} has no description");
        self.fields.push(name);
    }
    fn close(&mut self) {
        self.depth -= 1;
    }
}

#[test]
fn a_configuration_tells_every_number_of_its_memory() {
    use filters::{FirLowPassSettings, MsImmIkf, MsImmIkfSettings};
    let fir = FirLowPassSettings { length: 3.0, ..FirLowPassSettings::defaults(200.0, noise()) };
    let filter = fir.build::<f64>().unwrap();
    let mut told = Counted::default();
    filter.outline(&mut told);
    assert_eq!(told.numbers.len() * 8, core::mem::size_of_val(&filter));
    assert_eq!((told.fields[0], told.fields[1], told.depth), ("period_s", "taps", 0));
    assert!((told.numbers[1..4].iter().sum::<f64>() - 1.0).abs() < 1e-15);
    let bank: MsImmIkf<f32> = MsImmIkfSettings::defaults(200.0, noise()).build().unwrap();
    let mut told = Counted::default();
    bank.outline(&mut told);
    assert_eq!((told.numbers.len() + told.counts) * 4, core::mem::size_of_val(&bank));
    let mut state = Counted::default();
    bank.start().outline(&mut state);
    assert_eq!(state.numbers.len(), <<MsImmIkf<f32> as Filter<f32>>::State as Reals<f32>>::COUNT);
}
