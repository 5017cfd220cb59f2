//! What a study came to, in the form that `report.json` has.

use serde::Serialize;

use super::axis::{Axis, Precision};
use super::energy::Ledger;
use super::errors::Errors;
use super::front::front;
use super::journal::{Change, Journal, Rays};
use super::reference::Made;
use super::variant::Variant;
use crate::measure::Figure;
use crate::measure::Machine;

/// Everything that was measured.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// What it ran on.
    pub machine: Machine,
    /// Worker threads.
    pub threads: usize,
    /// The command that made this report.
    pub command: String,
    /// What was pictured.
    pub subject: Pictured,
    /// Whether all that was planned is here; else the time limit or the user ended it.
    pub finished: bool,
    /// Time limit of a session, in seconds.
    pub limit: f64,
    /// What pictures are held against, at the default's rays a pixel.
    pub own: Option<Made>,
    /// What the sampling axis is held against.
    pub fine: Option<Made>,
    /// One for each variant, the default one first.
    pub rows: Vec<Row>,
    /// What was not measured, and why.
    pub left_out: Vec<String>,
    /// What follows from the rows, in words.
    pub findings: Vec<String>,
}

/// The scene of a study.
#[derive(Clone, Debug, Serialize)]
pub struct Pictured {
    /// The scene file, as the user named it.
    pub scene: String,
    /// Columns of its pictures.
    pub width: u32,
    /// Rows of its pictures.
    pub height: u32,
    /// Triangles.
    pub triangles: u64,
    /// Exact spheres.
    pub spheres: u64,
    /// Infinite planes.
    pub planes: u64,
}

/// One variant.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// What it has else than the default.
    pub name: String,
    /// True for the default variant.
    #[serde(skip)]
    pub is_default: bool,
    /// The axis, where it is one only.
    pub axis: Option<&'static str>,
    /// Its choices, all of them.
    pub levels: Variant,
    /// The command that makes its picture again.
    pub command: String,
    /// Wall time of a render, in seconds.
    pub seconds: Figure,
    /// Over the default's in the same round.
    pub ratio: Figure,
    /// Whether the ratio may be 1: no measurable difference.
    pub same_time: bool,
    /// Where a triangle test or a reciprocal is chosen, over the time of the same walk with the watertight test and true
    /// division in the same round: what the choice costs, without what the walk does.
    pub walk: Option<Figure>,
    /// Share of triangle tests that fell to `f64`, where one is chosen.
    pub settled: Option<f64>,
    /// Wall time of building its hierarchy, in seconds; no part of the above.
    pub build_seconds: f64,
    /// Rays traced.
    pub rays: Rays,
    /// Against `f64` with the exact choices at the default's rays a pixel.
    pub own: Option<Errors>,
    /// Against 16 by 16 rays a pixel.
    pub fine: Option<Errors>,
    /// Against the default's picture.
    pub change: Option<Change>,
    /// Where its light went.
    pub ledger: Ledger,
    /// Whether nothing beats it in both time and `own.rmse` without ill-conditioned pixels.
    pub front: bool,
    /// Whether nothing beats it in both time and `fine.rmse`.
    pub front_fine: bool,
    /// Its picture's file in the study's folder.
    pub film: String,
}

impl Row {
    /// The error that it is judged by: its own where it has as many rays a pixel as the default, else the fine one.
    #[must_use]
    pub fn judged(&self) -> Option<&Errors> {
        self.own.as_ref().or(self.fine.as_ref())
    }
}

/// The rows of what is in a journal.
#[must_use]
pub fn rows(journal: &Journal, default: &Variant, command: impl Fn(&Variant) -> String) -> Vec<Row> {
    let mut rows: Vec<Row> = journal
        .records
        .iter()
        .filter(|r| !r.seconds.is_empty())
        .map(|r| {
            let apart = r.variant.apart_from(default);
            let ratio = Figure::of(&r.ratios);
            Row {
                name: r.variant.name(default),
                is_default: apart.is_empty(),
                axis: (apart.len() == 1).then(|| apart[0].axis().name()),
                levels: r.variant,
                command: command(&r.variant),
                seconds: Figure::of(&r.seconds),
                ratio,
                same_time: ratio.may_be(1.0),
                walk: (!r.walk_ratios.is_empty()).then(|| Figure::of(&r.walk_ratios)),
                settled: r.settled,
                build_seconds: r.build_seconds,
                rays: r.rays,
                own: r.own.clone(),
                fine: r.fine.clone(),
                change: r.change,
                ledger: r.ledger,
                front: false,
                front_fine: false,
                film: r.film.clone(),
            }
        })
        .collect();
    // Stable: the default first, then one axis at a time, then combinations.
    rows.sort_by_key(|r| (r.levels.apart_from(default).len(), r.levels.apart_from(default).first().map(|l| l.axis())));
    let points = |error: fn(&Row) -> Option<f64>| {
        // What cannot be told from the default's time is not believed to beat it.
        let time = |r: &Row| if r.same_time && r.ratio.runs > 2 { 1.0 } else { r.ratio.median };
        let points: Vec<[f64; 2]> = rows.iter().map(|r| [time(r), error(r).unwrap_or(f64::NAN)]).collect();
        front(&points)
    };
    let own = points(|r| r.own.as_ref().map(Errors::ranked));
    let fine = points(|r| r.fine.as_ref().map(|e| e.rmse));
    for ((row, own), fine) in rows.iter_mut().zip(own).zip(fine) {
        (row.front, row.front_fine) = (own, fine);
    }
    rows
}

/// What follows from the rows, in words.
#[must_use]
pub fn findings(rows: &[Row]) -> Vec<String> {
    let Some(default) = rows.iter().find(|r| r.is_default) else { return Vec::new() };
    let mut out = Vec::new();
    for axis in Axis::ALL {
        for row in rows.iter().filter(|r| r.axis == Some(axis.name())) {
            let [low, high] = row.ratio.interval;
            let time = if row.ratio.runs < 3 {
                format!("{:.2} times the default's time in a single run", row.ratio.median)
            } else if row.same_time {
                format!("no measurable difference in time ({low:.3} to {high:.3})")
            } else {
                format!("{:.3} times the default's time ({low:.3} to {high:.3})", row.ratio.median)
            };
            let error = match (row.own.as_ref(), default.own.as_ref(), row.fine.as_ref(), default.fine.as_ref()) {
                (Some(e), Some(d), ..) => compared(e.ranked(), d.ranked(), row.change.map(|c| c.max)),
                (None, _, Some(e), Some(d)) => compared(e.rmse, d.rmse, None) + ", against 16 x 16 rays a pixel",
                _ => String::from("not judged"),
            };
            out.push(format!("{}: {time}; {error}{}", row.name, walked(row)));
        }
    }
    let double = rows.iter().find(|r| r.levels.precision == Precision::Double);
    if let Some(change) = double.and_then(|r| r.change) {
        out.push(format!(
            "f32 in place of f64 moves no channel by more than {:.1e} (RMSE {:.1e})",
            change.max, change.rmse
        ));
    }
    out
}

/// How a choice compares within the walk of one ray at a time that all of its axis share.
fn walked(row: &Row) -> String {
    let Some(walk) = row.walk else { return String::new() };
    let [low, high] = walk.interval;
    let plain = row.levels.plain_walk().is_some_and(|plain| plain == row.levels);
    let time = if plain {
        String::from("the walk that the others of its kind are compared with")
    } else if walk.runs < 3 {
        format!("{:.2} times watertight's in the same walk, in too few runs to tell", walk.median)
    } else if walk.may_be(1.0) {
        format!("no measurable difference to watertight in the same walk ({low:.3} to {high:.3})")
    } else {
        format!("{:.3} times watertight's in the same walk ({low:.3} to {high:.3})", walk.median)
    };
    let settled = row.settled.filter(|share| *share > 0.0);
    let settled = settled.map_or_else(String::new, |s| format!("; {s:.1e} of its triangle tests fell to f64"));
    format!("; {time}{settled}")
}

fn compared(error: f64, default: f64, change: Option<f64>) -> String {
    if change == Some(0.0) {
        return String::from("the same picture to the bit");
    }
    let change = change.map_or_else(String::new, |c| format!(", no channel more than {c:.1e} from the default's"));
    format!("RMSE {error:.1e} where the default has {default:.1e}{change}")
}
