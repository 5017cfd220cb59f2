//! Hits of rays with known answers.

use glam::{DVec3, Vec3};

use super::shapes::*;
use crate::accel::reference::*;
use crate::accel::{Coherence, Intersector};
use crate::geometry::{GeometryMask, Hit, Hit8, Ray, Ray8, Shape};
use crate::simd::Mask8;

fn down(x: f64, y: f64) -> Ray64 {
    Ray64::new(DVec3::new(x, y, 3.0), -DVec3::Z)
}

#[test]
fn a_triangle_is_met_where_it_is_from_either_side_with_the_documented_weights() {
    let world = Reference::build(&[triangle()]);
    let hit = world.closest(&down(0.25, 0.5));
    assert_eq!((hit.t, hit.u, hit.v, hit.id()), (3.0, 0.25, 0.25, (0, 0, 0)));
    let behind = Ray64::new(DVec3::new(0.25, 0.5, -2.0), DVec3::Z * 4.0);
    assert_eq!(world.closest(&behind).t, 0.5);
    assert_eq!(world.closest(&down(0.6, 1.0)), Hit64::MISS);
    assert!(world.occluded(&down(0.5, 1.0)), "edges belong to the triangle");
}

#[test]
fn a_sphere_is_met_on_both_sides_and_from_within() {
    let world = Reference::build(&[sphere(Vec3::new(0.0, 0.0, -5.0), 2.0)]);
    let hits = world.all_hits(&down(0.0, 0.0));
    assert_eq!(hits.iter().map(|h| h.t).collect::<Vec<_>>(), [6.0, 10.0]);
    let within = Ray64::new(DVec3::new(0.0, 0.0, -5.0), DVec3::X);
    assert_eq!(world.closest(&within).t, 2.0);
    let off_axis = world.closest(&down(1.2, 0.0));
    assert!((off_axis.t - 6.4).abs() < 1e-14, "{}", off_axis.t);
}

/// A parameter that is no number moves the foot of the centre along the ray, by far more than the radius here.
#[test]
fn a_sphere_keeps_its_outline_from_any_distance() {
    for radius in [1e-12_f32, 1e-20, 1e-30] {
        let world = Reference::build(&[sphere(Vec3::ZERO, radius)]);
        let from =
            |y: f64| DVec3::new(3.0 * (1.0 + 2_f64.powi(-10)), y * f64::from(radius), 4.0 * (1.0 + 2_f64.powi(-10)));
        let ray = |y| Ray64::new(from(y), DVec3::new(-15.0, 0.0, -20.0));
        for y in [0.0, 0.5, -0.999] {
            let hit = world.closest(&ray(y));
            assert!((hit.t - 0.2 * (1.0 + 2_f64.powi(-10))).abs() < 1e-11, "{radius}, {y}: {hit:?}");
        }
        assert!(!world.occluded(&ray(1.001)) && !world.occluded(&ray(-1.001)), "{radius}");
    }
}

#[test]
fn a_plane_is_met_from_both_sides_and_not_along_itself() {
    let world = Reference::build(&[plane(Vec3::new(7.0, 1.0, 9.0), Vec3::Y)]);
    assert_eq!(world.closest(&Ray64::new(DVec3::ZERO, DVec3::new(0.0, 0.5, 1.0))).t, 2.0);
    assert_eq!(world.closest(&Ray64::new(DVec3::Y * 4.0, -DVec3::Y)).t, 3.0);
    assert!(!world.occluded(&Ray64::new(DVec3::ZERO, DVec3::X)));
}

#[test]
fn the_interval_is_open_below_and_closed_above() {
    for shape in [triangle(), plane(Vec3::ZERO, Vec3::Z), sphere(Vec3::new(0.25, 0.25, -1.0), 1.0)] {
        let world = Reference::build(&[shape]);
        let ray = |t_min, t_max| Ray64 { t_min, t_max, ..down(0.25, 0.25) };
        assert!(!world.occluded(&ray(3.0, 4.0)));
        assert!(world.occluded(&ray(3.0_f64.next_down(), 4.0)));
        assert!(world.occluded(&ray(0.0, 3.0)));
        assert!(!world.occluded(&ray(0.0, 3.0_f64.next_down())));
    }
}

#[test]
fn ties_go_to_the_lower_id_and_masks_hide() {
    let mut world = vec![plane(Vec3::ZERO, Vec3::Z), triangle(), triangle()];
    assert_eq!(Reference::build(&world).closest(&down(0.25, 0.25)).id(), (0, 0, 0));
    world[0].mask = GeometryMask::TRANSMISSIVE;
    world.swap(0, 2);
    let opaque = Ray64 { admits: GeometryMask::OPAQUE, ..down(0.25, 0.25) };
    assert_eq!(Reference::build(&world).closest(&opaque).id(), (0, 0, 0));
    world[0].mask = GeometryMask::TRANSMISSIVE;
    assert_eq!(Reference::build(&world).closest(&opaque).id(), (0, 1, 0));
}

#[test]
fn senseless_rays_and_shapes_meet_nothing_and_are_counted() {
    let nan = f32::NAN;
    let shapes = [
        mesh(vec![Vec3::ZERO, Vec3::X, Vec3::splat(nan)], vec![[0, 1, 2], [0, 0, 1], [1, 1, 1]]),
        mesh(vec![Vec3::ZERO, Vec3::X * 1e30, Vec3::Y], vec![[0, 1, 2]]),
        sphere(Vec3::ZERO, 0.0),
        sphere(Vec3::ZERO, -1.0),
        sphere(Vec3::ZERO, nan),
        sphere(Vec3::splat(f32::INFINITY), 1.0),
        plane(Vec3::ZERO, Vec3::ZERO),
        plane(Vec3::ZERO, Vec3::splat(nan)),
    ];
    let world = Reference::build(&shapes);
    assert_eq!(world.stats().dropped, 10);
    assert!(!world.occluded(&down(0.1, 0.1)));

    let world = Reference::build(&[sphere(Vec3::ZERO, 1.0), plane(Vec3::ZERO, Vec3::Z), triangle()]);
    let good = down(0.1, 0.1);
    assert!(world.occluded(&good));
    for bad in [
        Ray64 { dir: DVec3::ZERO, ..good },
        Ray64 { dir: DVec3::splat(f64::NAN), ..good },
        Ray64 { origin: DVec3::splat(f64::INFINITY), ..good },
        Ray64 { t_max: f64::NAN, ..good },
        Ray64 { t_min: f64::NAN, ..good },
        Ray64 { t_min: 5.0, t_max: 4.0, ..good },
    ] {
        assert!(!world.occluded(&bad) && !world.closest(&bad).is_hit() && world.all_hits(&bad).is_empty());
    }
    assert!(!Reference::build(&[]).occluded(&good));
}

#[test]
fn the_hierarchy_finds_what_trying_every_primitive_finds() {
    let mut numbers = Numbers(1);
    let mut positions = Vec::new();
    for _ in 0..400 {
        let corner = numbers.vector() * 5.0;
        positions.extend([corner, corner + numbers.vector(), corner + numbers.vector()]);
    }
    let triangles = (0..400).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mut shapes = vec![mesh(positions, triangles), plane(Vec3::ZERO, Vec3::new(0.6, 0.8, 0.0))];
    shapes.extend((0..50).map(|_| sphere(numbers.vector() * 5.0, 0.5)));
    let world = Reference::build(&shapes);
    let mut met = 0;
    for k in 0..4000 {
        let mut dir = numbers.vector();
        if k % 4 == 0 {
            dir[k / 4 % 3] = 0.0;
        }
        let ray = Ray64 { t_max: 20.0, ..Ray64::new(numbers.vector().as_dvec3() * 8.0, dir.as_dvec3()) };
        let probe = Probe::new(&ray);
        let all: Vec<_> = world.primitives.iter().flat_map(|p| p.meetings(&probe)).filter(|h| ray.sees(h.t)).collect();
        let nearest = all.iter().fold(Hit64::MISS, |best, h| if h.is_before(&best) { *h } else { best });
        assert_eq!(world.closest(&ray), nearest);
        assert_eq!(world.all_hits(&ray).len(), all.len());
        assert_eq!(world.occluded(&ray), !all.is_empty());
        met += usize::from(nearest.is_hit());
    }
    assert!(met > 1500, "{met}");
}

#[test]
fn no_ray_aimed_at_a_corner_or_an_edge_slips_into_a_closed_ball() {
    for (centre, radius) in [
        (Vec3::ZERO, 1.0),
        (Vec3::new(148_376.0, 1234.0, -223_423.0), 100.0),
        (Vec3::new(1e-3, 0.0, 0.0), 1e-8),
        (Vec3::ZERO, 1e15),
    ] {
        let ball = ball(centre, radius, 12);
        let world = Reference::build(&[geometry(Shape::Mesh(ball.clone()))]);
        let mut numbers = Numbers(7);
        for i in 0..ball.triangles.len() {
            let [a, b, c] = ball.corners(i).map(|p| p.as_dvec3());
            for target in [a, b, c, (a + b) * 0.5, a + (c - a) * 0.3, b + (c - b) * 0.9] {
                let from = centre.as_dvec3() + numbers.vector().as_dvec3() * f64::from(radius) * 0.5;
                let inside_out = Ray64::new(from, target - from);
                assert!(world.occluded(&inside_out), "{centre} {radius}: {inside_out:?}");
            }
        }
    }
}

/// Case RT-07 of the catalogue.
#[test]
fn an_edge_on_triangle_and_a_collinear_one_are_not_met() {
    let world = Reference::build(&[triangle(), mesh(vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0], vec![[0, 1, 2]])]);
    assert!(!world.occluded(&Ray64::new(DVec3::new(-1.0, 0.5, 0.0), DVec3::X)));
    assert!(!world.occluded(&Ray64::new(DVec3::new(-1.0, 0.0, 0.0), DVec3::X)));
    assert!(world.occluded(&Ray64::new(DVec3::new(0.5, 0.0, 1.0), -DVec3::Z)), "but the whole triangle's edge is");
}

#[test]
fn ten_thousand_equal_triangles_build_a_shallow_tree() {
    let world = Reference::build(&vec![triangle(); 10_000]);
    assert!(world.stats().depth <= 13, "{}", world.stats().depth);
    assert_eq!(world.all_hits(&down(0.25, 0.25)).len(), 10_000);
    assert_eq!(world.closest(&down(0.25, 0.25)).id(), (0, 0, 0));
}

#[test]
fn packets_answer_lane_by_lane_and_leave_inactive_lanes_alone() {
    let world = Reference::build(&[triangle()]);
    let mut rays = Ray8::default();
    rays.set_lane(1, &Ray::new(Vec3::new(0.25, 0.5, 3.0), -Vec3::Z));
    rays.set_lane(6, &Ray::new(Vec3::new(5.0, 0.5, 3.0), -Vec3::Z));
    let mut hits = Hit8::default();
    let marker = Hit { t: 9.0, u: 8.0, v: 7.0, instance: 6, geometry: 5, primitive: 4 };
    (0..8).for_each(|i| hits.set_lane(i, &marker));
    Intersector::closest(&world, &[rays], std::slice::from_mut(&mut hits), Coherence::Incoherent, &mut ());
    assert_eq!(hits.lane(0), marker);
    assert_eq!(hits.lane(1), Hit { t: 3.0, u: 0.25, v: 0.25, instance: 0, geometry: 0, primitive: 0 });
    assert_eq!(hits.lane(6), Hit::MISS);
    let mut blocked = [Mask8::ALL];
    Intersector::occluded(&world, &[rays], &mut blocked, Coherence::Coherent, &mut ());
    assert_eq!(blocked[0].bits(), 0b10);
}
