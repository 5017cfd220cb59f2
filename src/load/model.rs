//! Scenes made from a single model file: a camera that shows all of it, two lights and a sky.

use std::f32::consts::PI;
use std::path::Path;

use glam::{DVec3, Vec3};

use super::assembly::Assembly;
use super::extent::WIDEST;
use super::extras::{Lamp, LampKind, View};
use super::format::Format;
use super::origin::Frame;
use super::request::Request;
use super::transform::Transform;
use super::{LoadOptions, Loaded};
use crate::geometry::{Aabb, Shape};
use crate::scene::{Camera, Environment, Falloff, Light, LightKind, Projection, Rgb};
use crate::{Error, Result};

/// Full vertical angle of view, in degrees.
const VFOV: f32 = 40.0;
/// Direction from the model to the camera: front, right and above.
const TOWARDS_CAMERA: DVec3 = DVec3::new(0.5, 0.4, 1.0);

/// Reads a model and builds a scene around it.
pub(super) fn load(path: &Path, format: Format, options: &LoadOptions) -> Result<Loaded> {
    let mut assembly = Assembly::new(path, options)?;
    let request = Request {
        name: path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned()),
        material: None,
        smooth: None,
        flip: false,
        transform: Transform::IDENTITY,
        limit: WIDEST,
        wrong_transform: &|e| Error::file(path, e),
    };
    let extras = format.load(path, &request, &mut assembly)?;
    let frame = assembly.settle(None)?;
    let bounds = assembly.scene.geometry.iter().fold(Aabb::EMPTY, |b, g| match &g.shape {
        Shape::Mesh(mesh) => b.union(mesh.bounds()),
        Shape::Sphere(sphere) => b.union(sphere.bounds()),
        Shape::Plane(_) => b,
    });
    assembly.scene.camera = match &extras.view {
        Some(view) => placed(view, frame, &bounds),
        None => fitted(&bounds),
    };
    let own = extras.lamps.iter().map(|lamp| light(lamp, frame)).collect::<Vec<_>>();
    let used = match (extras.view.is_some(), own.is_empty()) {
        (false, true) => "a camera fitted to the model, a key and a fill light, and a sky",
        (true, true) => "the model's camera, a key and a fill light, and a sky",
        (false, false) => "a camera fitted to the model, the model's lights, and a sky",
        (true, false) => "the model's camera and lights, and a sky",
    };
    assembly.scene.lights = if own.is_empty() { lights() } else { own };
    assembly.scene.environment = Environment::Gradient {
        nadir: Rgb::splat(0.2),
        horizon: Rgb::new(0.8, 0.85, 0.9),
        zenith: Rgb::new(0.3, 0.45, 0.75),
    };
    assembly.reporter.default_used(used);
    Ok(assembly.finish())
}

/// Returns a three-quarter view that contains the bounding box's sphere at any size.
fn fitted(bounds: &Aabb) -> Camera {
    let (lo, hi) = (bounds.lo.as_dvec3(), bounds.hi.as_dvec3());
    let centre = (lo + hi) * 0.5;
    let radius = (hi - lo).length() * 0.5;
    if !(radius > 0.0 && radius.is_finite()) {
        // Nothing is visible.
        return Camera::default();
    }
    let distance = 1.05 * radius / (f64::from(VFOV).to_radians() * 0.5).sin();
    Camera {
        eye: (centre + TOWARDS_CAMERA.normalize() * distance).as_vec3(),
        target: centre.as_vec3(),
        up: Vec3::Y,
        projection: Projection::Pinhole { vfov: VFOV },
        medium: None,
    }
}

/// Returns the camera of the model's file, whose target is as far as the middle of the model.
fn placed(view: &View, frame: Frame, bounds: &Aabb) -> Camera {
    let eye = frame.local(view.eye);
    let centre = (bounds.lo.as_dvec3() + bounds.hi.as_dvec3()) * 0.5;
    let distance = (centre - eye).length();
    // Far enough for the digits of `f32` to hold the direction.
    let least = eye.abs().max_element().max(f64::MIN_POSITIVE) * 1e-2;
    let distance = if distance.is_finite() { distance.max(least) } else { least.max(1.0) };
    let projection = match view.projection {
        Projection::Orthographic { height } => Projection::Orthographic { height: height / frame.unit() as f32 },
        other => other,
    };
    let target = (eye + view.forward * distance).as_vec3();
    Camera { eye: eye.as_vec3(), target, up: view.up, projection, medium: None }
}

/// Returns a light of the model's file, in the scene's unit.
fn light(lamp: &Lamp, frame: Frame) -> Light {
    let local = |place| frame.local(place).as_vec3();
    let kind = match lamp.kind {
        LampKind::Distant { direction } => LightKind::Directional { direction },
        LampKind::Point { place } => LightKind::Point { position: local(place) },
        LampKind::Spot { place, direction, cos_inner, cos_outer } => {
            LightKind::Spot { position: local(place), direction, cos_inner, cos_outer }
        }
    };
    // A radiant intensity gives an irradiance per square of the unit.
    let unit = if matches!(kind, LightKind::Directional { .. }) { 1.0 } else { frame.unit() as f32 };
    let intensity = lamp.intensity / (unit * unit);
    Light { name: lamp.name.clone(), kind, intensity, falloff: Falloff::InverseSquare, shadows: true }
}

/// Returns a key light over the camera's left shoulder, and a weak light without shadows from the other side so that no
/// side is black. The key light shows a facing white surface as white.
fn lights() -> Vec<Light> {
    let light = |name: &str, direction: Vec3, strength: f32, shadows| Light {
        name: name.to_owned(),
        kind: LightKind::Directional { direction: direction.normalize() },
        intensity: Rgb::splat(strength * PI),
        falloff: Falloff::InverseSquare,
        shadows,
    };
    vec![light("key", Vec3::new(0.6, -1.0, -0.7), 0.8, true), light("fill", Vec3::new(-1.0, -0.4, -0.3), 0.2, false)]
}
