//! Judging another path's answers, ray by ray.

use std::cell::OnceCell;
use std::collections::BTreeSet;
use std::ops::ControlFlow;

use super::margin::SLIP;
use super::primitive::Probe;
use super::seams::Seams;
use super::{Budget, Contact, Hit64, Margin, Ray64, Reference};
use crate::geometry::{Hit, Ray};

/// What is to be thought of an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// Same primitive, `t` within its tolerance; or a miss on both sides.
    Agrees,
    /// It differs, but the `f64` decision is nearer to flipping than `f32` can tell: `distance <= bound`.
    Undecidable(Cause, Margin),
    /// It differs where `f32` had to know better.
    Wrong(Fault),
}

/// Why an answer cannot be judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Cause {
    /// The ray passes a silhouette too closely: a fold of joined triangles, or the outline of a sphere; in scene units.
    Edge,
    /// Two hits are too close along the ray; in units of `t`.
    Tie,
    /// A hit lies too close to `t_min` or `t_max`; in units of `t`.
    Interval,
    /// `t` misses its tolerance, on a triangle so thin that rounding makes bad weights of its corners; in units of `t`.
    Sliver,
    /// The ray passes an edge too closely that is open, or where triangles meet without being joined: a rim, a slit, a
    /// seam of corners that differ, a corner in the middle of an edge; in scene units.
    Crack,
}

/// What is wrong with an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fault {
    /// Nothing reported, though something is surely there.
    MissedHit,
    /// Something reported that is surely not there.
    FalseHit,
    /// Something reported, though something else is surely nearer.
    OtherPrimitive,
    /// `t` off by more than its bound.
    TOutOfBounds,
    /// `t` outside the ray's own interval.
    OutsideInterval,
    /// A surface passed through at an edge or corner, though its triangles are joined and surround the ray.
    Leak,
    /// A ray meets the surface that it leaves, because its start lies on the wrong side. The arbiter is given the same
    /// start and cannot see this fault, so that it comes from [`crate::trial::parity`], which made the ray.
    SelfHit,
}

impl Contact {
    /// Distance of `t` from the nearer end of the ray's interval, against its bound; 0 where `f32` has no such `t`.
    fn interval(&self, ray: &Ray64) -> Margin {
        let distance = (self.t - ray.t_min).abs().min((ray.t_max - self.t).abs());
        Margin { distance: if self.t.abs() < LARGEST_T { distance } else { 0.0 }, bound: self.bound }
    }

    /// Returns true if `f32` can only find it, if at all, within the ray's interval and before `end`.
    fn is_sure_to_lie_before(&self, end: f64, ray: &Ray64) -> bool {
        let [first, last] = self.span;
        ray.t_min < first && last <= ray.t_max && last < end.min(LARGEST_T)
    }

    /// Whether `f32` has to find it.
    fn is_certain(&self, ray: &Ray64) -> bool {
        self.inside && self.edge.is_decided() && ray.sees(self.t) && self.interval(ray).is_decided()
    }

    /// Whether `f32` may find it.
    fn is_possible(&self, ray: &Ray64) -> bool {
        let beyond = !ray.sees(self.t) && self.interval(ray).is_decided();
        !self.is_beside() && !beyond
    }

    /// Returns true if the line surely passes it by.
    fn is_beside(&self) -> bool {
        !self.inside && self.edge.is_decided()
    }

    /// Whether it lies nearer than `o` beyond doubt.
    fn is_surely_before(&self, o: &Self) -> bool {
        self.t + self.bound < o.t - o.bound
    }
}

/// `t` from which on `f32` may have none, with room for roundings.
const LARGEST_T: f64 = f32::MAX as f64 * (1.0 - 1e-6);

/// What there is to know of one ray: found once, and held against any number of answers.
#[derive(Clone, Debug)]
pub struct Examined<'a> {
    reference: &'a Reference,
    ray: Ray,
    wide: Ray64,
    contacts: Vec<Contact>,
    /// Contacts on the ray's line, but beyond its interval.
    beyond: Vec<Contact>,
    truth: Hit64,
    /// Found only where an answer differs.
    seams: OnceCell<Seams>,
}

impl Examined<'_> {
    /// The nearest hit in `f64`, or a miss.
    #[must_use]
    pub fn truth(&self) -> &Hit64 {
        &self.truth
    }

    /// Everything that `f32` may find, nearest first.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Judges the nearest hit that another path claims. Only primitives that were kept can be claimed.
    #[must_use]
    pub fn judge(&self, claim: &Hit) -> Verdict {
        let Self { ray, wide, contacts, truth, .. } = self;
        if !claim.is_hit() {
            return self.judge_nothing();
        }
        if !(ray.t_min < claim.t && claim.t <= ray.t_max) {
            return Verdict::Wrong(Fault::OutsideInterval);
        }
        let t = f64::from(claim.t);
        let off = |c: &Contact| (c.t - t).abs();
        let same = contacts.iter().filter(|c| c.id == claim.id());
        let Some(found) = same.min_by(|a, b| off(a).total_cmp(&off(b))) else {
            return Verdict::Wrong(Fault::FalseHit);
        };
        if off(found) > found.bound {
            return Verdict::Wrong(Fault::TOutOfBounds);
        }
        if contacts.iter().any(|c| c.is_surely_before(found) && c.is_certain(wide)) {
            return Verdict::Wrong(Fault::OtherPrimitive);
        }
        if self.is_surrounded(found.t - found.bound) {
            return Verdict::Wrong(Fault::Leak);
        }
        if truth.id() == claim.id() && truth.is_hit() && (truth.t - found.t).abs() <= found.bound {
            return if off(found) <= found.tolerance {
                Verdict::Agrees
            } else {
                Verdict::Undecidable(Cause::Sliver, Margin { distance: off(found), bound: found.bound })
            };
        }
        if !found.is_certain(wide) {
            return self.doubt(found);
        }
        match contacts.iter().filter(|c| c.id == truth.id()).min_by(|a, b| a.t.total_cmp(&b.t)) {
            Some(c) if !c.is_certain(wide) => self.doubt(c),
            Some(c) => Verdict::Undecidable(
                Cause::Tie,
                Margin { distance: (c.t - found.t).abs(), bound: c.bound + found.bound },
            ),
            // The claim is certain and the truth no contact at all: the two halves of the arbiter disagree.
            None => Verdict::Wrong(Fault::FalseHit),
        }
    }

    /// Judges the claim that the ray is blocked, or is not.
    #[must_use]
    pub fn judge_occluded(&self, claim: bool) -> Verdict {
        if !claim {
            return self.judge_nothing();
        }
        if self.truth.is_hit() {
            return Verdict::Agrees;
        }
        self.contacts.first().map_or(Verdict::Wrong(Fault::FalseHit), |c| self.doubt(c))
    }

    fn judge_nothing(&self) -> Verdict {
        let Self { wide, contacts, truth, .. } = self;
        if contacts.iter().any(|c| c.is_certain(wide)) {
            return Verdict::Wrong(Fault::MissedHit);
        }
        if !truth.is_hit() {
            return Verdict::Agrees;
        }
        if self.is_surrounded(f64::INFINITY) {
            return Verdict::Wrong(Fault::Leak);
        }
        match contacts.iter().find(|c| c.id == truth.id()) {
            Some(c) => self.doubt(c),
            None => Verdict::Wrong(Fault::MissedHit),
        }
    }

    /// Returns true if joined triangles surround the ray that can only be met within its interval and before `end`.
    fn is_surrounded(&self, end: f64) -> bool {
        let open = |c: &&Contact| !c.edge.is_decided() && c.is_sure_to_lie_before(end, &self.wide);
        // Triangles that surround the ray have it in one of them.
        self.contacts.iter().filter(open).any(|c| c.inside)
            && self.seams().surround(&self.contacts.iter().filter(open).map(|c| c.place).collect::<BTreeSet<_>>())
    }

    /// Why `f32` need not find `c`, or may.
    fn doubt(&self, c: &Contact) -> Verdict {
        if c.edge.is_decided() {
            Verdict::Undecidable(Cause::Interval, c.interval(&self.wide))
        } else if self.seams().are_open_at(c.place) {
            Verdict::Undecidable(Cause::Crack, c.edge)
        } else {
            Verdict::Undecidable(Cause::Edge, c.edge)
        }
    }

    fn seams(&self) -> &Seams {
        self.seams.get_or_init(|| {
            let all = self.contacts.iter().chain(&self.beyond);
            Seams::of(&self.reference.primitives, &Probe::new(&self.wide), all)
        })
    }
}

impl Reference {
    /// Finds out all that [`Reference::judge`] and [`Reference::judge_occluded`] need to know of `ray`.
    #[must_use]
    pub fn examine(&self, ray: &Ray) -> Examined<'_> {
        self.look(ray, &mut Budget::unlimited())
    }

    /// The same as [`Reference::examine`]; `None` where `budget` did not last for it.
    #[must_use]
    pub fn examine_within(&self, ray: &Ray, budget: &mut Budget) -> Option<Examined<'_>> {
        let examined = self.look(ray, budget);
        (!budget.is_spent()).then_some(examined)
    }

    fn look(&self, ray: &Ray, budget: &mut Budget) -> Examined<'_> {
        let wide = Ray64::from(ray);
        let (contacts, beyond) = self.line_contacts(&wide, budget).into_iter().partition(|c| c.is_possible(&wide));
        let truth = self.closest_within(&wide, budget);
        Examined { reference: self, ray: *ray, wide, contacts, beyond, truth, seams: OnceCell::new() }
    }

    /// Judges the nearest hit that another path claims for `ray`. Only primitives that were kept can be claimed.
    #[must_use]
    pub fn judge(&self, ray: &Ray, claim: &Hit) -> Verdict {
        self.examine(ray).judge(claim)
    }

    /// Judges the claim that `ray` is blocked, or is not.
    #[must_use]
    pub fn judge_occluded(&self, ray: &Ray, claim: bool) -> Verdict {
        self.examine(ray).judge_occluded(claim)
    }

    /// Everything that `f32` may find along `ray`, nearest first.
    #[must_use]
    pub fn contacts(&self, ray: &Ray64) -> Vec<Contact> {
        let mut found = self.line_contacts(ray, &mut Budget::unlimited());
        found.retain(|c| c.is_possible(ray));
        found
    }

    /// Everything that `f32` may find along the whole line of `ray`, nearest first, while `budget` lasts.
    fn line_contacts(&self, ray: &Ray64, budget: &mut Budget) -> Vec<Contact> {
        let mut found = Vec::new();
        if !ray.is_usable() {
            return found;
        }
        let probe = Probe::new(ray);
        // Boxes are entered over the whole line: a hit just outside the interval may round into it.
        let line = Ray64 { t_min: f64::NEG_INFINITY, t_max: f64::INFINITY, ..*ray };
        let slack = 4.0 * SLIP / f64::EPSILON;
        self.tree.walk(&line, slack, budget, |place, budget| {
            let primitive = &self.primitives[place];
            if primitive.mask.meets(ray.admits) {
                let before = found.len();
                found.extend(Contact::with(primitive, place, &probe).into_iter().filter(|c| !c.is_beside()));
                budget.spend(Budget::CONTACT * (found.len() - before) as u64);
            }
            ControlFlow::Continue(f64::INFINITY)
        });
        found.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.id.cmp(&b.id)));
        found
    }
}
