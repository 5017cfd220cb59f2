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
    if !scene.admitted().emissive {
        let bounded: Vec<usize> = shining.into_iter().filter(|&o| scene.can_light(o)).collect();
        let Some(&first) = bounded.first().filter(|_| scene.settings.lights_from == LightsFrom::Auto) else {
            return Vec::new();
        };
        let name = facts.name(first);
        let because = match scene.lights.is_empty() {
            true => "the scene has ambient light, and `lights_from` is not given",
            false => "the scene has lamps, and `lights_from` is not given",
        };
        return vec![Finding {
            place: FileLocation::object(scene, first),
            wrong: match bounded.len() - 1 {
                0 => format!("{name} shines and lights nothing"),
                1 => format!("{name} and 1 other emissive object shine and light nothing"),
                n => format!("{name} and {n} other emissive objects shine and light nothing"),
            },
            because: because.into(),
            cure: String::from(
                "write `lights_from = \"all\"` in [render] for their light, or \"lamps\" if they shall only be seen",
            ),
        }];
    }
    let boundless = |o: &usize| matches!(scene.geometry[*o].shape, Shape::Plane(_));
    let lightless = shining.into_iter().filter(boundless).map(|o| Finding {
        place: FileLocation::object(scene, o),
        wrong: format!("{} shines and lights nothing", facts.name(o)),
        because: String::from("a plane has no bounds, so its light cannot be sampled"),
        cure: String::from("make it a large rectangle, or an [environment]"),
    });
    lightless.collect()
}
