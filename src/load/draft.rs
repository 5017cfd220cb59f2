//! Shapes in world coordinates in `f64`, before the scene's origin is known.

use glam::DVec3;

use super::extent::{Extent, WIDEST, within};
use super::origin::Frame;
use crate::geometry::{Plane, Shape, Sphere, TriMesh};

/// Number of corners of a mesh that are examined to find its bulk.
const SAMPLE: usize = 1024;
/// One in this many corners may be an outlier on either side, along each axis.
const STRAY: usize = 20;

/// Rounds a position to `f32`, unless `keep` preserves all digits.
pub(super) fn rounded(place: DVec3, keep: bool) -> DVec3 {
    if keep { place } else { place.as_vec3().as_dvec3() }
}

/// Mesh in world coordinates.
#[derive(Clone, Debug, Default)]
pub(super) struct MeshDraft {
    /// Positions, later copied to `mesh`.
    pub corners: Vec<DVec3>,
    /// All other data; no positions yet.
    pub mesh: TriMesh,
    /// Smoothing group of each triangle, 0 for none; empty if there is none, and if the mesh has normals.
    pub smoothing: Vec<u32>,
}

impl MeshDraft {
    pub(super) fn extent(&self) -> Extent {
        Extent::around(self.corners.iter().copied())
    }

    /// Returns the box around most of the mesh, which ignores a few distant corners.
    fn bulk(&self) -> Extent {
        let step = self.corners.len() / SAMPLE + 1;
        let sample: Vec<DVec3> = self.corners.iter().step_by(step).copied().filter(|&p| within(p, WIDEST)).collect();
        if sample.is_empty() {
            return self.extent();
        }
        let mut bulk = Extent::EMPTY;
        for axis in 0..3 {
            let mut along: Vec<f64> = sample.iter().map(|p| p[axis]).collect();
            along.sort_unstable_by(f64::total_cmp);
            let stray = along.len() / STRAY;
            (bulk.lo[axis], bulk.hi[axis]) = (along[stray], along[along.len() - 1 - stray]);
        }
        if bulk.size() > 0.0 { bulk } else { self.extent() }
    }

    /// Rounds the corners to `f32`, except where the mesh is far. The numbers of a file and the corners of built-in
    /// shapes are rounded before they are moved.
    pub(super) fn round_unless_far(&mut self) {
        if self.extent().suits_f32() {
            self.corners.iter_mut().for_each(|p| *p = rounded(*p, false));
        }
    }

    /// Returns the mesh in `frame`.
    fn settle(self, frame: Frame) -> TriMesh {
        let positions = self.corners.iter().map(|&p| frame.shifted(p).as_vec3()).collect();
        TriMesh { positions, ..self.mesh }
    }
}

impl From<TriMesh> for MeshDraft {
    fn from(mut mesh: TriMesh) -> Self {
        let corners = std::mem::take(&mut mesh.positions).into_iter().map(|p| p.as_dvec3()).collect();
        Self { corners, mesh, smoothing: Vec::new() }
    }
}

/// Exact sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ball {
    pub centre: DVec3,
    pub radius: f64,
}

impl Ball {
    /// Creates the sphere given by a file, rounded to `f32` as [`MeshDraft::round_unless_far`] rounds meshes.
    pub(super) fn new(centre: DVec3, radius: f64) -> Self {
        let exact = Self { centre, radius: f64::from(radius as f32) };
        Self { centre: rounded(centre, !exact.extent().suits_f32()), ..exact }
    }

    fn extent(&self) -> Extent {
        Extent::around([self.centre - self.radius, self.centre + self.radius].into_iter())
    }
}

/// Infinite plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Flat {
    /// Point on the plane.
    pub point: DVec3,
    /// Unit normal.
    pub normal: DVec3,
    /// The same plane with each number rounded to `f32` before and after it was moved.
    pub near: Plane,
}

impl Flat {
    /// Returns the plane with its sides exchanged.
    pub(super) fn flipped(self) -> Self {
        let near = Plane { normal: -self.near.normal, ..self.near };
        Self { normal: -self.normal, near, ..self }
    }

    /// Returns the plane in `frame`, held by its point nearest to the origin, so that the digits of a distant point do
    /// not matter.
    pub(super) fn settle(self, frame: Frame) -> Plane {
        if frame == Frame::at(DVec3::ZERO) {
            return self.near;
        }
        let foot = self.normal * frame.shifted(self.point).dot(self.normal);
        Plane { point: foot.as_vec3(), ..self.near }
    }

    /// Returns the point on the plane nearest to `place`.
    pub(super) fn foot(&self, place: DVec3) -> DVec3 {
        place + self.normal * (self.point - place).dot(self.normal)
    }
}

/// Shape in world coordinates.
#[derive(Clone, Debug)]
pub(super) enum Draft {
    Mesh(MeshDraft),
    Ball(Ball),
    Flat(Flat),
}

impl Draft {
    /// Returns the box around the shape; empty for a plane.
    pub(super) fn extent(&self) -> Extent {
        match self {
            Self::Mesh(mesh) => mesh.extent(),
            Self::Ball(ball) => ball.extent(),
            Self::Flat(_) => Extent::EMPTY,
        }
    }

    /// Returns the box around most of the shape.
    pub(super) fn bulk(&self) -> Extent {
        match self {
            Self::Mesh(mesh) => mesh.bulk(),
            Self::Ball(_) | Self::Flat(_) => self.extent(),
        }
    }

    /// Returns the shape in `frame`.
    pub(super) fn settle(self, frame: Frame) -> Shape {
        match self {
            Self::Mesh(mesh) => Shape::Mesh(mesh.settle(frame)),
            Self::Ball(ball) => Shape::Sphere(Sphere {
                centre: frame.shifted(ball.centre).as_vec3(),
                radius: (ball.radius / frame.unit()) as f32,
            }),
            Self::Flat(flat) => Shape::Plane(flat.settle(frame)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_within_64_times_its_size_is_rounded_and_what_lies_beyond_is_not() {
        let ball = |x: f64| Ball::new(DVec3::new(x, 0.0, 0.0), 0.5).centre.x;
        assert_eq!(ball(60.1), f64::from(60.1_f32));
        assert_eq!(ball(70.1), 70.1);
    }
}
