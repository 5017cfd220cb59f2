//! Sets of effects.

use super::Effect;

/// A set of effects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct EffectSet(u32);

impl EffectSet {
    /// No effect.
    pub const EMPTY: Self = Self(0);

    /// Every effect.
    #[must_use]
    pub fn all() -> Self {
        Effect::ALL.into_iter().collect()
    }

    /// Returns true if the set holds an effect.
    #[must_use]
    pub fn has(self, effect: Effect) -> bool {
        self.0 >> effect as u32 & 1 != 0
    }

    /// Returns true if the set is empty.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Returns the set with an effect added.
    #[must_use]
    pub fn with(self, effect: Effect) -> Self {
        Self(self.0 | 1 << effect as u32)
    }

    /// Returns all effects that are not in the set.
    #[must_use]
    pub fn complement(self) -> Self {
        Self(Self::all().0 & !self.0)
    }

    /// Returns the union of both sets.
    #[must_use]
    pub fn union(self, o: Self) -> Self {
        Self(self.0 | o.0)
    }

    /// Returns the intersection of both sets.
    #[must_use]
    pub fn intersection(self, o: Self) -> Self {
        Self(self.0 & o.0)
    }

    /// Iterates over the effects in the order of [`Effect::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Effect> {
        Effect::ALL.into_iter().filter(move |&e| self.has(e))
    }
}

impl FromIterator<Effect> for EffectSet {
    fn from_iter<T: IntoIterator<Item = Effect>>(effects: T) -> Self {
        effects.into_iter().fold(Self::EMPTY, Self::with)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_and_its_complement_share_nothing_and_are_everything() {
        let some: EffectSet = [Effect::Ambient, Effect::Alpha].into_iter().collect();
        assert!(some.has(Effect::Alpha) && !some.has(Effect::Mirror));
        assert!(some.intersection(some.complement()).is_empty());
        assert_eq!(some.union(some.complement()), EffectSet::all());
        assert_eq!(some.iter().collect::<Vec<_>>(), [Effect::Ambient, Effect::Alpha]);
        assert!(Effect::ALL.len() <= 32, "the set is 32 bits wide");
    }

    #[test]
    fn every_effect_goes_by_its_name() {
        for effect in Effect::ALL {
            assert_eq!(Effect::named(effect.name()), Some(effect));
        }
        assert_eq!(Effect::named("refracton"), None);
    }
}
