//! Notices of a scene for commands that render no picture.

use std::path::Path;
use std::sync::atomic::Ordering;

use super::facts::Facts;
use super::notice::Notice;
use super::{of_picture, of_scene};
use crate::Result;
use crate::accel::{Accel, Backend, BuildOptions};
use crate::effects;
use crate::load::LoadReport;
use crate::render::{Observer, Options, Pixels, Shortfall};
use crate::scene::{Scene, Settings};

/// Largest number of pixels along each side of the first picture.
const FIRST_LOOK: u32 = 96;

/// Returns the notices that a render of `scene` would report, with the scene's own settings and no effect left out.
///
/// First renders a small picture with one ray per pixel. If a check finds something in it, renders the whole picture,
/// whose findings count. The native back end renders both. The scene is returned unchanged.
///
/// # Errors
/// Fails as [`crate::render::render`] does.
pub fn survey(
    file: &Path,
    scene: &mut Scene,
    report: &LoadReport,
    options: &Options,
    observer: &Observer,
) -> Result<Vec<Notice>> {
    let options = Options { effects: effects::Options::default(), ..options.clone() };
    let accel = Accel::build(Backend::Native, &scene.geometry, BuildOptions::default())?;
    // One scene in two sizes: contacts are searched for once.
    let pixels = Pixels::new(&accel, &options, observer);
    let look = |scene: &Scene| -> Result<Vec<Notice>> {
        let mut outcome = pixels.picture(scene)?;
        let again = |scene: &Scene, which: &[[u32; 2]]| pixels.render(scene, which);
        outcome.shortfall = Shortfall::of(scene, &options, &outcome, 1.0, &again)?;
        Ok(of_picture(&Facts { file, scene, report, options: &options }, &outcome))
    };
    let mut notices = of_scene(&Facts { file, scene, report, options: &options });
    let whole = scene.settings.clone();
    scene.settings = first_look(&whole);
    let first = look(scene);
    scene.settings = whole;
    if !first?.is_empty() {
        notices.extend(look(scene)?);
    }
    observer.pixels_done.store(0, Ordering::Relaxed);
    Ok(notices)
}

/// Returns the settings of a picture of the same shape with few pixels.
fn first_look(settings: &Settings) -> Settings {
    let edge = settings.width.max(settings.height).max(1);
    let scaled = |x: u32| (u64::from(x) * u64::from(FIRST_LOOK.min(edge)) / u64::from(edge)).max(1) as u32;
    Settings { width: scaled(settings.width), height: scaled(settings.height), samples: 1, ..settings.clone() }
}
