//! Light from emissive shapes and from the environment: against answers known by hand, against lamps, and the same in both
//! renderers and for any division of the work.

use crate::support;

use glam::{DVec3, Vec3};
use support::backends;
use support::scenes::{add, cuboid, empty, glass, material, native, plane, sphere};
use vitrum::accel::Backend;
use vitrum::effects::{self, Effect, EffectPlan, Pipeline};
use vitrum::geometry::{Shape, TriMesh};
use vitrum::image::Film;
use vitrum::render::reference;
use vitrum::render::{Observer, Options, RayKind, render};
use vitrum::scene::{
    Colour, Environment, Falloff, Highlight, HighlightModel, LampChoice, LampSampling, Light, LightKind, LightsFrom,
    Material, Pattern, Projection, Rgb, Scene, Spread, Texture,
};

fn matt(albedo: f32) -> Material {
    Material { diffuse: Colour::Constant(Rgb::splat(albedo)), ..Material::default() }
}

fn emissive(radiance: Rgb) -> Material {
    Material { emission: radiance, ..Material::black("emissive") }
}

fn samples(count: u32) -> LampSampling {
    LampSampling { count, pattern: Pattern::Sobol, seed: 5, probe: true }
}

/// A scene lit by all that shines, of 24 by 18 pixels.
fn lit(environment: Environment, count: u32) -> Scene {
    let mut scene = empty(0.0);
    (scene.settings.width, scene.settings.height) = (24, 18);
    scene.settings.lights_from = LightsFrom::All;
    scene.settings.lamps = samples(count);
    scene.environment = environment;
    scene
}

fn picture(scene: &mut Scene, rows: [f32; 32], sun: Option<(usize, usize, f32)>) {
    let (width, height) = (64, 32);
    let mut pixels: Vec<Rgb> = (0..width * height).map(|i| Rgb::splat(rows[i as usize / 64])).collect();
    if let Some((x, y, radiance)) = sun {
        pixels[y * 64 + x] = Rgb::splat(radiance);
    }
    let texture =
        scene.add_texture(Texture { name: "sky".into(), width, height, pixels: pixels.into(), ..Texture::default() });
    scene.environment = Environment::LatLong { texture, scale: Rgb::ONE, rotation: 0.0 };
}

/// A camera above that sees only the floor within 2 of the origin.
fn look_down(scene: &mut Scene) {
    scene.camera.eye = Vec3::new(0.0, 20.0, 0.001);
    scene.camera.target = Vec3::ZERO;
    scene.camera.projection = Projection::Orthographic { height: 4.0 };
}

/// The pictures over each back end that is there.
fn by_each(scene: &Scene) -> Vec<Film> {
    let embree =
        [Backend::Embree, Backend::EmbreeFast].into_iter().filter_map(|b| backends::embree(b, &scene.geometry));
    std::iter::once(backends::native(&scene.geometry))
        .chain(embree)
        .map(|accel| render(scene, &accel, &Options::default(), &Observer::default()).expect("renders").film)
        .collect()
}

fn by_reference(scene: &Scene) -> Film {
    reference::render(scene, &Options::default(), &Observer::default()).expect("nobody interrupts a test").film
}

fn mean(film: &Film) -> DVec3 {
    let sum: DVec3 = film.pixels.iter().map(|p| DVec3::from(p.map(f64::from))).sum();
    sum / film.pixels.len() as f64
}

fn largest_difference(a: &Film, b: &Film) -> f64 {
    a.pixels
        .as_flattened()
        .iter()
        .zip(b.pixels.as_flattened())
        .map(|(a, b)| f64::from((a - b).abs()))
        .fold(0.0, f64::max)
}

#[test]
fn a_matt_sphere_under_an_even_sky_has_albedo_times_radiance_over_every_back_end() {
    let mut scene = lit(Environment::Constant(Rgb::new(2.0, 1.0, 0.5)), 8);
    let grey = material(&mut scene, matt(0.6));
    sphere(&mut scene, Vec3::ZERO, 1.0, grey);
    // A camera so near that it sees nothing else.
    scene.camera.eye = Vec3::new(0.0, 0.2, 1.3);
    let want = DVec3::new(1.2, 0.6, 0.3);
    for film in by_each(&scene).into_iter().chain([by_reference(&scene)]) {
        for pixel in &film.pixels {
            let pixel = DVec3::from(pixel.map(f64::from));
            assert!((pixel - want).abs().max_element() < 1e-5, "{pixel}");
        }
    }
}

#[test]
fn energy_is_kept_inside_an_even_glowing_ball() {
    // Albedo times radiance, whatever the surface faces; what lights it is a shape and no environment.
    let mut scene = lit(Environment::default(), 64);
    let glow = material(&mut scene, emissive(Rgb::splat(1.0)));
    sphere(&mut scene, Vec3::ZERO, 30.0, glow);
    let grey = material(&mut scene, matt(0.5));
    sphere(&mut scene, Vec3::new(0.3, -0.2, 0.0), 1.0, grey);
    scene.camera.eye = Vec3::new(0.3, 0.0, 1.4);
    let got = mean(&native(&scene, &Options::default()).film).x;
    assert!((got - 0.5).abs() < 2e-3, "{got}");
}

#[test]
fn half_a_sky_lights_a_floor_fully_and_a_wall_half() {
    let mut scene = lit(Environment::default(), 64);
    picture(&mut scene, std::array::from_fn(|row| if row < 16 { 1.0 } else { 0.0 }), None);
    let grey = material(&mut scene, matt(0.8));
    look_down(&mut scene);
    plane(&mut scene, Vec3::ZERO, Vec3::Y, grey);
    let floor = mean(&native(&scene, &Options::default()).film).x;
    // Between the middles of the two rows at the horizon the picture falls from 1 to 0: the floor lacks what lies below
    // 1 up to half a row above it, an integral of 2 sin cos over angles of 2.8 degrees.
    let row: f64 = std::f64::consts::PI / 32.0;
    let lacking = 2.0 * (row / 2.0).powi(2) / 12.0;
    assert!((floor - 0.8 * (1.0 - lacking)).abs() < 4e-4, "{floor}");
    scene.geometry.clear();
    scene.objects.clear();
    plane(&mut scene, Vec3::ZERO, Vec3::Z, grey);
    scene.camera.eye = Vec3::new(0.0, 0.0, 20.0);
    let wall = mean(&native(&scene, &Options::default()).film).x;
    assert!((wall - 0.4).abs() < 1e-3, "{wall}");
}

/// A floor with a post, under a sun of one texel of the picture, or under a lamp as far and as strong.
fn sundial(lamp: bool) -> Scene {
    let mut scene = lit(Environment::default(), 32);
    let (x, y, radiance) = (20, 8, 900.0);
    let grey = material(&mut scene, matt(0.5));
    plane(&mut scene, Vec3::ZERO, Vec3::Y, grey);
    cuboid(&mut scene, Vec3::new(-0.2, 0.0, -0.2), Vec3::new(0.2, 1.0, 0.2), grey);
    look_down(&mut scene);
    (scene.settings.width, scene.settings.height) = (48, 36);
    if lamp {
        let (turn, polar) = (
            ((f64::from(x) + 0.5) / 64.0 - 0.5) * 2.0 * std::f64::consts::PI,
            (f64::from(y) + 0.5) / 32.0 * std::f64::consts::PI,
        );
        let towards = DVec3::new(turn.sin() * polar.sin(), polar.cos(), -turn.cos() * polar.sin());
        let solid = 2.0 * std::f64::consts::PI.powi(2) / 2048.0 * polar.sin();
        scene.lights.push(Light {
            name: "sun".into(),
            kind: LightKind::Directional { direction: -towards.as_vec3() },
            intensity: Rgb::splat((f64::from(radiance) * solid) as f32),
            falloff: Falloff::InverseSquare,
            shadows: true,
        });
    } else {
        picture(&mut scene, [0.0; 32], Some((x as usize, y as usize, radiance)));
    }
    scene
}

#[test]
fn a_sun_of_one_texel_is_found_and_casts_the_shadow_of_a_distant_lamp() {
    let [sun, lamp] = [false, true].map(|lamp| native(&sundial(lamp), &Options::default()).film);
    let most = lamp.pixels.iter().map(|p| p[0]).fold(0.0, f32::max);
    assert!(most > 0.5, "{most}");
    // Texels are 5.6 degrees wide, and interpolation doubles that: the shadow of a post of height 1 has a penumbra of some
    // pixels of 0.11. Elsewhere both agree.
    let mut agree = 0;
    let mut noise = 0.0_f64;
    for (a, b) in sun.pixels.iter().zip(&lamp.pixels) {
        let off = f64::from((a[0] - b[0]).abs() / most);
        agree += usize::from(off < 0.08);
        noise += off;
    }
    let count = sun.pixels.len();
    assert!(agree * 100 >= count * 88, "{agree} of {count}");
    assert!(noise / count as f64 <= 0.04, "{}", noise / count as f64);
    let dark = |film: &Film| film.pixels.iter().filter(|p| p[0] < 0.02 * most).count();
    assert!(dark(&sun) * 2 > dark(&lamp), "the middle of the shadow is black: {} {}", dark(&sun), dark(&lamp));
    assert!((mean(&sun).x / mean(&lamp).x - 1.0).abs() < 0.01, "{} {}", mean(&sun).x, mean(&lamp).x);
}

/// A floor of grey with a shiny ball, lit by a ball of radius `radius` at height `height`, which shines itself or is a lamp.
fn under_ball(radius: f32, height: f32, kind: Option<bool>) -> Scene {
    let mut scene = lit(Environment::default(), 128);
    let highlight = Highlight { colour: Rgb::splat(0.3), exponent: 12.0, model: HighlightModel::BlinnPhong };
    let floor = material(&mut scene, Material { highlight: Some(highlight), ..matt(0.7) });
    plane(&mut scene, Vec3::ZERO, Vec3::Y, floor);
    sphere(&mut scene, Vec3::new(0.6, 0.3, 0.2), 0.3, floor);
    look_down(&mut scene);
    scene.camera.eye.y = 0.5 * height;
    let position = Vec3::new(0.0, height, 0.0);
    let intensity = Rgb::splat(0.8 * height * height);
    match kind {
        None => {
            let glow = material(&mut scene, emissive(intensity / (std::f32::consts::PI * radius * radius)));
            sphere(&mut scene, position, radius, glow);
        }
        Some(extended) => {
            let kind = if extended { LightKind::Sphere { position, radius } } else { LightKind::Point { position } };
            let falloff = Falloff::InverseSquare;
            scene.lights.push(Light { name: "lamp".into(), kind, intensity, falloff, shadows: true });
        }
    }
    scene
}

#[test]
fn an_emissive_sphere_equals_the_spherical_lamp_nearby_and_a_point_lamp_far_away() {
    let film = |scene: &Scene| native(scene, &Options::default()).film;
    let [near, lamp] = [None, Some(true)].map(|kind| film(&under_ball(0.4, 2.5, kind)));
    let off = largest_difference(&near, &lamp);
    assert!(off < 1e-4, "sample by sample: {off}");
    let [far, point] = [None, Some(false)].map(|kind| film(&under_ball(0.05, 200.0, kind)));
    assert!((mean(&far).x / mean(&point).x - 1.0).abs() < 1e-4);
    let beyond = far.pixels.iter().zip(&point.pixels).filter(|(a, b)| (a[0] - b[0]).abs() > 1e-3).count();
    assert!(beyond * 50 <= far.pixels.len(), "{beyond}: but for the edge of the shadow");
}

#[test]
fn an_emissive_rectangle_lights_as_a_panel_does_and_a_flat_box_as_its_lower_face() {
    let scene = |of: &dyn Fn(&mut Scene)| {
        let mut scene = lit(Environment::default(), 256);
        let floor = material(&mut scene, matt(0.7));
        plane(&mut scene, Vec3::ZERO, Vec3::Y, floor);
        look_down(&mut scene);
        scene.camera.eye.y = 0.5;
        of(&mut scene);
        native(&scene, &Options::default()).film
    };
    let (a, b) = (Vec3::new(-0.7, 1.0, -0.6), Vec3::new(0.9, 1.0, 0.8));
    let mesh = |scene: &mut Scene| {
        let glow = material(scene, emissive(Rgb::splat(1.5)));
        let positions = vec![a, Vec3::new(b.x, 1.0, a.z), b, Vec3::new(a.x, 1.0, b.z)];
        add(scene, Shape::Mesh(TriMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]])), glow);
    };
    let lamp = |scene: &mut Scene| {
        let edges = [Vec3::X * (b.x - a.x), Vec3::Z * (b.z - a.z)];
        let area = (b.x - a.x) * (b.z - a.z);
        let kind = LightKind::Rectangle { corner: a, edges, spread: Spread::Cosine };
        let intensity = Rgb::splat(1.5 * area);
        scene.lights.push(Light {
            name: "panel".into(),
            kind,
            intensity,
            falloff: Falloff::InverseSquare,
            shadows: true,
        });
    };
    let cube = |scene: &mut Scene| {
        let glow = material(scene, emissive(Rgb::splat(1.5)));
        cuboid(scene, a, Vec3::new(b.x, 1.0005, b.z), glow);
    };
    let [panel, sheet, cube] = [scene(&lamp), scene(&mesh), scene(&cube)];
    // X cross Z is -Y: the panel shines down.
    assert!(mean(&panel).x > 0.05, "{}", mean(&panel));
    for (what, film) in [("sheet", sheet), ("box", cube)] {
        assert!((mean(&film).x / mean(&panel).x - 1.0).abs() < 3e-3, "{what}: {} {}", mean(&film).x, mean(&panel).x);
        let off = largest_difference(&film, &panel);
        assert!(off < 0.15 * mean(&panel).x, "{what}: {off}");
    }
}

/// All that shines at once: a box that touches the floor, a ball, a mesh, a sun in a picture, and glass in between.
fn still_life() -> Scene {
    let mut scene = lit(Environment::default(), 8);
    picture(&mut scene, std::array::from_fn(|row| 0.5 - 0.01 * row as f32), Some((40, 9, 60.0)));
    (scene.settings.width, scene.settings.height) = (48, 36);
    scene.settings.max_depth = 4;
    scene.camera.eye = Vec3::new(0.4, 3.0, 5.0);
    scene.camera.target = Vec3::new(0.0, 0.4, 0.0);
    let floor = material(&mut scene, matt(0.7));
    plane(&mut scene, Vec3::ZERO, Vec3::Y, floor);
    let shiny = Highlight { colour: Rgb::splat(0.4), exponent: 20.0, model: HighlightModel::Phong };
    let red = material(&mut scene, Material { highlight: Some(shiny), ..matt(0.5) });
    sphere(&mut scene, Vec3::new(0.5, 0.4, 0.4), 0.4, red);
    let glow = material(&mut scene, emissive(Rgb::new(3.0, 2.0, 1.0)));
    cuboid(&mut scene, Vec3::new(-1.0, 0.0, -0.6), Vec3::new(-0.5, 0.7, -0.1), glow);
    let blue = material(
        &mut scene,
        Material { diffuse: Colour::Constant(Rgb::splat(0.2)), ..emissive(Rgb::new(0.5, 1.0, 4.0)) },
    );
    sphere(&mut scene, Vec3::new(1.3, 0.9, -0.4), 0.2, blue);
    let clear = glass(&mut scene, 1.5, 0, Rgb::new(0.8, 0.2, 0.4));
    sphere(&mut scene, Vec3::new(-0.3, 0.45, 0.9), 0.4, clear);
    scene
}

#[test]
fn both_renderers_agree_on_all_that_shines() {
    let scene = still_life();
    let ours = native(&scene, &Options::default());
    let theirs = reference::render(&scene, &Options::default(), &Observer::default()).expect("renders");
    assert!(theirs.rays.of(RayKind::Shadow) > 5000);
    let beyond = |limit: f32| {
        ours.film
            .pixels
            .iter()
            .zip(&theirs.film.pixels)
            .filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| (a - b).abs() > limit))
            .count()
    };
    // A sample that falls on the other side of an edge changes its pixel by an eighth of that light.
    assert!(beyond(5e-4) * 50 <= ours.film.pixels.len(), "{}", beyond(5e-4));
    assert!((mean(&ours.film) - mean(&theirs.film)).abs().max_element() < 1e-3);
}

#[test]
fn threads_tiles_and_pipelines_give_the_same_bytes() {
    let scene = still_life();
    let bytes = |options: &Options| -> Vec<u32> {
        native(&scene, options).film.pixels.as_flattened().iter().map(|x| x.to_bits()).collect()
    };
    let one = bytes(&Options { threads: 1, ..Options::default() });
    let all = effects::Options { pipeline: Pipeline::All, ..effects::Options::default() };
    for options in [
        Options { threads: 3, tile: 7, ..Options::default() },
        Options { threads: 2, tile: 48, ..Options::default() },
        Options { effects: all, ..Options::default() },
    ] {
        assert!(bytes(&options) == one, "{options:?}");
    }
}

#[test]
fn a_thousand_emitters_cost_as_many_rays_as_one_and_bring_the_sum_of_their_light() {
    let scene = |many: bool| {
        let mut scene = lit(Environment::default(), 64);
        let floor = material(&mut scene, matt(0.7));
        plane(&mut scene, Vec3::ZERO, Vec3::Y, floor);
        look_down(&mut scene);
        scene.camera.eye.y = 0.5;
        let side = if many { 32 } else { 1 };
        let glow = material(&mut scene, emissive(Rgb::splat(40.0)));
        for i in 0..side * side {
            let at = |k: i32| (k as f32 + 0.5) / side as f32 * 4.0 - 2.0;
            sphere(&mut scene, Vec3::new(at(i % side), 1.5, at(i / side)), 0.01, glow);
        }
        scene
    };
    let [one, many] = [scene(false), scene(true)].map(|scene| native(&scene, &Options::default()));
    let shadow = |outcome: &vitrum::render::Outcome| outcome.rays.of(RayKind::Shadow);
    assert!(shadow(&many) <= shadow(&one), "{} {}", shadow(&many), shadow(&one));
    // Each is a point lamp of intensity pi r^2 L.
    let scene = scene(true);
    let intensity = std::f64::consts::PI * 1e-4 * 40.0;
    let (mut want, mut count) = (0.0, 0);
    for y in 0..18 {
        for x in 0..24 {
            let (x, z) =
                ((f64::from(x) + 0.5) / 18.0 * 4.0 - 4.0 * 24.0 / 36.0, (f64::from(y) + 0.5) / 18.0 * 4.0 - 2.0);
            count += 1;
            for object in &scene.geometry[1..] {
                let Shape::Sphere(lamp) = &object.shape else { panic!("all others are spheres") };
                let way = lamp.centre.as_dvec3() - DVec3::new(x, 0.0, z);
                want += 0.7 / std::f64::consts::PI * intensity * way.y / way.length().powi(3);
            }
        }
    }
    let got = mean(&many.film).x;
    assert!((got / (want / f64::from(count)) - 1.0).abs() < 5e-3, "{got} {}", want / f64::from(count));
}

#[test]
fn sampled_lamps_light_as_each_lamp_does_at_the_cost_of_a_few() {
    let mut scene = lit(Environment::default(), 16);
    scene.settings.lights_from = LightsFrom::Lamps;
    let floor = material(&mut scene, matt(0.7));
    plane(&mut scene, Vec3::ZERO, Vec3::Y, floor);
    sphere(&mut scene, Vec3::new(0.3, 0.4, 0.0), 0.4, floor);
    look_down(&mut scene);
    for i in 0..400_u16 {
        let at = |by: f32| (f32::from(i) * by).fract();
        let position = Vec3::new(6.0 * at(0.618_034) - 3.0, 1.0 + at(0.414_214), 6.0 * at(0.732_051) - 3.0);
        let spot = LightKind::Spot { position, direction: Vec3::NEG_Y, cos_inner: 0.9, cos_outer: 0.3 };
        let kind = if i % 4 == 0 { spot } else { LightKind::Point { position } };
        let intensity = Rgb::new(0.01, 0.02, 0.03) * (1.0 + f32::from(i % 7));
        scene.lights.push(Light {
            name: "lamp".into(),
            kind,
            intensity,
            falloff: Falloff::InverseSquare,
            shadows: true,
        });
    }
    let each = native(&scene, &Options::default());
    scene.settings.lamp_choice = LampChoice::Sampled;
    let sampled = native(&scene, &Options::default());
    let (few, many) = (sampled.rays.of(RayKind::Shadow), each.rays.of(RayKind::Shadow));
    assert!(few * 10 < many, "{few} {many}");
    let off = mean(&sampled.film) / mean(&each.film) - DVec3::ONE;
    assert!(off.abs().max_element() < 0.01, "{off}");
    let exact = by_reference(&scene);
    assert!(largest_difference(&sampled.film, &exact) < 0.2 * mean(&each.film).z);
    assert!((mean(&sampled.film) - mean(&exact)).abs().max_element() < 1e-3 * mean(&exact).z);
}

#[test]
fn scenes_with_lamps_or_ambient_light_keep_their_pictures_unless_they_ask() {
    let mut scene = still_life();
    scene.lights.push(Light {
        name: "lamp".into(),
        kind: LightKind::Point { position: Vec3::new(1.0, 5.0, 2.0) },
        intensity: Rgb::splat(20.0),
        falloff: Falloff::InverseSquare,
        shadows: true,
    });
    let film = |scene: &Scene| native(scene, &Options::default()).film;
    let mut with = |from| {
        scene.settings.lights_from = from;
        (scene.shining(), film(&scene))
    };
    let [auto, lamps, all] = [LightsFrom::Auto, LightsFrom::Lamps, LightsFrom::All].map(&mut with);
    assert!(!auto.0.any() && auto.1 == lamps.1 && all.1 != lamps.1);
    // Light adds up: what each kind brings is the same with and without the others.
    let [emissive, sky] = [LightsFrom::Emissive, LightsFrom::Sky].map(&mut with);
    let sum = mean(&emissive.1) + mean(&sky.1) - mean(&lamps.1);
    assert!((sum - mean(&all.1)).abs().max_element() < 1e-6, "{sum} {}", mean(&all.1));
    scene.lights.clear();
    scene.settings.lights_from = LightsFrom::Auto;
    assert!(scene.shining().emissive && scene.shining().sky);
    scene.ambient = Rgb::splat(0.1);
    assert!(!scene.shining().any());
}

#[test]
fn reasons_name_what_shines_and_what_keeps_it_from_lighting() {
    let mut scene = still_life();
    scene.objects[2].name = "stove".into();
    scene.objects[0].name = "floor".into();
    let why = |scene: &Scene, effect| {
        let plan = EffectPlan::resolve(scene, &effects::Options::default());
        (plan.of(effect).on, plan.of(effect).because.clone())
    };
    assert_eq!(
        why(&scene, Effect::EmissiveLight),
        (true, String::from("`stove` shines; `floor` answers light (and 2 more)"))
    );
    let (on, because) = why(&scene, Effect::SkyLight);
    assert!(on && because.contains("`floor`"), "{because}");
    scene.settings.lights_from = LightsFrom::Lamps;
    let off = (false, String::from("`stove` shines, but `lights_from = \"lamps\"`"));
    assert_eq!(why(&scene, Effect::EmissiveLight), off);
    assert!(!why(&scene, Effect::SkyLight).0);
    scene.settings.lights_from = LightsFrom::All;
    // Each can be left out by itself.
    for (effect, kept) in [(Effect::EmissiveLight, LightsFrom::Sky), (Effect::SkyLight, LightsFrom::Emissive)] {
        let without = effects::without(&scene, [effect].into_iter().collect());
        assert_eq!(without.settings.lights_from, kept);
    }
    let none = effects::without(&scene, [Effect::HardShadows].into_iter().collect());
    let bright = mean(&native(&none, &Options::default()).film);
    assert!(bright.x > mean(&native(&scene, &Options::default()).film).x, "no surface is in the way");
}

#[test]
fn the_back_ends_agree_on_all_that_shines() {
    let scene = still_life();
    let films = by_each(&scene);
    for film in &films[1..] {
        let beyond = film.pixels.iter().zip(&films[0].pixels).filter(|(a, b)| (a[0] - b[0]).abs() > 1e-3).count();
        assert!(beyond * 100 <= film.pixels.len(), "{beyond}");
    }
}
