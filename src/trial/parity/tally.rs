//! Counts of verdicts.

use crate::accel::reference::{Cause, Fault, Verdict};

/// All causes, in the order of [`VerdictCounts::undecidable`].
pub const CAUSES: [Cause; 5] = [Cause::Edge, Cause::Tie, Cause::Interval, Cause::Sliver, Cause::Crack];

/// All faults, in the order of [`VerdictCounts::wrong`].
pub const FAULTS: [Fault; 7] = [
    Fault::MissedHit,
    Fault::FalseHit,
    Fault::OtherPrimitive,
    Fault::TOutOfBounds,
    Fault::OutsideInterval,
    Fault::Leak,
    Fault::SelfHit,
];

/// Returns the name used in reports.
#[must_use]
pub fn cause_name(cause: Cause) -> &'static str {
    match cause {
        Cause::Edge => "edge",
        Cause::Tie => "tie",
        Cause::Interval => "interval",
        Cause::Sliver => "sliver",
        Cause::Crack => "crack",
    }
}

/// Returns the name used in reports.
#[must_use]
pub fn fault_name(fault: Fault) -> &'static str {
    match fault {
        Fault::MissedHit => "missed_hit",
        Fault::FalseHit => "false_hit",
        Fault::OtherPrimitive => "other_primitive",
        Fault::TOutOfBounds => "t_out_of_bounds",
        Fault::OutsideInterval => "outside_interval",
        Fault::Leak => "leak",
        Fault::SelfHit => "self_hit",
    }
}

/// Verdict on an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Judgement {
    /// Equal to the arbiter's answer.
    Agrees,
    /// Different where `f32` could not tell, with the distance from flipping relative to the bound on the error, at
    /// most 1.
    Undecidable(Cause, f64),
    /// Hit whose `t` lies at or outside an end of the interval, by no more than its rounding. The contract forbids it.
    BeyondEnd,
    /// Different where `f32` could tell.
    Wrong(Fault),
}

impl Judgement {
    /// Returns true if the answer breaks the contract.
    #[must_use]
    pub fn is_wrong(self) -> bool {
        matches!(self, Self::BeyondEnd | Self::Wrong(_))
    }

    /// Returns the fault of a wrong answer.
    #[must_use]
    pub fn fault(self) -> Option<Fault> {
        if let Self::Wrong(fault) = self { Some(fault) } else { None }
    }
}

impl From<Verdict> for Judgement {
    fn from(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Agrees => Self::Agrees,
            Verdict::Undecidable(cause, margin) => Self::Undecidable(
                cause,
                // 0 / 0 counts as distance 0, as does any distance under an unbounded error.
                if margin.distance > 0.0 && margin.bound.is_finite() { margin.distance / margin.bound } else { 0.0 },
            ),
            Verdict::Wrong(fault) => Self::Wrong(fault),
        }
    }
}

/// Numbers of answers by verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VerdictCounts {
    /// All answers.
    pub answers: u64,
    /// Answers equal to the arbiter's.
    pub agree: u64,
    /// Undecidable answers, in the order of [`CAUSES`].
    pub undecidable: [u64; 5],
    /// Hits at or just outside an end of the interval.
    pub beyond_end: u64,
    /// Wrong answers, in the order of [`FAULTS`].
    pub wrong: [u64; 7],
    /// Largest distance from flipping among undecidable answers, relative to its bound; at most 1.
    pub largest_margin: f64,
}

impl VerdictCounts {
    /// Counts one answer.
    pub fn add(&mut self, finding: Judgement) {
        self.answers += 1;
        match finding {
            Judgement::Agrees => self.agree += 1,
            Judgement::Undecidable(cause, margin) => {
                self.undecidable[cause as usize] += 1;
                self.largest_margin = self.largest_margin.max(margin);
            }
            Judgement::BeyondEnd => self.beyond_end += 1,
            Judgement::Wrong(fault) => self.wrong[fault as usize] += 1,
        }
    }

    /// Adds another count to this one.
    pub fn merge(&mut self, o: &Self) {
        self.answers += o.answers;
        self.agree += o.agree;
        self.undecidable.iter_mut().zip(o.undecidable).for_each(|(a, b)| *a += b);
        self.beyond_end += o.beyond_end;
        self.wrong.iter_mut().zip(o.wrong).for_each(|(a, b)| *a += b);
        self.largest_margin = self.largest_margin.max(o.largest_margin);
    }

    /// Returns the number of undecidable answers.
    #[must_use]
    pub fn all_undecidable(&self) -> u64 {
        self.undecidable.iter().sum()
    }

    /// Returns the number of wrong answers, excluding those beyond an end by a rounding.
    #[must_use]
    pub fn all_wrong(&self) -> u64 {
        self.wrong.iter().sum()
    }

    /// Returns the number of answers that break the contract: wrong, or beyond an end.
    #[must_use]
    pub fn broken(&self) -> u64 {
        self.all_wrong() + self.beyond_end
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::reference::Margin;

    #[test]
    fn lists_and_places_go_together() {
        for (i, cause) in CAUSES.into_iter().enumerate() {
            assert_eq!(cause as usize, i);
        }
        for (i, fault) in FAULTS.into_iter().enumerate() {
            assert_eq!(fault as usize, i);
        }
    }

    #[test]
    fn every_finding_is_counted_once_and_sums_add_up() {
        let findings = [
            Judgement::Agrees,
            Verdict::Undecidable(Cause::Tie, Margin { distance: 1.0, bound: 4.0 }).into(),
            Verdict::Undecidable(Cause::Edge, Margin { distance: 1.0, bound: f64::INFINITY }).into(),
            Judgement::BeyondEnd,
            Judgement::Wrong(Fault::Leak),
        ];
        let mut tally = VerdictCounts::default();
        findings.into_iter().for_each(|f| tally.add(f));
        assert_eq!((tally.answers, tally.agree, tally.all_undecidable(), tally.broken()), (5, 1, 2, 2));
        assert_eq!(
            (tally.undecidable, tally.wrong, tally.largest_margin),
            ([1, 1, 0, 0, 0], [0, 0, 0, 0, 0, 1, 0], 0.25)
        );
        let mut twice = tally;
        twice.merge(&tally);
        assert_eq!((twice.answers, twice.all_wrong(), twice.beyond_end), (10, 2, 2));
    }
}
