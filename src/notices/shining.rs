//! Check for shapes that shine and light nothing.

use super::{Check, Facts, FileLocation, Find, Finding};
use crate::geometry::Shape;
use crate::scene::{LightsFrom, Rgb};

/// An emissive shape lights nothing, although matt surfaces are there and the scene does not say that it should not.
pub(super) const CHECK: Check = Check { id: "lights-nothing", find: Find::InScene(find) };

fn find(facts: &Facts) -> Vec<Finding> {
    let scene = facts.scene;
    let emits = |&o: &usize| facts.material(o).emission != Rgb::ZERO;
    let others_answer = |o: usize| (0..scene.objects.len()).any(|p| p != o && facts.material(p).answers_light());
    let shining: Vec<usize> = (0..scene.objects.len()).filter(emits).filter(|&o| others_answer(o)).collect();
    let mut findings = Vec::new();
    if !scene.admitted().emissive {
        let lamps = scene.settings.lights_from == LightsFrom::Auto;
        let bounded: Vec<usize> = shining.iter().copied().filter(|&o| scene.can_light(o)).collect();
        if let (Some(&first), true) = (bounded.first(), lamps) {
            let more = match bounded.len() - 1 {
                0 => String::new(),
                1 => String::from(" and 1 other emissive object"),
                n => format!(" and {n} other emissive objects"),
            };
            let because = match scene.lights.is_empty() {
                true => "the scene has ambient light, and `lights_from` is not given",
                false => "the scene has lamps, and `lights_from` is not given",
            };
            findings.push(Finding {
                place: FileLocation::object(scene, first),
                wrong: match bounded.len() {
                    1 => format!("{} shines and lights nothing", facts.name(first)),
                    _ => format!("{}{more} shine and light nothing", facts.name(first)),
                },
                because: because.into(),
                cure: String::from(
                    "write `lights_from = \"all\"` in [render] for their light, or \"lamps\" if they shall only be seen",
                ),
            });
        }
        return findings;
    }
    let boundless = |o: &usize| matches!(scene.geometry[*o].shape, Shape::Plane(_));
    findings.extend(shining.into_iter().filter(boundless).map(|o| Finding {
        place: FileLocation::object(scene, o),
        wrong: format!("{} shines and lights nothing", facts.name(o)),
        because: String::from("a plane has no bounds, so its light cannot be sampled"),
        cure: String::from("make it a large rectangle, or an [environment]"),
    }));
    findings
}
