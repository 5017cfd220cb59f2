//! Media around a ray: interned stacks of media with priorities, so that a lane carries one small number.
//!
//! Nested dielectrics after Schmidt & Budge 2002 ("Simple nested dielectrics in ray traced images"), with a rule for
//! leaving a surface that was never entered. `src/README.md`, "What a ray does", step 3, states all rules.
//!
//! The wavelength of a ray is part of its stack: a red ray in glass has another stack than a blue or a white one. So
//! every table here holds the indices for that wavelength, and rays carry no further field for it.

mod fan;
mod stack;
#[cfg(test)]
mod tests;

use std::collections::HashMap;

use fan::DispersiveBoundary;
pub use fan::{Fan, FanId};
pub use stack::StackId;
use stack::{Stack, TopMedium, filling, insert};

use crate::optics::{Boundary, Spectrum};
use crate::scene::{Bodies, Medium, Rgb};

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
    tops: Vec<TopMedium>,
    /// By fan: its boundary.
    fan_boundaries: Vec<DispersiveBoundary>,
    /// By fan, then by wavelength set. Without bands until computed.
    fans: Vec<Vec<Fan>>,
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
            fan_boundaries: Vec::new(),
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
        self.fan_boundaries.clear();
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
            self.fan_boundaries.push(DispersiveBoundary { from, to, entered: after.entered.clone() });
            self.fans.push(vec![Fan::default(); sets]);
            FanId(self.fan_boundaries.len() as u32 - 1)
        });
        let (n1, n2) = (self.index(from, wave), self.index(to, wave));
        let beyond = self.beyond(before, after);
        let thin_side = Boundary::new(n1.min(n2), n1.max(n2));
        Transition { real, boundary: Boundary::new(n1, n2), thin_side, beyond, unmatched, fan, media: [from, to] }
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
        self.tops.push(TopMedium { medium, ior, absorption, absorbs: absorption != Rgb::ZERO });
        self.transitions.push(vec![None; self.bodies.count() * 2]);
        self.ids.insert(stack.clone(), id);
        self.stacks.push(stack);
        id
    }
}
