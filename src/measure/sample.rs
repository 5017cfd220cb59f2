//! Seeded random numbers, directions, and rays aimed without rounding.

use glam::{DVec3, Vec3};

use crate::math::Vector3;

/// `SplitMix64` generator (Steele, Lea & Flood 2014).
#[derive(Clone, Debug)]
pub(crate) struct Rng(u64);

impl Rng {
    /// Creates the stream of a batch of a group.
    pub fn new(group: &str, batch: usize) -> Self {
        let seed =
            group.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |h, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
        let mut rng = Self(seed ^ (batch as u64).wrapping_mul(0xd6e8_feb8_6659_fd93));
        rng.bits();
        rng
    }

    /// Returns 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a random index in 0..n, for n of at least 1.
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.bits()) * n as u128) >> 64) as usize
    }

    /// Returns a uniform number in 0..1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a uniform number between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Returns a uniform point of the cube -1..1.
    pub fn point(&mut self) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| self.between(-1.0, 1.0)))
    }

    /// Returns a uniform direction.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.point();
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    /// Returns a direction of travel and a normal at `angle` to each other, as `f32`.
    pub fn meeting_at(&mut self, angle: f64) -> (Vector3<f32>, Vector3<f32>) {
        let (incident, normal) = self.unit_meeting_at(angle);
        (incident.as_vec3().into(), normal.as_vec3().into())
    }

    /// Returns a direction of travel and a normal at `angle` to each other.
    pub fn unit_meeting_at(&mut self, angle: f64) -> (DVec3, DVec3) {
        let normal = self.direction();
        let across = loop {
            let v = normal.cross(self.direction());
            if v.length_squared() > 1e-3 {
                break v.normalize();
            }
        };
        (across * angle.sin() - normal * angle.cos(), normal)
    }

    /// Returns arbitrary bits, or one of the special values.
    pub fn awkward(&mut self) -> f32 {
        const SPECIAL: [f32; 10] =
            [0.0, -0.0, 1.0, -1.0, 1e-45, f32::MIN_POSITIVE, f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
        match self.below(4) {
            0 => SPECIAL[self.below(SPECIAL.len())],
            1 => self.between(-1.0, 1.0) as f32,
            _ => f32::from_bits(self.bits() as u32),
        }
    }
}

/// Returns an origin near `around` (within `spread` along each axis) from which the vector to `target` is exact in
/// `f32`, so that the ray really is aimed there.
pub(crate) fn exact_start(rng: &mut Rng, target: Vec3, around: DVec3, spread: DVec3) -> Option<Vec3> {
    let mut start = Vec3::ZERO;
    for axis in 0..3 {
        let to = f64::from(target[axis]);
        let exact = |from: f32| f64::from(target[axis] - from) == to - f64::from(from);
        // Grid of the target itself: the difference between the target and a smaller number on this grid has no more
        // digits.
        let grid = f64::from(crate::math::ulp(target[axis]));
        let tries = (0..12).map(|i| {
            let from = around[axis] + spread[axis] * rng.between(-1.0, 1.0);
            if i < 4 { from as f32 } else { ((from / grid).round() * grid) as f32 }
        });
        let found = tries.chain([around[axis] as f32]).find(|&from| exact(from));
        start[axis] = found?;
    }
    Some(start)
}
