//! Shapes and rays that several tests share, and the promise that every accelerator keeps.

#![allow(dead_code, reason = "each test uses its own part")]

pub mod aim;
pub mod backends;
pub mod contract;
pub mod cracks;
pub mod exact;
pub mod gltf;
pub mod kernels;
pub mod program;
pub mod random;
pub mod scenes;
pub mod shapes;

/// Numbers without an end, the same in every run (PCG-XSH-RR, O'Neill 2014).
pub struct Rng(u64);

impl Rng {
    /// A stream of its own for each seed.
    pub fn new(seed: u64) -> Self {
        let mut rng = Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        rng.bits();
        rng
    }

    /// 32 random bits.
    pub fn bits(&mut self) -> u32 {
        let old = self.0;
        self.0 = old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mixed = (((old >> 18) ^ old) >> 27) as u32;
        mixed.rotate_right((old >> 59) as u32)
    }

    /// In 0..n.
    pub fn below(&mut self, n: usize) -> usize {
        ((u64::from(self.bits()) * n as u64) >> 32) as usize
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / (1 << 24) as f32
    }

    /// In [-1, 1).
    pub fn signed(&mut self) -> f32 {
        self.unit() * 2.0 - 1.0
    }

    /// In the cube [-1, 1)³.
    pub fn point(&mut self) -> glam::Vec3 {
        glam::Vec3::new(self.signed(), self.signed(), self.signed())
    }

    /// A direction of about unit length.
    pub fn direction(&mut self) -> glam::Vec3 {
        loop {
            let p = self.point();
            let l = p.length();
            if (0.01..1.0).contains(&l) {
                return p / l;
            }
        }
    }
}
