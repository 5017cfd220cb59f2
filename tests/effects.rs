//! A render simulates what its scene calls for, says why, and makes the same picture by code that knows everything.

#[path = "support/mod.rs"]
mod support;

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use glam::Vec3;
use support::scenes::{add, bare, cuboid, cuboid_mesh, empty, glass, material, native, plane, sphere};
use support::{Rng, random};
use vitrum::effects::{self, Decision, Effect, EffectPlan, EffectSet, Pipeline};
use vitrum::geometry::{Shape, Sphere};
use vitrum::load;
use vitrum::render::{Observer, Options, Outcome, Stage, reference};
use vitrum::scene::{
    Colour, Dispersion, Environment, Falloff, FresnelRule, Interface, Light, LightKind, Material, MirrorSource,
    Projection, Rgb, Scene, Settings,
};

fn by(pipeline: Pipeline, without: EffectSet, options: &Options) -> Options {
    Options { effects: effects::Options { pipeline, without }, ..options.clone() }
}

fn same(a: &Outcome, b: &Outcome) -> bool {
    let bits = |o: &Outcome| -> Vec<u32> {
        let films = o.film.pixels.as_flattened().iter().chain(o.truncated.pixels.as_flattened());
        films.map(|x| x.to_bits()).collect()
    };
    bits(a) == bits(b)
}

fn auto_and_all(scene: &Scene, without: EffectSet, options: &Options) -> [Outcome; 2] {
    [Pipeline::Auto, Pipeline::All].map(|pipeline| native(scene, &by(pipeline, without, options)))
}

fn scene_files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let list = |folder: PathBuf| {
        std::fs::read_dir(folder).expect("the folder is there").map(|f| f.expect("readable").path()).collect::<Vec<_>>()
    };
    let mut files = [list(folder.join("hard")), list(folder)].concat();
    files.retain(|f| f.extension().is_some_and(|e| e == "toml"));
    assert!(files.len() >= 19, "{files:?}");
    files
}

fn small(file: &Path) -> Scene {
    let mut scene = load::scene(file, &load::LoadOptions::default()).expect("loads").scene;
    (scene.settings.width, scene.settings.height, scene.settings.samples) = (40, 30, 1);
    scene
}

#[test]
fn every_scene_of_the_project_is_the_same_by_all_stages_as_by_its_own() {
    for file in scene_files() {
        let [auto, all] = auto_and_all(&small(&file), EffectSet::EMPTY, &Options::default());
        assert!(same(&auto, &all), "{}", file.display());
    }
}

#[test]
fn random_scenes_with_random_effects_left_out_are_the_same_by_all_stages_as_by_their_own() {
    let mut rng = Rng::new(77);
    for seed in 0..300 {
        let (scene, fresnel) = random::scene(seed);
        let options = Options { fresnel, ..Options::default() };
        let some: EffectSet = Effect::ALL.iter().copied().filter(|_| rng.below(6) == 0).collect();
        for without in [EffectSet::EMPTY, some] {
            let [auto, all] = auto_and_all(&scene, without, &options);
            assert!(same(&auto, &all), "scene {seed} without {:?}", without.iter().collect::<Vec<_>>());
        }
    }
}

#[test]
fn what_is_off_can_be_left_out_without_changing_a_bit() {
    for seed in 0..120 {
        let (scene, fresnel) = random::scene(seed);
        let options = Options { fresnel, ..Options::default() };
        let whole = native(&scene, &options);
        let plan = EffectPlan::resolve(&scene, &options.effects);
        for decision in plan.decisions.iter().filter(|d| !d.on) {
            let without = EffectSet::EMPTY.with(decision.effect);
            let left = native(&scene, &by(Pipeline::Auto, without, &options));
            assert!(same(&whole, &left), "scene {seed}: {} is off ({})", decision.effect, decision.because);
        }
    }
}

#[test]
fn a_picture_never_takes_more_rays_or_deeper_ones_than_was_said_before() {
    for seed in 0..200 {
        let (scene, fresnel) = random::scene(seed);
        let options = Options { fresnel, ..Options::default() };
        let bound = EffectPlan::resolve(&scene, &options.effects).rays;
        let rays = native(&scene, &options).rays;
        let pixels = f64::from(scene.settings.width * scene.settings.height);
        assert!(rays.total() as f64 <= bound.per_pixel * pixels, "scene {seed}: {} of {bound:?}", rays.total());
        assert!(rays.by_depth.len() as u32 <= bound.depth + 1, "scene {seed}: {bound:?}");
    }
}

/// Rays of a scene of one camera ray to a pixel: what was said before, and the most that a pixel took.
fn said_and_taken(scene: &mut Scene) -> (effects::RayBound, f64) {
    let said = EffectPlan::resolve(scene, &effects::Options::default()).rays;
    let mut most = 0;
    let (width, height) = (scene.settings.width, scene.settings.height);
    (scene.settings.width, scene.settings.height) = (1, 1);
    let (eye, target) = (scene.camera.eye, scene.camera.target);
    for i in 0..width * height {
        // One pixel at a time, looking all over the scene.
        let off = Vec3::new((i % width) as f32 / width as f32 - 0.5, (i / width) as f32 / height as f32 - 0.5, 0.0);
        scene.camera.target = target + off * 2.0;
        most = most.max(native(scene, &Options::default()).rays.total());
    }
    (scene.settings.width, scene.settings.height) = (width, height);
    (scene.camera.eye, scene.camera.target) = (eye, target);
    (said, most as f64)
}

#[test]
fn the_bound_on_rays_is_reached_where_it_can_be_counted_by_hand() {
    let base = || {
        let mut scene = empty(1.0);
        scene.settings = Settings { width: 8, height: 8, max_depth: 6, cutoff: 0.0, ..Settings::default() };
        (scene.camera.eye, scene.camera.target) = (Vec3::new(0.0, 0.1, 4.0), Vec3::ZERO);
        scene
    };
    // A ball of glass: one ray outside and one inside at each level after the first.
    let mut scene = base();
    let clear = glass(&mut scene, 1.5, 0, Rgb::ZERO);
    sphere(&mut scene, Vec3::ZERO, 1.0, clear);
    let (said, taken) = said_and_taken(&mut scene);
    assert_eq!((said.depth, said.per_pixel, taken), (6, 1.0 + 2.0 * 6.0, 13.0));
    // A box of glass alone, which a ray can leave on any side.
    let mut scene = base();
    let clear = glass(&mut scene, 1.5, 0, Rgb::ZERO);
    cuboid(&mut scene, Vec3::new(-0.9, -0.7, -0.5), Vec3::new(0.8, 0.6, 0.4), clear);
    let (said, taken) = said_and_taken(&mut scene);
    assert!(said.per_pixel == 13.0 && taken <= 13.0, "{said:?} {taken}");
    // One plane of a mirror: a ray and its reflection. With a lamp over a floor that answers, shadow rays from the end.
    let mut scene = base();
    let mirror = material(&mut scene, mirror());
    plane(&mut scene, Vec3::Z * -1.0, Vec3::Z, mirror);
    let grey = material(&mut scene, grey());
    plane(&mut scene, Vec3::Z * 5.0, -Vec3::Z, grey);
    scene.lights.push(lamp(Vec3::new(0.0, 3.0, 0.0)));
    let (said, taken) = said_and_taken(&mut scene);
    assert_eq!((said.depth, said.per_pixel, taken), (1, 3.0, 3.0));
    // Two facing mirrors that keep 0.9: 0.9 to the 65th is the last that is not below 1/1024.
    let mut scene = base();
    (scene.settings.max_depth, scene.settings.cutoff) = (500, 1.0 / 1024.0);
    let mirror = material(&mut scene, mirror_of(0.9));
    plane(&mut scene, Vec3::Z * -1.0, Vec3::Z, mirror);
    plane(&mut scene, Vec3::Z * 5.0, -Vec3::Z, mirror);
    let (said, taken) = said_and_taken(&mut scene);
    assert_eq!((said.depth, said.per_pixel, taken), (65, 66.0, 66.0));
}

#[test]
fn scenes_that_disperse_keep_to_their_bound_on_rays() {
    let mut rng = Rng::new(12);
    for k in 0..12 {
        let mut scene = empty(1.0);
        scene.settings = Settings { width: 12, height: 12, max_depth: 5, wavelengths: 7, ..Settings::default() };
        scene.settings.cutoff = [0.0, 1e-3, 0.05, 0.2][k % 4];
        let clear = glass(&mut scene, 1.7, 0, Rgb::ZERO);
        scene.media.last_mut().expect("just added").dispersion = Dispersion::Cauchy([1.7, 0.02, 0.0]);
        for _ in 0..=k / 4 {
            sphere(&mut scene, rng.point() * 0.8, 0.5 + 0.3 * rng.unit(), clear);
        }
        (scene.camera.eye, scene.camera.target) = (rng.direction().normalize() * 4.0, Vec3::ZERO);
        let (said, taken) = said_and_taken(&mut scene);
        assert!(taken <= said.per_pixel, "scene {k}: {taken} of {said:?}");
    }
}

fn lamp(position: Vec3) -> Light {
    let kind = LightKind::Point { position };
    Light { name: "lamp".into(), kind, intensity: Rgb::splat(20.0), falloff: Falloff::InverseSquare, shadows: true }
}

fn grey() -> Material {
    Material { name: "grey".into(), ..Material::default() }
}

fn mirror() -> Material {
    mirror_of(0.9)
}

fn mirror_of(share: f32) -> Material {
    bare(Interface::Mirror { reflectance: Rgb::splat(share), source: MirrorSource::Traced })
}

#[test]
fn a_diffuse_scene_runs_no_stage_but_those_of_diffuse_surfaces() {
    let mut scene = empty(0.0);
    let grey = material(&mut scene, grey());
    cuboid(&mut scene, Vec3::splat(-0.5), Vec3::splat(0.5), grey);
    scene.lights.push(lamp(Vec3::new(2.0, 3.0, 4.0)));
    let streams = native(&scene, &Options::default()).streams;
    for stage in [Stage::Gather, Stage::Base, Stage::Light, Stage::Shadow] {
        assert!(streams.of(stage) > 0, "{stage:?}");
    }
    for stage in [
        Stage::Medium,
        Stage::Miss,
        Stage::Mirror,
        Stage::Conductor,
        Stage::Dielectric,
        Stage::Thin,
        Stage::Coated,
        Stage::Alpha,
        Stage::Lamp,
        Stage::Pass,
    ] {
        assert_eq!(streams.of(stage), 0, "{stage:?}");
    }
    assert_eq!(Stage::COUNT, 14, "a stage that is new is in one of these lists");
    let on: Vec<_> = EffectPlan::resolve(&scene, &effects::Options::default()).on().iter().collect();
    assert_eq!(on, [Effect::Diffuse, Effect::HardShadows]);
    // The same scene with a pane behind the eye has its code, and never runs it.
    let pane = Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fresnel, tint: Rgb::ONE };
    let pane = material(&mut scene, bare(pane));
    sphere(&mut scene, Vec3::new(0.0, 0.0, 50.0), 0.1, pane);
    let streams = native(&scene, &Options::default()).streams;
    assert_eq!((streams.of(Stage::Thin), streams.of(Stage::Pass)), (0, 0));
}

/// A random scene of shiny things with a pane inside a closed shell that nothing gets through.
fn with_a_secret(rng: &mut Rng) -> (Scene, usize, usize) {
    let mut scene = empty(0.5);
    scene.settings = Settings { width: 48, height: 48, max_depth: 12, cutoff: 0.0, ..Settings::default() };
    let surfaces = [
        mirror(),
        grey(),
        bare(Interface::Coated { ior: 1.5 }),
        bare(Interface::Conductor { eta: Rgb::splat(0.2), k: Rgb::splat(3.0) }),
    ];
    let surfaces: Vec<u32> = surfaces.into_iter().map(|m| material(&mut scene, m)).collect();
    let clear = glass(&mut scene, 1.5, 0, Rgb::ZERO);
    let pane = Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fresnel, tint: Rgb::ONE };
    let pane = material(&mut scene, bare(pane));
    let centre = rng.point() * 0.5;
    let outer = surfaces[rng.below(4)];
    let size = 0.2 + rng.unit() * 0.8;
    if rng.below(2) == 0 {
        sphere(&mut scene, centre, size, outer);
    } else {
        let half = Vec3::new(1.0, 0.5 + rng.unit(), 0.3 + rng.unit()) * size;
        let mut mesh = cuboid_mesh(-half, half);
        let turn = glam::Quat::from_axis_angle(rng.direction().normalize(), rng.unit() * 6.0);
        mesh.positions.iter_mut().for_each(|p| *p = turn * *p + centre);
        add(&mut scene, Shape::Mesh(mesh), outer);
    }
    // As large as will be proven to be inside, and sometimes larger.
    sphere(&mut scene, centre, size * (0.05 + 0.3 * rng.unit()), pane);
    for _ in 0..8 {
        let surface = if rng.below(3) == 0 { clear } else { surfaces[rng.below(4)] };
        sphere(&mut scene, rng.direction().normalize() * (2.0 + rng.unit()), 0.3 + 0.4 * rng.unit(), surface);
    }
    scene.lights.push(lamp(rng.direction() * 4.0));
    scene.camera.eye = rng.direction().normalize() * (1.6 + 3.0 * rng.unit());
    scene.camera.target = centre;
    if rng.below(3) == 0 {
        scene.camera.projection = Projection::Orthographic { height: 1.5 };
    }
    (scene, 0, 1)
}

#[test]
fn nothing_ever_meets_what_is_proven_to_be_sealed_in() {
    let (mut rng, mut proven) = (Rng::new(5), 0);
    for k in 0..150 {
        let (scene, wall, secret) = with_a_secret(&mut rng);
        let plan = EffectPlan::resolve(&scene, &effects::Options::default());
        let [auto, all] = auto_and_all(&scene, EffectSet::EMPTY, &Options::default());
        assert!(same(&auto, &all), "scene {k}");
        if plan.reach.sealed[secret] {
            proven += 1;
            assert_eq!(plan.reach.hidden[secret], Some(wall));
            assert!(!plan.of(Effect::ThinPanes).on);
            assert!(
                plan.of(Effect::ThinPanes).because.contains("no ray gets past"),
                "{:?}",
                plan.of(Effect::ThinPanes)
            );
            assert_eq!(all.streams.of(Stage::Thin), 0, "scene {k}: a ray met the pane");
        }
    }
    assert!(proven >= 60, "{proven} proofs to be tried");
}

#[test]
fn nothing_meets_what_lies_behind_an_opaque_plane() {
    let mut rng = Rng::new(6);
    for k in 0..60 {
        let (mut scene, _, secret) = with_a_secret(&mut rng);
        // The shell goes, the pane stays, far below.
        scene.geometry.remove(0);
        scene.objects.remove(0);
        let secret = secret - 1;
        let normal = (Vec3::Y + rng.point() * 0.2).normalize();
        let surface = rng.below(2) as u32;
        plane(&mut scene, normal * -4.2, normal, surface);
        if let Shape::Sphere(pane) = &mut scene.geometry[secret].shape {
            pane.centre = normal * -5.5;
        }
        let plan = EffectPlan::resolve(&scene, &effects::Options::default());
        if plan.reach.hidden[secret].is_some() {
            assert!(plan.reach.unmet[secret] && !plan.reach.sealed[secret]);
            let [auto, all] = auto_and_all(&scene, EffectSet::EMPTY, &Options::default());
            assert!(same(&auto, &all), "scene {k}");
            assert_eq!(all.streams.of(Stage::Thin), 0, "scene {k}: a ray met the pane");
        } else {
            // Only the eye can be on the wrong side.
            assert!(normal.dot(scene.camera.eye) < -4.0, "scene {k}");
        }
    }
}

#[test]
fn rays_that_graze_a_plane_and_start_on_it_far_away_do_not_meet_what_lies_right_behind_it() {
    let (mut rng, mut far) = (Rng::new(8), 0);
    for k in 0..60 {
        let mut scene = empty(0.5);
        scene.settings = Settings { width: 64, height: 64, max_depth: 8, cutoff: 0.0, ..Settings::default() };
        let surfaces = [
            mirror(),
            bare(Interface::Coated { ior: 1.5 }),
            Material { diffuse: Colour::Constant(Rgb::ONE), ..mirror() },
        ];
        let surfaces: Vec<u32> = surfaces.into_iter().map(|m| material(&mut scene, m)).collect();
        let coloured = glass(&mut scene, 1.5, 0, Rgb::splat(0.3));
        let clear = glass(&mut scene, 1.5, 0, Rgb::ZERO);
        let normal = (Vec3::Y + rng.point() * if k % 2 == 0 { 0.0 } else { 0.3 }).normalize();
        let across = normal.any_orthonormal_vector();
        plane(&mut scene, Vec3::ZERO, normal, surfaces[rng.below(3)]);
        // Right behind the plane, as near as is proven and sometimes nearer; none other has an absorbing medium.
        for _ in 0..6 {
            let (along, radius) = (rng.point() * 2.0, 0.1 + 0.5 * rng.unit());
            let depth = radius + 3e-4 * (0.8 + 2.0 * rng.unit());
            sphere(&mut scene, along - normal * (along.dot(normal) + depth), radius, coloured);
        }
        for _ in 0..3 {
            let along = rng.point() * 2.0;
            sphere(&mut scene, along - normal * (along.dot(normal) - 1.5), 0.6, clear);
        }
        // Nearly along the plane, so that much of the picture meets it farther off than anything else is large.
        let slope = 10_f32.powf(-1.0 - 5.0 * rng.unit());
        scene.camera.eye = across * -2.0 + normal * (1e-3 + 0.1 * rng.unit());
        scene.camera.target = scene.camera.eye + across - normal * slope;
        scene.camera.up = normal;
        scene.camera.projection = if rng.below(2) == 0 {
            Projection::Orthographic { height: 0.05 * slope }
        } else {
            Projection::Pinhole { vfov: 3.0 * slope }
        };
        let plan = EffectPlan::resolve(&scene, &effects::Options::default());
        let [auto, all] = auto_and_all(&scene, EffectSet::EMPTY, &Options::default());
        assert!(same(&auto, &all), "scene {k}");
        if plan.reach.unmet[1..7].iter().all(|&unmet| unmet) {
            far += 1;
            assert!(!plan.of(Effect::Absorption).on);
        }
    }
    assert!(far >= 20, "{far} proofs to be tried");
}

#[test]
fn a_lamp_that_is_walled_in_has_no_stage_and_adds_nothing() {
    let (mut rng, mut proven) = (Rng::new(9), 0);
    for k in 0..80 {
        let (mut scene, wall, _) = with_a_secret(&mut rng);
        let position = scene.camera.target + rng.point() * 0.1;
        scene.lights[0].kind = match rng.below(3) {
            0 => LightKind::Sphere { position, radius: 0.02 },
            _ => LightKind::Point { position },
        };
        let plan = EffectPlan::resolve(&scene, &effects::Options::default());
        let [auto, all] = auto_and_all(&scene, EffectSet::EMPTY, &Options::default());
        assert!(same(&auto, &all), "scene {k}");
        if plan.reach.dark[0] {
            proven += 1;
            let why = plan.reach.useless[0].as_ref().expect("told as well");
            assert!(why.ends_with(&format!("is parted from the view by `{}`", scene.objects[wall].name)), "{why}");
            let lit = |outcome: &Outcome| outcome.streams.of(Stage::Light) + outcome.streams.of(Stage::Lamp);
            assert!(lit(&auto) == 0 && auto.streams.of(Stage::Shadow) == 0);
        }
    }
    assert!(proven >= 30, "{proven} proofs to be tried");
}

#[test]
fn nothing_is_proven_by_shells_with_holes_open_ones_touched_ones_or_ones_that_let_light_through() {
    let pane = || bare(Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fresnel, tint: Rgb::ONE });
    let sealed = |change: &dyn Fn(&mut Scene)| {
        let mut scene = empty(1.0);
        let outer = material(&mut scene, mirror());
        let pane = material(&mut scene, pane());
        cuboid(&mut scene, Vec3::splat(-1.0), Vec3::splat(1.0), outer);
        sphere(&mut scene, Vec3::ZERO, 0.5, pane);
        change(&mut scene);
        let plan = EffectPlan::resolve(&scene, &effects::Options::default());
        plan.reach.hidden[1].is_some()
    };
    assert!(sealed(&|_| {}));
    let mesh = |scene: &mut Scene, change: &dyn Fn(&mut vitrum::geometry::TriMesh)| match &mut scene.geometry[0].shape {
        Shape::Mesh(mesh) => change(mesh),
        _ => unreachable!("a box"),
    };
    assert!(!sealed(&|s| mesh(s, &|m| m.triangles.truncate(11))), "a hole");
    assert!(!sealed(&|s| mesh(s, &|m| m.triangles[3].swap(0, 1))), "a triangle turned over");
    // As deep that the corner lies behind the plane through its neighbours; the pane, made small, is still well inside.
    let dent = |s: &mut Scene| {
        mesh(s, &|m| m.positions[7] = Vec3::splat(0.2));
        s.geometry[1].shape = Shape::Sphere(Sphere { centre: Vec3::ZERO, radius: 0.1 });
    };
    assert!(!sealed(&dent), "a corner pushed in");
    let beyond = |s: &mut Scene| {
        s.camera.eye = Vec3::new(0.1, 0.2, 0.3);
        s.geometry[1].shape = Shape::Sphere(Sphere { centre: Vec3::Z * -4.0, radius: 0.5 });
        // With nothing within, the box would not be looked at.
        sphere(s, Vec3::splat(-0.5), 0.2, 0);
    };
    assert!(!sealed(&beyond), "walls seen from within, whose creases rounding may put a ray beyond");
    assert!(!sealed(&|s| s.materials[0].interface = Interface::Alpha { opacity: 0.99 }), "a cover with holes");
    assert!(!sealed(&|s| s.camera.eye = Vec3::new(0.8, 0.8, 0.8)), "the eye inside");
    assert!(!sealed(&|s| s.camera.eye = Vec3::new(0.0, 0.0, 1.0)), "the eye on the wall");
    assert!(!sealed(&|s| sphere(s, Vec3::X, 0.3, 0)), "something across the wall");
    assert!(!sealed(&|s| sphere(s, Vec3::X * 1.5, 0.499_99, 0)), "something all but touching the wall");
    assert!(!sealed(&|s| plane(s, Vec3::Y * -3.0, Vec3::Y, 0)), "a floor, on which rays start anywhere");
    assert!(
        !sealed(&|s| s.geometry[1].shape = Shape::Mesh(cuboid_mesh(Vec3::splat(-1.0), Vec3::splat(1.0)))),
        "the wall's twin"
    );
}

#[test]
fn reasons_name_what_they_are_about() {
    let mut scene = empty(1.0);
    let clear = glass(&mut scene, 1.52, 0, Rgb::ZERO);
    sphere(&mut scene, Vec3::ZERO, 1.0, clear);
    scene.objects[0].name = "goblet".into();
    let why = |scene: &Scene, effect| {
        let decision = EffectPlan::resolve(scene, &effects::Options::default()).of(effect).clone();
        (decision.on, decision.because)
    };
    let is = |on, text: &str| (on, text.to_owned());
    assert_eq!(why(&scene, Effect::Refraction), is(true, "`goblet` has index 1.52 against `air` 1"));
    assert_eq!(why(&scene, Effect::Absorption), is(false, "no medium has a colour"));
    assert_eq!(why(&scene, Effect::HardShadows), is(false, "the only light is the environment"));
    assert_eq!(why(&scene, Effect::NestedMedia), is(false, "depth 1 is enough, no two dielectrics overlap"));
    scene.media[1].absorption = Rgb::X;
    assert_eq!(why(&scene, Effect::Absorption), is(true, "`medium 1.52` has a colour"));
    sphere(&mut scene, Vec3::X, 0.5, clear);
    assert_eq!(why(&scene, Effect::NestedMedia), is(true, "`goblet` and `object 1` may overlap"));
    scene.media[1].ior = 1.0;
    assert_eq!(why(&scene, Effect::TotalInternalReflection), is(false, "no ray can start in a denser medium"));
    assert_eq!(
        why(&scene, Effect::Refraction),
        is(false, "every transparent solid has the index of what surrounds it")
    );
    // A lamp under an opaque floor.
    let floor = material(&mut scene, grey());
    plane(&mut scene, Vec3::Y * -2.0, Vec3::Y, floor);
    scene.objects[2].name = "floor".into();
    scene.lights.push(lamp(Vec3::Y * -3.0));
    assert_eq!(why(&scene, Effect::HardShadows), is(false, "`lamp` is behind `floor`"));
    assert_eq!(why(&scene, Effect::Diffuse).1, "`lamp` is behind `floor`");
    // Nothing is in the way of a light that casts no shadows.
    scene.lights[0].shadows = false;
    assert!(why(&scene, Effect::Diffuse).0, "{}", why(&scene, Effect::Diffuse).1);
}

/// No object is of it: that the eye is in it is all there is to know it by.
#[test]
fn the_medium_around_the_eye_weakens_what_is_seen_through_it() {
    let mut scene = empty(0.0);
    glass(&mut scene, 1.0, 0, Rgb::new(0.5, 0.25, 0.0));
    scene.camera.medium = Some(1);
    let wall = material(&mut scene, Material { emission: Rgb::ONE, ..Material::black("wall") });
    plane(&mut scene, Vec3::Z, Vec3::Z, wall);
    (scene.settings.width, scene.settings.height) = (1, 1);
    (scene.camera.eye, scene.camera.target) = (Vec3::Z * 5.0, Vec3::ZERO);
    let [auto, all] = auto_and_all(&scene, EffectSet::EMPTY, &Options::default());
    assert!(same(&auto, &all));
    for (seen, absorption) in auto.film.pixels[0].into_iter().zip([0.5_f32, 0.25, 0.0]) {
        assert!((seen - (-4.0 * absorption).exp()).abs() < 1e-6, "{seen} through {absorption}");
    }
}

#[test]
fn the_illumination_model_of_a_material_decides_what_is_simulated() {
    let scene = small(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/illum.toml"));
    let plan = EffectPlan::resolve(&scene, &effects::Options::default());
    for (effect, model) in [
        (Effect::Mirror, "illum3"),
        (Effect::ThinPanes, "illum4"),
        (Effect::Coats, "illum5"),
        (Effect::Refraction, "illum6"),
    ] {
        let Decision { on, because, .. } = plan.of(effect);
        assert!(*on && because.contains(&format!("`models/{model}`")), "{effect}: {because}");
    }
    let only = |kept: &str| {
        let mut scene = scene.clone();
        let others: Vec<usize> = (0..scene.objects.len()).filter(|&o| !scene.objects[o].name.ends_with(kept)).collect();
        others.into_iter().rev().for_each(|o| {
            scene.objects.remove(o);
            scene.geometry.remove(o);
        });
        EffectPlan::resolve(&scene, &effects::Options::default()).on()
    };
    assert!(!only("illum2").has(Effect::FresnelSplit) && only("illum2").has(Effect::Highlight));
    // 6 reflects a fixed share, 7 what Fresnel says.
    assert!(only("illum6").has(Effect::Refraction) && !only("illum6").has(Effect::FresnelSplit));
    assert!(only("illum7").has(Effect::Refraction) && only("illum7").has(Effect::FresnelSplit));
}

#[test]
fn both_renderers_leave_out_the_same() {
    for name in ["box", "absorption", "illum"] {
        let scene = small(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("toml"));
        let plan = EffectPlan::resolve(&scene, &effects::Options::default());
        for effect in plan.on().iter() {
            let options = by(Pipeline::Auto, EffectSet::EMPTY.with(effect), &Options::default());
            let ours = native(&scene, &options);
            let theirs = reference::render(&scene, &options, &Observer::default()).expect("nobody interrupts a test");
            let pixels = ours.film.pixels.iter().zip(&theirs.film.pixels);
            let apart = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| (a - b).abs() > 5e-3)).count();
            // Edges and what magnifies roundings.
            assert!(apart <= 24, "{name} without {effect}: {apart} pixels");
        }
    }
}

#[test]
fn each_effect_that_is_on_shows_when_it_is_left_out() {
    let mut scene = empty(0.3);
    let ambient = Material { ambient: Rgb::ONE, emission: Rgb::splat(0.1), ..grey() };
    let checker = Colour::Checker { even: Rgb::ONE, odd: Rgb::ZERO, size: 0.3, offset: Vec3::splat(0.1) };
    let grey = material(&mut scene, Material { diffuse: checker, ..ambient });
    let mirror = material(&mut scene, mirror());
    let clear = glass(&mut scene, 1.5, 0, Rgb::X);
    scene.environment = Environment::Gradient { nadir: Rgb::X, horizon: Rgb::Y, zenith: Rgb::Z };
    scene.ambient = Rgb::splat(0.2);
    plane(&mut scene, Vec3::Y * -1.0, Vec3::Y, grey);
    sphere(&mut scene, Vec3::new(-0.7, 0.0, 0.0), 0.6, mirror);
    sphere(&mut scene, Vec3::new(0.7, 0.0, 0.0), 0.6, clear);
    scene.lights.push(lamp(Vec3::new(1.0, 3.0, 2.0)));
    let whole = native(&scene, &Options::default());
    let on = EffectPlan::resolve(&scene, &effects::Options::default()).on();
    for effect in [
        Effect::Ambient,
        Effect::Emission,
        Effect::Diffuse,
        Effect::HardShadows,
        Effect::ShadowsThroughGlass,
        Effect::Mirror,
        Effect::Refraction,
        Effect::FresnelSplit,
        Effect::Absorption,
        Effect::Environment,
        Effect::Textures,
    ] {
        assert!(on.has(effect), "{effect}");
        let left = native(&scene, &by(Pipeline::Auto, EffectSet::EMPTY.with(effect), &Options::default()));
        assert_ne!(whole.film, left.film, "{effect}");
    }
}

fn fails(arguments: &str) -> String {
    let output = Command::cargo_bin("vitrum").expect("built").args(arguments.split(' ')).output().expect("runs");
    assert_eq!(output.status.code(), Some(2), "{arguments}");
    let text = String::from_utf8(output.stderr).expect("text");
    assert_eq!(text.trim_end().lines().count(), 1, "{text}");
    text
}

#[test]
fn slips_and_contradictions_on_the_command_line_get_one_line() {
    let unknown = fails("render scenes/glass.toml -o /tmp/none.png --effects refracton");
    assert!(unknown.contains("no effect is called `refracton`; did you mean `refraction`?"), "{unknown}");
    let both = fails("explain scenes/glass.toml --effects mirror --no-mirror");
    assert!(both.contains("--effects mirror and --no-mirror contradict each other"), "{both}");
    let bent = fails("render scenes/glass.toml -o /tmp/none.png --no-refraction --refraction bec");
    assert!(bent.contains("--refraction chooses how `refraction` is done, which is left out"), "{bent}");
}

#[test]
fn explain_tells_every_effect_within_eighty_columns_and_as_json() {
    let run = |arguments: &str| {
        let output = Command::cargo_bin("vitrum").expect("built").args(arguments.split(' ')).output().expect("runs");
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).expect("text")
    };
    let text = run("explain scenes/absorption.toml --measure --rounds 1 --width 24 -q");
    assert!(text.ends_with('\n') && text.lines().all(|line| line.chars().count() <= 80), "{text}");
    for effect in Effect::ALL {
        assert!(text.contains(effect.name()), "{effect}");
    }
    let json: serde_json::Value =
        serde_json::from_str(&run("explain scenes/absorption.toml --measure --rounds 1 --width 24 -q --json"))
            .expect("JSON");
    let rows = json["effects"].as_array().expect("rows");
    assert_eq!(rows.len(), Effect::ALL.len());
    for row in rows {
        assert_eq!(row["on"].as_bool(), Some(row.get("worth").is_some()), "{row}");
    }
    assert!(text.contains("shaded together: `slab 1`, `slab 2`"), "{text}");
    let shared = json["shared"].as_array().expect("groups");
    let objects: usize = shared.iter().map(|group| group["objects"].as_array().expect("names").len()).sum();
    let scene = small(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/absorption.toml"));
    assert_eq!(objects, scene.objects.len(), "{shared:?}");
    let (most, mean) = (json["rays"]["most_per_pixel"].as_f64(), json["rays"]["mean_per_pixel"].as_f64());
    assert!(mean.expect("measured") > 1.0 && mean < most, "{mean:?} {most:?}");
}
