use glam::{DVec3, Vec3};

use super::*;
use crate::accel::{Coherence, Intersector};
use crate::geometry::{GeometryMask, Hit, Hit8, Plane, Ray, Ray8, Shape, Sphere, TriMesh};
use crate::simd::Mask8;

fn geometry(shape: Shape) -> Geometry {
    Geometry { shape, mask: GeometryMask::OPAQUE }
}

fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Geometry {
    geometry(Shape::Mesh(TriMesh { positions, triangles, ..TriMesh::default() }))
}

fn sphere(centre: Vec3, radius: f32) -> Geometry {
    geometry(Shape::Sphere(Sphere { centre, radius }))
}

fn plane(point: Vec3, normal: Vec3) -> Geometry {
    geometry(Shape::Plane(Plane { point, normal }))
}

/// The triangle (0,0,0), (1,0,0), (0,2,0), counter-clockwise seen from +z.
fn triangle() -> Geometry {
    mesh(vec![Vec3::ZERO, Vec3::X, Vec3::new(0.0, 2.0, 0.0)], vec![[0, 1, 2]])
}

/// A closed ball of triangles, `2 n` by `n`, poles shared.
fn ball(centre: Vec3, radius: f32, n: u32) -> TriMesh {
    let mut positions = vec![centre + Vec3::Y * radius];
    for i in 1..n {
        let (sin, cos) = (std::f32::consts::PI * i as f32 / n as f32).sin_cos();
        for j in 0..2 * n {
            let (s, c) = (std::f32::consts::PI * j as f32 / n as f32).sin_cos();
            positions.push(centre + Vec3::new(sin * c, cos, sin * s) * radius);
        }
    }
    positions.push(centre - Vec3::Y * radius);
    let last = positions.len() as u32 - 1;
    let at = |i: u32, j: u32| 1 + (i - 1) * 2 * n + j % (2 * n);
    let mut triangles = Vec::new();
    for j in 0..2 * n {
        triangles.push([0, at(1, j + 1), at(1, j)]);
        triangles.push([last, at(n - 1, j), at(n - 1, j + 1)]);
        for i in 1..n - 1 {
            triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
            triangles.push([at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    TriMesh { positions, triangles, ..TriMesh::default() }
}

/// Numbers in -1..1, the same in every run (xorshift, Marsaglia 2003).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

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

mod judging {
    use super::*;

    fn ray(x: f32, y: f32) -> Ray {
        Ray::new(Vec3::new(x, y, 3.0), -Vec3::Z)
    }

    fn hit(geometry: u32, t: f32) -> Hit {
        Hit { t, geometry, ..Hit::MISS }
    }

    /// Two triangles, one a unit below the other.
    fn two() -> Reference {
        let below = mesh(
            vec![Vec3::new(0.0, 0.0, -1.0), Vec3::new(1.0, 0.0, -1.0), Vec3::new(0.0, 2.0, -1.0)],
            vec![[0, 1, 2]],
        );
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
        assert_eq!(undecidable(world.judge(&sharp, &Hit::MISS)), Cause::Edge);
        assert_eq!(undecidable(world.judge(&sharp, &hit(1, 4.0))), Cause::Edge);
        assert_eq!(world.judge(&sharp, &hit(0, 3.0)), Verdict::Agrees);
        let beside = ray(-1e-9, 0.5);
        assert_eq!(undecidable(world.judge(&beside, &hit(0, 3.0))), Cause::Edge);
        assert_eq!(undecidable(world.judge_occluded(&beside, true)), Cause::Edge);
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
        assert!(matches!(undecidable(world.judge(&ray(1.0, 0.25), &Hit::MISS)), Cause::Edge), "an open edge is none");
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
}
