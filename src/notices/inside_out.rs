//! Check for closed dielectrics whose faces point inwards.

use super::facts::Facts;
use super::notice::{FileLocation, Finding};
use super::{Check, Find};
use crate::load::Hull;

/// Cure for a mesh that is wholly inside out.
pub const CURE: &str = "set `flip = true` in its [[mesh]], or take it away where it is set";

/// A closed dielectric mesh has negative signed volume: light leaves the medium where it should enter.
pub(super) const CHECK: Check = Check { id: "inside-out", find: Find::InScene(find) };

fn find(facts: &Facts) -> Vec<Finding> {
    let finding = |(&object, hull): (&usize, &Hull)| {
        let &Hull::InsideOut { parts, of } = hull else { return None };
        let name = facts.name(object);
        Some(Finding {
            place: FileLocation::object(facts.scene, object),
            wrong: match (parts, of) {
                (1, 1) => format!("{name} is inside out"),
                _ => format!("{parts} of the {of} separate parts of {name} are inside out"),
            },
            because: String::from("its faces point inwards, so light leaves the medium where it should enter"),
            cure: String::from(if parts == of { CURE } else { "turn the faces of these parts in the model" }),
        })
    };
    facts.report.hulls.iter().filter_map(finding).collect()
}
