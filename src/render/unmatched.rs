//! Unmatched exits: rays that left a medium they had never entered, by object.

use std::collections::BTreeMap;

/// Number of unmatched exits by object. Causes are open or inside-out surfaces, or an earlier hit that was missed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnmatchedExits(BTreeMap<u32, u64>);

impl UnmatchedExits {
    /// Counts one exit. Out of line, because exits are rare.
    #[cold]
    #[inline(never)]
    pub(super) fn add(&mut self, object: u32) {
        *self.0.entry(object).or_default() += 1;
    }

    /// Adds another count to this one.
    pub(super) fn merge(&mut self, o: &Self) {
        for (&object, &n) in &o.0 {
            *self.0.entry(object).or_default() += n;
        }
    }

    /// Returns the number of exits through all objects.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.0.values().sum()
    }

    /// Returns the objects with their number of exits, the worst first; equal counts keep the order of the scene.
    #[must_use]
    pub fn worst_first(&self) -> Vec<(u32, u64)> {
        let mut objects: Vec<(u32, u64)> = self.0.iter().map(|(&object, &n)| (object, n)).collect();
        objects.sort_by_key(|&(_, n)| std::cmp::Reverse(n));
        objects
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_come_worst_first_and_sum_to_the_total() {
        let (mut one, mut other) = (UnmatchedExits::default(), UnmatchedExits::default());
        [3, 1, 1].into_iter().for_each(|object| one.add(object));
        [7, 1, 3, 7].into_iter().for_each(|object| other.add(object));
        one.merge(&other);
        assert_eq!((one.total(), one.worst_first()), (7, vec![(1, 3), (3, 2), (7, 2)]));
        assert_eq!(UnmatchedExits::default().total(), 0);
    }
}
