//! Objects that are proven out of reach are never hit.

use glam::Vec3;
use vitrum::effects::{self, Effect, EffectPlan, EffectSet};
use vitrum::geometry::{Shape, Sphere, TriMesh};
use vitrum::render::{Options, Outcome, Stage};
use vitrum::scene::{Colour, FresnelRule, Interface, LightKind, Material, Projection, Rgb, Scene, Settings};

use super::{auto_and_all, grey, lamp, mirror, same};
use crate::support::Rng;
use crate::support::scenes::{add, bare, cuboid, cuboid_mesh, empty, glass, material, plane, sphere};

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
    let mesh = |scene: &mut Scene, change: &dyn Fn(&mut TriMesh)| match &mut scene.geometry[0].shape {
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
    assert!(
        !sealed(&|s| s.materials[0].interface = Interface::Alpha { opacity: 0.99, mask: None }),
        "a cover with holes"
    );
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
