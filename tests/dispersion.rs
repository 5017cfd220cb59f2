//! Promise: white light divides where a medium disperses it, each wavelength goes where Snell sends it, and together
//! they are as white as before. Answers by hand first, for both renderers; then one renderer against the other.

use crate::support;

use glam::{DVec2, DVec3, Vec3};
use support::scenes::{add, bare, cuboid_mesh, empty, glass, material, native, plane, sphere};
use vitrum::geometry::{Shape, TriMesh};
use vitrum::load::catalogue;
use vitrum::optics::{Bands, FresnelModel, LINE_D};
use vitrum::render::reference::{self, Prepared};
use vitrum::render::{Observer, Options, Outcome, RayKind};
use vitrum::scene::{
    Camera, Dispersion, Environment, Falloff, Interface, Light, LightKind, Material, Projection, Rgb, Scene,
};

const BANDS: u32 = 8;

/// A scene of one pixel in black, with nothing cut off.
fn dark() -> Scene {
    let mut scene = empty(0.0);
    let settings = &mut scene.settings;
    (settings.width, settings.height, settings.wavelengths) = (1, 1, BANDS);
    scene
}

fn named(name: &str) -> Dispersion {
    catalogue::transparent(name).expect("it is known").dispersion
}

/// Adds a glass with a curve and gives its material's number.
fn dispersing(scene: &mut Scene, curve: Dispersion) -> u32 {
    let material = glass(scene, curve.index_at(LINE_D).expect("a curve"), 0, Rgb::ZERO);
    scene.media.last_mut().expect("just added").dispersion = curve;
    material
}

fn emitter(scene: &mut Scene, radiance: f32) -> u32 {
    material(scene, Material { emission: Rgb::splat(radiance), ..bare(Interface::Opaque) })
}

/// Points the only pixel's only ray.
fn look(scene: &mut Scene, origin: DVec3, dir: DVec3) {
    let (eye, target) = (origin.as_vec3(), (origin + dir).as_vec3());
    let up = if dir.z.abs() < 0.9 { Vec3::Z } else { Vec3::Y };
    let projection = Projection::Orthographic { height: 1e-3 };
    scene.camera = Camera { eye, target, up, projection, medium: scene.camera.medium };
}

/// Both renderers' outcomes.
fn both(scene: &Scene) -> [(&'static str, Outcome); 2] {
    let reference = reference::render(scene, &Options::default(), &Observer::default()).expect("renders");
    [("reference", reference), ("native", native(scene, &Options::default()))]
}

#[track_caller]
fn close(what: &str, got: [f32; 3], want: DVec3, within: f64) {
    let off = (DVec3::from(got.map(f64::from)) - want).abs().max_element();
    assert!(off <= within, "{what}: got {got:?}, want {want}, off by {off:e}");
}

/// Fresnel by the textbook, from the sine of the angle of incidence; 1 where reflection is total.
fn fresnel(n1: f64, n2: f64, sin_i: f64) -> f64 {
    let sin_t = n1 / n2 * sin_i;
    if sin_t >= 1.0 {
        return 1.0;
    }
    let (c, d) = ((1.0 - sin_i * sin_i).sqrt(), (1.0 - sin_t * sin_t).sqrt());
    let s = (n1 * c - n2 * d) / (n1 * c + n2 * d);
    let p = (n1 * d - n2 * c) / (n1 * d + n2 * c);
    0.5 * (s * s + p * p)
}

fn weight(bands: &Bands, k: usize) -> DVec3 {
    DVec3::from(bands.weight[k].map(f64::from))
}

/// An upright prism: an equilateral triangle of side 1 in the plane of x and y, its base on y = 0.
fn prism() -> Shape {
    let height = 0.75_f32.sqrt();
    let corners = [[-0.5, 0.0], [0.5, 0.0], [0.0, height]];
    let positions = [-2.0, 2.0].iter().flat_map(|&z| corners.map(|[x, y]| Vec3::new(x, y, z))).collect();
    let (ends, sides) = ([[0, 2, 1], [3, 4, 5]], [[0, 1], [1, 2], [2, 0]]);
    let sides = sides.iter().flat_map(|&[a, b]| [[a, b, b + 3], [a, b + 3, a + 3]]);
    let triangles = ends.into_iter().chain(sides).collect();
    Shape::Mesh(TriMesh { positions, triangles, ..TriMesh::default() })
}

fn turned(degrees: f64) -> DVec2 {
    DVec2::from_angle(degrees.to_radians())
}

/// Computes the path of a ray that hits the middle of the prism's left face under an angle (degrees). Returns the point
/// where it leaves the right face, the angle of its direction to the x axis, and the share of light that arrives there.
fn through_the_prism(n: f64, incidence: f64) -> Option<(DVec2, f64, f64)> {
    let sin_i = incidence.to_radians().sin();
    let first = (sin_i / n).asin();
    let second = 60_f64.to_radians() - first;
    let sin_e = n * second.sin();
    let (middle, right) = (DVec2::new(-0.25, 0.75_f64.sqrt() / 2.0), turned(30.0));
    let inside = DVec2::from_angle(first - 30_f64.to_radians());
    let way = right.dot(DVec2::new(0.5, 0.0) - middle) / right.dot(inside);
    let passes = (1.0 - fresnel(1.0, n, sin_i)) * (1.0 - fresnel(n, 1.0, second.sin()));
    (sin_e < 1.0).then(|| (middle + inside * way, 30.0 - sin_e.asin().to_degrees(), passes))
}

/// The prism alone, and the ray that meets the middle of its left face under an angle.
fn prism_scene(curve: Dispersion, incidence: f64) -> Scene {
    let mut scene = dark();
    // What is reflected inside goes round and would leave along with the rest.
    scene.settings.max_depth = 2;
    let glass = dispersing(&mut scene, curve);
    add(&mut scene, prism(), glass);
    let dir = turned(incidence - 30.0).extend(0.0);
    look(&mut scene, DVec3::new(-0.25, 0.75_f64.sqrt() / 2.0, 0.0) - dir * 2.0, dir);
    scene
}

#[test]
fn each_wavelength_leaves_a_prism_by_the_formula_of_minimum_deviation() {
    let curve = named("sf11");
    let bands = Bands::new(BANDS, 0.5);
    let mut last = f64::INFINITY;
    for (k, &nm) in bands.nm.iter().enumerate() {
        let n = curve.index_at(nm).expect("a curve");
        // Light crosses the prism parallel to its base: n = sin((A + D) / 2) / sin(A / 2).
        let incidence = (n * 30_f64.to_radians().sin()).asin().to_degrees();
        let deviation = 2.0 * incidence - 60.0;
        assert!(deviation < last, "longer waves are deviated less");
        last = deviation;
        let (leaves, angle, passes) = through_the_prism(n, incidence).expect("it passes");
        assert!((incidence - 30.0 - angle - deviation).abs() < 1e-9);
        // A lamp a thousand sides away that only this wavelength can hit: its neighbours pass it by three of its radii.
        let mut scene = prism_scene(curve, incidence);
        let lamp = emitter(&mut scene, 1.0);
        let at = leaves + turned(angle) * 1000.0;
        sphere(&mut scene, at.extend(0.0).as_vec3(), 0.5, lamp);
        for (renderer, outcome) in both(&scene) {
            close(&format!("{nm} nm, {renderer}"), outcome.film.at(0, 0), weight(&bands, k) * passes, 4e-6);
        }
    }
}

#[test]
fn blue_is_deviated_more_than_green_and_green_more_than_red() {
    // One ray, and a lamp for each wavelength where Snell sends it: each sees its own and no other.
    let curve = named("flint");
    let bands = Bands::new(BANDS, 0.5);
    let angles: Vec<f64> = (0..bands.nm.len())
        .map(|k| {
            let n = curve.index_at(bands.nm[k]).expect("a curve");
            let (leaves, angle, passes) = through_the_prism(n, 55.0).expect("it passes");
            let mut scene = prism_scene(curve, 55.0);
            let lamp = emitter(&mut scene, 1.0);
            sphere(&mut scene, (leaves + turned(angle) * 1000.0).extend(0.0).as_vec3(), 0.3, lamp);
            for (renderer, outcome) in both(&scene) {
                close(renderer, outcome.film.at(0, 0), weight(&bands, k) * passes, 4e-6);
            }
            angle
        })
        .collect();
    // More deviated is further down.
    assert!(angles.windows(2).all(|w| w[0] < w[1]), "{angles:?}");
    let most = |channel: usize| {
        (0..bands.nm.len()).max_by(|&a, &b| bands.weight[a][channel].total_cmp(&bands.weight[b][channel])).unwrap()
    };
    assert!(angles[most(2)] < angles[most(1)] && angles[most(1)] < angles[most(0)]);
}

/// A half space of glass below y = 0 with the eye in it, and a ground at y = -9 that sends out `ground`.
fn from_inside(curve: Dispersion, ground: f32, sin_i: f64) -> Scene {
    let mut scene = dark();
    let glass = dispersing(&mut scene, curve);
    plane(&mut scene, Vec3::ZERO, Vec3::Y, glass);
    let floor = emitter(&mut scene, ground);
    plane(&mut scene, Vec3::Y * -9.0, Vec3::Y, floor);
    scene.camera.medium = Some(1);
    look(&mut scene, DVec3::new(0.0, -1.0, 0.0), DVec3::new(sin_i, (1.0 - sin_i * sin_i).sqrt(), 0.0));
    scene
}

#[test]
fn blue_is_reflected_totally_before_red() {
    let curve = named("sf11");
    let bands = Bands::new(BANDS, 0.5);
    let n: Vec<f64> = bands.nm.iter().map(|&nm| curve.index_at(nm).expect("a curve")).collect();
    // Half of the wavelengths are beyond their critical angles.
    let sin_i = 0.5 * (1.0 / n[3] + 1.0 / n[4]);
    let shares: Vec<f64> = n.iter().map(|&n| fresnel(n, 1.0, sin_i)).collect();
    assert!(shares[..4].iter().all(|&r| r == 1.0) && shares[4..].iter().all(|&r| r < 0.9));
    let reflected: DVec3 = (0..8).map(|k| weight(&bands, k) * shares[k]).sum();
    assert!(reflected.z > 0.99 && reflected.x < reflected.y, "{reflected}: the mirror image is blue");
    // Near the critical angle f32's rounding of the direction is magnified.
    for (renderer, outcome) in both(&from_inside(curve, 1.0, sin_i)) {
        close(&format!("{renderer}, reflected"), outcome.film.at(0, 0), reflected, 2e-5);
        assert_eq!(outcome.rays.of(RayKind::Reflected), 1, "what is reflected stays together");
        assert_eq!(outcome.rays.of(RayKind::Transmitted), 4);
    }
    let mut scene = from_inside(curve, 0.0, sin_i);
    scene.environment = Environment::Constant(Rgb::ONE);
    for (renderer, outcome) in both(&scene) {
        close(&format!("{renderer}, refracted"), outcome.film.at(0, 0), DVec3::ONE - reflected, 2e-5);
    }
}

#[test]
fn white_stays_whole_where_its_wavelengths_stay_together() {
    let slab = || Shape::Mesh(cuboid_mesh(Vec3::new(-5.0, -5.0, -1.0), Vec3::new(5.0, 5.0, 0.0)));
    let scene_of = |curve: Option<Dispersion>, outside: Option<Dispersion>, dir: DVec3| {
        let mut scene = dark();
        scene.environment = Environment::Constant(Rgb::ONE);
        scene.settings.max_depth = 6;
        for curve in [curve, outside].into_iter().flatten() {
            let medium = scene.media.len();
            let glass = dispersing(&mut scene, curve);
            if medium == 1 {
                add(&mut scene, slab(), glass);
            }
        }
        if outside.is_some() {
            scene.camera.medium = Some(2);
        }
        look(&mut scene, DVec3::new(0.1, 0.2, 3.0), dir);
        scene
    };
    let one_index = |mut scene: Scene| {
        scene.media.iter_mut().for_each(|m| m.dispersion = Dispersion::None);
        scene
    };
    let (sf11, facing, askew) = (named("sf11"), -DVec3::Z, DVec3::new(0.5, 0.0, -0.8).normalize());
    // Face on, and inside a medium of the same glass.
    for scene in [scene_of(Some(sf11), None, facing), scene_of(Some(sf11), Some(sf11), askew)] {
        let plain = one_index(scene.clone());
        for ((renderer, divided), (_, whole)) in both(&scene).iter().zip(&both(&plain)) {
            assert_eq!(divided.film, whole.film, "{renderer}");
            assert_eq!(divided.rays.total(), whole.rays.total(), "{renderer}");
        }
    }
    // Askew they part.
    let scene = scene_of(Some(sf11), None, askew);
    for ((_, divided), (_, whole)) in both(&scene).iter().zip(&both(&one_index(scene.clone()))) {
        assert!(divided.rays.total() > 4 * whole.rays.total());
    }
}

/// The wavelengths behind a window leave in parallel and stay apart.
#[test]
fn behind_a_slab_wavelengths_are_parallel_and_as_far_apart_as_snell_has_them() {
    let curve = named("sf11");
    let bands = Bands::new(BANDS, 0.5);
    let n: Vec<f64> = bands.nm.iter().map(|&nm| curve.index_at(nm).expect("a curve")).collect();
    let sin_i = 0.5_f64.sqrt();
    let sin_t = |n: f64| sin_i / n;
    let passes = |n: f64| (1.0 - fresnel(1.0, n, sin_i)) * (1.0 - fresnel(n, 1.0, sin_t(n)));
    // A slab of thickness 1 below z = 0; the ray falls on it in the middle, under 45 degrees.
    let slab_scene = || {
        let mut scene = dark();
        scene.settings.max_depth = 2;
        let glass = dispersing(&mut scene, curve);
        add(&mut scene, Shape::Mesh(cuboid_mesh(Vec3::new(-9.0, -9.0, -1.0), Vec3::new(9.0, 9.0, 0.0))), glass);
        let dir = DVec3::new(sin_i, 0.0, -sin_i);
        look(&mut scene, DVec3::new(0.1, 0.2, 0.0) - dir * 2.0, dir);
        scene
    };
    // Where each is two units below: the shift inside, and 45 degrees again.
    let at: Vec<f64> = n.iter().map(|&n| 0.1 + sin_t(n) / (1.0 - sin_t(n).powi(2)).sqrt() + 2.0).collect();
    assert!((0.019..0.02).contains(&(at[7] - at[0])), "{at:?}");
    // A sheet of light from there on where half of them arrive.
    let mut scene = slab_scene();
    let edge = 0.5 * (at[3] + at[4]) as f32;
    let lamp = emitter(&mut scene, 1.0);
    let sheet = cuboid_mesh(Vec3::new(edge, -9.0, -3.0002), Vec3::new(9.0, 9.0, -3.0));
    add(&mut scene, Shape::Mesh(sheet), lamp);
    let want: DVec3 = (4..8).map(|k| weight(&bands, k) * passes(n[k])).sum();
    for (renderer, outcome) in both(&scene) {
        close(&format!("{renderer}, an edge"), outcome.film.at(0, 0), want, 4e-6);
        // There, reflected, in by eight, and on and back by eight each.
        assert_eq!(outcome.rays.total(), 1 + 1 + 8 + 16);
    }
    // A small lamp so far off that only parallel light meets it all.
    let mut scene = slab_scene();
    let lamp = emitter(&mut scene, 1.0);
    let middle = 0.5 * (at[0] + at[7]);
    sphere(&mut scene, Vec3::new((middle + 1000.0) as f32, 0.2, -1003.0), 0.05, lamp);
    let want: DVec3 = (0..8).map(|k| weight(&bands, k) * passes(n[k])).sum();
    for (renderer, outcome) in both(&scene) {
        close(&format!("{renderer}, far away"), outcome.film.at(0, 0), want, 4e-6);
    }
}

#[test]
fn in_a_white_room_a_clear_prism_and_ball_are_as_white_as_the_room() {
    for cutoff in [0.0, 1e-2] {
        let mut scene = empty(1.0);
        (scene.settings.width, scene.settings.height) = (8, 8);
        (scene.settings.max_depth, scene.settings.cutoff, scene.settings.wavelengths) = (9, cutoff, BANDS);
        let sf11 = dispersing(&mut scene, named("sf11"));
        let diamond = dispersing(&mut scene, named("diamond"));
        add(&mut scene, prism(), sf11);
        sphere(&mut scene, Vec3::new(0.9, 0.7, 0.1), 0.45, diamond);
        for (renderer, outcome) in both(&scene) {
            let mut lost = 0.0_f32;
            for (seen, cut) in outcome.film.pixels.iter().zip(&outcome.truncated.pixels) {
                let sum: [f32; 3] = std::array::from_fn(|c| seen[c] + cut[c]);
                close(renderer, sum, DVec3::ONE, 4e-6);
                lost = lost.max(cut[1]);
            }
            assert!(lost > 0.0, "some of it was cut, and is accounted for");
        }
    }
}

#[test]
fn a_negative_channel_does_not_let_a_wavelength_end_early() {
    // Behind a filter that passes red alone, what is left of cyan is below zero in every channel that is left.
    let mut scene = prism_scene(named("flint"), 55.0);
    scene.environment = Environment::Constant(Rgb::ONE);
    if let Interface::Dielectric { tint, .. } = &mut scene.materials[0].interface {
        *tint = Rgb::X;
    }
    scene.settings.cutoff = 1e-4;
    let bands = Bands::new(BANDS, 0.5);
    assert!(bands.weight.iter().any(|w| w[0] < -0.01));
    let want: f64 = (0..bands.nm.len())
        .map(|k| {
            let n = named("flint").index_at(bands.nm[k]).expect("a curve");
            let (_, _, passes) = through_the_prism(n, 55.0).expect("it passes");
            weight(&bands, k).x * passes
        })
        .sum();
    let first = (0..bands.nm.len()).map(|k| {
        let n = named("flint").index_at(bands.nm[k]).expect("a curve");
        weight(&bands, k) * fresnel(1.0, n, 55_f64.to_radians().sin())
    });
    let want = DVec3::X * want + first.sum::<DVec3>();
    for (renderer, outcome) in both(&scene) {
        close(renderer, outcome.film.at(0, 0), want, 4e-6);
    }
}

#[test]
fn light_that_has_a_wavelength_meets_shadows_and_coats_with_its_own_index() {
    // A white floor under a half space of flint, lit from straight above: on the way down the lamp's light crosses the
    // surface at the index of the ray that asks.
    let curve = named("sf11");
    let bands = Bands::new(BANDS, 0.5);
    let mut scene = dark();
    let glass = dispersing(&mut scene, curve);
    plane(&mut scene, Vec3::ZERO, Vec3::Y, glass);
    let floor = material(&mut scene, Material::default());
    plane(&mut scene, Vec3::Y * -1.0, Vec3::Y, floor);
    let kind = LightKind::Directional { direction: -Vec3::Y };
    let light = Light { name: "sun".into(), kind, intensity: Rgb::ONE, falloff: Falloff::None, shadows: true };
    scene.lights.push(light);
    scene.settings.max_depth = 1;
    look(&mut scene, DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.6, -0.8, 0.0));
    let want: DVec3 = (0..bands.nm.len())
        .map(|k| {
            let n = curve.index_at(bands.nm[k]).expect("a curve");
            weight(&bands, k) * (1.0 - fresnel(1.0, n, 0.6)) * 0.5 * (1.0 - fresnel(1.0, n, 0.0))
        })
        .sum();
    for (renderer, outcome) in both(&scene) {
        close(renderer, outcome.film.at(0, 0), want, 2e-6);
    }
}

/// Prism and ball before a checkered wall, lit, with everything on.
fn still_life() -> Scene {
    let mut scene = empty(0.1);
    (scene.settings.width, scene.settings.height, scene.settings.wavelengths) = (64, 48, 7);
    (scene.settings.max_depth, scene.settings.cutoff) = (8, 1e-3);
    (scene.camera.eye, scene.camera.target) = (Vec3::new(-3.5, 1.3, 4.0), Vec3::new(0.3, 0.5, 0.0));
    let sf11 = dispersing(&mut scene, named("sf11"));
    let diamond = dispersing(&mut scene, named("diamond"));
    let wall = material(&mut scene, Material::default());
    plane(&mut scene, Vec3::new(2.0, 0.0, -3.0), Vec3::new(-1.0, 0.0, 1.0).normalize(), wall);
    let lamp = emitter(&mut scene, 0.9);
    add(&mut scene, prism(), sf11);
    sphere(&mut scene, Vec3::new(0.8, 0.9, 0.3), 0.35, diamond);
    let bar = cuboid_mesh(Vec3::new(1.5, -2.0, -2.9), Vec3::new(1.7, 3.0, -2.7));
    add(&mut scene, Shape::Mesh(bar), lamp);
    let bar = cuboid_mesh(Vec3::new(2.3, -2.0, -1.9), Vec3::new(2.5, 3.0, -1.7));
    add(&mut scene, Shape::Mesh(bar), lamp);
    let kind = LightKind::Point { position: Vec3::new(1.0, 4.0, 3.0) };
    let light = Light { name: "lamp".into(), kind, intensity: Rgb::ONE, falloff: Falloff::None, shadows: true };
    scene.lights.push(light);
    scene
}

#[test]
fn both_renderers_make_the_same_picture_of_prism_and_diamond() {
    const TOLERANCE: f64 = 5e-4;
    let scene = still_life();
    let [(_, reference), (_, native)] = both(&scene);
    let prepared = Prepared::new(&scene, FresnelModel::Exact);
    let (mut apart, mut unexplained) = (0, Vec::new());
    for y in 0..48 {
        for x in 0..64 {
            let (ours, theirs) = (native.film.at(x, y), reference.film.at(x, y));
            if ours.iter().zip(theirs).any(|(a, b)| f64::from((a - b).abs()) > TOLERANCE) {
                apart += 1;
                if prepared.ulps_until_moved(f64::from(x) + 0.5, f64::from(y) + 0.5, TOLERANCE, 64.0).is_none() {
                    unexplained.push((x, y, ours, theirs));
                }
            }
        }
    }
    println!("{apart} of 3072 pixels apart");
    let n = unexplained.len();
    unexplained.truncate(5);
    assert!(apart < 40 && n == 0, "{apart} apart, {n} unexplained, among them {unexplained:?}");
    let coloured = native.film.pixels.iter().filter(|p| (p[0] - p[2]).abs() > 0.05).count();
    assert!(coloured > 5, "{coloured} pixels with colour in a scene without any but the spectrum's");
}

#[test]
fn the_picture_depends_neither_on_threads_nor_on_tiles() {
    let mut scene = still_life();
    scene.settings.samples = 2;
    let of = |threads, tile| {
        let outcome = native(&scene, &Options { threads, tile, ..Options::default() });
        (outcome.film, outcome.truncated, outcome.rays.total())
    };
    let first = of(1, 32);
    for (threads, tile) in [(1, 8), (3, 16), (2, 64), (4, 5)] {
        assert!(of(threads, tile) == first, "{threads} threads, tiles of {tile}");
    }
}
