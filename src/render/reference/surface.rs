//! Where a hit is, how exactly, and which way the surface faces there.

use glam::{DVec2, DVec3};

use crate::accel::reference::{Hit64, Ray64, Reference};
use crate::geometry::Shape;
use crate::geometry::contact::Face;
use crate::geometry::sphere::normal;
use crate::scene::Scene;

/// Bound on the distance between a computed point and its surface, plus that between the surface and what the next
/// ray's intersection test takes it for, in units of `f64::EPSILON` and of the largest coordinate involved.
///
/// A barycentric point rounds each coordinate about 7 times. The test of the next ray rounds the corner's difference
/// to the origin, the shear factor, its product and their difference: 4 roundings of numbers at most twice as large,
/// so that it finds the exact answer for a triangle moved by 8. Three axes give another factor below 2; 64 holds it
/// twice over and is still a ten-millionth of the offset that `f32` needs.
const ROUNDINGS: f64 = 64.0;

/// A point on a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    /// Place, in scene units.
    pub point: DVec3,
    /// How far from it a ray must start to be off the surface, in scene units.
    pub clearance: f64,
    /// Unit normal of the surface itself, on its outside.
    pub outward: DVec3,
    /// Interpolated unit normal, where the mesh has any; on either side.
    pub interpolated: Option<DVec3>,
    /// Texture coordinates, as [`crate::scene::Colour::Image`] has them.
    pub uv: DVec2,
}

impl Surface {
    /// What lies at `hit`.
    pub fn at(scene: &Scene, ray: &Ray64, hit: &Hit64) -> Self {
        match &scene.geometry[hit.geometry as usize].shape {
            Shape::Mesh(mesh) => {
                let i = hit.primitive as usize;
                let [a, b, c] = mesh.corners(i).map(|p| p.as_dvec3());
                let (u, v) = (hit.u, hit.v);
                let w = 1.0 - u - v;
                let outward = (b - a).cross(c - a).try_normalize();
                let interpolated = mesh.corner_normals(i).and_then(|n| {
                    let [a, b, c] = n.map(|n| n.as_dvec3());
                    (a * w + b * u + c * v).try_normalize()
                });
                let uv = mesh.corner_uvs(i).map_or(DVec2::ZERO, |uv| {
                    let [a, b, c] = uv.map(|uv| uv.as_dvec2());
                    a * w + b * u + c * v
                });
                Self {
                    point: a * w + b * u + c * v,
                    clearance: clearance([a, b, c]),
                    // A collinear triangle has no side: it is taken to face the ray.
                    outward: outward.unwrap_or_else(|| -ray.dir.normalize()),
                    interpolated,
                    uv,
                }
            }
            Shape::Sphere(sphere) => {
                let centre = sphere.centre.as_dvec3();
                let radius = f64::from(sphere.radius);
                let outward = normal(ray.origin.into(), ray.dir.into(), centre.into(), radius, hit.t);
                let outward = DVec3::from(outward);
                Self {
                    point: centre + outward * radius,
                    clearance: clearance([centre.abs() + radius]),
                    outward,
                    interpolated: None,
                    uv: equirectangular(outward),
                }
            }
            Shape::Plane(plane) => {
                let (outward, foot) = (plane.normal.as_dvec3().normalize(), plane.point.as_dvec3());
                let near = ray.at(hit.t);
                let once = near - outward * outward.dot(near - foot);
                // The first time leaves roundings of the ray's length, which may be large against the place.
                let left = outward.dot(once - foot);
                let point = once - outward * left;
                let clearance = clearance([point, foot, DVec3::splat(left)]);
                Self { point, clearance, outward, interpolated: None, uv: DVec2::ZERO }
            }
        }
    }

    /// The surface at a place of a face where surfaces touch, as a ray arrives there. `apart` is the distance between the
    /// faces of the place.
    pub fn on_face(scene: &Scene, ray: &Ray64, face: &Face, point: DVec3, apart: f64) -> Self {
        let (u, v) = face.barycentrics(point);
        let here = Ray64 { origin: point, ..*ray };
        let hit = Hit64 { t: 0.0, u, v, instance: 0, geometry: face.object, primitive: face.primitive };
        let surface = Self::at(scene, &here, &hit);
        Self { clearance: 2.0 * surface.clearance + apart, ..surface }
    }

    /// Where a ray that leaves into `dir` starts: off the surface, on the side it leaves by.
    pub fn start(&self, dir: DVec3) -> DVec3 {
        self.point + self.outward * self.clearance.copysign(dir.dot(self.outward))
    }
}

fn clearance<const N: usize>(points: [DVec3; N]) -> f64 {
    let largest = points.iter().fold(0.0_f64, |m, p| m.max(p.abs().max_element()));
    ROUNDINGS * f64::EPSILON * largest
}

/// Where a direction lies in an equirectangular picture: the middle column towards -z, columns advancing towards +x,
/// v = 1 straight up. `u` in 0..=1, `v` in 0..=1.
pub(super) fn equirectangular(dir: DVec3) -> DVec2 {
    use std::f64::consts::{PI, TAU};
    DVec2::new(0.5 + dir.x.atan2(-dir.z) / TAU, 1.0 - dir.y.clamp(-1.0, 1.0).acos() / PI)
}

/// One surface that a straight ray passes through.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Ray parameter.
    pub t: f64,
    /// Place in `Scene::geometry`.
    pub geometry: u32,
    /// Triangle within a mesh; 0 for other shapes.
    pub primitive: u32,
    /// Place, in scene units.
    pub point: DVec3,
    /// Whether the ray arrives on the outside.
    pub front: bool,
    /// Cosine between the ray and the normal, above 0.
    pub cos: f64,
    /// Unit normal of the surface, on its outside.
    pub outward: DVec3,
}

/// Every surface along `ray`, in order. Where it passes through an edge or a corner that triangles of one mesh share,
/// the surface counts once, as it does for a ray that starts anew behind the first of them.
pub(super) fn crossings(scene: &Scene, accel: &Reference, ray: &Ray64) -> Vec<Crossing> {
    let mut found: Vec<Crossing> = Vec::new();
    for hit in accel.all_hits(ray) {
        let surface = Surface::at(scene, ray, &hit);
        let along = surface.outward.dot(ray.dir) / ray.dir.length();
        let (front, cos, outward) = (along < 0.0, along.abs(), surface.outward);
        let (geometry, primitive, point) = (hit.geometry, hit.primitive, surface.point);
        let crossing = Crossing { t: hit.t, geometry, primitive, point, front, cos, outward };
        let same_place = surface.clearance / (along.abs() * ray.dir.length());
        let again = found.iter().rev().take_while(|o| crossing.t - o.t <= same_place);
        if !again.clone().any(|o| o.geometry == crossing.geometry && o.front == crossing.front) {
            found.push(crossing);
        }
    }
    found
}
