//! Size of a study's pictures, as large as its time limit allows.

use super::engine::Engine;
use super::reference;
use super::subject::Subject;
use crate::Result;
use crate::render::Observer;
use crate::scene::{Scene, Settings};

/// Largest size chosen, in pixels.
const MOST: f64 = 320.0 * 240.0;

/// Smallest size, in pixels; fewer would be meaningless for any time limit.
const LEAST: f64 = 48.0 * 32.0;

/// Numbers of pixels of the pictures that costs are estimated from.
const PROBE: [f64; 2] = [4800.0, 600.0];

/// Number of default pictures that a session should have time for.
const PICTURES: f64 = 1000.0;

/// Share of a session that the reference may take.
const REFERENCE: f64 = 0.1;

/// Returns the requested columns and rows, or as many as the time limit allows, in the scene's aspect ratio.
///
/// # Errors
/// - `Error::Interrupted` if the observer requests a stop.
/// - `Error::Limit` if the default back end is not available.
pub fn choose(subject: &Subject, observer: &Observer) -> Result<[u32; 2]> {
    if let Some(size) = subject.size {
        return Ok(size);
    }
    let settings = &subject.scene.settings;
    let exact = reference::most_exact(&subject.default, subject.scene);
    let [fast, slow] = PROBE.map(|pixels| fit(settings, pixels));
    let cost = |size: [u32; 2], variant, runs: usize| {
        let mut scene = Scene::clone(subject.scene);
        [scene.settings.width, scene.settings.height] = size;
        let mut engine = Engine::new(&scene, subject.threads);
        let mut seconds = f64::INFINITY;
        for _ in 0..runs {
            seconds = engine.shoot(variant, observer)?.seconds.min(seconds);
        }
        Ok::<f64, crate::Error>(seconds / (f64::from(size[0]) * f64::from(size[1])))
    };
    let limit = subject.limit.as_secs_f64();
    let by_default = limit / PICTURES / cost(fast, &subject.default, 3)?;
    let by_reference = limit * REFERENCE / cost(slow, &exact, 1)?;
    let own = f64::from(settings.width) * f64::from(settings.height);
    Ok(fit(settings, by_default.min(by_reference).clamp(LEAST, MOST).min(own)))
}

/// Returns the size with about `pixels` pixels in the aspect ratio of a picture.
pub(super) fn fit(settings: &Settings, pixels: f64) -> [u32; 2] {
    let (width, height) = (f64::from(settings.width), f64::from(settings.height));
    let scale = (pixels / (width * height)).sqrt().min(1.0);
    [width, height].map(|edge| (edge * scale).round().max(1.0) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_shrinks_in_its_own_shape() {
        let settings = Settings { width: 1920, height: 1080, ..Settings::default() };
        assert_eq!(fit(&settings, 320.0 * 180.0), [320, 180]);
        let small = Settings { width: 40, height: 30, ..Settings::default() };
        assert_eq!(fit(&small, MOST), [40, 30], "never larger than the scene's own");
    }
}
