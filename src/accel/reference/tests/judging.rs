//! Verdicts on single answers.

use glam::Vec3;

use super::shapes::*;
use crate::accel::reference::*;
use crate::geometry::{Hit, Ray, Shape};

fn ray(x: f32, y: f32) -> Ray {
    Ray::new(Vec3::new(x, y, 3.0), -Vec3::Z)
}

fn hit(geometry: u32, t: f32) -> Hit {
    Hit { t, geometry, ..Hit::MISS }
}

/// Two triangles, one a unit below the other.
fn two() -> Reference {
    let below =
        mesh(vec![Vec3::new(0.0, 0.0, -1.0), Vec3::new(1.0, 0.0, -1.0), Vec3::new(0.0, 2.0, -1.0)], vec![[0, 1, 2]]);
    Reference::build(&[triangle(), below])
}

#[test]
fn right_answers_agree_and_each_wrong_one_has_its_name() {
    let world = two();
    let middle = ray(0.25, 0.25);
    assert_eq!(world.judge(&middle, &hit(0, 3.0)), Verdict::Agrees);
    assert_eq!(world.judge(&middle, &hit(0, 3.000_001)), Verdict::Agrees);
    assert_eq!(world.judge(&middle, &hit(0, 3.000_1)), Verdict::Wrong(Fault::TOutOfBounds));
    assert_eq!(world.judge(&middle, &hit(1, 4.0)), Verdict::Wrong(Fault::OtherPrimitive));
    assert_eq!(world.judge(&middle, &Hit::MISS), Verdict::Wrong(Fault::MissedHit));
    assert_eq!(world.judge(&middle, &hit(7, 3.0)), Verdict::Wrong(Fault::FalseHit));
    assert_eq!(world.judge(&ray(0.9, 0.9), &hit(0, 3.0)), Verdict::Wrong(Fault::FalseHit));
    assert_eq!(world.judge(&ray(0.9, 0.9), &Hit::MISS), Verdict::Agrees);
    let short = Ray { t_max: 2.0, ..middle };
    assert_eq!(world.judge(&short, &hit(0, 3.0)), Verdict::Wrong(Fault::OutsideInterval));
    assert_eq!(world.judge(&short, &Hit::MISS), Verdict::Agrees);
    assert_eq!(world.judge_occluded(&middle, true), Verdict::Agrees);
    assert_eq!(world.judge_occluded(&middle, false), Verdict::Wrong(Fault::MissedHit));
    assert_eq!(world.judge_occluded(&short, true), Verdict::Wrong(Fault::FalseHit));
    assert_eq!(world.judge_occluded(&short, false), Verdict::Agrees);
    let nowhere = Ray { dir: Vec3::ZERO, ..middle };
    assert_eq!(world.judge(&nowhere, &Hit::MISS), Verdict::Agrees);
    assert_eq!(world.judge(&nowhere, &hit(0, 3.0)), Verdict::Wrong(Fault::FalseHit));
}

fn undecidable(verdict: Verdict) -> Cause {
    let Verdict::Undecidable(cause, margin) = verdict else { panic!("{verdict:?}") };
    assert!(margin.distance <= margin.bound, "{margin:?}");
    cause
}

#[test]
fn at_an_open_edge_either_answer_passes_and_the_margin_says_why() {
    let world = two();
    let sharp = ray(1e-9, 0.5);
    assert_eq!(undecidable(world.judge(&sharp, &Hit::MISS)), Cause::Crack);
    assert_eq!(undecidable(world.judge(&sharp, &hit(1, 4.0))), Cause::Crack);
    assert_eq!(world.judge(&sharp, &hit(0, 3.0)), Verdict::Agrees);
    let beside = ray(-1e-9, 0.5);
    assert_eq!(undecidable(world.judge(&beside, &hit(0, 3.0))), Cause::Crack);
    assert_eq!(undecidable(world.judge_occluded(&beside, true)), Cause::Crack);
    // A ten-thousandth beside the edge nothing excuses it.
    assert_eq!(world.judge(&ray(1e-4, 0.5), &Hit::MISS), Verdict::Wrong(Fault::MissedHit));
    assert_eq!(world.judge(&ray(-1e-4, 0.5), &hit(0, 3.0)), Verdict::Wrong(Fault::FalseHit));
}

#[test]
fn ties_and_ends_of_the_interval_are_classes_of_their_own() {
    let tied = Reference::build(&[triangle(), triangle()]);
    assert_eq!(tied.judge(&ray(0.25, 0.25), &hit(0, 3.0)), Verdict::Agrees);
    assert_eq!(undecidable(tied.judge(&ray(0.25, 0.25), &hit(1, 3.0))), Cause::Tie);
    let world = two();
    let to_the_face = Ray { t_max: 3.0, ..ray(0.25, 0.25) };
    assert_eq!(undecidable(world.judge(&to_the_face, &Hit::MISS)), Cause::Interval);
    let from_the_face = Ray { t_min: 3.0, ..ray(0.25, 0.25) };
    assert_eq!(world.judge(&from_the_face, &hit(1, 4.0)), Verdict::Agrees);
    assert_eq!(undecidable(world.judge(&from_the_face, &hit(0, 3.0_f32.next_up()))), Cause::Interval);
}

#[test]
fn slipping_through_a_shared_edge_is_a_leak_and_not_excused() {
    let square = |z: f32| {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, z));
        mesh(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
    };
    let world = Reference::build(&[square(0.0), square(-1.0)]);
    let diagonal = ray(0.25, 0.25);
    assert_eq!(world.judge(&diagonal, &hit(1, 4.0)), Verdict::Wrong(Fault::Leak));
    assert_eq!(world.judge(&diagonal, &Hit::MISS), Verdict::Wrong(Fault::Leak));
    assert_eq!(world.judge(&diagonal, &hit(0, 3.0)), Verdict::Agrees);
    let other_half = Hit { primitive: 1, ..hit(0, 3.0) };
    assert!(matches!(undecidable(world.judge(&diagonal, &other_half)), Cause::Edge));
    assert_eq!(undecidable(world.judge(&ray(1.0, 0.25), &Hit::MISS)), Cause::Crack, "an open edge is none");
}

#[test]
fn a_silhouette_of_a_sphere_is_undecidable_only_within_roundings() {
    let world = Reference::build(&[sphere(Vec3::ZERO, 1.0)]);
    assert_eq!(undecidable(world.judge(&ray(1.0, 0.0), &Hit::MISS)), Cause::Edge);
    assert_eq!(world.judge(&ray(0.999, 0.0), &Hit::MISS), Verdict::Wrong(Fault::MissedHit));
    assert_eq!(world.judge(&ray(1.001, 0.0), &hit(0, 3.0)), Verdict::Wrong(Fault::FalseHit));
    assert_eq!(world.judge(&ray(0.0, 0.0), &hit(0, 2.0)), Verdict::Agrees);
    assert_eq!(world.judge(&ray(0.0, 0.0), &hit(0, 4.0)), Verdict::Wrong(Fault::OtherPrimitive));
    let from_within = Ray::new(Vec3::ZERO, Vec3::X);
    assert_eq!(world.judge(&from_within, &hit(0, 1.0)), Verdict::Agrees);
}

#[test]
fn few_random_rays_are_undecidable_and_the_arbiter_agrees_with_itself() {
    let ball = ball(Vec3::new(0.3, -0.2, 0.1), 1.0, 24);
    let world = Reference::build(&[geometry(Shape::Mesh(ball.clone()))]);
    let mut numbers = Numbers(3);
    let mut undecided = 0;
    for i in 0..4000 {
        let origin = numbers.vector() * 4.0;
        let corner = ball.positions[i % ball.positions.len()];
        let target = if i % 2 == 0 { numbers.vector() } else { corner };
        let ray = Ray::new(origin, target - origin);
        let own = world.closest(&Ray64::from(&ray));
        assert_eq!(world.judge(&ray, &own.to_f32(0.0)), Verdict::Agrees);
        if i % 2 == 0 {
            let sure = world.contacts(&Ray64::from(&ray)).iter().all(|c| c.edge.is_decided());
            undecided += usize::from(!sure);
        }
    }
    assert!(undecided <= 10, "{undecided} of 2000");
}
