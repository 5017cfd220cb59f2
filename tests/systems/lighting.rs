//! The reflection model of the lighting slides, with numbers by hand. The slides' own examples give titles and no numbers.

use glam::Vec3;
use vitrum::geometry::{Shape, TriMesh};
use vitrum::render::Options;
use vitrum::scene::{
    Colour, Falloff, Highlight, HighlightModel, Interface, Light, LightKind, Material, Projection, Rgb, Scene,
};

use super::outcomes;
use crate::support::scenes::{add, bare, empty, material};

/// A triangle without normals across (0, 0, 1), around `middle`; its corners run counter-clockwise as seen from +z.
fn triangle(middle: Vec3) -> Shape {
    let corners = [Vec3::new(-2.0, -1.0, 0.0), Vec3::new(2.0, -1.0, 0.0), Vec3::new(0.0, 3.0, 0.0)];
    Shape::Mesh(TriMesh::new(corners.map(|p| p + middle).to_vec(), vec![[0, 1, 2]]))
}

/// The triangle with `surface` under light of (1, 0.5, 0.25) that comes from (3, 0, 4) / 5, seen along `view` in one pixel.
fn scene(middle: Vec3, surface: Material, view: Vec3) -> Scene {
    let mut scene = empty(0.0);
    (scene.settings.width, scene.settings.height, scene.settings.samples) = (1, 1, 1);
    scene.camera.projection = Projection::Orthographic { height: 0.01 };
    (scene.camera.eye, scene.camera.target) = (middle - view * 10.0, middle);
    let number = material(&mut scene, surface);
    add(&mut scene, triangle(middle), number);
    scene.ambient = Rgb::new(0.5, 0.5, 1.0);
    scene.lights.push(Light {
        name: String::from("lamp"),
        kind: LightKind::Directional { direction: Vec3::new(-0.6, 0.0, -0.8) },
        intensity: Rgb::new(1.0, 0.5, 0.25),
        falloff: Falloff::None,
        shadows: true,
    });
    scene
}

fn close(scene: &Scene, want: [f32; 3]) {
    for (name, outcome) in outcomes(scene, &Options::default()) {
        let seen = outcome.film.pixels[0];
        let off = (0..3).map(|c| (seen[c] - want[c]).abs()).fold(0.0, f32::max);
        assert!(off < 2e-6, "{name}: {seen:?} for {want:?}");
    }
}

fn phong(colour: f32, exponent: f32) -> Option<Highlight> {
    Some(Highlight { colour: Rgb::splat(colour), exponent, model: HighlightModel::Phong })
}

/// Unit direction of a view that looks down along the mirror direction of the light, (-3, 0, 4) / 5.
const INTO_MIRROR: Vec3 = Vec3::new(0.6, 0.0, -0.8);

#[test]
fn ambient_light_is_its_coefficient_times_the_scenes() {
    let surface = Material { ambient: Rgb::new(0.2, 0.4, 0.6), ..bare(Interface::Opaque) };
    close(&scene(Vec3::ZERO, surface, Vec3::NEG_Z), [0.1, 0.2, 0.6]);
}

#[test]
fn diffuse_light_is_its_coefficient_times_the_cosine_and_the_same_from_all_sides() {
    let surface = Material { diffuse: Colour::Constant(Rgb::new(0.5, 1.0, 0.4)), ..bare(Interface::Opaque) };
    for view in [Vec3::NEG_Z, INTO_MIRROR, Vec3::new(0.0, 0.28, -0.96)] {
        // n . l = 0.8.
        close(&scene(Vec3::ZERO, surface.clone(), view), [0.4, 0.4, 0.08]);
    }
}

#[test]
fn specular_light_is_its_coefficient_times_the_cosine_to_the_mirror_direction_raised_to_the_exponent() {
    for (view, cos) in [(INTO_MIRROR, 1.0_f32), (Vec3::NEG_Z, 0.8), (Vec3::new(-0.6, 0.0, -0.8), 0.28)] {
        for exponent in [1.0, 2.0, 8.0] {
            let surface = Material { highlight: phong(0.5, exponent), ..bare(Interface::Opaque) };
            let want = 0.5 * cos.powf(exponent);
            close(&scene(Vec3::ZERO, surface, view), [want, 0.5 * want, 0.25 * want]);
        }
    }
}

#[test]
fn the_complete_model_is_the_sum_and_does_not_depend_on_the_place() {
    // Seen straight on: 0.2 * 0.5 + 1 * (0.5 * 0.8 + 0.3 * 0.8^2) = 0.692 of red, and so on.
    let surface = Material {
        ambient: Rgb::splat(0.2),
        diffuse: Colour::Constant(Rgb::splat(0.5)),
        highlight: phong(0.3, 2.0),
        ..bare(Interface::Opaque)
    };
    for middle in [Vec3::ZERO, Vec3::new(7.0, -3.0, 2.0)] {
        close(&scene(middle, surface.clone(), Vec3::NEG_Z), [0.692, 0.396, 0.348]);
    }
}

#[test]
fn light_from_behind_gives_nothing_but_ambient_light() {
    let surface = Material {
        ambient: Rgb::splat(0.2),
        diffuse: Colour::Constant(Rgb::splat(0.5)),
        highlight: phong(0.3, 2.0),
        ..bare(Interface::Opaque)
    };
    let mut scene = scene(Vec3::ZERO, surface, Vec3::NEG_Z);
    scene.lights[0].kind = LightKind::Directional { direction: Vec3::new(-0.6, 0.0, 0.8) };
    close(&scene, [0.1, 0.1, 0.2]);
}
