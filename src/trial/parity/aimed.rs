//! Rays aimed where paths are most likely to differ: at edges, at corners and at the ends of their own intervals.

use glam::Vec3;

use crate::accel::reference::{Ray64, Reference};
use crate::geometry::{Geometry, Plane, Ray, Shape, Sphere, TriMesh};
use crate::measure::random::Pcg32;
use crate::trial::rays;

/// Edges and corners of a scene to aim at. A sphere's edge is its outline, and its corners are the six ends of its
/// axes. A plane's edge is its horizon, and its corner the point that defines it.
#[derive(Clone, Debug)]
pub struct Targets<'a> {
    meshes: Vec<(&'a TriMesh, Vec<u32>)>,
    spheres: Vec<Sphere>,
    planes: Vec<Plane>,
    centre: Vec3,
    size: f32,
}

impl<'a> Targets<'a> {
    /// Collects the targets of the shapes in `geometry` that can be hit.
    #[must_use]
    pub fn new(geometry: &'a [Geometry]) -> Self {
        let (mut meshes, mut spheres, mut planes) = (Vec::new(), Vec::new(), Vec::new());
        for g in geometry {
            match &g.shape {
                Shape::Mesh(mesh) => {
                    let all = 0..mesh.triangles.len();
                    let usable: Vec<u32> = all.filter(|&i| mesh.is_usable(i)).map(|i| i as u32).collect();
                    meshes.push((mesh, usable));
                }
                Shape::Sphere(sphere) if sphere.is_usable() => spheres.push(*sphere),
                Shape::Plane(plane) if plane.is_usable() => planes.push(*plane),
                _ => {}
            }
        }
        let bounds = rays::bounds(geometry);
        let (centre, size) = if bounds.is_empty() { (Vec3::ZERO, 1.0) } else { (bounds.centre(), bounds.diagonal()) };
        Self { meshes, spheres, planes, centre, size }
    }

    /// Returns up to `count` rays at points of edges; the same for the same `seed`.
    #[must_use]
    pub fn edges(&self, count: usize, seed: u64) -> Vec<Ray> {
        let mut random = Pcg32::new(seed, 2);
        let aim = |t: Target, from: Vec3, random: &mut Pcg32| match t {
            Target::Triangle([a, b, c]) => {
                let (p, q) = [(a, b), (b, c), (c, a)][below(random, 3)];
                p.lerp(q, random.unit())
            }
            Target::Sphere(s) => {
                // The tangent cone from `from` touches nearer than the great circle across, by r^2 / d.
                let away = (from - s.centre).as_dvec3();
                let (d, r) = (away.length(), f64::from(s.radius));
                let (axis, across) = (away / d, direction(random).as_dvec3());
                let across = (across - axis * axis.dot(across)).normalize_or_zero();
                let near = if d > r { r / d } else { 0.0 };
                let point = axis * (r * near) + across * (r * (1.0 - near * near).sqrt());
                s.centre + point.as_vec3()
            }
            Target::Plane(p) => {
                let along = direction(random);
                from + (along - p.normal * p.normal.dot(along) / p.normal.length_squared())
            }
        };
        self.rays(count, &mut random, aim)
    }

    /// Returns up to `count` rays at corners; the same for the same `seed`.
    #[must_use]
    pub fn vertices(&self, count: usize, seed: u64) -> Vec<Ray> {
        let mut random = Pcg32::new(seed, 3);
        let aim = |t: Target, _: Vec3, random: &mut Pcg32| match t {
            Target::Triangle(corners) => corners[below(random, 3)],
            Target::Sphere(s) => {
                s.centre + Vec3::AXES[below(random, 3)] * if random.unit() < 0.5 { s.radius } else { -s.radius }
            }
            Target::Plane(p) => p.point,
        };
        self.rays(count, &mut random, aim)
    }

    /// Returns rays from all around and from close by, some of them along an axis, of directions both raw and of unit
    /// length.
    fn rays(&self, count: usize, random: &mut Pcg32, aim: impl Fn(Target, Vec3, &mut Pcg32) -> Vec3) -> Vec<Ray> {
        let mut rays = Vec::new();
        for k in 0..count {
            let Some(target) = self.pick(random) else { break };
            let at = match target {
                Target::Triangle(corners) => corners[0],
                Target::Sphere(s) => s.centre,
                Target::Plane(_) => self.centre,
            };
            let from = if k % 2 == 0 {
                self.centre + direction(random) * (self.size * (0.6 + 2.0 * random.unit()))
            } else {
                at + direction(random) * (self.size * 10.0_f32.powf(-3.0 * random.unit()))
            };
            let point = aim(target, from, random);
            let axis = Vec3::AXES[below(random, 3)] * if random.unit() < 0.5 { 1.0 } else { -1.0 };
            let mut ray = Ray::new(from, point - from);
            if k % 8 == 0 {
                ray = Ray::new(point - axis * self.size, axis);
            } else if k % 3 == 0 {
                ray.dir = ray.dir.normalize_or(axis);
            }
            if ray.dir != Vec3::ZERO && ray.dir.is_finite() && ray.origin.is_finite() {
                rays.push(ray);
            }
        }
        rays
    }

    /// Picks any triangle, sphere or plane, each with equal probability.
    fn pick(&self, random: &mut Pcg32) -> Option<Target> {
        let triangles: usize = self.meshes.iter().map(|(_, usable)| usable.len()).sum();
        let all = triangles + self.spheres.len() + self.planes.len();
        if all == 0 {
            return None;
        }
        let mut i = below(random, all);
        for (mesh, usable) in &self.meshes {
            match usable.get(i) {
                Some(&triangle) => return Some(Target::Triangle(mesh.corners(triangle as usize))),
                None => i -= usable.len(),
            }
        }
        let sphere = self.spheres.get(i).map(|&s| Target::Sphere(s));
        sphere.or_else(|| self.planes.get(i - self.spheres.len()).map(|&p| Target::Plane(p)))
    }
}

/// Shape to aim at.
#[derive(Clone, Copy, Debug)]
enum Target {
    Triangle([Vec3; 3]),
    Sphere(Sphere),
    Plane(Plane),
}

/// Returns those of `rays` that hit something, with intervals that end or begin at the `t` of the hit. It is rounded to
/// `f32`, or the number below it, in turn.
#[must_use]
pub fn ends(reference: &Reference, rays: &[Ray]) -> Vec<Ray> {
    let met = rays.iter().map(|ray| (ray, reference.closest(&Ray64::from(ray)))).filter(|(_, hit)| hit.is_hit());
    met.enumerate()
        .map(|(k, (ray, hit))| {
            let t = hit.to_f32(ray.t_min).t;
            match k % 4 {
                0 => Ray { t_max: t, ..*ray },
                1 => Ray { t_min: t, ..*ray },
                2 => Ray { t_max: t.next_down(), ..*ray },
                _ => Ray { t_min: t.next_down().max(ray.t_min), ..*ray },
            }
        })
        .collect()
}

/// Returns a random index in 0..n.
fn below(random: &mut Pcg32, n: usize) -> usize {
    ((u64::from(random.draw()) * n as u64) >> 32) as usize
}

/// Returns a uniformly distributed direction of about unit length.
fn direction(random: &mut Pcg32) -> Vec3 {
    loop {
        let p = Vec3::new(random.unit(), random.unit(), random.unit()) * 2.0 - 1.0;
        let length = p.length();
        if (0.01..1.0).contains(&length) {
            return p / length;
        }
    }
}
