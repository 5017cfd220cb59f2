//! Judging another path's answers, ray by ray.

use std::ops::ControlFlow;

use arrayvec::ArrayVec;
use glam::DVec3;

use super::margin::SLIP;
use super::primitive::Probe;
use super::{Contact, Hit64, Margin, Ray64, Reference};
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
    /// The ray passes an edge or a silhouette too closely; in scene units.
    Edge,
    /// Two hits are too close along the ray; in units of `t`.
    Tie,
    /// A hit lies too close to `t_min` or `t_max`; in units of `t`.
    Interval,
    /// `t` misses its tolerance, on a triangle so thin that rounding makes bad weights of its corners; in units of `t`.
    Sliver,
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
    /// A surface passed through at an edge or corner, though it goes on all around. (Or else a crack between its
    /// triangles narrower than `f32` sees, in a mesh that is not joined there.)
    Leak,
    /// A ray meets the surface that it leaves, because its start lies on the wrong side. The arbiter is given the same
    /// start and cannot see this fault, so that it comes from [`crate::trial::parity`], which made the ray.
    SelfHit,
}

impl Contact {
    /// Distance of `t` from the nearer end of the ray's interval, against its bound.
    fn interval(&self, ray: &Ray64) -> Margin {
        Margin { distance: (self.t - ray.t_min).abs().min((ray.t_max - self.t).abs()), bound: self.bound }
    }

    /// Whether `f32` has to find it.
    fn is_certain(&self, ray: &Ray64) -> bool {
        self.inside && self.edge.is_decided() && ray.sees(self.t) && self.interval(ray).is_decided()
    }

    /// Whether `f32` may find it.
    fn is_possible(&self, ray: &Ray64) -> bool {
        let beside = !self.inside && self.edge.is_decided();
        let beyond = !ray.sees(self.t) && self.interval(ray).is_decided();
        !beside && !beyond
    }

    /// Whether it lies nearer than `o` beyond doubt.
    fn is_surely_before(&self, o: &Self) -> bool {
        self.t + self.bound < o.t - o.bound
    }

    /// Why `f32` need not find it, or may.
    fn doubt(&self, ray: &Ray64) -> Verdict {
        if self.edge.is_decided() {
            Verdict::Undecidable(Cause::Interval, self.interval(ray))
        } else {
            Verdict::Undecidable(Cause::Edge, self.edge)
        }
    }
}

/// What there is to know of one ray: found once, and held against any number of answers.
#[derive(Clone, Debug)]
pub struct Examined<'a> {
    reference: &'a Reference,
    ray: Ray,
    wide: Ray64,
    contacts: Vec<Contact>,
    truth: Hit64,
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
        let Self { reference, ray, wide, contacts, truth } = self;
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
        let mut nearer = contacts.iter().filter(|c| c.inside && c.is_surely_before(found));
        if nearer.clone().any(|c| c.is_certain(wide)) {
            return Verdict::Wrong(Fault::OtherPrimitive);
        }
        if nearer.any(|c| c.interval(wide).is_decided() && reference.goes_on_around(wide, c, 0.5 * (c.t + found.t))) {
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
            return found.doubt(wide);
        }
        match contacts.iter().filter(|c| c.id == truth.id()).min_by(|a, b| a.t.total_cmp(&b.t)) {
            Some(c) if !c.is_certain(wide) => c.doubt(wide),
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
        self.contacts.first().map_or(Verdict::Wrong(Fault::FalseHit), |c| c.doubt(&self.wide))
    }

    fn judge_nothing(&self) -> Verdict {
        let Self { reference, wide, contacts, truth, .. } = self;
        if contacts.iter().any(|c| c.is_certain(wide)) {
            return Verdict::Wrong(Fault::MissedHit);
        }
        if !truth.is_hit() {
            return Verdict::Agrees;
        }
        let solid = |c: &&Contact| c.inside && wide.sees(c.t) && c.interval(wide).is_decided();
        if contacts.iter().filter(solid).any(|c| reference.goes_on_around(wide, c, f64::INFINITY)) {
            return Verdict::Wrong(Fault::Leak);
        }
        match contacts.iter().find(|c| c.id == truth.id()) {
            Some(c) => c.doubt(wide),
            None => Verdict::Wrong(Fault::MissedHit),
        }
    }
}

impl Reference {
    /// Finds out all that [`Reference::judge`] and [`Reference::judge_occluded`] need to know of `ray`.
    #[must_use]
    pub fn examine(&self, ray: &Ray) -> Examined<'_> {
        let wide = Ray64::from(ray);
        Examined { reference: self, ray: *ray, wide, contacts: self.contacts(&wide), truth: self.closest(&wide) }
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

    /// Everything that `f32` may find along `ray`.
    #[must_use]
    pub fn contacts(&self, ray: &Ray64) -> Vec<Contact> {
        let mut found = Vec::new();
        if !ray.is_usable() {
            return found;
        }
        let probe = Probe::new(ray);
        // Boxes are entered over the whole line: a hit just outside the interval may round into it.
        let line = Ray64 { t_min: f64::NEG_INFINITY, t_max: f64::INFINITY, ..*ray };
        let slack = 4.0 * SLIP / f64::EPSILON;
        self.tree.walk(&line, slack, |place| {
            let primitive = &self.primitives[place];
            if primitive.mask.meets(ray.admits) {
                found.extend(Contact::with(primitive, &probe).into_iter().filter(|c| c.is_possible(ray)));
            }
            ControlFlow::Continue(f64::INFINITY)
        });
        found.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.id.cmp(&b.id)));
        found
    }

    /// Whether eight rays, moved aside by more than `f32` can tell from `c`'s edge, all meet something up to `until`.
    fn goes_on_around(&self, ray: &Ray64, c: &Contact, until: f64) -> bool {
        let (x, y) = ray.dir.normalize().any_orthonormal_pair();
        let aside = 4.0 * c.edge.bound;
        let ring: ArrayVec<DVec3, 8> = (0..8)
            .map(|i| {
                let (sin, cos) = (f64::from(i) * std::f64::consts::FRAC_PI_4).sin_cos();
                (x * cos + y * sin) * aside
            })
            .collect();
        aside.is_finite()
            && ring.iter().all(|&o| {
                let moved = Ray64 { origin: ray.origin + o, t_max: until.min(ray.t_max), ..*ray };
                self.occluded(&moved)
            })
    }
}
