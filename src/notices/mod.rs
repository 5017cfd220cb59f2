//! Warnings about a scene and a picture of it: one list of checks, worded once, for every command that reports them.
//!
//! A check finds one kind of fault. To add one: write a file beside this one that holds a [`Check`], name it in [`CHECKS`],
//! and add its row to the table of warnings in `scenes/README.md` (a test compares the two).

mod decal;
mod dropped;
mod facts;
mod inside;
mod inside_out;
mod low_poly;
mod near;
mod nothing_seen;
mod notice;
mod survey;
mod truncated;
mod unlit;
mod unused;
mod view;

pub use facts::Facts;
pub use inside_out::CURE as INSIDE_OUT_CURE;
pub use notice::{Finding, Notice, Place};
pub use survey::survey;

use crate::render::Outcome;

/// A search for one kind of fault.
#[derive(Clone, Copy, Debug)]
pub struct Check {
    /// Name of the kind in JSON and in the documentation.
    pub id: &'static str,
    /// The search itself.
    pub find: Find,
}

/// The input of a [`Check`].
#[derive(Clone, Copy, Debug)]
pub enum Find {
    /// The scene alone: made before the first ray. Costs little beside building a hierarchy.
    InScene(fn(&Facts) -> Vec<Finding>),
    /// A finished picture of it. Costs nothing noticeable where there is nothing to find.
    InPicture(fn(&Facts, &Outcome) -> Vec<Finding>),
}

/// All checks, in the order in which their findings are reported.
pub const CHECKS: &[Check] = &[
    unused::CHECK,
    dropped::CHECK,
    decal::CHECK,
    near::CHECK,
    inside_out::CHECK,
    nothing_seen::CHECK,
    inside::CHECK,
    unlit::CHECK,
    low_poly::CHECK,
    truncated::CHECK,
];

/// Findings of the checks that need no picture.
#[must_use]
pub fn of_scene(facts: &Facts) -> Vec<Notice> {
    collect(|find| if let Find::InScene(find) = find { find(facts) } else { Vec::new() })
}

/// Findings of the checks that look at a picture. None where effects were left out on request: such a picture is meant to
/// lack something.
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
