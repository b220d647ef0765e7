//! Numbers, choices and time steps out of the fuzzer's bytes, with a leaning towards values where things break.

/// Reads what a target asks for; zeros once the bytes are used up.
pub struct Input<'a>(pub &'a [u8]);

impl Input<'_> {
    /// Whether anything is left.
    pub fn any(&self) -> bool {
        !self.0.is_empty()
    }

    /// The next byte.
    pub fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    /// The next so many bytes.
    pub fn bytes<const N: usize>(&mut self) -> [u8; N] {
        core::array::from_fn(|_| self.byte())
    }

    /// One of `count`.
    pub fn choice(&mut self, count: usize) -> usize {
        usize::from(self.byte()) % count
    }

    /// Any number at all: ordinary ones, special ones, any bit pattern.
    pub fn number(&mut self) -> f64 {
        const SPECIAL: [f64; 24] = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            0.02,
            50.0,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN_POSITIVE,
            5e-324,
            1e-310,
            f32::MAX as f64,
            1e38,
            1e30,
            1e-38,
            1e-45,
            1e-46,
            1e10,
            1e-10,
            16_777_216.0,
            0.5,
            2000.0,
        ];
        match self.byte() {
            tag @ 0..=95 => {
                f64::from(i16::from_le_bytes(self.bytes())) / [1.0, 16.0, 256.0, 4096.0, 65_536.0][usize::from(tag) % 5]
            }
            tag @ 96..=191 => SPECIAL[usize::from(tag) % SPECIAL.len()],
            192..=223 => f64::from(f32::from_le_bytes(self.bytes())),
            _ => f64::from_le_bytes(self.bytes()),
        }
    }

    /// A time step: mostly the nominal one.
    pub fn time_step(&mut self, period_s: f64) -> f64 {
        match self.byte() {
            0..=159 => period_s,
            tag @ 160..=199 => period_s * f64::from(tag - 159) / 4.0,
            _ => self.number(),
        }
    }
}
