//! Seeded numbers and directions.

use vitrum::math::Vector3;

/// `SplitMix64` (Steele, Lea & Flood 2014).
pub struct Rng(u64);

impl Rng {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in 0..1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform on the sphere.
    pub fn direction(&mut self) -> Vector3<f64> {
        loop {
            let v = Vector3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0));
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalized();
            }
        }
    }

    /// A normal, and a direction of travel that meets it at `angle`, as an `f32` ray tracer has them.
    pub fn meeting_at(&mut self, angle: f64) -> (Vector3<f32>, Vector3<f32>) {
        let normal = self.direction();
        let across = normal.cross(self.direction()).normalized();
        let incident = across * angle.sin() - normal * angle.cos();
        (narrow(incident), narrow(normal))
    }
}

pub fn narrow(v: Vector3<f64>) -> Vector3<f32> {
    Vector3::new(v.x as f32, v.y as f32, v.z as f32)
}

pub fn widen(v: Vector3<f32>) -> Vector3<f64> {
    Vector3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z))
}

pub fn bits(v: Vector3<f32>) -> [u32; 3] {
    [v.x.to_bits(), v.y.to_bits(), v.z.to_bits()]
}

/// Angle of incidence past which nothing leaves the denser medium.
pub fn critical_angle(n1: f64, n2: f64) -> f64 {
    (n2 / n1).asin()
}
