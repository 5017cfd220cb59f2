//! Long chains: light that stays inside for a long time, and many surfaces one behind another.

use glam::Vec3;
use vitrum::optics::FresnelModel;
use vitrum::render::{Options, Outcome};
use vitrum::scene::{FresnelRule, Interface, Rgb, Scene};

use crate::support::scenes;

/// Checks that arriving light and truncated weight sum to 1 in a room of radiance 1.
fn assert_whole(outcome: &Outcome, what: &str) {
    assert_eq!((outcome.non_finite, outcome.clamped), (0, 0), "{what}");
    for (seen, lost) in outcome.film.pixels.iter().zip(&outcome.truncated.pixels) {
        for k in 0..3 {
            assert!((seen[k] + lost[k] - 1.0).abs() <= 1e-5, "{what}: {} seen, {} cut", seen[k], lost[k]);
        }
    }
}

fn small(edge: u32) -> Scene {
    let mut scene = scenes::empty(1.0);
    (scene.settings.width, scene.settings.height) = (edge, edge);
    scene
}

/// AB-04, AB-12: an eye inside a cube of glass, where most light is reflected totally for ever: every depth from 0 to 64
/// ends, and what it cuts is reported.
#[test]
fn light_caught_in_a_cube_of_glass_is_cut_at_the_depth_asked_for_and_reported() {
    let mut scene = small(16);
    let crown = scenes::glass(&mut scene, 1.5, 0, Rgb::ZERO);
    scenes::cuboid(&mut scene, Vec3::splat(-1.0), Vec3::splat(1.0), crown);
    scene.camera.eye = Vec3::new(0.1, 0.2, 0.05);
    scene.camera.target = Vec3::new(1.0, 0.9, 0.8);
    let mut last = f32::INFINITY;
    for depth in [0, 1, 2, 3, 5, 8, 13, 21, 34, 64] {
        // 2^64 rays are not the point: reflections below a thousandth are cut, too.
        (scene.settings.max_depth, scene.settings.cutoff) = (depth, 1e-3);
        let outcome = scenes::native(&scene, &Options::default());
        assert_whole(&outcome, &format!("depth {depth}"));
        assert!(outcome.rays.by_depth.len() <= depth as usize + 1);
        assert_eq!(outcome.unmatched_exits, 0, "depth {depth}");
        let lost: f32 = outcome.truncated.pixels.iter().map(|p| p[0]).sum();
        assert!(lost > 0.0 && lost <= last * 1.000_01, "depth {depth}: {lost} after {last}");
        last = lost;
    }
}

/// AB-05: each surface makes two rays of one, 2^depth in all without a cut-off. With a cut-off of c at most 2 / c rays
/// per pixel are alive at any depth, since their weights add up to at most 1.
#[test]
fn the_number_of_rays_is_bounded_by_the_cutoff_and_not_by_two_to_the_depth() {
    let mut scene = small(8);
    let crown = scenes::glass(&mut scene, 2.4, 0, Rgb::ZERO);
    scenes::cuboid(&mut scene, Vec3::splat(-0.9), Vec3::splat(0.9), crown);
    scene.settings.max_depth = 200;
    for cutoff in [0.1, 0.01, 0.001] {
        scene.settings.cutoff = cutoff;
        let outcome = scenes::native(&scene, &Options::default());
        for (depth, row) in outcome.rays.by_depth.iter().enumerate() {
            let alive: u64 = row.iter().sum();
            assert!((alive as f32) <= 64.0 * 2.0 / cutoff, "{alive} rays at depth {depth}, cut-off {cutoff}");
        }
        assert_whole(&outcome, &format!("cut-off {cutoff}"));
    }
}

/// AB-08: a hundred nested shells, each of another index. Every boundary is the right one (a straight ray through the
/// middle is weakened by their product), there is no unmatched exit, and no light is lost.
#[test]
fn a_hundred_nested_shells_weaken_light_by_the_product_of_their_boundaries() {
    let mut scene = small(9);
    scene.camera.eye = Vec3::new(0.0, 0.0, 5.0);
    let ior = |k: usize| if k == 0 { 1.0 } else { 1.2 + 0.3 * ((k * 37) % 100) as f64 / 100.0 };
    for k in 1..=100 {
        let material = scenes::glass(&mut scene, ior(k), k as i32, Rgb::ZERO);
        scenes::sphere(&mut scene, Vec3::ZERO, 1.0 - 0.009 * k as f32, material);
    }
    // Only what goes straight through survives this cut-off: no reflection is above 5 %.
    (scene.settings.max_depth, scene.settings.cutoff) = (256, 0.055);
    let outcome = scenes::native(&scene, &Options::default());
    assert_whole(&outcome, "shells");
    assert_eq!(outcome.unmatched_exits, 0);
    let through = |k: usize| 1.0 - ((ior(k - 1) - ior(k)) / (ior(k - 1) + ior(k))).powi(2);
    let want: f64 = (1..=100).map(through).product::<f64>().powi(2);
    let middle = outcome.film.at(4, 4)[0];
    assert!((f64::from(middle) - want).abs() < 2e-5, "{middle} for {want}");
    assert_eq!(outcome.rays.by_depth.len(), 201);
    // The same with everything cut early.
    for depth in [0, 1, 50, 101] {
        scene.settings.max_depth = depth;
        assert_whole(&scenes::native(&scene, &Options::default()), &format!("depth {depth}"));
    }
}

/// SI-07: glass and water with a gap of 16 ulp between them, and one of 1e-3: no NaN, nothing lost, wherever the offsets
/// put the ray.
#[test]
fn a_gap_of_a_few_ulps_between_glass_and_water_loses_nothing() {
    for place in [0.0_f32, 1.0, 1000.0] {
        let face = place + 1.0;
        for gap in [16.0 * vitrum::math::ulp(face), 1e-3, 0.0] {
            let mut scene = small(16);
            scene.camera.eye = Vec3::new(0.7, 0.4, place + 8.0);
            scene.camera.target = Vec3::new(0.0, 0.0, place);
            let crown = scenes::glass(&mut scene, 1.5, 0, Rgb::ZERO);
            let water = scenes::glass(&mut scene, 1.33, 0, Rgb::ZERO);
            scenes::cuboid(&mut scene, Vec3::new(-9.0, -9.0, place), Vec3::new(9.0, 9.0, face), water);
            scenes::cuboid(&mut scene, Vec3::new(-9.0, -9.0, face + gap), Vec3::new(9.0, 9.0, place + 2.0), crown);
            (scene.settings.max_depth, scene.settings.cutoff) = (24, 1e-5);
            for fresnel in [FresnelModel::Exact, FresnelModel::Schlick] {
                let outcome = scenes::native(&scene, &Options { fresnel, ..Options::default() });
                assert_whole(&outcome, &format!("gap {gap} at {place}"));
            }
        }
    }
}

/// LuxCore #124: more than 16 stacked sheets darkened what lies behind. Holes and clear panes cost what the table says and
/// no more, 8 or 40 of them; those that are cut are reported.
#[test]
fn stacked_sheets_are_as_clear_as_their_product() {
    let alpha = Interface::Alpha { opacity: 0.0, mask: None };
    let pane = Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fixed(Rgb::ZERO), tint: Rgb::splat(0.875) };
    for (interface, each) in [(alpha, 1.0_f64), (pane, 0.875)] {
        for sheets in [8, 15, 16, 17, 26, 40] {
            let mut scene = small(5);
            scene.camera.eye = Vec3::new(0.0, 0.0, 5.0);
            scene.settings.max_depth = sheets;
            let material = scenes::material(&mut scene, scenes::bare(interface));
            for k in 0..sheets {
                let z = -0.1 * k as f32;
                scenes::cuboid(&mut scene, Vec3::new(-9.0, -9.0, z), Vec3::new(9.0, 9.0, z), material);
            }
            // A flat box is a two-sided sheet: its two faces in one place are one.
            let outcome = scenes::native(&scene, &Options::default());
            let want = each.powi(sheets as i32);
            for p in &outcome.film.pixels {
                assert!((f64::from(p[0]) - want).abs() < 1e-5, "{sheets} sheets: {} for {want}", p[0]);
            }
            scene.settings.max_depth = sheets / 2;
            let cut = scenes::native(&scene, &Options::default());
            let want = each.powi((sheets / 2 + 1) as i32);
            for (seen, lost) in cut.film.pixels.iter().zip(&cut.truncated.pixels) {
                let (seen, lost) = (f64::from(seen[0]), f64::from(lost[0]));
                assert!(seen == 0.0 && (lost - want).abs() < 1e-5, "{sheets} sheets: {seen} and {lost}");
            }
        }
    }
}

/// AB-11: the shadow march over transparent surfaces is left out where a scene has none. Forced on by a pane that nobody
/// can see, it changes no bit of the picture; nor do materials and media that nothing is made of.
#[test]
fn what_a_scene_does_not_call_for_changes_no_bit_when_forced_on() {
    use vitrum::scene::{Falloff, Light, LightKind, Material};
    let mut scene = small(48);
    let floor = scenes::material(&mut scene, Material::default());
    scenes::plane(&mut scene, Vec3::new(0.0, -1.0, 0.0), Vec3::Y, floor);
    scenes::sphere(&mut scene, Vec3::new(0.2, 0.0, 0.3), 0.7, floor);
    scenes::cuboid(&mut scene, Vec3::new(-1.4, -1.0, -0.6), Vec3::new(-0.6, 0.4, 0.2), floor);
    scene.lights.push(Light {
        name: "lamp".into(),
        kind: LightKind::Point { position: Vec3::new(2.0, 4.0, 3.0) },
        intensity: Rgb::splat(20.0),
        falloff: Falloff::InverseSquare,
        shadows: true,
    });
    let plain = scenes::native(&scene, &Options::default());
    let glass = scenes::glass(&mut scene, 1.5, 0, Rgb::ONE);
    let unused = scenes::native(&scene, &Options::default());
    assert!(plain.film == unused.film);
    scenes::sphere(&mut scene, Vec3::new(0.0, -50.0, 900.0), 0.1, glass);
    let marched = scenes::native(&scene, &Options::default());
    assert!(plain.film == marched.film && plain.rays == marched.rays);
}
