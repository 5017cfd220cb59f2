//! Shapes to try rays on.

use glam::Vec3;

use crate::geometry::{Geometry, GeometryMask, Plane, Shape, Sphere, TriMesh};

pub fn geometry(shape: Shape) -> Geometry {
    Geometry { shape, mask: GeometryMask::OPAQUE }
}

pub fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Geometry {
    geometry(Shape::Mesh(TriMesh { positions, triangles, ..TriMesh::default() }))
}

pub fn sphere(centre: Vec3, radius: f32) -> Geometry {
    geometry(Shape::Sphere(Sphere { centre, radius }))
}

pub fn plane(point: Vec3, normal: Vec3) -> Geometry {
    geometry(Shape::Plane(Plane { point, normal }))
}

/// The triangle (0,0,0), (1,0,0), (0,2,0), counter-clockwise seen from +z.
pub fn triangle() -> Geometry {
    mesh(vec![Vec3::ZERO, Vec3::X, Vec3::new(0.0, 2.0, 0.0)], vec![[0, 1, 2]])
}

/// A closed ball of triangles, `2 n` by `n`, poles shared.
pub fn ball(centre: Vec3, radius: f32, n: u32) -> TriMesh {
    let mut positions = vec![centre + Vec3::Y * radius];
    for i in 1..n {
        let (sin, cos) = (std::f32::consts::PI * i as f32 / n as f32).sin_cos();
        for j in 0..2 * n {
            let (s, c) = (std::f32::consts::PI * j as f32 / n as f32).sin_cos();
            positions.push(centre + Vec3::new(sin * c, cos, sin * s) * radius);
        }
    }
    positions.push(centre - Vec3::Y * radius);
    let last = positions.len() as u32 - 1;
    let at = |i: u32, j: u32| 1 + (i - 1) * 2 * n + j % (2 * n);
    let mut triangles = Vec::new();
    for j in 0..2 * n {
        triangles.push([0, at(1, j + 1), at(1, j)]);
        triangles.push([last, at(n - 1, j), at(n - 1, j + 1)]);
        for i in 1..n - 1 {
            triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
            triangles.push([at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    TriMesh { positions, triangles, ..TriMesh::default() }
}

/// Numbers in -1..1, the same in every run (xorshift, Marsaglia 2003).
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}
