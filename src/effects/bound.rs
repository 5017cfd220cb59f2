//! Upper bound on the number of rays per pixel, computed before any ray is traced.
//!
//! A camera ray and its descendants form a ray tree. These facts bound its size, level by level and in total:
//!
//! - A surface sends at most two secondary rays: one reflected, one transmitted. Under total reflection, and on other
//!   kinds of surface, it sends one or none.
//! - Shares add up to at most 1 in each channel, and a ray ends when its weight is below the cut-off in all of them. So
//!   at most 1 / cut-off rays continue at any level, or three times as many where something is coloured. Over all
//!   levels together, no more than that end at surfaces that send nothing.
//! - If a single object sends rays and is convex, rays that leave it never return. A level then has no more rays than
//!   one surface sends.
//! - If every surface that sends rays is a mirror or has holes, weights fall at least by the largest share per level,
//!   and the cut-off ends the chain.
//! - White light divides at most once along a path, and each wavelength then goes no further than the white ray would.
//!   The magnitudes of weights may grow at the division, since wavelengths have channels below 0.

use super::Reach;
use super::shell::Shell;
use crate::geometry::Shape;
use crate::optics::Spectrum;
use crate::scene::{Colour, FresnelRule, Interface, Light, MOST_PASSES, Medium, MirrorSource, Rgb, Scene};

/// Relative margin for rounding sums of weights in `f32`; far larger than the error.
const ROUNDED_UP: f64 = 1.01;

/// Upper bound on the rays of one camera ray, and of a pixel, under the weight cut-off of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct RayBound {
    /// Levels of secondary rays that can follow a camera ray.
    pub depth: u32,
    /// Reason for that number of levels.
    pub because: String,
    /// Number of secondary rays that one surface can send.
    pub fan: u32,
    /// Number of shadow rays that one surface can send.
    pub shadows: u32,
    /// Number of rays of all kinds in the tree of one camera ray, including itself.
    pub per_sample: f64,
    /// Number of rays of all kinds per pixel.
    pub per_pixel: f64,
}

impl RayBound {
    /// Computes the bound for a scene of which `reach` can be reached. `passing` says that surfaces may lie inside
    /// other media.
    #[must_use]
    pub fn of(scene: &Scene, reach: &Reach, passing: bool) -> Self {
        let met = || (0..scene.objects.len()).filter(|&o| !reach.unmet[o]);
        let sending: Vec<usize> = met().filter(|&o| fan(interface(scene, o)) > 0).collect();
        let fan = sending.iter().map(|&o| fan(interface(scene, o))).max().unwrap_or(0);
        let Chain { depth, because, lone } = Chain::of(scene, &sending);

        let levels = Levels { depth, fan: f64::from(fan), lone };
        let weight = Weights::of(scene, &sending);
        let (mut rays, ends) = levels.count(&weight);
        if passing {
            rays *= 1.0 + passes(scene, met()) as f64;
        }

        let shadows = shadow_rays(scene, reach, met());
        // Rays are shaded only where they end, unless a surface that sends rays also reflects lamp light.
        let both = sending.iter().any(|&o| answers_light(scene, o));
        let shaded = if both { rays } else { ends.min(rays) };
        let per_sample = rays + shaded * f64::from(shadows);
        let samples = f64::from(scene.settings.samples) * f64::from(scene.settings.samples);
        let fan = if weight.bands > 1.0 && fan > 0 { 1 + weight.bands as u32 } else { fan };
        Self { depth, because, fan, shadows, per_sample, per_pixel: per_sample * samples }
    }
}

/// Limits on the width of a ray tree.
struct Levels {
    depth: u32,
    fan: f64,
    /// True if a level has no more rays than one surface sends.
    lone: bool,
}

impl Levels {
    /// Returns the number of rays of all levels, and how many of them may end at a surface that sends nothing.
    fn count(&self, weight: &Weights) -> (f64, f64) {
        let (mut level, mut rays) = (1.0_f64, 1.0);
        let (mut white, mut divided, mut most_ends) = (1.0_f64, 0.0_f64, weight.rays(1.0));
        for _ in 0..self.depth {
            level = if self.lone { self.fan } else { level * self.fan };
            // Sums of magnitudes: of the wavelengths that white light divides into, and of light that stays white.
            divided += white * weight.divided;
            white *= weight.kept;
            let heavy = weight.rays(white + divided);
            most_ends = most_ends.max(heavy);
            level = level.min(heavy);
            rays += (level * weight.bands).min(heavy);
        }
        // In a tree whose nodes have at most two children, half of the nodes plus one half are leaves.
        let ends = if self.fan <= 1.0 {
            1.0
        } else if weight.bands > 1.0 {
            rays
        } else {
            0.5 * (rays + 1.0)
        };
        // Ends share the weight of the camera ray; light that divides gains weight at every level.
        (rays, if weight.bands > 1.0 { ends } else { ends.min(most_ends) })
    }
}

/// Limits on the weights of rays.
struct Weights {
    cutoff: f64,
    /// Number of channels that can keep a ray above the cut-off while the others carry nothing.
    channels: f64,
    /// True if no surface sends more light than it receives.
    conserved: bool,
    /// Number of wavelengths that white light divides into; 1 if it never divides.
    bands: f64,
    /// Sum of the magnitudes of the wavelengths' weights, relative to white; 0 if white light never divides.
    divided: f64,
    /// Largest share that can stay white where light divides.
    kept: f64,
}

impl Weights {
    fn of(scene: &Scene, sending: &[usize]) -> Self {
        let settings = &scene.settings;
        let grey = sending.iter().all(|&o| is_grey(interface(scene, o)))
            && scene.media.iter().all(|m| m.absorption == Rgb::ZERO);
        let mut weights = Self {
            cutoff: f64::from(settings.cutoff),
            channels: if grey { 1.0 } else { 3.0 },
            conserved: conserves(scene, sending),
            bands: 1.0,
            divided: 0.0,
            kept: 1.0,
        };
        if scene.media.iter().any(Medium::disperses) {
            weights.channels = 3.0;
            for set in Spectrum::new(settings.wavelengths, settings.samples).sets() {
                weights.bands = weights.bands.max(set.nm.len() as f64);
                for channel in 0..3 {
                    let of = |f: fn(f32) -> f32| set.weight.iter().map(|w| f64::from(f(w[channel]))).sum::<f64>();
                    weights.divided = weights.divided.max(of(f32::abs));
                    weights.kept = weights.kept.max(of(|w| w.max(0.0)));
                }
            }
        }
        weights
    }

    /// Returns how many rays can continue whose weights sum to `together` in the channel with the largest sum.
    fn rays(&self, together: f64) -> f64 {
        if self.conserved && self.cutoff > 0.0 {
            (ROUNDED_UP * self.channels * together / self.cutoff).max(1.0)
        } else {
            f64::INFINITY
        }
    }
}

fn interface(scene: &Scene, object: usize) -> &Interface {
    &scene.materials[scene.objects[object].material as usize].interface
}

fn answers_light(scene: &Scene, object: usize) -> bool {
    let material = &scene.materials[scene.objects[object].material as usize];
    material.diffuse != Colour::Constant(Rgb::ZERO) || material.highlight.is_some()
}

/// Returns the largest number of shadow rays of one surface.
fn shadow_rays(scene: &Scene, reach: &Reach, mut met: impl Iterator<Item = usize>) -> u32 {
    if !met.any(|o| answers_light(scene, o)) {
        return 0;
    }
    let casting = scene
        .lights
        .iter()
        .zip(&reach.dark)
        .filter(|(l, dark)| l.shadows && l.intensity != Rgb::ZERO && !**dark && !scene.is_sampled(l));
    // An area lamp has its sample points, and four corners for the shaft.
    let points = |l: &Light| if l.kind.is_extended() { scene.settings.lamps.count + 4 } else { 1 };
    let shining = scene.shining();
    let kinds = u32::from(shining.emitters()) + u32::from(shining.sky);
    let beside = if scene.settings.shine_shadows { kinds * scene.settings.lamps.count } else { 0 };
    beside + casting.map(|(l, _)| points(l)).sum::<u32>()
}

/// Returns the largest number of consecutive surfaces that a ray may pass. A straight line crosses a sphere at most
/// twice, and a plane and each triangle once.
fn passes(scene: &Scene, met: impl Iterator<Item = usize>) -> usize {
    met.filter(|&o| matches!(interface(scene, o), Interface::Dielectric { .. }))
        .map(|o| match &scene.geometry[o].shape {
            Shape::Sphere(_) => 2,
            Shape::Plane(_) => 1,
            Shape::Mesh(mesh) => mesh.triangles.len(),
        })
        .sum::<usize>()
        .min(MOST_PASSES as usize)
}

/// Returns the largest number of secondary rays of one hit.
fn fan(interface: &Interface) -> u32 {
    match interface {
        Interface::Opaque | Interface::Mirror { source: MirrorSource::Environment, .. } => 0,
        Interface::Mirror { .. } | Interface::Conductor { .. } | Interface::Coated { .. } | Interface::Alpha { .. } => {
            1
        }
        Interface::Dielectric { .. } | Interface::ThinDielectric { .. } => 2,
    }
}

/// Deepest chain of rays.
struct Chain {
    depth: u32,
    because: String,
    lone: bool,
}

impl Chain {
    fn of(scene: &Scene, sending: &[usize]) -> Self {
        let limit = scene.settings.max_depth;
        let name = |o: usize| &scene.objects[o].name;
        match *sending {
            [] => Self { depth: 0, because: String::from("no surface sends light on"), lone: false },
            [only] if is_convex(&scene.geometry[only].shape) => Self::of_convex(scene, only),
            [first, ..] => {
                let who = match sending.len() - 1 {
                    0 => format!("`{}`", name(first)),
                    others => format!("`{}` and {others} more", name(first)),
                };
                match weakest(scene, sending).filter(|&(depth, _)| depth < limit) {
                    Some((depth, share)) => {
                        let because = format!("weight cut-off; {who} may send light round and round, {share} of it");
                        Self { depth, because, lone: false }
                    }
                    None => {
                        let because = format!("depth limit; {who} may send light round and round");
                        Self { depth: limit, because, lone: false }
                    }
                }
            }
        }
    }

    /// Returns the chain of a single convex object. Rays that leave it outwards do not hit it again.
    fn of_convex(scene: &Scene, only: usize) -> Self {
        let (limit, name) = (scene.settings.max_depth, &scene.objects[only].name);
        let (shape, interface) = (&scene.geometry[only].shape, interface(scene, only));
        let is_plane = matches!(shape, Shape::Plane(_));
        let reflects =
            matches!(interface, Interface::Mirror { .. } | Interface::Conductor { .. } | Interface::Coated { .. });
        let chain = |most: u32, why: &str| Self {
            depth: most.min(limit),
            because: if most < limit {
                format!("`{name}` alone sends light on, and {why}")
            } else {
                format!("depth limit; `{name}` alone sends light on")
            },
            lone: true,
        };
        match interface {
            _ if is_plane => chain(1, "a plane is met by nothing that leaves it"),
            _ if reflects && seen_from_outside(scene, shape) => {
                chain(1, &format!("a {} seen from outside reflects nothing onto itself", kind(shape)))
            }
            Interface::Alpha { .. } if matches!(shape, Shape::Sphere(_)) => chain(2, "a line meets a sphere twice"),
            _ => Self {
                depth: limit,
                because: format!("depth limit; light may go round and round in `{name}`, but what leaves it is gone"),
                lone: true,
            },
        }
    }
}

/// Returns true if a shape bounds a convex body or a half space. Meshes with interpolated normals do not count.
fn is_convex(shape: &Shape) -> bool {
    match shape {
        Shape::Mesh(mesh) => mesh.normal_indices.is_empty() && Shell::of(shape).is_some(),
        _ => Shell::of(shape).is_some(),
    }
}

/// Returns true if all camera rays start outside a closed shape.
fn seen_from_outside(scene: &Scene, shape: &Shape) -> bool {
    Shell::of(shape).is_some_and(|shell| super::reach::is_seen_from_outside(scene, &shell))
}

fn kind(shape: &Shape) -> &'static str {
    match shape {
        Shape::Plane(_) => "plane",
        Shape::Sphere(_) => "sphere",
        Shape::Mesh(_) => "convex mesh",
    }
}

/// Returns the level at which the cut-off has ended the chain, and the largest share. Requires that each surface sends
/// at most one ray, with a share below 1 at any angle; otherwise returns `None`.
fn weakest(scene: &Scene, sending: &[usize]) -> Option<(u32, f32)> {
    let share = |&o: &usize| match interface(scene, o) {
        Interface::Mirror { reflectance, .. } => reflectance.abs().max_element(),
        Interface::Alpha { opacity, mask: None } => (1.0 - opacity).abs(),
        _ => f32::INFINITY,
    };
    let most = sending.iter().map(share).fold(0.0, f32::max);
    let (cutoff, step) = (f64::from(scene.settings.cutoff), f64::from(most) * (1.0 + 1e-6));
    if !(step < 1.0 && cutoff > 0.0) {
        return None;
    }
    let mut weight = step;
    for depth in 0..scene.settings.max_depth {
        if weight < cutoff {
            return Some((depth, most));
        }
        weight *= step;
    }
    None
}

/// Returns true if an interface treats all channels alike.
fn is_grey(interface: &Interface) -> bool {
    let grey = |c: Rgb| c.x == c.y && c.y == c.z;
    match interface {
        Interface::Opaque | Interface::Coated { .. } | Interface::Alpha { .. } => true,
        Interface::Mirror { reflectance, .. } => grey(*reflectance),
        Interface::Conductor { eta, k } => grey(*eta) && grey(*k),
        Interface::Dielectric { rule, tint, .. } | Interface::ThinDielectric { rule, tint, .. } => {
            grey(*tint) && if let FresnelRule::Fixed(share) = rule { grey(*share) } else { true }
        }
    }
}

/// Returns true if no surface sends more light than it receives, in any channel.
fn conserves(scene: &Scene, sending: &[usize]) -> bool {
    let within = |c: Rgb| c.cmpge(Rgb::ZERO).all() && c.cmple(Rgb::ONE).all();
    let share = |rule: &FresnelRule| match rule {
        FresnelRule::Fresnel => true,
        FresnelRule::Fixed(share) => within(*share),
    };
    sending.iter().all(|&o| match interface(scene, o) {
        Interface::Mirror { reflectance, .. } => within(*reflectance),
        Interface::Dielectric { rule, tint, .. } | Interface::ThinDielectric { rule, tint, .. } => {
            within(*tint) && share(rule)
        }
        Interface::Alpha { opacity, .. } => (0.0..=1.0).contains(opacity),
        Interface::Opaque | Interface::Conductor { .. } | Interface::Coated { .. } => true,
    })
}
