//! Verdicts on another path's answers, ray by ray.

use std::cell::OnceCell;
use std::collections::BTreeSet;
use std::ops::ControlFlow;

use super::margin::SLIP;
use super::primitive::Probe;
use super::seams::Seams;
use super::{Budget, Contact, Hit64, Margin, Ray64, Reference};
use crate::geometry::{Hit, Ray};

/// Verdict on an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// Same primitive and `t` within its tolerance, or a miss on both sides.
    Agrees,
    /// Another answer, but the `f64` decision is closer to its opposite than `f32` can tell: `distance <= bound`.
    Undecidable(Cause, Margin),
    /// Another answer that the errors of `f32` do not explain.
    Wrong(Fault),
}

/// Reason why an answer cannot be judged. Its margin has the given unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Cause {
    /// The ray passes a silhouette too closely: a fold of joined triangles, or the outline of a sphere. In scene units.
    Edge,
    /// Two hits are too close along the ray. In units of `t`.
    Tie,
    /// A hit lies too close to `t_min` or `t_max`. In units of `t`.
    Interval,
    /// `t` exceeds its tolerance on a triangle so thin that rounding gives bad weights of its corners. In units of `t`.
    Sliver,
    /// The ray passes too closely an edge that is open, or at which triangles touch without being joined: a rim, a
    /// slit, a seam of different corners, a corner in the middle of an edge. In scene units.
    Crack,
}

/// Fault of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fault {
    /// A miss, although the ray hits something for certain.
    MissedHit,
    /// A hit on a primitive that the ray misses for certain.
    FalseHit,
    /// A hit, although another primitive is nearer for certain.
    OtherPrimitive,
    /// Error of `t` above its bound.
    TOutOfBounds,
    /// `t` outside the ray's interval.
    OutsideInterval,
    /// A miss at an edge or corner of triangles that are joined and surround the ray.
    Leak,
    /// A hit on the surface that the ray leaves, because its origin lies on the wrong side. The arbiter gets the same
    /// origin and cannot see this fault. [`crate::trial::parity`], which makes such rays, reports it.
    SelfHit,
}

impl Contact {
    /// Distance of `t` from the nearer end of the ray's interval, with its bound. The distance is 0 if `f32` has no
    /// such `t`.
    fn interval(&self, ray: &Ray64) -> Margin {
        let distance = (self.t - ray.t_min).abs().min((ray.t_max - self.t).abs());
        Margin { distance: if self.t.abs() < LARGEST_T { distance } else { 0.0 }, bound: self.bound }
    }

    /// Returns true if every `t` that `f32` may compute lies within the ray's interval and before `end`.
    fn is_sure_to_lie_before(&self, end: f64, ray: &Ray64) -> bool {
        let [first, last] = self.span;
        ray.t_min < first && last <= ray.t_max && last < end.min(LARGEST_T)
    }

    /// Returns true if `f32` must find the contact.
    fn is_certain(&self, ray: &Ray64) -> bool {
        self.inside && self.edge.is_decided() && ray.sees(self.t) && self.interval(ray).is_decided()
    }

    /// Returns true if `f32` may find the contact.
    fn is_possible(&self, ray: &Ray64) -> bool {
        let beyond = !ray.sees(self.t) && self.interval(ray).is_decided();
        !self.is_beside() && !beyond
    }

    /// Returns true if the line passes outside the primitive for certain.
    fn is_beside(&self) -> bool {
        !self.inside && self.edge.is_decided()
    }

    /// Returns true if it is nearer than `o` for certain.
    fn is_surely_before(&self, o: &Self) -> bool {
        self.t + self.bound < o.t - o.bound
    }
}

/// Largest `t` that `f32` can represent for certain.
const LARGEST_T: f64 = f32::MAX as f64 * (1.0 - 1e-6);

/// Contacts of one ray. They are computed once and compared with any number of answers.
#[derive(Clone, Debug)]
pub struct Examined<'a> {
    reference: &'a Reference,
    ray: Ray,
    wide: Ray64,
    contacts: Vec<Contact>,
    /// Contacts on the ray's line outside its interval.
    beyond: Vec<Contact>,
    truth: Hit64,
    /// Computed only if an answer differs.
    seams: OnceCell<Seams>,
}

impl Examined<'_> {
    /// Returns the nearest hit in `f64`, or a miss.
    #[must_use]
    pub fn truth(&self) -> &Hit64 {
        &self.truth
    }

    /// Returns all contacts that `f32` may find, nearest first.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Judges the nearest hit that another path reports. It must be on a primitive that the arbiter did not drop.
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
            // The claim is certain, but the hit in `f64` is no contact: the two halves of the arbiter disagree.
            None => Verdict::Wrong(Fault::FalseHit),
        }
    }

    /// Judges another path's answer on occlusion: true if it reports the ray as blocked.
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

    /// Returns true if joined triangles surround the ray, all of which `f32` can only hit within the interval and
    /// before `end`.
    fn is_surrounded(&self, end: f64) -> bool {
        let open = |c: &&Contact| !c.edge.is_decided() && c.is_sure_to_lie_before(end, &self.wide);
        // One of the triangles that surround the ray contains it.
        self.contacts.iter().filter(open).any(|c| c.inside)
            && self.seams().surround(&self.contacts.iter().filter(open).map(|c| c.place).collect::<BTreeSet<_>>())
    }

    /// Returns the reason why `f32` need not, or may, find `c`.
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
    /// Computes all that [`Reference::judge`] and [`Reference::judge_occluded`] need for `ray`.
    #[must_use]
    pub fn examine(&self, ray: &Ray) -> Examined<'_> {
        self.look(ray, &mut Budget::unlimited())
    }

    /// Computes the same as [`Reference::examine`]; `None` if `budget` was spent before.
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

    /// Judges the nearest hit that another path reports for `ray`. It must be on a primitive that the arbiter did not
    /// drop.
    #[must_use]
    pub fn judge(&self, ray: &Ray, claim: &Hit) -> Verdict {
        self.examine(ray).judge(claim)
    }

    /// Judges another path's answer on the occlusion of `ray`: true if it reports the ray as blocked.
    #[must_use]
    pub fn judge_occluded(&self, ray: &Ray, claim: bool) -> Verdict {
        self.examine(ray).judge_occluded(claim)
    }

    /// Returns all contacts along `ray` that `f32` may find, nearest first.
    #[must_use]
    pub fn contacts(&self, ray: &Ray64) -> Vec<Contact> {
        let mut found = self.line_contacts(ray, &mut Budget::unlimited());
        found.retain(|c| c.is_possible(ray));
        found
    }

    /// Returns all contacts along the whole line of `ray`, nearest first, until `budget` is spent.
    fn line_contacts(&self, ray: &Ray64, budget: &mut Budget) -> Vec<Contact> {
        let mut found = Vec::new();
        if !ray.is_usable() {
            return found;
        }
        let probe = Probe::new(ray);
        // Boxes are tested against the whole line, since a hit just outside the interval may be rounded into it.
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
