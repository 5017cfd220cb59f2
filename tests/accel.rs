//! The native accelerator keeps the promise of every accelerator, and more: the bits of testing everything.

use crate::support;

use glam::Vec3;
use support::contract::{self, bits};
use support::kernels::{Held, KERNELS, assert_bits_of_brute_force, sound, sound_as};
use support::{Rng, shapes};
use vitrum::accel::native::Native;
use vitrum::accel::reference::{Reference, Verdict};
use vitrum::accel::{BuildQuality, Intersector, Unbounded};
use vitrum::geometry::{Geometry, GeometryMask, Hit, Ray, Shape, TriMesh};

#[test]
fn every_kernel_keeps_the_contract() {
    for kernel in KERNELS {
        contract::holds(|g| Held(sound(g), kernel), true);
    }
}

#[test]
fn the_arbiter_keeps_the_contract() {
    contract::holds(Reference::build, true);
}

/// Case PA-01 of the catalogue.
#[test]
fn the_arbiter_finds_no_fault_with_native_hits() {
    let mut rng = Rng::new(14);
    let mut geometry: Vec<Geometry> =
        (0..20).map(|_| shapes::ball(rng.point(), rng.unit() * 0.2 + 0.01, GeometryMask::OPAQUE)).collect();
    geometry.push(shapes::masked(shapes::closed_sphere(24, 0.2, 0.7, Vec3::ZERO), GeometryMask::OPAQUE));
    geometry.push(shapes::masked(shapes::soup(400, 0.3, &mut rng), GeometryMask::OPAQUE));
    geometry.push(shapes::plane(rng.point(), rng.direction(), GeometryMask::OPAQUE));
    let it = Unbounded::new(sound(&geometry), &geometry);
    let arbiter = Reference::build(&geometry);
    let Shape::Mesh(mesh) = &geometry[20].shape else { unreachable!() };
    let mut rays = assorted(20_000, &mut rng);
    rays.extend(aimed(mesh, &[Vec3::new(0.1, 0.0, 0.05), Vec3::new(3.0, 2.0, -1.0)], &mut rng));
    let (hits, blocked) = (contract::closest(&it, &rays), contract::occluded(&it, &rays));
    let mut agreed = 0;
    for ((ray, hit), blocked) in rays.iter().zip(&hits).zip(blocked) {
        for verdict in [arbiter.judge(ray, hit), arbiter.judge_occluded(ray, blocked)] {
            assert!(!matches!(verdict, Verdict::Wrong(_)), "{verdict:?}: {hit:?} for {ray:?}");
            agreed += usize::from(verdict == Verdict::Agrees);
        }
    }
    assert!(agreed > rays.len() * 2 * 9 / 10, "{agreed} of {}", rays.len() * 2);
}

#[test]
fn wrapping_for_planes_keeps_the_contract() {
    contract::holds(|g| Unbounded::new(Native::build(g), g), true);
    // With a plane that no ray of the contract reaches, so that the wrapper has its own work to do.
    contract::holds(
        |g| {
            let mut g = g.to_vec();
            g.push(shapes::plane(Vec3::new(0.0, 0.0, 1e18), Vec3::Z, GeometryMask(128)));
            Unbounded::new(Native::build(&g), &g)
        },
        true,
    );
}

/// Rays of many kinds at shapes about the unit cube.
fn assorted(n: usize, rng: &mut Rng) -> Vec<Ray> {
    (0..n)
        .map(|i| {
            let origin = rng.point() * [0.5, 1.5, 4.0, 1000.0][i % 4];
            let mut dir = rng.point() - origin;
            if i % 3 == 0 {
                dir[rng.below(3)] = if i % 2 == 0 { 0.0 } else { -0.0 };
            }
            if i % 11 == 0 {
                dir = Vec3::AXES[rng.below(3)] * rng.signed();
            }
            let mut ray = Ray::new(origin, dir);
            if i % 5 == 0 {
                (ray.t_min, ray.t_max) = (-2.0, 2.0);
            }
            ray
        })
        .collect()
}

/// Cases TR-08, LN-09 of the catalogue.
#[test]
fn every_kernel_gives_the_bits_of_testing_everything() {
    let mut rng = Rng::new(1);
    for (n, size) in [(1, 1.0), (2, 1.0), (9, 0.8), (100, 0.5), (700, 0.3), (700, 3.0)] {
        let halves = [shapes::soup(n, size, &mut rng), shapes::soup(n, size * 0.1, &mut rng)];
        let geometry = halves.map(|m| shapes::masked(m, GeometryMask::OPAQUE));
        let hits = assert_bits_of_brute_force(&geometry, &assorted(1600, &mut rng));
        assert!(hits > 0 || n < 9);
    }
}

/// Case RT-08 of the catalogue.
#[test]
fn rays_of_any_scale_give_the_bits_of_testing_everything() {
    let mut rng = Rng::new(2);
    for exponent in [-15, -6, 6, 14] {
        let scale = 10_f32.powi(exponent);
        let mut mesh = shapes::soup(150, 1.0, &mut rng);
        mesh.positions.iter_mut().for_each(|p| *p *= scale);
        let rays: Vec<Ray> = assorted(800, &mut rng)
            .iter()
            .enumerate()
            .map(|(i, r)| Ray { origin: r.origin * scale, dir: r.dir * 10_f32.powi(i as i32 % 9 - 4), ..*r })
            .collect();
        assert!(assert_bits_of_brute_force(&[shapes::masked(mesh, GeometryMask::OPAQUE)], &rays) > 50);
    }
}

/// Case TR-08 of the catalogue.
#[test]
fn spheres_and_planes_give_the_bits_of_testing_everything() {
    let mut rng = Rng::new(12);
    for count in [1, 3, 40, 500] {
        let mut geometry: Vec<Geometry> = (0..count)
            .map(|i| shapes::ball(rng.point(), rng.unit() * [0.01, 0.1, 0.5][i % 3], GeometryMask::OPAQUE))
            .collect();
        geometry.insert(0, shapes::masked(shapes::soup(50, 0.3, &mut rng), GeometryMask::OPAQUE));
        geometry.insert(1, geometry[count].clone());
        geometry.push(shapes::plane(rng.point(), rng.direction(), GeometryMask::OPAQUE));
        geometry.insert(2, geometry[count + 2].clone());
        assert!(assert_bits_of_brute_force(&geometry, &assorted(1600, &mut rng)) > 400);
    }
}

/// Rays at every corner and along every edge of a mesh from `origins` inside and outside of it.
fn aimed(mesh: &TriMesh, origins: &[Vec3], rng: &mut Rng) -> Vec<Ray> {
    let mut rays = Vec::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|k| mesh.positions[k as usize]);
        for target in [a, a + (b - a) * rng.unit(), b + (c - b) * 0.5, c + (a - c) * rng.unit()] {
            rays.extend(origins.iter().map(|&o| Ray::new(o, target - o)));
        }
    }
    rays
}

/// Cases RT-01, RT-09 of the catalogue.
#[test]
fn no_ray_leaves_a_closed_mesh_through_its_seams() {
    let mut rng = Rng::new(3);
    let mut count = 0;
    for (bumps, scale, offset) in [
        (0.0, 1.0, Vec3::ZERO),
        (0.3, 1.0, Vec3::ZERO),
        (0.2, 2.0, Vec3::new(148_376.0, 1234.0, -223_423.0)),
        (0.1, 0.07, Vec3::splat(0.5)),
        (0.3, 1e6, Vec3::splat(-3e5)),
        (0.2, 1e-12, Vec3::ZERO),
    ] {
        let mesh = shapes::closed_sphere(16, bumps, scale, offset);
        let inside: Vec<Vec3> = (0..12).map(|_| offset + rng.point() * (0.3 * scale)).collect();
        let rays = aimed(&mesh, &inside, &mut rng);
        let native = sound(&[shapes::masked(mesh, GeometryMask::OPAQUE)]);
        for kernel in KERNELS {
            let held = Held(native.clone(), kernel);
            let leaks = contract::closest(&held, &rays).iter().filter(|h| !h.is_hit()).count();
            assert_eq!(leaks, 0, "{kernel:?}, bumps {bumps}, scale {scale}, at {offset}");
            assert!(contract::occluded(&held, &rays).iter().all(|b| *b));
            count += rays.len();
        }
    }
    assert!(count > 300_000, "{count}");
}

/// Case TR-09 of the catalogue.
#[test]
fn axis_aligned_rays_through_the_corners_of_a_grid_all_hit() {
    let native = sound(&[shapes::masked(shapes::grid(40), GeometryMask::OPAQUE)]);
    for kernel in KERNELS {
        for zero in [0.0, -0.0] {
            let rays: Vec<Ray> = (0..=80)
                .flat_map(|y| (0..=80).map(move |x| (x as f32 * 0.5, y as f32 * 0.5)))
                .map(|(x, y)| Ray::new(Vec3::new(x, y, 7.0), Vec3::new(zero, -zero, -1.0)))
                .collect();
            let hits = contract::closest(&Held(native.clone(), kernel), &rays);
            assert!(hits.iter().all(|h| h.t == 7.0), "{kernel:?}");
        }
    }
}

/// Case RB-01 of the catalogue.
#[test]
fn rays_that_enter_a_box_by_its_corner_hit_it() {
    let mut rng = Rng::new(4);
    let mut count = 0;
    for _ in 0..40 {
        let lo = rng.point() * 100.0;
        let hi = lo + Vec3::new(rng.unit(), rng.unit(), rng.unit()) * 10.0 + 0.1;
        let mesh = shapes::cuboid(lo, hi);
        // Start and direction exact in f32, so that the ray does pass through the corner. (One that only grazes it
        // there meets a point, which no finite precision can promise.)
        let rays: Vec<Ray> = (0..800)
            .filter_map(|k| {
                let corner = mesh.positions[k % 8];
                let inwards = (lo + hi) * 0.5 - corner;
                let dir = Vec3::from_array([0; 3].map(|_| (1 + rng.below(1024)) as f32 / 1024.0)).copysign(inwards);
                let origin = corner - dir * 8.0;
                let exact = (0..3).all(|a| f64::from(corner[a]) - 8.0 * f64::from(dir[a]) == f64::from(origin[a]));
                exact.then(|| Ray::new(origin, dir))
            })
            .collect();
        let native = sound(&[shapes::masked(mesh, GeometryMask::OPAQUE)]);
        for kernel in KERNELS {
            let hits = contract::closest(&Held(native.clone(), kernel), &rays);
            assert!(hits.iter().all(Hit::is_hit), "{kernel:?} {lo} {hi}");
        }
        count += rays.len();
    }
    assert!(count > 2000, "{count}");
}

#[test]
fn planes_take_their_part() {
    let geometry = [
        shapes::plane(Vec3::ZERO, Vec3::Y, GeometryMask::OPAQUE),
        shapes::ball(Vec3::new(0.0, 1.0, 0.0), 1.0, GeometryMask::TRANSMISSIVE),
        shapes::plane(Vec3::ZERO, -Vec3::Y, GeometryMask::TRANSMISSIVE),
        shapes::plane(Vec3::new(0.0, f32::NAN, 0.0), Vec3::Y, GeometryMask::OPAQUE),
    ];
    let it = Unbounded::new(sound(&geometry), &geometry);
    let stats = it.build_stats();
    assert_eq!((stats.planes, stats.spheres, stats.dropped), (2, 1, 1));
    let down = Ray::new(Vec3::new(0.0, 5.0, 0.0), -Vec3::Y);
    let aside = Ray::new(Vec3::new(3.0, 5.0, 0.0), -Vec3::Y);
    let along = Ray::new(Vec3::new(3.0, 5.0, 0.0), Vec3::X);
    let up = Ray::new(Vec3::new(3.0, 5.0, 0.0), Vec3::Y);
    let ids = |rays: &[Ray]| contract::closest(&it, rays).iter().map(|h| (h.t, h.geometry)).collect::<Vec<_>>();
    let none = (f32::INFINITY, vitrum::geometry::NO_GEOMETRY);
    assert_eq!(ids(&[down, aside, along, up]), [(3.0, 1), (5.0, 0), none, none]);
    assert_eq!(contract::occluded(&it, &[down, aside, along, up]), [true, true, false, false]);
    // The ball touches the plane at t = 5: the plane's id is lower than the ball's, the other plane's is higher.
    let touch = |admits, t_min| Ray { t_min, admits, ..down };
    assert_eq!(ids(&[touch(GeometryMask::ALL, 4.0)]), [(5.0, 0)]);
    assert_eq!(ids(&[touch(GeometryMask::TRANSMISSIVE, 4.0)]), [(5.0, 1)]);
    assert_eq!(ids(&[touch(GeometryMask::OPAQUE, 0.0)]), [(5.0, 0)]);
    assert_eq!(ids(&[touch(GeometryMask::OPAQUE, 5.0)]), [none]);
    let short = Ray { t_max: 4.9, ..aside };
    assert_eq!(contract::occluded(&it, &[short, Ray { t_max: 5.0, ..short }]), [false, true]);
}

/// Case BB-10 of the catalogue.
#[test]
fn the_tree_is_the_same_for_any_number_of_threads() {
    let mut rng = Rng::new(6);
    let geometry = [
        shapes::masked(shapes::soup(70_000, 0.02, &mut rng), GeometryMask::OPAQUE),
        shapes::masked(shapes::closed_sphere(64, 0.1, 1.0, Vec3::ZERO), GeometryMask::OPAQUE),
        shapes::ball(Vec3::ZERO, 0.5, GeometryMask::OPAQUE),
    ];
    let rays = assorted(64, &mut rng);
    let hits = |native: &Native| contract::closest(native, &rays).iter().map(bits).collect::<Vec<_>>();
    let mut found = Vec::new();
    for quality in BuildQuality::ALL {
        let built = [1, 2, 3, 8].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| sound_as(&geometry, quality))
        });
        for other in &built[1..] {
            assert!(other.tree_bytes() == built[0].tree_bytes(), "{quality:?}");
        }
        found.extend([hits(&built[0]), hits(&built[3])]);
    }
    assert!(found.iter().all(|other| *other == found[0]));
}

/// Cases RB-10, BB-03, BB-04, BB-06, BB-12 of the catalogue.
#[test]
fn odd_meshes_build_and_are_hit() {
    let unit = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let n = 100_000;
    let same = TriMesh { positions: unit.to_vec(), triangles: vec![[0, 1, 2]; n], ..Default::default() };
    // Halving sizes: every split by area cuts off one triangle, until the depth bound says otherwise.
    let series = from_triangles((0..120).map(|i| unit.map(|p| p * 2_f32.powi(60 - i))));
    let line = from_triangles((0..5000).map(|i| unit.map(|p| p + Vec3::X * i as f32)));
    let concentric = from_triangles((1..3000).map(|i| [Vec3::X, Vec3::Y, -Vec3::X - Vec3::Y].map(|p| p * i as f32)));
    let giant = from_triangles(
        (0..1000).map(|i| unit.map(|p| if i == 0 { p * 1e9 } else { p * 1e-3 + Vec3::splat(i as f32 * 1e-2) })),
    );
    let huge = from_triangles((0..100).map(|i| unit.map(|p| p * 1.8e18 * if i % 2 == 0 { 1.0 } else { -1.0 })));
    for (name, mesh) in [
        ("same", same),
        ("series", series),
        ("line", line),
        ("concentric", concentric),
        ("giant", giant),
        ("huge", huge),
    ] {
        let geometry = [shapes::masked(mesh, GeometryMask::OPAQUE)];
        let native = sound(&geometry);
        let Shape::Mesh(mesh) = &geometry[0].shape else { unreachable!() };
        assert_eq!(native.build_stats().triangles, mesh.triangles.len(), "{name}");
        for i in (0..mesh.triangles.len()).step_by(mesh.triangles.len().div_ceil(500)) {
            let [a, b, c] = mesh.corners(i);
            let middle = a * 0.4 + b * 0.3 + c * 0.3;
            let size = (b - a).length();
            let ray = Ray {
                t_max: 2.0,
                ..Ray::new(
                    middle + (b - a).cross(c - a).normalize_or(Vec3::Z) * size,
                    -(b - a).cross(c - a).normalize_or(Vec3::Z) * size,
                )
            };
            assert!(contract::closest(&native, &[ray])[0].is_hit(), "{name} {i}");
        }
    }
}

fn from_triangles(of: impl Iterator<Item = [Vec3; 3]>) -> TriMesh {
    let positions: Vec<Vec3> = of.flatten().collect();
    let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    TriMesh { positions, triangles, ..Default::default() }
}

/// Cases RB-10, RT-18, BB-08 of the catalogue.
#[test]
fn garbage_is_dropped_and_counted() {
    let mut rng = Rng::new(8);
    for _ in 0..300 {
        let n = 1 + rng.below(255);
        let positions: Vec<Vec3> =
            (0..n + 3).map(|_| Vec3::from_array([0; 3].map(|_| f32::from_bits(rng.bits())))).collect();
        let index = |rng: &mut Rng| rng.below(n + 3) as u32;
        let triangles: Vec<[u32; 3]> = (0..n).map(|_| [index(&mut rng), index(&mut rng), index(&mut rng)]).collect();
        let mesh = TriMesh { positions, triangles, ..Default::default() };
        let usable = (0..n).filter(|&i| mesh.is_usable(i)).count();
        let geometry = [
            shapes::masked(mesh, GeometryMask::OPAQUE),
            shapes::ball(
                Vec3::from_array([0; 3].map(|_| f32::from_bits(rng.bits()))),
                f32::from_bits(rng.bits()),
                GeometryMask::OPAQUE,
            ),
        ];
        let native = sound(&geometry);
        let stats = native.build_stats();
        assert_eq!(stats.triangles, usable);
        assert_eq!(stats.dropped + stats.triangles + stats.spheres, n + 1);
        contract::closest(&native, &assorted(32, &mut rng));
    }
}
