//! The native path by each of its kernels, and what all of them must equal: testing everything.

use vitrum::accel::native::{Kernel, Native, Scratch};
use vitrum::accel::{BuildQuality, BuildStats, Coherence, Intersector, Unbounded};
use vitrum::geometry::{Geometry, Hit, Hit8, Ray, Ray8, Shape};
use vitrum::simd::Mask8;

use super::contract::{self, bits};

/// The native accelerator, held to one kernel.
pub struct Held(pub Native, pub Kernel);

impl Intersector for Held {
    type Scratch = Scratch;
    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], coherence: Coherence, scratch: &mut Scratch) {
        self.0.closest_with(self.1, rays, hits, coherence, scratch);
    }
    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], coherence: Coherence, scratch: &mut Scratch) {
        self.0.occluded_with(self.1, rays, blocked, coherence, scratch);
    }
    fn build_stats(&self) -> BuildStats {
        self.0.build_stats()
    }
}

pub const KERNELS: [Kernel; 4] = [Kernel::Single, Kernel::Packet, Kernel::Stream, Kernel::Auto];

/// A tree whose every invariant was checked.
pub fn sound(geometry: &[Geometry]) -> Native {
    sound_as(geometry, BuildQuality::Default)
}

/// The same of any quality.
pub fn sound_as(geometry: &[Geometry], quality: BuildQuality) -> Native {
    let native = Native::build_as(geometry, quality);
    native.validate(geometry).unwrap();
    native
}

/// Every triangle, sphere and plane in turn, by the scalar tests.
pub fn brute_force(geometry: &[Geometry], ray: &Ray) -> Hit {
    let mut best = Hit::MISS;
    let mut take = |met: Option<(f32, f32, f32)>, geometry: u32, primitive: u32| {
        let Some((t, u, v)) = met else { return };
        let hit = Hit { t, u, v, instance: 0, geometry, primitive };
        if t < best.t || (t == best.t && hit.id() < best.id()) {
            best = hit;
        }
    };
    for (g, id) in geometry.iter().zip(0..).filter(|(g, _)| g.mask.meets(ray.admits)) {
        match &g.shape {
            Shape::Mesh(mesh) => {
                for i in (0..mesh.triangles.len()).filter(|&i| mesh.is_usable(i)) {
                    take(vitrum::geometry::intersect_triangle(ray, mesh.corners(i)), id, i as u32);
                }
            }
            Shape::Sphere(s) => take(s.intersect(ray).map(|t| (t, 0.0, 0.0)), id, 0),
            Shape::Plane(p) => take(p.intersect(ray).map(|t| (t, 0.0, 0.0)), id, 0),
        }
    }
    best
}

/// Every kernel, and every quality of the build, against [`brute_force`], to the last bit; how many rays hit.
pub fn assert_bits_of_brute_force(geometry: &[Geometry], rays: &[Ray]) -> usize {
    let native = sound(geometry);
    let others = [BuildQuality::Fast, BuildQuality::High].map(|q| (sound_as(geometry, q), Kernel::Auto));
    let want: Vec<Hit> = rays.iter().map(|r| brute_force(geometry, r)).collect();
    for (native, kernel) in KERNELS.map(|kernel| (native.clone(), kernel)).into_iter().chain(others) {
        let held = Unbounded::new(Held(native, kernel), geometry);
        let (got, blocked) = (contract::closest(&held, rays), contract::occluded(&held, rays));
        for i in 0..rays.len() {
            assert_eq!(bits(&got[i]), bits(&want[i]), "{kernel:?} {:?}: {:?} is not {:?}", rays[i], got[i], want[i]);
            assert_eq!(blocked[i], want[i].is_hit(), "{kernel:?} {:?}", rays[i]);
        }
    }
    want.iter().filter(|h| h.is_hit()).count()
}
