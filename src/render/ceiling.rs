//! Upper bounds on the radiance a ray can bring, used to prove how little a cut ray was worth.
//!
//! Let `U(d)` bound, per channel, what a ray of depth `d` and weight 1 can add to its pixel. The ray either misses and
//! sees the environment, or hits a surface with base `B`. The secondary rays of that surface have shares that sum to at
//! most `g`, and depth `d + 1`. Transmittance is at most 1, and a passed surface changes nothing. So `U(d) = max(E, max
//! over surfaces (B + g U(d + 1)))`, where `E` bounds the environment and `g` excludes the base share of a coat or
//! cover. Past the depth limit only a mirror that looks up the environment finds light: `U(limit + 1) = E`. The bound
//! holds for the picture with this depth limit.
//!
//! A base is bounded by emission, ambient light, and for each light the largest albedo and highlight times the light
//! that arrives at the nearest point of the surface. Cosines and lobes are taken as 1, and shadows as none. A sample of the
//! environment brings at most its radiance times the excess of its weight. Samples of emissive shapes have no bound.

use glam::{DVec3, Vec3};

use super::options::Options;
use super::shine::Around;
use crate::error::{Result, Unsupported};
use crate::geometry::{Shape, Spot, TriMesh};
use crate::optics::FresnelModel;
use crate::scene::{Colour, Environment, Falloff, FresnelRule, Interface, Light, LightKind, Material, MirrorSource};
use crate::scene::{Object, Rgb, Scene};

/// Relative margin for rounding in `f32`, where cosines and lobes may exceed 1 by a few roundings.
const ROUNDED_UP: f64 = 1.0 + 1e-5;

/// Upper bounds, by depth, on what a ray of weight 1 adds to its pixel.
#[derive(Clone, Debug)]
pub struct Ceiling {
    by_depth: Vec<DVec3>,
}

impl Ceiling {
    /// Computes the bounds of a scene at its depth limit.
    ///
    /// # Errors
    /// Returns [`Unsupported`] if no bound exists: a light with inverse-square falloff touches a surface that reflects
    /// it, or the bound overflows.
    pub fn of(scene: &Scene) -> Result<Self> {
        let sampled = scene.shining().emitters();
        let ceiling = Self::with(scene, |number, object, material| of_base(scene, sampled, number, object, material))?;
        if ceiling.by_depth.iter().any(|most| !most.is_finite()) {
            return Err(Unsupported::UnboundedLight.into());
        }
        Ok(ceiling)
    }

    /// Computes the bounds of a scene where they exist. `brightest` replaces the lamp light on surfaces that a lamp
    /// touches, and every bound that overflows.
    #[must_use]
    pub fn estimate(scene: &Scene, brightest: DVec3) -> Self {
        let sampled = scene.shining().emitters();
        let base = |number: usize, object: &Object, material: &Material| {
            let own = of_emission(scene, material) + (material.ambient * scene.ambient).abs().as_dvec3();
            Ok(of_base(scene, sampled, number, object, material).unwrap_or(own + brightest))
        };
        let estimated = Self::with(scene, base).ok().filter(|c| c.by_depth.iter().all(|most| most.is_finite()));
        estimated.unwrap_or_else(|| Self { by_depth: vec![brightest.max(of_environment(scene))] })
    }

    fn with(scene: &Scene, base: impl Fn(usize, &Object, &Material) -> Result<DVec3>) -> Result<Self> {
        let environment = of_environment(scene);
        let sky = of_sky_light(scene, environment);
        let mut surfaces = Vec::with_capacity(scene.objects.len());
        for (number, object) in scene.objects.iter().enumerate() {
            let material = &scene.materials[object.material as usize];
            let under_sky = if sky == DVec3::ZERO { sky } else { of_colour(scene, &material.diffuse) * sky };
            surfaces.push((base(number, object, material)? + under_sky, material));
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

    /// Returns [`Ceiling::tolls`] if the options ask for a proven cut-off, and checks that dispersion does not rule out
    /// the options.
    ///
    /// # Errors
    /// Fails as [`Ceiling::of`] does, and where media disperse light:
    /// - Wavelengths have channels below 0. The wavelengths that a white ray divides into, and its reflected part,
    ///   together weigh more than the ray, by a factor at each surface. After a few surfaces no useful bound is left.
    /// - The reflected part stays one white ray, although each of its wavelengths has its own polarisation.
    pub fn asked(scene: &Scene, options: &Options) -> Result<Option<Self>> {
        let reason = |medium: String| match options {
            Options { cutoff_error: Some(_), .. } => Some(Unsupported::ProofWithDispersion { medium }),
            Options { fresnel: FresnelModel::Polarised, .. } => {
                Some(Unsupported::PolarisationWithDispersion { medium })
            }
            _ => None,
        };
        let dispersing = scene.media.iter().find(|m| m.disperses());
        if let Some(reason) = dispersing.and_then(|medium| reason(medium.name.clone())) {
            return Err(reason.into());
        }
        options.cutoff_error.map(|error| Self::tolls(scene, error)).transpose()
    }

    /// Computes the tolls of rays of weight 1: the bounds divided by `error`, the allowed error, which is above 0.
    ///
    /// # Errors
    /// Fails as [`Ceiling::of`] does.
    pub fn tolls(scene: &Scene, error: f32) -> Result<Self> {
        let ceiling = Self::of(scene)?;
        Ok(Self { by_depth: ceiling.by_depth.into_iter().map(|most| most / f64::from(error)).collect() })
    }

    /// Returns the bound per channel for a ray of this depth; camera rays have depth 0.
    #[must_use]
    pub fn at(&self, depth: usize) -> DVec3 {
        self.by_depth[depth.min(self.by_depth.len() - 1)]
    }
}

/// Bounds a surface's base plus its secondary rays, where rays of the next depth bring at most `beyond`.
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
        // The mask may cover nothing and may cover all.
        Interface::Alpha { opacity, mask: Some(_) } => {
            let opacity = f64::from(opacity).abs();
            (base * opacity + beyond * (1.0 - opacity).abs()).max(beyond)
        }
        Interface::Alpha { opacity, mask: None } => {
            let opacity = f64::from(opacity);
            base * opacity.abs() + beyond * (1.0 - opacity).abs()
        }
    }
}

fn of_environment(scene: &Scene) -> DVec3 {
    match &scene.environment {
        Environment::Constant(colour) => colour.abs().as_dvec3(),
        Environment::Gradient { nadir, horizon, zenith } => nadir.abs().max(horizon.abs()).max(zenith.abs()).as_dvec3(),
        Environment::LatLong { texture, scale, .. } | Environment::Map { texture, scale, .. } => {
            of_texture(scene, *texture) * scale.abs().as_dvec3()
        }
    }
}

/// Bounds what samples of the environment make a surface of albedo 1 reflect; `brightest` is its largest radiance.
fn of_sky_light(scene: &Scene, brightest: DVec3) -> DVec3 {
    if !scene.shining().sky {
        return DVec3::ZERO;
    }
    Around::of(scene).map_or(DVec3::ZERO, |around| brightest * around.excess() * ROUNDED_UP)
}

/// Returns the largest texel per channel. Bilinear interpolation never exceeds it.
fn of_texture(scene: &Scene, texture: u32) -> DVec3 {
    scene.textures[texture as usize].pixels.iter().fold(Vec3::ZERO, |most, texel| most.max(texel.abs())).as_dvec3()
}

/// Returns the largest emission per channel.
fn of_emission(scene: &Scene, material: &Material) -> DVec3 {
    let mean = material.emission.abs().as_dvec3();
    material.glow.as_ref().map_or(mean, |glow| mean.max(of_colour(scene, glow)))
}

fn of_colour(scene: &Scene, colour: &Colour) -> DVec3 {
    match colour {
        Colour::Constant(colour) => colour.abs().as_dvec3(),
        Colour::Image { texture, scale } => of_texture(scene, *texture) * scale.abs().as_dvec3(),
        Colour::Corners { texture, scale } => {
            let corners = scene.geometry.iter().flat_map(|g| match &g.shape {
                Shape::Mesh(mesh) => mesh.colours.as_slice(),
                Shape::Sphere(_) | Shape::Plane(_) => &[],
            });
            let most = corners.fold(Vec3::ONE, |most, c| most.max(c.abs())).as_dvec3();
            most * texture.map_or(DVec3::ONE, |t| of_texture(scene, t)) * scale.abs().as_dvec3()
        }
        Colour::Checker { even, odd, .. } => even.abs().max(odd.abs()).as_dvec3(),
    }
}

/// Bounds what a base sends back of all light but the sky's. `sampled` tells that samples of emitters light it.
fn of_base(scene: &Scene, sampled: bool, number: usize, object: &Object, material: &Material) -> Result<DVec3> {
    let mut most = of_emission(scene, material) + (material.ambient * scene.ambient).abs().as_dvec3();
    let albedo = of_colour(scene, &material.diffuse);
    let highlight = material.highlight.map_or(DVec3::ZERO, |h| h.colour.abs().as_dvec3());
    if albedo == DVec3::ZERO && highlight == DVec3::ZERO {
        return Ok(most);
    }
    if sampled {
        return Err(Unsupported::SampledLight.into());
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

/// Bounds what a light of intensity 1 with inverse-square falloff sends to any facing point of a shape.
fn most_share(light: &Light, shape: &Shape, object: &Object) -> Result<f64> {
    let nearest = match light.kind {
        LightKind::Directional { .. } => return Ok(1.0),
        LightKind::Point { position } | LightKind::Spot { position, .. } => nearest(position.as_dvec3(), shape),
        LightKind::Sphere { position, radius } => {
            // Half of the irradiance of even radiance over a half space. Points inside the lamp get nothing.
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
    let (light, object) = (light.name.clone(), object.name.clone());
    Err(Unsupported::LightTouchesSurface { light, object, place }.into())
}

/// Returns a lower bound on the distance between a shape and a parallelogram, given by its middle and half edges. The
/// bound is the distance of the middle less that of the farthest corner from the middle. Where that is coarse, the
/// parallelogram is divided into quarters, up to `levels` times.
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

/// Returns a lower bound on the distance between a point and any ray origin on a shape; rays start slightly off their
/// surfaces. The result is not above 0 where it cannot be told from 0.
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
            // Farther points are off by more, but never by more than their extra distance.
            height - OFF * (lamp.abs().element_sum() + anchor.abs().element_sum() + 2.0 * height)
        }
    }
}

/// Largest offset of a ray origin from a sphere or plane, relative to its coordinates. `geometry::Spot` has 14
/// roundings, and the point itself is off by as many again at worst.
const OFF: f64 = 2e-6;

/// Bounds the offset of ray origins on triangle `i`. The bound of `geometry::Spot` is largest at a corner.
fn most_reach(mesh: &TriMesh, i: usize) -> f64 {
    let corners = mesh.corners(i).map(crate::math::Vector3::<f32>::from);
    [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]
        .iter()
        .map(|&(u, v)| Spot::on_triangle(corners, u, v).reach)
        // A triangle without area has no finite offset, and receives no light.
        .map(|reach| if reach.is_finite() { 1.001 * f64::from(reach) } else { 0.0 })
        .fold(0.0, f64::max)
}

/// Returns the distance from `p` to the triangle (Ericson, Real-Time Collision Detection, section 5.1.5).
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
