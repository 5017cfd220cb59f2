//! Building hierarchies over what is hard to divide, or hardly geometry at all.

use glam::Vec3;
use vitrum::accel::Intersector;
use vitrum::geometry::{Geometry, GeometryMask, Ray, Shape, TriMesh};

use crate::support::aim::count;
use crate::support::kernels::sound;
use crate::support::{Rng, contract, shapes};

/// One mesh of triangles that share nothing.
pub fn from_triangles(of: impl Iterator<Item = [Vec3; 3]>) -> TriMesh {
    let positions: Vec<Vec3> = of.flatten().collect();
    let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    TriMesh { positions, triangles, ..Default::default() }
}

/// Twenty meshes, each a trial to a builder or a traversal, with their names; `n` is the size of the large ones.
pub fn zoo(n: usize) -> Vec<(&'static str, TriMesh)> {
    let mut rng = Rng::new(31);
    let unit = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let many = |f: &dyn Fn(usize) -> [Vec3; 3]| from_triangles((0..n).map(f));
    let centred = [Vec3::X, Vec3::Y, -Vec3::X - Vec3::Y];
    let mut dented = shapes::closed_sphere(16, 0.4, 1.0, Vec3::ZERO);
    dented.triangles.extend_from_within(..40);
    vec![
        ("one triangle", from_triangles([unit].into_iter())),
        (
            "two that share an edge",
            TriMesh { triangles: vec![[0, 1, 2], [2, 1, 0]], positions: unit.to_vec(), ..Default::default() },
        ),
        ("nine", from_triangles((0..9).map(|i| unit.map(|p| p + Vec3::Z * i as f32)))),
        ("identical", many(&|_| unit)),
        ("identical, turned", many(&|i| [unit[i % 3], unit[(i + 1) % 3], unit[(i + 2) % 3]])),
        ("in a line", many(&|i| unit.map(|p| p * 0.5 + Vec3::X * i as f32))),
        ("in a plane", shapes::grid(((n / 2) as f32).sqrt() as u32)),
        ("one centre", many(&|i| centred.map(|p| p * (1 + i) as f32))),
        ("halving", from_triangles((0..120).map(|i| unit.map(|p| p * 2_f32.powi(60 - i))))),
        ("halving towards a far place", from_triangles((0..60).map(|i| unit.map(|p| p * 2_f32.powi(30 - i) + 1e3)))),
        ("doubling, spread out", from_triangles((0..50).map(|i| unit.map(|p| (p + 1.0) * 2_f32.powi(i))))),
        (
            "giant beside tiny",
            many(&|i| unit.map(|p| if i == 0 { p * 1e7 } else { p * 1e-3 + Vec3::splat(i as f32 * 1e-2) })),
        ),
        ("huge", from_triangles((0..100).map(|i| unit.map(|p| p * 1.8e18 * if i % 2 == 0 { 1.0 } else { -1.0 })))),
        ("denormal", from_triangles((0..100).map(|i| unit.map(|p| p * 1e-39 * (1 + i) as f32)))),
        (
            "needles",
            from_triangles((0..n).map(|_| {
                let (a, along) = (rng.point(), rng.direction());
                [a, a + along * 2.0, a + along + rng.point() * 1e-6]
            })),
        ),
        (
            "collinear",
            from_triangles((0..n).map(|_| {
                let (a, along) = (rng.point(), rng.direction());
                [a, a + along, a + along * 0.5]
            })),
        ),
        ("closed, some of it twice", dented),
        ("soup", shapes::soup(n, 0.2, &mut rng)),
        (
            "even steps",
            many(&|i| unit.map(|p| p * 0.25 + Vec3::new((i % 17) as f32, (i / 17 % 16) as f32, (i / 272) as f32))),
        ),
        ("far away", {
            let mut m = shapes::closed_sphere(12, 0.1, 2.0, Vec3::ZERO);
            m.positions.iter_mut().for_each(|p| *p += Vec3::new(148_376.0, 1234.0, -223_423.0));
            m
        }),
    ]
}

/// BB-03, BB-04, BB-05, BB-07, BB-09: for any input every box contains its subtree, every triangle occurs once, and no
/// path is deeper than the stacks allow. A centre on the last bin's border has a bin.
#[test]
fn every_tree_of_the_zoo_is_sound() {
    for (name, mesh) in zoo(count(20_000)) {
        let usable = (0..mesh.triangles.len()).filter(|&i| mesh.is_usable(i)).count();
        let geometry = [shapes::masked(mesh, GeometryMask::OPAQUE)];
        let stats = sound(&geometry).build_stats();
        assert_eq!(stats.triangles, usable, "{name}");
        assert!(stats.depth <= 64, "{name}: {}", stats.depth);
    }
}

/// BB-02: Embree's `ManyBuild` makes a million scenes of one triangle each; here each is asked, too.
#[test]
fn scenes_of_one_triangle_are_built_by_the_thousand_and_hit() {
    let mut rng = Rng::new(32);
    for _ in 0..count(5000) {
        let a = rng.point() * 10.0;
        let corners = [a, a + rng.point(), a + rng.point()];
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let normal = (corners[1] - a).cross(corners[2] - a);
        if normal.length() < 0.01 {
            continue;
        }
        let native = sound(&[shapes::masked(from_triangles([corners].into_iter()), GeometryMask::OPAQUE)]);
        let hit = contract::closest(&native, &[Ray::new(middle + normal, -normal)])[0];
        assert!(hit.is_hit(), "{corners:?}");
    }
}

/// BB-08: scenes of twenty meshes of random bit patterns with one index in 32 from anywhere (Embree's `GarbageGeometry`):
/// every triangle is built or counted as dropped.
#[test]
fn scenes_of_garbage_are_built_and_every_triangle_accounted_for() {
    let mut rng = Rng::new(33);
    for _ in 0..count(40) {
        let mut geometry: Vec<Geometry> = Vec::new();
        let mut total = 0;
        for _ in 0..20 {
            let n = 1 + rng.below(255);
            let mild = rng.below(2) == 0;
            let number = |rng: &mut Rng| {
                if mild && rng.below(8) != 0 {
                    rng.signed() * 10_f32.powi(rng.below(20) as i32 - 10)
                } else {
                    f32::from_bits(rng.bits())
                }
            };
            let positions: Vec<Vec3> =
                (0..n + 2).map(|_| Vec3::new(number(&mut rng), number(&mut rng), number(&mut rng))).collect();
            let index = |rng: &mut Rng, i: usize| if rng.below(32) == 0 { rng.below(n + 2) as u32 } else { i as u32 };
            let triangles =
                (0..n).map(|i| [index(&mut rng, i), index(&mut rng, i + 1), index(&mut rng, i + 2)]).collect();
            geometry.push(shapes::masked(TriMesh { positions, triangles, ..Default::default() }, GeometryMask::OPAQUE));
            total += n;
        }
        let usable: usize = geometry
            .iter()
            .map(|g| match &g.shape {
                Shape::Mesh(m) => (0..m.triangles.len()).filter(|&i| m.is_usable(i)).count(),
                _ => 0,
            })
            .sum();
        let native = sound(&geometry);
        let stats = native.build_stats();
        assert_eq!((stats.triangles, stats.dropped), (usable, total - usable));
        let rays: Vec<Ray> = (0..32).map(|_| Ray::new(rng.point(), rng.point())).collect();
        contract::closest(&native, &rays);
    }
}

/// BB-11: a tree takes at most the 70 bytes a triangle that Embree allows itself with AVX
/// (`MemoryConsumptionTest`), where there are enough of them to share a node.
#[test]
fn a_tree_takes_at_most_seventy_bytes_a_triangle() {
    for n in [64, 150, 256] {
        let mesh = shapes::closed_sphere(n, 0.2, 1.0, Vec3::ZERO);
        let stats = sound(&[shapes::masked(mesh, GeometryMask::OPAQUE)]).build_stats();
        let each = stats.bytes as f64 / stats.triangles as f64;
        println!("{} triangles: {each:.1} bytes each", stats.triangles);
        assert!((30.0..=70.0).contains(&each), "{each} bytes for each of {}", stats.triangles);
    }
}
