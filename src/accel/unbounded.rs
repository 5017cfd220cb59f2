//! Infinite planes, which no hierarchy can hold, added to any accelerator.

use super::{BuildStats, Coherence, Intersector};
use crate::geometry::slab::{T_LIMIT, is_traceable};
use crate::geometry::{Geometry, GeometryMask, Hit8, NO_GEOMETRY, Plane, Ray8, Shape, plane};
use crate::math::{LaneMask, Real};
use crate::simd::{F32x8, Mask8, Vec3x8};

/// Accelerator with the infinite planes of a scene added. Planes are tested first and shorten the rays for the inner
/// accelerator. Without planes the rays are passed on unchanged.
#[derive(Clone, Debug)]
pub struct Unbounded<I> {
    inner: I,
    planes: Vec<Placed>,
    dropped: usize,
}

#[derive(Clone, Copy, Debug)]
struct Placed {
    plane: Plane,
    geometry: u32,
    mask: GeometryMask,
}

/// Scratch memory of [`Unbounded`] and of the inner accelerator.
#[derive(Clone, Debug, Default)]
pub struct Scratch<S> {
    inner: S,
    rays: Vec<Ray8>,
    nearest: Vec<Nearest>,
}

/// The nearest plane of each ray.
#[derive(Clone, Copy, Debug)]
struct Nearest {
    t: F32x8,
    geometry: [u32; 8],
}

impl<I: Intersector> Unbounded<I> {
    /// Adds the planes of `geometry` to `inner`, which was built over the same list. Planes that cannot be hit
    /// ([`Plane::is_usable`]) are dropped and counted.
    #[must_use]
    pub fn new(inner: I, geometry: &[Geometry]) -> Self {
        let mut planes = Vec::new();
        let mut dropped = 0;
        for (g, id) in geometry.iter().zip(0..) {
            match g.shape {
                Shape::Plane(plane) if plane.is_usable() => planes.push(Placed { plane, geometry: id, mask: g.mask }),
                Shape::Plane(_) => dropped += 1,
                _ => {}
            }
        }
        Self { inner, planes, dropped }
    }

    /// The accelerator without the planes.
    pub fn inner(&self) -> &I {
        &self.inner
    }

    /// Returns the same planes added to another accelerator over the same geometry.
    #[must_use]
    pub fn with_inner<J>(&self, inner: J) -> Unbounded<J> {
        Unbounded { inner, planes: self.planes.clone(), dropped: self.dropped }
    }

    /// Returns the nearest planes of the active lanes. The list is in order of id, so the first plane wins a tie.
    fn nearest(&self, rays: &Ray8) -> Nearest {
        let mut nearest = Nearest { t: F32x8::INFINITY, geometry: [NO_GEOMETRY; 8] };
        let limit = Real::min(rays.t_max, F32x8::from(T_LIMIT));
        let sound = is_traceable(rays.origin, rays.dir, rays.t_min, limit) & rays.t_max.eq(rays.t_max);
        let sound = sound & Mask8::from_bits(rays.active);
        for placed in self.planes.iter().filter(|p| p.mask.meets(rays.admits)) {
            let (point, normal) = (Vec3x8::splat(placed.plane.point), Vec3x8::splat(placed.plane.normal));
            let t = plane::intersect(rays.origin, rays.dir, point, normal);
            let nearer = sound & rays.t_min.lt(t) & t.le(limit) & t.lt(nearest.t);
            nearest.t = nearer.select(t, nearest.t);
            let bits = nearer.bits();
            for (i, geometry) in nearest.geometry.iter_mut().enumerate() {
                if bits >> i & 1 != 0 {
                    *geometry = placed.geometry;
                }
            }
        }
        nearest
    }
}

impl Nearest {
    /// Lanes that hit a plane.
    fn met(&self) -> Mask8 {
        self.t.lt(F32x8::INFINITY)
    }

    /// Writes the planes to the active lanes of `hits` that have no nearer hit.
    fn settle(&self, active: u8, hits: &mut Hit8) {
        let met = self.met().bits() & active;
        for i in (0..8).filter(|i| met >> i & 1 != 0) {
            let (hit, t) = (hits.lane(i), self.t.lane(i));
            if !hit.is_hit() || t < hit.t || (t == hit.t && (0, self.geometry[i], 0) < hit.id()) {
                let (geometry, primitive) = (self.geometry[i], 0);
                hits.set_lane(i, &crate::geometry::Hit { t, u: 0.0, v: 0.0, instance: 0, geometry, primitive });
            }
        }
    }
}

impl<I: Intersector> Intersector for Unbounded<I> {
    type Scratch = Scratch<I::Scratch>;

    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], coherence: Coherence, scratch: &mut Self::Scratch) {
        if self.planes.is_empty() {
            return self.inner.closest(rays, hits, coherence, &mut scratch.inner);
        }
        assert_eq!(rays.len(), hits.len());
        scratch.nearest.clear();
        scratch.nearest.extend(rays.iter().map(|r| self.nearest(r)));
        scratch.rays.clear();
        scratch
            .rays
            .extend(rays.iter().zip(&scratch.nearest).map(|(r, n)| Ray8 { t_max: n.met().select(n.t, r.t_max), ..*r }));
        self.inner.closest(&scratch.rays, hits, coherence, &mut scratch.inner);
        for ((nearest, rays), hits) in scratch.nearest.iter().zip(rays).zip(hits) {
            nearest.settle(rays.active, hits);
        }
    }

    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], coherence: Coherence, scratch: &mut Self::Scratch) {
        if self.planes.is_empty() {
            return self.inner.occluded(rays, blocked, coherence, &mut scratch.inner);
        }
        assert_eq!(rays.len(), blocked.len());
        scratch.nearest.clear();
        scratch.nearest.extend(rays.iter().map(|r| self.nearest(r)));
        scratch.rays.clear();
        scratch
            .rays
            .extend(rays.iter().zip(&scratch.nearest).map(|(r, n)| Ray8 { active: r.active & !n.met().bits(), ..*r }));
        self.inner.occluded(&scratch.rays, blocked, coherence, &mut scratch.inner);
        for ((nearest, rays), blocked) in scratch.nearest.iter().zip(rays).zip(blocked) {
            let met = nearest.met();
            debug_assert!(!met.any() || met.bits() & rays.active == met.bits());
            *blocked |= met;
        }
    }

    fn build_stats(&self) -> BuildStats {
        let planes = BuildStats { planes: self.planes.len(), dropped: self.dropped, ..Default::default() };
        self.inner.build_stats().and(planes)
    }

    fn native(&self) -> Option<&super::native::Native> {
        self.inner.native()
    }
}
