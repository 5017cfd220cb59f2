//! Check for materials of the scene file that no shape uses.

use super::facts::Facts;
use super::notice::{FileLocation, Finding};
use super::{Check, Find};

/// A `[[material]]` is not used by any `[[mesh]]`.
pub(super) const CHECK: Check = Check { id: "unused-material", find: Find::InScene(find) };

fn find(facts: &Facts) -> Vec<Finding> {
    let finding = |(name, line): &(String, u32)| Finding {
        place: FileLocation { line: *line, ..FileLocation::file(facts.file) },
        wrong: format!("the [[material]] `{name}` is not used"),
        because: String::from("no [[mesh]] names it"),
        cure: format!("write `material = \"{name}\"` in a [[mesh]], or remove it"),
    };
    facts.report.unused_materials.iter().map(finding).collect()
}
