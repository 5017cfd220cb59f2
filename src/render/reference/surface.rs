//! Surface points in `f64`: position, accuracy and normals of a hit.

use glam::{DVec2, DVec3};

use crate::accel::reference::{Hit64, Ray64, Reference};
use crate::geometry::Shape;
use crate::geometry::contact::Face;
use crate::geometry::sphere::normal;
use crate::render::relief::embossed;
use crate::scene::Scene;

/// Bound on the error of a surface point, in units of `f64::EPSILON` and of the largest coordinate involved. It covers
/// the distance between the computed point and its surface, and the error of the next ray's intersection test.
///
/// A barycentric point rounds each coordinate about 7 times. The next ray's test rounds the corner's difference to the
/// origin, the shear factor, its product and their difference: 4 roundings of numbers at most twice as large. So the
/// test is exact for a triangle moved by 8. Three axes give another factor below 2. 64 holds that twice over, and is
/// still a ten-millionth of the offset that `f32` needs.
const ROUNDINGS: f64 = 64.0;

/// Surface point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    /// Position in scene units.
    pub point: DVec3,
    /// Distance from the point, in scene units, at which a ray origin is off the surface.
    pub clearance: f64,
    /// Unit geometric normal, on the outside.
    pub outward: DVec3,
    /// Interpolated unit normal, if the mesh has vertex normals; it may point to either side.
    pub interpolated: Option<DVec3>,
    /// Texture coordinates, as [`crate::scene::Colour::Image`] defines them.
    pub uv: DVec2,
    /// Colour between the corners; white where the mesh has none.
    pub colour: DVec3,
}

impl Surface {
    /// Returns the surface point at `hit`.
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
                let plain = interpolated.or(outward);
                let interpolated =
                    plain.and_then(|n| embossed(scene, hit.geometry, hit.primitive, [u, v], n)).or(interpolated);
                let uv = mesh.corner_uvs(i).map_or(DVec2::ZERO, |uv| {
                    let [a, b, c] = uv.map(|uv| uv.as_dvec2());
                    a * w + b * u + c * v
                });
                let colour = mesh.corner_colours(i).map_or(DVec3::ONE, |colours| {
                    let [a, b, c] = colours.map(|c| c.as_dvec3());
                    a * w + b * u + c * v
                });
                Self {
                    point: a * w + b * u + c * v,
                    clearance: clearance([a, b, c]),
                    // A collinear triangle has no side and counts as facing the ray.
                    outward: outward.unwrap_or_else(|| -ray.dir.normalize()),
                    interpolated,
                    uv,
                    colour,
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
                    colour: DVec3::ONE,
                }
            }
            Shape::Plane(plane) => {
                let (outward, foot) = (plane.normal.as_dvec3().normalize(), plane.point.as_dvec3());
                let near = ray.at(hit.t);
                let once = near - outward * outward.dot(near - foot);
                // The first projection leaves rounding in proportion to the ray's length, which may be large against
                // the coordinates.
                let left = outward.dot(once - foot);
                let point = once - outward * left;
                let clearance = clearance([point, foot, DVec3::splat(left)]);
                Self { point, clearance, outward, interpolated: None, uv: DVec2::ZERO, colour: DVec3::ONE }
            }
        }
    }

    /// Returns the surface point on a face where surfaces touch. `apart` is the distance between the touching faces.
    pub fn on_face(scene: &Scene, ray: &Ray64, face: &Face, point: DVec3, apart: f64) -> Self {
        let (u, v) = face.barycentrics(point);
        let here = Ray64 { origin: point, ..*ray };
        let hit = Hit64 { t: 0.0, u, v, instance: 0, geometry: face.object, primitive: face.primitive };
        let surface = Self::at(scene, &here, &hit);
        Self { clearance: 2.0 * surface.clearance + apart, ..surface }
    }

    /// Returns the origin of a ray that leaves in `dir`: off the surface, on the side of `dir`.
    pub fn start(&self, dir: DVec3) -> DVec3 {
        self.point + self.outward * self.clearance.copysign(dir.dot(self.outward))
    }
}

fn clearance<const N: usize>(points: [DVec3; N]) -> f64 {
    let largest = points.iter().fold(0.0_f64, |m, p| m.max(p.abs().max_element()));
    ROUNDINGS * f64::EPSILON * largest
}

/// Returns the texture coordinates of a direction in an equirectangular picture, both in 0..=1. The middle column is
/// towards -z, columns advance towards +x, and v = 1 is straight up.
pub(super) fn equirectangular(dir: DVec3) -> DVec2 {
    use std::f64::consts::{PI, TAU};
    DVec2::new(0.5 + dir.x.atan2(-dir.z) / TAU, 1.0 - dir.y.clamp(-1.0, 1.0).acos() / PI)
}

/// Surface that a straight ray passes through.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Ray parameter.
    pub t: f64,
    /// Index into `Scene::geometry`.
    pub geometry: u32,
    /// Triangle within a mesh; 0 for other shapes.
    pub primitive: u32,
    /// Position in scene units.
    pub point: DVec3,
    /// True if the ray arrives on the outside.
    pub front: bool,
    /// Cosine between the ray and the normal, above 0.
    pub cos: f64,
    /// Unit normal of the surface, on the outside.
    pub outward: DVec3,
    /// Texture coordinates.
    pub uv: DVec2,
}

/// Returns every surface along `ray`, in order. At an edge or corner shared by triangles of one mesh the surface counts
/// once, as it does for a ray restarted behind the first triangle.
pub(super) fn crossings(scene: &Scene, accel: &Reference, ray: &Ray64) -> Vec<Crossing> {
    let mut found: Vec<Crossing> = Vec::new();
    for hit in accel.all_hits(ray) {
        let surface = Surface::at(scene, ray, &hit);
        let along = surface.outward.dot(ray.dir) / ray.dir.length();
        let (front, cos, outward) = (along < 0.0, along.abs(), surface.outward);
        let (geometry, primitive, point) = (hit.geometry, hit.primitive, surface.point);
        let crossing = Crossing { t: hit.t, geometry, primitive, point, front, cos, outward, uv: surface.uv };
        let same_place = surface.clearance / (along.abs() * ray.dir.length());
        let again = found.iter().rev().take_while(|o| crossing.t - o.t <= same_place);
        if !again.clone().any(|o| o.geometry == crossing.geometry && o.front == crossing.front) {
            found.push(crossing);
        }
    }
    found
}
