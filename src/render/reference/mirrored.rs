//! Reflection systems for one ray: planar mirrors by matrix, where the camera's ray becomes one of the camera's mirror
//! image, and environment maps.

use glam::{DVec2, DVec3};

use super::split::Lobe;
use super::trace::{Arrival, Branch, Tracer};
use super::{Prepared, past};
use crate::accel::reference::{Hit64, Ray64};
use crate::render::record::{Recorder, Source};
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
    /// Sends the reflection of a ray of the camera, or of an image of it, in a planar mirror as a ray of the camera's mirror
    /// image. Traces any other reflection.
    pub(super) fn reflected_by_matrix(&mut self, at: &Arrival, lobe: Lobe) {
        let kind = RayKind::Reflected;
        let Some((dir, start)) = self.prepared.image_of(at) else {
            return self.send(at, kind, at.mirrored(), lobe, at.ray.stack.clone());
        };
        let weight = at.ray.weight * lobe.share;
        if weight == DVec3::ZERO {
            return;
        }
        if start.image.level > self.prepared.mirror_levels {
            self.tally.end(Limit::Asked, weight);
            return;
        }
        let (stack, polarisation) = (at.ray.stack.clone(), lobe.polarisation);
        self.branches.push(Branch {
            kind,
            dir,
            weight,
            nm: at.ray.nm,
            stack,
            polarisation,
            start: Some(start),
            shown: None,
        });
    }

    /// Sends a ray to what the virtual scene of the reflector shows; as any other where there is none, or where the ray that
    /// met the reflector is none of the eye.
    pub(super) fn reflected_in_virtual_scene(&mut self, at: &Arrival, lobe: Lobe) {
        let (prepared, kind) = (self.prepared, RayKind::Reflected);
        let front = at.geometric.dot(at.surface.outward) > 0.0;
        let image = prepared.images.as_ref().filter(|_| at.ray.depth == 0 && at.returning.is_none());
        let Some((image, accel)) = image.and_then(|images| images.at(at.id.0, front)) else {
            self.tally.without_image += 1;
            return self.send(at, kind, at.mirrored(), lobe, at.ray.stack.clone());
        };
        let weight = at.ray.weight * lobe.share;
        if weight == DVec3::ZERO {
            return;
        }
        let eye = prepared.scene.camera.eye.as_dvec3();
        let line = Ray64 { t_min: (at.surface.point - eye).length(), ..Ray64::new(eye, at.ray.dir) };
        let hit = accel.closest(&line);
        if !hit.is_hit() && image.left_out > 0 {
            self.tally.without_image += 1;
            return self.send(at, kind, at.mirrored(), lobe, at.ray.stack.clone());
        }
        let (dir, shown) = if hit.is_hit() {
            let shown = image.shown(prepared.scene, hit.geometry, hit.primitive, DVec2::new(hit.u, hit.v));
            let way = shown.place - at.surface.start(at.geometric);
            let (object, primitive) = (shown.object, shown.primitive);
            let real = Hit64 { t: way.length(), u: shown.uv.x, v: shown.uv.y, geometry: object, primitive, ..hit };
            (way, real)
        } else {
            (at.mirrored(), Hit64::MISS)
        };
        let (stack, polarisation) = (at.ray.stack.clone(), lobe.polarisation);
        let nm = at.ray.nm;
        self.branches.push(Branch { kind, dir, weight, nm, stack, polarisation, start: None, shown: Some(shown) });
    }

    /// Looks the reflection up in the map of the reflector. Traces it if there is no map, or inside a body.
    pub(super) fn reflected_in_map(&mut self, at: &Arrival, lobe: Lobe) {
        let (prepared, object) = (self.prepared, at.id.0);
        let front = at.geometric.dot(at.surface.outward) > 0.0;
        let inside = !front && prepared.scene.medium_of(object as usize).is_some();
        let maps = prepared.maps.as_ref().map(|taken| &*taken.maps);
        let Some((maps, map)) = maps.and_then(|maps| Some((maps, maps.of(object).filter(|_| !inside)?))) else {
            self.tally.without_map += 1;
            return self.send(at, RayKind::Reflected, at.mirrored(), lobe, at.ray.stack.clone());
        };
        let seen = maps.look_up(map, prepared.proxy, at.surface.point.as_vec3(), at.mirrored().as_vec3());
        self.add(at.ray.node, Source::MirroredEnvironment, at.ray.weight * lobe.share * seen.as_dvec3());
    }
}

impl Prepared<'_> {
    /// Returns the nearest hit of a ray. Camera rays pass through the object `past`, if any.
    pub(super) fn nearest(&self, ray: &Ray64, kind: RayKind) -> Hit64 {
        match self.past.filter(|_| kind == RayKind::Camera) {
            Some(object) => past(&self.accel, ray, object),
            None => self.accel.closest(ray),
        }
    }

    /// Returns direction and start of the mirror image of a ray that hit a planar mirror.
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
