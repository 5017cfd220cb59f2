//! Measurement of variants by turns: rounds in which each variant is timed beside the default.

use std::time::Instant;

use super::axis::Precision;
use super::journal::Record;
use super::session::{BLOCK, Session};
use super::variant::Variant;
use crate::Result;
use crate::image::Film;

/// Smallest number of runs for a meaningful interval.
const FEWEST_RUNS: usize = 3;

/// Time in seconds above which a render needs no warm-up, and one run suffices if time is short.
const LONG: f64 = 1.0;

/// Condition tests use at most this share of a variant's render time.
const ASKING: f64 = 0.25;

/// Variant that runs once per round.
struct Turn {
    record: Record,
    film: Film,
    /// Seconds of a run, including its share of the default's.
    cost: f64,
    /// Number of timed runs.
    wanted: usize,
}

impl Session<'_> {
    /// Measures variants that are not complete yet, several at a time.
    pub fn block(&mut self, name: &str, variants: &[Variant]) -> Result<()> {
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
}
