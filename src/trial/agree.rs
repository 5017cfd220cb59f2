//! Comparison of the contenders' answers, before anything is timed.

use std::cell::OnceCell;

use super::contender::{Answers, Label};
use super::rays::RaySet;
use crate::accel::reference::{Fault, Reference, Verdict};
use crate::geometry::{Geometry, Hit, Ray};

/// Largest number of rays judged at which two contenders report different primitives, evenly spread over all such rays.
const JUDGED: usize = 1000;

/// Largest number of rays judged at which they report the same primitive at another `t`: those with the largest
/// difference.
const JUDGED_T: usize = 100;

/// The arbiter over some shapes, built when it is first needed.
pub struct Judge<'a> {
    geometry: &'a [Geometry],
    reference: OnceCell<Reference>,
}

/// Wrong answers of one contender. Leaks alone are expected of Embree and only noted: a single leaked ray is within the
/// errors of `f32`, and wrong only because the surface is closed all around. The native path has no leaks.
#[derive(Clone, Debug, PartialEq)]
pub struct Disagreement {
    /// Contender that gave the answers.
    pub label: Label,
    /// Kind of the rays.
    pub rays: &'static str,
    /// Number of wrong answers among those that were judged.
    pub wrong: usize,
    /// Number of answers judged. Only answers that differ are.
    pub judged: usize,
    /// Number of answers that differ from the first contender's.
    pub differ: usize,
    /// Fault of the first wrong answer; leaks come last.
    pub fault: Fault,
    /// Index of its ray in the set.
    pub ray: usize,
}

impl Disagreement {
    /// Returns true if the fault makes timings meaningless.
    #[must_use]
    pub fn refuses(&self) -> bool {
        self.fault != Fault::Leak || self.label.backend.is_exact()
    }
}

impl std::fmt::Display for Disagreement {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let Self { label, rays, wrong, judged, differ, fault, ray } = self;
        write!(
            f,
            "{label}, {rays} rays: {differ} answers differ in some bit from the native path's; of the {judged} judged \
             {wrong} are wrong beyond what f32 cannot decide, ray {ray} for one ({fault:?})"
        )
    }
}

/// Ray at which the answers of two contenders differ.
struct Difference {
    ray: usize,
    /// Relative difference of `t`; infinite if they report different primitives.
    size: f32,
}

impl<'a> Judge<'a> {
    /// Creates the judge for rays at `geometry`.
    #[must_use]
    pub fn new(geometry: &'a [Geometry]) -> Self {
        Self { geometry, reference: OnceCell::new() }
    }

    /// Compares the answers of two contenders. If they differ, the arbiter judges both. Returns the wrong ones.
    #[must_use]
    pub fn compare(&self, set: &RaySet, a: (Label, &Answers), b: (Label, &Answers)) -> Vec<Disagreement> {
        let all = differences(set, a.1, b.1);
        let (others, same): (Vec<_>, Vec<_>) = all.into_iter().partition(|d| d.size.is_infinite());
        let step = others.len().div_ceil(JUDGED).max(1);
        let mut judged: Vec<usize> = others.iter().step_by(step).map(|d| d.ray).collect();
        let mut same = same;
        same.sort_by(|x, y| y.size.total_cmp(&x.size).then(x.ray.cmp(&y.ray)));
        judged.extend(same.iter().take(JUDGED_T).map(|d| d.ray));
        let verdicts = |(label, answers): (Label, &Answers)| {
            let faults: Vec<(usize, Fault)> = judged
                .iter()
                .filter_map(|&ray| match self.verdict(set, ray, answers) {
                    Verdict::Wrong(fault) => Some((ray, fault)),
                    _ => None,
                })
                .collect();
            faults.iter().min_by_key(|(_, fault)| *fault == Fault::Leak).map(|&(ray, fault)| Disagreement {
                label,
                rays: set.kind.name(),
                wrong: faults.len(),
                judged: judged.len(),
                differ: others.len() + same.len(),
                fault,
                ray,
            })
        };
        [a, b].into_iter().filter_map(verdicts).collect()
    }

    fn verdict(&self, set: &RaySet, i: usize, answers: &Answers) -> Verdict {
        let reference = self.reference.get_or_init(|| Reference::build(self.geometry));
        let ray: Ray = set.rays[i / 8].lane(i % 8);
        match answers {
            Answers::Closest(hits) => reference.judge(&ray, &hits[i / 8].lane(i % 8)),
            Answers::Blocked(blocked) => reference.judge_occluded(&ray, blocked[i / 8].lane(i % 8)),
        }
    }
}

/// Returns the rays at which two answers differ.
fn differences(set: &RaySet, a: &Answers, b: &Answers) -> Vec<Difference> {
    let size = |i: usize| match (a, b) {
        (Answers::Closest(a), Answers::Closest(b)) => apart(&a[i / 8].lane(i % 8), &b[i / 8].lane(i % 8)),
        (Answers::Blocked(a), Answers::Blocked(b)) if a[i / 8].lane(i % 8) == b[i / 8].lane(i % 8) => 0.0,
        _ => f32::INFINITY,
    };
    (0..set.count).map(|ray| Difference { ray, size: size(ray) }).filter(|d| d.size > 0.0).collect()
}

/// Relative difference of two hits: 0 if they are the same, infinite if they are on different primitives.
fn apart(a: &Hit, b: &Hit) -> f32 {
    if a.id() != b.id() || a.is_hit() != b.is_hit() {
        f32::INFINITY
    } else if a.t == b.t {
        0.0
    } else {
        let size = (a.t - b.t).abs() / a.t.abs().max(f32::MIN_POSITIVE);
        if size.is_nan() { f32::INFINITY } else { size }
    }
}

#[cfg(test)]
mod tests {
    use super::super::contender::Mode;
    use super::super::rays::{Picture, RayKind, View, all, bounds};
    use super::super::streams::contenders;
    use super::super::team::Team;
    use super::*;
    use crate::accel::{Accel, Backend, BuildQuality};
    use crate::geometry::{GeometryMask, Shape, TriMesh};
    use crate::simd::Mask8;
    use glam::Vec3;

    /// A grid of hills, 2 n^2 triangles.
    fn hills(n: u32) -> Vec<Geometry> {
        let point = |i: u32, k: u32| {
            let (x, z) = (i as f32 / n as f32 * 4.0 - 2.0, k as f32 / n as f32 * 4.0 - 2.0);
            Vec3::new(x, 0.3 * (3.0 * x).sin() * (4.0 * z).cos(), z)
        };
        let positions = (0..=n).flat_map(|k| (0..=n).map(move |i| point(i, k))).collect();
        let at = |i: u32, k: u32| k * (n + 1) + i;
        let quads = (0..n).flat_map(|k| (0..n).map(move |i| (i, k)));
        let triangles = quads
            .flat_map(|(i, k)| [[at(i, k), at(i, k + 1), at(i + 1, k)], [at(i + 1, k), at(i, k + 1), at(i + 1, k + 1)]])
            .collect();
        let mesh = TriMesh { positions, triangles, ..TriMesh::default() };
        vec![Geometry { shape: Shape::Mesh(mesh), mask: GeometryMask::OPAQUE }]
    }

    const WRONG: Label = Label { backend: Backend::Native, mode: Mode::Only("wrong") };

    /// Compares the native path's answers with the same answers after `spoil` has changed them.
    fn spoiled(kind: RayKind, spoil: impl Fn(&mut Answers)) -> Vec<Disagreement> {
        let geometry = hills(20);
        let accel = Accel::build(Backend::Native, &geometry, BuildQuality::Default).unwrap();
        let sets = all(&accel, &geometry, &View::of(&bounds(&geometry)), &Picture { edge: 64, one_in: 1 });
        let set = sets.iter().find(|s| s.kind == kind).unwrap();
        let mut auto = contenders(&accel).swap_remove(0);
        auto.prepare(set);
        auto.trace(set, &Team::new(1).unwrap());
        let right = auto.answers(set);
        let mut wrong = right.clone();
        spoil(&mut wrong);
        Judge::new(&geometry).compare(set, (auto.label(), &right), (WRONG, &wrong))
    }

    fn hits(answers: &mut Answers) -> &mut [Hit8] {
        match answers {
            Answers::Closest(hits) => hits,
            Answers::Blocked(_) => panic!("asked for the nearest hits"),
        }
    }

    use crate::geometry::Hit8;

    #[test]
    fn equal_answers_are_not_refused() {
        assert_eq!(spoiled(RayKind::Primary, |_| {}), []);
        assert_eq!(spoiled(RayKind::Shadow, |_| {}), []);
    }

    #[test]
    fn one_hit_left_out_among_thousands_is_found_and_is_its_own_fault() {
        let refusals = spoiled(RayKind::Primary, |answers| {
            let packet = hits(answers).iter_mut().find(|h| (0..8).all(|i| h.lane(i).is_hit())).unwrap();
            packet.set_lane(3, &Hit::MISS);
        });
        assert_eq!(refusals.len(), 1);
        let refusal = &refusals[0];
        assert_eq!((refusal.label, refusal.wrong, refusal.judged, refusal.differ), (WRONG, 1, 1, 1));
        assert_eq!((refusal.fault, refusal.ray % 8), (Fault::MissedHit, 3));
        assert!(refusal.to_string().contains("native wrong, primary rays: 1 answers differ"), "{refusal}");
    }

    #[test]
    fn a_wrong_t_and_a_wrong_triangle_are_found() {
        let first = |answers: &mut Answers, change: &dyn Fn(&mut Hit)| {
            let packet = hits(answers).iter_mut().find(|h| h.lane(0).is_hit()).unwrap();
            let mut hit = packet.lane(0);
            change(&mut hit);
            packet.set_lane(0, &hit);
        };
        let off = spoiled(RayKind::Mirror, |a| first(a, &|hit| hit.t *= 1.001));
        assert_eq!(off[0].fault, Fault::TOutOfBounds);
        let other = spoiled(RayKind::Diffuse, |a| first(a, &|hit| hit.primitive ^= 256));
        assert_eq!(other[0].fault, Fault::FalseHit);
    }

    #[test]
    fn only_embree_may_leak() {
        let finding = |backend, fault| {
            let label = Label { backend, mode: Mode::Auto };
            Disagreement { label, rays: "primary", wrong: 1, judged: 1, differ: 1, fault, ray: 0 }.refuses()
        };
        assert!(finding(Backend::Native, Fault::Leak) && finding(Backend::EmbreeFast, Fault::MissedHit));
        assert!(!finding(Backend::EmbreeFast, Fault::Leak));
    }

    #[test]
    fn a_shadow_that_is_none_is_found() {
        let refusals = spoiled(RayKind::Shadow, |answers| match answers {
            Answers::Blocked(blocked) => blocked.iter_mut().for_each(|b| *b = Mask8::from_bits(!b.bits())),
            Answers::Closest(_) => panic!("asked for any hit"),
        });
        assert_eq!(refusals.len(), 1);
        assert!(refusals[0].label == WRONG && refusals[0].wrong > refusals[0].judged / 2);
        assert!(refusals[0].judged <= 1000 && refusals[0].differ > 500);
    }
}
