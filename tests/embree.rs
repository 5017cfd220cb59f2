//! The Embree back end keeps the contract of `accel::Intersector`.
//!
//! Where no library is found the tests say so and pass, unless VITRUM_REQUIRE_EMBREE is set.

use crate::support;

use std::io::Write;

use glam::{DVec3, Vec3};
use vitrum::accel::embree::Library;
use vitrum::accel::embree::{Embree, Isa, Mode, Options, Quality, Spheres, Width};
use vitrum::accel::native::Native;
use vitrum::accel::{Coherence, Intersector, Unbounded};
use vitrum::geometry::{
    COORDINATE_LIMIT, Geometry, GeometryMask, Hit, Hit8, NO_GEOMETRY, Plane, Ray, Ray8, Shape, Sphere, TriMesh,
};
use vitrum::simd::Mask8;

const WIDTHS: [Width; 4] = [Width::Auto, Width::One, Width::Eight, Width::Sixteen];
const BOTH: [Coherence; 2] = [Coherence::Coherent, Coherence::Incoherent];

/// The library, or word on the terminal that the test was left out (test output that passes is not shown).
fn library(test: &str) -> Option<&'static Library> {
    match Library::open(None) {
        Ok(library) => Some(library),
        Err(e) if std::env::var_os("VITRUM_REQUIRE_EMBREE").is_some() => panic!("{test}: {e}"),
        Err(e) => {
            writeln!(std::io::stderr(), "SKIPPED {test}: {e}").ok();
            None
        }
    }
}

/// All ways to trace that should give the same hits.
fn every_way() -> impl Iterator<Item = Options> {
    [Mode::Robust, Mode::Fast]
        .into_iter()
        .flat_map(|mode| WIDTHS.into_iter().map(move |width| Options { mode, width, threads: 1, ..Options::default() }))
}

fn mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Geometry {
    let positions = positions.iter().map(|&p| p.into()).collect();
    let mesh = TriMesh { positions, triangles: triangles.to_vec(), ..TriMesh::default() };
    Geometry { shape: Shape::Mesh(mesh), mask: GeometryMask::ALL }
}

fn ball(centre: Vec3, radius: f32) -> Geometry {
    Geometry { shape: Shape::Sphere(Sphere { centre, radius }), mask: GeometryMask::ALL }
}

fn build(geometry: &[Geometry], options: &Options) -> Embree {
    Embree::build(geometry, options).unwrap()
}

fn trace<I: Intersector>(accel: &I, rays: &[Ray], coherence: Coherence) -> (Vec<Hit>, Vec<bool>) {
    let packets = Ray8::pack(rays);
    let mut hits = vec![Hit8::default(); packets.len()];
    let mut blocked = vec![Mask8::NONE; packets.len()];
    let mut scratch = I::Scratch::default();
    accel.closest(&packets, &mut hits, coherence, &mut scratch);
    accel.occluded(&packets, &mut blocked, coherence, &mut scratch);
    let lanes = || (0..rays.len()).map(|i| (i / 8, i % 8));
    (lanes().map(|(p, i)| hits[p].lane(i)).collect(), lanes().map(|(p, i)| blocked[p].lane(i)).collect())
}

fn one(accel: &Embree, ray: &Ray) -> Hit {
    trace(accel, std::slice::from_ref(ray), Coherence::Incoherent).0[0]
}

/// Numbers in 0..1 from a seed.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 24) as f32
    }

    fn point(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
    }
}

/// Case PA-04 of the catalogue.
#[test]
fn the_contract_holds_but_for_ties_bits_and_looking_back() {
    if library("contract").is_none() {
        return;
    }
    for width in WIDTHS {
        let options = Options { width, threads: 1, ..Options::default() };
        support::contract::holds(|geometry| build(geometry, &options), false);
    }
    let options = Options { threads: 1, ..Options::default() };
    support::contract::holds(|geometry| Unbounded::new(build(geometry, &options), geometry), false);
    let mut levels = 0;
    for isa in Isa::LEVELS {
        let options = Options { isa, ..options.clone() };
        if Embree::build(&[], &options).is_ok() {
            support::contract::holds(|geometry| build(geometry, &options), false);
            levels += 1;
        }
    }
    assert!(levels > 0, "no instructions that Embree can use");
}

/// Case PA-03 of the catalogue.
#[test]
fn weights_and_ids_are_those_of_the_contract() {
    if library("weights and ids").is_none() {
        return;
    }
    // Geometry 0 is out of the way; the ray meets triangle 2 of geometry 1 at weights 1/2, 1/8 and 3/8.
    let away = mesh(&[[9.0, 9.0, 9.0], [10.0, 9.0, 9.0], [9.0, 10.0, 9.0]], &[[0, 1, 2]]);
    let here = mesh(
        &[[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 16.0, 0.0], [50.0, 0.0, 0.0], [50.0, 1.0, 0.0], [50.0, 0.0, 1.0]],
        &[[3, 4, 5], [3, 5, 4], [0, 1, 2]],
    );
    for options in every_way() {
        let accel = build(&[away.clone(), here.clone()], &options);
        for (z, dir) in [(4.0, Vec3::NEG_Z), (-4.0, Vec3::Z)] {
            let hit = one(&accel, &Ray::new(Vec3::new(1.0, 6.0, z), dir));
            assert_eq!(hit.id(), (0, 1, 2), "{options:?}");
            assert!(
                (hit.t - 4.0).abs() < 1e-6 && (hit.u - 0.125).abs() < 1e-6 && (hit.v - 0.375).abs() < 1e-6,
                "{hit:?}, {options:?}"
            );
        }
        assert_eq!(one(&accel, &Ray::new(Vec3::new(-1.0, 6.0, 4.0), Vec3::NEG_Z)), Hit::MISS);
    }
}

#[test]
fn rays_pass_through_what_their_mask_does_not_meet() {
    if library("masks").is_none() {
        return;
    }
    let wall = |z: f32, mask| {
        let mut g = mesh(&[[-9.0, -9.0, z], [9.0, -9.0, z], [0.0, 9.0, z]], &[[0, 1, 2]]);
        g.mask = mask;
        g
    };
    let mut glass = ball(Vec3::new(0.0, 0.0, -5.0), 1.0);
    glass.mask = GeometryMask::TRANSMISSIVE;
    let shapes = [
        wall(-1.0, GeometryMask::TRANSMISSIVE),
        glass,
        wall(-8.0, GeometryMask::OPAQUE),
        wall(-9.0, GeometryMask::ALL),
    ];
    for options in every_way() {
        let accel = build(&shapes, &options);
        for (admits, near, want) in [
            (GeometryMask::ALL, 0.0, Some(0)),
            (GeometryMask::TRANSMISSIVE, 0.0, Some(0)),
            (GeometryMask::TRANSMISSIVE, 2.0, Some(1)),
            (GeometryMask::OPAQUE, 0.0, Some(2)),
            (GeometryMask::TRANSMISSIVE, 7.0, Some(3)),
            (GeometryMask(0), 0.0, None),
        ] {
            let rays = [Ray { t_min: near, admits, ..Ray::new(Vec3::ZERO, Vec3::NEG_Z) }; 16];
            let (hits, blocked) = trace(&accel, &rays, Coherence::Coherent);
            for (hit, blocked) in hits.into_iter().zip(blocked) {
                assert_eq!(hit.is_hit().then_some(hit.geometry), want, "{admits:?} from {near}, {options:?}");
                assert_eq!(blocked, want.is_some());
            }
        }
    }
}

#[test]
fn inactive_lanes_are_left_untouched_and_disturb_no_other() {
    if library("inactive lanes").is_none() {
        return;
    }
    let shapes = soup(60, 3);
    let mut random = Random(4);
    let rays: Vec<Ray> = (0..16).map(|_| Ray::new(random.point() * 3.0, random.point())).collect();
    let poison = Ray::new(Vec3::splat(f32::NAN), Vec3::new(0.0, f32::INFINITY, f32::NAN));
    let mark = Hit { t: -7.0, u: 3.0, v: 4.0, instance: 5, geometry: 6, primitive: 7 };
    for options in every_way() {
        let accel = build(&shapes, &options);
        for coherence in BOTH {
            let (want, want_blocked) = trace(&accel, &rays, coherence);
            for mask in 0..=255_u8 {
                let lanes = [mask, mask.rotate_left(3)];
                let mut packets = Ray8::pack(&rays);
                let mut hits = [Hit8::default(); 2];
                let mut blocked = [Mask8::ALL; 2];
                for (p, &active) in lanes.iter().enumerate() {
                    for i in 0..8 {
                        if active >> i & 1 == 0 {
                            packets[p].set_lane(i, &poison);
                        }
                        hits[p].set_lane(i, &mark);
                    }
                    packets[p].active = active;
                }
                let mut scratch = Default::default();
                accel.closest(&packets, &mut hits, coherence, &mut scratch);
                accel.occluded(&packets, &mut blocked, coherence, &mut scratch);
                for i in 0..16 {
                    let active = lanes[i / 8] >> (i % 8) & 1 != 0;
                    let hit = hits[i / 8].lane(i % 8);
                    if active {
                        // The other lanes decide which of Embree's kernels runs, and so the last bits.
                        assert_eq!(hit.id(), want[i].id(), "{mask:08b} {i} {options:?}");
                        assert!(hit.t == want[i].t || (hit.t - want[i].t).abs() < 1e-4 * want[i].t);
                    } else {
                        assert_eq!(hit, mark, "{mask:08b} {i} {options:?}");
                    }
                    assert_eq!(blocked[i / 8].lane(i % 8), active && want_blocked[i], "{mask:08b} {i} {options:?}");
                }
            }
        }
    }
}

#[test]
fn rays_that_can_meet_nothing_do_and_disturb_no_other_lane() {
    if library("invalid rays").is_none() {
        return;
    }
    let shapes = [ball(Vec3::ZERO, 1.0), soup(50, 8).remove(0)];
    let good = Ray::new(Vec3::new(0.1, 0.2, 3.0), Vec3::NEG_Z);
    let nan = f32::NAN;
    let bad = [
        Ray { dir: Vec3::ZERO, ..good },
        Ray { dir: Vec3::new(0.0, nan, -1.0), ..good },
        Ray { dir: Vec3::new(f32::INFINITY, 0.0, 0.0), ..good },
        Ray { origin: Vec3::new(nan, 0.0, 3.0), ..good },
        Ray { origin: Vec3::new(0.0, f32::NEG_INFINITY, 3.0), ..good },
        Ray { t_min: nan, ..good },
        Ray { t_max: nan, ..good },
        Ray { t_min: 5.0, t_max: 1.0, ..good },
        Ray { t_min: 1.0, t_max: 1.0, ..good },
        Ray { t_min: 0.0, t_max: 0.0, ..good },
        Ray { t_min: f32::INFINITY, ..good },
        Ray { t_max: f32::NEG_INFINITY, ..good },
        Ray { t_min: -5.0, t_max: -1.0, ..good },
    ];
    for options in every_way() {
        let accel = build(&shapes, &options);
        for coherence in BOTH {
            let want = trace(&accel, &[good; 16], coherence).0[0];
            assert!(want.is_hit());
            for bad in &bad {
                for lane in 0..16 {
                    let mut rays = [good; 16];
                    rays[lane] = *bad;
                    let (hits, blocked) = trace(&accel, &rays, coherence);
                    for i in 0..16 {
                        let want = if i == lane { Hit::MISS } else { want };
                        assert_eq!(
                            (hits[i].id(), blocked[i]),
                            (want.id(), want.is_hit()),
                            "{bad:?} {lane} {options:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn an_interval_excludes_its_start_and_includes_its_end_at_every_width_and_isa() {
    if library("interval").is_none() {
        return;
    }
    let wall = mesh(&[[-8.0, -8.0, 0.0], [8.0, -8.0, 0.0], [0.0, 8.0, 0.0]], &[[0, 1, 2]]);
    let ways = [Isa::Best].into_iter().chain(Isa::LEVELS).flat_map(|isa| WIDTHS.map(|width| (isa, width)));
    for (isa, width) in ways {
        let options = Options { isa, width, threads: 1, ..Options::default() };
        if Embree::build(&[], &options).is_err() {
            continue;
        }
        for shape in [&wall, &ball(Vec3::new(0.0, 0.0, -1.0), 1.0)] {
            let accel = build(std::slice::from_ref(shape), &options);
            // The same ray in sixteen lanes, so that one kernel sees it; then by itself.
            let first = |z: f32, t_min: f32, t_max: f32| {
                let rays = [Ray { t_min, t_max, ..Ray::new(Vec3::new(0.0, 0.0, z), Vec3::NEG_Z) }; 17];
                let (hits, blocked) = trace(&accel, &rays, Coherence::Coherent);
                assert!(hits.iter().zip(blocked).all(|(h, b)| h.is_hit() == b));
                assert!(hits[..16].iter().all(|h| h.t == hits[0].t));
                hits[0].t
            };
            for z in [4.0, 1.0, 0.3] {
                let t = first(z, 0.0, 100.0);
                assert!((t - z).abs() < 1e-6, "{z} {options:?}");
                let (below, above) = (t.next_down(), t.next_up());
                assert!(
                    first(z, 0.0, t) == t && first(z, below, t) == t && first(z, below, above) == t,
                    "{z} {options:?}"
                );
                // The sphere is met again on its far side, two further on.
                assert!(first(z, t, above) > 100.0 && first(z, 0.0, below) > 100.0, "{z} {options:?}");
                assert!(first(z, t, 100.0) > t + 1.0, "{z} {options:?}");
            }
            assert!(first(0.0, 0.0, 100.0) > 1.0, "a start on the surface, {options:?}");
        }
    }
}

/// Case PA-06 of the catalogue.
#[test]
fn unusable_shapes_are_left_out_and_counted_and_the_others_keep_their_ids() {
    if library("dropped shapes").is_none() {
        return;
    }
    let inf = f32::INFINITY;
    let positions = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [f32::NAN, 0.0, 0.0],
        [inf, 0.0, 0.0],
        [3e18, 0.0, 0.0],
        [0.0, 0.0, 0.0],
    ];
    let triangles = [[0, 1, 3], [0, 4, 2], [0, 0, 1], [5, 1, 2], [0, 1, 2], [0, 6, 1], [0, 2, 1]];
    let shapes = [ball(Vec3::ZERO, 0.0), mesh(&positions, &triangles), ball(Vec3::NAN, 1.0), ball(Vec3::X * 9.0, -1.0)];
    for options in every_way() {
        let accel = build(&shapes, &options);
        let stats = accel.build_stats();
        assert_eq!((stats.triangles, stats.spheres, stats.dropped), (2, 0, 8));
        let hit = one(&accel, &Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z));
        assert_eq!(hit.geometry, 1);
        assert!(hit.primitive == 4 || hit.primitive == 6, "{hit:?}");
    }
    let nothing = build(&[], &Options::default());
    assert_eq!(one(&nothing, &Ray::new(Vec3::ZERO, Vec3::X)), Hit::MISS);
    let all_dropped = build(&shapes[..1], &Options::default());
    assert_eq!(one(&all_dropped, &Ray::new(Vec3::ZERO, Vec3::X)).geometry, NO_GEOMETRY);
}

#[test]
fn shapes_as_far_out_as_is_allowed_are_hit() {
    if library("far out").is_none() {
        return;
    }
    let far = COORDINATE_LIMIT;
    // Not as large as far away: Embree's t of a triangle is a product of three lengths before it is a quotient.
    let wall = mesh(&[[-9e8, -9e8, -far], [9e8, -9e8, -far], [-9e8, 9e8, -far]], &[[0, 1, 2]]);
    let huge = ball(Vec3::ZERO, far.next_down());
    let down = Ray::new(Vec3::new(-4e8, -4e8, 0.0), Vec3::NEG_Z);
    for shape in [wall, huge] {
        for isa in [Isa::Best, Isa::Avx2] {
            let options = Options { isa, even_lost: true, ..Options::default() };
            if Embree::build(&[], &options).is_err() {
                continue;
            }
            let accel = build(std::slice::from_ref(&shape), &options);
            let stats = accel.build_stats();
            assert_eq!((stats.triangles + stats.spheres, stats.dropped), (1, 0));
            assert!(one(&accel, &down).is_hit(), "{:?} {isa:?}", shape.shape);
        }
    }
}

/// A tessellated ball around the origin, and rays at it from three and from thirty radii away.
fn far_ball(radius: f32) -> (Geometry, Vec<Ray>) {
    let mut mesh = vitrum::load::shapes::sphere(12);
    mesh.positions.iter_mut().for_each(|p| *p *= radius);
    let mut random = Random(7);
    let mut point = || Vec3::new(random.next() - 0.5, random.next() - 0.5, random.next() - 0.5);
    let rays = (0..200).map(|i| {
        let from = point().normalize() * [3.0, 30.0][i % 2];
        Ray::new(from * radius, (point() - from).normalize())
    });
    let rays = rays.collect();
    (Geometry { shape: Shape::Mesh(mesh), mask: GeometryMask::ALL }, rays)
}

#[test]
fn what_embree_would_lose_is_refused_and_nothing_else_is_lost() {
    if library("sizes").is_none() {
        return;
    }
    let hits = |radius: f32, options: &Options| {
        let (ball, rays) = far_ball(radius);
        let hits = trace(&build(std::slice::from_ref(&ball), options), &rays, Coherence::Incoherent).0;
        // What is met lies near the ball's surface.
        let near = |(hit, ray): (&Hit, &Ray)| {
            let place = ray.origin.as_dvec3() + ray.dir.as_dvec3() * f64::from(hit.t);
            hit.is_hit() && (place.length() / f64::from(radius) - 1.0).abs() < 0.1
        };
        hits.iter().zip(&rays).filter(|&pair| near(pair)).count()
    };
    for mode in [Mode::Robust, Mode::Fast] {
        let options = Options { mode, ..Options::default() };
        for radius in [1.1e-6, 1e-3, 1.0, 1e6, 1e9, 9.9e11] {
            assert_eq!(hits(radius, &options), 200, "{radius:e} {mode:?}");
        }
        for radius in [1e-15, 1e-9, 9e-7, 1.1e12, 1e14, 1e17] {
            let refused = Embree::build(&[far_ball(radius).0], &options).err().unwrap();
            assert_eq!(refused.exit_code(), 4);
            assert!(refused.to_string().contains("shape 1") && refused.to_string().contains("native"), "{refused}");
        }
        // The reason for all this. Once it no longer holds, the refusal can go.
        for radius in [1e-16, 1e14] {
            assert_eq!(hits(radius, &Options { even_lost: true, ..options.clone() }), 0, "{radius:e} {mode:?}");
        }
    }
}

/// Triangles in three meshes, of sizes from 0.01 to 1, with no order to them.
fn soup(count: usize, seed: u64) -> Vec<Geometry> {
    let mut random = Random(seed);
    (0..3)
        .map(|_| {
            let mut positions = Vec::new();
            for _ in 0..count {
                let (centre, size) = (random.point(), 10_f32.powf(-2.0 * random.next()));
                positions.extend((0..3).map(|_| (centre + random.point() * size).to_array()));
            }
            let triangles: Vec<[u32; 3]> = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            mesh(&positions, &triangles)
        })
        .collect()
}

/// Every meeting of a ray with triangles and spheres in `f64`: parameter, id, and by how much it is not a near miss.
fn brute_force(shapes: &[Geometry], ray: &Ray) -> Vec<(f64, (u32, u32), f64)> {
    let (o, d) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
    let mut met = Vec::new();
    for (g, shape) in shapes.iter().enumerate() {
        let Shape::Mesh(mesh) = &shape.shape else { continue };
        for i in 0..mesh.triangles.len() {
            let [a, b, c] = mesh.corners(i).map(|p| p.as_dvec3());
            let (e1, e2): (DVec3, DVec3) = (b - a, c - a);
            let p = d.cross(e2);
            let det = e1.dot(p);
            let s = o - a;
            let (u, q) = (s.dot(p) / det, s.cross(e1));
            let (v, t) = (d.dot(q) / det, e2.dot(q) / det);
            let margin = u.min(v).min(1.0 - u - v);
            if t > 0.0 && margin > -1e-3 {
                met.push((t, (g as u32, i as u32), margin));
            }
        }
    }
    met.sort_by(|a, b| a.0.total_cmp(&b.0));
    met
}

/// Case PA-01 of the catalogue.
#[test]
fn hits_are_those_of_a_brute_force_search_in_f64() {
    if library("brute force").is_none() {
        return;
    }
    let shapes = soup(200, 1);
    let mut random = Random(2);
    let rays: Vec<Ray> = (0..3000)
        .map(|_| {
            let (from, to) = (random.point() * 2.0, random.point());
            Ray::new(from, to - from)
        })
        .collect();
    let want: Vec<_> = rays.iter().map(|ray| brute_force(&shapes, ray)).collect();
    for options in every_way() {
        let accel = build(&shapes, &options);
        for coherence in BOTH {
            let (hits, blocked) = trace(&accel, &rays, coherence);
            let (mut clear, mut met) = (0, 0);
            for ((hit, blocked), want) in hits.iter().zip(blocked).zip(&want) {
                // Rays that pass close by an edge, or meet two triangles at nearly one place, prove nothing.
                let close_call = want.iter().any(|w| w.2.abs() < 1e-3 || w.0 < 1e-3);
                let tie = want.windows(2).any(|w| w[1].0 - w[0].0 < 1e-4);
                if close_call || tie {
                    continue;
                }
                clear += 1;
                assert_eq!(hit.is_hit(), !want.is_empty(), "{options:?}");
                assert_eq!(blocked, !want.is_empty(), "{options:?}");
                if let Some(&(t, id, _)) = want.first() {
                    met += 1;
                    assert_eq!((hit.geometry, hit.primitive), id, "{options:?}");
                    assert!((f64::from(hit.t) - t).abs() < 1e-4, "{} for {t}", hit.t);
                }
            }
            assert!(clear > 2000 && met > 500, "{clear} of {} rays tell, {met} hit", rays.len());
        }
    }
}

#[test]
fn what_is_hit_blocks_and_what_blocks_is_hit() {
    if library("closest and occluded").is_none() {
        return;
    }
    let mut shapes = soup(300, 5);
    let mut random = Random(6);
    shapes.extend((0..40).map(|_| ball(random.point(), 0.02 + 0.1 * random.next())));
    let rays: Vec<Ray> = (0..20_000)
        .map(|_| Ray { t_max: 2.0 * random.next(), ..Ray::new(random.point() * 1.5, random.point()) })
        .collect();
    for width in WIDTHS {
        let accel = build(&shapes, &Options { width, ..Options::default() });
        for coherence in BOTH {
            let (hits, blocked) = trace(&accel, &rays, coherence);
            let differ = hits.iter().zip(&blocked).filter(|(h, b)| h.is_hit() != **b).count();
            assert_eq!(differ, 0, "{width:?} {coherence:?}");
            assert!(hits.iter().zip(&rays).all(|(h, r)| !h.is_hit() || (r.t_min < h.t && h.t <= r.t_max)));
        }
    }
}

#[test]
fn spheres_are_met_outside_inside_and_by_embrees_own_points() {
    if library("spheres").is_none() {
        return;
    }
    let shapes = [soup(10, 9).remove(0), ball(Vec3::new(0.0, 0.0, -8.0), 2.0), ball(Vec3::new(50.0, 0.0, 0.0), 4.0)];
    for spheres in [Spheres::Native, Spheres::Points] {
        for options in every_way() {
            let options = Options { spheres, ..options };
            let accel = build(&shapes, &options);
            assert_eq!(accel.build_stats().spheres, 2);
            let outside = one(&accel, &Ray::new(Vec3::new(0.0, 0.0, -4.0), Vec3::NEG_Z));
            assert_eq!((outside.id(), outside.u, outside.v), ((0, 1, 0), 0.0, 0.0), "{options:?}");
            assert!((outside.t - 2.0).abs() < 1e-6, "{outside:?} {options:?}");
            let inside = one(&accel, &Ray::new(Vec3::new(50.0, 1.0, 0.0), Vec3::X));
            assert_eq!(inside.id(), (0, 2, 0), "{options:?}");
            assert!((inside.t - 15_f32.sqrt()).abs() < 1e-6, "{inside:?} {options:?}");
        }
    }
}

#[test]
fn a_scene_of_spheres_and_planes_gives_the_bits_of_the_native_path() {
    if library("spheres as in the native path").is_none() {
        return;
    }
    let mut random = Random(12);
    let mut shapes: Vec<Geometry> = (0..200).map(|_| ball(random.point() * 2.0, 0.02 + 0.3 * random.next())).collect();
    let plane = Plane { point: Vec3::new(0.0, -1.5, 0.0), normal: Vec3::Y };
    shapes.insert(7, Geometry { shape: Shape::Plane(plane), mask: GeometryMask::ALL });
    let rays: Vec<Ray> = (0..20_000)
        .map(|_| Ray { t_min: 0.3 * random.next(), ..Ray::new(random.point() * 3.0, random.point()) })
        .collect();
    let native = Unbounded::new(Native::build(&shapes), &shapes);
    let want = trace(&native, &rays, Coherence::Incoherent);
    assert!(want.1.iter().filter(|b| **b).count() > 5000 && want.1.iter().any(|b| !b));
    for width in WIDTHS {
        let embree = Unbounded::new(build(&shapes, &Options { width, ..Options::default() }), &shapes);
        for coherence in BOTH {
            assert!(trace(&embree, &rays, coherence) == want, "{width:?} {coherence:?}");
        }
    }
}

#[test]
fn any_number_of_threads_may_trace_at_once() {
    if library("threads").is_none() {
        return;
    }
    let accel = build(&soup(300, 14), &Options::default());
    let mut random = Random(15);
    let rays: Vec<Ray> = (0..4000).map(|_| Ray::new(random.point() * 2.0, random.point())).collect();
    let alone = trace(&accel, &rays, Coherence::Coherent);
    std::thread::scope(|scope| {
        let threads = [0; 6].map(|_| scope.spawn(|| trace(&accel, &rays, Coherence::Coherent)));
        assert!(threads.into_iter().all(|thread| thread.join().unwrap() == alone));
    });
}

#[test]
fn accelerators_live_side_by_side_and_say_what_they_hold() {
    if library("several accelerators").is_none() {
        return;
    }
    let (small, large) = (soup(10, 1), soup(1000, 1));
    let qualities = [Quality::Low, Quality::Medium, Quality::High];
    let many: Vec<(usize, Embree)> = qualities
        .into_iter()
        .flat_map(|quality| {
            [(10, &small), (1000, &large)].map(|(n, s)| (n, build(s, &Options { quality, ..Options::default() })))
        })
        .collect();
    for (n, accel) in &many {
        let stats = accel.build_stats();
        assert_eq!((stats.triangles, stats.spheres, stats.planes, stats.dropped), (3 * n, 0, 0, 0));
        let each = stats.bytes / stats.triangles;
        assert!(*n < 1000 || (20..400).contains(&each), "{each} bytes a triangle");
        assert!(!stats.time.is_zero());
        assert!(accel.library().version.starts_with("4."));
    }
    let ray = Ray::new(Vec3::new(0.1, 0.1, 5.0), Vec3::new(-0.01, 0.02, -1.0));
    let hits: Vec<Hit> = many.iter().map(|(_, accel)| one(accel, &ray)).collect();
    assert!(hits[0].id() == hits[2].id() && hits[1].id() == hits[3].id() && hits[1].id() == hits[5].id());
}
