//! Polarisation along whole paths, in pictures.

use glam::{DVec3, Vec3};
use vitrum::geometry::{Shape, TriMesh};
use vitrum::optics::{Boundary, FresnelModel, polarised};
use vitrum::render::Options;
use vitrum::scene::{
    Camera, Colour, Falloff, FresnelRule, Interface, Light, LightKind, Material, Projection, Rgb, Scene,
};

use super::{outcomes, random};
use crate::support::scenes::{add, bare, cuboid, empty, glass, material, plane, sphere};

fn options(fresnel: FresnelModel) -> Options {
    Options { fresnel, ..Options::default() }
}

/// A square of edge 1 around `centre`.
fn square(centre: DVec3, normal: DVec3) -> Shape {
    let (x, y) = normal.any_orthonormal_pair();
    let corner = |a: f64, b: f64| (centre + x * (a * 0.5) + y * (b * 0.5)).as_vec3();
    let positions = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let triangles = if x.cross(y).dot(normal) > 0.0 { [[0, 1, 2], [0, 2, 3]] } else { [[0, 2, 1], [0, 3, 2]] };
    Shape::Mesh(TriMesh { positions, triangles: triangles.to_vec(), ..TriMesh::default() })
}

/// The normal of a mirror that turns light coming along `dir` by reflecting it at `angle`, in the plane turned by
/// `azimuth` about `dir`.
fn mirror_at(dir: DVec3, angle: f64, azimuth: f64) -> DVec3 {
    let (x, y) = dir.any_orthonormal_pair();
    -dir * angle.cos() + (x * azimuth.cos() + y * azimuth.sin()) * angle.sin()
}

/// One pixel that looks along +x at a coated black plate, off which it sees another, and off that the light of 1.
fn two_plates(angle: f64, azimuth: f64) -> Scene {
    let mut scene = empty(1.0);
    scene.camera = Camera {
        eye: Vec3::new(-5.0, 0.0, 0.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        projection: Projection::Orthographic { height: 1e-3 },
        medium: None,
    };
    (scene.settings.width, scene.settings.height) = (1, 1);
    let coat = material(&mut scene, bare(Interface::Coated { ior: 1.5 }));
    let first = mirror_at(DVec3::X, angle, 0.3);
    let onwards = DVec3::X - first * (2.0 * first.x);
    // The plane of the second is counted from that of the first.
    let across = DVec3::X.cross(first).normalize();
    let (x, y) = onwards.any_orthonormal_pair();
    let in_plane = across.cross(onwards);
    let second = mirror_at(onwards, angle, azimuth + in_plane.dot(y).atan2(in_plane.dot(x)));
    add(&mut scene, square(DVec3::ZERO, first), coat);
    add(&mut scene, square(onwards * 7.0, second), coat);
    scene
}

fn pixel(scene: &Scene, fresnel: FresnelModel) -> Vec<(&'static str, f64)> {
    let first = |film: &vitrum::image::Film| f64::from(film.at(0, 0)[1]);
    outcomes(scene, &options(fresnel)).iter().map(|(name, o)| (*name, first(&o.film))).collect()
}

#[test]
fn two_plates_at_brewsters_angle_follow_malus_down_to_black() {
    let brewster = 1.5_f64.atan();
    let r_s = (1.25_f64 / 3.25).powi(2);
    for i in 0..=18 {
        let azimuth = f64::to_radians(f64::from(i) * 10.0);
        let want = 0.5 * r_s * r_s * azimuth.cos().powi(2);
        let scene = two_plates(brewster, azimuth);
        for (name, got) in pixel(&scene, FresnelModel::Polarised) {
            assert!((got - want).abs() < 2e-7, "{name} at {} degrees: {got}, not {want}", i * 10);
        }
        // Whoever forgets what the first plate did sees the same at every angle.
        for (name, got) in pixel(&scene, FresnelModel::Exact) {
            assert!((got - 0.25 * r_s * r_s).abs() < 2e-7, "{name}: {got}");
        }
    }
}

#[test]
fn at_any_angle_aligned_and_crossed_plates_are_the_products_of_their_parts() {
    for degrees in [6.0_f64, 20.0, 45.0, 70.0, 80.0] {
        let angle = degrees.to_radians();
        let boundary = Boundary::<f64>::new(1.0, 1.5);
        let r = polarised(&boundary, &boundary.cross(angle.cos()));
        let aligned = 0.5 * (r.s * r.s + r.p * r.p);
        let crossed = r.s * r.p;
        for (azimuth, want) in [(0.0, aligned), (90.0, crossed), (180.0, aligned)] {
            let scene = two_plates(angle, f64::to_radians(azimuth));
            for (name, got) in pixel(&scene, FresnelModel::Polarised) {
                assert!((got - want).abs() < 3e-7, "{name}, {degrees} and {azimuth} degrees: {got}, not {want}");
            }
        }
    }
}

#[test]
fn light_between_two_panes_on_its_way_to_a_surface_is_polarised_by_the_first() {
    let mut scene = empty(0.0);
    scene.camera = Camera {
        eye: Vec3::new(0.0, -0.5, 0.0),
        target: Vec3::new(0.0, -1.0, 0.0),
        up: Vec3::Z,
        projection: Projection::Orthographic { height: 1e-3 },
        medium: None,
    };
    (scene.settings.width, scene.settings.height) = (1, 1);
    let white = Material { diffuse: Colour::Constant(Rgb::ONE), ..Material::default() };
    let white = material(&mut scene, white);
    plane(&mut scene, Vec3::new(0.0, -1.0, 0.0), Vec3::Y, white);
    let pane = Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fresnel, tint: Rgb::ONE };
    let pane = material(&mut scene, bare(pane));
    for height in [1.0, 2.0] {
        plane(&mut scene, Vec3::new(0.0, height, 0.0), Vec3::Y, pane);
    }
    let angle = f64::to_radians(70.0);
    scene.lights.push(Light {
        name: String::from("sun"),
        kind: LightKind::Directional { direction: Vec3::new(angle.sin() as f32, -(angle.cos() as f32), 0.0) },
        intensity: Rgb::ONE,
        falloff: Falloff::None,
        shadows: true,
    });
    let boundary = Boundary::<f64>::new(1.0, 1.5);
    let r = polarised(&boundary, &boundary.cross(angle.cos()));
    let [t_s, t_p] = [r.s, r.p].map(|r| 1.0 - 2.0 * r / (1.0 + r));
    let want = angle.cos() * 0.5 * (t_s * t_s + t_p * t_p);
    for (name, got) in pixel(&scene, FresnelModel::Polarised) {
        assert!((got - want).abs() < 3e-7, "{name}: {got}, not {want}");
    }
    let mean = 0.5 * (t_s + t_p);
    for (name, got) in pixel(&scene, FresnelModel::Exact) {
        assert!((got - want).abs() > 0.01 && got < angle.cos() * (mean * mean + 0.01), "{name}: {got}");
    }
}

#[test]
fn one_bounce_and_what_depolarises_see_no_difference() {
    // A coat over an even wall of light: one bounce, then an environment; and a mirror before it, which does nothing.
    let mut scene = empty(1.0);
    let coat = Material { interface: Interface::Coated { ior: 1.5 }, ..Material::default() };
    let coat = material(&mut scene, coat);
    sphere(&mut scene, Vec3::ZERO, 1.0, coat);
    scene.ambient = Rgb::ONE;
    let exact = outcomes(&scene, &options(FresnelModel::Exact));
    for ((name, by_polarised), (_, by_exact)) in outcomes(&scene, &options(FresnelModel::Polarised)).iter().zip(&exact)
    {
        for (a, b) in by_polarised.film.pixels.iter().zip(&by_exact.film.pixels) {
            assert!((0..3).all(|c| (a[c] - b[c]).abs() < 1e-6), "{name}: {a:?} {b:?}");
        }
    }
}

#[test]
fn lossless_glass_stays_invisible_and_nothing_is_lost_of_either_polarisation() {
    let mut scene = empty(1.0);
    let crown = glass(&mut scene, 1.5, 0, Rgb::ZERO);
    let diamond = glass(&mut scene, 2.417, 5, Rgb::ZERO);
    sphere(&mut scene, Vec3::new(-0.6, 0.0, 0.0), 0.7, crown);
    cuboid(&mut scene, Vec3::new(0.1, -0.9, -0.3), Vec3::new(0.9, -0.1, 0.5), diamond);
    scene.settings.cutoff = 1e-4;
    for (name, outcome) in outcomes(&scene, &options(FresnelModel::Polarised)) {
        for (seen, lost) in outcome.film.pixels.iter().zip(&outcome.truncated.pixels) {
            assert!((seen[0] + lost[0] - 1.0).abs() <= 1e-5, "{name}: {} seen, {} lost", seen[0], lost[0]);
        }
    }
}

#[test]
fn both_renderers_agree_on_random_scenes_where_polarisation_matters() {
    let mut apart = 0;
    for seed in 0..6 {
        let mut scene = random::scene(seed);
        scene.settings.cutoff = 1e-4;
        let exact = &outcomes(&scene, &options(FresnelModel::Exact))[0].1.film;
        let all = outcomes(&scene, &options(FresnelModel::Polarised));
        let by_reference = &all[0].1.film;
        let far = |a: &[f32; 3], b: &[f32; 3], most: f32| (0..3).any(|c| (a[c] - b[c]).abs() > most);
        apart += by_reference.pixels.iter().zip(&exact.pixels).filter(|(a, b)| far(a, b, 2e-3)).count();
        for (name, outcome) in &all[1..] {
            let off = outcome.film.pixels.iter().zip(&by_reference.pixels).filter(|(a, b)| far(a, b, 1e-3)).count();
            // Edges and checks seen through glass fall to one side or the other.
            assert!(off <= 12, "{name}, scene {seed}: {off} pixels of 576");
        }
    }
    assert!(apart > 50, "only {apart} pixels show polarisation");
}
