//! Rays that leave a surface, started by the renderer's own rule.

use glam::Vec3;

use super::id::Id;
use crate::accel::reference::{Ray64, Reference};
use crate::geometry::{Geometry, Hit, Ray, Shape, Spot};

/// Smallest cosine to the surface; rounding may turn nearer directions to its other side.
const LEAST_COSINE: f32 = 1e-5;

/// Returns the reflected ray and the straight one for each of `rays`, of unit direction, that hits something. The
/// second list holds the primitive that each ray leaves and must not hit again: a triangle, a plane, or a sphere left
/// outwards.
#[must_use]
pub fn leaving(reference: &Reference, geometry: &[Geometry], rays: &[Ray]) -> (Vec<Ray>, Vec<Option<Id>>) {
    let met = rays.iter().map(|ray| (ray, reference.closest(&Ray64::from(ray)).to_f32(ray.t_min)));
    met.filter(|(_, hit)| hit.is_hit()).flat_map(|(ray, hit)| both(geometry, ray, &hit)).unzip()
}

fn both(geometry: &[Geometry], ray: &Ray, hit: &Hit) -> Vec<(Ray, Option<Id>)> {
    let shape = &geometry[hit.geometry as usize].shape;
    let spot = Spot::at(shape, ray, hit);
    let outward = Vec3::from(spot.outward);
    let reflected = ray.dir - outward * (2.0 * ray.dir.dot(outward));
    let sound = |dir: &Vec3| spot.reach.is_finite() && dir.dot(outward).abs() > LEAST_COSINE;
    [reflected, ray.dir]
        .into_iter()
        .filter(sound)
        .map(|dir| {
            let out = dir.dot(outward) > 0.0;
            let start = Vec3::from(spot.leave(if out { spot.outward } else { -spot.outward }));
            let gone = out || !matches!(shape, Shape::Sphere(_));
            (Ray { admits: ray.admits, ..Ray::new(start, dir) }, gone.then_some(hit.id()))
        })
        .collect()
}
