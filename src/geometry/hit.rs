//! Hits: ids and coordinates. Materials and normals are looked up later.

use crate::simd::F32x8;

/// The geometry id of a miss.
pub const NO_GEOMETRY: u32 = u32::MAX;

/// The closest hit of one ray, or a miss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter; infinite on a miss.
    pub t: f32,
    /// Barycentric weight of the triangle's second corner, in 0..=1; 0 on other shapes.
    pub u: f32,
    /// Barycentric weight of the triangle's third corner, in 0..=1; 0 on other shapes.
    pub v: f32,
    /// Instance; 0 until scenes hold instances.
    pub instance: u32,
    /// Index of the geometry in the list the accelerator was built from; [`NO_GEOMETRY`] on a miss.
    pub geometry: u32,
    /// Triangle within the mesh; 0 on other shapes.
    pub primitive: u32,
}

impl Hit {
    /// A miss.
    pub const MISS: Self = Self { t: f32::INFINITY, u: 0.0, v: 0.0, instance: 0, geometry: NO_GEOMETRY, primitive: 0 };

    /// Returns true unless this is a miss.
    #[inline(always)]
    #[must_use]
    pub fn is_hit(&self) -> bool {
        self.geometry != NO_GEOMETRY
    }

    /// The key that decides between hits at the same `t`: the lower one wins.
    #[must_use]
    pub fn id(&self) -> (u32, u32, u32) {
        (self.instance, self.geometry, self.primitive)
    }
}

/// Eight hits ([`Hit`]) in structure-of-arrays.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Hit8 {
    /// Ray parameters; infinite on a miss.
    pub t: F32x8,
    /// Barycentric weights of the second corners.
    pub u: F32x8,
    /// Barycentric weights of the third corners.
    pub v: F32x8,
    /// Instances.
    pub instance: [u32; 8],
    /// Geometries; [`NO_GEOMETRY`] on a miss.
    pub geometry: [u32; 8],
    /// Primitives.
    pub primitive: [u32; 8],
}

impl Default for Hit8 {
    /// Eight misses.
    fn default() -> Self {
        Self {
            t: F32x8::INFINITY,
            u: F32x8::ZERO,
            v: F32x8::ZERO,
            instance: [0; 8],
            geometry: [NO_GEOMETRY; 8],
            primitive: [0; 8],
        }
    }
}

impl Hit8 {
    /// The hit in lane `i` (0..8).
    #[inline(always)]
    #[must_use]
    pub fn lane(&self, i: usize) -> Hit {
        Hit {
            t: self.t.lane(i),
            u: self.u.lane(i),
            v: self.v.lane(i),
            instance: self.instance[i],
            geometry: self.geometry[i],
            primitive: self.primitive[i],
        }
    }

    /// Puts `hit` into lane `i` (0..8).
    #[inline(always)]
    pub fn set_lane(&mut self, i: usize, hit: &Hit) {
        self.t.set_lane(i, hit.t);
        self.u.set_lane(i, hit.u);
        self.v.set_lane(i, hit.v);
        self.instance[i] = hit.instance;
        self.geometry[i] = hit.geometry;
        self.primitive[i] = hit.primitive;
    }
}
