//! Numbers drawn at random, the same ones in every run.

/// PCG-XSH-RR with 64 bits of state and 32 of output (O'Neill, "PCG: A Family of Simple Fast Space-Efficient
/// Statistically Good Algorithms for Random Number Generation", 2014).
#[derive(Clone, Debug)]
pub struct Pcg32 {
    state: u64,
    increment: u64,
}

impl Pcg32 {
    /// The generator that `pcg32_srandom_r(seed, stream)` makes.
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut new = Self { state: 0, increment: stream << 1 | 1 };
        new.draw();
        new.state = new.state.wrapping_add(seed);
        new.draw();
        new
    }

    /// The next 32 bits.
    pub fn draw(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(self.increment);
        let shifted = ((old >> 18 ^ old) >> 27) as u32;
        shifted.rotate_right((old >> 59) as u32)
    }

    /// A number in 0..1, of 24 bits.
    pub fn unit(&mut self) -> f32 {
        (self.draw() >> 8) as f32 / (1 << 24) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_numbers_are_those_of_the_published_demo() {
        // `pcg32-demo` with seed 42 and stream 54, first round.
        let mut random = Pcg32::new(42, 54);
        let drawn: [u32; 6] = std::array::from_fn(|_| random.draw());
        assert_eq!(drawn, [0xa15c_02b7, 0x7b47_f409, 0xba1d_3330, 0x83d2_f293, 0xbfa4_784b, 0xcbed_606e]);
    }

    #[test]
    fn units_stay_below_one() {
        let mut random = Pcg32::new(1, 1);
        assert!((0..10_000).all(|_| (0.0..1.0).contains(&random.unit())));
    }
}
