//! Opaque shells, and the side of a shell on which something lies.

use glam::{DVec3, Vec3};

use crate::geometry::topology::{Edges, weld};
use crate::geometry::{Aabb, Plane, Shape, Sphere, TriMesh};

/// Margin of every proof, relative to the largest coordinate in the scene: a thousand times the rounding error of a
/// point.
const MARGIN: f64 = 1e-4;

/// Number of triangles above which a mesh is not considered as a shell.
const MOST_TRIANGLES: usize = 2_000;

/// Side of a shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// Outside a closed shell; in front of a plane.
    Outside,
    /// Within a closed shell; behind a plane.
    Inside,
    /// Across the shell, or too near to tell.
    Across,
}

/// Surface that divides space in two.
pub(super) enum Shell<'a> {
    /// Infinite plane; its outside is where the normal points.
    Plane(&'a Plane),
    /// A sphere.
    Sphere(&'a Sphere),
    /// A closed convex mesh.
    Mesh(&'a TriMesh),
}

impl<'a> Shell<'a> {
    /// Returns the shell of a shape, if it is one.
    pub fn of(shape: &'a Shape) -> Option<Self> {
        match shape {
            Shape::Plane(plane) => plane.is_usable().then_some(Self::Plane(plane)),
            Shape::Sphere(sphere) => sphere.is_usable().then_some(Self::Sphere(sphere)),
            Shape::Mesh(mesh) => {
                let small = mesh.triangles.len() <= MOST_TRIANGLES;
                (small && is_closed(mesh) && is_convex(mesh)).then_some(Self::Mesh(mesh))
            }
        }
    }

    /// Returns true if the shell is a plane.
    pub fn is_plane(&self) -> bool {
        matches!(self, Self::Plane(_))
    }

    /// Returns the side on which a box lies, in a scene of coordinates up to `scale`.
    pub fn side_of_box(&self, b: &Aabb, scale: f64) -> Side {
        if b.is_empty() {
            return Side::Across;
        }
        let (lo, hi) = (b.lo.as_dvec3(), b.hi.as_dvec3());
        let (centre, half) = ((lo + hi) * 0.5, (hi - lo) * 0.5);
        let margin = MARGIN * scale;
        match self {
            Self::Plane(plane) => {
                let normal = plane.normal.as_dvec3().normalize();
                let height = normal.dot(centre - plane.point.as_dvec3());
                side(height, normal.abs().dot(half) + margin)
            }
            Self::Sphere(sphere) => {
                let (c, r) = (sphere.centre.as_dvec3(), f64::from(sphere.radius));
                let farthest = ((centre - c).abs() + half).length();
                let nearest = ((centre - c).abs() - half).max(DVec3::ZERO).length();
                if farthest < r - margin {
                    Side::Inside
                } else if nearest > r + margin {
                    Side::Outside
                } else {
                    Side::Across
                }
            }
            Self::Mesh(mesh) => {
                let grown = (lo - margin, hi + margin);
                // If no triangle's box overlaps the grown box, all of it lies on the side of its centre.
                let touched = (0..mesh.triangles.len()).any(|i| {
                    let t = Aabb::of(&mesh.corners(i));
                    t.lo.as_dvec3().cmple(grown.1).all() && t.hi.as_dvec3().cmpge(grown.0).all()
                });
                if touched { Side::Across } else { of_winding(winding_number(mesh, centre)) }
            }
        }
    }

    /// Returns the side on which a point lies.
    pub fn side_of_point(&self, p: Vec3, scale: f64) -> Side {
        self.side_of_box(&Aabb { lo: p, hi: p }, scale)
    }
}

fn side(height: f64, reach: f64) -> Side {
    if height > reach {
        Side::Outside
    } else if height < -reach {
        Side::Inside
    } else {
        Side::Across
    }
}

fn of_winding(turns: f64) -> Side {
    if turns.abs() < 0.1 {
        Side::Outside
    } else if (turns.abs() - 1.0).abs() < 0.1 {
        Side::Inside
    } else {
        Side::Across
    }
}

/// Returns true if each edge of a mesh is shared by two triangles in opposite directions, and every triangle has an
/// area.
pub(super) fn is_closed(mesh: &TriMesh) -> bool {
    let has_area = |i: usize| {
        let [a, b, c] = mesh.corners(i).map(|p| p.as_dvec3());
        let area = (b - a).cross(c - a).length();
        area > 0.0 && area.is_finite()
    };
    !mesh.triangles.is_empty()
        && (0..mesh.triangles.len()).all(has_area)
        && Edges::new(&mesh.triangles, &weld(&mesh.positions)).manifold()
}

/// Returns true if every corner of a closed mesh lies behind or in the plane of every triangle.
fn is_convex(mesh: &TriMesh) -> bool {
    let size = Aabb::of(&mesh.positions);
    let slack = 1e-6 * (size.hi - size.lo).as_dvec3().length();
    (0..mesh.triangles.len()).all(|i| {
        let [a, b, c] = mesh.corners(i).map(|v| v.as_dvec3());
        let normal = (b - a).cross(c - a).normalize();
        mesh.triangles.iter().flatten().all(|&k| normal.dot(mesh.positions[k as usize].as_dvec3() - a) <= slack)
    })
}

/// Returns the winding number of a closed mesh about a point off its triangles (van Oosterom & Strackee 1983).
fn winding_number(mesh: &TriMesh, p: DVec3) -> f64 {
    let mut angle = 0.0;
    for i in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(i).map(|v| (v.as_dvec3() - p).normalize());
        let volume = a.dot(b.cross(c));
        angle += 2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
    }
    angle / (4.0 * std::f64::consts::PI)
}
