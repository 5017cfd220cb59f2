//! The arbiter makes no false accusation: not of the native path at any boundary, and of broken kernels and of Embree none
//! that rational arithmetic does not confirm.
//!
//! `VITRUM_TEST_SCALE=1000 cargo test --release --features embree --test suite cracks::` aims ten million rays at each kind of
//! boundary, and fires `verify` at nine thousand meshes.

use crate::support;

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

use glam::Vec3;
use support::cracks::{Boundary, ray};
use support::kernels::{Held, KERNELS};
use support::{Rng, aim, contract, exact, scenes};
use vitrum::accel::native::Native;
use vitrum::accel::reference::{Cause, Fault, Reference, Verdict};
use vitrum::accel::{Accel, Backend, BuildOptions, BuildQuality};
use vitrum::geometry::{Geometry, GeometryMask, Hit, Ray, Shape, TriMesh};
use vitrum::render::Observer;
use vitrum::scene::Material;
use vitrum::trial::parity::{Answers, Query, Set, ask, judge, sets};
use vitrum::trial::rays::View;
use vitrum::trial::verify::{self, Group, UnderTest, VerifyPlan};

/// Rays at each mesh.
const RAYS: usize = 500;

fn geometry(mesh: &TriMesh) -> [Geometry; 1] {
    [Geometry { shape: Shape::Mesh(mesh.clone()), mask: GeometryMask::OPAQUE }]
}

/// Verdicts by cause: how many of which.
type Causes = BTreeMap<&'static str, u64>;

fn count(causes: &mut Causes, verdict: Verdict) {
    let name = match verdict {
        Verdict::Agrees => "agrees",
        Verdict::Undecidable(cause, margin) => {
            assert!(margin.distance <= margin.bound, "{margin:?}");
            vitrum::trial::parity::cause_name(cause)
        }
        Verdict::Wrong(fault) => vitrum::trial::parity::fault_name(fault),
    };
    *causes.entry(name).or_default() += 1;
}

/// Aims at meshes of one kind, and holds every kernel's answers against the arbiter.
fn native_is_right_at(boundary: Boundary) -> Causes {
    let mut causes = Causes::new();
    for seed in 0..aim::count(20) as u64 {
        let mesh = boundary.mesh(seed);
        if mesh.triangles.is_empty() {
            continue;
        }
        let geometry = geometry(&mesh);
        let (reference, native) = (Reference::build(&geometry), Native::build(&geometry));
        let mut rng = Rng::new(seed);
        let rays: Vec<Ray> = (0..RAYS).map(|_| ray(&mesh, &mut rng)).collect();
        let answers = KERNELS.map(|kernel| {
            let held = Held(native.clone(), kernel);
            (contract::closest(&held, &rays), contract::occluded(&held, &rays))
        });
        for (k, ray) in rays.iter().enumerate() {
            let examined = reference.examine(ray);
            for (i, (hits, blocked)) in answers.iter().enumerate() {
                for verdict in [examined.judge(&hits[k]), examined.judge_occluded(blocked[k])] {
                    assert!(
                        !matches!(verdict, Verdict::Wrong(_)),
                        "{boundary:?} {seed}, {:?}: {verdict:?}: {} met {:?}; {:?}",
                        KERNELS[i],
                        vitrum::trial::shown::argument(ray),
                        hits[k],
                        examined.truth()
                    );
                    count(&mut causes, verdict);
                }
            }
        }
    }
    println!("{boundary:?}: {causes:?}");
    causes
}

#[test]
fn native_is_not_accused_at_open_rims() {
    assert!(native_is_right_at(Boundary::Open)["crack"] > 0);
}

#[test]
fn native_is_not_accused_at_slits() {
    assert!(native_is_right_at(Boundary::Slit)["crack"] > 0);
}

#[test]
fn native_is_not_accused_at_unjoined_seams() {
    assert!(native_is_right_at(Boundary::Unjoined)["crack"] > 0);
}

#[test]
fn native_is_not_accused_at_corners_within_edges() {
    assert!(native_is_right_at(Boundary::Junction)["crack"] > 0);
}

#[test]
fn native_is_not_accused_at_edges_of_three_triangles_and_more() {
    assert!(native_is_right_at(Boundary::NonManifold)["crack"] > 0);
}

#[test]
fn native_is_not_accused_where_cones_touch_at_their_tips() {
    assert!(native_is_right_at(Boundary::Cones)["crack"] > 0);
}

#[test]
fn native_is_not_accused_at_triangles_that_are_there_twice() {
    native_is_right_at(Boundary::Duplicated);
}

#[test]
fn native_is_not_accused_at_slivers() {
    native_is_right_at(Boundary::Spindle);
}

#[test]
fn closed_balls_have_no_cracks() {
    let causes = native_is_right_at(Boundary::Closed);
    assert!(!causes.contains_key("crack"), "{causes:?}");
}

/// A way to answer wrongly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Broken {
    /// Edges belong to neither side.
    OpenEdges,
    /// Moeller & Trumbore 1997 in plain `f32`.
    Leaky,
    /// `t` off by a ten-thousandth.
    Off,
    /// The next hit but one.
    Farther,
    /// Another triangle.
    Elsewhere,
    /// Nothing at all, once in ten rays.
    Blind,
}

fn moeller_trumbore(ray: &Ray, [a, b, c]: [Vec3; 3]) -> Option<(f32, f32, f32)> {
    let (e1, e2) = (b - a, c - a);
    let p = ray.dir.cross(e2);
    let det = e1.dot(p);
    let s = ray.origin - a;
    let u = s.dot(p) / det;
    let q = s.cross(e1);
    let v = ray.dir.dot(q) / det;
    let t = e2.dot(q) / det;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && ray.t_min < t && t <= ray.t_max).then_some((t, u, v))
}

fn nearest(ray: &Ray, mesh: &TriMesh, test: impl Fn(&Ray, [Vec3; 3]) -> Option<(f32, f32, f32)>) -> Hit {
    let mut best = Hit::MISS;
    for i in (0..mesh.triangles.len()).filter(|&i| mesh.is_usable(i)) {
        if let Some((t, u, v)) = test(ray, mesh.corners(i)).filter(|hit| hit.0 < best.t) {
            best = Hit { t, u, v, instance: 0, geometry: 0, primitive: i as u32 };
        }
    }
    best
}

impl Broken {
    const ALL: [Self; 6] = [Self::OpenEdges, Self::Leaky, Self::Off, Self::Farther, Self::Elsewhere, Self::Blind];

    fn answer(self, k: usize, ray: &Ray, mesh: &TriMesh) -> Hit {
        let right = |ray: &Ray| nearest(ray, mesh, vitrum::geometry::intersect_triangle);
        let mut hit = right(ray);
        match self {
            Self::OpenEdges => {
                return nearest(ray, mesh, |ray, corners| {
                    vitrum::geometry::intersect_triangle(ray, corners)
                        .filter(|&(_, u, v)| u != 0.0 && v != 0.0 && u + v != 1.0)
                });
            }
            Self::Leaky => return nearest(ray, mesh, moeller_trumbore),
            Self::Off => hit.t *= 1.0 + 1e-4,
            Self::Farther if hit.is_hit() => return right(&Ray { t_min: hit.t, ..*ray }),
            Self::Elsewhere if hit.is_hit() => hit.primitive = (hit.primitive + 5) % mesh.triangles.len() as u32,
            Self::Blind if k.is_multiple_of(10) => return Hit::MISS,
            _ => {}
        }
        hit
    }
}

#[test]
fn broken_kernels_are_accused_and_rational_arithmetic_confirms_it() {
    let mut found: BTreeMap<(&str, &str), u64> = BTreeMap::new();
    for boundary in Boundary::ALL {
        for seed in 0..aim::count(4) as u64 {
            let mesh = boundary.mesh(1000 + seed);
            let reference = Reference::build(&geometry(&mesh));
            let mut rng = Rng::new(seed);
            for k in 0..120 {
                let ray = ray(&mesh, &mut rng);
                for broken in Broken::ALL {
                    let claim = broken.answer(k, &ray, &mesh);
                    let Verdict::Wrong(fault) = reference.judge(&ray, &claim) else { continue };
                    let name = vitrum::trial::parity::fault_name(fault);
                    let found = found.entry((format!("{broken:?}").leak(), name)).or_default();
                    *found += 1;
                    // Of the common ones a sample is confirmed.
                    if *found > 40 && !found.is_multiple_of(16) {
                        continue;
                    }
                    assert!(
                        exact::confirms(fault, &ray, &claim, &mesh),
                        "{boundary:?} {seed}, {broken:?}: {fault:?}: {} met {claim:?}",
                        vitrum::trial::shown::argument(&ray)
                    );
                }
            }
        }
    }
    println!("{found:?}");
    for (broken, fault) in [
        ("OpenEdges", "leak"),
        ("Leaky", "leak"),
        ("Off", "t_out_of_bounds"),
        ("Farther", "other_primitive"),
        ("Elsewhere", "false_hit"),
        ("Blind", "missed_hit"),
    ] {
        assert!(found.get(&(broken, fault)).is_some_and(|&n| n > 0), "{broken} is not found out: {found:?}");
    }
}

/// A fan of triangles around the origin that are seen from above, with a wedge of an angle left out.
fn fan(gap: f32) -> TriMesh {
    let rim = |k: u32| (gap / 2.0 + (std::f32::consts::TAU - gap) * k as f32 / 8.0).sin_cos();
    let mut positions = vec![Vec3::ZERO];
    positions.extend((0..=8).map(rim).map(|(s, c)| Vec3::new(c, s, 0.0)));
    TriMesh { positions, triangles: (1..=8).map(|k| [0, k, k + 1]).collect(), ..TriMesh::default() }
}

#[test]
fn a_corner_is_a_leak_where_its_fan_is_joined_and_a_crack_where_it_is_slit() {
    let down = Ray::new(Vec3::new(0.0, 0.0, 1.0), Vec3::NEG_Z);
    let judge = |mesh: &TriMesh| Reference::build(&geometry(mesh)).judge(&down, &Hit::MISS);
    let is_crack = |v| matches!(v, Verdict::Undecidable(Cause::Crack, _));
    for gap in [1e-6, 1e-3, 0.1, 0.78, 1.5] {
        assert!(is_crack(judge(&fan(gap))), "a slit of {gap}");
    }
    let mut joined = fan(0.0);
    joined.positions[9] = joined.positions[1];
    assert_eq!(judge(&joined), Verdict::Wrong(Fault::Leak), "joined by equal coordinates");
    joined.positions[9].x = joined.positions[9].x.next_down();
    assert!(is_crack(judge(&joined)), "an ulp apart at the rim");
    // Twice the same is still joined, a third sheet at one edge changes nothing, and one triangle less opens it.
    let mut twice = fan(0.0);
    twice.positions[9] = twice.positions[1];
    twice.triangles.extend(twice.triangles.clone());
    assert_eq!(judge(&twice), Verdict::Wrong(Fault::Leak));
    twice.triangles.pop();
    assert_eq!(judge(&twice), Verdict::Wrong(Fault::Leak), "one of both is whole");
    twice.triangles.remove(7);
    assert!(is_crack(judge(&twice)), "the last one is gone from both");
    let mut fin = fan(0.0);
    fin.positions[9] = fin.positions[1];
    fin.positions.push(Vec3::NEG_Z);
    fin.triangles.push([0, 3, 10]);
    assert_eq!(judge(&fin), Verdict::Wrong(Fault::Leak));
    // A folded sheet has the ray at its outline: no crack, and no leak.
    let folded = TriMesh {
        positions: vec![Vec3::NEG_Y, Vec3::Y, Vec3::new(1.0, 0.0, -0.2), Vec3::new(1.0, 0.0, -0.9)],
        triangles: vec![[0, 1, 2], [1, 0, 3]],
        ..TriMesh::default()
    };
    assert!(matches!(judge(&folded), Verdict::Undecidable(Cause::Edge, _)));
    // The same with a corner in the middle of the long edge on one side.
    let mut junction = folded;
    junction.positions[3] = Vec3::NEG_X;
    assert_eq!(judge(&junction), Verdict::Wrong(Fault::Leak));
    junction.positions.push(Vec3::ZERO);
    junction.triangles = vec![[0, 1, 2], [1, 4, 3], [4, 0, 3]];
    assert!(is_crack(judge(&junction)));
}

/// A slit of 28 degrees in a fan of a real tree, as one of its rays sees it.
#[test]
fn a_slit_narrower_than_45_degrees_is_no_leak() {
    let positions = [
        [30.768_1, 2.291_56, -13.459_7],
        [30.859_1, 2.232_76, -13.501_3],
        [30.846_2, 2.239_07, -13.507],
        [30.937_6, 2.188_18, -13.580_7],
        [30.922_5, 2.195_37, -13.591],
        [30.868_1, 2.251_05, -13.733_7],
        [30.700_3, 2.352_13, -13.621_7],
    ];
    let triangles = vec![[2, 1, 0], [0, 6, 2], [6, 5, 2], [4, 3, 2], [5, 4, 2]];
    let mesh = TriMesh { positions: positions.map(Vec3::from_array).to_vec(), triangles, ..TriMesh::default() };
    let through =
        Ray::new(Vec3::new(98.484_215, 61.946_224, 146.055_2), Vec3::new(-0.368_995_93, -0.325_729_52, -0.870_484));
    let verdict = Reference::build(&geometry(&mesh)).judge(&through, &Hit::MISS);
    assert!(matches!(verdict, Verdict::Agrees | Verdict::Undecidable(Cause::Crack, _)), "{verdict:?}");
    let scene = scene(mesh);
    let plan = VerifyPlan { groups: Group::OF_SCENE.to_vec(), full: false, rays: Some(6400) };
    let findings = verify::fire_at_scene(
        &UnderTest { backend: Backend::Native, bvh: BuildQuality::Default },
        &scene,
        "fan.obj",
        &plan,
        &Observer::default(),
    );
    for f in findings.expect("the native path is there") {
        assert!(f.holds(), "{}: {:#?}", f.group.name(), f.tally.examples);
    }
}

fn scene(mesh: TriMesh) -> vitrum::scene::Scene {
    let mut scene = scenes::empty(1.0);
    let matt = scenes::material(&mut scene, Material::default());
    scenes::add(&mut scene, Shape::Mesh(mesh), matt);
    scene
}

/// `parity` of a mesh: rays of pictures, aimed ones, those at the ends of their intervals, and those that leave a surface. Wrong
/// answers of native fail; those of Embree count only where rational arithmetic does not confirm them. Answers, and how many of
/// them were wrong.
fn parity(name: &str, mesh: &TriMesh, rays: usize) -> (u64, u64) {
    let geometry = geometry(mesh);
    let reference = Reference::build(&geometry);
    let view = View::of(&mesh.bounds());
    let native = Native::build(&geometry);
    let (mut all, mut wrong) = (0, 0);
    for set in sets(&reference, &geometry, &view, rays) {
        let answers =
            [ask(&native, &set.rays, set.coherence)].into_iter().chain(embree(&geometry, &set)).collect::<Vec<_>>();
        let records = judge(&reference, &set, &answers, &AtomicBool::new(false), |_| {}).expect("nobody stops it");
        for (contender, records) in records.iter().enumerate() {
            for (query, record) in records.each() {
                all += record.tally.answers;
                wrong += record.tally.broken();
                for found in &record.wrong {
                    let told = || {
                        let ray = vitrum::trial::shown::argument(&found.ray);
                        format!("{name}, {} {query:?} by contender {contender}: {found:?}: {ray}", set.name)
                    };
                    assert!(contender > 0, "{}", told());
                    let confirmed = match (found.fault, query) {
                        (None, _) => found.claim.t <= found.ray.t_min || found.claim.t > found.ray.t_max,
                        (Some(Fault::FalseHit), Query::Occluded) => exact::meets_nothing(&found.ray, mesh),
                        // Not a matter of this ray alone: it has left the triangle that it meets.
                        (Some(Fault::SelfHit), _) => true,
                        (Some(fault), _) => exact::confirms(fault, &found.ray, &found.claim, mesh),
                    };
                    assert!(confirmed, "{}", told());
                }
            }
        }
    }
    (all, wrong)
}

/// Answers of Embree, robust and fast, where it is there.
fn embree(geometry: &[Geometry], set: &Set) -> Vec<Answers> {
    let options = BuildOptions { threads: 1, ..BuildOptions::default() };
    let accels = [Backend::Embree, Backend::EmbreeFast].map(|backend| Accel::build(backend, geometry, options));
    accels.iter().flatten().map(|accel| ask(accel, &set.rays, set.coherence)).collect()
}

#[test]
fn parity_accuses_native_of_nothing_and_embree_of_nothing_that_rational_arithmetic_does_not_confirm() {
    let (mut all, mut wrong) = (0, 0);
    for seed in 0..aim::count(2) as u64 {
        for boundary in Boundary::ALL {
            let mesh = boundary.mesh(90_000 + seed);
            if mesh.triangles.is_empty() {
                continue;
            }
            let found = parity(&format!("{boundary:?} {seed}"), &mesh, 256);
            (all, wrong) = (all + found.0, wrong + found.1);
        }
    }
    println!("{all} answers, {wrong} wrong ones of Embree");
    assert!(all > 10_000);
}

/// All groups that are fired at scenes, at random meshes of all kinds: nine in the plain suite, and
/// `VITRUM_TEST_SCALE=1000` makes nine thousand of them.
#[test]
fn verify_accuses_nobody_at_random_meshes() {
    let mut cases = 0;
    for seed in 0..aim::count(1) as u64 {
        for boundary in Boundary::ALL {
            let mesh = boundary.mesh(50_000 + seed);
            if mesh.triangles.is_empty() {
                continue;
            }
            let plan = VerifyPlan { groups: Group::OF_SCENE.to_vec(), full: false, rays: Some(640) };
            let scene = scene(mesh);
            let name = format!("{boundary:?} {seed}");
            let found = verify::fire_at_scene(
                &UnderTest { backend: Backend::Native, bvh: BuildQuality::Default },
                &scene,
                &name,
                &plan,
                &Observer::default(),
            );
            for f in found.expect("the native path is there") {
                assert!(f.holds() && f.tally.left_out == 0, "{name}, {}: {:#?}", f.group.name(), f.tally);
                cases += f.tally.cases;
            }
        }
    }
    println!("{cases} cases");
    assert!(cases > 10_000);
}
