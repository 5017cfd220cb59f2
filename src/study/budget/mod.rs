//! Choice of settings for a budget: the fastest within a given error, or the most exact within a given time.
//!
//! A small picture of the scene is rendered with every level of every free choice, while the others are exact. To
//! predict combinations, errors of levels are added and times multiplied. The most promising combinations are rendered
//! and measured, and the best one within the budget is chosen. Afterwards ([`check`]) a sample of the final picture's
//! pixels is checked against `f64`. If that fails, the next more exact combination is used.

mod candidate;
pub mod check;
mod quick;

use std::time::Duration;

use serde::Serialize;

use super::axis::{Axis, Level, Precision};
use super::plan;
use super::reference;
use super::variant::Variant;
use crate::error::{Result, Unsupported};
use crate::optics::FresnelModel;
use crate::render::{Observer, Reflection};
use crate::scene::Scene;
pub use candidate::Candidate;
use quick::{Judged, Quick};

/// Share of the allowed error that the small picture may use, since it has fewer pixels that could be wrong.
const MARGIN: f64 = 0.5;

/// Share of the allowed time that the prediction from the slowest run may use.
const OF_THE_TIME: f64 = 0.85;

/// Largest number of combinations that are rendered.
const TRIED: usize = 24;

/// Largest number of larger pictures rendered to improve predicted times, each of the best candidate so far.
const LARGER: usize = 4;

/// Relative difference below which times count as equal, so that noise decides nothing; the more exact candidate wins.
const CLOSE: f64 = 0.07;

/// Budget given by the user.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wish {
    /// Largest error of a channel, in units of radiance.
    MaxError(f64),
    /// Largest rendering time.
    Time(Duration),
}

impl Wish {
    /// Returns the largest predicted time in seconds, from a candidate's slowest run.
    fn seconds(self) -> f64 {
        match self {
            Self::MaxError(_) => f64::INFINITY,
            Self::Time(t) => OF_THE_TIME * t.as_secs_f64(),
        }
    }
}

/// Effect of one level while the other choices are exact.
#[derive(Clone, Debug, Serialize)]
pub struct Alone {
    /// Name of the axis.
    pub axis: &'static str,
    /// Name of the level.
    pub level: String,
    /// Time relative to the exact level.
    pub ratio: f64,
    /// Largest difference of a channel.
    pub max: f64,
    #[serde(skip)]
    what: Level,
    #[serde(skip)]
    rmse: f64,
}

/// Result of the choice.
#[derive(Clone, Debug, Serialize)]
pub struct Choice {
    /// Columns and rows of the small picture.
    pub size: [u32; 2],
    /// Seconds that the choice took.
    pub study_seconds: f64,
    /// Effects of each level by itself.
    pub alone: Vec<Alone>,
    /// Number of combinations predicted.
    pub thought_of: usize,
    /// Number of combinations measured.
    pub tried: usize,
    /// Chosen combination, followed by ever more exact ones to use if it fails.
    pub ladder: Vec<Candidate>,
    /// True if the first combination is predicted to keep the budget.
    pub kept: bool,
}

/// Predicted combination.
#[derive(Clone, Copy)]
struct Predicted {
    variant: Variant,
    seconds: f64,
    /// Time ratios of the ray-cutting levels: [minimum, product].
    cut: [f64; 2],
    max: f64,
    squares: f64,
}

/// Chooses settings for a picture of `scene` with `threads` threads. Axes in `fixed` keep the level of `default`.
///
/// # Errors
/// - `Error::Interrupted` if the observer requests a stop.
/// - `Error::Limit` if the default back end is not available.
/// - `Error::Unsupported` if `f32` cannot represent the bound.
pub fn choose(
    scene: &Scene,
    default: &Variant,
    fixed: &[Axis],
    wish: Wish,
    threads: usize,
    observer: &Observer,
) -> Result<Choice> {
    let start = std::time::Instant::now();
    let tolerance = match wish {
        Wish::MaxError(e) => e,
        Wish::Time(_) => super::errors::VISIBLE,
    };
    let exact = reference::most_exact(default, scene);
    let quick = Quick::of(scene, &exact, threads, observer)?;
    if let Wish::MaxError(e) = wish {
        refuse_what_f32_cannot_hold(e, quick.brightest())?;
    }
    let mut quick = quick.judged(tolerance);
    let free: Vec<Axis> = Axis::ALL
        .into_iter()
        .filter(|a| !fixed.contains(a) && !matches!(a, Axis::Sampling | Axis::Precision))
        // The single-ray walk exists for comparison only.
        .filter(|a| !matches!(a, Axis::Triangles | Axis::Reciprocal))
        .collect();
    // The most exact choices in f32, within the fixed axes.
    let mut base = Variant { precision: Precision::Single, ..exact };
    for &axis in fixed {
        base = base.with(default.level(axis));
    }
    let of_base = quick.measure(&base)?;
    let mut alone: Vec<Alone> = Vec::new();
    let mut nearest = of_base.clone();
    let (singles, _) = plan::singles(scene, &base, &free);
    for variant in singles.into_iter().flat_map(|(_, variants)| variants) {
        // Dispersive scenes carry no polarisation, and a proof costs more than the base's own cut-off.
        let polarised = variant.fresnel == FresnelModel::Polarised && base.fresnel != FresnelModel::Polarised;
        // Maps and virtual scenes take longer to make than a small picture takes to trace.
        let mapped = matches!(variant.reflection, Reflection::CubeMap | Reflection::SphereMap | Reflection::Virtual)
            || variant.refraction.is_mapped();
        if polarised || mapped || (variant.proven.is_some() && base.proven.is_none()) {
            continue;
        }
        let candidate = quick.measure(&variant)?;
        let Some(what) = variant.apart_from(&base).first().copied() else { continue };
        if let Wish::Time(t) = wish {
            let apart = |c: &Candidate| (c.seconds / t.as_secs_f64()).ln().abs();
            nearest = if apart(&candidate) < apart(&nearest) { candidate.clone() } else { nearest };
        }
        alone.push(Alone {
            axis: what.axis().name(),
            level: what.to_string(),
            ratio: candidate.seconds / of_base.seconds,
            max: candidate.max,
            what,
            rmse: candidate.rmse,
        });
    }
    let mut tried = vec![of_base];
    if let Wish::Time(t) = wish {
        let mut slower = 1.0;
        for _ in 0..LARGER {
            let economy = quick.learn_from_larger(scene, &nearest, t.as_secs_f64())?;
            for c in &mut tried {
                (c.seconds, c.slowest) = (c.seconds * economy, c.slowest * economy);
            }
            slower = try_out(&mut tried, &alone, wish, slower, &mut quick)?;
            let best = best(&tried, wish).0.clone();
            if best.variant == nearest.variant {
                break;
            }
            nearest = best;
        }
    } else {
        try_out(&mut tried, &alone, wish, 1.0, &mut quick)?;
    }
    let thought_of = combinations(&tried[0], &alone).len();
    let of_base = tried[0].clone();
    let double = Candidate {
        seconds: of_base.seconds * quick.double_ratio(),
        slowest: of_base.slowest * quick.double_ratio(),
        max: 0.0,
        rmse: 0.0,
        variant: { Variant { precision: Precision::Double, ..base } },
    };
    let (ladder, kept) = ladder(&tried, double, wish);
    Ok(Choice {
        size: quick.size(),
        study_seconds: start.elapsed().as_secs_f64(),
        alone,
        thought_of,
        tried: tried.len(),
        ladder,
        kept,
    })
}

/// # Errors
/// Returns `Error::Unsupported` if rounding the picture's brightest value exceeds the bound.
fn refuse_what_f32_cannot_hold(bound: f64, brightest: f64) -> Result<()> {
    let rounding = brightest * f64::from(f32::EPSILON) / 2.0;
    if bound >= rounding {
        return Ok(());
    }
    Err(Unsupported::BoundBelowRounding { bound, brightest, rounding }.into())
}

/// Renders the most promising combinations beside those in `tried`, whose first entry is the base. `slower` is the
/// factor by which candidates that were too slow exceeded their predictions; it is updated.
fn try_out(
    tried: &mut Vec<Candidate>,
    alone: &[Alone],
    wish: Wish,
    mut slower: f64,
    quick: &mut Judged,
) -> Result<f64> {
    let predicted = combinations(&tried[0], alone);
    let before = tried.len();
    for p in promising(&predicted, wish) {
        if tried.iter().any(|c| c.variant == p.variant) || p.seconds * slower > wish.seconds() {
            continue;
        }
        let candidate = quick.measure(&p.variant)?;
        if !keeps(&candidate, wish) {
            slower = slower.max(candidate.slowest / p.seconds);
        }
        tried.push(candidate);
        // The most promising combinations come first.
        let new = &tried[before..];
        if new.len() >= TRIED || (new.len() >= TRIED / 3 && new.iter().any(|c| keeps(c, wish))) {
            break;
        }
    }
    let fastest = predicted.iter().min_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let fastest = fastest.filter(|f| tried.iter().all(|c| c.variant != f.variant && !keeps(c, wish)));
    if let (Wish::Time(_), Some(fastest)) = (wish, fastest) {
        tried.push(quick.measure(&fastest.variant)?);
    }
    Ok(slower)
}

fn keeps(c: &Candidate, wish: Wish) -> bool {
    match wish {
        Wish::MaxError(e) => c.max <= MARGIN * e,
        Wish::Time(_) => c.slowest <= wish.seconds(),
    }
}

/// Returns true if the axis saves time by tracing fewer rays. Several such levels partly save the same rays: together
/// at least as many as the best one, and at most as many as their product says. The prediction is the geometric mean of
/// both.
fn cuts_rays(axis: Axis) -> bool {
    matches!(axis, Axis::Reflection | Axis::Cutoff | Axis::Depth)
}

/// Returns the product of all levels. Times multiply (see [`cuts_rays`]); errors add at most.
fn combinations(base: &Candidate, alone: &[Alone]) -> Vec<Predicted> {
    let first = Predicted {
        variant: base.variant,
        seconds: base.seconds,
        cut: [1.0; 2],
        max: base.max,
        squares: base.rmse * base.rmse,
    };
    // A gain within the noise counts as none.
    let ratio = |a: &Alone| if (a.ratio - 1.0).abs() < CLOSE { 1.0 } else { a.ratio };
    let mut all = vec![first];
    for axis in Axis::ALL {
        let levels: Vec<&Alone> = alone.iter().filter(|a| a.what.axis() == axis).collect();
        let wider = all.iter().flat_map(|p| {
            let with = levels.iter().map(|a| {
                let ratio = ratio(a);
                let cuts = cuts_rays(axis) && ratio < 1.0;
                let [least, product] = p.cut;
                let cut = if cuts { [least.min(ratio), product * ratio] } else { p.cut };
                let left = |[least, product]: [f64; 2]| (least * product).sqrt();
                Predicted {
                    variant: p.variant.with(a.what),
                    seconds: p.seconds * if cuts { left(cut) / left(p.cut) } else { ratio },
                    cut,
                    max: p.max + (a.max - base.max).max(0.0),
                    squares: p.squares + (a.rmse * a.rmse - base.rmse * base.rmse).max(0.0),
                }
            });
            std::iter::once(*p).chain(with)
        });
        all = wider.collect();
    }
    all
}

/// Returns the combinations worth rendering, the best first.
fn promising(all: &[Predicted], wish: Wish) -> Vec<Predicted> {
    let mut sorted: Vec<Predicted> = all.to_vec();
    match wish {
        Wish::MaxError(e) => {
            // Added errors are a bound, so combinations slightly beyond it may still keep it.
            sorted.retain(|p| p.max <= 2.0 * MARGIN * e);
            sorted.sort_by(|a, b| a.seconds.total_cmp(&b.seconds).then(a.max.total_cmp(&b.max)));
        }
        Wish::Time(_) => {
            let limit = wish.seconds();
            if sorted.iter().any(|p| p.seconds <= limit) {
                sorted.retain(|p| p.seconds <= 1.15 * limit);
                sorted.sort_by(|a, b| a.squares.total_cmp(&b.squares).then(a.seconds.total_cmp(&b.seconds)));
            } else {
                sorted.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
            }
        }
    }
    // Variants that differ only in levels without effect are equivalent.
    sorted.dedup_by(|a, b| a.seconds == b.seconds && a.max == b.max && a.squares == b.squares);
    sorted
}

/// Returns the best candidate within the budget, or else the nearest to it, and true if it is within.
fn best(tried: &[Candidate], wish: Wish) -> (&Candidate, bool) {
    let keeping = tried.iter().filter(|c| keeps(c, wish));
    let (best, fallback) = match wish {
        Wish::MaxError(_) => (
            keeping.min_by(|a, b| a.seconds.total_cmp(&b.seconds)),
            tried.iter().min_by(|a, b| a.max.total_cmp(&b.max)),
        ),
        Wish::Time(_) => (
            keeping.min_by(|a, b| a.rmse.total_cmp(&b.rmse)),
            tried.iter().min_by(|a, b| a.slowest.total_cmp(&b.slowest)),
        ),
    };
    (best.or(fallback).expect("the base is always tried"), best.is_some())
}

/// Returns the best candidate within the budget, then ever more exact ones, and `f64` last. Also returns true if the
/// first is within.
fn ladder(tried: &[Candidate], double: Candidate, wish: Wish) -> (Vec<Candidate>, bool) {
    let (best, kept) = best(tried, wish);
    let mut ladder = vec![best.clone()];
    if let Wish::MaxError(_) = wish {
        let mut others: Vec<&Candidate> = tried.iter().collect();
        others.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        for c in others {
            if ladder.last().is_some_and(|last| c.seconds > last.seconds && c.max < 0.5 * last.max) {
                ladder.push(c.clone());
            }
        }
        // The base, whatever the small picture shows, and f64.
        if let Some(base) = tried.first().filter(|b| ladder.iter().all(|c| c.variant != b.variant)) {
            ladder.push(base.clone());
        }
        ladder.push(double);
    }
    (ladder, kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Backend;
    use crate::scene::Settings;

    fn candidate(level: Option<Level>, seconds: f64, max: f64) -> Candidate {
        let base = Variant::of(&Settings::default(), Backend::Native);
        Candidate { variant: level.map_or(base, |l| base.with(l)), seconds, slowest: seconds, max, rmse: max * 0.1 }
    }

    #[test]
    fn the_cheapest_that_keeps_the_error_is_taken_and_ever_more_exact_ones_follow() {
        let tried = [
            candidate(None, 4.0, 1e-5),
            candidate(Some(Level::Depth(8)), 2.0, 1e-4),
            candidate(Some(Level::Depth(4)), 1.0, 8e-4),
            candidate(Some(Level::Depth(2)), 0.5, 0.1),
        ];
        let double = candidate(Some(Level::Precision(Precision::Double)), 40.0, 0.0);
        let (ladder_, kept) = ladder(&tried, double.clone(), Wish::MaxError(1.0 / 512.0));
        let depths: Vec<u32> = ladder_.iter().map(|c| c.variant.depth).collect();
        assert_eq!((depths, kept), (vec![4, 8, 64, 64], true));
        assert_eq!(ladder_[3].variant.precision, Precision::Double);
        let (ladder_, kept) = ladder(&tried, double.clone(), Wish::MaxError(1e-7));
        assert_eq!((ladder_[0].variant.depth, ladder_.len(), kept), (64, 2, false));
        let (ladder_, kept) = ladder(&tried, double.clone(), Wish::Time(Duration::from_secs(3)));
        assert_eq!((ladder_[0].variant.depth, ladder_.len(), kept), (8, 1, true));
        // The slowest run took 1.5 times the median, so a candidate within the time only by its median is not chosen.
        let uneasy = tried.map(|c| Candidate { slowest: 1.5 * c.seconds, ..c });
        let (ladder_, kept) = ladder(&uneasy, double, Wish::Time(Duration::from_secs(3)));
        assert_eq!((ladder_[0].variant.depth, ladder_.len(), kept), (4, 1, true));
    }

    #[test]
    fn times_multiply_but_for_the_same_rays_and_errors_add() {
        let base = candidate(None, 4.0, 1e-5);
        let alone = |what: Level, ratio, max: f64| Alone {
            axis: what.axis().name(),
            level: what.to_string(),
            ratio,
            max,
            what,
            rmse: max * 0.1,
        };
        let levels = [
            alone(Level::Depth(4), 0.5, 1e-3),
            alone(Level::Fresnel(FresnelModel::Schlick), 0.99, 1e-2),
            alone(Level::Cutoff(0.25), 0.25, 1e-2),
            alone(Level::Shadows(crate::scene::ShadowRule::Opaque), 0.8, 0.0),
        ];
        let all = combinations(&base, &levels);
        assert_eq!(all.len(), 16);
        let last = all.iter().find(|p| p.variant.apart_from(&base.variant).len() == 4).unwrap();
        // 0.25 is the minimum, 0.125 the product.
        let seconds = 4.0 * 0.8 * (0.25_f64 * 0.125).sqrt();
        assert!((last.seconds - seconds).abs() < 1e-12 && (last.max - (1e-5 + 0.00099 + 2.0 * 0.00999)).abs() < 1e-9);
        // Schlick's gain is within the noise, so it is never preferred.
        let best = promising(&all, Wish::MaxError(1.0));
        assert_eq!(best[0].variant.fresnel, FresnelModel::Exact);
    }
}
