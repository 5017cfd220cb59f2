//! The budget turned round: which choices keep a given error at the least time, or a given time at the least error.
//!
//! A small picture of the scene is made by every level of every choice that is free, the others exact. Errors of levels
//! are then added and times multiplied to predict combinations; the most promising of these are made and measured, and
//! the best one that keeps the wish is taken. Afterwards ([`check`]) a sample of the picture's own pixels is held against
//! `f64`, and where that fails the next more exact combination is taken.

pub mod check;
mod quick;

use std::time::Duration;

use serde::Serialize;

use super::axis::{Axis, Level, Precision};
use super::plan;
use super::reference;
use super::variant::Variant;
use crate::optics::FresnelModel;
use crate::render::Observer;
use crate::scene::Scene;
use crate::{Error, Result};
use quick::{Judged, Quick};

/// Part of the wished error that the small picture may use up: it has fewer pixels to be wrong in.
const MARGIN: f64 = 0.5;

/// Part of the wished time that the prediction from the slowest run may use up.
const OF_THE_TIME: f64 = 0.85;

/// Combinations that are made, at most.
const TRIED: usize = 24;

/// Larger pictures that times are learnt from, at most: from that of what looked best by the one before.
const LARGER: usize = 4;

/// Times that are this close count as equal, so that noise decides nothing: the more exact wins.
const CLOSE: f64 = 0.07;

/// What is wished for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wish {
    /// No channel of a pixel off by more, in units of radiance.
    MaxError(f64),
    /// Rendering within this time.
    Time(Duration),
}

impl Wish {
    /// Seconds that a picture may be predicted to take, from its slowest run.
    fn seconds(self) -> f64 {
        match self {
            Self::MaxError(_) => f64::INFINITY,
            Self::Time(t) => OF_THE_TIME * t.as_secs_f64(),
        }
    }
}

/// Choices that were made and measured on the small picture.
#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    /// The choices.
    pub variant: Variant,
    /// Seconds that the whole picture is predicted to take, from the median of some runs.
    pub seconds: f64,
    /// The same from the slowest of them: what a machine that does other work may make of it.
    pub slowest: f64,
    /// Largest difference of a channel from `f64` in the small picture, ill-conditioned pixels apart.
    pub max: f64,
    /// Root of the mean squared difference.
    pub rmse: f64,
}

/// What one level does by itself, the others exact.
#[derive(Clone, Debug, Serialize)]
pub struct Alone {
    /// Its axis.
    pub axis: &'static str,
    /// Its name.
    pub level: String,
    /// Its time over that of the exact level.
    pub ratio: f64,
    /// Largest difference of a channel.
    pub max: f64,
    #[serde(skip)]
    what: Level,
    #[serde(skip)]
    rmse: f64,
}

/// What was chosen, and why.
#[derive(Clone, Debug, Serialize)]
pub struct Choice {
    /// Columns and rows of the small picture.
    pub size: [u32; 2],
    /// Seconds that the study took.
    pub study_seconds: f64,
    /// What each level does by itself.
    pub alone: Vec<Alone>,
    /// Combinations that were thought of.
    pub thought_of: usize,
    /// Those that were made and measured.
    pub tried: usize,
    /// The one to take and, where it fails, those to take then, each more exact than the one before.
    pub ladder: Vec<Candidate>,
    /// Whether the first of them is predicted to keep the wish.
    pub kept: bool,
}

/// A combination as predicted.
#[derive(Clone, Copy)]
struct Predicted {
    variant: Variant,
    seconds: f64,
    /// Of the levels that cut rays, the least part of the base's time that one leaves, and the product of all of them.
    cut: [f64; 2],
    max: f64,
    squares: f64,
}

/// Finds what keeps the wish for a picture of `scene` by `threads` threads. `default` holds where an axis is in `fixed`.
///
/// # Errors
/// `Interrupted`; a limit, where the default back end is not there; usage, where `f32` cannot hold the bound.
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
        // What walks one ray at a time is there to be compared, not to be chosen.
        .filter(|a| !matches!(a, Axis::Triangles | Axis::Reciprocal))
        .collect();
    // The most exact that f32 does, within what is fixed.
    let mut base = Variant { precision: Precision::Single, ..exact };
    for &axis in fixed {
        base = base.with(default.level(axis));
    }
    let of_base = quick.measure(&base)?;
    let mut alone: Vec<Alone> = Vec::new();
    let mut nearest = of_base.clone();
    let (singles, _) = plan::singles(scene, &base, &free);
    for variant in singles.into_iter().flat_map(|(_, variants)| variants) {
        // Where a medium disperses, polarisation is not carried; and a proof costs more than the base's own cut-off.
        let polarised = variant.fresnel == FresnelModel::Polarised && base.fresnel != FresnelModel::Polarised;
        if polarised || (variant.proven.is_some() && base.proven.is_none()) {
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
/// Usage, where the rounding of the picture's brightest value is larger than the bound.
fn refuse_what_f32_cannot_hold(bound: f64, brightest: f64) -> Result<()> {
    let rounding = brightest * f64::from(f32::EPSILON) / 2.0;
    if bound >= rounding {
        return Ok(());
    }
    Err(Error::Usage(format!(
        "--max-error {bound:e}: cannot be kept: pictures hold f32 values, which rounds the brightest of this scene \
         ({brightest:.3}) by up to {rounding:.1e}; take a bound of at least {:.0e}",
        2.0 * rounding
    )))
}

/// Makes the combinations that look most promising beside those in `tried`, of which the first is the base. `slower` is how
/// much longer than predicted those turned out to take that were too slow; what it is from here on.
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
        // The most promising come first.
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

/// Whether what the levels of an axis save is rays. Several such levels save partly the same ones: at least what the one does
/// that saves most, at most what their product says. Half way between, geometrically, is what is predicted.
fn cuts_rays(axis: Axis) -> bool {
    matches!(axis, Axis::Reflection | Axis::Cutoff | Axis::Depth)
}

/// The product of all levels: times multiply (see [`cuts_rays`]), errors add at most.
fn combinations(base: &Candidate, alone: &[Alone]) -> Vec<Predicted> {
    let first = Predicted {
        variant: base.variant,
        seconds: base.seconds,
        cut: [1.0; 2],
        max: base.max,
        squares: base.rmse * base.rmse,
    };
    // Within the noise, no gain is believed in.
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

/// Those worth making, the best first.
fn promising(all: &[Predicted], wish: Wish) -> Vec<Predicted> {
    let mut sorted: Vec<Predicted> = all.to_vec();
    match wish {
        Wish::MaxError(e) => {
            // Adding errors is a bound; what is a little beyond may hold all the same.
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
    // Variants that only differ where nothing is gained or lost say the same.
    sorted.dedup_by(|a, b| a.seconds == b.seconds && a.max == b.max && a.squares == b.squares);
    sorted
}

/// The best that keeps the wish, or else comes nearest to it; and whether it keeps it.
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

/// The best that keeps the wish, then ever more exact ones, and `f64` last. And whether the first one keeps it.
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
        // The base, whatever the small picture says, and f64.
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
        // A run that took half as long again: what is in time in the median alone is not taken.
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
        // 0.25 is the least, 0.125 the product.
        let seconds = 4.0 * 0.8 * (0.25_f64 * 0.125).sqrt();
        assert!((last.seconds - seconds).abs() < 1e-12 && (last.max - (1e-5 + 0.00099 + 2.0 * 0.00999)).abs() < 1e-9);
        // Schlick gains nothing that can be told from noise, so that it is never preferred.
        let best = promising(&all, Wish::MaxError(1.0));
        assert_eq!(best[0].variant.fresnel, FresnelModel::Exact);
    }
}
