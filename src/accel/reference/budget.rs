//! Limit on work, because rays that touch ten thousand shapes at once would take hours.

/// Work that may still be done. It is counted and not timed, so that every machine leaves out the same. A unit takes
/// about ten nanoseconds. A box entered costs 1, a shape tested 4, a contact found 16.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    left: u64,
}

impl Budget {
    pub(super) const BOX: u64 = 1;
    pub(super) const TEST: u64 = 4;
    pub(super) const CONTACT: u64 = 16;

    /// Creates a budget of so many units.
    #[must_use]
    pub fn new(units: u64) -> Self {
        Self { left: units }
    }

    /// Creates a budget that no run can use up.
    #[must_use]
    pub fn unlimited() -> Self {
        Self { left: u64::MAX }
    }

    /// Number of units left.
    #[must_use]
    pub fn left(&self) -> u64 {
        self.left
    }

    /// Returns true if nothing is left.
    #[must_use]
    pub fn is_spent(&self) -> bool {
        self.left == 0
    }

    /// Subtracts `units`, or all that is left.
    pub fn spend(&mut self, units: u64) {
        self.left = self.left.saturating_sub(units);
    }
}
