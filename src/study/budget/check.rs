//! A picture held against `f64` at a sample of its own pixels.

use rayon::prelude::*;
use serde::Serialize;

use crate::Result;
use crate::image::Film;
use crate::render::Observer;
use crate::render::reference::{Prepared, Tally};
use crate::scene::Scene;
use crate::study::condition::Condition;
use crate::study::errors::off;
use crate::study::reference;
use crate::study::variant::Variant;

/// Pixels that are asked, at most.
const ASKED: usize = 512;

/// What the sample came to.
#[derive(Clone, Debug, Serialize)]
pub struct Check {
    /// Pixels asked.
    pub asked: usize,
    /// The picture they are held against.
    pub reference: String,
    /// The most that a channel may be off.
    pub bound: f64,
    /// Pixels within the bound at which the reference itself may be off by more: by the light that its depth limit and
    /// cut-off took, or by the rounding of the picture's `f32`.
    pub undecided: usize,
    /// The largest difference of a pixel that is not known to be ill-conditioned.
    pub worst: f64,
    /// Pixels beyond the bound.
    pub beyond: usize,
    /// Whether these were asked for their condition; where not, the two lists below are empty.
    pub examined: bool,
    /// Pixels beyond the bound that are ill-conditioned, each with what shows it.
    pub ill: Vec<Beyond>,
    /// Pixels beyond the bound without such an excuse.
    pub wrong: Vec<Beyond>,
}

/// A pixel beyond the bound.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Beyond {
    /// Column from the left.
    pub x: u32,
    /// Row from the top.
    pub y: u32,
    /// How far it is off.
    pub off: f64,
    /// Its `f64` value itself moves by more than the bound when its camera rays move by so many ulps of `f32`.
    pub moves_at_ulps: Option<f64>,
}

/// Largest relative error of a value rounded to `f32`.
const HALF_AN_ULP: f64 = f32::EPSILON as f64 / 2.0;

/// A pixel of the sample.
struct Asked {
    pixel: Beyond,
    /// Largest channel of the reference.
    bright: f64,
    /// Largest weight that the reference's limits took of a channel.
    cut: f64,
}

impl Check {
    /// Returns true if the pixels that the reference leaves undecided are few enough for the rest to speak for the
    /// picture: one in a hundred.
    #[must_use]
    pub fn can_show(&self) -> bool {
        self.undecided * 100 <= self.asked
    }

    /// Returns true if the sample shows that the picture keeps the bound: no pixel is wrong, and those that are excused
    /// for their condition are at most one in twenty. Below some bound every pixel in `f32` has that excuse.
    #[must_use]
    pub fn shows_it_kept(&self) -> bool {
        self.wrong.is_empty() && self.ill.len() * 20 <= self.asked && self.can_show()
    }
}

/// Holds `film`, a picture of `scene` by whatever choices, against the best reference that the scene supports
/// ([`reference::most_exact`]): at all its pixels where they are few, else at a sample that covers it evenly (the R2
/// sequence of Roberts 2018). Lamps with an extent and wavelengths are sampled as in the picture. Only where `examined`
/// are pixels beyond the bound asked for their condition, which takes a hundred times as long as their value.
///
/// # Errors
/// `Interrupted`.
pub fn check(
    scene: &Scene,
    film: &Film,
    default: &Variant,
    bound: f64,
    examined: bool,
    observer: &Observer,
) -> Result<Check> {
    let exact = reference::most_exact(default, scene);
    let judge = Scene { settings: exact.settings(&scene.settings), ..scene.clone() };
    let prepared = Prepared::new(&judge, exact.fresnel);
    let condition = Condition::new(&judge, prepared, bound, observer);
    let pixels = sample(film.width, film.height);
    let ask = |&(x, y): &(u32, u32)| {
        if observer.stop.load(std::sync::atomic::Ordering::Relaxed) {
            return Err(crate::Error::Interrupted);
        }
        let Tally { radiance, truncated, .. } = condition.exact(x, y);
        let off = off(film.at(x, y), radiance.as_vec3().to_array());
        let moves_at_ulps = if examined && off > bound { condition.moves_at(x, y) } else { None };
        let [bright, cut] = [radiance, truncated].map(|channels| channels.abs().max_element());
        Ok(Asked { pixel: Beyond { x, y, off, moves_at_ulps }, bright, cut })
    };
    let found: Vec<Asked> = pixels.par_iter().map(ask).collect::<Result<_>>()?;
    let worth = usual_brightness(&found);
    let in_doubt = |p: &&Asked| p.pixel.off <= bound && p.bright * HALF_AN_ULP + p.cut * worth > bound;
    let undecided = found.iter().filter(in_doubt).count();
    let found: Vec<Beyond> = found.into_iter().map(|asked| asked.pixel).collect();
    let excused = |p: &Beyond| p.moves_at_ulps.is_some();
    let worst = found.iter().filter(|p| !excused(p)).map(|p| p.off).fold(0.0, f64::max);
    let beyond: Vec<Beyond> = found.into_iter().filter(|p| p.off > bound).collect();
    let count = beyond.len();
    let (ill, wrong) = if examined { beyond.into_iter().partition(excused) } else { Default::default() };
    let reference = reference::named(&exact);
    Ok(Check { asked: pixels.len(), reference, bound, undecided, worst, beyond: count, examined, ill, wrong })
}

/// The brightness that nineteen pixels of twenty stay within.
fn usual_brightness(found: &[Asked]) -> f64 {
    let mut bright: Vec<f64> = found.iter().map(|asked| asked.bright).collect();
    bright.sort_unstable_by(f64::total_cmp);
    bright.get(bright.len() * 19 / 20).copied().unwrap_or(0.0)
}

fn sample(width: u32, height: u32) -> Vec<(u32, u32)> {
    let all = width as usize * height as usize;
    if all <= ASKED {
        return (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).collect();
    }
    // Powers of the inverse of the plastic number.
    let step = [0.754_877_666_246_693, 0.569_840_290_998_053_2];
    let mut chosen: Vec<(u32, u32)> = (1..=ASKED)
        .map(|k| {
            let [u, v] = step.map(|s| (0.5 + s * k as f64).fract());
            ((u * f64::from(width)) as u32, (v * f64::from(height)) as u32)
        })
        .collect();
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sample_covers_the_picture_evenly() {
        assert_eq!(sample(3, 2), [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)]);
        let chosen = sample(640, 480);
        assert!(chosen.len() > ASKED * 99 / 100);
        for quarter in 0..16 {
            let inside = |&&(x, y): &&(u32, u32)| x / 160 == quarter % 4 && y / 120 == quarter / 4;
            let n = chosen.iter().filter(inside).count();
            assert!((28..=36).contains(&n), "{n} in one sixteenth");
        }
    }
}
