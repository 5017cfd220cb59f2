//! Check for pictures that show nothing but the environment.

use glam::Vec3;

use super::facts::Facts;
use super::notice::{FileLocation, Finding};
use super::view::{Extent, View};
use super::{Check, Find};
use crate::geometry::{Aabb, Shape};
use crate::render::Outcome;
use crate::scene::{Dispersion, FresnelRule, Interface, Material, Rgb};

/// No camera ray, and no ray of its tree, hits a visible object.
pub(super) const CHECK: Check = Check { id: "nothing-seen", find: Find::InPicture(find) };

fn find(facts: &Facts, picture: &Outcome) -> Vec<Finding> {
    let met: Vec<usize> = (0..picture.seen.objects.len()).filter(|&o| picture.seen.objects[o]).collect();
    if facts.scene.objects.is_empty() || met.iter().any(|&o| is_visible(facts, o)) {
        return Vec::new();
    }
    let (place, because, cure) = match met.first() {
        Some(&object) => invisible(facts, object),
        None => unmet(facts),
    };
    let wrong = String::from("the picture shows nothing but the environment");
    vec![Finding { place, wrong, because, cure }]
}

/// Returns true if an object changes the light that hits it.
pub(super) fn is_visible(facts: &Facts, object: usize) -> bool {
    let material = facts.material(object);
    let clear = |ior: f64, rule: FresnelRule, tint: Rgb| {
        ior == facts.scene.media[0].ior
            && matches!(rule, FresnelRule::Fresnel | FresnelRule::Fixed(Rgb::ZERO))
            && tint == Rgb::ONE
    };
    match material.interface {
        Interface::Alpha { opacity, .. } => opacity > 0.0,
        Interface::ThinDielectric { ior, rule, tint } => has_base(material) || !clear(f64::from(ior), rule, tint),
        Interface::Dielectric { medium, rule, tint } => {
            let medium = &facts.scene.media[medium as usize];
            let even = medium.dispersion == Dispersion::None && medium.absorption == facts.scene.media[0].absorption;
            has_base(material) || !even || !clear(medium.ior, rule, tint)
        }
        Interface::Opaque | Interface::Mirror { .. } | Interface::Conductor { .. } | Interface::Coated { .. } => true,
    }
}

fn has_base(material: &Material) -> bool {
    material.answers_light() || material.emission != Rgb::ZERO || material.ambient != Rgb::ZERO
}

/// Returns place, reason and cure if rays hit only invisible objects.
fn invisible(facts: &Facts, object: usize) -> (FileLocation, String, String) {
    let material = facts.material(object);
    let (what, cure) = match material.interface {
        Interface::Alpha { .. } => (
            "has opacity 0 (`opacity = 0`; in an MTL file `d 0` or `Tr 1`)",
            "give the material an opacity above 0 (an opaque one is `d 1`, which is `Tr 0`)",
        ),
        _ => ("has the refractive index of what surrounds it, and no colour", "give the material another index"),
    };
    let because = format!("the material `{}` of {} {what}", material.name, facts.name(object));
    (FileLocation::object(facts.scene, object), because, String::from(cure))
}

/// Returns place, reason and cure if no ray hits anything.
fn unmet(facts: &Facts) -> (FileLocation, String, String) {
    let place = FileLocation::file(facts.file);
    let scene = facts.scene;
    let bounds = (0..scene.objects.len()).fold(Aabb::EMPTY, |bounds, o| bounds.union(facts.bounds(o)));
    let plane = scene.geometry.iter().find_map(|g| match &g.shape {
        Shape::Plane(plane) if plane.is_usable() => Some(plane.point),
        _ => None,
    });
    let target = match (bounds.is_empty(), plane) {
        (false, _) => bounds.centre(),
        (true, Some(point)) => point,
        (true, None) => {
            let because = String::from("no shape in it can be hit (each has no area, or is not finite)");
            return (place, because, String::from("mend the shapes, or export the model again"));
        }
    };
    let camera = &scene.camera;
    let aim = || format!("aim it there: `target = {}` in [camera]", triple(target));
    let extent = if bounds.is_empty() { Extent::Behind } else { View::of(scene).extent(&bounds) };
    let (because, cure) = match extent {
        Extent::Behind => (format!("the camera at {} looks away from everything", triple(camera.eye)), aim()),
        Extent::Beside => (format!("the camera at {} looks past everything", triple(camera.eye)), aim()),
        Extent::Pixels(pixels) if pixels < 1.0 => (
            format!("all of the scene together is {pixels:.1e} pixels wide"),
            String::from("move the camera nearer, or make its angle (`fov`) or `height` smaller"),
        ),
        Extent::Pixels(_) => (
            String::from("every camera ray passes beside the shapes, or between them"),
            String::from("aim the camera at one of them (`target` in [camera]), or take more `samples` a pixel"),
        ),
    };
    (place, because, cure)
}

/// Formats a point as in TOML.
fn triple(p: Vec3) -> String {
    format!("[{}, {}, {}]", p.x, p.y, p.z)
}
