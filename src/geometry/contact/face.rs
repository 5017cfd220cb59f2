//! One face of a shape, in `f64`.

use glam::DVec3;

use crate::geometry::shape::{Geometry, Shape};
use crate::geometry::spawn::Spot;
use crate::math::Vector3;

/// A triangle, a plane or a sphere of a list of shapes.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// Place in the list of shapes.
    pub object: u32,
    /// Triangle within a mesh; 0 for other shapes.
    pub primitive: u32,
    /// Place and form.
    pub form: Form,
}

/// The form of a face; widened from `f32` without loss, but for normals.
#[derive(Clone, Copy, Debug)]
pub enum Form {
    /// A triangle with its unit normal.
    Triangle {
        /// Corners, in scene units.
        corners: [DVec3; 3],
        /// Unit normal, outward.
        normal: DVec3,
    },
    /// An infinite plane.
    Plane {
        /// A point on it, in scene units.
        point: DVec3,
        /// Unit normal, outward.
        normal: DVec3,
    },
    /// A sphere.
    Sphere {
        /// Centre, in scene units.
        centre: DVec3,
        /// Radius, in scene units.
        radius: f64,
    },
}

impl Face {
    /// A face of a list of shapes. A triangle without area has the normal zero.
    #[must_use]
    pub fn of(geometry: &[Geometry], object: u32, primitive: u32) -> Self {
        let form = match &geometry[object as usize].shape {
            Shape::Mesh(mesh) => {
                let corners = mesh.corners(primitive as usize).map(|p| p.as_dvec3());
                let [a, b, c] = corners;
                Form::Triangle { corners, normal: (b - a).cross(c - a).normalize_or_zero() }
            }
            Shape::Plane(plane) => {
                Form::Plane { point: plane.point.as_dvec3(), normal: plane.normal.as_dvec3().normalize() }
            }
            Shape::Sphere(sphere) => {
                Form::Sphere { centre: sphere.centre.as_dvec3(), radius: f64::from(sphere.radius) }
            }
        };
        Self { object, primitive, form }
    }

    /// Object and primitive.
    #[must_use]
    pub fn id(&self) -> (u32, u32) {
        (self.object, self.primitive)
    }

    /// Unit normal at a point of the face, outward.
    #[must_use]
    pub fn outward(&self, point: DVec3) -> DVec3 {
        match self.form {
            Form::Triangle { normal, .. } | Form::Plane { normal, .. } => normal,
            Form::Sphere { centre, .. } => (point - centre).normalize_or_zero(),
        }
    }

    /// Returns true if a face that coincides with this one has its outside on the same side.
    #[must_use]
    pub fn faces_like(&self, other: &Self) -> bool {
        let somewhere = match self.form {
            Form::Triangle { corners: [a, ..], .. } | Form::Plane { point: a, .. } => a,
            Form::Sphere { centre, radius } => centre + DVec3::X * radius,
        };
        self.outward(somewhere).dot(other.outward(somewhere)) > 0.0
    }

    /// Signed distance of a point from the surface (of a triangle: from its plane), positive outside, in scene units.
    #[must_use]
    pub fn height(&self, point: DVec3) -> f64 {
        match self.form {
            Form::Triangle { corners: [a, ..], normal } | Form::Plane { point: a, normal } => normal.dot(point - a),
            Form::Sphere { centre, radius } => (point - centre).length() - radius,
        }
    }

    /// Returns true if the perpendicular from `point` meets the face, or passes it by at most `slack` (scene units).
    #[must_use]
    pub fn covers(&self, point: DVec3, slack: f64) -> bool {
        let Form::Triangle { corners: [a, b, c], normal } = self.form else { return true };
        [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| {
            let inward = normal.cross(to - from);
            inward.dot(point - from) >= -slack * inward.length()
        })
    }

    /// Weights of the second and the third corner of a triangle at a point of it, clamped to the triangle; 0 for other
    /// shapes.
    #[must_use]
    pub fn barycentrics(&self, point: DVec3) -> (f64, f64) {
        let Form::Triangle { corners: [a, b, c], normal } = self.form else { return (0.0, 0.0) };
        let area = normal.dot((b - a).cross(c - a));
        if area <= 0.0 {
            return (0.0, 0.0);
        }
        let u = (normal.dot((point - a).cross(c - a)) / area).clamp(0.0, 1.0);
        let v = (normal.dot((b - a).cross(point - a)) / area).clamp(0.0, 1.0);
        if u + v > 1.0 { (u / (u + v), v / (u + v)) } else { (u, v) }
    }

    /// Distance off the face at which an `f32` ray must start so that it cannot meet the face ([`Spot::reach`]), in scene
    /// units.
    #[must_use]
    pub fn reach(&self, point: DVec3) -> f64 {
        match self.form {
            Form::Triangle { corners, .. } => {
                let (u, v) = self.barycentrics(point);
                Spot::<f64>::on_triangle(corners.map(Vector3::from), u, v).reach
            }
            Form::Plane { point: anchor, normal } => {
                Spot::<f64>::on_plane(anchor.into(), normal.into(), point.into()).reach
            }
            Form::Sphere { centre, radius } => {
                Spot::<f64>::off_sphere(self.outward(point).into(), centre.into(), radius)
            }
        }
    }

    /// The largest coordinate that takes part in the place of the face at a point of it, in scene units.
    #[must_use]
    pub fn largest_coordinate(&self, point: DVec3) -> f64 {
        let here = point.abs().max_element();
        match self.form {
            Form::Triangle { corners, .. } => {
                corners.iter().map(|corner| corner.abs().max_element()).fold(here, f64::max)
            }
            // A plane is as exact as its unit normal, which turns it about its point.
            Form::Plane { point: anchor, .. } => {
                here.max(anchor.abs().max_element()).max((point - anchor).abs().max_element())
            }
            Form::Sphere { centre, radius } => here.max(centre.abs().max_element()).max(radius),
        }
    }
}
