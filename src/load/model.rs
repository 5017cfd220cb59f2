//! Scenes made from a single model file: a camera that shows all of it, two lights and a sky.

use std::f32::consts::PI;
use std::path::Path;

use glam::{DVec3, Vec3};

use super::assembly::Assembly;
use super::extent::WIDEST;
use super::format::Format;
use super::request::Request;
use super::transform::Transform;
use super::{LoadOptions, Loaded};
use crate::geometry::{Aabb, Shape};
use crate::scene::{Camera, Environment, Falloff, Light, LightKind, Projection, Rgb, Scene};
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
        replace: &[],
        smooth: None,
        flip: false,
        transform: Transform::IDENTITY,
        limit: WIDEST,
        wrong_transform: &|e| Error::file(path, e),
    };
    format.load(path, &request, &mut assembly)?;
    assembly.settle(None)?;
    assembly.scene.camera = fitted(&bounds(&assembly.scene));
    assembly.scene.lights = lights(assembly.scene.camera.eye);
    assembly.scene.environment = Environment::Gradient {
        nadir: Rgb::splat(0.2),
        horizon: Rgb::new(0.8, 0.85, 0.9),
        zenith: Rgb::new(0.3, 0.45, 0.75),
    };
    assembly
        .reporter
        .default_used("a camera fitted to the model, a key light, two weak ones that leave no side black, and a sky");
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
