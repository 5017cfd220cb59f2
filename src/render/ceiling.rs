//! How bright anything in a scene can be: what proves that a cut ray was worth less than it may be.
//!
//! Let `U(d)` bound, per channel, what a ray of depth `d` and weight 1 can add to its pixel. It either meets nothing and
//! sees the environment, or meets a surface with base `B`, whose secondary rays have shares that sum to at most `g` and
//! a depth of `d + 1`. No absorption is above 1, and a surface that is not there changes nothing. So
//! `U(d) = max(E, max over surfaces (B + g U(d + 1)))`, where `E` bounds the environment, the base share of a coat or a
//! hole takes its part from `g`, and past the depth limit only a mirror that looks up the environment finds anything:
//! `U(limit + 1) = E`. What is bounded is the picture with this depth limit.
//!
//! A base is bounded by emission, ambient, and for each light the largest albedo and highlight times what arrives
//! at the nearest point of the surface, cosines and lobes taken as 1, shadows as none.

use glam::{DVec3, Vec3};

use super::options::Options;
use crate::geometry::{Shape, Spot, TriMesh};
use crate::optics::FresnelModel;
use crate::scene::{Colour, Environment, Falloff, FresnelRule, Interface, Light, LightKind, Material, MirrorSource};
use crate::scene::{Object, Rgb, Scene};
use crate::{Error, Result};

/// What rounding in `f32` may add to a base, in proportion: cosines and lobes a few roundings above 1.
const ROUNDED_UP: f64 = 1.0 + 1e-5;

/// Upper bounds on what a ray of weight 1 adds to its pixel, by its depth.
#[derive(Clone, Debug)]
pub struct Ceiling {
    by_depth: Vec<DVec3>,
}

impl Ceiling {
    /// The bounds of a scene at its depth limit.
    ///
    /// # Errors
    /// [`Error::Usage`], where there is none: a light that weakens with the square of the distance touches a surface
    /// that answers to it, or numbers grow beyond all bounds.
    pub fn of(scene: &Scene) -> Result<Self> {
        let ceiling = Self::with(scene, |number, object, material| of_base(scene, number, object, material))?;
        if ceiling.by_depth.iter().any(|most| !most.is_finite()) {
            return Err(refused("the light of this scene adds up beyond all bounds"));
        }
        Ok(ceiling)
    }

    /// The bounds of a scene as far as it has any. `brightest` stands for the light of lamps on surfaces that they touch, and
    /// for all light that adds up beyond all bounds.
    #[must_use]
    pub fn estimate(scene: &Scene, brightest: DVec3) -> Self {
        let base = |number: usize, object: &Object, material: &Material| {
            let own = material.emission.abs().as_dvec3() + (material.ambient * scene.ambient).abs().as_dvec3();
            Ok(of_base(scene, number, object, material).unwrap_or(own + brightest))
        };
        let estimated = Self::with(scene, base).ok().filter(|c| c.by_depth.iter().all(|most| most.is_finite()));
        estimated.unwrap_or_else(|| Self { by_depth: vec![brightest.max(of_environment(scene))] })
    }

    fn with(scene: &Scene, base: impl Fn(usize, &Object, &Material) -> Result<DVec3>) -> Result<Self> {
        let environment = of_environment(scene);
        let mut surfaces = Vec::with_capacity(scene.objects.len());
        for (number, object) in scene.objects.iter().enumerate() {
            let material = &scene.materials[object.material as usize];
            surfaces.push((base(number, object, material)?, material));
        }
        let deepest = scene.settings.max_depth as usize;
        let mut by_depth = vec![environment; deepest + 2];
        for depth in (0..=deepest).rev() {
            let beyond = by_depth[depth + 1];
            by_depth[depth] = surfaces
                .iter()
                .fold(environment, |most, &(base, material)| most.max(of_surface(material, base, beyond, environment)));
        }
        Ok(Self { by_depth })
    }

    /// [`Ceiling::tolls`] where options ask for a proven cut-off, and whether what they ask for can be had.
    ///
    /// # Errors
    /// As [`Ceiling::of`], and where media disperse light. Wavelengths have channels below 0, so that those a white ray
    /// divides into, and what of it is reflected, together weigh more than it does, by a factor at each surface: no bound
    /// that is worth having is left after a few. And what is reflected stays one white ray, of which each wavelength has
    /// a polarisation of its own.
    pub fn asked(scene: &Scene, options: &Options) -> Result<Option<Self>> {
        let (flag, reason) = match options {
            Options { cutoff_error: Some(_), .. } => (
                "--cutoff-error",
                "wavelengths weigh less than nothing in some channels, and together more than the ray they come from",
            ),
            Options { fresnel: FresnelModel::Polarised, .. } => (
                "--fresnel polarised",
                "what a surface reflects stays one white ray, though each wavelength is polarised otherwise",
            ),
            _ => return Ok(None),
        };
        if let Some(medium) = scene.media.iter().find(|m| m.disperses()) {
            return Err(Error::Usage(format!(
                "{flag} is not for scenes whose media disperse light, as `{}` does: {reason}; take --no-dispersion \
                 besides, or leave the option out",
                medium.name
            )));
        }
        options.cutoff_error.map(|error| Self::tolls(scene, error)).transpose()
    }

    /// What cutting a ray of weight 1 may cost, in units of the error that may be made: the bounds over `error`, which is
    /// above 0.
    ///
    /// # Errors
    /// As [`Ceiling::of`].
    pub fn tolls(scene: &Scene, error: f32) -> Result<Self> {
        let ceiling = Self::of(scene)?;
        Ok(Self { by_depth: ceiling.by_depth.into_iter().map(|most| most / f64::from(error)).collect() })
    }

    /// The bound for a ray of this depth, 0 being the camera's, per channel.
    #[must_use]
    pub fn at(&self, depth: usize) -> DVec3 {
        self.by_depth[depth.min(self.by_depth.len() - 1)]
    }
}

fn refused(reason: &str) -> Error {
    Error::Usage(format!("--cutoff-error: {reason}; take --cutoff instead"))
}

/// A surface's base with what its secondary rays can bring, where those of the next depth bring at most `beyond`.
fn of_surface(material: &Material, base: DVec3, beyond: DVec3, environment: DVec3) -> DVec3 {
    let divided = |rule: FresnelRule, tint: Rgb| {
        let tint = tint.abs().as_dvec3();
        let gain = match rule {
            // R + (1 - R) tint, for R in 0..=1.
            FresnelRule::Fresnel => tint.max(DVec3::ONE),
            FresnelRule::Fixed(share) => {
                let share = share.as_dvec3();
                (share.abs() + (DVec3::ONE - share).abs() * tint).max(DVec3::ONE)
            }
        };
        base + gain * beyond
    };
    match material.interface {
        Interface::Opaque => base,
        Interface::Mirror { reflectance, source: MirrorSource::Traced } => base + reflectance.abs().as_dvec3() * beyond,
        Interface::Mirror { reflectance, source: MirrorSource::Environment } => {
            base + reflectance.abs().as_dvec3() * environment
        }
        Interface::Conductor { .. } => base + beyond,
        Interface::Dielectric { rule, tint, .. } | Interface::ThinDielectric { rule, tint, .. } => divided(rule, tint),
        Interface::Coated { .. } => base.max(beyond),
        Interface::Alpha { opacity } => {
            let opacity = f64::from(opacity);
            base * opacity.abs() + beyond * (1.0 - opacity).abs()
        }
    }
}

fn of_environment(scene: &Scene) -> DVec3 {
    match &scene.environment {
        Environment::Constant(colour) => colour.abs().as_dvec3(),
        Environment::Gradient { nadir, horizon, zenith } => nadir.abs().max(horizon.abs()).max(zenith.abs()).as_dvec3(),
        Environment::LatLong { texture, scale, .. } => of_texture(scene, *texture) * scale.abs().as_dvec3(),
    }
}

/// Bilinear mixtures are never above the largest texel.
fn of_texture(scene: &Scene, texture: u32) -> DVec3 {
    scene.textures[texture as usize].pixels.iter().fold(Vec3::ZERO, |most, texel| most.max(texel.abs())).as_dvec3()
}

fn of_colour(scene: &Scene, colour: &Colour) -> DVec3 {
    match colour {
        Colour::Constant(colour) => colour.abs().as_dvec3(),
        Colour::Image { texture, scale } => of_texture(scene, *texture) * scale.abs().as_dvec3(),
        Colour::Checker { even, odd, .. } => even.abs().max(odd.abs()).as_dvec3(),
    }
}

fn of_base(scene: &Scene, number: usize, object: &Object, material: &Material) -> Result<DVec3> {
    let mut most = material.emission.abs().as_dvec3() + (material.ambient * scene.ambient).abs().as_dvec3();
    let albedo = of_colour(scene, &material.diffuse);
    let highlight = material.highlight.map_or(DVec3::ZERO, |h| h.colour.abs().as_dvec3());
    if albedo == DVec3::ZERO && highlight == DVec3::ZERO {
        return Ok(most);
    }
    for light in &scene.lights {
        let arriving = light.intensity.abs().as_dvec3();
        most += match light.falloff {
            Falloff::None => (albedo + highlight) * arriving,
            Falloff::InverseSquare => {
                let weakened = arriving * most_share(light, &scene.geometry[number].shape, object)?;
                (albedo / std::f64::consts::PI + highlight) * weakened
            }
        };
    }
    Ok(most * ROUNDED_UP)
}

/// The most that a light of intensity 1 that weakens with distance can send to a place on a shape that faces it.
fn most_share(light: &Light, shape: &Shape, object: &Object) -> Result<f64> {
    let nearest = match light.kind {
        LightKind::Directional { .. } => return Ok(1.0),
        LightKind::Point { position } | LightKind::Spot { position, .. } => nearest(position.as_dvec3(), shape),
        LightKind::Sphere { position, radius } => {
            // Half of what even radiance over a half sphere comes to; places inside get nothing.
            let outside = nearest(position.as_dvec3(), shape).max(f64::from(radius) * (1.0 - 1e-5));
            return Ok(2.0 / (outside * outside));
        }
        LightKind::Rectangle { corner, edges, .. } => {
            let [u, v] = edges.map(|edge| edge.as_dvec3() * 0.5);
            nearest_to_sheet(corner.as_dvec3() + u + v, [u, v], shape, 5)
        }
    };
    if nearest > 0.0 {
        return Ok(1.0 / (nearest * nearest));
    }
    let place = match &object.origin {
        origin if origin.line > 0 => format!(" ({}:{})", origin.file, origin.line),
        _ => String::new(),
    };
    Err(refused(&format!(
        "there is no bound on what is cut: `{}` shines with inverse-square falloff and has no least distance to \
         object `{}`{place}, which it touches to within rounding; move one of them, or give the light falloff = \"none\"",
        light.name, object.name
    )))
}

/// A lower bound on the distance between a parallelogram, by its middle and half its edges, and a shape: that of the
/// middle less what the corners are off it, by quarters where that is coarse.
fn nearest_to_sheet(middle: DVec3, half: [DVec3; 2], shape: &Shape, levels: u32) -> f64 {
    let [u, v] = half;
    let off = (u + v).length().max((u - v).length());
    let near = nearest(middle, shape);
    if levels == 0 || off < near / 16.0 {
        return near - off;
    }
    let quarter = |i: f64, j: f64| nearest_to_sheet(middle + u * i + v * j, [u * 0.5, v * 0.5], shape, levels - 1);
    quarter(-0.5, -0.5).min(quarter(0.5, -0.5)).min(quarter(-0.5, 0.5)).min(quarter(0.5, 0.5))
}

/// The least distance between a point and any place on a shape that shading may take as a start of a ray to it: rays
/// start a little off their surfaces. Not above 0 where it cannot be told from 0.
fn nearest(lamp: DVec3, shape: &Shape) -> f64 {
    match shape {
        Shape::Mesh(mesh) => (0..mesh.triangles.len())
            .filter(|&i| mesh.is_usable(i))
            .map(|i| to_triangle(lamp, mesh.corners(i).map(|p| p.as_dvec3())) - most_reach(mesh, i))
            .fold(f64::INFINITY, f64::min),
        Shape::Sphere(sphere) => {
            let (centre, radius) = (sphere.centre.as_dvec3(), f64::from(sphere.radius));
            (lamp.distance(centre) - radius).abs() - OFF * (centre.abs().element_sum() + radius)
        }
        Shape::Plane(plane) => {
            let anchor = plane.point.as_dvec3();
            let height = (lamp - anchor).dot(plane.normal.as_dvec3().normalize()).abs();
            // Farther points lie off by more, but never by more than they are farther.
            height - OFF * (lamp.abs().element_sum() + anchor.abs().element_sum() + 2.0 * height)
        }
    }
}

/// Largest distance of a start from a sphere or plane, in proportion to its coordinates: `geometry::Spot` has 14 roundings,
/// and the place itself is off by as many again at worst.
const OFF: f64 = 2e-6;

/// How far off triangle `i` the start of a ray may lie. The bound of `geometry::Spot` is largest at a corner.
fn most_reach(mesh: &TriMesh, i: usize) -> f64 {
    let corners = mesh.corners(i).map(crate::math::Vector3::<f32>::from);
    [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]
        .iter()
        .map(|&(u, v)| Spot::on_triangle(corners, u, v).reach)
        // A triangle without area lies off by no finite number, and is lit by nothing.
        .map(|reach| if reach.is_finite() { 1.001 * f64::from(reach) } else { 0.0 })
        .fold(0.0, f64::max)
}

/// The distance from `p` to the triangle (Ericson, Real-Time Collision Detection, section 5.1.5).
fn to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return ap.length();
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return bp.length();
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (ap - ab * (d1 / (d1 - d3))).length();
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return cp.length();
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (ap - ac * (d2 / (d2 - d6))).length();
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return (bp - (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)))).length();
    }
    let within = 1.0 / (va + vb + vc);
    (ap - ab * (vb * within) - ac * (vc * within)).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_to_a_triangle_is_that_to_the_nearest_of_many_points_of_it() {
        let mut state = 7_u64;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
        };
        for _ in 0..200 {
            let mut point = || DVec3::new(number(), number(), number());
            let (p, corners) = (point() * 2.0, [point(), point(), point()]);
            let got = to_triangle(p, corners);
            let n = 200;
            let mut nearest = f64::INFINITY;
            for i in 0..=n {
                for j in 0..=n - i {
                    let (u, v) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
                    let q = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
                    nearest = nearest.min(p.distance(q));
                }
            }
            assert!(got <= nearest + 1e-12 && nearest - got < 0.03, "{got} {nearest}");
        }
    }
}
