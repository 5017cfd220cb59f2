//! A render simulates what its scene calls for, says why, and makes the same picture by code that knows everything.

use crate::support;

mod bound;
#[cfg(feature = "cli")]
mod command;
mod pipelines;
mod reach;
mod reasons;
mod stages;

use std::path::{Path, PathBuf};

use glam::Vec3;
use support::scenes::{bare, native};
use vitrum::effects::{self, EffectSet, Pipeline};
use vitrum::load;
use vitrum::render::{Options, Outcome};
use vitrum::scene::{Falloff, Interface, Light, LightKind, Material, MirrorSource, Rgb, Scene};

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
