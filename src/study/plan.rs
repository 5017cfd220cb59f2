//! Selection of the variants to measure.

use std::fmt;

use super::axis::{Axis, Level};
use super::front::front;
use super::systems;
use super::variant::Variant;
use crate::scene::Scene;

/// Smallest difference of an error that counts, as a share of the default's mean squared error.
const ANY_DIFFERENCE: f64 = 0.1;

/// Largest number of combinations that are measured.
const MOST: usize = 96;

/// Largest number of combinations that are predicted.
const MOST_THOUGHT_OF: usize = 200_000;

/// Measurements of a variant that differs from the default in at most one axis.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Choices.
    pub variant: Variant,
    /// Time relative to the default's.
    pub ratio: f64,
    /// True if the measurements are consistent with a ratio of 1.
    pub same_time: bool,
    /// Mean squared error.
    pub mse: f64,
}

/// Part of a study that is not measured.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Names of the axes, levels or variants.
    pub titles: Vec<String>,
    /// Reason that they share.
    pub why: String,
}

impl LeftOut {
    /// Creates an entry with one name.
    #[must_use]
    pub fn new(title: impl Into<String>, why: impl Into<String>) -> Self {
        Self { titles: vec![title.into()], why: why.into() }
    }
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.titles.join(", "), self.why)
    }
}

/// Returns the levels of each axis with the others at their defaults, and the reasons why axes or levels are left out.
#[must_use]
pub fn singles(scene: &Scene, default: &Variant, axes: &[Axis]) -> (Vec<(Axis, Vec<Variant>)>, Vec<LeftOut>) {
    let mut plan = Vec::new();
    let mut left_out = Vec::new();
    for axis in Axis::ALL.into_iter().filter(|axis| axes.contains(axis)) {
        if let Some(why) = axis.idle(scene) {
            left_out.push(LeftOut::new(axis.name(), why));
            continue;
        }
        let mut variants = Vec::new();
        for level in axis.levels().into_iter().filter(|level| *level != default.level(axis)) {
            let fit = match level {
                Level::Backend(backend) => backend.availability().map_err(|why| why.to_string()),
                Level::Reflection(reflection) => systems::reflection(scene, reflection).map(drop),
                Level::Refraction(refraction) => systems::refraction(scene, refraction).map(drop),
                _ => Ok(()),
            };
            match fit {
                Ok(()) => variants.push(default.with(level)),
                Err(why) => left_out.push(LeftOut::new(format!("{} {level}", axis.name()), why)),
            }
        }
        plan.push((axis, variants));
    }
    (plan, left_out)
}

/// Combinations to measure, and how they were selected.
#[derive(Clone, Debug, Default)]
pub struct Products {
    /// Combinations of two axes or more that may be on the front, the cheapest first.
    pub variants: Vec<Variant>,
    /// Axes with a measurable effect.
    pub mattered: Vec<Axis>,
    /// Axes without one.
    pub null: Vec<Axis>,
    /// Number of combinations of useful levels.
    pub all: usize,
    /// Number of these that others are predicted to beat in both time and error.
    pub beaten: usize,
}

/// Returns the product of the axes with a measurable effect. It uses their levels that are cheaper or more exact than
/// the default and that no other level of the axis beats. Times are predicted as products, squared errors as sums.
///
/// Some axes are left out: sampling, which is judged separately; precision, because `f64` is exact in every choice; and
/// the axes that need the single-ray walk.
#[must_use]
pub fn products(default: &Point, singles: &[Point]) -> Products {
    let mut out = Products::default();
    let mut useful: Vec<Vec<Point>> = Vec::new();
    for axis in Axis::ALL {
        let level = |p: &&Point| p.variant.level(axis) != default.variant.level(axis);
        let of_axis: Vec<Point> = singles.iter().filter(level).copied().collect();
        let differs = |p: &Point| (p.mse - default.mse).abs() > ANY_DIFFERENCE * default.mse;
        if of_axis.is_empty() {
            continue;
        }
        if of_axis.iter().any(|p| !p.same_time || differs(p)) {
            out.mattered.push(axis);
        } else {
            out.null.push(axis);
            continue;
        }
        if matches!(axis, Axis::Sampling | Axis::Precision | Axis::Triangles | Axis::Reciprocal) {
            continue;
        }
        let better = |p: &&Point| (p.ratio < 1.0 && !p.same_time) || p.mse < (1.0 - ANY_DIFFERENCE) * default.mse;
        let better: Vec<Point> = of_axis.iter().filter(better).copied().collect();
        let best = front(&better.iter().map(|p| [p.ratio, p.mse]).collect::<Vec<_>>());
        let kept: Vec<Point> = better.into_iter().zip(best).filter(|(_, best)| *best).map(|(p, _)| p).collect();
        if !kept.is_empty() {
            useful.push(kept);
        }
    }
    let mut combinations = vec![(*default, 0)];
    for levels in &useful {
        let wider = combinations.iter().flat_map(|&(base, changed)| {
            let with = levels.iter().map(move |p| (combined(&base, p, default), changed + 1));
            std::iter::once((base, changed)).chain(with)
        });
        combinations = wider.take(MOST_THOUGHT_OF).collect();
    }
    let best = front(&combinations.iter().map(|(p, _)| [p.ratio, p.mse]).collect::<Vec<_>>());
    out.all = combinations.iter().filter(|(_, changed)| *changed > 1).count();
    let mut kept: Vec<Point> = combinations
        .iter()
        .zip(best)
        .filter(|((_, changed), best)| *best && *changed > 1)
        .map(|((p, _), _)| *p)
        .collect();
    out.beaten = out.all - kept.len();
    kept.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
    // Evenly along the front if there are too many.
    let step = kept.len().div_ceil(MOST).max(1);
    out.variants = kept.into_iter().step_by(step).map(|p| p.variant).collect();
    out
}

/// Returns `base` with the level in which `single` differs from the default.
fn combined(base: &Point, single: &Point, default: &Point) -> Point {
    let variant = single.variant.apart_from(&default.variant).into_iter().fold(base.variant, Variant::with);
    // A more exact level cannot reduce the error by more than there is.
    let mse = (base.mse + single.mse - default.mse).max(base.mse.min(single.mse) * 0.25);
    Point { variant, ratio: base.ratio * single.ratio, same_time: false, mse }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Backend;
    use crate::optics::FresnelModel;
    use crate::scene::{Settings, ShadowRule};

    fn point(level: Option<Level>, ratio: f64, mse: f64) -> Point {
        let default = Variant::of(&Settings::default(), Backend::Native);
        let variant = level.map_or(default, |level| default.with(level));
        Point { variant, ratio, same_time: (ratio - 1.0).abs() < 0.01, mse }
    }

    #[test]
    fn the_product_is_of_the_levels_that_are_worth_something() {
        let default = point(None, 1.0, 1e-6);
        let singles = [
            point(Some(Level::Depth(4)), 0.5, 1e-4),
            // Beaten by depth 4 in both.
            point(Some(Level::Depth(2)), 0.6, 1e-3),
            point(Some(Level::Cutoff(0.25)), 0.7, 1e-5),
            // Neither cheaper nor more right.
            point(Some(Level::Fresnel(FresnelModel::Schlick)), 1.0, 1.0),
            // Nothing measurable at all.
            point(Some(Level::Shadows(ShadowRule::Opaque)), 1.005, 1.01e-6),
        ];
        let products = products(&default, &singles);
        assert_eq!(products.mattered, [Axis::Fresnel, Axis::Cutoff, Axis::Depth]);
        assert_eq!(products.null, [Axis::Shadows]);
        assert_eq!((products.all, products.beaten), (1, 0));
        assert_eq!(products.variants, [default.variant.with(Level::Depth(4)).with(Level::Cutoff(0.25))]);
    }
}
