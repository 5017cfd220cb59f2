//! Planar mirrors by matrix, for one ray: the camera's ray becomes one of the camera's mirror image.

use glam::DVec3;

use super::Prepared;
use super::split::Way;
use super::trace::{Arrival, Branch, Tracer};
use crate::render::record::Recorder;
use crate::render::{Limit, RayKind};

/// A ray of a camera, or of a mirror image of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Image {
    /// Mirrors in a row that the camera was mirrored in.
    level: u32,
    /// Parameter at which the ray passes the plane of the last of them.
    pub clip: f64,
    /// Start of the visible part of the ray: the plane, and a margin that keeps the ray off it.
    pub t_min: f64,
}

/// Start of the ray of an image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    pub origin: DVec3,
    pub image: Image,
}

impl<L: Recorder> Tracer<'_, '_, L> {
    /// Sends what is reflected as a ray of the camera's image in the mirror that was met; as any other where the ray that met
    /// it is no camera's, or the mirror is not planar.
    pub(super) fn reflected_by_matrix(&mut self, at: &Arrival, way: Way) {
        let kind = RayKind::Reflected;
        let Some((dir, start)) = self.prepared.image_of(at) else {
            return self.send(at, kind, at.mirrored(), way, at.ray.stack.clone());
        };
        let weight = at.ray.weight * way.share;
        if weight == DVec3::ZERO {
            return;
        }
        if start.image.level > self.prepared.mirror_levels {
            self.end(Limit::Asked, weight);
            return;
        }
        let (stack, polarisation) = (at.ray.stack.clone(), way.polarisation);
        self.branches.push(Branch { kind, dir, weight, nm: at.ray.nm, stack, polarisation, start: Some(start) });
    }
}

impl Prepared<'_> {
    /// The direction and the start of the mirror image of a ray that met a mirror.
    fn image_of(&self, at: &Arrival) -> Option<(DVec3, Start)> {
        let (mirrors, image) = (self.mirrors.as_ref()?, at.ray.image?);
        if at.returning.is_some() {
            return None;
        }
        let (object, primitive) = at.id;
        let mirror = &mirrors.list[mirrors.at(object, primitive)? as usize];
        let matrix = mirror.matrix();
        let origin = DVec3::from(matrix.point(at.ray.origin.into()));
        let dir = DVec3::from(matrix.direction(at.ray.dir.into()));
        let speed = mirror.normal.dot(dir);
        let clip = mirror.normal.dot(mirror.point - origin) / speed;
        let rounding = 16.0 * f64::EPSILON * (origin.abs().max_element() + mirror.point.abs().max_element());
        let margin = at.surface.clearance + mirror.spread + rounding;
        let t_min = clip + margin / speed.abs();
        Some((dir, Start { origin, image: Image { level: image.level + 1, clip, t_min } }))
    }
}
