//! A whole trial: builds, checks that all contenders find the same, and times them.

use super::agree::{Disagreement, Judge};
use super::contender::{Answers, Contender};
use super::rays::{self, Picture, RayKind, RaySet, View};
use super::report::{Build, Ratio, Report, Row};
use super::streams::contenders;
use super::team::Team;
use super::timing::{self, Watch};
use crate::Result;
use crate::accel::{Accel, Backend, BuildOptions, BuildQuality, Intersector};
use crate::geometry::{Geometry, GeometryMask, Shape, TriMesh};
use crate::measure::Machine;
use crate::measure::Percentiles;

/// Shapes of a trial.
#[derive(Clone, Debug)]
pub struct BenchSubject {
    /// Name in reports.
    pub name: String,
    /// Shapes. Infinite planes are left out, since no hierarchy holds them.
    pub geometry: Vec<Geometry>,
    /// Viewpoint; if `None`, one is fitted to the shapes.
    pub view: Option<View>,
}

impl BenchSubject {
    /// Creates a subject without the infinite planes of `geometry`.
    #[must_use]
    pub fn new(name: &str, mut geometry: Vec<Geometry>, view: Option<View>) -> Self {
        geometry.retain(|g| !matches!(g.shape, Shape::Plane(_)));
        Self { name: name.to_owned(), geometry, view }
    }

    /// Creates a subject of one mesh, with a view fitted to it.
    #[must_use]
    pub fn of_mesh(name: &str, mesh: TriMesh) -> Self {
        // Rays need only positions and triangles.
        let mesh = TriMesh { positions: mesh.positions, triangles: mesh.triangles, ..TriMesh::default() };
        Self::new(name, vec![Geometry { shape: Shape::Mesh(mesh), mask: GeometryMask::OPAQUE }], None)
    }
}

/// Measurements to make.
#[derive(Clone, Debug)]
pub struct BenchPlan {
    /// Pixels that the rays start from.
    pub picture: Picture,
    /// Kinds of rays.
    pub kinds: Vec<RayKind>,
    /// Numbers of threads, measured one after the other.
    pub threads: Vec<usize>,
    /// Number of runs of each contender, at least 1.
    pub rounds: usize,
    /// Number of builds of each hierarchy, at least 1.
    pub builds: usize,
    /// Build quality of the native hierarchy; Embree's is `MEDIUM`.
    pub bvh: BuildQuality,
}

impl BenchPlan {
    /// Number of runs for each subject, as counted by [`Watch::done`].
    #[must_use]
    pub fn steps(&self, embree: bool) -> u64 {
        let (scenes, contenders) = if embree { (3, 15) } else { (1, 3) };
        let a_kind = contenders * (self.rounds + 1);
        (self.threads.len() * (scenes * self.builds + self.kinds.len() * a_kind)) as u64
    }
}

/// Result of a trial.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// Measurements, and the leaks that were noted.
    Measured(Box<Report>, Vec<Disagreement>),
    /// Contenders that do not find the same, so that timings would be meaningless.
    Refused(Vec<Disagreement>),
}

/// Measures all `subjects`, with Embree only if `machine` has it.
///
/// # Errors
/// `Interrupted`; a limit, if threads or memory run out.
pub fn run(subjects: &[BenchSubject], plan: &BenchPlan, machine: Machine, watch: &Watch) -> Result<Outcome> {
    let embree = machine.embree.is_some();
    let mut report = Report { machine, rows: Vec::new(), builds: Vec::new(), ratios: Vec::new() };
    let mut noted = Vec::new();
    for subject in subjects {
        let built = build(subject, plan, embree, watch, &mut report)?;
        let findings = measure(subject, &built, plan, watch, &mut report)?;
        if findings.iter().any(Disagreement::refuses) {
            return Ok(Outcome::Refused(findings));
        }
        noted.extend(findings);
    }
    Ok(Outcome::Measured(Box::new(report), noted))
}

/// Hierarchies of all back ends over the same shapes.
pub struct Built(Vec<Accel>);

impl Built {
    /// Builds with the threads of `team`: native with quality `bvh`, and Embree in both modes with `MEDIUM` if `embree`
    /// is true.
    ///
    /// # Errors
    /// As [`Accel::build`].
    pub fn new(geometry: &[Geometry], team: &Team, embree: bool, bvh: BuildQuality) -> Result<Self> {
        let build = |backend: Backend| {
            let quality = if backend == Backend::Native { bvh } else { BuildQuality::Default };
            let options = BuildOptions { quality, threads: team.threads() };
            team.install(|| Accel::build(backend, geometry, options))
        };
        let backends = if embree { &Backend::ALL } else { &Backend::ALL[..1] };
        Ok(Self(backends.iter().map(|&backend| build(backend)).collect::<Result<_>>()?))
    }

    /// The native accelerator.
    #[must_use]
    pub fn native(&self) -> &Accel {
        &self.0[0]
    }

    /// Returns all contenders; the first is native as in renders.
    #[must_use]
    pub fn contenders(&self) -> Vec<Box<dyn Contender + '_>> {
        self.0.iter().flat_map(contenders).collect()
    }
}

/// Builds every hierarchy as often as planned, in turn. Returns the last ones.
fn build(subject: &BenchSubject, plan: &BenchPlan, embree: bool, watch: &Watch, report: &mut Report) -> Result<Built> {
    let mut last: Option<Built> = None;
    for &threads in &plan.threads {
        let team = Team::new(threads)?;
        let mut ms: Vec<Vec<f64>> = Vec::new();
        for _ in 0..plan.builds.max(1) {
            // The old hierarchies are dropped first, to halve the memory.
            drop(last.take());
            let built = Built::new(&subject.geometry, &team, embree, plan.bvh)?;
            ms.resize_with(built.0.len(), Vec::new);
            for (ms, accel) in ms.iter_mut().zip(&built.0) {
                ms.push(accel.build_stats().time.as_secs_f64() * 1e3);
                watch.step()?;
            }
            last = Some(built);
        }
        let accels = last.iter().flat_map(|built| &built.0);
        report.builds.extend(accels.zip(ms).map(|(accel, ms)| {
            let stats = accel.build_stats();
            Build {
                mesh: subject.name.clone(),
                backend: accel.backend(),
                quality: accel.embree().map_or(plan.bvh.name(), |_| "medium"),
                threads,
                ms: Percentiles::of(ms).median,
                bytes_per_triangle: stats.bytes as f64 / (stats.triangles + stats.spheres).max(1) as f64,
            }
        }));
    }
    match last {
        Some(built) => Ok(built),
        None => Built::new(&subject.geometry, &Team::new(1)?, embree, plan.bvh),
    }
}

/// Times one subject, if all contenders find the same.
fn measure(
    subject: &BenchSubject,
    built: &Built,
    plan: &BenchPlan,
    watch: &Watch,
    report: &mut Report,
) -> Result<Vec<Disagreement>> {
    let view = subject.view.unwrap_or_else(|| View::of(&rays::bounds(&subject.geometry)));
    let sets = rays::all(built.native(), &subject.geometry, &view, &plan.picture);
    let judge = Judge::new(&subject.geometry);
    let triangles = built.native().build_stats().triangles;
    let mut contenders = built.contenders();
    let mut noted = Vec::new();
    for set in sets.iter().filter(|s| plan.kinds.contains(&s.kind) && s.count > 0) {
        for &threads in &plan.threads {
            let team = Team::new(threads)?;
            let findings = check(&mut contenders, set, &team, &judge, watch)?;
            if findings.iter().any(Disagreement::refuses) {
                return Ok(findings);
            }
            // Leaks do not depend on the number of threads.
            noted.extend(findings.into_iter().filter(|_| threads == plan.threads[0]));
            let seconds = timing::rounds(&mut contenders, set, &team, plan.rounds.max(1), watch)?;
            let labels: Vec<_> = contenders.iter().map(|c| c.label()).collect();
            let figures: Vec<Percentiles> = seconds.iter().map(|s| Percentiles::of_millions(set.count, s)).collect();
            for (label, figure) in labels.iter().zip(&figures) {
                report.rows.push(Row {
                    mesh: subject.name.clone(),
                    triangles,
                    rays: set.kind.name(),
                    backend: label.backend,
                    mode: label.mode,
                    threads,
                    mrays_per_s: figure.median,
                    spread: figure.spread,
                });
            }
            for against in [Backend::Embree, Backend::EmbreeFast] {
                let modes = (0..labels.len()).filter(|&i| labels[i].backend == against);
                let Some(best) = modes.max_by(|&a, &b| figures[a].median.total_cmp(&figures[b].median)) else {
                    continue;
                };
                let ratio = Percentiles::of_ratio(&seconds[0], &seconds[best]);
                report.ratios.push(Ratio {
                    mesh: subject.name.clone(),
                    rays: set.kind.name(),
                    threads,
                    against,
                    embree_mode: labels[best].mode,
                    ratio: ratio.median,
                    spread: ratio.spread,
                });
            }
        }
    }
    Ok(noted)
}

/// Traces the set once with each contender and compares its answers with the first one's. Each mismatch is reported
/// once per back end.
///
/// # Errors
/// `Interrupted`.
pub fn check(
    contenders: &mut [Box<dyn Contender + '_>],
    set: &RaySet,
    team: &Team,
    judge: &Judge,
    watch: &Watch,
) -> Result<Vec<Disagreement>> {
    let mut first: Option<(_, Answers)> = None;
    let mut findings: Vec<Disagreement> = Vec::new();
    for contender in contenders {
        contender.prepare(set);
        contender.trace(set, team);
        let (label, answers) = (contender.label(), contender.answers(set));
        match &first {
            None => first = Some((label, answers)),
            Some((other, theirs)) => {
                for new in judge.compare(set, (*other, theirs), (label, &answers)) {
                    let told = |f: &Disagreement| f.label.backend == new.label.backend && f.ray == new.ray;
                    if !findings.iter().any(told) {
                        findings.push(new);
                    }
                }
            }
        }
        watch.step()?;
    }
    Ok(findings)
}
