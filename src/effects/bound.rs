//! The ray budget: how many rays a pixel can take at most, before any is traced.
//!
//! The rays of a camera ray are a tree. What bounds its size, level by level and in all:
//!
//! - A surface sends at most two rays (one each way, total reflection being one of them), or one, or none.
//! - Shares add up to at most 1 in each channel, and no ray goes on that weighs less than the cut-off in all of them. So at
//!   any level at most 1 / cut-off rays go on, where nothing is coloured, else three times as many; and as many, over all
//!   levels together, end at a surface that sends nothing.
//! - Where a single object sends light on and is convex, what leaves it never comes back: a level has no more rays than
//!   one surface sends.
//! - Where each surface that sends light on is a mirror or has holes, weights fall by the largest share at least, and the
//!   cut-off ends the chain.
//! - White light divides once on its way, and each wavelength then goes no further than it would. Magnitudes of weights
//!   may grow where it divides, since wavelengths have channels below 0.

use super::Reach;
use super::shell::Shell;
use crate::geometry::Shape;
use crate::optics::Spectrum;
use crate::scene::{Colour, FresnelRule, Interface, Light, Medium, MirrorSource, Rgb, Scene};

/// Surfaces that are not there which a ray may pass in a row.
const MOST_PASSES: usize = 256;

/// What rounding in `f32` may add to sums of weights, in proportion; far more than it does.
const ROUNDED_UP: f64 = 1.01;

/// An upper bound on the rays of one camera ray, and of a pixel, under the weight cut-off of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct RayBound {
    /// Levels of secondary rays that can follow a camera ray.
    pub depth: u32,
    /// Why no more.
    pub because: String,
    /// Secondary rays that one surface can send.
    pub fan: u32,
    /// Shadow rays that one surface can send.
    pub shadows: u32,
    /// Rays of all kinds a camera ray can lead to, itself included.
    pub per_sample: f64,
    /// The same a pixel.
    pub per_pixel: f64,
}

impl RayBound {
    /// The bound for a scene of which `reach` can be reached; `passing` where surfaces may lie inside other media.
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
        // A ray is shaded where it ends, unless what sends rays answers light, too.
        let both = sending.iter().any(|&o| answers_light(scene, o));
        let shaded = if both { rays } else { ends.min(rays) };
        let per_sample = rays + shaded * f64::from(shadows);
        let samples = f64::from(scene.settings.samples) * f64::from(scene.settings.samples);
        let fan = if weight.bands > 1.0 && fan > 0 { 1 + weight.bands as u32 } else { fan };
        Self { depth, because, fan, shadows, per_sample, per_pixel: per_sample * samples }
    }
}

/// How wide a tree may be.
struct Levels {
    depth: u32,
    fan: f64,
    /// Whether a level has no more rays than one surface sends.
    lone: bool,
}

impl Levels {
    /// Rays of all levels, and those of them that may end at a surface which sends nothing.
    fn count(&self, weight: &Weights) -> (f64, f64) {
        let (mut level, mut rays) = (1.0_f64, 1.0);
        let (mut white, mut divided, mut most_ends) = (1.0_f64, 0.0_f64, weight.rays(1.0));
        for _ in 0..self.depth {
            level = if self.lone { self.fan } else { level * self.fan };
            // Sums of magnitudes: what divides of white light, and what stays white.
            divided += white * weight.divided;
            white *= weight.kept;
            let heavy = weight.rays(white + divided);
            most_ends = most_ends.max(heavy);
            level = level.min(heavy);
            rays += (level * weight.bands).min(heavy);
        }
        // Of the nodes of a tree in which each has two children at most, half and one are leaves.
        let ends = if self.fan <= 1.0 {
            1.0
        } else if weight.bands > 1.0 {
            rays
        } else {
            0.5 * (rays + 1.0)
        };
        // Ends share the light of the camera ray; what divides has more of it at every level.
        (rays, if weight.bands > 1.0 { ends } else { ends.min(most_ends) })
    }
}

/// What rays may weigh.
struct Weights {
    cutoff: f64,
    /// Channels that may each make a ray heavy enough, where one that does may leave the others with nothing.
    channels: f64,
    /// Whether no surface sends on more than it gets.
    conserved: bool,
    /// Wavelengths that white light divides into; 1 where it does not.
    bands: f64,
    /// The sum of the magnitudes of their weights, over that of white; 0 where it does not divide.
    divided: f64,
    /// The most that can stay white where it divides.
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

    /// How many rays can go on that weigh so much together, in the channel that has most.
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

/// Shadow rays of one surface, at most.
fn shadow_rays(scene: &Scene, reach: &Reach, mut met: impl Iterator<Item = usize>) -> u32 {
    if !met.any(|o| answers_light(scene, o)) {
        return 0;
    }
    let casting =
        scene.lights.iter().zip(&reach.dark).filter(|(l, dark)| l.shadows && l.intensity != Rgb::ZERO && !**dark);
    // Of a lamp with an extent, its points and the corners that are asked besides.
    let points = |l: &Light| if l.kind.is_extended() { scene.settings.lamps.count + 4 } else { 1 };
    casting.map(|(l, _)| points(l)).sum()
}

/// Surfaces that are not there which a ray may pass in a row: a straight line meets a sphere twice at most, a plane and
/// each triangle once.
fn passes(scene: &Scene, met: impl Iterator<Item = usize>) -> usize {
    met.filter(|&o| matches!(interface(scene, o), Interface::Dielectric { .. }))
        .map(|o| match &scene.geometry[o].shape {
            Shape::Sphere(_) => 2,
            Shape::Plane(_) => 1,
            Shape::Mesh(mesh) => mesh.triangles.len(),
        })
        .sum::<usize>()
        .min(MOST_PASSES)
}

/// Secondary rays of one hit, at most.
fn fan(interface: &Interface) -> u32 {
    match interface {
        Interface::Opaque | Interface::Mirror { source: MirrorSource::Environment, .. } => 0,
        Interface::Mirror { .. } | Interface::Conductor { .. } | Interface::Coated { .. } | Interface::Alpha { .. } => {
            1
        }
        Interface::Dielectric { .. } | Interface::ThinDielectric { .. } => 2,
    }
}

/// The deepest chain of rays.
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

    /// One convex object alone. What leaves it outwards does not meet it again.
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

/// Whether a shape bounds a convex body or a half space. Of meshes, only those whose faces are seen as they are.
fn is_convex(shape: &Shape) -> bool {
    match shape {
        Shape::Mesh(mesh) => mesh.normal_indices.is_empty() && Shell::of(shape).is_some(),
        _ => Shell::of(shape).is_some(),
    }
}

/// Whether all camera rays start outside a closed shape.
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

/// Where each surface sends one ray at most, of a share below 1 whatever the angle: the level at which the cut-off has
/// ended it, and the largest share.
fn weakest(scene: &Scene, sending: &[usize]) -> Option<(u32, f32)> {
    let share = |&o: &usize| match interface(scene, o) {
        Interface::Mirror { reflectance, .. } => reflectance.abs().max_element(),
        Interface::Alpha { opacity } => (1.0 - opacity).abs(),
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

/// Whether an interface treats all channels alike.
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

/// Whether no surface sends more light on than it gets, in any channel.
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
        Interface::Alpha { opacity } => (0.0..=1.0).contains(opacity),
        Interface::Opaque | Interface::Conductor { .. } | Interface::Coated { .. } => true,
    })
}
