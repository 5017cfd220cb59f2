//! Bounded work: rays that touch ten thousands of shapes at once must not hold up a run for hours.

/// Work that may still be done, counted and not timed, so that the same is left out on every machine. A unit is about
/// ten nanoseconds: a box entered is one, a shape tested four, a contact found sixteen.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    left: u64,
}

impl Budget {
    pub(super) const BOX: u64 = 1;
    pub(super) const TEST: u64 = 4;
    pub(super) const CONTACT: u64 = 16;

    /// A budget of so many units.
    #[must_use]
    pub fn new(units: u64) -> Self {
        Self { left: units }
    }

    /// More than any run can spend.
    #[must_use]
    pub fn unlimited() -> Self {
        Self { left: u64::MAX }
    }

    /// The units left.
    #[must_use]
    pub fn left(&self) -> u64 {
        self.left
    }

    /// Returns true if nothing is left.
    #[must_use]
    pub fn is_spent(&self) -> bool {
        self.left == 0
    }

    /// Takes `units` away, or all that is left.
    pub fn spend(&mut self, units: u64) {
        self.left = self.left.saturating_sub(units);
    }
}
