//! Treatment of reflected light: traced, looked up in the environment, or left out.

use super::super::extra::Extra8;
use super::super::limit::Limit;
use super::super::options::Reflection;
use super::super::outcome::RayKind;
use super::super::queue::{Rgb8, Spawn8};
use super::super::shading::Shading;
use super::super::sky::{Constant, Gradient, LatLong, Sky};
use super::super::surface::Surface8;
use crate::scene::{Environment, Scene};
use crate::simd::Vec3x8;

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
        (Reflection::None, _) => none,
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

/// Leaves the reflection out, and counts its weight as truncated.
fn none(shading: &mut Shading, surface: &Surface8, lanes: u8, _: Vec3x8, weight: Rgb8, _: Option<&Extra8>, _: usize) {
    shading.accumulator.add_ended8(Limit::Asked, lanes, &surface.pixel, &weight);
}
