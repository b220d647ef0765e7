//! Random numbers from an explicit seed: the same on every platform, for any number of threads.
//!
//! Integers come from SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014) and
//! xoshiro256++ (Blackman and Vigna, "Scrambled linear pseudorandom number generators", 2021). Normal deviates are
//! Box and Muller's (1958): r = sqrt(-2 ln u), angle 2 pi v, built on the elementary functions of [`stillrate::Real`],
//! never on the system's. Independent work takes its own `stream` of a seed, so results do not depend on who runs it.

use core::f64::consts::TAU;

use stillrate::Real;

/// 2^-53: turns the upper 53 bits of a word into a number in 0..1.
const UNIT: f64 = 1.0 / (1_u64 << 53) as f64;
/// 2^64 divided by the golden ratio, made odd: SplitMix64's step.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A source of random numbers: whatever yields 64 random bits.
///
/// # Example
/// ```
/// use stillrate_lab::random::{Generator, SplitMix64};
/// let mut random = SplitMix64::new(7);
/// let mean = (0..10_000).map(|_| random.uniform()).sum::<f64>() / 1e4;
/// assert!((mean - 0.5).abs() < 4.0 / 120_000.0_f64.sqrt()); // four standard errors: the variance is a twelfth
/// let sixes = (0..600).filter(|_| random.below(6) == 5).count();
/// assert!((64..=136).contains(&sixes)); // a fair die: 100 and four standard deviations
/// let top_bits = (0..1000).filter(|_| random.bits() >> 63 == 1).count();
/// assert!((437..=563).contains(&top_bits)); // a fair coin
/// ```
pub trait Generator {
    /// The next 64 bits.
    fn bits(&mut self) -> u64;
    /// Uniform in 0 <= u < 1, 53 bits: (x >> 11) 2^-53.
    fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * UNIT
    }
    /// A whole number in `0..bound` without bias (0 when `bound` is 0).
    fn below(&mut self, bound: u64) -> u64 {
        if bound == 0 {
            return 0;
        }
        // Words at or above the largest multiple of the bound would favour small numbers: draw again.
        let limit = u64::MAX - u64::MAX % bound;
        loop {
            let word = self.bits();
            if word < limit {
                return word % bound;
            }
        }
    }
}

/// SplitMix64: one word of state, any seed is good.
///
/// # Example
/// ```
/// use stillrate_lab::random::{Generator, SplitMix64};
/// assert_eq!(SplitMix64::new(12345).uniform(), 0.1330796686614273);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SplitMix64 {
    state: u64,
}

impl SplitMix64 {
    /// The sequence of a seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self { state: seed }
    }
}

impl Generator for SplitMix64 {
    fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(GOLDEN);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

/// xoshiro256++ with numbered streams: the generator of every simulation here.
///
/// # Example
/// ```
/// use stillrate_lab::random::{Generator, Random};
/// assert_eq!(Random::new(1, 0).bits(), Random::new(1, 0).bits());
/// assert_ne!(Random::new(1, 0).bits(), Random::new(1, 1).bits());
///
/// let noise = Random::new(7, 0).normals(10_000);
/// assert_eq!(noise[0], Random::new(7, 0).normal()); // the same numbers, all at once or one by one
/// let variance = noise.iter().map(|x| x * x).sum::<f64>() / 1e4;
/// assert!((variance - 1.0).abs() < 4.0 * 2e-4_f64.sqrt()); // four standard errors
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Random {
    state: [u64; 4],
    spare: Option<f64>,
}

impl Random {
    /// Stream number `stream` of a seed. Streams start at unrelated points of a sequence of period 2^256.
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut key =
            SplitMix64::new(SplitMix64::new(seed).bits() ^ SplitMix64::new(stream.wrapping_mul(GOLDEN) ^ 1).bits());
        Self { state: core::array::from_fn(|_| key.bits()), spare: None }
    }

    /// One standard normal deviate (the pair's second half is kept for the next call).
    pub fn normal(&mut self) -> f64 {
        if let Some(second) = self.spare.take() {
            return second;
        }
        // 1 - u lies in (0, 1], where the logarithm is finite.
        let radius = (-2.0 * (1.0 - self.uniform()).logarithm()).root();
        let (sine, cosine) = (TAU * self.uniform()).sine_cosine();
        self.spare = Some(radius * sine);
        radius * cosine
    }

    /// `count` standard normal deviates.
    #[must_use]
    pub fn normals(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.normal()).collect()
    }
}

impl Generator for Random {
    fn bits(&mut self) -> u64 {
        let [a, b, c, d] = self.state;
        let out = a.wrapping_add(d).rotate_left(23).wrapping_add(a);
        let (c, d) = (c ^ a, d ^ b);
        let (b, a) = (b ^ c, a ^ d);
        self.state = [a, b, c ^ (self.state[1] << 17), d.rotate_left(45)];
        out
    }
}

#[cfg(test)]
mod tests {
    use super::{Generator, Random, SplitMix64};

    #[test]
    fn splitmix_gives_the_published_sequence() {
        let mut generator = SplitMix64::new(12345);
        let expected = [0.133_079_668_661_427_3, 0.204_816_633_361_659_12, 0.119_542_583_009_115_47];
        for value in expected {
            assert_eq!(generator.uniform(), value);
        }
    }

    #[test]
    fn xoshiro_follows_its_definition_written_literally() {
        let mut generator = Random { state: [1, 2, 3, 4], spare: None };
        let mut s = [1_u64, 2, 3, 4];
        for _ in 0..1000 {
            let result = s[0].wrapping_add(s[3]).rotate_left(23).wrapping_add(s[0]);
            let t = s[1] << 17;
            s[2] ^= s[0];
            s[3] ^= s[1];
            s[1] ^= s[2];
            s[0] ^= s[3];
            s[2] ^= t;
            s[3] = s[3].rotate_left(45);
            assert_eq!(generator.bits(), result);
        }
    }

    #[test]
    fn normal_deviates_have_the_moments_of_a_normal() {
        let n = 200_000.0;
        let z = Random::new(3, 9).normals(200_000);
        let moment = |p: i32| z.iter().map(|x| (0..p).fold(1.0, |a, _| a * x)).sum::<f64>() / n;
        // Four standard errors: var(z^p)/n with var 1, 2, 15, 96.
        assert!(moment(1).abs() < 4.0 * (1.0 / n).sqrt());
        assert!((moment(2) - 1.0).abs() < 4.0 * (2.0 / n).sqrt());
        assert!(moment(3).abs() < 4.0 * (15.0 / n).sqrt());
        assert!((moment(4) - 3.0).abs() < 4.0 * (96.0 / n).sqrt());
        let lag = z.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / n;
        assert!(lag.abs() < 4.0 * (1.0 / n).sqrt());
    }

    #[test]
    fn streams_of_one_seed_are_uncorrelated() {
        let a = Random::new(5, 0).normals(100_000);
        let b = Random::new(5, 1).normals(100_000);
        let c = a.iter().zip(&b).map(|(x, y)| x * y).sum::<f64>() / 1e5;
        assert!(c.abs() < 4.0 / 1e5_f64.sqrt());
    }

    #[test]
    fn the_first_numbers_of_a_stream_never_change() {
        let mut random = Random::new(2026, 3);
        let first: Vec<u64> = (0..3).map(|_| random.bits()).collect();
        assert_eq!(first, FIRST);
        assert_eq!(Random::new(2026, 3).normal().to_bits(), FIRST_NORMAL);
    }
    const FIRST: [u64; 3] = [0x1e6d_ab1e_c9f0_8533, 0xe8fc_1783_982c_a71a, 0x5d03_d7c2_092a_6e8c];
    const FIRST_NORMAL: u64 = 0x3fdb_31e2_8762_fa45;

    #[test]
    fn whole_numbers_stay_below_their_bound_and_reach_it() {
        let mut random = Random::new(1, 1);
        let mut seen = [false; 6];
        for _ in 0..1000 {
            seen[random.below(6) as usize] = true;
        }
        assert_eq!(seen, [true; 6]);
        assert_eq!(random.below(0), 0);
    }
}
