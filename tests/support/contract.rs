//! The promise of [`Intersector`], as tests that any implementor can be put through.

use glam::Vec3;
use vitrum::accel::{Coherence, Intersector};
use vitrum::geometry::{Geometry, GeometryMask, Hit, Hit8, Ray, Ray8, TriMesh};
use vitrum::simd::Mask8;

use super::{Rng, shapes};

/// Returns the closest hits of rays that share a mask, in order.
pub fn closest<I: Intersector>(of: &I, rays: &[Ray]) -> Vec<Hit> {
    let packets = Ray8::pack(rays);
    let mut hits = vec![Hit8::default(); packets.len()];
    of.closest(&packets, &mut hits, Coherence::Coherent, &mut I::Scratch::default());
    (0..rays.len()).map(|i| hits[i / 8].lane(i % 8)).collect()
}

/// Returns true for each occluded ray of a list that shares a mask.
pub fn occluded<I: Intersector>(of: &I, rays: &[Ray]) -> Vec<bool> {
    let packets = Ray8::pack(rays);
    let mut blocked = vec![Mask8::NONE; packets.len()];
    of.occluded(&packets, &mut blocked, Coherence::Coherent, &mut I::Scratch::default());
    (0..rays.len()).map(|i| blocked[i / 8].lane(i % 8)).collect()
}

/// The bits of a hit, for comparison to the last one.
pub fn bits(hit: &Hit) -> (u32, u32, u32, (u32, u32, u32)) {
    (hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.id())
}

/// Puts an implementor through everything below. `exactly` where it keeps the tie rule, gives the same bits in
/// whatever company a ray is traced, and sees behind the start; Embree does none of the three.
pub fn holds<I: Intersector>(build: impl Fn(&[Geometry]) -> I, exactly: bool) {
    an_empty_scene_is_never_met(&build);
    answers_by_hand(&build, exactly);
    both_faces_count(&build);
    an_interval_is_open_below_and_closed_above(&build, exactly);
    masks_hide(&build, exactly);
    impossible_rays_meet_nothing_and_disturb_nobody(&build, exactly);
    inactive_lanes_are_left_alone(&build, exactly);
    lanes_do_not_matter(&build, exactly);
    blocked_is_having_a_hit(&build);
    if exactly {
        an_interval_may_lie_behind_the_start(&build);
        the_lower_id_wins_a_tie(&build);
    }
}

/// Returns true if two hits are equal to the last bit if `exactly`, else up to rounding.
fn same(a: &Hit, b: &Hit, exactly: bool) -> bool {
    let near = |a: f32, b: f32, to: f32| (a - b).abs() <= to;
    let nearly = || a.id() == b.id() && near(a.t, b.t, 1e-5 * b.t) && near(a.u, b.u, 1e-3) && near(a.v, b.v, 1e-3);
    bits(a) == bits(b) || (!exactly && nearly())
}

fn ray(origin: [f32; 3], dir: [f32; 3]) -> Ray {
    Ray::new(Vec3::from(origin), Vec3::from(dir))
}

fn triangle(z: f32) -> TriMesh {
    let positions = vec![Vec3::new(-1.0, -1.0, z), Vec3::new(3.0, -1.0, z), Vec3::new(-1.0, 3.0, z)];
    TriMesh { positions, triangles: vec![[0, 1, 2]], ..Default::default() }
}

/// A scene with something of everything.
fn still_life() -> Vec<Geometry> {
    let mut rng = Rng::new(5);
    vec![
        shapes::masked(shapes::closed_sphere(16, 0.2, 1.0, Vec3::ZERO), GeometryMask::TRANSMISSIVE),
        shapes::ball(Vec3::new(2.0, 0.0, 0.0), 0.75, GeometryMask::TRANSMISSIVE),
        shapes::masked(shapes::cuboid(Vec3::new(-3.0, -1.0, -1.0), Vec3::new(-1.5, 0.5, 1.0)), GeometryMask::OPAQUE),
        shapes::masked(shapes::soup(300, 0.4, &mut rng), GeometryMask::OPAQUE),
        shapes::ball(Vec3::new(0.0, 2.5, 0.0), 1.0, GeometryMask::OPAQUE),
    ]
}

/// Rays from all around towards the middle, some of them axis-aligned, some with an interval of their own.
fn rays_at(radius: f32, n: usize, seed: u64) -> Vec<Ray> {
    let mut rng = Rng::new(seed);
    (0..n)
        .map(|i| {
            let origin = rng.direction() * radius;
            let mut ray = Ray::new(origin, rng.point() * 2.0 - origin);
            if i % 7 == 0 {
                let axis = rng.below(3);
                ray.dir = Vec3::AXES[axis] * if origin[axis] > 0.0 { -1.0 } else { 1.0 };
            }
            if i % 5 == 0 {
                ray.t_min = rng.unit();
                ray.t_max = ray.t_min + rng.unit();
            }
            ray
        })
        .collect()
}

/// Case BB-01 of the catalogue.
fn an_empty_scene_is_never_met<I: Intersector>(build: &impl Fn(&[Geometry]) -> I) {
    let empties = [vec![], vec![shapes::mesh(vec![], vec![])], vec![shapes::mesh(vec![Vec3::ZERO], vec![[0, 0, 0]])]];
    for geometry in empties {
        let it = build(&geometry);
        let rays = rays_at(3.0, 20, 1);
        assert!(closest(&it, &rays).iter().all(|h| *h == Hit::MISS));
        assert!(occluded(&it, &rays).iter().all(|b| !b));
        assert!(closest(&it, &[]).is_empty());
    }
}

fn answers_by_hand<I: Intersector>(build: &impl Fn(&[Geometry]) -> I, exactly: bool) {
    let ball = shapes::ball(Vec3::new(0.0, 0.0, 10.0), 1.0, GeometryMask::OPAQUE);
    let it = build(&[ball, shapes::masked(triangle(4.0), GeometryMask::OPAQUE)]);
    let hits = closest(
        &it,
        &[
            ray([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
            ray([0.0, 0.0, 5.0], [0.0, 0.0, 2.0]),
            ray([0.0, 0.0, 10.0], [0.0, 1.0, 0.0]),
            ray([2.0, 2.0, 0.0], [0.0, 0.0, 1.0]),
            ray([0.0, 0.0, 0.0], [0.0, 0.0, -1.0]),
        ],
    );
    assert!(same(&hits[0], &Hit { t: 4.0, u: 0.25, v: 0.25, instance: 0, geometry: 1, primitive: 0 }, exactly));
    assert_eq!((hits[1].t, hits[1].geometry, hits[1].primitive), (2.0, 0, 0));
    assert_eq!((hits[2].t, hits[2].geometry), (1.0, 0));
    assert_eq!(hits[3], Hit::MISS);
    assert_eq!(hits[4], Hit::MISS);
}

fn both_faces_count<I: Intersector>(build: &impl Fn(&[Geometry]) -> I) {
    let it = build(&[shapes::masked(triangle(1.0), GeometryMask::OPAQUE)]);
    let hits = closest(&it, &[ray([0.5, 0.25, 0.0], [0.0, 0.0, 1.0]), ray([0.5, 0.25, 2.0], [0.0, 0.0, -1.0])]);
    assert_eq!(hits[0], hits[1]);
    assert!(hits[0].is_hit());
}

fn an_interval_is_open_below_and_closed_above<I: Intersector>(build: &impl Fn(&[Geometry]) -> I, exactly: bool) {
    for geometry in [
        shapes::masked(triangle(2.0), GeometryMask::OPAQUE),
        shapes::ball(Vec3::new(0.0, 0.0, 3.0), 1.0, GeometryMask::OPAQUE),
    ] {
        let two_sided = matches!(geometry.shape, vitrum::geometry::Shape::Sphere(_));
        let it = build(&[geometry]);
        let straight = ray([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        let at = |t_min: f32, t_max: f32| closest(&it, &[Ray { t_min, t_max, ..straight }])[0];
        // What 2 is taken for: an ulp off where a division is a product with a guess.
        let t = at(0.0, 3.0).t;
        assert!(t == 2.0 || (!exactly && (t - 2.0).abs() < 1e-6));
        assert_eq!(at(0.0, t).t, t);
        assert_eq!(at(t.next_down(), t).t, t);
        assert_eq!(at(0.0, t.next_down()), Hit::MISS);
        assert_eq!(at(-5.0, 5.0).t, t);
        let behind = at(t, f32::INFINITY);
        if two_sided {
            assert_eq!(behind.t, 4.0);
        } else {
            assert_eq!(behind, Hit::MISS);
        }
    }
}

fn an_interval_may_lie_behind_the_start<I: Intersector>(build: &impl Fn(&[Geometry]) -> I) {
    let it = build(&[shapes::masked(triangle(-2.0), GeometryMask::OPAQUE)]);
    let back = Ray { t_min: -3.0, t_max: -1.0, ..ray([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]) };
    assert_eq!(closest(&it, &[back])[0].t, -2.0);
    assert!(occluded(&it, &[back])[0]);
}

fn masks_hide<I: Intersector>(build: &impl Fn(&[Geometry]) -> I, exactly: bool) {
    let it = build(&[
        shapes::masked(triangle(1.0), GeometryMask::OPAQUE),
        shapes::masked(triangle(2.0), GeometryMask::TRANSMISSIVE),
        shapes::ball(Vec3::new(0.0, 0.0, 5.0), 1.0, GeometryMask::OPAQUE),
        shapes::ball(Vec3::new(0.0, 0.0, 8.0), 1.0, GeometryMask::TRANSMISSIVE),
    ]);
    let expected = [
        (GeometryMask::OPAQUE, 0.0, 1.0),
        (GeometryMask::TRANSMISSIVE, 0.0, 2.0),
        (GeometryMask::ALL, 0.0, 1.0),
        (GeometryMask::OPAQUE, 1.5, 4.0),
        (GeometryMask::TRANSMISSIVE, 2.5, 7.0),
        (GeometryMask(0), 0.0, f32::INFINITY),
        (GeometryMask(4), 0.0, f32::INFINITY),
    ];
    for (admits, t_min, t) in expected {
        let one = Ray { admits, t_min, ..ray([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]) };
        let hits = closest(&it, &[one; 8]);
        let right = |h: &Hit| h.t == t || (!exactly && (h.t - t).abs() < 1e-6);
        assert!(hits.iter().all(right), "{admits:?} from {t_min}: {hits:?}");
        assert!(occluded(&it, &[one; 8]).iter().all(|&b| b == t.is_finite()));
    }
}

/// A ray that can meet nothing, of every sort.
fn impossible() -> Vec<Ray> {
    let good = ray([0.1, 0.2, -4.0], [0.0, 0.05, 1.0]);
    let mut all = vec![
        Ray { dir: Vec3::ZERO, ..good },
        Ray { dir: -Vec3::ZERO, ..good },
        Ray { t_min: 1.0, t_max: 1.0, ..good },
        Ray { t_min: 5.0, t_max: 2.0, ..good },
        Ray { t_min: f32::NAN, ..good },
        Ray { t_max: f32::NAN, ..good },
        Ray { t_max: f32::NEG_INFINITY, ..good },
        Ray { t_min: f32::INFINITY, ..good },
        Ray { t_max: 0.0, ..good },
    ];
    for axis in 0..3 {
        let put = |mut v: Vec3, x: f32| {
            v[axis] = x;
            v
        };
        all.push(Ray { dir: put(good.dir, f32::NAN), ..good });
        all.push(Ray { origin: put(good.origin, f32::NAN), ..good });
        all.push(Ray { origin: put(good.origin, f32::INFINITY), ..good });
    }
    all
}

/// Cases RB-04, TR-02, TR-05, LN-03 of the catalogue.
fn impossible_rays_meet_nothing_and_disturb_nobody<I: Intersector>(build: &impl Fn(&[Geometry]) -> I, exactly: bool) {
    let it = build(&still_life());
    let good = rays_at(5.0, 8, 17);
    let (want, want_blocked) = (closest(&it, &good), occluded(&it, &good));
    assert!(want.iter().any(Hit::is_hit));
    for bad in impossible() {
        for lane in 0..8 {
            let mut rays = good.clone();
            rays[lane] = bad;
            let (hits, blocked) = (closest(&it, &rays), occluded(&it, &rays));
            for i in 0..8 {
                let (expected, expected_blocked) =
                    if i == lane { (Hit::MISS, false) } else { (want[i], want_blocked[i]) };
                assert!(same(&hits[i], &expected, exactly), "lane {i} beside {bad:?} in lane {lane}");
                assert_eq!(blocked[i], expected_blocked);
            }
        }
        assert!(closest(&it, &[bad; 8]).iter().all(|h| *h == Hit::MISS), "{bad:?}");
    }
}

/// Cases LN-01, LN-02 of the catalogue.
fn inactive_lanes_are_left_alone<I: Intersector>(build: &impl Fn(&[Geometry]) -> I, exactly: bool) {
    let it = build(&still_life());
    let good = rays_at(5.0, 8, 23);
    let want = closest(&it, &good);
    let want_blocked = occluded(&it, &good);
    let mark = Hit { t: -7.5, u: f32::NAN, v: 3.0, instance: 9, geometry: 77, primitive: 78 };
    let poisons = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, 1e-45, f32::MAX];
    let mut scratch = I::Scratch::default();
    for active in 0..=u8::MAX {
        for poison in poisons {
            let mut packet = Ray8::pack(&good)[0];
            let mut hits = [Hit8::default()];
            packet.active = active;
            for i in 0..8 {
                hits[0].set_lane(i, &mark);
                if active >> i & 1 == 0 {
                    packet.origin.set_lane(i, Vec3::splat(poison));
                    packet.dir.set_lane(i, Vec3::splat(poison));
                    packet.t_min.set_lane(i, poison);
                    packet.t_max.set_lane(i, poison);
                }
            }
            let mut blocked = [Mask8::ALL];
            let coherence = if active & 1 == 0 { Coherence::Coherent } else { Coherence::Incoherent };
            it.closest(&[packet], &mut hits, coherence, &mut scratch);
            it.occluded(&[packet], &mut blocked, coherence, &mut scratch);
            for i in 0..8 {
                let on = active >> i & 1 != 0;
                let (expected, exactly) = if on { (want[i], exactly) } else { (mark, true) };
                assert!(same(&hits[0].lane(i), &expected, exactly), "lane {i} of {active:08b} beside {poison}");
                assert_eq!(blocked[0].lane(i), on && want_blocked[i], "lane {i} of {active:08b} beside {poison}");
            }
        }
    }
}

/// Case LN-08 of the catalogue.
fn lanes_do_not_matter<I: Intersector>(build: &impl Fn(&[Geometry]) -> I, exactly: bool) {
    let it = build(&still_life());
    let rays = rays_at(4.0, 800, 29);
    let want = closest(&it, &rays);
    let mut rng = Rng::new(31);
    for _ in 0..4 {
        let mut order: Vec<usize> = (0..rays.len()).collect();
        for i in (1..order.len()).rev() {
            order.swap(i, rng.below(i + 1));
        }
        let shuffled: Vec<Ray> = order.iter().map(|&i| rays[i]).collect();
        for (&i, got) in order.iter().zip(closest(&it, &shuffled)) {
            assert!(same(&got, &want[i], exactly), "{:?}", rays[i]);
        }
    }
    for (ray, want) in rays.iter().zip(&want) {
        assert!(same(&closest(&it, std::slice::from_ref(ray))[0], want, exactly), "{ray:?}");
    }
}

/// Case TR-04 of the catalogue.
fn blocked_is_having_a_hit<I: Intersector>(build: &impl Fn(&[Geometry]) -> I) {
    let it = build(&still_life());
    for admits in [GeometryMask::ALL, GeometryMask::OPAQUE, GeometryMask::TRANSMISSIVE] {
        let rays: Vec<Ray> = rays_at(3.0, 4000, 37).iter().map(|r| Ray { admits, ..*r }).collect();
        let (hits, blocked) = (closest(&it, &rays), occluded(&it, &rays));
        let count = hits.iter().filter(|h| h.is_hit()).count();
        assert!((400..3900).contains(&count), "{count} hits would not tell much");
        for ((ray, hit), blocked) in rays.iter().zip(&hits).zip(blocked) {
            assert_eq!(hit.is_hit(), blocked, "{ray:?}");
            assert!(!hit.is_hit() || (ray.t_min < hit.t && hit.t <= ray.t_max));
        }
    }
}

/// Cases RT-17, TR-03 of the catalogue.
fn the_lower_id_wins_a_tie<I: Intersector>(build: &impl Fn(&[Geometry]) -> I) {
    // The same triangle twenty times in one mesh and once in each of five, behind two equal balls.
    let mut many = triangle(1.0);
    many.triangles = vec![[0, 1, 2]; 20];
    let ball = |_| shapes::ball(Vec3::new(0.0, 0.0, 2.0), 1.0, GeometryMask::OPAQUE);
    let flat = |_| shapes::masked(triangle(1.0), GeometryMask::OPAQUE);
    let straight = [ray([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]); 8];
    let orders: [Vec<Geometry>; 3] = [
        (0..5).map(flat).chain([shapes::masked(many.clone(), GeometryMask::OPAQUE)]).chain((0..2).map(ball)).collect(),
        [shapes::masked(many.clone(), GeometryMask::OPAQUE)].into_iter().chain((0..5).map(flat)).collect(),
        (0..2).map(ball).chain((0..5).map(flat)).chain([shapes::masked(many, GeometryMask::OPAQUE)]).collect(),
    ];
    for geometry in orders {
        for hit in closest(&build(&geometry), &straight) {
            assert_eq!((hit.t, hit.id()), (1.0, (0, 0, 0)));
        }
    }
}
