//! Intersection tests for triangles, spheres and planes in `f64`.

use arrayvec::ArrayVec;
use glam::{DVec2, DVec3};

use super::{Hit64, Ray64};
use crate::geometry::{Geometry, GeometryMask, Plane, Shape, Sphere};
use crate::math::Vector3;

/// Triangle, sphere or plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Primitive {
    pub form: Form,
    pub mask: GeometryMask,
    pub geometry: u32,
    pub primitive: u32,
}

/// Its shape.
#[derive(Clone, Copy, Debug)]
pub(super) enum Form {
    Triangle([DVec3; 3]),
    Sphere {
        centre: DVec3,
        radius: f64,
    },
    /// Unit normal.
    Plane {
        point: DVec3,
        normal: DVec3,
    },
}

impl Primitive {
    /// Returns the usable primitives of `geometry` in order of their ids, and the number of dropped ones.
    pub fn collect(geometry: &[Geometry]) -> (Vec<Self>, usize) {
        let mut kept = Vec::new();
        let mut dropped = 0;
        for (g, shape) in geometry.iter().enumerate() {
            let mut add = |primitive: usize, form: Option<Form>| match form {
                Some(form) => {
                    kept.push(Self { form, mask: shape.mask, geometry: g as u32, primitive: primitive as u32 });
                }
                None => dropped += 1,
            };
            match &shape.shape {
                Shape::Mesh(mesh) => (0..mesh.triangles.len()).for_each(|i| {
                    let corners = || Form::Triangle(mesh.corners(i).map(|p| p.as_dvec3()));
                    add(i, mesh.is_usable(i).then(corners));
                }),
                Shape::Sphere(sphere) => add(0, sphere_form(sphere)),
                Shape::Plane(plane) => add(0, plane_form(plane)),
            }
        }
        (kept, dropped)
    }

    /// Returns the hits of the whole line of `probe`'s ray, nearest first. The caller compares them with the interval.
    pub fn meetings(&self, probe: &Probe) -> ArrayVec<Hit64, 2> {
        let hit =
            |t: f64, u: f64, v: f64| Hit64 { t, u, v, instance: 0, geometry: self.geometry, primitive: self.primitive };
        let mut hits = ArrayVec::new();
        match &self.form {
            Form::Triangle(corners) => {
                let seen = probe.triangle(corners);
                if let Some((t, u, v)) = seen.is_inside().then(|| seen.meeting()).flatten() {
                    hits.push(hit(t, u, v));
                }
            }
            Form::Sphere { centre, radius } => {
                if let Some(roots) = sphere_roots(&probe.ray, *centre, *radius) {
                    hits.extend(roots.map(|t| hit(t, 0.0, 0.0)));
                }
            }
            Form::Plane { point, normal } => {
                let along = normal.dot(probe.ray.dir);
                if along != 0.0 {
                    hits.push(hit(normal.dot(*point - probe.ray.origin) / along, 0.0, 0.0));
                }
            }
        }
        hits
    }

    /// Instance, geometry and primitive of its hits.
    pub fn id(&self) -> (u32, u32, u32) {
        (0, self.geometry, self.primitive)
    }
}

fn sphere_form(sphere: &Sphere) -> Option<Form> {
    let form = || Form::Sphere { centre: sphere.centre.as_dvec3(), radius: f64::from(sphere.radius) };
    sphere.is_usable().then(form)
}

fn plane_form(plane: &Plane) -> Option<Form> {
    let form = || Form::Plane { point: plane.point.as_dvec3(), normal: plane.normal.as_dvec3().normalize() };
    plane.is_usable().then(form)
}

/// Distance between the line of `ray` and the centre, times the length of the ray's direction. `from_centre` is the
/// ray's origin relative to the centre. Products are compensated, so the result is accurate from any distance.
pub(super) fn moment(ray: &Ray64, from_centre: DVec3) -> f64 {
    Vector3::from(from_centre).cross(ray.dir.into()).length()
}

/// Returns both roots in ascending order. The discriminant is computed from the moment of the line and the smaller root
/// from the larger, so that neither cancels.
fn sphere_roots(ray: &Ray64, centre: DVec3, radius: f64) -> Option<[f64; 2]> {
    let from_centre = ray.origin - centre;
    let a = ray.dir.length_squared();
    let b = -from_centre.dot(ray.dir);
    let (aside, most) = (moment(ray, from_centre), radius * a.sqrt());
    let below = (most - aside) * (most + aside);
    if below < 0.0 {
        return None;
    }
    let far_from_centre = from_centre.length();
    let c = (far_from_centre - radius) * (far_from_centre + radius);
    let q = b + below.sqrt().copysign(b);
    if q == 0.0 {
        return Some([0.0, 0.0]);
    }
    let (s, t) = (c / q, q / a);
    Some([s.min(t), s.max(t)])
}

/// Ray with the shear that turns its direction into the z axis (Woop, Benthin & Wald, "Watertight ray/triangle
/// intersection", JCGT 2013).
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    pub ray: Ray64,
    /// Axes that become x, y and z; z is the one of the direction's largest component.
    axes: [usize; 3],
    shear: DVec2,
}

impl Probe {
    /// Computes the shear of `ray`, which must be usable.
    pub fn new(ray: &Ray64) -> Self {
        let z = ray.dir.abs().max_position();
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let shear = DVec2::new(ray.dir[x], ray.dir[y]) / ray.dir[z];
        Self { ray: *ray, axes: [x, y, z], shear }
    }

    /// Transforms a triangle to the sheared space. A corner that several triangles share has the same coordinates in
    /// each.
    pub fn triangle(&self, corners: &[DVec3; 3]) -> SeenTriangle {
        let [x, y, z] = self.axes;
        let relative = corners.map(|p| p - self.ray.origin);
        let flat = relative.map(|p| DVec2::new(p[x], p[y]) - self.shear * p[z]);
        let depth = relative.map(|p| p[z] / self.ray.dir[z]);
        let [a, b, c] = flat;
        SeenTriangle { flat, depth, edges: [edge(c, b), edge(a, c), edge(b, a)] }
    }
}

/// Triangle in the sheared space of a ray. The ray is the point (0, 0).
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenTriangle {
    /// Corners across the ray, in scene units along the two smaller axes of the direction.
    pub flat: [DVec2; 3],
    /// Ray parameters of the corners.
    pub depth: [f64; 3],
    /// Twice the signed area between the ray and the edge opposite each corner: the unscaled weights of the corners.
    pub edges: [f64; 3],
}

impl SeenTriangle {
    /// Returns true if the ray passes through the triangle or its edges, from either side.
    pub fn is_inside(&self) -> bool {
        self.edges.iter().all(|&e| e >= 0.0) || self.edges.iter().all(|&e| e <= 0.0)
    }

    /// Returns `t`, `u`, `v` of the ray in the triangle's plane; `None` if the triangle is seen edge-on.
    pub fn meeting(&self) -> Option<(f64, f64, f64)> {
        let whole = self.whole();
        let [a, b, c] = self.edges.map(|e| e / whole);
        let t = a * self.depth[0] + b * self.depth[1] + c * self.depth[2];
        (whole != 0.0 && t.is_finite()).then_some((t, b, c))
    }

    /// Twice the signed area of the triangle.
    pub fn whole(&self) -> f64 {
        self.edges.iter().sum()
    }
}

/// Returns `p.x q.y - p.y q.x` with the right sign in all cases. Rounding is monotonic, so rounded products have the
/// order of exact ones; if they are equal, their rounding errors decide. Swapping the corners only flips the sign. So
/// two triangles that share an edge agree on the side of it that the ray passes, and no ray slips between them.
pub(super) fn edge(p: DVec2, q: DVec2) -> f64 {
    let (first, second) = (p.x * q.y, p.y * q.x);
    let first_missed = p.x.mul_add(q.y, -first);
    let second_missed = p.y.mul_add(q.x, -second);
    (first - second) + (first_missed - second_missed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_keeps_its_sign_where_both_products_round_to_the_same_number() {
        let e = f64::EPSILON;
        // (1 + e)(1 + 3e) and (1 + 2e)^2 differ by e^2 alone.
        let (p, q) = (DVec2::new(1.0 + e, 1.0 + 2.0 * e), DVec2::new(1.0 + 2.0 * e, 1.0 + 3.0 * e));
        assert_eq!(edge(p, q), -e * e);
        assert_eq!(edge(q, p), e * e);
        assert_eq!(edge(p, p), 0.0);
    }
}
