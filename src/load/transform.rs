//! Transforms of shapes: affine maps in `f64`, applied and then rounded once.

use glam::{DMat3, DMat4, DVec3, Vec3};

use super::draft::{Ball, Flat, MeshDraft, rounded};
use super::extent::FAR;
use crate::geometry::{COORDINATE_LIMIT, Plane, TriMesh};

/// Limit on the column lengths of a transform: between one over this and this.
pub(super) const SCALE_LIMIT: f64 = 1e15;
/// Share of the box of its column lengths below which the volume of a transform counts as singular.
const SINGULAR: f64 = 1e-10;
/// Largest relative deviation of columns from equal lengths and right angles for a sphere to stay a sphere.
const SIMILAR: f64 = 1e-6;

/// Non-singular affine map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    matrix: DMat4,
    /// Transpose of the inverse of the linear part, for normals.
    normal: DMat3,
}

impl Transform {
    /// Identity map.
    pub const IDENTITY: Self = Self { matrix: DMat4::IDENTITY, normal: DMat3::IDENTITY };

    /// Creates the map `p -> matrix p`.
    ///
    /// # Errors
    /// Returns a message if the matrix is not finite, not affine, singular, or scales by more than 1e15.
    pub fn new(matrix: DMat4) -> Result<Self, String> {
        if !matrix.is_finite() {
            return Err(String::from("holds a number that is not finite"));
        }
        if matrix.row(3) != glam::DVec4::W {
            return Err(String::from("is not affine: its last row must be 0, 0, 0, 1"));
        }
        let linear = DMat3::from_mat4(matrix);
        let lengths = [linear.x_axis, linear.y_axis, linear.z_axis].map(DVec3::length);
        if lengths.contains(&0.0) {
            return Err(String::from("is singular: it scales an axis by 0"));
        }
        if let Some(&l) = lengths.iter().find(|&&l| !(1.0 / SCALE_LIMIT..=SCALE_LIMIT).contains(&l)) {
            return Err(format!("scales by {l:e}; 1e-15 to 1e15 is allowed"));
        }
        let box_volume = lengths[0] * lengths[1] * lengths[2];
        if linear.determinant().abs() < SINGULAR * box_volume {
            return Err(String::from("is singular: it flattens space"));
        }
        if matrix.w_axis.truncate().abs().max_element() > f64::from(COORDINATE_LIMIT) {
            return Err(format!("moves things beyond {COORDINATE_LIMIT:e}"));
        }
        Ok(Self { matrix, normal: linear.inverse().transpose() })
    }

    /// Creates a map that scales, then rotates about x, y and z in that order (degrees, right-handed), then translates.
    ///
    /// # Errors
    /// Fails as [`Transform::new`] does.
    pub fn from_parts(scale: DVec3, rotate: DVec3, translate: DVec3) -> Result<Self, String> {
        let linear = turn(2, rotate.z) * turn(1, rotate.y) * turn(0, rotate.x) * DMat3::from_diagonal(scale);
        Self::new(DMat4::from_translation(translate) * DMat4::from_mat3(linear))
    }

    /// Returns the map that applies `inner` first, then this one.
    ///
    /// # Errors
    /// Fails as [`Transform::new`] does.
    pub fn after(&self, inner: &Self) -> Result<Self, String> {
        Self::new(self.matrix * inner.matrix)
    }

    /// Returns true if the map reverses handedness.
    #[must_use]
    pub fn mirrors(&self) -> bool {
        DMat3::from_mat4(self.matrix).determinant() < 0.0
    }

    /// Returns the factor by which lengths grow, in the mean of all directions.
    pub(super) fn scale(&self) -> f64 {
        DMat3::from_mat4(self.matrix).determinant().abs().cbrt()
    }

    /// Transforms a point.
    #[must_use]
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.matrix.transform_point3(p)
    }

    /// Transforms a unit normal.
    #[must_use]
    pub fn normal(&self, n: DVec3) -> DVec3 {
        let m = self.normal * n;
        // Scaled by its largest component first, since the squares of a normal under a huge scale would underflow.
        let largest = m.abs().max_element();
        if largest > 0.0 && largest.is_finite() { (m / largest).normalize() } else { n }
    }

    /// Transforms a mesh. A mirroring map reverses the triangles, so that the outside stays outside.
    ///
    /// # Errors
    /// Returns a message if a corner that could be hit ends up beyond [`COORDINATE_LIMIT`].
    pub(super) fn mesh(&self, draft: &mut MeshDraft) -> Result<(), String> {
        if *self == Self::IDENTITY {
            return Ok(());
        }
        for p in &mut draft.corners {
            let usable = within_limit(*p);
            *p = self.point(*p);
            if usable && !within_limit(*p) {
                return Err(format!("moves a corner to {}, beyond {COORDINATE_LIMIT:e}", p.as_vec3()));
            }
        }
        for n in &mut draft.mesh.normals {
            *n = self.normal(n.as_dvec3()).as_vec3();
        }
        if self.mirrors() {
            swap_winding(&mut draft.mesh);
        }
        Ok(())
    }

    /// Transforms a sphere.
    ///
    /// # Errors
    /// Returns a message if it would not stay a sphere, or its coordinates leave the range of numbers.
    pub(super) fn ball(&self, ball: &Ball) -> Result<Ball, String> {
        let linear = DMat3::from_mat4(self.matrix);
        let gram = linear.transpose() * linear;
        let squared = (gram.x_axis.x + gram.y_axis.y + gram.z_axis.z) / 3.0;
        let off = gram - DMat3::from_diagonal(DVec3::splat(squared));
        if off.abs().to_cols_array().iter().any(|&e| e > SIMILAR * squared) {
            return Err(String::from(
                "does not leave a sphere a sphere; give it `tessellation = 64` to make it a mesh, or scale all axes alike",
            ));
        }
        let centre = self.point(ball.centre);
        let radius = ball.radius * squared.sqrt();
        if !(within_limit(centre.abs() + radius) && radius as f32 > 0.0) {
            let (centre, radius) = (centre.as_vec3(), radius as f32);
            return Err(format!("makes the sphere's centre {centre} and its radius {radius:e}"));
        }
        Ok(Ball { centre, radius })
    }

    /// Transforms a plane.
    ///
    /// # Errors
    /// Returns a message if its point leaves the range of numbers.
    pub(super) fn plane(&self, point: DVec3, normal: DVec3) -> Result<Flat, String> {
        let moved = self.point(point);
        if !within_limit(moved) {
            return Err(format!("moves the plane's point to {}", moved.as_vec3()));
        }
        // A plane that is moved back from far away keeps its digits.
        let back = point.abs().max_element() > FAR * moved.abs().max_element();
        let near = Plane {
            point: self.point(rounded(point, back)).as_vec3(),
            normal: self.normal(normal.as_vec3().as_dvec3()).as_vec3(),
        };
        Ok(Flat { point: moved, normal: self.normal(normal), near })
    }
}

/// Returns true if all coordinates are finite and none is beyond [`COORDINATE_LIMIT`].
pub(super) fn within_limit(p: DVec3) -> bool {
    p.as_vec3().abs().cmple(Vec3::splat(COORDINATE_LIMIT)).all()
}

/// Turns a mesh inside out: reverses triangles and normals.
pub(super) fn flip(mesh: &mut TriMesh) {
    swap_winding(mesh);
    for n in &mut mesh.normals {
        *n = -*n;
    }
}

fn swap_winding(mesh: &mut TriMesh) {
    for list in [&mut mesh.triangles, &mut mesh.normal_indices, &mut mesh.uv_indices] {
        for t in list {
            t.swap(1, 2);
        }
    }
}

/// Returns a rotation by `degrees` about an axis; exact at multiples of 90.
fn turn(axis: usize, degrees: f64) -> DMat3 {
    let (s, c) = sin_cos_degrees(degrees);
    match axis {
        0 => DMat3::from_cols(DVec3::X, DVec3::new(0.0, c, s), DVec3::new(0.0, -s, c)),
        1 => DMat3::from_cols(DVec3::new(c, 0.0, -s), DVec3::Y, DVec3::new(s, 0.0, c)),
        _ => DMat3::from_cols(DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0), DVec3::Z),
    }
}

/// Returns sine and cosine of an angle in degrees; exact at multiples of 90.
pub(super) fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let turns = degrees.rem_euclid(360.0);
    let quarter = (turns / 90.0).round();
    let (s, c) = (turns - quarter * 90.0).to_radians().sin_cos();
    match quarter as u32 % 4 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// Returns two unit vectors at right angles to the unit vector `n` and to each other, with `cross(first, second) = n`
/// (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
pub(super) fn basis(n: DVec3) -> (DVec3, DVec3) {
    let sign = 1f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), DVec3::new(b, sign + n.y * n.y * a, -n.y))
}

/// Returns the map for the unit square shapes: +y to `normal`, their size to `scale`, their middle to `centre`.
pub(super) fn facing(normal: DVec3, scale: f64, centre: DVec3) -> Result<Transform, String> {
    let (z, x) = if normal == DVec3::Y { (DVec3::Z, DVec3::X) } else { basis(normal) };
    let linear = DMat3::from_cols(x * scale, normal * scale, z * scale);
    Transform::new(DMat4::from_translation(centre) * DMat4::from_mat3(linear))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::origin::Frame;

    #[test]
    fn rotations_go_x_then_y_then_z_and_quarter_turns_are_exact() {
        let t = Transform::from_parts(DVec3::ONE, DVec3::new(90.0, 90.0, 0.0), DVec3::ZERO).unwrap();
        // x turns y to z, then y turns z to x.
        assert_eq!(t.point(DVec3::Y), DVec3::X);
        let z = Transform::from_parts(DVec3::ONE, DVec3::new(0.0, 0.0, -270.0), DVec3::ZERO).unwrap();
        assert_eq!(z.point(DVec3::X), DVec3::Y);
    }

    #[test]
    fn normals_stay_perpendicular_under_uneven_scale() {
        let t = Transform::from_parts(DVec3::new(1.0, 4.0, 0.5), DVec3::new(10.0, 20.0, 30.0), DVec3::ZERO).unwrap();
        let n = DVec3::new(1.0, 2.0, 3.0).normalize();
        let (a, b) = basis(n);
        for edge in [a, b] {
            assert!((t.point(edge).dot(t.normal(n))).abs() < 1e-12);
        }
    }

    #[test]
    fn facing_takes_up_to_the_normal_without_mirroring() {
        for n in [DVec3::Y, DVec3::NEG_Y, DVec3::X, DVec3::NEG_Z, DVec3::new(1.0, 2.0, -3.0).normalize()] {
            let t = facing(n, 2.0, DVec3::ONE).unwrap();
            assert!((t.point(DVec3::Y) - (n * 2.0 + 1.0)).length() < 1e-12, "{n}");
            assert!(!t.mirrors(), "{n}");
        }
    }

    #[test]
    fn bad_transforms_are_named() {
        let scaled = |s: DVec3| Transform::from_parts(s, DVec3::ZERO, DVec3::ZERO).unwrap_err();
        assert!(scaled(DVec3::new(1.0, 0.0, 1.0)).contains("singular"));
        assert!(scaled(DVec3::splat(1e30)).contains("1e30"));
        assert!(scaled(DVec3::splat(f64::NAN)).contains("not finite"));
        let flat = DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0));
        assert!(Transform::new(DMat4::from_mat3(flat)).unwrap_err().contains("flattens"));
    }

    #[test]
    fn a_sphere_survives_mirrors_and_turns_but_no_squeeze() {
        let ball = Ball { centre: DVec3::X, radius: 2.0 };
        let mirror = Transform::from_parts(DVec3::new(-3.0, 3.0, 3.0), DVec3::splat(33.0), DVec3::ZERO).unwrap();
        assert!((mirror.ball(&ball).unwrap().radius - 6.0).abs() < 1e-12);
        let squeeze = Transform::from_parts(DVec3::new(1.0, 1.001, 1.0), DVec3::ZERO, DVec3::ZERO).unwrap();
        assert!(squeeze.ball(&ball).unwrap_err().contains("tessellation"));
    }

    #[test]
    fn a_far_plane_is_held_next_to_the_origin() {
        let normal = DVec3::new(0.6, 0.8, 0.0);
        let far = DVec3::new(4e6, 3.1, 5e6);
        // 1e6 along the plane from there, and 0.25 off it.
        let origin = far + DVec3::new(8e5, -6e5, 0.0) - normal * 0.25;
        let plane = Transform::IDENTITY.plane(far, normal).unwrap().settle(Frame::at(origin));
        assert!((plane.point.as_dvec3() - normal * 0.25).length() < 1e-8, "{}", plane.point);
    }

    #[test]
    fn a_plane_that_is_moved_back_from_afar_keeps_its_digits() {
        let back = Transform::from_parts(DVec3::ONE, DVec3::ZERO, DVec3::new(0.0, -5411234.3, 0.0)).unwrap();
        let plane = back.plane(DVec3::new(0.0, 5411234.25, 0.0), DVec3::Y).unwrap().settle(Frame::at(DVec3::ZERO));
        assert!((f64::from(plane.point.y) + 0.05).abs() < 1e-8, "{}", plane.point);
    }
}
