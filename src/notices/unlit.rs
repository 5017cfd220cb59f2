//! Check for pictures of matt surfaces that no light reaches.

use std::collections::BTreeMap;

use super::facts::Facts;
use super::inside::{dark_body, glows};
use super::nothing_seen::is_visible;
use super::notice::{FileLocation, Finding};
use super::{Check, Find};
use crate::render::Outcome;
use crate::render::record::Source;
use crate::render::reference::Prepared;
use crate::scene::{Colour, Rgb, ShadowRule};

/// Matt surfaces are visible, and no light reaches any of them.
pub(super) const CHECK: Check = Check { id: "unlit", find: Find::InPicture(find) };

/// Number of pixels along each side of the picture whose rays are traced to find occluders.
const PROBED: u32 = 12;

fn find(facts: &Facts, picture: &Outcome) -> Vec<Finding> {
    let seen = &picture.seen;
    let matt: Vec<usize> = (0..seen.objects.len()).filter(|&o| seen.objects[o] && is_matt(facts, o)).collect();
    let Some(&first) = matt.first() else { return Vec::new() };
    if seen.lit || dark_body(facts, picture).is_some() {
        return Vec::new();
    }
    let others = match matt.len() - 1 {
        0 => String::new(),
        1 => String::from(" and 1 other matt object in view"),
        more => format!(" and {more} other matt objects in view"),
    };
    let (because, cure) = reason(facts);
    let wrong = format!("no light reaches {}{others}", facts.name(first));
    vec![Finding { place: FileLocation::object(facts.scene, first), wrong, because, cure }]
}

/// Returns true if an object is visible, dark without lamps, and reflects lamp light.
fn is_matt(facts: &Facts, object: usize) -> bool {
    let coloured = facts.material(object).diffuse != Colour::Constant(Rgb::ZERO);
    coloured && is_visible(facts, object) && !glows(facts, object)
}

fn reason(facts: &Facts) -> (String, String) {
    let lights = &facts.scene.lights;
    if facts.scene.shining().any() {
        return (
            String::from("what shines does not reach what is seen: it is shut off, below the horizon, or on far sides"),
            String::from("move or open what is in the way, or add a [[light]] that reaches what is seen"),
        );
    }
    if lights.is_empty() {
        let because = match facts.scene.has_shiners() {
            true => "the scene has no [[light]], and `lights_from` does not admit what else shines",
            false => {
                "the scene has no [[light]], nothing in it that can light others shines, and its environment is black"
            }
        };
        let cure = match facts.scene.has_shiners() {
            true => "write `lights_from = \"all\"` in [render], or add a [[light]]",
            false => "add a [[light]], a bounded shape with `emission`, an [environment], or `ambient` light",
        };
        return (because.into(), cure.into());
    }
    if lights.iter().all(|light| light.intensity == Rgb::ZERO) {
        return (String::from("every [[light]] has the intensity 0"), String::from("give one a higher `intensity`"));
    }
    let Some((blocker, light)) = blocker(facts) else {
        return (
            String::from("every [[light]] shines on far sides, or past what is seen"),
            String::from("move a [[light]] to the side that the camera sees, or aim it there"),
        );
    };
    let transparent = facts.material(blocker).is_transmissive();
    let because = format!("{} is in the way of the light `{}`", facts.name(blocker), lights[light].name);
    let cure = if transparent && facts.scene.settings.shadows == ShadowRule::Opaque {
        String::from("let light through it with `shadows = \"straight\"` in [render]")
    } else {
        String::from("move one of them, or write `shadows = false` in the [[light]]")
    };
    (because, cure)
}

/// Returns the object that blocks most light on its way to visible surfaces, and the light.
fn blocker(facts: &Facts) -> Option<(usize, usize)> {
    let prepared = Prepared::with(facts.scene, facts.options);
    let (width, height) = (facts.scene.settings.width, facts.scene.settings.height);
    let mut blocked: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let grid = |extent: u32| (0..PROBED.min(extent)).map(move |i| (2 * i + 1) * extent / (2 * PROBED.min(extent)));
    for (x, y) in grid(height).flat_map(|y| grid(width).map(move |x| (x, y))) {
        for share in prepared.recorded_at(f64::from(x) + 0.5, f64::from(y) + 0.5).shares() {
            if let (Source::Light(light), Some(object)) = (share.source, share.blocker) {
                *blocked.entry((object as usize, light as usize)).or_default() += 1;
            }
        }
    }
    blocked.into_iter().max_by_key(|&(_, count)| count).map(|(pair, _)| pair)
}
