//! Rays that pass through a place exactly, and the places of meshes worth aiming at.

use glam::{DVec3, Vec3};
use vitrum::geometry::{Ray, TriMesh};

use super::Rng;

/// Returns the number of cases of a test: `quick`, times `VITRUM_TEST_SCALE` if that is set.
pub fn count(quick: usize) -> usize {
    let factor = std::env::var("VITRUM_TEST_SCALE").ok().and_then(|s| s.parse().ok()).unwrap_or(1);
    quick * factor
}

/// The ray from `origin` that is at `target` for t = 1 without any rounding: none where the difference of the two is
/// no `f32`.
pub fn exactly(origin: Vec3, target: Vec3) -> Option<Ray> {
    let dir = target - origin;
    let wide = DVec3::from(target) - DVec3::from(origin);
    let exact = DVec3::from(dir) == wide && DVec3::from(origin) + wide == DVec3::from(target);
    (exact && dir != Vec3::ZERO).then(|| Ray::new(origin, dir))
}

/// The mesh with each corner moved to the nearest multiple of `2^exponent`, so that differences are exact.
pub fn snapped(mut mesh: TriMesh, exponent: i32) -> TriMesh {
    let grid = 2.0_f64.powi(exponent);
    for p in &mut mesh.positions {
        *p = ((p.as_dvec3() / grid).round() * grid).as_vec3();
    }
    mesh
}

/// The mesh scaled and moved in `f64` and rounded once; none where fewer than 256 ulp of its place are left of it.
pub fn placed(mesh: &TriMesh, scale: f64, offset: DVec3) -> Option<TriMesh> {
    let at = |p: &Vec3| (p.as_dvec3() * scale + offset).as_vec3();
    let placed = TriMesh { positions: mesh.positions.iter().map(at).collect(), ..mesh.clone() };
    let b = vitrum::geometry::Aabb::of(&placed.positions);
    let ulps = (0..3).map(|k| (b.hi[k] - b.lo[k]) / vitrum::math::ulp(b.hi[k].abs().max(b.lo[k].abs())));
    (ulps.fold(f32::INFINITY, f32::min) >= 256.0).then_some(placed)
}

/// Scales and places that leaks and self-hits are looked for at; the last one is that of Embree's own watertight test
/// (`tutorials/verify/verify.cpp`).
pub fn places() -> impl Iterator<Item = (f64, DVec3)> {
    let offsets = [0.0, 1e3, 1e6].map(|x| DVec3::new(x, -0.7 * x, 0.4 * x));
    let all = offsets.into_iter().chain([DVec3::new(148_376.0, 1234.0, -223_423.0)]);
    all.flat_map(|offset| [1e-3, 1.0, 30.0, 1e3].map(|scale| (scale, offset)))
}

/// A point on the edge from `a` to `b` that is exactly on it and an `f32`: a quarter, the half or three.
pub fn on_edge(a: Vec3, b: Vec3, rng: &mut Rng) -> Option<Vec3> {
    let share = [0.25, 0.5, 0.75][rng.below(3)];
    let wide = a.as_dvec3() + (b.as_dvec3() - a.as_dvec3()) * share;
    (wide.as_vec3().as_dvec3() == wide).then(|| wide.as_vec3())
}

/// Rays from places about `centre`, at most `reach` away from it: a third at corners of the mesh, a third at its
/// edges, both exactly; a third anywhere. Fewer than `n`, where places cannot be met exactly.
pub fn at_seams(mesh: &TriMesh, centre: Vec3, reach: f32, n: usize, rng: &mut Rng) -> Vec<Ray> {
    // Starts on the grid of the corners themselves, so that most differences are exact.
    let grid = mesh.positions.iter().fold(0.0_f32, |m, p| m.max(p.abs().max_element()));
    let grid = vitrum::math::ulp(grid);
    let mut rays = Vec::with_capacity(n);
    for i in 0..n {
        let origin = ((centre + rng.point() * reach) / grid).round() * grid;
        let triangle = mesh.corners(rng.below(mesh.triangles.len()));
        let k = rng.below(3);
        let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
        rays.extend(match i % 3 {
            0 => exactly(origin, a),
            1 => on_edge(a, b, rng).and_then(|target| exactly(origin, target)),
            _ => Some(Ray::new(origin, rng.direction())),
        });
    }
    rays
}
