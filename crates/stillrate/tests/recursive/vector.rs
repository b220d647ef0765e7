use stillrate::Flags;
use stillrate::filters::{VectorRls, VectorRlsSettings, VectorRlsState};

use crate::Noise;

/// P <- (P - k phi'P)/lambda, as textbooks print it: only to show how it fails.
struct Conventional<const N: usize> {
    p: [[f32; N]; N],
    lambda: f32,
}

impl<const N: usize> Conventional<N> {
    fn new(lambda: f32) -> Self {
        let mut p = [[0.0; N]; N];
        (0..N).for_each(|i| p[i][i] = 100.0);
        Self { p, lambda }
    }
    /// False once P is no covariance any more.
    fn step(&mut self, phi: [f32; N]) -> bool {
        let p_phi: [f32; N] = core::array::from_fn(|i| (0..N).map(|j| self.p[i][j] * phi[j]).sum());
        let scale = self.lambda + (0..N).map(|i| phi[i] * p_phi[i]).sum::<f32>();
        for i in 0..N {
            for j in 0..N {
                self.p[i][j] = (self.p[i][j] - p_phi[i] * p_phi[j] / scale) / self.lambda;
            }
        }
        (0..N).all(|i| self.p[i][i] > 0.0 && self.p[i][i].is_finite())
    }
}

/// The stretches of a run of `total` samples: exciting, a fifth constant, a tenth zero, a tenth nearly collinear, exciting.
fn regressor<const N: usize>(noise: &mut Noise, k: usize, total: usize) -> [f32; N] {
    let fresh: [f64; N] = core::array::from_fn(|_| noise.normal());
    let tenths = 10 * k / total;
    let phi = match tenths {
        2 | 3 => [1.0; N],
        5 => [0.0; N],
        7 => core::array::from_fn(|i| fresh[0] * (i as f64 + 1.0) + 1e-4 * fresh[i]),
        _ => fresh,
    };
    phi.map(|x| x as f32)
}

fn wind_up<const N: usize>(total: usize, lambda: f64) {
    let rls = VectorRls::<f32, N>::new(VectorRlsSettings { forgetting_factor: lambda, ..Default::default() }).unwrap();
    let mut state: VectorRlsState<f32, N> = rls.start();
    let mut conventional = Conventional::<N>::new(lambda as f32);
    let mut broke = None;
    let mut noise = Noise(20_260 + N as u64);
    let truth: [f32; N] = core::array::from_fn(|i| 1.0 - 0.4 * i as f32);
    let (mut smallest, mut widest) = (f32::MAX, 0.0_f32);
    for k in 0..total {
        let phi = regressor::<N>(&mut noise, k, total);
        let y = phi.iter().zip(truth).map(|(a, b)| a * b).sum::<f32>() + (0.02 * noise.normal()) as f32;
        rls.step(&mut state, phi, y);
        if broke.is_none() && !conventional.step(phi) {
            broke = Some(k);
        }
        smallest = state.diagonal.iter().fold(smallest, |least, &d| least.min(d));
        widest = widest.max(state.trace());
    }
    let error = state.weights.iter().zip(truth).map(|(w, t)| (w - t).abs()).fold(0.0, f32::max);
    println!(
        "N {N} lambda {lambda}: min D {smallest:.1e}, trace {widest:.4e}, error {error:.4}, conventional broke at {broke:?}"
    );
    assert!(smallest > 0.0, "a factor of {N} weights is not positive");
    assert!(widest <= 1e4 * (1.0 + 1e-5), "trace {widest} above its cap");
    assert!(error < 0.03, "error {error} of {N} weights");
    let constant = total / 5..2 * total / 5;
    assert!(broke.is_some_and(|k| constant.contains(&k)), "the conventional form should have failed: {broke:?}");
}

#[test]
fn directional_forgetting_survives_where_the_conventional_form_winds_up() {
    wind_up::<3>(1_000_000, 0.9512);
    wind_up::<6>(1_000_000, 0.9512);
}

#[test]
#[ignore = "four runs of ten million samples"]
fn directional_forgetting_survives_ten_million_samples() {
    for lambda in [0.9512, 0.999] {
        wind_up::<3>(10_000_000, lambda);
        wind_up::<6>(10_000_000, lambda);
    }
}

#[test]
fn one_weight_is_the_scalar_filter() {
    // With phi = 1 and P0 = 1/lambda - 1 + ... the steady variance after an update is 1 - lambda.
    let lambda = 0.9512;
    let rls = VectorRls::<f64, 1>::new(VectorRlsSettings { forgetting_factor: lambda, ..Default::default() }).unwrap();
    let mut state = rls.start();
    for _ in 0..2000 {
        rls.step(&mut state, [1.0], 3.0);
    }
    assert!((state.covariance()[0][0] - (1.0 - lambda)).abs() < 1e-12);
    assert!((state.weights[0] - 3.0).abs() < 1e-12);
}

#[test]
fn what_cannot_be_used_changes_nothing() {
    let rls = VectorRls::<f64, 2>::new(VectorRlsSettings::default()).unwrap();
    let mut state = rls.start();
    rls.step(&mut state, [1.0, 0.5], 2.0);
    let before = state;
    assert!(rls.step(&mut state, [f64::NAN, 0.0], 1.0).flags.has(Flags::MISSING));
    assert!(rls.step(&mut state, [1.0, 0.0], f64::INFINITY).flags.has(Flags::MISSING));
    assert!(rls.step(&mut state, [1e200, 0.0], 1.0).flags.has(Flags::MISSING)); // its square overflows
    rls.step(&mut state, [0.0, 0.0], 1.0);
    rls.step(&mut state, [1e-7, 0.0], 1.0);
    assert_eq!(state, before);
}

#[test]
fn forgetting_factors_outside_the_unit_interval_are_refused() {
    for lambda in [0.0, -0.5, 1.5, f64::NAN] {
        let settings = VectorRlsSettings { forgetting_factor: lambda, ..Default::default() };
        assert_eq!(VectorRls::<f64, 3>::new(settings).unwrap_err().field, "forgetting_factor");
    }
}
