//! Warnings about a scene and its picture: one list of checks, with one wording for all commands.
//!
//! A check finds one kind of fault. To add one, write a file beside this one that contains a [`Check`], add it to
//! [`CHECKS`], and add its row to the table of warnings in `scenes/README.md` (a test compares the two).

mod decal;
mod dropped;
mod facts;
mod inside;
mod inside_out;
mod low_poly;
mod near;
mod nothing_seen;
mod notice;
mod shining;
mod survey;
mod truncated;
mod unlit;
mod unused;
mod view;

pub use facts::Facts;
pub use inside_out::CURE as INSIDE_OUT_CURE;
pub use notice::{FileLocation, Finding, Notice};
pub use survey::survey;

use crate::render::Outcome;

/// Check for one kind of fault.
#[derive(Clone, Copy, Debug)]
pub struct Check {
    /// Identifier of the kind in JSON and in the documentation.
    pub id: &'static str,
    /// Function that searches for the fault.
    pub find: Find,
}

/// Search function of a [`Check`], by its input.
#[derive(Clone, Copy, Debug)]
pub enum Find {
    /// Examines the scene alone, before the first ray. Costs little compared with building a hierarchy.
    InScene(fn(&Facts) -> Vec<Finding>),
    /// Examines a finished picture of the scene. Costs almost nothing if there is no fault.
    InPicture(fn(&Facts, &Outcome) -> Vec<Finding>),
}

/// All checks, in the order of their findings in reports.
pub const CHECKS: &[Check] = &[
    unused::CHECK,
    dropped::CHECK,
    decal::CHECK,
    near::CHECK,
    shining::CHECK,
    inside_out::CHECK,
    nothing_seen::CHECK,
    inside::CHECK,
    unlit::CHECK,
    low_poly::CHECK,
    truncated::CHECK,
];

/// Returns the findings of the checks that need no picture.
#[must_use]
pub fn of_scene(facts: &Facts) -> Vec<Notice> {
    collect(|find| if let Find::InScene(find) = find { find(facts) } else { Vec::new() })
}

/// Returns the findings of the checks on a picture. Returns none if effects were left out on request, since such a
/// picture lacks something on purpose.
#[must_use]
pub fn of_picture(facts: &Facts, picture: &Outcome) -> Vec<Notice> {
    if !facts.options.effects.without.is_empty() {
        return Vec::new();
    }
    collect(|find| if let Find::InPicture(find) = find { find(facts, picture) } else { Vec::new() })
}

fn collect(mut findings: impl FnMut(Find) -> Vec<Finding>) -> Vec<Notice> {
    let notices = |&Check { id, find }: &Check| findings(find).into_iter().map(move |finding| Notice { id, finding });
    CHECKS.iter().flat_map(notices).collect()
}
