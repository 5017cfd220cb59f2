//! What surrounds a ray: stacks of media with priorities, interned, so that a lane carries one small number.
//!
//! Nested dielectrics after Schmidt & Budge 2002 ("Simple nested dielectrics in ray traced images"), with a rule for
//! surfaces left that were never entered; `src/README.md`, "What a ray does", step 3, states all of it.

use std::collections::HashMap;

use crate::optics::Boundary;
use crate::scene::{Medium, Rgb};

/// An interned stack; its meaning is local to one [`MediaTable`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct StackId(u32);

/// Stacks that one table holds before it refuses more: far above any scene, and a bound on its memory.
const MOST_STACKS: usize = 1 << 16;

/// What crossing a dielectric surface does.
#[derive(Clone, Copy, Debug)]
pub struct Transition {
    /// Whether there is a boundary at all; if not, the ray goes straight on in `beyond`.
    pub real: bool,
    /// The boundary, from the medium the ray is in to the one beyond.
    pub boundary: Boundary<f32>,
    /// The same boundary seen from its thinner side, for light that crosses unbent.
    pub thin_side: Boundary<f32>,
    /// The stack of a ray that crosses.
    pub beyond: StackId,
    /// Whether the ray leaves a medium that it never entered.
    pub unmatched: bool,
}

/// Interned stacks, their top media, and every transition met so far. One a thread: ids never leave it.
#[derive(Debug)]
pub struct MediaTable<'a> {
    media: &'a [Medium],
    stacks: Vec<Vec<u32>>,
    ids: HashMap<Vec<u32>, StackId>,
    /// By stack, then `medium * 2 + entering`.
    transitions: Vec<Vec<Option<Transition>>>,
    tops: Vec<Top>,
}

/// What the medium on top of a stack does to a ray inside it.
#[derive(Clone, Copy, Debug)]
struct Top {
    medium: u32,
    absorption: Rgb,
    absorbs: bool,
}

impl<'a> MediaTable<'a> {
    /// A table over the scene's media, of which the first surrounds everything.
    #[must_use]
    pub fn new(media: &'a [Medium]) -> Self {
        let mut table =
            Self { media, stacks: Vec::new(), ids: HashMap::new(), transitions: Vec::new(), tops: Vec::new() };
        // The empty stack is id 0, the default.
        table.intern(Vec::new());
        table
    }

    /// The stack of a ray that entered `entered` in this order.
    pub fn stack_of(&mut self, entered: &[u32]) -> StackId {
        let mut stack = Vec::new();
        for &m in entered {
            insert(&mut stack, m, self.media);
        }
        self.intern(stack)
    }

    /// The media a ray with this stack has entered, highest priority last.
    #[must_use]
    pub fn entered(&self, stack: StackId) -> &[u32] {
        &self.stacks[stack.0 as usize]
    }

    /// The medium a ray with this stack is in.
    #[inline]
    #[must_use]
    pub fn top(&self, stack: StackId) -> u32 {
        self.tops[stack.0 as usize].medium
    }

    /// Its index of refraction.
    #[inline]
    #[must_use]
    pub fn ior(&self, stack: StackId) -> f64 {
        self.media[self.top(stack) as usize].ior
    }

    /// Its absorption per scene unit; `None` where it absorbs nothing.
    #[inline]
    #[must_use]
    pub fn absorption(&self, stack: StackId) -> Option<Rgb> {
        let top = &self.tops[stack.0 as usize];
        top.absorbs.then_some(top.absorption)
    }

    /// What happens to a ray in `stack` at a surface of `medium`, which it enters or leaves.
    #[inline]
    pub fn cross(&mut self, stack: StackId, medium: u32, entering: bool) -> Transition {
        let slot = medium as usize * 2 + usize::from(entering);
        if let Some(known) = self.transitions[stack.0 as usize][slot] {
            return known;
        }
        let new = self.resolve(stack, medium, entering);
        self.transitions[stack.0 as usize][slot] = Some(new);
        new
    }

    fn resolve(&mut self, stack: StackId, medium: u32, entering: bool) -> Transition {
        let mut list = self.stacks[stack.0 as usize].clone();
        let current = self.top(stack);
        let ior = |m: u32| self.media[m as usize].ior;
        let (real, n1, n2, unmatched) = if entering {
            let real = self.media[medium as usize].priority >= self.media[current as usize].priority;
            insert(&mut list, medium, self.media);
            (real, ior(current), ior(medium), false)
        } else if let Some(at) = list.iter().rposition(|&m| m == medium) {
            list.remove(at);
            (medium == current, ior(medium), ior(filling(&list, self.media)), false)
        } else {
            (true, ior(medium), ior(current), true)
        };
        // A table that is full keeps the ray in its stack: wrong media in a scene of 65,536 nestings, but bounded.
        let beyond = if self.stacks.len() < MOST_STACKS { self.intern(list) } else { stack };
        let thin_side = Boundary::new(n1.min(n2), n1.max(n2));
        Transition { real, boundary: Boundary::new(n1, n2), thin_side, beyond, unmatched }
    }

    fn intern(&mut self, stack: Vec<u32>) -> StackId {
        if let Some(&id) = self.ids.get(&stack) {
            return id;
        }
        let id = StackId(self.stacks.len() as u32);
        let medium = filling(&stack, self.media);
        let absorption = self.media[medium as usize].absorption;
        self.tops.push(Top { medium, absorption, absorbs: absorption != Rgb::ZERO });
        self.transitions.push(vec![None; self.media.len() * 2]);
        self.ids.insert(stack.clone(), id);
        self.stacks.push(stack);
        id
    }
}

/// Puts `medium` where its priority belongs: above all of its own priority or lower, below all of higher. The top is
/// the end of the list.
fn insert(stack: &mut Vec<u32>, medium: u32, media: &[Medium]) {
    let priority = media[medium as usize].priority;
    let at = stack.partition_point(|&m| media[m as usize].priority <= priority);
    stack.insert(at, medium);
}

/// The medium that fills space where `stack` has been entered: its top, unless what surrounds everything comes before
/// that.
fn filling(stack: &[u32], media: &[Medium]) -> u32 {
    stack.last().copied().filter(|&m| media[m as usize].priority >= media[0].priority).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn medium(name: &str, ior: f64, priority: i32) -> Medium {
        Medium { name: name.into(), ior, absorption: Rgb::ZERO, priority }
    }

    /// Air, glass, water, ice: ice in water in a glass, with ice above glass above water.
    fn drink() -> Vec<Medium> {
        vec![Medium::air(), medium("glass", 1.5, 10), medium("water", 1.33, 5), medium("ice", 1.31, 20)]
    }

    #[test]
    fn water_that_overlaps_its_glass_begins_where_the_glass_ends() {
        let media = drink();
        let mut table = MediaTable::new(&media);
        let air = StackId::default();
        // Into the glass wall: air to glass.
        let into_glass = table.cross(air, 1, true);
        assert!(into_glass.real);
        assert!((into_glass.boundary.eta - 1.0 / 1.5).abs() < 1e-6);
        // The water's surface inside the wall is not there.
        let water_in_wall = table.cross(into_glass.beyond, 2, true);
        assert!(!water_in_wall.real);
        assert_eq!(table.top(water_in_wall.beyond), 1);
        // Leaving the wall: glass to water.
        let into_water = table.cross(water_in_wall.beyond, 1, false);
        assert!(into_water.real);
        assert!((into_water.boundary.eta - (1.5 / 1.33) as f32).abs() < 1e-6);
        assert_eq!(table.top(into_water.beyond), 2);
        // Ice wins over water, and gives it back.
        let into_ice = table.cross(into_water.beyond, 3, true);
        assert!(into_ice.real);
        let out_of_ice = table.cross(into_ice.beyond, 3, false);
        assert_eq!(out_of_ice.beyond, into_water.beyond);
    }

    /// Case AB-08 of the catalogue.
    #[test]
    fn leaving_what_was_never_entered_is_counted_and_does_not_underflow() {
        let media = drink();
        let mut table = MediaTable::new(&media);
        let t = table.cross(StackId::default(), 1, false);
        assert!(t.real && t.unmatched);
        assert_eq!(t.beyond, StackId::default());
        assert!((t.boundary.eta - 1.5).abs() < 1e-6);
    }

    #[test]
    fn entering_twice_needs_leaving_twice() {
        let media = drink();
        let mut table = MediaTable::new(&media);
        let once = table.cross(StackId::default(), 1, true).beyond;
        let twice = table.cross(once, 1, true);
        assert!(twice.real, "among equals the latest wins");
        assert_eq!(twice.boundary.kc, 0.0, "glass to glass is no boundary to see");
        assert_eq!(table.cross(twice.beyond, 1, false).beyond, once);
        assert_eq!(table.cross(once, 1, false).beyond, StackId::default());
    }

    #[test]
    fn an_onion_of_a_hundred_shells_interns_a_hundred_and_one_stacks() {
        let media: Vec<Medium> = std::iter::once(Medium::air())
            .chain((1..=100).map(|i| medium("shell", 1.0 + f64::from(i) * 0.01, i)))
            .collect();
        let mut table = MediaTable::new(&media);
        let mut stack = StackId::default();
        for m in 1..=100 {
            stack = table.cross(stack, m, true).beyond;
            assert_eq!(table.top(stack), m);
        }
        for m in (1..=100).rev() {
            stack = table.cross(stack, m, false).beyond;
        }
        assert_eq!(stack, StackId::default());
        assert_eq!(table.stacks.len(), 101);
    }
}
