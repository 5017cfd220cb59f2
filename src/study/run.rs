//! A study from start to end, or until time runs out or the user stops it.

use std::path::Path;
use std::time::{Duration, Instant};

use super::axis::{Axis, Level, Precision};
use super::condition::Condition;
use super::energy::Ledger;
use super::engine::{Engine, Shot};
use super::errors::{Errors, VISIBLE};
use super::journal::{Change, Header, Journal, Record, film_name};
use super::plan::{self, Point};
use super::reference::{self, Made, Reference};
use super::report::{self, Pictured, Report};
use super::variant::Variant;
use super::{digest, size};
use crate::accel::reference::Reference as Arbiter;
use crate::image::{self, Film};
use crate::measure::Machine;
use crate::render::Observer;
use crate::render::reference::Prepared;
use crate::scene::Scene;
use crate::{Error, Result};

/// Smallest number of runs for a meaningful interval.
const FEWEST_RUNS: usize = 3;

/// Time in seconds above which a render needs no warm-up, and one run suffices if time is short.
const LONG: f64 = 1.0;

/// Number of variants that take turns.
const BLOCK: usize = 8;

/// Condition tests use at most this share of a variant's render time.
const ASKING: f64 = 0.25;

/// Number of front members that are tried at other numbers of rays per pixel.
const RESAMPLED: usize = 4;

/// Subject and options of a study.
#[derive(Clone, Debug)]
pub struct Subject<'a> {
    /// Scene, with the settings of its default picture.
    pub scene: &'a Scene,
    /// File of the scene, as named by the user.
    pub path: &'a Path,
    /// Default choices.
    pub default: Variant,
    /// Columns and rows; `None` for as many as the time limit allows.
    pub size: Option<[u32; 2]>,
    /// Number of worker threads; 0 means one per processor.
    pub threads: usize,
    /// Axes to study.
    pub axes: Vec<Axis>,
    /// Largest duration of one session.
    pub limit: Duration,
    /// Largest number of timed runs per variant.
    pub runs: usize,
    /// True if axes are combined.
    pub combine: bool,
    /// Command that started the study.
    pub command: String,
    /// Machine that it runs on.
    pub machine: Machine,
}

/// Progress of a study, and the request to stop it.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Observer whose `stop` ends the study within a tile.
    pub observer: &'a Observer,
    /// Callback for messages on the current work.
    pub say: &'a (dyn Fn(&str) + Sync),
}

/// Measures everything that the journal of `folder` lacks, and reports on all measurements. If the user stops it, the
/// report says that the study is unfinished.
///
/// # Errors
/// - `Error::Io` if a file cannot be read or written.
/// - `Error::Usage` if the folder contains another study.
/// - `Error::Limit` if the default back end is not available.
/// - `Error::Interrupted` if stopped before there is anything to report.
pub fn run(subject: &Subject, folder: &Path, fresh: bool, watch: &Watch) -> Result<Report> {
    let start = Instant::now();
    let digest = digest::of(subject);
    let mut journal = Journal::open(folder, &digest, fresh)?;
    let [width, height] = match &journal.header {
        Some(header) => [header.width, header.height],
        None => {
            (watch.say)("choosing a size");
            let [width, height] = size::choose(subject, watch.observer)?;
            journal.begin(Header { digest, width, height })?;
            [width, height]
        }
    };
    let mut scene = subject.scene.try_clone()?;
    (scene.settings.width, scene.settings.height) = (width, height);
    scene.settings = subject.default.settings(&scene.settings);
    let exact = reference::most_exact(&subject.default, &scene);
    let judge = Scene { settings: exact.settings(&scene.settings), ..scene.try_clone()? };
    Arbiter::need(&judge.geometry)?;
    let condition = Condition::new(&judge, Prepared::new(&judge, exact.fresnel), VISIBLE, watch.observer);
    let mut session = Session {
        subject,
        engine: Engine::new(&scene, subject.threads),
        condition,
        journal,
        watch: *watch,
        start,
        left_out: Vec::new(),
        late: Vec::new(),
        portion: (1.0, 1),
        default_film: None,
    };
    let finished = match session.all() {
        Ok(()) => !session.late(),
        Err(Error::Interrupted) if session.journal.find(&subject.default).is_some() => false,
        Err(e) => return Err(e),
    };
    let size = [width, height];
    let rows = report::rows(&session.journal, &subject.default, |v| v.command(subject.path, size));
    let counts = scene.shape_counts();
    let mut left_out = session.left_out;
    if !session.late.is_empty() {
        left_out.push(format!("the time limit of {:.0} s: {}", subject.limit.as_secs_f64(), session.late.join("; ")));
    }
    if watch.observer.stop.load(std::sync::atomic::Ordering::Relaxed) {
        left_out.insert(0, String::from("all that was not reached when the study was ended; the same command goes on"));
    }
    let judged = session.journal.own.is_some();
    Ok(Report {
        machine: subject.machine.clone(),
        threads: crate::render::Options { threads: subject.threads, ..Default::default() }.thread_count(),
        command: subject.command.clone(),
        subject: Pictured {
            scene: subject.path.display().to_string(),
            width,
            height,
            triangles: counts.triangles,
            spheres: counts.spheres,
            planes: counts.planes,
        },
        finished: finished && judged,
        limit: subject.limit.as_secs_f64(),
        own: session.journal.own.map(|r| r.made),
        fine: session.journal.fine.map(|r| r.made),
        findings: report::findings(&rows),
        rows,
        left_out,
    })
}

struct Session<'a> {
    subject: &'a Subject<'a>,
    engine: Engine<'a>,
    condition: Condition<'a>,
    journal: Journal,
    watch: Watch<'a>,
    start: Instant,
    left_out: Vec<String>,
    /// Names of variants left out for lack of time.
    late: Vec<String>,
    /// Share of the remaining time for the variants still to come, and their number.
    portion: (f64, usize),
    /// Picture of the default variant.
    default_film: Option<Film>,
}

impl Session<'_> {
    fn left(&self) -> f64 {
        self.subject.limit.as_secs_f64() - self.start.elapsed().as_secs_f64()
    }

    fn late(&self) -> bool {
        self.left() <= 0.0
    }

    fn say(&self, what: &str) {
        (self.watch.say)(what);
    }

    /// Measures references, single axes, products and sampling.
    fn all(&mut self) -> Result<()> {
        let subject = self.subject;
        let default = subject.default;
        self.say("the default");
        // Twice: the first render builds and warms up.
        self.engine.shoot(&default, self.watch.observer)?;
        let shot = self.engine.shoot(&default, self.watch.observer)?;
        let default_seconds = shot.seconds;
        self.default_film = Some(shot.outcome.film.clone());

        let (mut plan, idle) = plan::singles(subject.scene, &default, &subject.axes);
        self.left_out.extend(idle);
        let sampled = plan.iter().any(|(axis, _)| *axis == Axis::Sampling);
        self.make_own()?;
        if sampled {
            self.make_fine(default_seconds)?;
        }
        self.keep_default(&shot)?;

        // Without its reference the sampling axis could be timed but not judged.
        let judged = self.journal.fine.is_some();
        plan.retain(|(axis, _)| *axis != Axis::Sampling || judged);
        let singles: usize = plan.iter().map(|(_, variants)| variants.len()).sum();
        // The remaining time is shared evenly, with a third of it for combinations.
        let for_singles = if subject.combine { 0.65 } else { 0.95 };
        self.portion = (for_singles, singles);
        for (axis, variants) in &plan {
            self.block(axis.name(), variants)?;
        }
        if subject.combine && !self.late() {
            self.combine()?;
            if sampled && judged {
                self.resample()?;
            }
        }
        Ok(())
    }

    /// Renders the reference of all axes except sampling.
    fn make_own(&mut self) -> Result<()> {
        if self.journal.own.is_some() {
            return Ok(());
        }
        self.say("the reference in f64");
        let exact = reference::most_exact(&self.subject.default, self.subject.scene);
        let reference = self.reference(&exact, "reference.pfm")?;
        self.journal.keep_own(reference)
    }

    /// Renders the reference of the sampling axis, the best that the time allows.
    fn make_fine(&mut self, default_seconds: f64) -> Result<()> {
        if self.journal.fine.is_some() {
            return Ok(());
        }
        let default = self.subject.default;
        let [double, single, plain] = reference::fine(&default, &reference::most_exact(&default, self.subject.scene));
        let times = (f64::from(reference::FINE) / f64::from(default.samples)).powi(2);
        let double_seconds = self.journal.own.as_ref().map_or(f64::INFINITY, |own| own.made.seconds) * times;
        // The cost of the exact choices in f32 is unknown; deep paths seldom cost more than four times as much.
        let [single_seconds, plain_seconds] = [4.0, 1.0].map(|factor| factor * default_seconds * times);
        let left = self.left();
        let chosen = [(double, double_seconds), (single, single_seconds), (plain, plain_seconds)]
            .into_iter()
            .zip([0.15, 0.15, 0.45])
            .find(|((_, seconds), share)| *seconds < share * left);
        let Some(((variant, _), _)) = chosen else {
            self.left_out.push(format!(
                "sampling against 16x16: it would take some {plain_seconds:.0} s; give more --limit or less --size"
            ));
            return Ok(());
        };
        self.say("16 x 16 rays a pixel");
        let reference = self.reference(&variant, "reference-16x16.pfm")?;
        self.journal.keep_fine(reference)
    }

    fn reference(&mut self, variant: &Variant, film: &str) -> Result<Reference> {
        let shot = self.engine.shoot(variant, self.watch.observer)?;
        let truncated = shot.outcome.truncated.pixels.as_flattened();
        let cut = truncated.iter().map(|&x| f64::from(x)).sum::<f64>() / truncated.len().max(1) as f64;
        let made = Made {
            variant: *variant,
            seconds: shot.seconds,
            cut,
            cut_most: f64::from(truncated.iter().fold(0.0_f32, |m, &x| m.max(x))),
            film: film.to_owned(),
        };
        Ok(Reference { film: shot.outcome.film, made })
    }

    fn keep_default(&mut self, shot: &Shot) -> Result<()> {
        let default = self.subject.default;
        let done = self.journal.find(&default);
        // A reference may have been added since.
        if done.is_some_and(|r| r.own.is_some() && r.fine.is_some() == self.journal.fine.is_some()) {
            return Ok(());
        }
        let kept = done.map_or_else(Vec::new, |r| r.seconds.clone());
        let mut record = self.judge(&default, shot, self.left() * 0.05)?;
        record.seconds = if kept.is_empty() { vec![shot.seconds] } else { kept };
        record.ratios = vec![1.0; record.seconds.len()];
        self.journal.keep(record, &shot.outcome.film)
    }

    /// Measures everything but the times of a variant. Condition tests take at most `seconds`.
    fn judge(&mut self, variant: &Variant, shot: &Shot, seconds: f64) -> Result<Record> {
        let until = Instant::now() + Duration::from_secs_f64(seconds.max(0.0));
        let film = &shot.outcome.film;
        let same_samples = variant.samples == self.subject.default.samples;
        let own = match &self.journal.own {
            Some(own) if same_samples => Some(Errors::of(film, &own.film, Some((&mut self.condition, until)))?),
            _ => None,
        };
        let fine = self.journal.fine.as_ref().map(|fine| Errors::of(film, &fine.film, None)).transpose()?;
        let change = match &self.default_film {
            Some(default) => {
                let c = image::compare(film, default, VISIBLE)?;
                Some(Change { rmse: c.rmse, max: c.max })
            }
            None => None,
        };
        let beside = if same_samples { &self.journal.own } else { &self.journal.fine };
        let ledger = beside.as_ref().map_or_else(Ledger::default, |r| Ledger::of(&shot.outcome, &r.film));
        Ok(Record {
            variant: *variant,
            seconds: Vec::new(),
            ratios: Vec::new(),
            walk_ratios: Vec::new(),
            settled: shot.lanes.map(|lanes| lanes.share()),
            build_seconds: shot.build_seconds,
            rays: (&shot.outcome.rays).into(),
            own,
            fine,
            change,
            ledger,
            film: film_name(variant),
        })
    }

    /// Measures variants that are not complete yet, several at a time.
    fn block(&mut self, name: &str, variants: &[Variant]) -> Result<()> {
        // One run of a long variant suffices if time is short.
        let enough = |r: &Record| {
            let fewest = if r.seconds.iter().any(|&s| s > LONG) { 1 } else { FEWEST_RUNS };
            r.ratios.len() >= fewest.min(self.subject.runs)
        };
        let done = |v: &Variant| self.journal.find(v).is_some_and(enough);
        let fresh: Vec<Variant> = variants.iter().filter(|v| !done(v)).copied().collect();
        self.portion.1 = self.portion.1.saturating_sub(variants.len() - fresh.len());
        for some in fresh.chunks(BLOCK) {
            let begin = Instant::now();
            // Share of the remaining time budget for this block.
            let share = self.left() * self.portion.0 / self.portion.1.max(some.len()) as f64 * some.len() as f64;
            self.portion.1 = self.portion.1.saturating_sub(some.len());
            let mut turns = Vec::new();
            for variant in some {
                let title = variant.name(&self.subject.default);
                let expected = self.expected(variant);
                // Even a single run must fit.
                if self.left() < expected {
                    self.late.push(title);
                    continue;
                }
                self.say(&title);
                match self.first(variant, ASKING * share / some.len() as f64) {
                    Ok(turn) => turns.push(turn),
                    Err(e) if e.is_refusal() => self.leave_out(&title, &e.to_string()),
                    Err(e) => return Err(e),
                }
            }
            let seconds = (share - begin.elapsed().as_secs_f64()).max(0.0);
            let ended = self.rounds(name, &mut turns, seconds);
            self.keep_turns(turns, ended.is_err())?;
            ended?;
        }
        Ok(())
    }

    /// Records why a variant is unavailable, once for all variants with the same reason.
    fn leave_out(&mut self, title: &str, why: &str) {
        let ending = format!(": {why}");
        match self.left_out.iter_mut().find(|line| line.ends_with(&ending)) {
            Some(line) => line.insert_str(line.len() - ending.len(), &format!(", {title}")),
            None => self.left_out.push(title.to_owned() + &ending),
        }
    }

    /// Estimated seconds for one run. Rough: most variants have not been measured yet.
    fn expected(&self, variant: &Variant) -> f64 {
        let default = self.journal.find(&self.subject.default).map_or(0.0, |r| r.seconds[0]);
        let rays = (f64::from(variant.samples) / f64::from(self.subject.default.samples)).powi(2);
        let double = match (variant.precision, &self.journal.own) {
            (Precision::Double, Some(own)) => own.made.seconds * 0.3,
            _ => 0.0,
        };
        (default * rays * 0.5).max(double * rays)
    }

    /// Renders and judges the first picture of a variant; if it takes long, its time counts.
    fn first(&mut self, variant: &Variant, asking: f64) -> Result<Turn> {
        // Rendered first, since the variant may be unavailable.
        let shot = self.engine.shoot(variant, self.watch.observer)?;
        let default = self.engine.shoot(&self.subject.default, self.watch.observer)?;
        let record = self.judge(variant, &shot, asking)?;
        let cost = (shot.seconds + default.seconds / BLOCK as f64).max(1e-9);
        let mut turn = Turn { record, film: shot.outcome.film, cost, wanted: 0 };
        if shot.seconds > LONG {
            turn.record.seconds.push(shot.seconds);
            turn.record.ratios.push(shot.seconds / default.seconds);
        }
        Ok(turn)
    }

    /// Runs rounds of default, A, B, C, default, default, A, B, C, default, ... until each variant has enough runs.
    fn rounds(&mut self, name: &str, turns: &mut [Turn], seconds: f64) -> Result<()> {
        let each = seconds / turns.len().max(1) as f64;
        let fewest = FEWEST_RUNS.min(self.subject.runs);
        for turn in turns.iter_mut() {
            let fewest = if turn.cost > LONG { 1 } else { fewest };
            turn.wanted = ((each / turn.cost) as usize).clamp(fewest, self.subject.runs.max(fewest));
        }
        let default = self.subject.default;
        let mut of_default = Vec::new();
        let result = (|| {
            for round in 1.. {
                if turns.iter().all(|t| t.record.ratios.len() >= t.wanted) || self.late() {
                    return Ok(());
                }
                self.say(&format!("{name}, round {round}"));
                let before = self.engine.shoot(&default, self.watch.observer)?.seconds;
                let mut round = Vec::new();
                let mut plain = None;
                for (i, turn) in turns.iter().enumerate().filter(|(_, t)| t.record.ratios.len() < t.wanted) {
                    let variant = turn.record.variant;
                    if let (None, Some(walk)) = (plain, variant.plain_walk()) {
                        plain = Some(self.engine.shoot(&walk, self.watch.observer)?.seconds);
                    }
                    round.push((i, self.engine.shoot(&variant, self.watch.observer)?.seconds));
                }
                // All variants of a round are compared with the default's time, so it is measured twice.
                let after = self.engine.shoot(&default, self.watch.observer)?.seconds;
                let beside = (before * after).sqrt();
                of_default.extend([before, after]);
                for (i, seconds) in round {
                    let record = &mut turns[i].record;
                    record.seconds.push(seconds);
                    record.ratios.push(seconds / beside);
                    record.walk_ratios.extend(plain.filter(|_| record.variant.walk().is_some()).map(|p| seconds / p));
                }
            }
            Ok(())
        })();
        if let Some(mut record) = self.journal.find(&default).cloned() {
            record.seconds.extend(of_default);
            record.ratios = vec![1.0; record.seconds.len()];
            self.journal.note(record)?;
        }
        result
    }

    fn keep_turns(&mut self, turns: Vec<Turn>, interrupted: bool) -> Result<()> {
        let fewest = if interrupted { FEWEST_RUNS } else { 1 };
        for turn in turns {
            if turn.record.ratios.len() >= fewest {
                self.journal.keep(turn.record, &turn.film)?;
            } else if !interrupted {
                self.late.push(turn.record.variant.name(&self.subject.default));
            }
        }
        Ok(())
    }

    fn points(&self) -> (Option<Point>, Vec<Point>) {
        let default = &self.subject.default;
        let rows = report::rows(&self.journal, default, |_| String::new());
        let point = |r: &report::Row| {
            let error = r.judged()?.ranked();
            Some(Point { variant: r.levels, ratio: r.ratio.median, same_time: r.same_time, mse: error * error })
        };
        let first = rows.iter().find(|r| r.levels == *default).and_then(point);
        let singles = rows.iter().filter(|r| r.axis.is_some_and(|a| a != Axis::Sampling.name()));
        (first, singles.filter_map(point).collect())
    }

    /// Measures the product of the axes that matter.
    fn combine(&mut self) -> Result<()> {
        let (Some(default), singles) = self.points() else { return Ok(()) };
        let products = plan::products(&default, &singles);
        if products.beaten > 0 {
            self.left_out.push(format!(
                "{} of {} combinations: others are predicted to be both faster and more right",
                products.beaten, products.all
            ));
        }
        self.portion = (0.7, products.variants.len());
        let mut late = 0;
        for some in products.variants.chunks(BLOCK) {
            if self.late() {
                late += some.iter().filter(|v| self.journal.find(v).is_none()).count();
                continue;
            }
            self.block("combinations", some)?;
        }
        if late > 0 {
            self.late.push(format!("{late} combinations"));
        }
        Ok(())
    }

    /// Measures the front at other numbers of rays per pixel.
    fn resample(&mut self) -> Result<()> {
        if self.journal.fine.is_none() {
            return Ok(());
        }
        let default = &self.subject.default;
        let rows = report::rows(&self.journal, default, |_| String::new());
        let mut front: Vec<_> = rows
            .iter()
            .filter(|r| r.front && r.levels != *default && r.levels.precision == default.precision)
            .map(|r| (r.ratio.median, r.levels))
            .collect();
        front.sort_by(|a, b| a.0.total_cmp(&b.0));
        let step = front.len().div_ceil(RESAMPLED).max(1);
        let bases: Vec<Variant> = front.iter().step_by(step).map(|(_, v)| *v).collect();
        let mut variants = Vec::new();
        for level in Axis::Sampling.levels() {
            let Level::Sampling(n) = level else { continue };
            if n != default.samples && n <= 4 * default.samples {
                variants.extend(bases.iter().map(|base| base.with(level)));
            }
        }
        self.portion = (0.9, variants.len());
        self.block("sampling and others", &variants)
    }
}

/// Variant that runs once per round.
struct Turn {
    record: Record,
    film: Film,
    /// Seconds of a run, including its share of the default's.
    cost: f64,
    /// Number of timed runs.
    wanted: usize,
}
