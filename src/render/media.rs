//! Media around a ray: interned stacks of media with priorities, so that a lane carries one small number.
//!
//! Nested dielectrics after Schmidt & Budge 2002 ("Simple nested dielectrics in ray traced images"), with a rule for
//! leaving a surface that was never entered. `src/README.md`, "What a ray does", step 3, states all rules.
//!
//! The wavelength of a ray is part of its stack: a red ray in glass has another stack than a blue or a white one. So
//! every table here holds the indices for that wavelength, and rays carry no further field for it.

use std::collections::HashMap;

use crate::optics::{Boundary, Spectrum};
use crate::scene::{Bodies, Medium, Rgb};

/// Index of an interned stack within one [`MediaTable`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct StackId(u32);

/// Index of a fan of wavelengths within one [`MediaTable`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FanId(u32);

/// Number of stacks above which a table is cleared before the next sample.
const MANY_STACKS: usize = 1 << 12;

/// Number of stacks above which a table interns no more. Far above any scene; bounds the memory.
const MOST_STACKS: usize = 1 << 16;

/// Effect of crossing a dielectric surface.
#[derive(Clone, Copy, Debug)]
pub struct Transition {
    /// True if the surface is a boundary between media. Otherwise the ray passes straight on in `beyond`.
    pub real: bool,
    /// Boundary from the ray's medium to the one beyond.
    pub boundary: Boundary<f32>,
    /// The same boundary seen from its optically thinner side, for light that crosses without bending.
    pub thin_side: Boundary<f32>,
    /// Stack of a ray that crosses.
    pub beyond: StackId,
    /// True if the ray leaves a medium that it never entered.
    pub unmatched: bool,
    /// Fan of wavelengths, where white light crosses into or out of a dispersive medium.
    pub fan: Option<FanId>,
    /// Indices of the media before and behind the surface.
    pub media: [u32; 2],
}

/// Boundaries for all wavelengths of the current set.
#[derive(Clone, Debug, Default)]
pub struct Fan {
    /// Bands by rising wavelength.
    pub bands: Vec<Band>,
    /// Indices of the bands with the smallest and the largest ratio of refractive indices: those refracted least and
    /// most.
    pub outermost: [usize; 2],
}

/// One wavelength at a boundary.
#[derive(Clone, Copy, Debug)]
pub struct Band {
    /// Boundary for this wavelength.
    pub boundary: Boundary<f32>,
    /// Stack of a ray of this wavelength that crosses.
    pub beyond: StackId,
}

/// Interned stacks, their top media, and every transition found so far. Each thread has its own; ids never leave it.
#[derive(Debug)]
pub struct MediaTable<'a> {
    media: &'a [Medium],
    bodies: &'a Bodies,
    /// Wavelengths that white light divides into. `None` if white light never divides.
    spectrum: Option<Spectrum>,
    /// Index of the wavelength set of the current sample.
    set: usize,
    stacks: Vec<Stack>,
    ids: HashMap<Stack, StackId>,
    /// By stack, then by `body * 2 + entering`.
    transitions: Vec<Vec<Option<Transition>>>,
    /// By stack and the (body, entering) pairs of coinciding surfaces.
    joint: HashMap<(StackId, Vec<(u32, bool)>), Transition>,
    tops: Vec<Top>,
    /// By fan: its boundary.
    plans: Vec<Plan>,
    /// By fan, then by wavelength set. Without bands until computed.
    fans: Vec<Vec<Fan>>,
}

/// Bodies a ray has entered, by rising rank, and its wavelength. Wavelength 0 is white; the others are counted through
/// all sets.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Stack {
    entered: Vec<u32>,
    wave: u32,
}

/// Boundary that may separate wavelengths: the media on both sides, and the bodies that a ray behind it has entered.
#[derive(Clone, Debug)]
struct Plan {
    from: u32,
    to: u32,
    entered: Vec<u32>,
}

/// Optical properties of the medium on top of a stack.
#[derive(Clone, Copy, Debug)]
struct Top {
    medium: u32,
    ior: f64,
    absorption: Rgb,
    absorbs: bool,
}

impl<'a> MediaTable<'a> {
    /// Creates a table over the scene's media. The first medium surrounds everything. White light stays white.
    #[must_use]
    pub fn new(media: &'a [Medium], bodies: &'a Bodies) -> Self {
        let mut table = Self {
            media,
            bodies,
            spectrum: None,
            set: 0,
            stacks: Vec::new(),
            ids: HashMap::new(),
            transitions: Vec::new(),
            joint: HashMap::new(),
            tops: Vec::new(),
            plans: Vec::new(),
            fans: Vec::new(),
        };
        table.clear();
        table
    }

    /// Creates a table that divides white light where media disperse it.
    #[must_use]
    pub fn dispersing(media: &'a [Medium], bodies: &'a Bodies, spectrum: Spectrum) -> Self {
        Self { spectrum: Some(spectrum), ..Self::new(media, bodies) }
    }

    /// Returns true if the table divides white light.
    #[must_use]
    pub fn disperses(&self) -> bool {
        self.spectrum.is_some()
    }

    /// Prepares for the `sample`th camera rays of the pixels, and selects their wavelengths. Invalidates all stacks and
    /// fans of earlier samples.
    pub fn begin_sample(&mut self, sample: u32) {
        if let Some(spectrum) = &self.spectrum {
            self.set = spectrum.set_of(sample);
            if self.stacks.len() > MANY_STACKS {
                self.clear();
            }
        }
    }

    fn clear(&mut self) {
        self.stacks.clear();
        self.ids.clear();
        self.transitions.clear();
        self.joint.clear();
        self.tops.clear();
        self.plans.clear();
        self.fans.clear();
        // The empty stack is id 0, the default.
        self.intern(Stack { entered: Vec::new(), wave: 0 });
    }

    /// Returns the stack of a white ray that entered these bodies.
    pub fn stack_of(&mut self, entered: &[u32]) -> StackId {
        let mut stack = Vec::new();
        for &body in entered {
            insert(&mut stack, body, self.bodies);
        }
        self.intern(Stack { entered: stack, wave: 0 })
    }

    /// Returns the media that a ray with this stack has entered. The last one fills the space around it.
    #[must_use]
    pub fn entered(&self, stack: StackId) -> Vec<u32> {
        self.stacks[stack.0 as usize].entered.iter().map(|&body| self.bodies.medium(body)).collect()
    }

    /// Returns the medium that a ray with this stack is in.
    #[inline]
    #[must_use]
    pub fn top(&self, stack: StackId) -> u32 {
        self.tops[stack.0 as usize].medium
    }

    /// Returns the refractive index of the top medium at the ray's wavelength.
    #[inline]
    #[must_use]
    pub fn ior(&self, stack: StackId) -> f64 {
        self.tops[stack.0 as usize].ior
    }

    /// Returns the absorption of the top medium per scene unit, or `None` if it absorbs nothing.
    #[inline]
    #[must_use]
    pub fn absorption(&self, stack: StackId) -> Option<Rgb> {
        let top = &self.tops[stack.0 as usize];
        top.absorbs.then_some(top.absorption)
    }

    /// Returns the body of a transparent object, or `None` if it bounds no medium.
    #[inline]
    #[must_use]
    pub fn body_of(&self, object: u32) -> Option<u32> {
        self.bodies.of_object(object)
    }

    /// Returns the transition of a ray in `stack` that enters or leaves `body`.
    #[inline]
    pub fn cross(&mut self, stack: StackId, body: u32, entering: bool) -> Transition {
        let slot = body as usize * 2 + usize::from(entering);
        if let Some(known) = self.transitions[stack.0 as usize][slot] {
            return known;
        }
        let new = self.resolve(stack, body, entering);
        self.transitions[stack.0 as usize][slot] = Some(new);
        new
    }

    /// Returns the transition of a ray in `stack` where surfaces of several bodies coincide. All bodies left are
    /// removed and all bodies entered are added. The media before and behind then form one boundary, or none if they
    /// are alike.
    pub fn cross_all(&mut self, stack: StackId, surfaces: &[(u32, bool)]) -> Transition {
        let key = (stack, surfaces.to_vec());
        if let Some(known) = self.joint.get(&key) {
            return *known;
        }
        let Stack { entered: mut list, wave } = self.stacks[stack.0 as usize].clone();
        let mut unmatched = None;
        for &(body, _) in surfaces.iter().filter(|&&(_, entering)| !entering) {
            match self.place_of(&list, body) {
                Some(at) => drop(list.remove(at)),
                None => unmatched = Some(body),
            }
        }
        for &(body, _) in surfaces.iter().filter(|&&(_, entering)| entering) {
            insert(&mut list, body, self.bodies);
        }
        let mut from = self.top(stack);
        // If nothing is entered, a medium left without having been entered counts as the medium around the ray.
        if let (Some(body), true) = (unmatched, surfaces.iter().all(|&(_, entering)| !entering)) {
            from = self.bodies.medium(body);
        }
        let to = filling(&list, self.bodies, self.media);
        let real = !self.media[from as usize].is_like(&self.media[to as usize]);
        let new = self.transition(stack, Stack { entered: list, wave }, [from, to], real, unmatched.is_some());
        self.joint.insert(key, new);
        new
    }

    /// Returns the number of wavelengths that a white ray divides into.
    #[must_use]
    pub fn bands(&self) -> usize {
        self.spectrum.as_ref().map_or(0, |s| s.sets()[self.set].nm.len())
    }

    /// Returns the colour that the `k`th wavelength of the current set contributes to white, per channel.
    #[must_use]
    pub fn band_weight(&self, k: usize) -> Rgb {
        self.spectrum.as_ref().map_or(Rgb::ZERO, |s| s.sets()[self.set].weight[k].into())
    }

    /// Computes a fan for the current set, so that [`MediaTable::known_fan`] can return it.
    #[inline]
    pub fn learn_fan(&mut self, id: FanId) {
        let (fan, set) = (id.0 as usize, self.set);
        if self.fans[fan][set].bands.is_empty() {
            self.fans[fan][set] = self.spread(fan);
        }
    }

    /// Returns a fan for the current set; [`MediaTable::learn_fan`] must have computed it.
    #[inline]
    #[must_use]
    pub fn known_fan(&self, id: FanId) -> &Fan {
        &self.fans[id.0 as usize][self.set]
    }

    /// Returns the position in `list` that leaving `body` removes: its own entry, else another one of the same medium.
    fn place_of(&self, list: &[u32], body: u32) -> Option<usize> {
        let medium = self.bodies.medium(body);
        let own = list.iter().rposition(|&b| b == body);
        own.or_else(|| list.iter().rposition(|&b| self.bodies.medium(b) == medium))
    }

    fn resolve(&mut self, stack: StackId, body: u32, entering: bool) -> Transition {
        let Stack { entered: mut list, wave } = self.stacks[stack.0 as usize].clone();
        let medium = self.bodies.medium(body);
        let current = self.top(stack);
        let (real, sides, unmatched) = if entering {
            let real = self.fills(&list, body);
            insert(&mut list, body, self.bodies);
            (real, [current, medium], false)
        } else if let Some(at) = self.place_of(&list, body) {
            let top = at + 1 == list.len() && medium == current;
            list.remove(at);
            (top, [medium, filling(&list, self.bodies, self.media)], false)
        } else {
            (true, [medium, current], true)
        };
        self.transition(stack, Stack { entered: list, wave }, sides, real, unmatched)
    }

    /// Returns true if `body` fills the space where it is entered by a ray that has entered `list`.
    fn fills(&self, list: &[u32], body: u32) -> bool {
        let priority = |m: u32| self.media[m as usize].priority;
        priority(self.bodies.medium(body)) >= priority(0)
            && list.last().is_none_or(|&top| self.bodies.rank(body) >= self.bodies.rank(top))
    }

    /// Returns the boundary between two media at the wavelength of `after`, with a fan if the ray is white.
    fn transition(
        &mut self,
        before: StackId,
        after: Stack,
        [from, to]: [u32; 2],
        real: bool,
        unmatched: bool,
    ) -> Transition {
        let wave = after.wave;
        let disperses = |m: u32| self.media[m as usize].disperses();
        let parts = real && wave == 0 && self.spectrum.is_some() && (disperses(from) || disperses(to));
        let fan = parts.then(|| {
            let sets = self.spectrum.as_ref().map_or(0, |s| s.sets().len());
            self.plans.push(Plan { from, to, entered: after.entered.clone() });
            self.fans.push(vec![Fan::default(); sets]);
            FanId(self.plans.len() as u32 - 1)
        });
        let (n1, n2) = (self.index(from, wave), self.index(to, wave));
        let beyond = self.beyond(before, after);
        let thin_side = Boundary::new(n1.min(n2), n1.max(n2));
        Transition { real, boundary: Boundary::new(n1, n2), thin_side, beyond, unmatched, fan, media: [from, to] }
    }

    fn spread(&mut self, fan: usize) -> Fan {
        let Plan { from, to, entered } = self.plans[fan].clone();
        let count = self.bands() as u32;
        let first = 1 + self.set as u32 * count;
        let (mut bands, mut ratios) = (Vec::new(), Vec::new());
        for wave in first..first + count {
            let (n1, n2) = (self.index(from, wave), self.index(to, wave));
            let beyond = self.beyond(StackId::default(), Stack { entered: entered.clone(), wave });
            bands.push(Band { boundary: Boundary::new(n1, n2), beyond });
            ratios.push(n1 / n2);
        }
        let by_ratio = |a: &usize, b: &usize| ratios[*a].total_cmp(&ratios[*b]);
        let [least, most] = [(0..bands.len()).min_by(by_ratio), (0..bands.len()).max_by(by_ratio)];
        Fan { bands, outermost: [least.unwrap_or(0), most.unwrap_or(0)] }
    }

    /// Returns the index of a medium at a wavelength; `wave` = 0, white, gives the index at the line d.
    fn index(&self, medium: u32, wave: u32) -> f64 {
        let medium = &self.media[medium as usize];
        match (&self.spectrum, wave) {
            (Some(spectrum), 1..) => {
                let bands = spectrum.sets()[0].nm.len();
                let wave = wave as usize - 1;
                medium.index_at(spectrum.sets()[wave / bands].nm[wave % bands])
            }
            _ => medium.ior,
        }
    }

    /// Interns `stack`, or returns `before` if the table is full. A scene with over 65,536 nestings then gets wrong
    /// media, but bounded memory.
    fn beyond(&mut self, before: StackId, stack: Stack) -> StackId {
        if self.stacks.len() < MOST_STACKS { self.intern(stack) } else { before }
    }

    fn intern(&mut self, stack: Stack) -> StackId {
        if let Some(&id) = self.ids.get(&stack) {
            return id;
        }
        let id = StackId(self.stacks.len() as u32);
        let medium = filling(&stack.entered, self.bodies, self.media);
        let ior = self.index(medium, stack.wave);
        let absorption = self.media[medium as usize].absorption;
        self.tops.push(Top { medium, ior, absorption, absorbs: absorption != Rgb::ZERO });
        self.transitions.push(vec![None; self.bodies.count() * 2]);
        self.ids.insert(stack.clone(), id);
        self.stacks.push(stack);
        id
    }
}

/// Inserts `body` by rank: above all bodies of equal or lower rank, below all of higher rank. The top is the end of the
/// list.
fn insert(stack: &mut Vec<u32>, body: u32, bodies: &Bodies) {
    let rank = bodies.rank(body);
    let at = stack.partition_point(|&b| bodies.rank(b) <= rank);
    stack.insert(at, body);
}

/// Returns the medium that fills the space inside the bodies of `stack`: that of the top, unless medium 0 has a higher
/// priority.
fn filling(stack: &[u32], bodies: &Bodies, media: &[Medium]) -> u32 {
    let top = stack.last().map(|&body| bodies.medium(body));
    top.filter(|&m| media[m as usize].priority >= media[0].priority).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Dispersion;

    fn medium(name: &str, ior: f64, priority: i32) -> Medium {
        Medium { name: name.into(), ior, dispersion: Dispersion::None, absorption: Rgb::ZERO, priority }
    }

    /// Air, glass, water, ice. Ice floats in water in a glass; ice has priority over glass, and glass over water.
    fn drink() -> Vec<Medium> {
        vec![Medium::air(), medium("glass", 1.5, 10), medium("water", 1.33, 5), medium("ice", 1.31, 20)]
    }

    #[test]
    fn water_that_overlaps_its_glass_begins_where_the_glass_ends() {
        let media = drink();
        let bodies = Bodies::one_each(&media);
        let mut table = MediaTable::new(&media, &bodies);
        let air = StackId::default();
        // Into the glass wall: air to glass.
        let into_glass = table.cross(air, 1, true);
        assert!(into_glass.real);
        assert!((into_glass.boundary.eta - 1.0 / 1.5).abs() < 1e-6);
        // The water surface inside the wall is passed.
        let water_in_wall = table.cross(into_glass.beyond, 2, true);
        assert!(!water_in_wall.real);
        assert_eq!(table.top(water_in_wall.beyond), 1);
        // Leaving the wall: glass to water.
        let into_water = table.cross(water_in_wall.beyond, 1, false);
        assert!(into_water.real);
        assert!((into_water.boundary.eta - (1.5 / 1.33) as f32).abs() < 1e-6);
        assert_eq!(table.top(into_water.beyond), 2);
        // Ice has priority over water; beyond the ice the water continues.
        let into_ice = table.cross(into_water.beyond, 3, true);
        assert!(into_ice.real);
        let out_of_ice = table.cross(into_ice.beyond, 3, false);
        assert_eq!(out_of_ice.beyond, into_water.beyond);
    }

    /// Case AB-08 of the catalogue.
    #[test]
    fn leaving_what_was_never_entered_is_counted_and_does_not_underflow() {
        let media = drink();
        let bodies = Bodies::one_each(&media);
        let mut table = MediaTable::new(&media, &bodies);
        let t = table.cross(StackId::default(), 1, false);
        assert!(t.real && t.unmatched);
        assert_eq!(t.beyond, StackId::default());
        assert!((t.boundary.eta - 1.5).abs() < 1e-6);
    }

    #[test]
    fn entering_twice_needs_leaving_twice() {
        let media = drink();
        let bodies = Bodies::one_each(&media);
        let mut table = MediaTable::new(&media, &bodies);
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
        let bodies = Bodies::one_each(&media);
        let mut table = MediaTable::new(&media, &bodies);
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

    /// Flint in water in air. The water's index does not depend on the wavelength.
    fn dispersing() -> Vec<Medium> {
        let flint = Medium { dispersion: Dispersion::Cauchy([1.59, 0.01, 0.0]), ..medium("flint", 1.618_97, 5) };
        vec![Medium::air(), medium("water", 1.33, 1), flint]
    }

    #[test]
    fn a_wavelength_keeps_its_own_index_in_every_medium_until_it_ends() {
        let media = dispersing();
        let bodies = Bodies::one_each(&media);
        let mut table = MediaTable::dispersing(&media, &bodies, Spectrum::new(8, 2));
        let mut eye = StackId::default();
        for sample in 0..4 {
            table.begin_sample(sample);
            eye = table.stack_of(&[1]);
            let into = table.cross(eye, 2, true);
            let white = table.media[2].ior;
            assert!((f64::from(into.boundary.eta) - 1.33 / white).abs() < 1e-6, "white light goes by the line d");
            let id = into.fan.expect("flint disperses");
            table.learn_fan(id);
            let fan = table.known_fan(id).clone();
            assert_eq!(fan.outermost, [0, 7], "blue has the smallest ratio, red the largest");
            let bands = Spectrum::new(8, 2).sets()[sample as usize].clone();
            for (k, band) in fan.bands.iter().enumerate() {
                let index = media[2].index_at(bands.nm[k]);
                assert!((f64::from(band.boundary.eta) - 1.33 / index).abs() < 1e-6);
                assert_eq!(table.band_weight(k).to_array(), bands.weight[k]);
                assert_eq!((table.top(band.beyond), table.ior(band.beyond)), (2, index));
                let out = table.cross(band.beyond, 2, false);
                assert!(out.real && out.fan.is_none(), "what has a wavelength does not divide");
                assert!((f64::from(out.boundary.eta) - index / 1.33).abs() < 1e-6);
                assert_eq!((table.top(out.beyond), table.ior(out.beyond)), (1, 1.33));
            }
        }
        assert!(table.cross(eye, 1, false).fan.is_none(), "water to air disperses nothing");
    }

    #[test]
    fn without_a_spectrum_nothing_divides_and_the_line_d_counts() {
        let media = dispersing();
        let bodies = Bodies::one_each(&media);
        let mut table = MediaTable::new(&media, &bodies);
        let into = table.cross(StackId::default(), 2, true);
        assert!(into.fan.is_none());
        assert!((f64::from(into.boundary.eta) - 1.0 / media[2].ior).abs() < 1e-6);
    }

    /// Glass to water at a common face is one boundary; two faces of one glass are none.
    #[test]
    fn faces_that_coincide_are_crossed_as_one_boundary() {
        let mut media = drink();
        media.push(medium("other glass", 1.5, 10));
        let bodies = Bodies::one_each(&media);
        let mut table = MediaTable::new(&media, &bodies);
        let glass = table.cross(StackId::default(), 1, true).beyond;
        let into_water = table.cross_all(glass, &[(1, false), (2, true)]);
        assert!(into_water.real && !into_water.unmatched);
        assert!((into_water.boundary.eta - (1.5 / 1.33) as f32).abs() < 1e-6);
        assert_eq!(table.entered(into_water.beyond), [2]);
        let on = table.cross_all(glass, &[(1, false), (4, true)]);
        assert!(!on.real);
        assert_eq!(table.entered(on.beyond), [4]);
        // Out of both at once, and into both at once.
        let both = table.cross_all(StackId::default(), &[(2, true), (1, true)]);
        assert_eq!((table.entered(both.beyond), both.media), (vec![2, 1], [0, 1]));
        let out = table.cross_all(both.beyond, &[(1, false), (2, false)]);
        assert_eq!((out.beyond, out.media), (StackId::default(), [1, 0]));
        assert!(table.cross_all(StackId::default(), &[(1, false), (2, false)]).unmatched);
    }
}
