//! Writes depth, normal and object of what each pixel shows, as guides for a denoiser or a mask: one file each.
//!
//!     cargo run --release --example depth_and_normals -- scenes/glass.toml folder

use std::path::{Path, PathBuf};

use vitrum::accel::{Accel, Backend, BuildOptions};
use vitrum::image::{Film, save};
use vitrum::load::{self, LoadOptions};
use vitrum::render::{FirstHit, first_hits};
use vitrum::scene::Scene;

fn main() -> vitrum::Result<()> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let file = arguments.next().unwrap_or_else(|| PathBuf::from("scenes/glass.toml"));
    let folder = arguments.next().unwrap_or_default();
    let scene = load::scene(&file, &LoadOptions::default())?.scene;
    write(&scene, &folder)
}

/// Writes `depth.pfm`, `normal.pfm` and `object.pfm` into a folder.
pub fn write(scene: &Scene, folder: &Path) -> vitrum::Result<()> {
    let accel = Accel::build(Backend::Native, &scene.geometry, BuildOptions::default())?;
    let hits = first_hits(scene, &accel)?;
    let film = |value: fn(&FirstHit) -> [f32; 3]| Film {
        width: scene.settings.width,
        height: scene.settings.height,
        pixels: hits.iter().map(value).collect(),
    };
    save(&film(|hit| [hit.depth; 3]), &folder.join("depth.pfm"))?;
    save(&film(|hit| hit.shading_normal.to_array()), &folder.join("normal.pfm"))?;
    // Objects count from 1; 0 is where nothing is.
    save(&film(|hit| [hit.object.map_or(0.0, |object| object as f32 + 1.0); 3]), &folder.join("object.pfm"))
}
