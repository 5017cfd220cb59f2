//! Meshes that are easy to make and hard to hit right.

use glam::Vec3;
use vitrum::geometry::{Geometry, GeometryMask, Plane, Shape, Sphere, TriMesh};

use super::Rng;

/// A mesh that every ray sees.
pub fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Geometry {
    masked(TriMesh { positions, triangles, ..Default::default() }, GeometryMask::OPAQUE)
}

/// A mesh of a kind.
pub fn masked(mesh: TriMesh, mask: GeometryMask) -> Geometry {
    Geometry { shape: Shape::Mesh(mesh), mask }
}

/// A sphere of a kind.
pub fn ball(centre: Vec3, radius: f32, mask: GeometryMask) -> Geometry {
    Geometry { shape: Shape::Sphere(Sphere { centre, radius }), mask }
}

/// A plane of a kind.
pub fn plane(point: Vec3, normal: Vec3, mask: GeometryMask) -> Geometry {
    Geometry { shape: Shape::Plane(Plane { point, normal }), mask }
}

/// A closed sphere of `n` slices and `n` stacks, its radius waving by `bumps`, moved and scaled: single corners at the
/// poles, shared ones along the seam.
pub fn closed_sphere(n: u32, bumps: f32, scale: f32, offset: Vec3) -> TriMesh {
    let mut positions = vec![Vec3::Y];
    for stack in 1..n {
        for slice in 0..n {
            let (theta, phi) =
                (std::f32::consts::PI * stack as f32 / n as f32, std::f32::consts::TAU * slice as f32 / n as f32);
            let r = 1.0 + bumps * (5.0 * phi).sin() * (3.0 * theta).sin();
            positions.push(r * Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()));
        }
    }
    positions.push(Vec3::NEG_Y);
    let last = positions.len() as u32 - 1;
    let at = |stack: u32, slice: u32| 1 + (stack - 1) * n + slice % n;
    let mut triangles = Vec::new();
    for slice in 0..n {
        triangles.push([0, at(1, slice + 1), at(1, slice)]);
        triangles.push([last, at(n - 1, slice), at(n - 1, slice + 1)]);
        for stack in 1..n - 1 {
            let (a, b) = (at(stack, slice), at(stack, slice + 1));
            let (c, d) = (at(stack + 1, slice), at(stack + 1, slice + 1));
            triangles.push([a, b, c]);
            triangles.push([b, d, c]);
        }
    }
    for p in &mut positions {
        *p = *p * scale + offset;
    }
    TriMesh { positions, triangles, ..Default::default() }
}

/// The twelve triangles of a box.
pub fn cuboid(lo: Vec3, hi: Vec3) -> TriMesh {
    let corner = |i: u32| {
        Vec3::new(
            if i & 1 == 0 { lo.x } else { hi.x },
            if i & 2 == 0 { lo.y } else { hi.y },
            if i & 4 == 0 { lo.z } else { hi.z },
        )
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { positions: (0..8).map(corner).collect(), triangles, ..Default::default() }
}

/// A flat grid of `n` x `n` unit squares in the plane z = 0, corners on integers from 0.
pub fn grid(n: u32) -> TriMesh {
    let positions = (0..=n).flat_map(|y| (0..=n).map(move |x| Vec3::new(x as f32, y as f32, 0.0))).collect();
    let at = |x: u32, y: u32| y * (n + 1) + x;
    let triangles = (0..n)
        .flat_map(|y| (0..n).map(move |x| (x, y)))
        .flat_map(|(x, y)| [[at(x, y), at(x + 1, y), at(x + 1, y + 1)], [at(x, y), at(x + 1, y + 1), at(x, y + 1)]])
        .collect();
    TriMesh { positions, triangles, ..Default::default() }
}

/// `n` triangles of size `size` anywhere in the unit cube, one in eight of them thin as a hair, a few degenerate or
/// doubled.
pub fn soup(n: usize, size: f32, rng: &mut Rng) -> TriMesh {
    let mut positions = Vec::with_capacity(3 * n);
    for i in 0..n {
        let a = rng.point();
        let (mut b, mut c) = (a + rng.point() * size, a + rng.point() * size);
        match i % 32 {
            1 | 9 | 17 => c = a + (b - a) * rng.unit() + rng.point() * 1e-6 * size,
            3 => b = a,
            5 => c = a + (b - a) * 0.5,
            7 if i > 8 => {
                positions.extend_from_within(3 * (i - 4)..3 * (i - 3));
                continue;
            }
            _ => {}
        }
        positions.extend([a, b, c]);
    }
    let triangles = (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    TriMesh { positions, triangles, ..Default::default() }
}
