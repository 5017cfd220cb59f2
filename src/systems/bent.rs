//! Refraction through a body without tracing: the second interface, with the thickness from the back side (Wyman 2005).
//!
//! The line of arrival and the normal give two thicknesses, each as far as the back side. The refracted line is between the
//! two, and so is its thickness, in proportion of the angles. The back side behind its end gives the second normal.

use glam::{DVec2, DVec3};

use crate::geometry::Shape;
use crate::optics::{Boundary, Exact, FresnelFormula};

/// Light that has entered a body.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Place on the surface, in scene units.
    pub point: DVec3,
    /// Unit normal, on the side of arrival.
    pub normal: DVec3,
    /// Unit direction of arrival.
    pub incident: DVec3,
    /// Unit direction inside.
    pub inside: DVec3,
    /// Index before the surface over the index behind it.
    pub eta: f64,
}

/// Place on the back side of a body.
#[derive(Clone, Copy, Debug)]
pub struct Back {
    /// The place, in scene units.
    pub point: DVec3,
    /// Unit normal, outwards.
    pub normal: DVec3,
}

/// Light that has left a body.
#[derive(Clone, Copy, Debug)]
pub struct Left {
    /// Place at which it left.
    pub point: DVec3,
    /// Unit direction.
    pub dir: DVec3,
    /// Length of its way inside, in scene units.
    pub thickness: f64,
    /// Share that the second interface transmits.
    pub share: f64,
}

impl Entry {
    /// Returns the estimated end of the refracted line. `along` is the back side on the line of arrival, `beneath` that
    /// along the normal.
    #[must_use]
    pub fn end(&self, along: Option<Back>, beneath: Option<Back>) -> DVec3 {
        let far = |back: Option<Back>| back.map(|back| back.point.distance(self.point));
        let angle = |cos: f64| cos.clamp(0.0, 1.0).acos();
        let (in_angle, out_angle) = (angle(-self.incident.dot(self.normal)), angle(-self.inside.dot(self.normal)));
        // The smaller angle belongs to the line in between; at the normal all three lines are one.
        let share = if in_angle > 0.0 { (out_angle / in_angle).min(1.0) } else { 1.0 };
        let (along, beneath) = (far(along), far(beneath));
        let along = along.or(beneath).unwrap_or(0.0);
        let thickness = share * along + (1.0 - share) * beneath.unwrap_or(along);
        self.point + self.inside * thickness
    }

    /// Lets light leave at the end of the refracted line, across the normal of the back side. Where it would be totally
    /// reflected it leaves along the surface.
    #[must_use]
    pub fn leave(&self, end: DVec3, back: Back) -> Left {
        let thickness = end.distance(self.point);
        let normal = if back.normal.dot(self.inside) > 0.0 { -back.normal } else { back.normal };
        let boundary = Boundary::<f64>::new(1.0, self.eta);
        let at = boundary.cross(-self.inside.dot(normal));
        if at.total {
            let along = self.inside - normal * self.inside.dot(normal);
            return Left { point: end, dir: along.normalize_or(self.inside), thickness, share: 1.0 };
        }
        let dir = DVec3::from(boundary.refract(self.inside.into(), normal.into(), &at)).normalize_or(self.inside);
        let share = 1.0 - Exact::dielectric(&boundary, &at);
        Left { point: end, dir, thickness, share }
    }
}

/// Returns the outward unit normal of a shape at a hit: that of its corners where it has any.
#[must_use]
pub fn outward(shape: &Shape, triangle: u32, uv: DVec2, point: DVec3) -> DVec3 {
    match shape {
        Shape::Sphere(sphere) => (point - sphere.centre.as_dvec3()).normalize_or(DVec3::Y),
        Shape::Plane(plane) => plane.normal.as_dvec3().normalize_or(DVec3::Y),
        Shape::Mesh(mesh) => {
            let i = triangle as usize;
            let [a, b, c] = mesh.corners(i).map(|p| p.as_dvec3());
            let flat = (b - a).cross(c - a).normalize_or(DVec3::Y);
            mesh.corner_normals(i).map_or(flat, |normals| {
                let [a, b, c] = normals.map(|n| n.as_dvec3());
                (a * (1.0 - uv.x - uv.y) + b * uv.x + c * uv.y).normalize_or(flat)
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Light that enters a body through its upper side, down and to the right.
    fn entry(eta: f64, degrees: f64) -> Entry {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let inside = (sin * eta).asin();
        Entry {
            point: DVec3::ZERO,
            normal: DVec3::Y,
            incident: DVec3::new(sin, -cos, 0.0),
            inside: DVec3::new(inside.sin(), -inside.cos(), 0.0),
            eta,
        }
    }

    #[test]
    fn light_leaves_a_slab_as_it_came() {
        for degrees in [0.0, 20.0, 45.0, 70.0] {
            let entry = entry(1.0 / 1.5, degrees);
            let back = |dir: DVec3| Back { point: dir * (2.0 / -dir.y), normal: DVec3::NEG_Y };
            let end = entry.end(Some(back(entry.incident)), Some(back(DVec3::NEG_Y)));
            let left = entry.leave(end, back(entry.incident));
            assert!(left.dir.distance(entry.incident) < 1e-12, "{degrees}");
            // Of the two thicknesses, 2 along the normal and more along the line, the way inside is in between.
            assert!(left.thickness >= 2.0 && left.thickness <= 2.0 / -entry.incident.y + 1e-12, "{degrees}");
            assert!(left.share > 0.5 && left.share < 1.0);
        }
        let straight = entry(1.0 / 1.5, 0.0);
        let left = straight.leave(straight.point - DVec3::Y, Back { point: DVec3::NEG_Y, normal: DVec3::NEG_Y });
        // By hand: 1 - (0.5 / 2.5)^2.
        assert!((left.share - 0.96).abs() < 1e-12 && (left.thickness - 1.0).abs() < 1e-12);
    }

    #[test]
    fn light_that_would_be_totally_reflected_leaves_along_the_surface() {
        let entry = entry(1.0 / 1.5, 60.0);
        let back = Back { point: DVec3::new(1.0, -1.0, 0.0), normal: DVec3::X };
        let left = entry.leave(back.point, back);
        assert!(left.dir.distance(DVec3::NEG_Y) < 1e-12 && left.share == 1.0, "{left:?}");
    }

    #[test]
    fn light_along_the_axis_of_a_ball_meets_its_far_side() {
        let entry = entry(1.0 / 1.5, 0.0);
        let far = Some(Back { point: DVec3::Y * -2.0, normal: DVec3::NEG_Y });
        assert_eq!(entry.end(far, far), DVec3::Y * -2.0);
        let ball = Shape::Sphere(crate::geometry::Sphere { centre: glam::Vec3::NEG_Y, radius: 1.0 });
        assert_eq!(outward(&ball, 0, DVec2::ZERO, DVec3::Y * -2.0), DVec3::NEG_Y);
    }
}
