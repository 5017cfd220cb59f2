//! The picture is right where the answer is known by hand, and the same however the work was divided.

use crate::support;

use glam::Vec3;
use support::scenes::{self, add, bare, cuboid, empty, glass, material, native, plane, sphere};
use vitrum::image::Film;
use vitrum::optics::{AtNormal, Boundary, Exact, FresnelFormula, FresnelModel, Schlick};
use vitrum::render::{Options, RayKind};
use vitrum::scene::{
    Camera, Colour, Environment, Falloff, FresnelRule, Highlight, HighlightModel, Interface, Light, LightKind,
    Material, MirrorSource, Projection, Rgb, Scene, ShadowRule,
};

fn centre(film: &Film) -> Vec3 {
    Vec3::from(film.at(film.width / 2, film.height / 2))
}

fn assert_close(got: Vec3, want: Vec3, tolerance: f32, what: &str) {
    assert!((got - want).abs().max_element() <= tolerance, "{what}: {got} is not {want}");
}

/// Looks along -z from (0, 0, 5) at an odd number of pixels, so that the middle one looks straight down the axis.
fn head_on(environment: f32) -> Scene {
    let mut scene = empty(environment);
    scene.camera.eye = Vec3::new(0.0, 0.0, 5.0);
    (scene.settings.width, scene.settings.height) = (33, 33);
    scene
}

/// Case AB-07 of the catalogue.
#[test]
fn lossless_glass_of_any_shape_in_a_constant_environment_is_invisible() {
    let mut scene = empty(1.0);
    let crown = glass(&mut scene, 1.5, 0, Rgb::ZERO);
    let water = glass(&mut scene, 1.33, -1, Rgb::ZERO);
    let diamond = glass(&mut scene, 2.417, 5, Rgb::ZERO);
    sphere(&mut scene, Vec3::new(-0.6, 0.0, 0.0), 0.7, crown);
    sphere(&mut scene, Vec3::new(0.2, 0.1, 0.2), 0.6, water);
    cuboid(&mut scene, Vec3::new(0.1, -0.9, -0.3), Vec3::new(0.9, -0.1, 0.5), diamond);
    scene.settings.cutoff = 1e-7;
    scene.settings.max_depth = 200;
    let outcome = native(&scene, &Options::default());
    for (seen, lost) in outcome.film.pixels.iter().zip(&outcome.truncated.pixels) {
        for c in 0..3 {
            assert!((seen[c] + lost[c] - 1.0).abs() <= 1e-5, "{} seen, {} lost", seen[c], lost[c]);
            assert!((seen[c] - 1.0).abs() <= 1e-5 + lost[c]);
        }
    }
}

/// Case AB-07 of the catalogue.
#[test]
fn what_a_small_depth_cuts_off_is_exactly_what_is_reported() {
    let mut scene = empty(1.0);
    let crown = glass(&mut scene, 1.5, 0, Rgb::ZERO);
    cuboid(&mut scene, Vec3::splat(-0.7), Vec3::splat(0.7), crown);
    for depth in [0, 1, 2, 3, 5, 8] {
        scene.settings.max_depth = depth;
        let outcome = native(&scene, &Options::default());
        let lost: f32 = outcome.truncated.pixels.iter().map(|p| p[0]).sum();
        assert!(lost > 0.0, "at depth {depth} something is lost");
        for (seen, lost) in outcome.film.pixels.iter().zip(&outcome.truncated.pixels) {
            assert!((seen[1] + lost[1] - 1.0).abs() <= 1e-5, "depth {depth}: {} + {}", seen[1], lost[1]);
        }
    }
}

/// Case AB-06 of the catalogue: nothing is ended at random, so the bias of a cut-off is what it took away, and that is
/// reported pixel by pixel.
#[test]
fn what_a_cut_off_takes_away_is_exactly_what_is_reported() {
    let mut scene = empty(1.0);
    let crown = glass(&mut scene, 1.5, 0, Rgb::ZERO);
    cuboid(&mut scene, Vec3::splat(-0.7), Vec3::splat(0.7), crown);
    scene.settings.max_depth = 200;
    let mut before = 0.0;
    for cutoff in [1e-4, 1e-2, 0.05, 0.5, 1.0] {
        scene.settings.cutoff = cutoff;
        let outcome = native(&scene, &Options::default());
        let lost: f32 = outcome.truncated.pixels.iter().map(|p| p[0]).sum();
        assert!(lost > 0.0 && lost >= before, "a cut-off of {cutoff} takes {lost}, a lower one {before}");
        before = lost;
        for (seen, lost) in outcome.film.pixels.iter().zip(&outcome.truncated.pixels) {
            assert!((seen[1] + lost[1] - 1.0).abs() <= 1e-5, "cut-off {cutoff}: {} + {}", seen[1], lost[1]);
        }
    }
}

/// Glass and water that share a face are met as one boundary, from glass to water, by both renderers and in any order.
#[test]
fn two_faces_in_one_place_are_one_boundary_to_both_renderers() {
    let reflectance = |n1: f64, n2: f64| {
        let boundary = Boundary::<f64>::new(n1, n2);
        Exact::dielectric(&boundary, &boundary.cross(1.0))
    };
    // Into the water, from it into the glass, and out of that: what depth 3 keeps.
    let [first, second, third] = [reflectance(1.0, 1.33), reflectance(1.33, 1.5), reflectance(1.5, 1.0)];
    let through = 1.0 - first;
    let want = (first + through * second * through + through * (1.0 - second) * (1.0 - third)) as f32;
    for glass_first in [true, false] {
        let mut scene = head_on(1.0);
        scene.camera.projection = Projection::Orthographic { height: 1.0 };
        scene.settings.max_depth = 3;
        let crown = glass(&mut scene, 1.5, 0, Rgb::ZERO);
        let water = glass(&mut scene, 1.33, 0, Rgb::ZERO);
        let (behind, before) = (Vec3::new(-3.0, -3.0, -1.0), Vec3::new(3.0, 3.0, 1.0));
        let boxes = [(behind, before.with_z(0.0), crown), (behind.with_z(0.0), before, water)];
        for &(lo, hi, material) in if glass_first { [&boxes[0], &boxes[1]] } else { [&boxes[1], &boxes[0]] } {
            cuboid(&mut scene, lo, hi, material);
        }
        let options = Options::default();
        let reference = vitrum::render::reference::render(&scene, &options, &vitrum::render::Observer::default());
        for outcome in [native(&scene, &options), reference.unwrap()] {
            for pixel in &outcome.film.pixels {
                assert!((pixel[1] - want).abs() <= 1e-5, "{} for {want}", pixel[1]);
            }
        }
    }
}

/// A scene with every kind of surface, light and shadow, so that whatever depends on grouping would show.
fn everything() -> Scene {
    let mut scene = empty(0.2);
    (scene.settings.width, scene.settings.height, scene.settings.samples) = (67, 45, 2);
    scene.settings.max_depth = 9;
    scene.settings.cutoff = 1e-3;
    scene.ambient = Rgb::splat(0.1);
    let checker = Colour::Checker {
        even: Rgb::new(0.9, 0.8, 0.7),
        odd: Rgb::new(0.1, 0.2, 0.3),
        size: 0.5,
        offset: Vec3::new(0.0, 0.25, 0.0),
    };
    let highlight = Highlight { colour: Rgb::splat(0.4), exponent: 30.0, model: HighlightModel::Phong };
    let floor = material(
        &mut scene,
        Material { diffuse: checker, ambient: Rgb::ONE, highlight: Some(highlight), ..Material::default() },
    );
    let kinds = [
        Interface::Mirror { reflectance: Rgb::splat(0.9), source: MirrorSource::Traced },
        Interface::Mirror { reflectance: Rgb::splat(0.8), source: MirrorSource::Environment },
        Interface::Conductor { eta: Rgb::new(0.2, 0.9, 1.1), k: Rgb::new(3.9, 2.4, 2.2) },
        Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fresnel, tint: Rgb::new(0.9, 1.0, 0.9) },
        Interface::Coated { ior: 1.6 },
        Interface::Alpha { opacity: 0.4, mask: None },
    ];
    plane(&mut scene, Vec3::new(0.0, -1.0, 0.0), Vec3::Y, floor);
    for (i, interface) in kinds.into_iter().enumerate() {
        let m = material(&mut scene, Material { interface, ..Material::default() });
        let at = Vec3::new(-1.25 + 0.5 * i as f32, -0.5, 0.3 * (i % 2) as f32);
        if i % 2 == 0 {
            sphere(&mut scene, at, 0.3, m);
        } else {
            cuboid(&mut scene, at - 0.25, at + 0.25, m);
        }
    }
    let red = glass(&mut scene, 1.5, 1, Rgb::new(0.1, 1.0, 1.5));
    let water = glass(&mut scene, 1.33, 0, Rgb::ZERO);
    sphere(&mut scene, Vec3::new(-0.5, 0.5, 0.5), 0.4, red);
    cuboid(&mut scene, Vec3::new(-0.4, 0.2, 0.2), Vec3::new(0.6, 0.9, 0.9), water);
    scene.lights = vec![
        Light {
            name: "lamp".into(),
            kind: LightKind::Point { position: Vec3::new(2.0, 4.0, 3.0) },
            intensity: Rgb::splat(20.0),
            falloff: Falloff::InverseSquare,
            shadows: true,
        },
        Light {
            name: "sun".into(),
            kind: LightKind::Directional { direction: Vec3::new(0.5, -1.0, -0.3).normalize() },
            intensity: Rgb::splat(0.5),
            falloff: Falloff::None,
            shadows: true,
        },
    ];
    scene
}

/// Case AC-03 of the catalogue.
#[test]
fn neither_threads_nor_tiles_change_a_byte() {
    let scene = everything();
    let reference = native(&scene, &Options { threads: 1, tile: 32, ..Options::default() });
    for (threads, tile) in [(1, 1), (2, 32), (3, 8), (8, 13), (2, 100), (3, 7)] {
        let other = native(&scene, &Options { threads, tile, ..Options::default() });
        assert_eq!(reference.film, other.film, "{threads} threads, tiles of {tile}");
        assert_eq!(reference.truncated, other.truncated);
        assert_eq!(reference.rays, other.rays);
        assert_eq!(reference.unmatched_exits, other.unmatched_exits);
    }
}

/// Case LN-12 of the catalogue.
#[test]
fn rays_are_counted_by_what_they_were_sent_for() {
    let mut scene = head_on(1.0);
    let mirror = bare(Interface::Mirror { reflectance: Rgb::ONE, source: MirrorSource::Traced });
    let mirror = material(&mut scene, mirror);
    plane(&mut scene, Vec3::ZERO, Vec3::Z, mirror);
    let outcome = native(&scene, &Options::default());
    assert_eq!(outcome.rays.of(RayKind::Camera), 33 * 33);
    assert_eq!(outcome.rays.of(RayKind::Reflected), 33 * 33);
    assert_eq!(outcome.rays.total(), 2 * 33 * 33);
    assert_eq!(outcome.rays.by_depth[1][RayKind::Reflected as usize], 33 * 33);
}

#[test]
fn a_glass_face_head_on_reflects_four_percent() {
    let mut scene = head_on(0.0);
    let crown = glass(&mut scene, 1.5, 0, Rgb::ZERO);
    // The reflected ray sees the sky above the eye's side; what enters is swallowed by a black absorber behind.
    plane(&mut scene, Vec3::ZERO, Vec3::Z, crown);
    scene.environment = Environment::Constant(Rgb::ONE);
    let black = material(&mut scene, bare(Interface::Opaque));
    plane(&mut scene, Vec3::new(0.0, 0.0, -1.0), Vec3::Z, black);
    for (fresnel, oblique) in [
        (FresnelModel::Exact, Exact::dielectric as fn(&Boundary<f64>, &_) -> f64),
        (FresnelModel::Schlick, Schlick::dielectric),
        (FresnelModel::Off, AtNormal::dielectric),
    ] {
        let outcome = native(&scene, &Options { fresnel, ..Options::default() });
        assert_close(centre(&outcome.film), Vec3::splat(0.04), 1e-6, "head on");
        // A corner pixel's angle, by the camera's own geometry.
        let half = (15.0_f64).to_radians().tan() * (16.0 / 16.5);
        let cos_i = 1.0 / (1.0 + 2.0 * half * half).sqrt();
        let boundary = Boundary::new(1.0, 1.5);
        let want = oblique(&boundary, &boundary.cross(cos_i)) as f32;
        assert_close(Vec3::from(outcome.film.at(0, 0)), Vec3::splat(want), 2e-6, "in the corner");
    }
}

#[test]
fn a_coloured_slab_weakens_by_beer_and_lambert() {
    let mut scene = head_on(1.0);
    let absorption = Rgb::new(0.0, 0.5, 2.0);
    let tinted = glass(&mut scene, 1.5, 0, absorption);
    cuboid(&mut scene, Vec3::new(-9.0, -9.0, -0.75), Vec3::new(9.0, 9.0, 0.75), tinted);
    let outcome = native(&scene, &Options::default());
    let through = (-absorption * 1.5).exp();
    // The series of inner reflections, with R = 0.04 at each face.
    let (r, t) = (0.04_f32, 0.96_f32);
    let want = Rgb::splat(r) + t * t * through * (1.0 + r * through) / (1.0 - r * r * through * through);
    assert_close(centre(&outcome.film), want, 3e-6, "reflected plus transmitted series");
}

/// Case AB-08 of the catalogue.
#[test]
fn ice_in_water_in_a_glass_reflects_at_the_boundaries_that_are_there() {
    // Slabs that overlap: glass 0.5..1 and water 0..0.6 (overlapping the glass), ice -0.5..0.2 (overlapping water).
    let mut scene = head_on(1.0);
    let crown = glass(&mut scene, 1.5, 10, Rgb::ZERO);
    let water = glass(&mut scene, 1.33, 1, Rgb::ZERO);
    let ice = glass(&mut scene, 1.31, 5, Rgb::new(0.7, 0.7, 0.7));
    let slab = |scene: &mut Scene, lo: f32, hi: f32, m| {
        cuboid(scene, Vec3::new(-50.0, -50.0, lo), Vec3::new(50.0, 50.0, hi), m);
    };
    slab(&mut scene, 0.5, 1.0, crown);
    slab(&mut scene, 0.0, 0.6, water);
    slab(&mut scene, -0.5, 0.2, ice);
    // Only the first passage: what enters the ice is absorbed to nothing after reflection, so compare one path.
    scene.settings.max_depth = 4;
    let outcome = native(&scene, &Options::default());
    let r = |a: f32, b: f32| ((a - b) / (a + b)).powi(2);
    let boundaries = [r(1.0, 1.5), r(1.5, 1.33), r(1.33, 1.31), r(1.31, 1.0)];
    let straight: f32 = boundaries.iter().map(|r| 1.0 - r).product::<f32>() * (-0.7_f32 * 0.7).exp();
    // Up to depth 4 the straight path (four refractions) and single reflections escape; sum them exactly.
    let absorbed_twice = (-0.7_f32 * 1.4).exp();
    let mut want = straight + boundaries[0];
    let mut through = (1.0 - boundaries[0]).powi(2);
    want += through * boundaries[1];
    // One more refraction each way is five events: cut off at depth 4.
    through *= (1.0 - boundaries[1]).powi(2);
    let _beyond = through * boundaries[2] * absorbed_twice;
    assert_close(centre(&outcome.film), Vec3::splat(want), 2e-6, "boundaries by priority");
    assert_eq!(outcome.unmatched_exits, 0);
}

#[test]
fn a_lamp_on_a_wall_gives_the_lambert_value_in_both_conventions() {
    let mut scene = head_on(0.0);
    let albedo = Rgb::new(0.8, 0.5, 0.2);
    let wall = material(&mut scene, Material { diffuse: Colour::Constant(albedo), ..Material::default() });
    plane(&mut scene, Vec3::ZERO, Vec3::Z, wall);
    let position = Vec3::new(0.0, 3.0, 4.0);
    let mut lamp = Light {
        name: "lamp".into(),
        kind: LightKind::Point { position },
        intensity: Rgb::splat(7.0),
        falloff: Falloff::InverseSquare,
        shadows: true,
    };
    scene.lights = vec![lamp.clone()];
    let cos = 4.0 / 5.0;
    let physical = albedo * std::f32::consts::FRAC_1_PI * 7.0 * cos / 25.0;
    assert_close(centre(&native(&scene, &Options::default()).film), physical, 1e-6, "inverse square");
    lamp.falloff = Falloff::None;
    scene.lights = vec![lamp.clone()];
    assert_close(centre(&native(&scene, &Options::default()).film), albedo * 7.0 * cos, 1e-6, "classic");
    // Something in the way.
    let blocker = material(&mut scene, Material::default());
    sphere(&mut scene, position * 0.5, 0.5, blocker);
    assert_eq!(centre(&native(&scene, &Options::default()).film), Vec3::ZERO);
}

/// Case CL-06 of the catalogue.
#[test]
fn light_through_a_pane_of_glass_is_weakened_and_not_bent() {
    let mut scene = head_on(0.0);
    let wall = material(&mut scene, Material { diffuse: Colour::Constant(Rgb::ONE), ..Material::default() });
    plane(&mut scene, Vec3::ZERO, Vec3::Z, wall);
    let absorption = Rgb::new(0.0, 0.3, 3.0);
    let pane = glass(&mut scene, 1.5, 0, absorption);
    // Out of the camera's way, between lamp and wall.
    cuboid(&mut scene, Vec3::new(-3.0, 0.6, 0.5), Vec3::new(3.0, 3.0, 1.25), pane);
    let position = Vec3::new(0.0, 4.0, 4.0);
    scene.lights = vec![Light {
        name: "lamp".into(),
        kind: LightKind::Point { position },
        intensity: Rgb::ONE,
        falloff: Falloff::None,
        shadows: true,
    }];
    let cos = 0.5_f64.sqrt();
    let boundary = Boundary::<f64>::new(1.0, 1.5);
    // The straight ray meets the top (y = 0.6 at z = 0.6) and the front (z = 1.25) of the pane, both at 45 degrees.
    let enter = 1.0 - Exact::dielectric(&boundary, &boundary.cross(cos));
    let length = (1.25 - 0.6) * 2.0_f32.sqrt();
    let want = Vec3::splat((enter * enter) as f32) * (-absorption * length).exp() * cos as f32;
    assert_close(centre(&native(&scene, &Options::default()).film), want, 2e-6, "straight");
    scene.settings.shadows = ShadowRule::Opaque;
    assert_eq!(centre(&native(&scene, &Options::default()).film), Vec3::ZERO, "opaque");
}

/// Case AB-04 of the catalogue.
#[test]
fn facing_mirrors_give_the_geometric_series_to_any_depth() {
    // A mirror of reflectance 0.9 opposite a wall that emits 1: after n bounces 0.9^n arrives, and nothing is lost but
    // what the depth cuts off.
    let mut scene = head_on(0.0);
    let mirror = |emission: f32| Material {
        emission: Rgb::splat(emission),
        ..bare(Interface::Mirror { reflectance: Rgb::splat(0.9), source: MirrorSource::Traced })
    };
    let shining = material(&mut scene, mirror(0.1));
    let dark = material(&mut scene, mirror(0.0));
    plane(&mut scene, Vec3::new(0.0, 0.0, -1.0), Vec3::Z, shining);
    plane(&mut scene, Vec3::new(0.0, 0.0, 6.0), Vec3::NEG_Z, dark);
    scene.settings.max_depth = 64;
    let outcome = native(&scene, &Options::default());
    // Hits at even bounces meet the shining one, from bounce 0 to 64.
    let want: f64 = (0..=32).map(|i| 0.1 * 0.9_f64.powi(2 * i)).sum();
    assert_close(centre(&outcome.film), Vec3::splat(want as f32), 1e-6, "series");
    assert_close(centre(&outcome.truncated), Vec3::splat(0.9_f32.powi(65)), 1e-7, "the rest is truncated");
}

/// Cases FR-13, AB-09 of the catalogue.
#[test]
fn under_water_the_sky_fills_snells_window_and_the_rest_is_total_reflection() {
    let mut scene = empty(0.0);
    (scene.settings.width, scene.settings.height) = (101, 101);
    scene.environment = Environment::Constant(Rgb::ONE);
    let water = glass(&mut scene, 1.333, 0, Rgb::ZERO);
    plane(&mut scene, Vec3::ZERO, Vec3::Y, water);
    let black = material(&mut scene, bare(Interface::Opaque));
    plane(&mut scene, Vec3::new(0.0, -9.0, 0.0), Vec3::Y, black);
    scene.camera = Camera {
        eye: Vec3::new(0.0, -1.0, 0.0),
        target: Vec3::ZERO,
        up: Vec3::Z,
        projection: Projection::Pinhole { vfov: 120.0 },
        medium: None,
    };
    let outcome = native(&scene, &Options::default());
    let critical = (1.0_f64 / 1.333).asin();
    for x in 0..101_u32 {
        let offset = (f64::from(x) + 0.5 - 50.5) / 50.5 * 60.0_f64.to_radians().tan();
        let angle = offset.abs().atan();
        let seen = outcome.film.at(x, 50)[0];
        if angle > critical + 1e-3 {
            assert_eq!(seen, 0.0, "outside the window the black floor is mirrored");
        } else if angle < critical - 0.02 {
            let boundary = Boundary::<f64>::new(1.333, 1.0);
            let want = 1.0 - Exact::dielectric(&boundary, &boundary.cross(angle.cos()));
            assert!((f64::from(seen) - want).abs() < 1e-5, "{seen} is not {want}");
        }
    }
    assert_eq!(outcome.unmatched_exits, 0, "the eye is found to be in the water");
}

/// Case RF-07 of the catalogue.
#[test]
fn matched_indices_are_invisible_to_the_bit() {
    let mut scene = empty(0.0);
    scene.environment =
        Environment::Gradient { nadir: Rgb::X, horizon: Rgb::new(0.2, 0.9, 0.4), zenith: Rgb::new(0.3, 0.1, 1.0) };
    let bare_film = native(&scene, &Options::default()).film;
    let same = glass(&mut scene, 1.0, 0, Rgb::ZERO);
    sphere(&mut scene, Vec3::ZERO, 0.9, same);
    cuboid(&mut scene, Vec3::splat(-0.5), Vec3::splat(1.3), same);
    for fresnel in [FresnelModel::Exact, FresnelModel::Off] {
        assert_eq!(native(&scene, &Options { fresnel, ..Options::default() }).film, bare_film);
    }
}

#[test]
fn coats_panes_and_holes_divide_light_as_the_table_says() {
    let mut scene = head_on(1.0);
    let lit = Material { emission: Rgb::splat(0.5), ..bare(Interface::Opaque) };
    let cases = [
        (Interface::Coated { ior: 1.5 }, 0.04 + 0.96 * 0.5),
        (Interface::Alpha { opacity: 0.25, mask: None }, 0.25 * 0.5 + 0.75),
        (
            Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fresnel, tint: Rgb::splat(0.5) },
            0.5 + 0.08 / 1.04 + (1.0 - 0.08 / 1.04) * 0.5,
        ),
        (
            Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fixed(Rgb::splat(0.3)), tint: Rgb::ONE },
            0.5 + 0.3 + 0.7,
        ),
        (Interface::Mirror { reflectance: Rgb::splat(0.7), source: MirrorSource::Environment }, 0.5 + 0.7),
    ];
    for (interface, want) in cases {
        scene.geometry.clear();
        scene.objects.clear();
        let m = material(&mut scene, Material { interface, ..lit.clone() });
        plane(&mut scene, Vec3::ZERO, Vec3::Z, m);
        assert_close(centre(&native(&scene, &Options::default()).film), Vec3::splat(want), 1e-6, "share");
    }
}

/// Case RV-04 of the catalogue.
#[test]
fn smooth_normals_never_send_light_through_the_surface() {
    // A flat sheet with wildly tilted normals over a black hall: a reflected ray that dived below would see the
    // bright ground under the sheet.
    let mut scene = empty(0.0);
    scene.camera.eye = Vec3::new(0.0, 0.4, 5.0);
    let mirror = material(&mut scene, bare(Interface::Mirror { reflectance: Rgb::ONE, source: MirrorSource::Traced }));
    let mut sheet = scenes::cuboid_mesh(Vec3::new(-2.0, -1.0, -2.0), Vec3::new(2.0, 0.0, 2.0));
    sheet.normals = (0..8)
        .map(|i| Vec3::new(if i & 1 == 0 { -2.0 } else { 2.0 }, 1.0, if i & 4 == 0 { -3.0 } else { 3.0 }).normalize())
        .collect();
    sheet.normal_indices = sheet.triangles.clone();
    add(&mut scene, vitrum::geometry::Shape::Mesh(sheet), mirror);
    let ground = material(&mut scene, Material { emission: Rgb::splat(100.0), ..bare(Interface::Opaque) });
    plane(&mut scene, Vec3::new(0.0, -0.5, 0.0), Vec3::Y, ground);
    let outcome = native(&scene, &Options::default());
    // Looking from above, the ground inside the sheet can be seen by no ray; the ground around it can.
    let (w, h) = (outcome.film.width, outcome.film.height);
    assert!(outcome.film.at(w / 2, h / 2)[0] < 50.0, "{:?}", outcome.film.at(w / 2, h / 2));
}

/// Case CL-07 of the catalogue.
#[test]
fn an_empty_scene_is_its_environment_and_no_light_is_no_error() {
    let scene = empty(0.25);
    let outcome = native(&scene, &Options::default());
    assert!(outcome.film.pixels.iter().all(|p| *p == [0.25; 3]));
    assert_eq!(outcome.rays.total(), 32 * 32);
    assert_eq!(outcome.non_finite, 0);
}
