//! Result of a parity run, written as text or as JSON.

use std::fmt::Write as _;

use glam::Vec3;

use super::contenders::Contenders;
use super::options::Parity;
use super::pixels::{Pixels, TOLERANCE, Worst};
use crate::accel::reference::{Cause, Fault};
use crate::cli::warnings::Warnings;
use crate::measure::table::{counted, grouped};
use crate::scene::Scene;
use crate::simd::level;
use crate::trial::parity::{FAULTS, Query, Record, Records, Set, VerdictCounts, Wrong, fault_name};
use crate::trial::shown::{self, Ray};

/// Inputs of a report. `records` and `pixels` are in the order of the sets and the contenders.
pub(super) struct Facts<'a> {
    pub job: &'a Parity,
    pub scene: &'a Scene,
    pub warnings: &'a Warnings,
    pub contenders: &'a Contenders,
    pub sets: &'a [Set],
    pub records: &'a [Vec<Records>],
    pub pixels: &'a [Pixels],
}

/// The report, in the form of the JSON output.
#[derive(serde::Serialize)]
pub(super) struct Report {
    version: &'static str,
    simd: &'static str,
    scene: String,
    #[serde(flatten)]
    warnings: Warnings,
    triangles: u64,
    spheres: u64,
    planes: u64,
    /// Number of rays requested of each kind.
    rays: usize,
    /// Build quality of the hierarchies.
    bvh: &'static str,
    contenders: Vec<&'static str>,
    left_out: Vec<LeftOut>,
    rows: Vec<Row>,
    pictures: Vec<Picture>,
    /// Some wrong answers of each row.
    examples: Vec<Example>,
    /// Number of wrong answers and pixels of the native path.
    native_wrong: u64,
    passed: bool,
}

#[derive(serde::Serialize)]
struct LeftOut {
    contender: &'static str,
    why: String,
}

/// Answers of one contender to one query about one set.
#[derive(serde::Serialize)]
struct Row {
    rays: &'static str,
    query: Query,
    contender: &'static str,
    answers: u64,
    agree: u64,
    undecidable: Undecidable,
    /// Hits at or beyond an end of the interval by no more than rounding. They are wrong for the native path.
    beyond_end: u64,
    wrong: Faults,
    /// Largest margin among the undecidable answers, relative to its bound.
    largest_margin: f64,
    differs_from_native: u64,
    differs_undecidably: u64,
    #[serde(skip)]
    tally: VerdictCounts,
}

#[derive(serde::Serialize)]
struct Undecidable {
    edge: u64,
    tie: u64,
    interval: u64,
    sliver: u64,
    /// Rays that pass an open edge or an unjoined seam.
    crack: u64,
}

#[derive(serde::Serialize)]
struct Faults {
    missed_hit: u64,
    false_hit: u64,
    other_primitive: u64,
    t_out_of_bounds: u64,
    outside_interval: u64,
    leak: u64,
    self_hit: u64,
}

/// Picture by one contender.
#[derive(serde::Serialize)]
struct Picture {
    contender: &'static str,
    width: u32,
    height: u32,
    tolerance: f64,
    differ: u64,
    /// Excused pixels: the `f64` value changes as much with the camera ray moved by a few ulps of `f32`.
    edge: u64,
    /// Excused pixels that need a few ulps for each level of the path.
    deep: u64,
    wrong: u64,
    largest_within: f64,
    differs_from_native: u64,
    worst: Option<Worst>,
}

/// Wrong answer. Infinite numbers are null.
#[derive(serde::Serialize)]
struct Example {
    rays: &'static str,
    query: Query,
    contender: &'static str,
    fault: &'static str,
    /// World coordinates, as `dir`.
    origin: [f64; 3],
    dir: [f64; 3],
    t_min: f32,
    t_max: f32,
    claim: Option<Met>,
    truth: Option<Met>,
    /// Command that sends the ray again.
    repeat: String,
    #[serde(skip)]
    ray: Ray,
}

/// A hit. Under [`Query::Occluded`] only its existence is reported.
#[derive(serde::Serialize)]
struct Met {
    t: f64,
    geometry: u32,
    primitive: u32,
}

impl Report {
    pub fn of(facts: &Facts) -> Self {
        let Facts { job, scene, warnings, contenders, sets, records, pixels } = facts;
        let (names, shapes) = (contenders.names(), scene.shape_counts());
        let scene_name = job.scene.display().to_string();
        let mut rows = Vec::new();
        let mut examples = Vec::new();
        for (set, records) in sets.iter().zip(*records) {
            for (&contender, both) in names.iter().zip(records) {
                for (query, record) in both.each() {
                    rows.push(Row::of(set.name, query, contender, record));
                    examples.extend(
                        record.wrong.iter().map(|w| Example::of(scene, &scene_name, set.name, query, contender, w)),
                    );
                }
            }
        }
        let pictures: Vec<Picture> = names
            .iter()
            .zip(*pixels)
            .map(|(&contender, p)| Picture {
                contender,
                width: scene.settings.width,
                height: scene.settings.height,
                tolerance: TOLERANCE,
                differ: p.differ,
                edge: p.edge,
                deep: p.deep,
                wrong: p.wrong(),
                largest_within: p.largest_within,
                differs_from_native: p.differs_from_first,
                worst: p.worst,
            })
            .collect();
        let native = names[0];
        let answers: u64 = rows.iter().filter(|r| r.contender == native).map(|r| r.tally.broken()).sum();
        let native_wrong = answers + pictures.first().map_or(0, |p| p.wrong);
        Self {
            version: env!("CARGO_PKG_VERSION"),
            simd: level::BUILT,
            scene: scene_name,
            warnings: (*warnings).clone(),
            triangles: shapes.triangles,
            spheres: shapes.spheres,
            planes: shapes.planes,
            rays: job.rays,
            bvh: contenders.bvh.name(),
            contenders: names,
            left_out: contenders.left_out.iter().map(|w| LeftOut { contender: "embree", why: w.clone() }).collect(),
            rows,
            pictures,
            examples,
            native_wrong,
            passed: native_wrong == 0,
        }
    }

    /// Returns true if the native path is wrong nowhere.
    pub fn passed(&self) -> bool {
        self.passed
    }

    /// Text of several lines of at most 80 columns (except for names of files), without a final line end.
    pub fn text(&self) -> String {
        let shapes = [(self.triangles, "triangle"), (self.spheres, "sphere"), (self.planes, "plane")];
        let shapes: Vec<_> = shapes.iter().filter(|(n, _)| *n > 0).map(|(n, noun)| counted(*n, noun)).collect();
        let mut s = format!("scene      {}: {}\n", self.scene, shapes.join(", "));
        // Writing to a string cannot fail, here and below.
        let _ = writeln!(s, "rays       up to {} of each kind, nearest hit and any hit", grouped(self.rays as u64));
        for LeftOut { contender, why } in &self.left_out {
            let _ = writeln!(s, "left out   {contender}: {why}");
        }
        self.answers(&mut s);
        self.faults(&mut s);
        self.pixels(&mut s);
        for e in self.examples.iter().filter(|e| e.contender == self.contenders[0]) {
            let _ = writeln!(s, "{}", e.text());
        }
        let verdict = if self.passed {
            String::from("native is nowhere wrong")
        } else {
            format!("native is WRONG in {}", counted(self.native_wrong, "case"))
        };
        let _ = write!(s, "\nverdict    {verdict}");
        s
    }

    /// Writes both queries of a kind in one line, and the sum of all kinds.
    fn answers(&self, s: &mut String) {
        let _ = writeln!(s, "\n{:31}undecidable, f32 cannot tell: ", "");
        let _ = writeln!(
            s,
            "{:<11} {:<13} {:>9} {:>7} {:>7} {:>4} {:>6} {:>6} {:>7}",
            "rays", "contender", "answers", "edge", "crack", "tie", "end", "sliver", "wrong"
        );
        let mut line = |kind: &str, contender: &str, t: &VerdictCounts| {
            let [edge, tie, interval, sliver, crack] = t.undecidable;
            let native = contender == self.contenders[0];
            let (end, wrong) = if native { (interval, t.broken()) } else { (interval + t.beyond_end, t.all_wrong()) };
            let figure = |n: u64| if n == 0 { String::from("-") } else { grouped(n) };
            let (answers, wrong) = (grouped(t.answers), figure(wrong));
            let [edge, crack, tie, end, sliver] = [edge, crack, tie, end, sliver].map(figure);
            let _ = writeln!(
                s,
                "{kind:<11} {contender:<13} {answers:>9} {edge:>7} {crack:>7} {tie:>4} {end:>6} {sliver:>6} {wrong:>7}"
            );
        };
        let mut kinds: Vec<&str> = self.rows.iter().map(|r| r.rays).collect();
        kinds.dedup();
        for kind in kinds.into_iter().map(Some).chain([None]) {
            for contender in &self.contenders {
                let rows = self.rows.iter().filter(|r| r.contender == *contender && kind.is_none_or(|k| k == r.rays));
                line(kind.unwrap_or("all"), contender, &sum(rows));
            }
        }
    }

    /// Writes the faults of each contender, and its differences from native.
    fn faults(&self, s: &mut String) {
        s.push('\n');
        for contender in &self.contenders {
            let rows = || self.rows.iter().filter(|r| r.contender == *contender);
            let total = sum(rows());
            let mut parts: Vec<String> = FAULTS
                .iter()
                .zip(total.wrong)
                .filter(|(_, n)| *n > 0)
                .map(|(f, n)| format!("{} {}", grouped(n), fault_name(*f).replace('_', " ")))
                .collect();
            if total.beyond_end > 0 {
                parts.push(format!("{} beyond an end by a rounding", grouped(total.beyond_end)));
            }
            let _ = match parts.len() {
                0 => writeln!(s, "{contender:<13} none wrong"),
                _ => writeln!(s, "{contender:<13} wrong: {}", parts.join(", ")),
            };
            let differs: u64 = rows().map(|r| r.differs_from_native).sum();
            let excused: u64 = rows().map(|r| r.differs_undecidably).sum();
            if *contender != self.contenders[0] {
                let (differs, excused) = (counted(differs, "answer"), grouped(excused));
                let _ = writeln!(s, "{:<13} differs from native in {differs}, {excused} undecidable", "");
            }
        }
    }

    fn pixels(&self, s: &mut String) {
        let Some(first) = self.pictures.first() else { return };
        let (width, height) = (first.width, first.height);
        let _ =
            writeln!(s, "\npicture    {width} x {height}, against the same shading over f64 hits, to {TOLERANCE:.0e}");
        let _ = writeln!(
            s,
            "{:<13} {:>8} {:>8} {:>8} {:>8} {:>14} {:>15}",
            "contender", "differ", "edge", "deep", "wrong", "others within", "from native"
        );
        for p in &self.pictures {
            let _ = writeln!(
                s,
                "{:<13} {:>8} {:>8} {:>8} {:>8} {:>14.1e} {:>15}",
                p.contender,
                grouped(p.differ),
                grouped(p.edge),
                grouped(p.deep),
                grouped(p.wrong),
                p.largest_within,
                grouped(p.differs_from_native)
            );
        }
        for (p, w) in self.pictures.iter().filter_map(|p| p.worst.map(|w| (p, w))) {
            let _ = writeln!(s, "{} at {}, {}: {:?}; over f64 hits: {:?}", p.contender, w.x, w.y, w.value, w.reference);
        }
    }
}

fn sum<'a>(rows: impl Iterator<Item = &'a Row>) -> VerdictCounts {
    let mut sum = VerdictCounts::default();
    rows.for_each(|r| sum.merge(&r.tally));
    sum
}

impl Row {
    fn of(rays: &'static str, query: Query, contender: &'static str, record: &Record) -> Self {
        let t = &record.tally;
        let cause = |c: Cause| t.undecidable[c as usize];
        let fault = |f: Fault| t.wrong[f as usize];
        Self {
            rays,
            query,
            contender,
            answers: t.answers,
            agree: t.agree,
            undecidable: Undecidable {
                edge: cause(Cause::Edge),
                tie: cause(Cause::Tie),
                interval: cause(Cause::Interval),
                sliver: cause(Cause::Sliver),
                crack: cause(Cause::Crack),
            },
            beyond_end: t.beyond_end,
            wrong: Faults {
                missed_hit: fault(Fault::MissedHit),
                false_hit: fault(Fault::FalseHit),
                other_primitive: fault(Fault::OtherPrimitive),
                t_out_of_bounds: fault(Fault::TOutOfBounds),
                outside_interval: fault(Fault::OutsideInterval),
                leak: fault(Fault::Leak),
                self_hit: fault(Fault::SelfHit),
            },
            largest_margin: t.largest_margin,
            differs_from_native: record.differs,
            differs_undecidably: record.differs_undecidably,
            tally: *t,
        }
    }
}

/// World coordinates of a place, with the digits of `f32` if they are the scene's own.
fn world(scene: &Scene, place: Vec3) -> [f64; 3] {
    if scene.is_in_world_coordinates() { digits(place) } else { scene.world(place.as_dvec3()).to_array() }
}

/// Numbers with enough digits to tell an `f32` from its neighbours.
fn digits(v: Vec3) -> [f64; 3] {
    v.to_array().map(|x| x.to_string().parse().unwrap_or(f64::from(x)))
}

impl Example {
    fn of(scene: &Scene, name: &str, rays: &'static str, query: Query, contender: &'static str, w: &Wrong) -> Self {
        let met = |hit: bool, t: f64, geometry: u32, primitive: u32| hit.then_some(Met { t, geometry, primitive });
        let (claim, truth) = (&w.claim, &w.truth);
        Self {
            rays,
            query,
            contender,
            fault: w.fault.map_or("beyond_end", fault_name),
            origin: world(scene, w.ray.origin),
            dir: digits(w.ray.dir).map(|x| x * scene.unit()),
            t_min: w.ray.t_min,
            t_max: w.ray.t_max,
            claim: met(claim.is_hit(), f64::from(claim.t), claim.geometry, claim.primitive),
            truth: met(truth.is_hit(), truth.t, truth.geometry, truth.primitive),
            repeat: shown::command(name, &w.ray),
            ray: w.ray,
        }
    }

    fn text(&self) -> String {
        let met = |m: &Option<Met>| {
            m.as_ref().map_or(String::from("nothing"), |m| format!("{}:{} at {}", m.geometry, m.primitive, m.t))
        };
        format!(
            "{} {} ({:?}): {}: {}; f64: {}\n  ray    {}\n  repeat {}",
            self.contender,
            self.rays,
            self.query,
            self.fault.replace('_', " "),
            met(&self.claim),
            met(&self.truth),
            shown::ray(&self.ray),
            self.repeat
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::BuildQuality;
    use crate::cli::command::{Cli, Command};
    use crate::trial::parity::Judgement;

    /// Report of one set in which the finding on native's closest hits is `finding`.
    fn report(finding: Judgement, pixels: &Pixels) -> Report {
        let Command::Parity(args) = <Cli as clap::Parser>::parse_from(["vitrum", "parity", "a.toml"]).command else {
            unreachable!("parity was asked for")
        };
        let (job, contenders) =
            (Parity::from(args), Contenders::build(&Scene::default(), BuildQuality::Default, 1).unwrap());
        let set =
            Set { name: "edge", coherence: crate::accel::Coherence::Coherent, rays: Vec::new(), leaves: Vec::new() };
        let count = contenders.names().len();
        let mut records = vec![Records::default(); count];
        records[0].closest.tally.add(finding);
        Report::of(&Facts {
            job: &job,
            scene: &Scene::default(),
            warnings: &Warnings::default(),
            contenders: &contenders,
            sets: &[set],
            records: &[records],
            pixels: &vec![pixels.clone(); count],
        })
    }

    #[test]
    fn native_passes_where_it_is_nowhere_wrong_and_not_even_beyond_an_end() {
        let sound = Pixels { differ: 3, edge: 2, deep: 1, ..Pixels::default() };
        for (finding, wrong) in [
            (Judgement::Agrees, 0),
            (Judgement::Undecidable(Cause::Edge, 0.5), 0),
            (Judgement::BeyondEnd, 1),
            (Judgement::Wrong(Fault::Leak), 1),
        ] {
            let report = report(finding, &sound);
            assert_eq!((report.native_wrong, report.passed()), (wrong, wrong == 0), "{finding:?}");
            assert_eq!(report.text().contains("native is WRONG in 1 case"), wrong == 1);
        }
        let off = Pixels { differ: 4, edge: 1, deep: 1, ..Pixels::default() };
        assert_eq!(report(Judgement::Agrees, &off).native_wrong, 2);
    }
}
