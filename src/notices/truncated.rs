//! Check for pictures that lack visible light because rays ended at a limit.

use super::facts::Facts;
use super::notice::{FileLocation, Finding};
use super::{Check, Find};
use crate::render::{Cure, Limit, Outcome, Shortfall};
use crate::scene::MOST_PASSES;

/// More than a thousandth of the pixels lack visible light.
pub(super) const CHECK: Check = Check { id: "truncated-light", find: Find::InPicture(find) };

fn find(facts: &Facts, picture: &Outcome) -> Vec<Finding> {
    picture.shortfall.iter().map(|shortfall| finding(facts, shortfall)).collect()
}

fn finding(facts: &Facts, shortfall: &Shortfall) -> Finding {
    let settings = &facts.scene.settings;
    let Shortfall { pixels, of, worst: [x, y], lacks, limit, .. } = shortfall;
    let because = match limit {
        Limit::Depth => format!("rays end after {} reflections and refractions", settings.max_depth),
        Limit::Cutoff => format!("rays of a weight below {} end", settings.cutoff),
        Limit::Passes => format!("rays end after {MOST_PASSES} surfaces in a row that lie inside other media"),
        Limit::Asked => String::from("rays end at limits that the command line sets"),
    };
    Finding {
        place: FileLocation::file(facts.file),
        wrong: format!(
            "about {pixels} of {of} pixels lack more than 1/255 of their light, pixel ({x}, {y}) lacks {} of white",
            share(*lacks)
        ),
        because,
        cure: cure(facts, shortfall),
    }
}

fn cure(facts: &Facts, shortfall: &Shortfall) -> String {
    let limits = |cure: &Cure| {
        let (own, mut options) = (&facts.scene.settings, Vec::new());
        if cure.depth != own.max_depth {
            options.push(format!("--depth {}", cure.depth));
        }
        if cure.cutoff != own.cutoff {
            options.push(format!("--cutoff {}", cure.cutoff));
        }
        options.join(" ")
    };
    match (shortfall.limit, &shortfall.cure, &shortfall.tried) {
        (Limit::Passes, ..) => String::from("make fewer solids overlap there"),
        (_, Some(cure), _) => {
            format!("render with {}, which takes about {:.1} times as many rays", limits(cure), cure.cost)
        }
        (_, None, Some(tried)) => format!(
            "even {} leaves some of it out, with about {:.1} times as many rays; put fewer surfaces in a row",
            limits(tried),
            tried.cost
        ),
        (_, None, None) => String::from(
            "wider limits take too many rays to be tried; try a larger --depth or a smaller --cutoff on a small picture",
        ),
    }
}

/// Formats a share of light, at most all of it.
fn share(lacks: f64) -> String {
    if lacks >= 1.0 { String::from("all") } else { format!("{lacks:.3}") }
}
