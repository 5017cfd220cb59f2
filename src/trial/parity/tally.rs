//! Counting findings.

use crate::accel::reference::{Cause, Fault, Verdict};

/// Every cause, in the order of [`Tally::undecidable`].
pub const CAUSES: [Cause; 5] = [Cause::Edge, Cause::Tie, Cause::Interval, Cause::Sliver, Cause::Crack];

/// Every fault, in the order of [`Tally::wrong`].
pub const FAULTS: [Fault; 7] = [
    Fault::MissedHit,
    Fault::FalseHit,
    Fault::OtherPrimitive,
    Fault::TOutOfBounds,
    Fault::OutsideInterval,
    Fault::Leak,
    Fault::SelfHit,
];

/// The name in reports.
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

/// The name in reports.
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

/// What an answer is found to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finding {
    /// What `f64` says.
    Agrees,
    /// Another one, where `f32` could not tell; the distance from flipping over the bound on the error, at most 1.
    Undecidable(Cause, f64),
    /// A hit whose `t` lies at or outside an end of the interval, by no more than its rounding. The contract forbids it.
    BeyondEnd,
    /// Another one, where `f32` had to know better.
    Wrong(Fault),
}

impl Finding {
    /// Whether the contract is broken.
    #[must_use]
    pub fn is_wrong(self) -> bool {
        matches!(self, Self::BeyondEnd | Self::Wrong(_))
    }

    /// The fault that has a name.
    #[must_use]
    pub fn fault(self) -> Option<Fault> {
        if let Self::Wrong(fault) = self { Some(fault) } else { None }
    }
}

impl From<Verdict> for Finding {
    fn from(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Agrees => Self::Agrees,
            Verdict::Undecidable(cause, margin) => Self::Undecidable(
                cause,
                // Zero of zero is no distance at all, and nothing is far from an error without bound.
                if margin.distance > 0.0 && margin.bound.is_finite() { margin.distance / margin.bound } else { 0.0 },
            ),
            Verdict::Wrong(fault) => Self::Wrong(fault),
        }
    }
}

/// Answers by what they were found to be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// All of them.
    pub answers: u64,
    /// The same as the arbiter's.
    pub agree: u64,
    /// Undecidable, by cause: [`CAUSES`].
    pub undecidable: [u64; 5],
    /// At or just outside an end of the interval.
    pub beyond_end: u64,
    /// Wrong, by fault: [`FAULTS`].
    pub wrong: [u64; 7],
    /// Over the undecidable ones, the largest distance from flipping in parts of its bound; at most 1.
    pub largest_margin: f64,
}

impl Tally {
    /// Counts one more.
    pub fn add(&mut self, finding: Finding) {
        self.answers += 1;
        match finding {
            Finding::Agrees => self.agree += 1,
            Finding::Undecidable(cause, margin) => {
                self.undecidable[cause as usize] += 1;
                self.largest_margin = self.largest_margin.max(margin);
            }
            Finding::BeyondEnd => self.beyond_end += 1,
            Finding::Wrong(fault) => self.wrong[fault as usize] += 1,
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

    /// Undecidable answers of every cause.
    #[must_use]
    pub fn all_undecidable(&self) -> u64 {
        self.undecidable.iter().sum()
    }

    /// Wrong answers of every fault; those beyond an end by a rounding are not among them.
    #[must_use]
    pub fn all_wrong(&self) -> u64 {
        self.wrong.iter().sum()
    }

    /// Answers that break the contract: wrong, or beyond an end.
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
            Finding::Agrees,
            Verdict::Undecidable(Cause::Tie, Margin { distance: 1.0, bound: 4.0 }).into(),
            Verdict::Undecidable(Cause::Edge, Margin { distance: 1.0, bound: f64::INFINITY }).into(),
            Finding::BeyondEnd,
            Finding::Wrong(Fault::Leak),
        ];
        let mut tally = Tally::default();
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
