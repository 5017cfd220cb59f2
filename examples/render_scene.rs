//! Renders a scene that is put together by code: a glass ball on a chequered floor under a lamp.
//!
//!     cargo run --release --example render_scene -- ball.png

use std::path::PathBuf;

use vitrum::accel::{Accel, Backend, BuildOptions};
use vitrum::geometry::{Plane, Sphere};
use vitrum::glam::Vec3;
use vitrum::image::{Film, save};
use vitrum::render::{Observer, Options, render};
use vitrum::scene::{
    Camera, Colour, Environment, Falloff, Light, LightKind, Material, Medium, Rgb, Scene, SceneError, Settings,
};

fn main() -> vitrum::Result<()> {
    let path = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("ball.png"), PathBuf::from);
    save(&picture(320, 240)?, &path)?;
    println!("wrote {}", path.display());
    Ok(())
}

/// The scene. Each `add_` method returns the index that others refer to.
pub fn scene(width: u32, height: u32) -> Result<Scene, SceneError> {
    let mut scene = Scene {
        camera: Camera { eye: Vec3::new(0.0, 1.4, 4.0), target: Vec3::new(0.0, 0.6, 0.0), ..Camera::default() },
        environment: Environment::Constant(Rgb::new(0.4, 0.5, 0.7)),
        settings: Settings { width, height, samples: 2, ..Settings::default() },
        ..Scene::default()
    };
    let squares =
        Colour::Checker { even: Rgb::splat(0.7), odd: Rgb::splat(0.1), size: 0.5, offset: Vec3::new(0.0, -0.25, 0.0) };
    let floor = scene.add_material(Material { diffuse: squares, ..Material::default() });
    let glass = scene.add_dielectric(Medium { absorption: Rgb::new(0.4, 0.1, 0.2), ..Medium::new("glass", 1.52) });
    scene.add_object("floor", Plane { point: Vec3::ZERO, normal: Vec3::Y }, floor);
    scene.add_object("ball", Sphere { centre: Vec3::new(0.0, 0.75, 0.0), radius: 0.7 }, glass);
    scene.add_light(Light {
        name: "lamp".into(),
        kind: LightKind::Point { position: Vec3::new(2.0, 4.0, 2.0) },
        intensity: Rgb::splat(40.0),
        falloff: Falloff::InverseSquare,
        shadows: true,
    });
    scene.validate()?;
    Ok(scene)
}

/// The picture of the scene: `film.pixels` is an array of linear red, green and blue.
pub fn picture(width: u32, height: u32) -> vitrum::Result<Film> {
    let scene = scene(width, height)?;
    let accel = Accel::build(Backend::Native, &scene.geometry, BuildOptions::default())?;
    Ok(render(&scene, &accel, &Options::default(), &Observer::default())?.film)
}
