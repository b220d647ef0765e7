//! Runs one filter over a fixed signal, so that callgrind can count its instructions.
use stillrate::filters::{MsImmIkfSettings, SingerImmKfSettings};
use stillrate::{Filter, GyroNoise, Real, Reals, Settings, block};
use std::time::Instant;

#[target_feature(enable = "avx2")]
fn tile_avx2<T: Real, F: Filter<T>, const W: usize>(filter: &F, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
    filter.tile(lanes, tile, dt);
}
#[inline(never)]
fn tile_plain<T: Real, F: Filter<T>, const W: usize>(filter: &F, lanes: &mut [[T; W]], tile: &mut [[T; W]], dt: T) {
    filter.tile(lanes, tile, dt);
}

fn run<T: Real, F: Filter<T>, const W: usize>(name: &str, filter: &F, rows: usize, avx2: bool) {
    let mut lanes = vec![[T::ZERO; W]; <F::State as Reals<T>>::COUNT];
    for c in 0..W { block::store(&filter.start(), &mut lanes, c); }
    let mut seed = 1_u64;
    let mut signal: Vec<[T; W]> = Vec::new();
    for k in 0..rows {
        let x = T::of(5.0 * ((k % 400) as f64 / 200.0 - 1.0));
        let mut row = [x; W];
        for c in 0..W {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            row[c] += T::of(((seed >> 33) as f64 / (1u64 << 31) as f64 - 0.5) * 0.3);
        }
        signal.push(row);
    }
    let mut best = f64::MAX;
    let mut sum = 0.0;
    for _ in 0..std::env::var("REPEATS").map_or(20, |r| r.parse().unwrap()) {
        let mut s = signal.clone();
        let t = Instant::now();
        for tile in s.chunks_mut(128) {
            if avx2 { unsafe { tile_avx2(filter, &mut lanes, tile, filter.period()) } }
            else { tile_plain(filter, &mut lanes, tile, filter.period()) }
        }
        best = best.min(t.elapsed().as_secs_f64() / (rows * W) as f64 * 1e9);
        sum += s.iter().map(|r| r[0].widen()).sum::<f64>();
    }
    println!("{name:40} {best:8.2} ns/channel-sample  {sum}");
}

fn main() {
    let which = std::env::args().nth(1).unwrap_or_default();
    let noise = GyroNoise::from_density_two_sided(0.015).with_rate_random_walk(0.003);
    let rows = 4096;
    macro_rules! go { ($($name:literal $s:ident $t:ident $w:literal $avx:literal;)*) => {$(
        if $name.contains(&which) {
            let filter = $s::defaults(1000.0, noise).build::<$t>().unwrap();
            run::<$t, _, $w>($name, &filter, rows, $avx);
        })*
    } }
    go! {
        "imm2-f64-1" SingerImmKfSettings f64 1 false;
        "imm2-f64-8-avx2" SingerImmKfSettings f64 8 true;
        "imm2-f32-16-avx2" SingerImmKfSettings f32 16 true;
        "bank-f64-1" MsImmIkfSettings f64 1 false;
        "bank-f64-8-avx2" MsImmIkfSettings f64 8 true;
        "bank-f32-16-avx2" MsImmIkfSettings f32 16 true;
    }
}
