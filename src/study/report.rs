//! Results of a study, in the form of `report.json`.

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

/// All results of a study.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Machine that it ran on.
    pub machine: Machine,
    /// Number of worker threads.
    pub threads: usize,
    /// Command that made this report.
    pub command: String,
    /// Scene and size of the pictures.
    pub subject: Pictured,
    /// True if all planned variants were measured. Otherwise the time limit or the user ended the study.
    pub finished: bool,
    /// Time limit of one session, in seconds.
    pub limit: f64,
    /// Reference of pictures with the default's rays per pixel.
    pub own: Option<Made>,
    /// Reference of the sampling axis.
    pub fine: Option<Made>,
    /// One row per variant, the default one first.
    pub rows: Vec<Row>,
    /// Variants that were not measured, with the reasons.
    pub left_out: Vec<String>,
    /// Conclusions from the rows, in words.
    pub findings: Vec<String>,
}

/// Scene of a study.
#[derive(Clone, Debug, Serialize)]
pub struct Pictured {
    /// The scene file, as the user named it.
    pub scene: String,
    /// Columns of its pictures.
    pub width: u32,
    /// Rows of its pictures.
    pub height: u32,
    /// Number of triangles.
    pub triangles: u64,
    /// Number of exact spheres.
    pub spheres: u64,
    /// Number of infinite planes.
    pub planes: u64,
}

/// Measurements of one variant.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Levels that differ from the default's.
    pub name: String,
    /// True for the default variant.
    #[serde(skip)]
    pub is_default: bool,
    /// Axis in which it differs from the default, if it is only one.
    pub axis: Option<&'static str>,
    /// All its choices.
    pub levels: Variant,
    /// Command that repeats its picture.
    pub command: String,
    /// Wall time of a render, in seconds.
    pub seconds: Figure,
    /// Time relative to the default's in the same round.
    pub ratio: Figure,
    /// True if the ratio may be 1: no measurable difference.
    pub same_time: bool,
    /// Time relative to the same walk with the watertight test and true division, in the same round: the cost of the
    /// choice without that of the walk. Only for variants that choose a triangle test or a reciprocal.
    pub walk: Option<Figure>,
    /// Share of triangle tests that fell back to `f64`, if a test was chosen.
    pub settled: Option<f64>,
    /// Wall time of building its hierarchy, in seconds. It is not part of `seconds`.
    pub build_seconds: f64,
    /// Number of rays traced.
    pub rays: Rays,
    /// Errors against `f64` with the exact choices at the default's rays per pixel.
    pub own: Option<Errors>,
    /// Errors against 16 by 16 rays per pixel.
    pub fine: Option<Errors>,
    /// Difference to the default's picture.
    pub change: Option<Change>,
    /// Energy balance.
    pub ledger: Ledger,
    /// True if no variant beats it in both time and `own.rmse` without ill-conditioned pixels.
    pub front: bool,
    /// True if no variant beats it in both time and `fine.rmse`.
    pub front_fine: bool,
    /// File of its picture in the study's folder.
    pub film: String,
}

impl Row {
    /// Returns the errors that it is ranked by: `own` if it has the default's rays per pixel, else `fine`.
    #[must_use]
    pub fn judged(&self) -> Option<&Errors> {
        self.own.as_ref().or(self.fine.as_ref())
    }
}

/// Returns the rows of a journal.
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
    // The sort is stable: the default first, then single axes, then combinations.
    rows.sort_by_key(|r| (r.levels.apart_from(default).len(), r.levels.apart_from(default).first().map(|l| l.axis())));
    let points = |error: fn(&Row) -> Option<f64>| {
        // A time that is indistinguishable from the default's does not beat it.
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

/// Returns conclusions from the rows, in words.
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

/// Returns a sentence that compares a choice within the single-ray walk, which all levels of its axis share.
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
