//! Soft shadows in the eight-wide renderer: against the one in `f64`, against a shadow ray for every point of a lamp, and
//! the same to the bit however the work is divided.

use crate::support;

use glam::{DVec3, Vec3};
use support::scenes::{add, bare, cuboid, empty, glass, material, native, plane, sphere};
use vitrum::image::Film;
use vitrum::render::reference::{self, Prepared};
use vitrum::render::{Observer, Options, RayKind};
use vitrum::scene::{
    Colour, Falloff, Highlight, HighlightModel, Interface, LampSampling, Light, LightKind, Material, MirrorSource,
    Pattern, Rgb, Scene, ShadowRule, Spread,
};

fn lamp(kind: LightKind, falloff: Falloff) -> Light {
    let intensity = if falloff == Falloff::None { Rgb::new(0.7, 0.6, 0.5) } else { Rgb::new(20.0, 17.0, 14.0) };
    Light { name: "lamp".into(), kind, intensity, falloff, shadows: true }
}

fn ball() -> LightKind {
    LightKind::Sphere { position: Vec3::new(-1.4, 3.1, 1.7), radius: 0.5 }
}

fn sheet(spread: Spread) -> LightKind {
    // Downwards.
    let edges = [Vec3::new(1.0, -0.4, 0.0), Vec3::new(0.1, 0.2, 1.1)];
    LightKind::Rectangle { corner: Vec3::new(0.6, 2.9, 0.3), edges, spread }
}

/// A floor with a box, a shiny ball, a mirror and a thin post on it, seen from above.
fn still_life(lights: Vec<Light>, sampling: LampSampling) -> Scene {
    let mut scene = empty(0.05);
    (scene.settings.width, scene.settings.height) = (60, 45);
    scene.settings.max_depth = 4;
    scene.settings.lamps = sampling;
    scene.camera.eye = Vec3::new(0.4, 3.0, 5.0);
    scene.camera.target = Vec3::new(0.0, 0.4, 0.0);
    let matt = |colour| Material { diffuse: Colour::Constant(colour), ..Material::default() };
    let floor = material(&mut scene, matt(Rgb::new(0.8, 0.7, 0.6)));
    plane(&mut scene, Vec3::ZERO, Vec3::Y, floor);
    let shiny = Highlight { colour: Rgb::splat(0.4), exponent: 20.0, model: HighlightModel::Phong };
    let red = material(&mut scene, Material { highlight: Some(shiny), ..matt(Rgb::new(0.8, 0.2, 0.1)) });
    sphere(&mut scene, Vec3::new(0.5, 0.4, 0.4), 0.4, red);
    let grey = material(&mut scene, matt(Rgb::splat(0.5)));
    cuboid(&mut scene, Vec3::new(-1.0, 0.0, -0.6), Vec3::new(-0.5, 0.7, -0.1), grey);
    cuboid(&mut scene, Vec3::new(-0.2, 0.0, -0.32), Vec3::new(-0.14, 1.3, -0.26), grey);
    let mirror =
        material(&mut scene, bare(Interface::Mirror { reflectance: Rgb::splat(0.8), source: MirrorSource::Traced }));
    cuboid(&mut scene, Vec3::new(0.8, 0.0, -0.9), Vec3::new(1.5, 0.8, -0.8), mirror);
    scene.lights = lights;
    scene
}

fn full(count: u32, pattern: Pattern) -> LampSampling {
    LampSampling { count, pattern, seed: 3, probe: false }
}

fn differ(a: &Film, b: &Film, by: f64) -> Vec<(u32, u32)> {
    let far = |x, y| {
        let [a, b] = [a.at(x, y), b.at(x, y)].map(|p| DVec3::from(p.map(f64::from)));
        (a - b).abs().max_element() > by
    };
    (0..a.height).flat_map(|y| (0..a.width).map(move |x| (x, y))).filter(|&(x, y)| far(x, y)).collect()
}

/// Both renderers' pictures agree but for pixels whose value moves when the camera ray does by what rounding moves it.
#[track_caller]
fn renderers_agree(what: &str, scene: &Scene) {
    let options = Options::default();
    let ours = native(scene, &options);
    let theirs = reference::render(scene, &options, &Observer::default()).expect("nobody interrupts a test");
    assert_eq!(ours.rays.of(RayKind::Camera), theirs.rays.of(RayKind::Camera));
    assert!(theirs.rays.of(RayKind::Shadow) > 1000, "{what} lights next to nothing");
    let prepared = Prepared::new(scene, options.fresnel);
    let mut beyond = differ(&ours.film, &theirs.film, 2e-4);
    let count = beyond.len();
    assert!(count * 50 <= ours.film.pixels.len(), "{what}: {count} pixels differ");
    beyond.retain(|&(x, y)| prepared.ulps_until_moved(f64::from(x) + 0.5, f64::from(y) + 0.5, 2e-4, 64.0).is_none());
    println!("{what}: {count} pixels differ, {} of them well-conditioned", beyond.len());
    // A shadow ray that grazes an edge in one renderer and misses it in the other is one of many of its pixel.
    assert!(beyond.len() * 500 <= ours.film.pixels.len(), "{what}: {beyond:?}");
    let largest = |film: &Film| film.pixels.iter().flatten().fold(0.0_f32, |m, &v| m.max(v));
    assert!((largest(&ours.film) - largest(&theirs.film)).abs() < 1e-3);
}

#[test]
fn both_renderers_see_the_same_half_shadows_point_by_point() {
    for (what, kind, falloff) in [
        ("a ball", ball(), Falloff::InverseSquare),
        ("a ball without falloff", ball(), Falloff::None),
        ("a panel", sheet(Spread::Cosine), Falloff::InverseSquare),
        ("an even panel without falloff", sheet(Spread::Even), Falloff::None),
    ] {
        for sampling in [full(8, Pattern::Sobol), full(9, Pattern::Grid)] {
            renderers_agree(what, &still_life(vec![lamp(kind, falloff)], sampling));
        }
    }
}

#[test]
fn both_renderers_agree_on_several_lamps_with_several_rays_a_pixel_and_through_glass() {
    let lights = vec![
        lamp(ball(), Falloff::InverseSquare),
        lamp(LightKind::Point { position: Vec3::new(2.0, 4.0, 2.0) }, Falloff::InverseSquare),
        lamp(sheet(Spread::Cosine), Falloff::InverseSquare),
    ];
    for shadows in [ShadowRule::Straight, ShadowRule::Opaque] {
        let mut scene = still_life(lights.clone(), full(4, Pattern::Sobol));
        scene.settings.samples = 2;
        (scene.settings.width, scene.settings.height) = (40, 30);
        scene.settings.shadows = shadows;
        let glass = glass(&mut scene, 1.5, 0, Rgb::new(0.8, 0.2, 0.4));
        sphere(&mut scene, Vec3::new(-0.5, 0.45, 0.9), 0.4, glass);
        renderers_agree("three lights", &scene);
    }
}

/// The pictures with and without shafts, of which the first has fewer shadow rays by `spared` at least.
#[track_caller]
fn shafts_change_nothing(what: &str, scene: &Scene, spared: f64) {
    let with = |probe| {
        let mut scene = scene.clone();
        scene.settings.lamps.probe = probe;
        native(&scene, &Options::default())
    };
    let [all, few] = [with(false), with(true)];
    let [rays, fewer] = [&all, &few].map(|outcome| outcome.rays.of(RayKind::Shadow) as f64);
    let differ = differ(&all.film, &few.film, 0.0);
    println!("{what}: {fewer} shadow rays for {rays}; {} pixels differ", differ.len());
    assert!(rays > 1000.0 && fewer <= (1.0 - spared) * rays, "{what}: {fewer} for {rays}");
    assert!(differ.is_empty(), "{what}: {differ:?}");
}

#[test]
fn a_picture_by_shafts_is_that_of_all_shadow_rays_and_spares_most() {
    for (what, kind) in [("a ball", ball()), ("a panel", sheet(Spread::Cosine)), ("an even panel", sheet(Spread::Even))]
    {
        shafts_change_nothing(
            what,
            &still_life(vec![lamp(kind, Falloff::InverseSquare)], full(64, Pattern::Sobol)),
            0.5,
        );
    }
}

/// Wires, grains and slits that a few probes would miss, far smaller than the lamp as the floor sees it.
#[test]
fn what_is_far_smaller_than_the_lamp_is_not_missed() {
    for kind in [ball(), sheet(Spread::Cosine)] {
        let mut scene = still_life(vec![lamp(kind, Falloff::InverseSquare)], full(32, Pattern::Sobol));
        let black = material(&mut scene, Material::black("small"));
        for k in 0..5 {
            let x = -1.0 + 0.4 * k as f32;
            sphere(&mut scene, Vec3::new(x, 0.9, 0.7), 0.004, black);
            cuboid(&mut scene, Vec3::new(x, 1.2, -2.0), Vec3::new(x + 0.003, 1.203, 2.0), black);
        }
        // Two boards with a slit between them.
        cuboid(&mut scene, Vec3::new(-2.0, 1.5, -0.5), Vec3::new(-0.3, 1.52, 0.5), black);
        cuboid(&mut scene, Vec3::new(-0.296, 1.5, -0.5), Vec3::new(1.0, 1.52, 0.5), black);
        shafts_change_nothing("small things", &scene, 0.05);
    }
}

/// A sheet with one edge through the middle of the scene, which reaches far on the other side: wholly lit, penumbra, dark.
#[test]
fn one_large_triangle_makes_a_core_shadow_without_a_shadow_ray() {
    for kind in [ball(), sheet(Spread::Cosine)] {
        let mut scene = empty(0.0);
        (scene.settings.width, scene.settings.height) = (64, 48);
        scene.settings.lamps = full(64, Pattern::Sobol);
        scene.camera.eye = Vec3::new(0.1, 1.0, 6.0);
        let white = material(&mut scene, Material { diffuse: Colour::Constant(Rgb::ONE), ..Material::default() });
        plane(&mut scene, Vec3::new(0.0, -1.0, 0.0), Vec3::Y, white);
        let (along, across) = (Vec3::new(60.0, 0.0, 18.0), Vec3::new(-30.0, 0.0, 100.0));
        let at = Vec3::new(0.2, 1.2, 0.1);
        let mesh = vitrum::geometry::TriMesh {
            positions: vec![at - along, at + along, at + across],
            triangles: vec![[0, 1, 2]],
            ..Default::default()
        };
        let black = material(&mut scene, Material::black("cover"));
        add(&mut scene, vitrum::geometry::Shape::Mesh(mesh), black);
        scene.lights = vec![lamp(kind, Falloff::InverseSquare)];
        shafts_change_nothing("a cover", &scene, 0.2);
    }
}

#[test]
fn light_that_passes_glass_is_weakened_point_by_point() {
    for kind in [ball(), sheet(Spread::Cosine)] {
        let mut scene = still_life(vec![lamp(kind, Falloff::InverseSquare)], full(16, Pattern::Sobol));
        let glass = glass(&mut scene, 1.5, 0, Rgb::new(0.8, 0.2, 0.4));
        // A sheet over everything but the eye's view of it.
        cuboid(&mut scene, Vec3::new(-9.0, 1.8, -9.0), Vec3::new(9.0, 1.9, 9.0), glass);
        (scene.camera.eye, scene.camera.target) = (Vec3::new(0.4, 1.2, 4.0), Vec3::new(0.0, 0.3, 0.0));
        shafts_change_nothing("a sheet of glass", &scene, 0.0);
    }
}

#[test]
fn an_empty_shaft_in_an_absorbing_medium_weakens_the_light_of_each_point() {
    let mut scene = still_life(vec![lamp(ball(), Falloff::InverseSquare)], full(16, Pattern::Sobol));
    scene.media[0].absorption = Rgb::new(0.3, 0.1, 0.2);
    shafts_change_nothing("fog", &scene, 0.0);
}

/// Lamps with a body: a ball in a ball, a panel on a panel and in a ceiling; and places next to lamps.
#[test]
fn the_body_of_a_lamp_does_not_shade_it() {
    for (what, kind) in [("a ball", ball()), ("a panel", sheet(Spread::Even))] {
        let mut scene = still_life(vec![lamp(kind, Falloff::InverseSquare)], full(16, Pattern::Sobol));
        let glow = material(&mut scene, Material { emission: Rgb::ONE, ..Material::black("glow") });
        match kind {
            LightKind::Sphere { position, radius } => sphere(&mut scene, position, radius, glow),
            LightKind::Rectangle { corner, edges: [u, v], .. } => {
                let mesh = vitrum::geometry::TriMesh {
                    positions: vec![corner, corner + u, corner + u + v, corner + v],
                    triangles: vec![[0, 1, 2], [0, 2, 3]],
                    ..Default::default()
                };
                add(&mut scene, vitrum::geometry::Shape::Mesh(mesh), glow);
            }
            _ => unreachable!("lamps with an extent"),
        }
        let with = |probe| {
            let mut scene = scene.clone();
            scene.settings.lamps.probe = probe;
            native(&scene, &Options::default())
        };
        let [all, few] = [with(false), with(true)];
        assert!(few.rays.of(RayKind::Shadow) * 10 < all.rays.of(RayKind::Shadow) * 6, "{what}");
        // A shadow ray to the rim of the ball may graze the body; light through an empty shaft cannot.
        let differ = differ(&all.film, &few.film, 0.0);
        assert!(differ.len() <= 5, "{what}: {differ:?}");
        assert!(differ.iter().all(|&(x, y)| few.film.at(x, y)[0] > all.film.at(x, y)[0]), "{what}: {differ:?}");
    }
}

/// Anything, anywhere: hundreds of small pictures of random boxes, balls and lamps, near and far from the origin.
#[test]
fn random_scenes_are_the_same_by_shafts() {
    let mut rng = support::Rng::new(11);
    for round in 0..60 {
        let offset = Vec3::from([0; 3].map(|_| rng.unit() - 0.5)) * [0.0, 10.0, 1000.0][round % 3];
        let mut any = |size: f32| Vec3::from([0; 3].map(|_| (rng.unit() - 0.5) * size));
        let mut scene = empty(0.02);
        (scene.settings.width, scene.settings.height, scene.settings.max_depth) = (24, 18, 3);
        scene.settings.lamps = full(16, Pattern::Sobol);
        (scene.camera.eye, scene.camera.target) = (offset + Vec3::new(0.3, 2.0, 5.0), offset);
        let matt = Material { diffuse: Colour::Constant(Rgb::splat(0.7)), ..Material::default() };
        let matt = material(&mut scene, matt);
        plane(&mut scene, offset - Vec3::Y, (Vec3::Y + any(0.2)).normalize(), matt);
        for _ in 0..6 {
            let (at, size) = (offset + any(4.0), any(1.0).abs() + 1e-3);
            cuboid(&mut scene, at, at + size, matt);
            sphere(&mut scene, offset + any(4.0), 0.01 + any(0.8).x.abs(), matt);
        }
        let position = offset + any(6.0) + Vec3::Y * 2.0;
        let kind = if round % 2 == 0 {
            LightKind::Sphere { position, radius: 0.05 + any(1.0).x.abs() }
        } else {
            LightKind::Rectangle { corner: position, edges: [any(3.0), any(3.0)], spread: Spread::Even }
        };
        scene.lights = vec![lamp(kind, Falloff::InverseSquare)];
        let with = |probe| {
            let mut scene = scene.clone();
            scene.settings.lamps.probe = probe;
            native(&scene, &Options::default()).film
        };
        let differ = differ(&with(false), &with(true), 1e-4);
        assert!(differ.is_empty(), "{round}: {differ:?}");
    }
}

#[test]
fn threads_and_tiles_make_no_difference_to_a_bit() {
    let lights = vec![lamp(ball(), Falloff::InverseSquare), lamp(sheet(Spread::Even), Falloff::InverseSquare)];
    let mut scene = still_life(lights, LampSampling { count: 16, ..LampSampling::default() });
    scene.settings.samples = 2;
    let glass = glass(&mut scene, 1.5, 0, Rgb::new(0.8, 0.2, 0.4));
    sphere(&mut scene, Vec3::new(-0.5, 0.45, 0.9), 0.4, glass);
    let first = native(&scene, &Options { threads: 1, ..Options::default() });
    for (threads, tile) in [(2, 32), (1, 8), (3, 17), (1, 1000)] {
        let other = native(&scene, &Options { threads, tile, ..Options::default() });
        assert_eq!(first.film.pixels, other.film.pixels, "{threads} threads, tiles of {tile}");
        assert_eq!(first.rays.of(RayKind::Shadow), other.rays.of(RayKind::Shadow));
    }
}

/// A wall of a lamp, most of it below the horizon of the floor.
#[test]
fn a_lamp_below_the_horizon_in_part_is_the_same_whatever_it_is_grouped_with() {
    let wall = LightKind::Rectangle {
        corner: Vec3::new(-3.0, -2.0, -4.0),
        edges: [Vec3::X * 6.0, Vec3::Y * 2.3],
        spread: Spread::Even,
    };
    let lights = vec![Light { intensity: Rgb::splat(60.0), ..lamp(wall, Falloff::InverseSquare) }];
    let scene = still_life(lights, LampSampling { count: 16, ..LampSampling::default() });
    let first = native(&scene, &Options { threads: 1, tile: 1000, ..Options::default() });
    for tile in [1, 4, 8, 17] {
        let other = native(&scene, &Options { tile, ..Options::default() });
        assert_eq!(first.film.pixels, other.film.pixels, "tiles of {tile}");
        assert_eq!(first.rays.of(RayKind::Shadow), other.rays.of(RayKind::Shadow));
    }
    shafts_change_nothing("a wall", &scene, 0.1);
}

#[test]
fn a_lamp_lights_what_nothing_shades_as_a_point_in_its_middle_does_from_afar() {
    let position = Vec3::new(3.0, 40.0, 9.0);
    let open = |kind| {
        let mut scene = empty(0.0);
        let white = material(&mut scene, Material { diffuse: Colour::Constant(Rgb::ONE), ..Material::default() });
        plane(&mut scene, Vec3::new(0.0, -1.0, 0.0), Vec3::Y, white);
        scene.lights = vec![Light { intensity: Rgb::splat(900.0), ..lamp(kind, Falloff::InverseSquare) }];
        native(&scene, &Options::default()).film
    };
    let point = open(LightKind::Point { position });
    let edges = [Vec3::X * 0.4, Vec3::Z * 0.4];
    let corner = position - Vec3::new(0.2, 0.0, 0.2);
    for kind in
        [LightKind::Sphere { position, radius: 0.3 }, LightKind::Rectangle { corner, edges, spread: Spread::Even }]
    {
        let film = open(kind);
        assert!(differ(&film, &point, 1e-3).is_empty(), "{kind:?}");
        assert!(film.pixels.iter().any(|p| p[0] > 0.1));
    }
}

#[test]
fn another_seed_is_other_noise_around_the_same_mean() {
    let scene = |seed| {
        still_life(
            vec![lamp(ball(), Falloff::InverseSquare)],
            LampSampling { count: 16, seed, ..LampSampling::default() },
        )
    };
    let [one, two] = [1, 2].map(|seed| native(&scene(seed), &Options::default()).film);
    assert!(differ(&one, &two, 1e-3).len() > 50);
    let mean = |film: &Film| film.pixels.iter().flatten().map(|&v| f64::from(v)).sum::<f64>() / 8100.0;
    assert!((mean(&one) - mean(&two)).abs() < 1e-3 * mean(&one), "{} {}", mean(&one), mean(&two));
}
