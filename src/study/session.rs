//! Session of a study: references, single axes, products and sampling.

use std::time::{Duration, Instant};

use super::axis::{Axis, Level};
use super::condition::Condition;
use super::energy::Ledger;
use super::engine::{Engine, Shot};
use super::errors::{Errors, VISIBLE};
use super::journal::{Change, Journal, Record, film_name};
use super::plan::{self, LeftOut, Point};
use super::reference::{self, Made, Reference};
use super::report;
use super::subject::{Subject, Watch};
use super::variant::Variant;
use crate::Result;
use crate::image::{self, Film};

/// Largest number of variants that take turns.
pub(super) const BLOCK: usize = 8;

/// Number of front members that are tried at other numbers of rays per pixel.
const RESAMPLED: usize = 4;

/// Session of a study: its measurements so far, and what is left of its time.
pub(super) struct Session<'a> {
    pub subject: &'a Subject<'a>,
    pub engine: Engine<'a>,
    pub condition: Condition<'a>,
    pub journal: Journal,
    pub watch: Watch<'a>,
    pub start: Instant,
    pub left_out: Vec<LeftOut>,
    /// Names of variants left out for lack of time.
    pub late: Vec<String>,
    /// Share of the remaining time for the variants still to come, and their number.
    pub portion: (f64, usize),
    /// Picture of the default variant.
    pub default_film: Option<Film>,
}

impl Session<'_> {
    pub fn left(&self) -> f64 {
        self.subject.limit.as_secs_f64() - self.start.elapsed().as_secs_f64()
    }

    pub fn late(&self) -> bool {
        self.left() <= 0.0
    }

    pub fn say(&self, what: &str) {
        (self.watch.say)(what);
    }

    /// Measures references, single axes, products and sampling.
    pub fn all(&mut self) -> Result<()> {
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

    /// Records why a variant is unavailable, once for all variants with the same reason.
    pub fn leave_out(&mut self, title: &str, why: &str) {
        match self.left_out.iter_mut().find(|one| one.why == why) {
            Some(one) => one.titles.push(title.to_owned()),
            None => self.left_out.push(LeftOut::new(title, why)),
        }
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
            let why = format!("it would take some {plain_seconds:.0} s; give more time or a smaller size");
            self.left_out.push(LeftOut::new("sampling against 16x16", why));
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
    pub fn judge(&mut self, variant: &Variant, shot: &Shot, seconds: f64) -> Result<Record> {
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
            let title = format!("{} of {} combinations", products.beaten, products.all);
            self.left_out.push(LeftOut::new(title, "others are predicted to be both faster and more right"));
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
