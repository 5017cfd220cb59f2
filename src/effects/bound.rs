//! The ray budget: how many rays a pixel can take at most, before any is traced.

use super::Reach;
use crate::geometry::Shape;
use crate::scene::{Interface, Light, Medium, MirrorSource, Rgb, Scene};

/// Surfaces that are not there which a ray may pass in a row.
const MOST_PASSES: f64 = 256.0;

/// An upper bound on the rays of one camera ray, and of a pixel.
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
        let settings = &scene.settings;
        let sending: Vec<usize> =
            (0..scene.objects.len()).filter(|&o| !reach.sealed[o] && fan(interface(scene, o)) > 0).collect();
        let fan = sending.iter().map(|&o| fan(interface(scene, o))).max().unwrap_or(0);
        let (depth, because) = chain(scene, &sending);
        let answering = (0..scene.objects.len()).any(|o| {
            let material = &scene.materials[scene.objects[o].material as usize];
            !reach.sealed[o]
                && (material.diffuse != crate::scene::Colour::Constant(Rgb::ZERO) || material.highlight.is_some())
        });
        let casting = scene.lights.iter().filter(|l| l.shadows && l.intensity != Rgb::ZERO);
        // Of a lamp with an extent, its points and the corners that are asked besides.
        let points = |l: &Light| if l.kind.is_extended() { settings.lamps.count + 4 } else { 1 };
        let shadows = if answering { casting.map(points).sum() } else { 0 };
        let dispersing = scene.media.iter().any(Medium::disperses);
        // Shares add up to at most 1, so that at any level at most 1 / cutoff rays weigh enough to go on (thrice as
        // many where the channels of fixed shares differ); what rounding adds is far below a hundredth.
        let weighty = if settings.cutoff > 0.0 && conserves(scene, &sending) && !dispersing {
            3.03 / f64::from(settings.cutoff)
        } else {
            f64::INFINITY
        };
        let mut level = 1.0_f64;
        let mut rays = 1.0_f64;
        for _ in 0..depth {
            level = (level * f64::from(fan)).min(weighty);
            rays += level;
        }
        if dispersing {
            // White light divides once on its way; each wavelength then goes no further than it would.
            rays *= f64::from(settings.wavelengths.max(7));
        }
        if passing {
            rays *= 1.0 + MOST_PASSES;
        }
        let per_sample = rays * (1.0 + f64::from(shadows));
        let samples = f64::from(settings.samples) * f64::from(settings.samples);
        Self { depth, because, fan, shadows, per_sample, per_pixel: per_sample * samples }
    }
}

fn interface(scene: &Scene, object: usize) -> &Interface {
    &scene.materials[scene.objects[object].material as usize].interface
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
fn chain(scene: &Scene, sending: &[usize]) -> (u32, String) {
    let most = scene.settings.max_depth;
    let name = |o: usize| &scene.objects[o].name;
    match *sending {
        [] => (0, String::from("no surface sends light on")),
        [only] if is_convex_reflector(scene, only) && most >= 1 => (
            1,
            format!("`{}` alone sends light on, and a {} reflects nothing onto itself", name(only), kind(scene, only)),
        ),
        [first, ..] => {
            let others = sending.len() - 1;
            let who =
                if others == 0 { format!("`{}`", name(first)) } else { format!("`{}` and {others} more", name(first)) };
            (most, format!("depth limit; {who} may send light round and round"))
        }
    }
}

/// Whether light that leaves an object by reflection cannot come back to it by itself: met from outside, a sphere; met
/// from anywhere, a plane.
fn is_convex_reflector(scene: &Scene, object: usize) -> bool {
    let reflects = matches!(
        interface(scene, object),
        Interface::Mirror { .. } | Interface::Conductor { .. } | Interface::Coated { .. }
    );
    reflects
        && match &scene.geometry[object].shape {
            Shape::Plane(_) => true,
            // Camera rays may start inside, where they would go round and round.
            Shape::Sphere(sphere) => {
                let way = scene.camera.eye.as_dvec3() - sphere.centre.as_dvec3();
                matches!(scene.camera.projection, crate::scene::Projection::Pinhole { .. })
                    && way.length() > 1.001 * f64::from(sphere.radius)
            }
            Shape::Mesh(_) => false,
        }
}

fn kind(scene: &Scene, object: usize) -> &'static str {
    match scene.geometry[object].shape {
        Shape::Plane(_) => "plane",
        Shape::Sphere(_) => "sphere seen from outside",
        Shape::Mesh(_) => "mesh",
    }
}

/// Whether no surface sends more light on than it gets, in any channel.
fn conserves(scene: &Scene, sending: &[usize]) -> bool {
    let within = |c: Rgb| c.cmpge(Rgb::ZERO).all() && c.cmple(Rgb::ONE).all();
    let share = |rule: &crate::scene::FresnelRule| match rule {
        crate::scene::FresnelRule::Fresnel => true,
        crate::scene::FresnelRule::Fixed(share) => within(*share),
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
