//! Native against the arbiter, ray by ray: on every built-in shape, and on real models where VITRUM_MESHES names their
//! folder. Whatever differs is shown to be undecidable; nothing is wrong.

use crate::support;

use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use glam::{DVec3, Vec3};
use support::backends;
use vitrum::accel::reference::{Cause, Fault, Reference, Verdict};
use vitrum::accel::{Backend, Coherence, Intersector};
use vitrum::geometry::{Geometry, GeometryMask, Hit, Plane, Ray, Shape, Sphere, TriMesh};
use vitrum::load::{self, shapes};
use vitrum::trial::View;
use vitrum::trial::parity::{Answers, Query, Records, Set, VerdictCounts, ask, judge, sets};
use vitrum::trial::rays::bounds;

/// The real models that are traced.
const MODELS: [&str; 6] =
    ["armadillo", "stanford_bunny", "stanford_dragon_res2", "glass_teapot", "utah_teapot", "glass_candle_holder"];

fn say(line: &str) {
    // Past the test harness, which shows nothing of what passes.
    writeln!(std::io::stderr(), "{line}").ok();
}

fn mesh(mesh: TriMesh) -> Geometry {
    Geometry { shape: Shape::Mesh(mesh), mask: GeometryMask::OPAQUE }
}

/// Every built-in shape at several tessellations, alone; and a room with something of everything.
fn built_in() -> Vec<(String, Vec<Geometry>)> {
    let waves = [
        shapes::Wave { amplitude: 0.05, wavelength: 0.7, direction: 20.0, phase: 0.0 },
        shapes::Wave { amplitude: 0.02, wavelength: 0.3, direction: 75.0, phase: 40.0 },
    ];
    let goblet = [
        [0.0, 0.0],
        [0.4, 0.02],
        [0.06, 0.1],
        [0.05, 0.6],
        [0.45, 1.0],
        [0.4, 1.5],
        [0.37, 1.5],
        [0.4, 1.0],
        [0.0, 0.7],
    ];
    let mut all = Vec::new();
    for n in [1, 3, 10, 40] {
        let water = |depth| shapes::heightfield([2.0, 3.0], &waves, 0.1, depth, n).expect("sound waves");
        let made = [
            ("box", shapes::cuboid(n)),
            ("disc", shapes::disc(n.max(3))),
            ("grid", shapes::grid(n)),
            ("sphere", shapes::sphere(n.max(2))),
            ("torus", shapes::torus(1.0, 0.3, n.max(3))),
            ("lathe", shapes::lathe(&goblet, n.max(3), 30.0).expect("a sound profile")),
            ("height field", water(None)),
            ("water", water(Some(0.5))),
        ];
        all.extend(made.map(|(name, shape)| (format!("{name} {n}"), vec![mesh(shape)])));
    }
    let exact = |x: f32, radius| {
        let sphere = Sphere { centre: Vec3::new(x, 0.2, -0.3), radius };
        Geometry { shape: Shape::Sphere(sphere), mask: GeometryMask::OPAQUE }
    };
    let plane = |y: f32, normal| {
        let plane = Plane { point: Vec3::new(0.0, y, 0.0), normal };
        Geometry { shape: Shape::Plane(plane), mask: GeometryMask::OPAQUE }
    };
    all.push((String::from("exact spheres"), vec![exact(0.0, 1.0), exact(1.5, 0.8), exact(-30.0, 0.01)]));
    all.push((String::from("planes"), vec![plane(-1.0, Vec3::Y), plane(8.0, Vec3::new(0.1, 1.0, 0.2).normalize())]));
    let mut room = vec![mesh(shapes::torus(1.0, 0.3, 24)), exact(0.0, 0.6), plane(-1.5, Vec3::Y)];
    room.push(mesh(shapes::sphere(30)));
    all.push((String::from("room"), room));
    all
}

/// Scene and camera to trace.
struct World {
    name: String,
    geometry: Vec<Geometry>,
    view: View,
}

fn built_in_worlds() -> Vec<World> {
    let view = |geometry: &[Geometry]| {
        let bounds = bounds(geometry);
        let front =
            View { eye: Vec3::new(0.0, 1.0, 5.0), target: Vec3::ZERO, up: Vec3::Y, fov: 50.0, light: Vec3::ONE };
        if bounds.is_empty() { front } else { View::of(&bounds) }
    };
    built_in().into_iter().map(|(name, geometry)| World { view: view(&geometry), name, geometry }).collect()
}

/// The real models; none, and loud word of it, where VITRUM_MESHES is not set.
fn models(test: &str) -> Vec<World> {
    let Some(folder) = std::env::var_os("VITRUM_MESHES").map(PathBuf::from) else {
        say(&format!("SKIPPED {test} on real models: VITRUM_MESHES is not set"));
        return Vec::new();
    };
    let load = |name: &str| {
        let file = folder.join(name).join(name).with_extension("obj");
        let scene = load::scene(&file, &load::LoadOptions::default()).unwrap_or_else(|e| panic!("{e}")).scene;
        World { name: name.into(), view: View::of(&bounds(&scene.geometry)), geometry: scene.geometry }
    };
    MODELS.map(load).into()
}

fn verdicts(reference: &Reference, set: &Set, answers: &[Answers]) -> Vec<Records> {
    judge(reference, set, answers, &AtomicBool::new(false), |_| {}).expect("nobody stops it")
}

/// Returns `t` where `ray` hits the plane of the triangle of `hit`, and its tolerance: 16 ulp of the coordinates' scale
/// over |cos| of incidence and the length of the direction.
fn plane_of_hit(geometry: &[Geometry], ray: &Ray, hit: &Hit) -> Option<(f64, f64)> {
    let Shape::Mesh(mesh) = &geometry[hit.geometry as usize].shape else { return None };
    let [a, b, c] = mesh.corners(hit.primitive as usize).map(|p| p.as_dvec3() - ray.origin.as_dvec3());
    let (normal, dir) = ((b - a).cross(c - a), ray.dir.as_dvec3());
    let scale = [a, b, c].iter().fold(DVec3::ZERO, |m, p| m.max(p.abs())).max_element();
    let ulp = f64::from((scale as f32).next_up()) - f64::from(scale as f32);
    let cos = normal.dot(dir).abs() / (normal.length() * dir.length());
    Some((normal.dot(a) / normal.dot(dir), 16.0 * ulp / (cos * dir.length())))
}

fn same(a: &Hit, b: &Hit) -> bool {
    let bits = |h: &Hit| (h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.id());
    bits(a) == bits(b)
}

/// Traces `count` rays of each kind by every kernel and holds the answers against the arbiter.
fn native_is_never_wrong(world: &World, count: usize) -> VerdictCounts {
    let World { name, geometry, view } = world;
    let reference = Reference::build(geometry);
    let accel = backends::native(geometry);
    let mut sum = VerdictCounts::default();
    for set in sets(&reference, geometry, view, count) {
        let answers = ask(&accel, &set.rays, set.coherence);
        for (kernel, held) in accel.by_kernel().into_iter().chain([("auto", accel.clone())]) {
            for coherence in [Coherence::Coherent, Coherence::Incoherent] {
                let other = ask(&held, &set.rays, coherence);
                let same = other.hits.iter().zip(&answers.hits).all(|(a, b)| same(a, b));
                assert!(same && other.blocked == answers.blocked, "{name}, {}: {kernel:?}, {coherence:?}", set.name);
            }
        }
        for ((ray, hit), blocked) in set.rays.iter().zip(&answers.hits).zip(&answers.blocked) {
            assert_eq!(hit.is_hit(), *blocked, "{name}, {}: {ray:?} and {hit:?}", set.name);
        }
        let records = verdicts(&reference, &set, std::slice::from_ref(&answers));
        for (query, record) in records[0].each() {
            let tally = &record.tally;
            assert_eq!(tally.broken(), 0, "{name}, {}, {query:?}: {:#?}", set.name, record.wrong);
            assert_eq!(tally.answers, set.rays.len() as u64);
            assert_eq!(tally.agree + tally.all_undecidable(), tally.answers);
            assert!(tally.largest_margin <= 1.0, "{name}, {}: {tally:?}", set.name);
            sum.merge(tally);
        }
        an_interval_ends_at_the_very_hit(&accel, &set, &answers);
        the_parameter_is_right(&format!("{name}, {}", set.name), geometry, &reference, &set, &answers);
    }
    sum
}

/// A ray that ends at the very `t` that it reports still meets the same, and one that begins there no more.
fn an_interval_ends_at_the_very_hit(accel: &impl Intersector, set: &Set, answers: &Answers) {
    let met = || set.rays.iter().zip(&answers.hits).filter(|(_, hit)| hit.is_hit());
    let until: Vec<Ray> = met().map(|(ray, hit)| Ray { t_max: hit.t, ..*ray }).collect();
    for (again, (ray, hit)) in ask(accel, &until, set.coherence).hits.iter().zip(met()) {
        assert!(same(again, hit), "{}: {ray:?} met {hit:?}, and {again:?} when it ended there", set.name);
    }
    let since: Vec<Ray> = met().map(|(ray, hit)| Ray { t_min: hit.t, ..*ray }).collect();
    for (next, (ray, hit)) in ask(accel, &since, set.coherence).hits.iter().zip(met()) {
        assert!(next.t > hit.t, "{}: {ray:?} met {hit:?}, and {next:?} when it began there", set.name);
    }
}

/// `t` of every hit that the arbiter confirms, measured against the plane of its triangle.
fn the_parameter_is_right(what: &str, geometry: &[Geometry], reference: &Reference, set: &Set, answers: &Answers) {
    for (ray, hit) in set.rays.iter().zip(&answers.hits).filter(|(_, hit)| hit.is_hit()) {
        let Some((t, bound)) = plane_of_hit(geometry, ray, hit) else { continue };
        let off = (f64::from(hit.t) - t).abs();
        assert!(
            off <= bound || reference.judge(ray, hit) != Verdict::Agrees,
            "{what}: t is off by {off:e}, {bound:e} is allowed: {ray:?} met {hit:?}"
        );
    }
}

fn report(name: &str, tally: &VerdictCounts) {
    say(&format!(
        "{name}: {} of {} answers undecidable (edge, tie, interval, sliver, crack: {:?}), margins up to {:.3} of their bounds",
        tally.all_undecidable(),
        tally.answers,
        tally.undecidable,
        tally.largest_margin
    ));
}

#[test]
fn native_is_never_wrong_on_built_in_shapes() {
    let mut sum = VerdictCounts::default();
    for world in built_in_worlds() {
        sum.merge(&native_is_never_wrong(&world, 400));
    }
    report("built-in shapes", &sum);
    assert!(sum.answers > 100_000 && sum.agree * 100 > sum.answers * 60, "{sum:?}");
}

#[test]
fn native_is_never_wrong_on_real_models() {
    for world in models("native_is_never_wrong_on_real_models") {
        let tally = native_is_never_wrong(&world, 2500);
        report(&world.name, &tally);
    }
}

/// A pair of walls behind each other, each of many triangles.
fn walls() -> World {
    let mut far = shapes::grid(8);
    far.positions.iter_mut().for_each(|p| p.y -= 0.5);
    let geometry = vec![mesh(shapes::grid(8)), mesh(far)];
    let above = View { eye: Vec3::new(0.1, 3.0, 0.2), target: Vec3::ZERO, up: Vec3::Z, fov: 12.0, light: Vec3::Y };
    World { name: String::from("walls"), geometry, view: above }
}

#[test]
fn every_planted_fault_is_found_and_called_by_its_name() {
    let World { geometry, view, .. } = walls();
    let reference = Reference::build(&geometry);
    let native = backends::native(&geometry);
    let set = sets(&reference, &geometry, &view, 2000).swap_remove(0);
    assert_eq!(set.name, "primary");
    let right = ask(&native, &set.rays, set.coherence);
    let plant = |change: &dyn Fn(usize, &mut Hit, &mut bool)| {
        let mut answers = right.clone();
        for (k, (hit, blocked)) in answers.hits.iter_mut().zip(&mut answers.blocked).enumerate().step_by(10) {
            assert!(hit.is_hit() && hit.geometry == 0);
            change(k, hit, blocked);
        }
        let all = [right.clone(), answers];
        let found = verdicts(&reference, &set, &all);
        assert_eq!(found[0].closest.tally.broken() + found[0].occluded.tally.broken(), 0);
        found[1].clone()
    };
    let planted = set.rays.len().div_ceil(10) as u64;
    let only = |fault: Fault| {
        let mut wrong = [0; 7];
        wrong[fault as usize] = planted;
        wrong
    };

    let missed = plant(&|_, hit, blocked| (*hit, *blocked) = (Hit::MISS, false));
    for (query, record) in missed.each() {
        assert_eq!(record.tally.wrong, only(Fault::MissedHit), "{query:?}");
        assert_eq!((record.differs, record.differs_undecidably), (planted, 0));
        assert!((1..=4).contains(&record.wrong.len()));
        let example = &record.wrong[0];
        assert!(example.fault == Some(Fault::MissedHit) && example.truth.is_hit() && !example.claim.is_hit());
    }
    let onwards: Vec<Ray> = set.rays.iter().zip(&right.hits).map(|(ray, hit)| Ray { t_min: hit.t, ..*ray }).collect();
    let next = ask(&native, &onwards, set.coherence).hits;
    let farther = plant(&|k, hit, _| *hit = next[k]);
    assert_eq!(farther.closest.tally.wrong, only(Fault::OtherPrimitive));
    assert_eq!((farther.occluded.tally.wrong, farther.occluded.differs), ([0; 7], 0));
    let off = plant(&|_, hit, _| hit.t *= 1.0 + 1e-4);
    assert_eq!(off.closest.tally.wrong, only(Fault::TOutOfBounds));
    assert_eq!(off.closest.differs, 0, "it names the same primitive");
    let elsewhere = plant(&|_, hit, _| hit.primitive ^= 64);
    assert_eq!(elsewhere.closest.tally.all_wrong(), planted);
    let behind = plant(&|_, hit, _| hit.t = -hit.t);
    assert_eq!(behind.closest.tally.wrong, only(Fault::OutsideInterval));
}

/// The floor at 0.1 + 0.2 - 0.3, which rays left on its wrong side as long as the bound on their start left out a term.
#[test]
fn a_ray_that_meets_the_surface_it_leaves_is_a_fault_of_its_own_and_none_does() {
    let plane = Plane { point: Vec3::new(0.0, 5.55e-17, 0.0), normal: Vec3::Y };
    let geometry = [Geometry { shape: Shape::Plane(plane), mask: GeometryMask::OPAQUE }];
    let reference = Reference::build(&geometry);
    let native = backends::native(&geometry);
    let view = View { eye: Vec3::new(0.0, 1.0, 5.0), target: Vec3::ZERO, up: Vec3::Y, fov: 40.0, light: Vec3::Y };
    let mut set = sets(&reference, &geometry, &view, 1000).pop().expect("the last set");
    assert_eq!(set.name, "leaving");
    assert!(set.rays.len() > 400 && set.leaves.len() == set.rays.len());
    let right = ask(&native, &set.rays, set.coherence);
    assert_eq!(verdicts(&reference, &set, &[right])[0].closest.tally.broken(), 0);
    // As far on the other side.
    for ray in &mut set.rays {
        ray.origin.y = 2.0 * plane.point.y - ray.origin.y;
    }
    let answers = ask(&native, &set.rays, set.coherence);
    let tally = verdicts(&reference, &set, &[answers])[0].closest.tally;
    assert_eq!(tally.wrong[Fault::SelfHit as usize], set.rays.len() as u64);
}

#[test]
fn hits_off_an_end_by_a_rounding_are_a_class_of_their_own_and_slips_through_seams_are_leaks() {
    let World { geometry, .. } = walls();
    let reference = Reference::build(&geometry);
    let down = Ray::new(Vec3::new(0.1, 1.0, 0.05), Vec3::NEG_Y);
    let short = Ray { t_max: 1.0_f32.next_down(), ..down };
    let seam = Ray::new(Vec3::new(0.0, 1.0, 0.1), Vec3::NEG_Y);
    let rays = [short, seam, Ray { t_max: 0.9, ..down }];
    let set = Set { name: "by hand", coherence: Coherence::Incoherent, rays: rays.to_vec(), leaves: Vec::new() };
    let full = ask(&backends::native(&geometry), &[down, seam, down], set.coherence);
    let mut leaked = full.clone();
    leaked.hits[1] = Hit::MISS;
    let found = verdicts(&reference, &set, &[full, leaked]);
    let [full, leaked] = [0, 1].map(|i| found[i].closest.tally);
    assert_eq!((full.agree, full.beyond_end, full.wrong[Fault::OutsideInterval as usize]), (1, 1, 1));
    assert_eq!((full.broken(), full.all_wrong()), (2, 1));
    assert_eq!((leaked.agree, leaked.wrong[Fault::Leak as usize]), (0, 1));
    // Whether the short ray is blocked is undecidable by an end of its interval.
    assert_eq!(found[0].occluded.tally.undecidable[Cause::Interval as usize], 1);
    let [(first, _), (second, _)] = found[0].each();
    assert_eq!((first, second), (Query::Closest, Query::Occluded));
}

#[test]
fn judging_stops_when_it_is_told_to() {
    let World { geometry, view, .. } = walls();
    let reference = Reference::build(&geometry);
    let set = sets(&reference, &geometry, &view, 100).swap_remove(0);
    let answers = ask(&reference, &set.rays, set.coherence);
    assert!(judge(&reference, &set, &[answers], &AtomicBool::new(true), |_| {}).is_none());
}

/// Embree as it is: counted and told, and held to a share that its own words ("next to no rays lost") leave room for.
#[test]
fn embree_in_robust_mode_is_wrong_at_few_corners_and_next_to_nowhere_else() {
    const TEST: &str = "embree_in_robust_mode_is_wrong_at_few_corners_and_next_to_nowhere_else";
    if !backends::is_there(Backend::Embree) {
        return;
    }
    let (mut pictured, mut aimed) = (VerdictCounts::default(), VerdictCounts::default());
    for World { name, geometry, view } in built_in_worlds().into_iter().chain(models(TEST)) {
        let reference = Reference::build(&geometry);
        let Some(accel) = backends::embree(Backend::Embree, &geometry) else { panic!("{name}") };
        for set in sets(&reference, &geometry, &view, 1000) {
            let answers = ask(&accel, &set.rays, set.coherence);
            let records = verdicts(&reference, &set, &[answers]);
            let sum = if ["edge", "vertex", "end"].contains(&set.name) { &mut aimed } else { &mut pictured };
            records[0].each().iter().for_each(|(_, record)| sum.merge(&record.tally));
        }
    }
    for (what, tally) in [("as pictures need them", &pictured), ("aimed at trouble", &aimed)] {
        report(&format!("Embree, robust, rays {what}"), tally);
        say(&format!("  beyond an end {}, wrong {:?}", tally.beyond_end, tally.wrong));
        assert!(tally.largest_margin <= 1.0 && tally.answers > 50_000);
    }
    assert!(pictured.broken() * 10_000 <= pictured.answers, "{pictured:?}");
    assert!(aimed.broken() * 200 <= aimed.answers, "{aimed:?}");
}

fn parity(arguments: &[&str]) -> assert_cmd::assert::Assert {
    let mut command = assert_cmd::Command::cargo_bin("vitrum").expect("the program is built");
    command.current_dir(env!("CARGO_MANIFEST_DIR")).arg("parity").args(arguments).assert()
}

#[test]
fn the_command_tells_it_in_eighty_columns_and_as_json_of_a_stable_shape() {
    let small = ["scenes/hall.toml", "--rays", "300", "--width", "40"];
    let text = parity(&small).code(0);
    let text = String::from_utf8_lossy(&text.get_output().stdout).into_owned();
    assert!(text.contains("native is nowhere wrong") && text.contains("scenes/hall.toml"), "{text}");
    let long = text.lines().filter(|l| !l.starts_with("left out")).find(|l| l.chars().count() > 80);
    assert_eq!(long, None);

    let json = parity(&[&small[..], &["--json"]].concat()).code(0);
    let report: serde_json::Value = serde_json::from_slice(&json.get_output().stdout).expect("JSON");
    assert_eq!((&report["native_wrong"], &report["passed"]), (&0.into(), &true.into()));
    assert_eq!(report["contenders"][0], "native");
    let rows = report["rows"].as_array().expect("rows");
    let kinds =
        ["primary", "shadow", "mirror", "refracted", "diffuse", "diffuse-any", "edge", "vertex", "end", "leaving"];
    for kind in kinds {
        for query in ["closest", "occluded"] {
            let of = |r: &&serde_json::Value| r["rays"] == kind && r["query"] == query && r["contender"] == "native";
            let row = rows.iter().find(of).unwrap_or_else(|| panic!("no row for {kind}, {query}"));
            let sum = |of: &str| row[of].as_object().expect(of).values().filter_map(|n| n.as_u64()).sum::<u64>();
            let whole = row["agree"].as_u64().zip(row["beyond_end"].as_u64()).map(|(a, b)| a + b);
            assert_eq!(whole.map(|n| n + sum("undecidable") + sum("wrong")), row["answers"].as_u64(), "{row}");
        }
    }
    let picture = &report["pictures"][0];
    assert_eq!(
        (&picture["contender"], &picture["width"], &picture["wrong"]),
        (&"native".into(), &40.into(), &0.into())
    );
    let embree = report["contenders"].as_array().is_some_and(|c| c.len() == 3);
    assert_eq!(report["left_out"].as_array().map(Vec::is_empty), Some(embree), "who is left out is told");
}

#[test]
fn the_command_finds_the_same_by_a_hierarchy_of_any_quality() {
    let reports = ["fast", "default", "high"].map(|quality| {
        let json = parity(&["scenes/hall.toml", "--rays", "200", "--width", "24", "--json", "--bvh", quality]).code(0);
        let report: serde_json::Value = serde_json::from_slice(&json.get_output().stdout).expect("JSON");
        assert_eq!((&report["bvh"], &report["native_wrong"]), (&quality.into(), &0.into()));
        report
    });
    // Of native alone: Embree settles ties by the order that its own tree has them in.
    let native = |report: &serde_json::Value, list: &str| {
        let of_native = |row: &&serde_json::Value| row["contender"] == "native";
        report[list].as_array().expect(list).iter().filter(of_native).cloned().collect::<Vec<_>>()
    };
    for list in ["rows", "pictures"] {
        let [fast, default, high] = reports.each_ref().map(|report| native(report, list));
        assert!(!default.is_empty() && fast == default && high == default, "{list}");
    }
}

#[test]
fn one_ray_is_sent_through_every_path_and_repeated_exactly() {
    let ray = "--ray=0.1,1.2,4,-0.033333335,-0.4,-1,0,inf";
    let text = parity(&["scenes/hall.toml", ray]).code(0);
    let text = String::from_utf8_lossy(&text.get_output().stdout).into_owned();
    assert!(
        text.starts_with("ray            from (0.1, 1.2, 4) along (-0.033333335, -0.4, -1), t from 0 to inf\n"),
        "{text}"
    );
    for way in ["single", "packet", "batch", "stream"] {
        assert!(text.contains(&format!("\nnative {way:<7} triangle ")), "{text}");
    }
    assert!(text.contains(" (agrees); blocked (agrees)") && text.ends_with("native is nowhere wrong\n"), "{text}");
    let json = parity(&["scenes/hall.toml", ray, "--json"]).code(0);
    let report: serde_json::Value = serde_json::from_slice(&json.get_output().stdout).expect("JSON");
    assert_eq!((&report["passed"], &report["native_wrong"]), (&true.into(), &0.into()));
    assert_eq!(report["dir"].as_array().expect("dir").len(), 3);
    assert_eq!(report["answers"][0]["hit"]["primitive"], report["truth"]["primitive"]);
    let short = parity(&["scenes/hall.toml", "--ray=0.1,1.2,4,-0.033333335,-0.4,-1,0,1e-3", "--json"]).code(0);
    let report: serde_json::Value = serde_json::from_slice(&short.get_output().stdout).expect("JSON");
    assert!(report["truth"].is_null() && report["answers"][0]["blocked"] == false);
    parity(&["scenes/hall.toml", "--ray=1,2,3"]).code(2);
    parity(&["scenes/hall.toml", ray, "--rays", "5"]).code(2);
}

#[test]
fn the_command_refuses_what_it_cannot_read() {
    parity(&["no/such/scene.toml"]).code(3);
    parity(&["scenes/hall.toml", "--rays", "0"]).code(2);
    parity(&["scenes/hall.toml", "--bvh", "best"]).code(2);
    parity(&["README.md"]).code(2);
}
