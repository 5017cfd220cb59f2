//! `vitrum verify`.

pub(super) mod args;
pub(super) mod options;

use std::collections::BTreeMap;
use std::sync::Arc;

use self::options::Verify;
use super::verdict::Verdict;
use super::warnings::Warnings;
use super::{backend, interrupt, output, progress};
use crate::Result;
use crate::accel::Backend;
use crate::measure::table::{counted, grouped};
use crate::render::{self, Observer};
use crate::scene::Scene;
use crate::simd::level;
use crate::trial::verify::{self, Candidate, GroupResult, Trouble, UnderTest, VerifyPlan};

/// Largest number of troubles of each kind listed outside JSON.
const TOLD: usize = 8;

/// Result in the form of the JSON output.
#[derive(serde::Serialize)]
struct Report {
    version: &'static str,
    simd: &'static str,
    threads: usize,
    scene: Option<String>,
    full: bool,
    /// Build quality of the hierarchies.
    bvh: &'static str,
    holds: bool,
    groups: Vec<Row>,
    /// Faults of the scene's triangles.
    troubles: Vec<TroubleRow>,
    /// Number of rays that were left out of the search for overlapping media, because earlier ones met too many shapes.
    probes_left_out: u64,
    #[serde(flatten)]
    warnings: Warnings,
}

#[derive(serde::Serialize)]
struct Row {
    group: &'static str,
    /// `None` if the group consists of formulas.
    path: Option<&'static str>,
    cases: u64,
    failures: u64,
    holds: bool,
    /// Meaning of the figure.
    figure: Option<&'static str>,
    /// Number of rays left out, because earlier ones met too many shapes at once.
    left_out: u64,
    worst: Option<f64>,
    bound: Option<f64>,
    seconds: f64,
    /// First few failures.
    examples: Vec<String>,
}

#[derive(serde::Serialize)]
struct TroubleRow {
    kind: &'static str,
    file: String,
    line: u32,
    object: String,
    triangle: u32,
    message: String,
}

/// Runs the groups and prints the table.
pub(super) fn run(job: &Verify) -> Result<Verdict> {
    let observer = Arc::new(Observer::default());
    interrupt::listen(&observer)?;
    backend::start_threads(job.threads)?;
    let mut warnings = Warnings::default();
    let scene = match &job.scene {
        None => None,
        Some(path) => {
            let options = render::Options { threads: job.threads, ..render::Options::default() };
            let (scene, found) = Warnings::survey((path, &job.reading), job.strict, &options, &observer)?;
            warnings = found;
            Some(scene)
        }
    };
    let name = job.scene.as_ref().map(|path| path.display().to_string());
    let named = scene.as_ref().zip(name.as_deref());
    let paths = usize::from(job.native) + 2 * usize::from(job.embree);
    let (findings, troubles) = progress::follow(&observer, job.plan.parts(paths), !job.quiet, || {
        interrupt::heeded(|| -> Result<_> {
            let findings = fire(job, named, &observer)?;
            Ok((findings, scene.as_ref().map(verify::find_trouble).unwrap_or_default()))
        })
    })?;
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        simd: level::BUILT,
        threads: rayon::current_num_threads(),
        scene: name,
        full: job.plan.full,
        bvh: job.bvh.name(),
        // Faulty triangles are reported, but are no failure: a scene may have them and be rendered correctly.
        holds: findings.iter().all(GroupResult::holds),
        groups: findings.iter().map(Row::of).collect(),
        troubles: troubles.found.iter().map(TroubleRow::of).collect(),
        probes_left_out: troubles.probes_left_out,
        warnings,
    };
    if !job.quiet {
        report.warnings.log();
    }
    if job.json {
        output::print_json(&report)?;
    } else if !job.quiet {
        output::print(&report.text())?;
    }
    Ok(if report.holds { Verdict::Done } else { Verdict::Negative })
}

fn fire(job: &Verify, scene: Option<(&Scene, &str)>, observer: &Observer) -> Result<Vec<GroupResult>> {
    let mut findings = if scene.is_none() { verify::fire_at_optics(&job.plan, observer)? } else { Vec::new() };
    let wanted = |backend: &Backend| if *backend == Backend::Native { job.native } else { job.embree };
    for backend in Backend::ALL.into_iter().filter(wanted) {
        findings.extend(fire_at(&UnderTest { backend, bvh: job.bvh }, &job.plan, scene, observer)?);
    }
    // Paths of a group side by side, in the requested order.
    let place = |f: &GroupResult| job.plan.groups.iter().position(|&g| g == f.group);
    findings.sort_by_key(place);
    Ok(findings)
}

fn fire_at<C: Candidate>(
    candidate: &C,
    plan: &VerifyPlan,
    scene: Option<(&Scene, &str)>,
    observer: &Observer,
) -> Result<Vec<GroupResult>> {
    match scene {
        Some((scene, name)) => verify::fire_at_scene(candidate, scene, name, plan, observer),
        None => verify::fire_at_path(candidate, plan, observer),
    }
}

impl Row {
    fn of(f: &GroupResult) -> Self {
        let worst = f.tally.worst.as_ref();
        Self {
            group: f.group.name(),
            path: f.path,
            cases: f.tally.cases,
            failures: f.tally.failures,
            holds: f.holds(),
            figure: worst.map(|w| w.what),
            left_out: f.tally.left_out,
            // JSON has no NaN.
            worst: worst.map(|w| w.value).filter(|x| x.is_finite()),
            bound: worst.and_then(|w| w.bound),
            seconds: f.time.as_secs_f64(),
            examples: f.tally.examples.clone(),
        }
    }

    fn cells(&self) -> [String; 8] {
        let figure = |x: f64| if x >= 1.0 { format!("{x:.1}") } else { format!("{x:.2e}") };
        [
            self.group.to_owned(),
            self.path.unwrap_or("-").to_owned(),
            grouped(self.cases),
            grouped(self.failures),
            self.worst.map_or(String::from(if self.figure.is_some() { "NaN" } else { "-" }), figure),
            self.bound.map_or(String::from("-"), figure),
            format!("{:.1} s", self.seconds),
            self.figure.unwrap_or_default().to_owned(),
        ]
    }
}

impl TroubleRow {
    fn of(t: &Trouble) -> Self {
        Self {
            kind: t.kind.name(),
            file: t.place.file.clone(),
            line: t.place.line,
            object: t.place.object.clone(),
            triangle: t.place.triangle,
            message: t.to_string(),
        }
    }
}

impl Report {
    /// Text of several lines.
    fn text(&self) -> String {
        let head = ["group", "path", "cases", "failures", "worst", "bound", "time", "figure"].map(String::from);
        let rows: Vec<[String; 8]> = [head].into_iter().chain(self.groups.iter().map(Row::cells)).collect();
        let widths: [usize; 8] = std::array::from_fn(|c| rows.iter().map(|r| r[c].len()).max().unwrap_or(0));
        let mut lines: Vec<String> = rows.iter().map(|row| aligned(row, &widths)).collect();
        for row in self.groups.iter().filter(|r| !r.examples.is_empty()) {
            lines.push(format!("\n{}, {}:", row.group, row.path.unwrap_or("all paths")));
            lines.extend(row.examples.iter().map(|e| format!("  {}", e.replace('\n', "\n  "))));
            if self.scene.is_none() {
                let full = if self.full { " --full" } else { "" };
                lines.push(format!("  repeat  vitrum verify --group {}{full}", row.group));
            }
        }
        for row in self.groups.iter().filter(|r| r.left_out > 0) {
            let (path, rays) = (row.path.unwrap_or("all paths"), counted(row.left_out, "ray"));
            let more = if self.full { "" } else { "; --full does about thirty times as much work" };
            lines.push(format!(
                "\n{}, {path}: left out {rays}, since those before met too many shapes at once{more}",
                row.group
            ));
        }
        let mut kinds: BTreeMap<&str, Vec<&TroubleRow>> = BTreeMap::new();
        for t in &self.troubles {
            kinds.entry(t.kind).or_default().push(t);
        }
        for (kind, troubles) in kinds {
            lines.push(format!("\n{kind}: {}", grouped(troubles.len() as u64)));
            lines.extend(troubles.iter().take(TOLD).map(|t| format!("  {}", t.message)));
            if troubles.len() > TOLD {
                lines.push(format!("  and {} more; --json has all", grouped((troubles.len() - TOLD) as u64)));
            }
        }
        if self.probes_left_out > 0 {
            let rays = counted(self.probes_left_out, "ray");
            lines
                .push(format!("\nmedia that overlap: left out {rays}, since those before met too many shapes at once"));
        }
        lines.push(format!(
            "\n{}: {}, {} threads",
            if self.holds { "holds" } else { "FALLS SHORT" },
            self.simd,
            self.threads
        ));
        lines.join("\n") + "\n"
    }
}

/// Aligns names to the left and figures to the right.
fn aligned(row: &[String; 8], widths: &[usize; 8]) -> String {
    let cell = |c: usize| {
        let (text, width) = (&row[c], widths[c]);
        if c < 2 || c == 7 { format!("{text:<width$}") } else { format!("{text:>width$}") }
    };
    (0..8).map(cell).collect::<Vec<_>>().join("  ").trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::trial::verify::{CaseCounts, Group, Worst};

    #[test]
    fn a_group_that_falls_short_is_told_with_its_figures() {
        let worst = Some(Worst { what: "relative error of R", value: 2e-6, bound: Some(1.2e-6) });
        let tally =
            CaseCounts { cases: 12_345, failures: 1, worst, examples: vec![String::from("1 to 1.5")], left_out: 0 };
        let finding = GroupResult { group: Group::Fresnel, path: None, tally, time: Duration::from_millis(250) };
        assert!(!finding.holds());
        let report = Report {
            version: "0",
            simd: "none",
            threads: 2,
            scene: None,
            full: false,
            bvh: "default",
            holds: finding.holds(),
            groups: vec![Row::of(&finding)],
            troubles: Vec::new(),
            probes_left_out: 0,
            warnings: Warnings::default(),
        };
        let text = report.text();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "group    path   cases  failures    worst    bound   time  figure");
        assert_eq!(lines[1], "fresnel  -     12 345         1  2.00e-6  1.20e-6  0.2 s  relative error of R");
        assert_eq!(lines[3..5], ["fresnel, all paths:", "  1 to 1.5"]);
        assert_eq!(lines.last(), Some(&"FALLS SHORT: none, 2 threads"));
        let none = GroupResult { tally: CaseCounts::default(), ..finding };
        assert!(!none.holds(), "what was not tried is not said to hold");
    }
}
