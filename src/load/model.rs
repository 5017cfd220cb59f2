//! Scenes made from a single model file: a camera that shows all of it, two lights and a sky.

use std::f32::consts::PI;
use std::path::Path;

use glam::{DVec3, Vec3};

use super::assembly::Assembly;
use super::bare::{ModelLight, ModelOptions};
use super::extent::WIDEST;
use super::extras::{Lamp, LampKind, View};
use super::format::Format;
use super::origin::Frame;
use super::request::Request;
use super::{LoadOptions, Loaded};
use crate::geometry::{Aabb, COORDINATE_LIMIT, Shape};
use crate::scene::ranges::LEAST_SINE_OF_UP;
use crate::scene::{Camera, Environment, Falloff, Light, LightKind, Projection, Rgb, Scene};
use crate::{Error, Result};

/// Full vertical angle of view, in degrees.
const VFOV: f32 = 40.0;
/// Direction from the model to the camera: front, right and above.
const TOWARDS_CAMERA: DVec3 = DVec3::new(0.5, 0.4, 1.0);

/// Reads a model and builds a scene around it.
pub(super) fn load(path: &Path, format: Format, options: &LoadOptions) -> Result<Loaded> {
    let model = &options.model;
    let mut assembly = Assembly::new(path, options)?;
    let mut replace = Vec::with_capacity(model.materials.len());
    for (name, surface) in &model.materials {
        let material = surface.material(name, &mut assembly);
        replace.push((name.clone(), assembly.add_material(material)?));
    }
    let request = Request {
        name: path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned()),
        material: None,
        replace: &replace,
        smooth: model.smooth,
        flip: false,
        transform: model.up.transform(),
        limit: WIDEST,
        wrong_transform: &|e| Error::file(path, e),
    };
    let extras = format.load(path, &request, &mut assembly)?;
    if let Some(fault) = request.not_replaced(&extras.names) {
        return Err(Error::Usage(format!("--material: {}: {fault}", path.display())));
    }
    let frame = assembly.settle(None)?;
    let bounds = bounds(&assembly.scene);
    let own_camera = extras
        .view
        .as_ref()
        .filter(|_| model.eye.is_none() && model.target.is_none() && model.fov.is_none())
        .and_then(|view| placed(view, frame, &bounds));
    let seen = if own_camera.is_some() { "the model's camera" } else { "a camera fitted to the model" };
    assembly.scene.camera = match own_camera {
        Some(camera) => camera,
        None => camera(&bounds, model, frame)?,
    };
    let own: Vec<Light> = if model.lights.is_empty() {
        extras.lamps.iter().filter_map(|lamp| light(lamp, frame)).collect()
    } else {
        let at = |(i, light): (usize, &ModelLight)| Light {
            name: format!("light {}", i + 1),
            kind: LightKind::Point { position: frame.local(light.position).as_vec3() },
            intensity: Rgb::splat(light.intensity),
            falloff: Falloff::None,
            shadows: true,
        };
        model.lights.iter().enumerate().map(at).collect()
    };
    if model.lights.is_empty() && own.len() < extras.lamps.len() {
        let kind = "lights beyond the largest coordinate are left out";
        assembly.reporter.warn(path, 0, kind, || format!(" ({} of them)", extras.lamps.len() - own.len()))?;
    }
    let lit = match (own.is_empty(), model.lights.is_empty()) {
        (true, _) => "a key light, two weak ones that leave no side black",
        (_, true) => "the model's lights",
        _ => "the lights that were given",
    };
    assembly.scene.lights = if own.is_empty() { lights(assembly.scene.camera.eye) } else { own };
    let sky = if model.background.is_some() || model.environment.is_some() { "surroundings" } else { "a sky" };
    assembly.scene.environment = match (&model.background, &model.environment) {
        (Some(colour), _) => Environment::Constant(*colour),
        (None, Some(file)) => Environment::LatLong { texture: assembly.picture(file)?, scale: Rgb::ONE, rotation: 0.0 },
        (None, None) => Environment::Gradient {
            nadir: Rgb::splat(0.2),
            horizon: Rgb::new(0.8, 0.85, 0.9),
            zenith: Rgb::new(0.3, 0.45, 0.75),
        },
    };
    assembly.reporter.default_used(format!("{seen}, {lit}, and {sky}"));
    Ok(assembly.finish())
}

/// Returns the camera: a three-quarter view of the bounding box's sphere, as far as the options do not place it.
fn camera(bounds: &Aabb, model: &ModelOptions, frame: Frame) -> Result<Camera> {
    let (lo, hi) = (bounds.lo.as_dvec3(), bounds.hi.as_dvec3());
    let radius = (hi - lo).length() * 0.5;
    let seen = radius > 0.0 && radius.is_finite();
    if !seen && model.eye.is_none() && model.target.is_none() {
        // Nothing is visible.
        return Ok(Camera::default());
    }
    let vfov = model.fov.map_or(VFOV, |fov| fov as f32);
    let centre = if seen { (lo + hi) * 0.5 } else { DVec3::ZERO };
    let target = model.target.map_or(centre, |p| frame.local(p));
    let distance = 1.05 * if seen { radius } else { 1.0 } / (f64::from(vfov).to_radians() * 0.5).sin();
    // Far enough for `f32` to tell the eye from a target at the origin.
    let distance = distance.max(1e4 * f64::from(f32::MIN_POSITIVE));
    let eye = model.eye.map_or(target + TOWARDS_CAMERA.normalize() * distance, |p| frame.local(p));
    let (eye, target) = (eye.as_vec3(), target.as_vec3());
    let Some(view) = (target - eye).as_dvec3().try_normalize() else {
        return Err(Error::Usage(String::from("--eye: the camera stands at what it looks at; move it, or --target")));
    };
    let up = if view.cross(DVec3::Y).length() < LEAST_SINE_OF_UP { Vec3::NEG_Z } else { Vec3::Y };
    Ok(Camera { eye, target, up, projection: Projection::Pinhole { vfov }, medium: None })
}

/// Returns the camera of the model's file, whose target is as far as the middle of the model.
/// `None` beyond the largest coordinate.
fn placed(view: &View, frame: Frame, bounds: &Aabb) -> Option<Camera> {
    let eye = frame.local(view.eye);
    let centre = (bounds.lo.as_dvec3() + bounds.hi.as_dvec3()) * 0.5;
    let distance = (centre - eye).length();
    // Far enough for the digits of `f32` to hold the direction.
    let least = eye.abs().max_element().max(f64::MIN_POSITIVE) * 1e-2;
    let distance = if distance.is_finite() { distance.max(least) } else { least.max(1.0) };
    let projection = match view.projection {
        Projection::Orthographic { height } => {
            let height = (f64::from(height) / frame.unit()) as f32;
            Projection::Orthographic { height: Some(height).filter(|h| h.is_finite() && *h > 0.0)? }
        }
        other => other,
    };
    let target = (eye + view.forward * distance).as_vec3();
    let camera = Camera { eye: eye.as_vec3(), target, up: view.up, projection, medium: None };
    (reachable(camera.eye) && reachable(target)).then_some(camera)
}

/// Returns true if a place is within the largest coordinate.
fn reachable(place: Vec3) -> bool {
    place.abs().max_element() <= COORDINATE_LIMIT && place.is_finite()
}

/// Returns a light of the model's file, in the scene's unit; `None` beyond the largest coordinate.
fn light(lamp: &Lamp, frame: Frame) -> Option<Light> {
    let local = |place| frame.local(place).as_vec3();
    let kind = match lamp.kind {
        LampKind::Distant { direction } => LightKind::Directional { direction },
        LampKind::Point { place } => LightKind::Point { position: local(place) },
        LampKind::Spot { place, direction, cos_inner, cos_outer } => {
            LightKind::Spot { position: local(place), direction, cos_inner, cos_outer }
        }
    };
    // A radiant intensity gives an irradiance per square of the unit.
    let unit = if matches!(kind, LightKind::Directional { .. }) { 1.0 } else { frame.unit() };
    let intensity = (lamp.intensity.as_dvec3() / (unit * unit)).min(DVec3::splat(f64::from(f32::MAX))).as_vec3();
    let there = kind.position().is_none_or(reachable);
    there.then(|| Light { name: lamp.name.clone(), kind, intensity, falloff: Falloff::InverseSquare, shadows: true })
}

/// Direction of the key light: over the camera's left shoulder.
const KEY: DVec3 = DVec3::new(0.6, -1.0, -0.7);

/// Returns a key light, and two weak ones without shadows so that no side is black. One is at the eye and reaches all
/// that is seen; the other is opposite to the key light, for sides that only mirrors and glass show. Key and eye light
/// show a facing white surface as white.
fn lights(eye: Vec3) -> Vec<Light> {
    let far = |name: &str, direction: DVec3, strength: f32, shadows| Light {
        name: name.to_owned(),
        kind: LightKind::Directional { direction: direction.normalize().as_vec3() },
        intensity: Rgb::splat(strength * PI),
        falloff: Falloff::InverseSquare,
        shadows,
    };
    let at_eye = Light {
        name: String::from("fill"),
        kind: LightKind::Point { position: eye },
        intensity: Rgb::splat(0.2),
        falloff: Falloff::None,
        shadows: false,
    };
    vec![far("key", KEY, 0.8, true), at_eye, far("back", -KEY, 0.15, false)]
}

/// Returns the direction of one of the usual lights before it was normalised.
pub(super) fn direction_of(light: &str) -> Option<DVec3> {
    match light {
        "key" => Some(KEY),
        "back" => Some(-KEY),
        _ => None,
    }
}

/// Share of the whole extent above which a triangle is wide.
const WIDE: f32 = 0.25;
/// Number of triangles that are examined to find most of the model.
const SAMPLE: usize = 4096;

/// Returns the box that the camera shows: that of all triangles, without wide ones, such as a ground plane, and without few
/// distant ones, where either makes it more than four times as large.
fn bounds(scene: &Scene) -> Aabb {
    let shapes = scene.geometry.iter().map(|g| &g.shape);
    let mut boxes: Vec<Aabb> = Vec::new();
    for shape in shapes {
        match shape {
            Shape::Mesh(mesh) => {
                let usable = (0..mesh.triangles.len()).filter(|&i| mesh.is_usable(i));
                boxes.extend(usable.map(|i| Aabb::of(&mesh.corners(i))));
            }
            Shape::Sphere(sphere) => boxes.push(sphere.bounds()),
            Shape::Plane(_) => {}
        }
    }
    let around = |boxes: &[Aabb]| boxes.iter().fold(Aabb::EMPTY, |all, b| all.union(*b));
    let size = |b: &Aabb| (b.hi - b.lo).max_element();
    // A plane around a plane takes another round.
    for _ in 0..4 {
        let all = size(&around(&boxes));
        let limit = all * WIDE;
        let narrow: Vec<Aabb> = boxes.iter().copied().filter(|b| size(b) <= limit).collect();
        let near = most(&narrow);
        let kept = [narrow, near].into_iter().find(|kept| {
            let extent = size(&around(kept));
            !kept.is_empty() && extent <= limit && extent > 0.0
        });
        match kept {
            Some(kept) => boxes = kept,
            None => break,
        }
    }
    around(&boxes)
}

/// Returns the boxes near most of them: within the range of 19 of 20 along each axis, widened by its size.
fn most(boxes: &[Aabb]) -> Vec<Aabb> {
    let centre = |b: &Aabb| b.lo * 0.5 + b.hi * 0.5;
    let sample: Vec<Vec3> = boxes.iter().step_by(boxes.len() / SAMPLE + 1).map(centre).collect();
    let stray = sample.len() / 40;
    let range = |axis: usize| {
        let mut along: Vec<f32> = sample.iter().map(|p| p[axis]).collect();
        along.sort_unstable_by(f32::total_cmp);
        (along[stray], along[along.len() - 1 - stray])
    };
    if sample.is_empty() {
        return Vec::new();
    }
    let (lo, hi): (Vec<f32>, Vec<f32>) = (0..3).map(range).unzip();
    let (lo, hi) = (Vec3::from_slice(&lo), Vec3::from_slice(&hi));
    let margin = Vec3::splat((hi - lo).max_element());
    let near = |b: &&Aabb| (centre(b).cmpge(lo - margin) & centre(b).cmple(hi + margin)).all();
    boxes.iter().filter(near).copied().collect()
}
