//! The hard cases that `vitrum verify` fires hold here, the faults that it looks for are found, and its report is what
//! its user reads.

use std::path::Path;
use std::time::Duration;

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::{contains, is_empty};
use vitrum::accel::native::{Native, Scratch};
use vitrum::accel::{Backend, BuildQuality, BuildStats, Coherence, Intersector};
use vitrum::error::{Error, Unavailable};
use vitrum::geometry::{Geometry, GeometryMask, Hit, Hit8, Ray8, Shape};
use vitrum::load::shapes;
use vitrum::render::Observer;
use vitrum::simd::Mask8;
use vitrum::trial::verify::{self, Candidate, Group, GroupResult, NamedAccel, UnderTest, VerifyPlan};

const NATIVE: UnderTest = UnderTest { backend: Backend::Native, bvh: BuildQuality::Default };

fn quick(group: Group) {
    let plan = VerifyPlan { groups: vec![group], full: false, rays: None };
    let observer = Observer::default();
    let mut findings = verify::fire_at_optics(&plan, &observer).expect("nobody interrupts a test");
    findings.extend(verify::fire_at_path(&NATIVE, &plan, &observer).expect("the native path is there"));
    assert_eq!(findings.len(), 1);
    for f in findings {
        println!("{:10} {:8} cases, worst {:?}, {:?}", group.name(), f.tally.cases, f.tally.worst, f.time);
        assert!(f.holds(), "{} of {}: {:#?}", f.tally.failures, f.tally.cases, f.tally.examples);
    }
}

#[test]
fn no_ray_leaks_out_of_a_closed_mesh() {
    quick(Group::Leaks);
}

#[test]
fn no_ray_meets_the_surface_that_it_leaves() {
    quick(Group::SelfHits);
}

#[test]
fn reflectance_keeps_its_bound() {
    quick(Group::Fresnel);
}

#[test]
fn refracted_directions_keep_their_bounds() {
    quick(Group::Refraction);
}

#[test]
fn mirror_directions_keep_their_bound() {
    quick(Group::Reflection);
}

#[test]
fn equal_media_are_no_boundary_and_light_is_split_without_loss() {
    quick(Group::Matched);
}

#[test]
fn lanes_keep_to_themselves() {
    quick(Group::Lanes);
}

#[test]
fn hits_are_those_of_testing_everything() {
    quick(Group::Traversal);
}

#[test]
fn garbage_is_built_into_sound_trees() {
    quick(Group::Builds);
}

#[test]
fn no_light_is_lost_in_long_chains() {
    quick(Group::Chains);
}

#[test]
fn a_hierarchy_of_any_quality_holds() {
    // Large enough that each quality makes another tree of it.
    let ball = [Geometry { shape: Shape::Mesh(shapes::sphere(40)), mask: GeometryMask::OPAQUE }];
    let nodes = BuildQuality::ALL.map(|bvh| {
        let ways = UnderTest { bvh, ..NATIVE }.build(&ball).expect("the native path is there");
        ways[0].accel.build_stats().nodes
    });
    assert!(nodes[0] != nodes[1] && nodes[1] != nodes[2] && nodes[2] != nodes[0], "{nodes:?}");
    // All else tries the default.
    for bvh in [BuildQuality::Fast, BuildQuality::High] {
        let findings = verify::fire_at_path(&UnderTest { bvh, ..NATIVE }, &VerifyPlan::quick(), &Observer::default());
        let findings = findings.expect("the native path is there");
        assert_eq!(findings.len(), 6);
        for f in findings {
            assert!(f.holds(), "{bvh:?}, {}: {:#?}", f.group.name(), f.tally);
        }
    }
}

/// The native path with something broken.
struct Broken(Fault);

#[derive(Clone, Copy)]
enum Fault {
    /// Hits exactly on an edge are lost, as by a test that has them belong to neither side.
    OpenEdges,
    /// Inactive lanes are written to.
    Spills,
    /// Answers are an ulp off.
    Rounds,
}

struct BrokenAccel(Native, Fault);

impl Candidate for Broken {
    type Accel = BrokenAccel;

    fn name(&self) -> &'static str {
        "broken"
    }

    fn is_exact(&self) -> bool {
        true
    }

    fn build(&self, geometry: &[Geometry]) -> vitrum::Result<Vec<NamedAccel<BrokenAccel>>> {
        Ok(vec![NamedAccel { name: "only", accel: BrokenAccel(Native::build(geometry), self.0) }])
    }
}

impl Intersector for BrokenAccel {
    type Scratch = Scratch;

    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], coherence: Coherence, scratch: &mut Scratch) {
        self.0.closest(rays, hits, coherence, scratch);
        for (packet, rays) in hits.iter_mut().zip(rays) {
            for i in 0..8 {
                let mut hit = packet.lane(i);
                let active = rays.active >> i & 1 != 0;
                match self.1 {
                    Fault::OpenEdges if active && (hit.u == 0.0 || hit.v == 0.0 || hit.u + hit.v == 1.0) => {
                        packet.set_lane(i, &Hit::MISS);
                    }
                    Fault::Spills if !active => packet.set_lane(i, &Hit::MISS),
                    Fault::Rounds if active && hit.is_hit() => {
                        hit.t = hit.t.next_up();
                        packet.set_lane(i, &hit);
                    }
                    _ => {}
                }
            }
        }
    }

    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], coherence: Coherence, scratch: &mut Scratch) {
        self.0.occluded(rays, blocked, coherence, scratch);
    }

    fn build_stats(&self) -> BuildStats {
        self.0.build_stats()
    }
}

fn of_broken(fault: Fault, group: Group) -> GroupResult {
    let plan = VerifyPlan { groups: vec![group], full: false, rays: None };
    verify::fire_at_path(&Broken(fault), &plan, &Observer::default()).expect("builds").remove(0)
}

#[test]
fn a_path_that_loses_rays_at_edges_is_caught() {
    let found = of_broken(Fault::OpenEdges, Group::Leaks);
    assert!(!found.holds() && found.tally.failures * 100 > found.tally.cases, "{:?}", found.tally);
    assert!(found.tally.examples.iter().all(|e| e.starts_with("only: out of ")), "{:?}", found.tally.examples);
    assert!(!of_broken(Fault::OpenEdges, Group::Traversal).holds());
}

#[test]
fn a_path_that_writes_into_lanes_that_are_off_is_caught() {
    assert!(!of_broken(Fault::Spills, Group::Lanes).holds());
}

#[test]
fn a_path_that_is_an_ulp_off_is_caught() {
    assert!(!of_broken(Fault::Rounds, Group::Traversal).holds());
}

#[test]
fn it_stops_when_told_to() {
    let observer = Observer::default();
    observer.stop.store(true, std::sync::atomic::Ordering::Relaxed);
    let plan = VerifyPlan::quick();
    assert!(matches!(verify::fire_at_path(&NATIVE, &plan, &observer), Err(Error::Interrupted)));
    assert!(matches!(verify::fire_at_optics(&plan, &observer), Err(Error::Interrupted)));
}

/// A clear box without its lid, a needle, and a triangle twice.
const MODEL: &str = "mtllib glass.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
usemtl glass
f 1 4 3
f 1 3 2
f 1 2 6
f 1 6 5
f 2 3 7
f 2 7 6
f 3 4 8
f 3 8 7
f 4 1 5
f 4 5 8
usemtl matt
v 0 0 -2
v 4 0 -2
v 2 0.0001 -2
f 9 10 11
f 9 10 11
";

const MATERIALS: &str = "newmtl glass
illum 7
Ni 1.5
d 0.1
newmtl matt
Kd 0.5 0.5 0.5
";

fn vitrum(folder: &Path, words: &str) -> Command {
    let mut command = Command::cargo_bin("vitrum").expect("built");
    command.current_dir(folder).args(words.split_whitespace()).timeout(Duration::from_secs(120));
    command
}

#[test]
fn the_table_and_the_json_tell_of_each_group() {
    let folder = tempfile::tempdir().unwrap();
    let table = contains("reflection").and(contains("failures")).and(contains("3.00e-7")).and(contains("holds"));
    vitrum(folder.path(), "verify --group reflection lanes").assert().code(0).stdout(table.and(contains("native")));
    let output = vitrum(folder.path(), "verify --group reflection --json --threads 1").output().unwrap();
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let row = &json["groups"][0];
    assert_eq!((row["group"].as_str(), row["failures"].as_u64()), (Some("reflection"), Some(0)));
    assert!(row["worst"].as_f64() <= row["bound"].as_f64() && row["cases"].as_u64() >= Some(100_000), "{row}");
    assert_eq!((json["holds"].as_bool(), json["threads"].as_u64()), (Some(true), Some(1)));
    vitrum(folder.path(), "verify --group reflection --quiet").assert().code(0).stdout(is_empty()).stderr(is_empty());
}

#[test]
fn the_quality_of_the_hierarchy_reaches_what_is_built_and_the_json() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = ["fast", "default", "high"].map(|quality| {
        let output = vitrum(folder.path(), &format!("verify --group builds --json --bvh {quality}")).output().unwrap();
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!((json["bvh"].as_str(), json["holds"].as_bool()), (Some(quality), Some(true)), "{json}");
        json["groups"][0]["worst"].as_f64().expect("bytes a triangle")
    });
    assert!(bytes[0] > bytes[1], "leaves are less full after a quick build: {bytes:?}");
    std::fs::write(folder.path().join("open.obj"), MODEL).unwrap();
    std::fs::write(folder.path().join("glass.mtl"), MATERIALS).unwrap();
    vitrum(folder.path(), "verify open.obj --bvh fast").assert().code(0);
}

#[test]
fn a_scene_is_fired_at_and_its_triangles_in_trouble_are_named() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("open.obj"), MODEL).unwrap();
    std::fs::write(folder.path().join("glass.mtl"), MATERIALS).unwrap();
    let scene = "[[material]]\nname = \"water\"\ntype = \"dielectric\"\nior = 1.33\n
[[material]]\nname = \"oil\"\ntype = \"dielectric\"\nior = 1.47\n
[[mesh]]\nname = \"box\"\nshape = \"box\"\nmaterial = \"water\"\ncenter = [5, 0, 0]\n
[[mesh]]\nname = \"other\"\nshape = \"box\"\nmaterial = \"oil\"\ncenter = [5.5, 0.25, 0]\n
[[mesh]]\nfile = \"open.obj\"\n";
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let touching = "[[mesh]]\nname = \"third\"\nshape = \"box\"\nmaterial = \"oil\"\ncenter = [4, 0.25, 0]\n";
    std::fs::write(folder.path().join("touching.toml"), scene.to_owned() + touching).unwrap();
    vitrum(folder.path(), "verify touching.toml --group leaks").assert().stdout(contains("`third` touches it"));
    let open = contains("open.obj:16: ").and(contains("open edge of a dielectric"));
    let thin =
        contains("open.obj:25: ").and(contains("sliver")).and(contains("open.obj:26: ")).and(contains("duplicate"));
    let overlap = contains("scene.toml:").and(contains("media overlap without priority"));
    vitrum(folder.path(), "verify scene.toml")
        .assert()
        .code(0)
        .stdout(open.and(thin).and(overlap).and(contains("parity")));
    let output = vitrum(folder.path(), "verify open.obj --json --group parity").output().unwrap();
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let of = |kind: &str| json["troubles"].as_array().unwrap().iter().filter(|t| t["kind"] == kind).count();
    assert_eq!((of("sliver"), of("duplicate"), of("open edge of a dielectric")), (2, 1, 4));
}

#[test]
fn what_cannot_be_run_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    vitrum(folder.path(), "verify --group parity").assert().code(2).stderr(contains("--group parity: with no scene"));
    vitrum(folder.path(), "verify a.toml --group lanes")
        .assert()
        .code(2)
        .stderr(contains("with a scene the groups are"));
    vitrum(folder.path(), "verify missing.toml").assert().code(3);
    vitrum(folder.path(), "verify --group fresnel,matched --bvh high")
        .assert()
        .code(2)
        .stderr("error: --bvh: formulas have no hierarchy to build; leave it out\n");
    vitrum(folder.path(), "verify --bvh best").assert().code(2).stderr(contains("high"));
    if !Backend::Embree.is_compiled_in() {
        vitrum(folder.path(), "verify --backend embree").assert().code(4).stderr(contains("built without it"));
    }
}

#[test]
fn embree_in_its_fast_mode_leaks_where_the_native_path_does_not() {
    if let Err(why) = Backend::Embree.availability() {
        assert!(why == Unavailable::NotCompiledIn || std::env::var_os("VITRUM_REQUIRE_EMBREE").is_none(), "{why}");
        return;
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let output = vitrum(folder, "verify --group leaks --backend native,embree --json").output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let of = |i: usize| (json["groups"][i]["path"].as_str().unwrap(), json["groups"][i]["holds"].as_bool().unwrap());
    assert_eq!((of(0), of(2)), (("native", true), ("embree-fast", false)));
}

fn scene_of(mesh: vitrum::geometry::TriMesh) -> vitrum::scene::Scene {
    use vitrum::scene::{Material, Medium, Object, Scene};
    Scene {
        geometry: vec![Geometry { shape: Shape::Mesh(mesh), mask: GeometryMask::OPAQUE }],
        objects: vec![Object { name: "thing".into(), material: 0, origin: Default::default() }],
        materials: vec![Material::default()],
        media: vec![Medium::air()],
        ..Scene::default()
    }
}

fn at_scene(candidate: &impl Candidate, scene: &vitrum::scene::Scene, group: Group) -> GroupResult {
    let plan = VerifyPlan { groups: vec![group], full: false, rays: None };
    verify::fire_at_scene(candidate, scene, "a thing.obj", &plan, &Observer::default()).expect("builds").remove(0)
}

#[test]
fn a_failing_ray_at_a_scene_is_told_line_by_line_with_the_command_that_repeats_it() {
    let found = at_scene(&Broken(Fault::OpenEdges), &scene_of(shapes::grid(4)), Group::Leaks);
    assert!(!found.holds() && found.tally.left_out == 0);
    for example in &found.tally.examples {
        let lines: Vec<&str> = example.lines().collect();
        assert_eq!(lines.len(), 5, "{example}");
        assert!(lines[0].starts_with("triangle ") && lines[0].ends_with(" of `thing`: leak"), "{example}");
        assert!(lines[1].starts_with("  ray     from (") && lines[1].ends_with(", t from 0 to inf"), "{example}");
        assert!(lines[2].starts_with("  f64     triangle ") && lines[2].contains(" of `thing` at t = "), "{example}");
        assert_eq!(lines[3], "  only    nothing; blocked");
        assert!(lines[4].starts_with("  repeat  vitrum parity 'a thing.obj' --ray="), "{example}");
    }
}

#[test]
fn work_at_triangles_that_lie_at_one_place_is_bounded_and_what_is_left_out_is_counted() {
    use glam::Vec3;
    let mut heap = shapes::grid(1);
    heap.triangles = heap.triangles.repeat(1_000);
    let nested = (1..2_000).flat_map(|k| [Vec3::X, Vec3::Y, -Vec3::ONE].map(|p| p * k as f32)).collect::<Vec<_>>();
    let triangles = (0..nested.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let nested = vitrum::geometry::TriMesh { positions: nested, triangles, ..Default::default() };
    (heap.normals, heap.normal_indices, heap.uvs, heap.uv_indices) = Default::default();
    for mesh in [heap, nested] {
        let scene = scene_of(mesh);
        for group in Group::OF_SCENE {
            let plan = VerifyPlan { groups: vec![group], full: false, rays: Some(6400) };
            let fire = || {
                let found = verify::fire_at_scene(&NATIVE, &scene, "heap", &plan, &Observer::default());
                found.expect("builds").remove(0)
            };
            let found = fire();
            assert!(found.holds() && found.tally.cases > 0, "{group:?}: {:#?}", found.tally);
            assert!(found.tally.left_out > 1_000, "{group:?}: {}", found.tally.left_out);
            if group == Group::Parity {
                assert_eq!(fire().tally, found.tally, "the same each time");
            }
        }
    }
}

#[test]
fn balls_of_any_size_are_as_quick_to_look_at_and_nothing_is_left_out() {
    for size in [1e-18, 1e-12, 1e-6, 1.0, 1e12] {
        let mut ball = shapes::sphere(24);
        ball.positions.iter_mut().for_each(|p| *p *= size);
        let mut scene = scene_of(ball);
        scene.camera.eye = glam::Vec3::Z * 4.0 * size;
        for group in Group::OF_SCENE {
            let plan = VerifyPlan { groups: vec![group], full: false, rays: Some(6400) };
            let found = verify::fire_at_scene(&NATIVE, &scene, "ball", &plan, &Observer::default());
            let found = found.expect("builds").remove(0);
            assert!(found.holds() && found.tally.left_out == 0, "{size:e}, {group:?}: {:#?}", found.tally);
        }
    }
}
