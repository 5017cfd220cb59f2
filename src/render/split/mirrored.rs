//! Treatment of reflected light: traced, looked up in the environment, or left out.

use super::super::extra::Extra8;
use super::super::limit::Limit;
use super::super::options::Reflection;
use super::super::outcome::RayKind;
use super::super::queue::{Rgb8, Spawn8};
use super::super::shading::Shading;
use super::super::sky::{Constant, Gradient, LatLong, Mapped, Sky};
use super::super::surface::Surface8;
use crate::scene::{Environment, Rgb, Scene};
use crate::simd::{Vec3x8, set_lanes};

/// Function that handles light of the given weight that leaves eight surfaces in a direction of about unit length. The
/// extras, if given, replace those of the arriving rays. The last argument is the depth of the arriving rays.
pub type ReflectStage = fn(&mut Shading, &Surface8, u8, Vec3x8, Rgb8, Option<&Extra8>, usize);

/// Picks the stage of one render.
#[must_use]
pub fn pick(reflection: Reflection, scene: &Scene) -> ReflectStage {
    match (reflection, &scene.environment) {
        (Reflection::Traced, _) => traced,
        (Reflection::Environment, Environment::Constant(_)) => looked_up::<Constant>,
        (Reflection::Environment, Environment::Gradient { .. }) => looked_up::<Gradient>,
        (Reflection::Environment, Environment::LatLong { .. }) => looked_up::<LatLong>,
        (Reflection::Environment, Environment::Map { .. }) => looked_up::<Mapped>,
        (Reflection::None, _) => none,
        (Reflection::CubeMap | Reflection::SphereMap, _) => in_map,
        (Reflection::Planar, _) => mirrored_camera,
        (Reflection::Virtual, _) => in_virtual_scene,
    }
}

/// Masks the pixel for the camera's mirror image if a ray of the camera, or of an image of it, hit a planar mirror. Traces a
/// reflected ray otherwise.
fn mirrored_camera(
    shading: &mut Shading,
    surface: &Surface8,
    lanes: u8,
    dir: Vec3x8,
    weight: Rgb8,
    extra: Option<&Extra8>,
    depth: usize,
) {
    let masked = shading.passes.masked(surface, lanes);
    if masked != 0 {
        if shading.passes.at_last_level() {
            shading.accumulator.add_ended8(Limit::Asked, masked, &surface.pixel, &weight);
        } else {
            let kept = shading.lasting(masked, &weight, &surface.pixel, depth);
            shading.passes.mask(surface, kept, &weight);
        }
    }
    if lanes != masked {
        traced(shading, surface, lanes & !masked, dir, weight, extra, depth);
    }
}

/// Sends the ray of the eye on into the virtual scene of the reflector. Queues a ray if there is none, or if no ray of the
/// eye met the reflector.
fn in_virtual_scene(
    shading: &mut Shading,
    surface: &Surface8,
    lanes: u8,
    dir: Vec3x8,
    weight: Rgb8,
    extra: Option<&Extra8>,
    depth: usize,
) {
    let shown = shading.virtual_rays.shown(surface, lanes, depth);
    if shown != 0 {
        let kept = shading.lasting(shown, &weight, &surface.pixel, depth);
        shading.virtual_rays.wait(shading.scene.camera.eye, surface, kept, dir, &weight);
    }
    if lanes != shown {
        traced(shading, surface, lanes & !shown, dir, weight, extra, depth);
    }
}

/// Queues a reflected ray.
fn traced(
    shading: &mut Shading,
    surface: &Surface8,
    lanes: u8,
    dir: Vec3x8,
    weight: Rgb8,
    extra: Option<&Extra8>,
    depth: usize,
) {
    let dir = dir.normalized();
    let new = Spawn8 { extra, ..surface.reflected(dir, weight) };
    shading.spawn(lanes, &new, RayKind::Reflected, depth);
}

/// Looks up the environment, ignoring occluders.
fn looked_up<S: Sky>(
    shading: &mut Shading,
    surface: &Surface8,
    lanes: u8,
    dir: Vec3x8,
    weight: Rgb8,
    _: Option<&Extra8>,
    _: usize,
) {
    let scene = shading.scene;
    let seen = S::radiance(&scene.environment, &scene.textures, &dir.normalized());
    shading.accumulator.add_radiance8(lanes, &surface.pixel, &seen.times(weight));
}

/// Looks up the map of the reflector. Traces a reflected ray if it has none, or inside a body.
fn in_map(
    shading: &mut Shading,
    surface: &Surface8,
    lanes: u8,
    dir: Vec3x8,
    weight: Rgb8,
    extra: Option<&Extra8>,
    depth: usize,
) {
    let mut left = lanes;
    if let Some(maps) = shading.maps {
        let mut seen = Vec3x8::splat(Rgb::ZERO);
        for lane in set_lanes(lanes) {
            let object = surface.hit[lane].geometry;
            let inside = !surface.front.lane(lane) && shading.scene.medium_of(object as usize).is_some();
            let Some(map) = maps.of(object).filter(|_| !inside) else { continue };
            let dir = dir.lane(lane).normalize();
            seen.set_lane(lane, maps.look_up(map, shading.proxy, surface.point.lane(lane), dir));
            left &= !(1 << lane);
        }
        shading.accumulator.add_radiance8(lanes & !left, &surface.pixel, &seen.times(weight));
        shading.without_map += u64::from(left.count_ones());
    }
    if left != 0 {
        traced(shading, surface, left, dir, weight, extra, depth);
    }
}

/// Leaves the reflection out, and counts its weight as truncated.
fn none(shading: &mut Shading, surface: &Surface8, lanes: u8, _: Vec3x8, weight: Rgb8, _: Option<&Extra8>, _: usize) {
    shading.accumulator.add_ended8(Limit::Asked, lanes, &surface.pixel, &weight);
}
