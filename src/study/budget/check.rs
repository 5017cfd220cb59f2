//! Check of a picture against `f64` at a sample of its pixels.

use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

use crate::Result;
use crate::image::Film;
use crate::render::Observer;
use crate::render::reference::{Prepared, Tally};
use crate::scene::{Scene, Settings};
use crate::study::condition::Condition;
use crate::study::errors::off;
use crate::study::reference;
use crate::study::variant::Variant;

/// Largest number of pixels in the sample.
const ASKED: usize = 512;

/// Result of checking the sample.
#[derive(Clone, Debug, Serialize)]
pub struct Check {
    /// Number of pixels checked.
    pub asked: usize,
    /// Description of the reference.
    pub reference: String,
    /// Bound on the error of a channel.
    pub bound: f64,
    /// Number of pixels within the bound at which the reference itself may be off by more. Causes are the light that its
    /// depth limit and cut-off took, as estimated under wider limits, and the rounding of the picture's `f32`.
    pub undecided: usize,
    /// Largest difference of a pixel that is not known to be ill-conditioned.
    pub worst: f64,
    /// Number of pixels beyond the bound.
    pub beyond: usize,
    /// True if these pixels were tested for their condition; if not, the two lists below are empty.
    pub examined: bool,
    /// Ill-conditioned pixels beyond the bound, with the evidence.
    pub ill: Vec<Beyond>,
    /// Well-conditioned pixels beyond the bound.
    pub wrong: Vec<Beyond>,
}

/// Pixel beyond the bound.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Beyond {
    /// Column from the left.
    pub x: u32,
    /// Row from the top.
    pub y: u32,
    /// Difference to the reference.
    pub off: f64,
    /// Movement of its camera rays, in ulps of `f32`, at which its `f64` value changes by more than the bound.
    pub moves_at_ulps: Option<f64>,
}

/// Largest relative error of a value rounded to `f32`.
const HALF_AN_ULP: f64 = f32::EPSILON as f64 / 2.0;

/// Share of a pixel's weight above which its loss leaves the pixel unknown.
const MOST: f64 = 0.5;

/// Pixel of the sample.
struct Asked {
    pixel: Beyond,
    /// Radiance of the reference.
    radiance: DVec3,
    /// Weight that the reference's limits took.
    truncated: DVec3,
    /// Light that the reference may lack for that weight.
    lacks: f64,
}

impl Asked {
    /// Returns true if the picture keeps the bound here as far as the reference tells, which may be off by more.
    fn is_in_doubt(&self, bound: f64) -> bool {
        self.pixel.off <= bound && self.radiance.abs().max_element() * HALF_AN_ULP + self.lacks > bound
    }

    /// Returns the light that the reference still lacks under wider limits. The weight that ends there, too, is taken to see
    /// as much light as the weight that they freed (as in `render/shortfall.rs`). `worth` is the most that a weight of 1 sees.
    fn lacks_under(&self, wide: &Tally, worth: f64) -> f64 {
        let weight = |truncated: DVec3| truncated.abs().max_element();
        let (ended, freed) = (weight(wide.truncated), weight(self.truncated) - weight(wide.truncated));
        if ended > MOST {
            return ended * worth;
        }
        if freed <= 0.0 {
            return 0.0;
        }
        let gained = (wide.radiance - self.radiance).abs().max_element();
        (gained * (ended / freed).min(1.0)).min(ended * worth)
    }
}

impl Check {
    /// Returns true if at most one pixel in a hundred is undecided, so that the others represent the picture.
    #[must_use]
    pub fn can_show(&self) -> bool {
        self.undecided * 100 <= self.asked
    }

    /// Returns true if the sample shows that the picture keeps the bound. No pixel may be wrong, and at most one in
    /// twenty ill-conditioned. Below some bound every pixel in `f32` is ill-conditioned.
    #[must_use]
    pub fn shows_it_kept(&self) -> bool {
        self.wrong.is_empty() && self.ill.len() * 20 <= self.asked && self.can_show()
    }
}

/// Checks `film`, a picture of `scene` by any choices, against the best reference that the scene supports
/// ([`reference::most_exact`]). Checks all pixels of a small picture, else a sample that covers it evenly (the R2
/// sequence of Roberts 2018). Area lamps and wavelengths are sampled as in the picture. If `examined`, pixels beyond
/// the bound are tested for their condition, which takes a hundred times as long as their value.
///
/// # Errors
/// Returns [`Error::Interrupted`](crate::Error::Interrupted) if the observer requests a stop.
pub fn check(
    scene: &Scene,
    film: &Film,
    default: &Variant,
    bound: f64,
    examined: bool,
    observer: &Observer,
) -> Result<Check> {
    let exact = reference::most_exact(default, scene);
    let judge = Scene { settings: exact.settings(&scene.settings), ..scene.try_clone()? };
    let prepared = Prepared::new(&judge, exact.fresnel);
    let condition = Condition::new(&judge, prepared, bound, observer);
    let pixels = sample(film.width, film.height);
    let heeded = || -> Result<()> {
        let stopped = observer.stop.load(std::sync::atomic::Ordering::Relaxed);
        if stopped { Err(crate::Error::Interrupted) } else { Ok(()) }
    };
    let excuse = |x, y, off| if examined && off > bound { condition.moves_at(x, y) } else { None };
    let ask = |&(x, y): &(u32, u32)| {
        heeded()?;
        let Tally { radiance, truncated, .. } = condition.exact(x, y);
        let off = off(film.at(x, y), radiance.as_vec3().to_array());
        Ok(Asked { pixel: Beyond { x, y, off, moves_at_ulps: excuse(x, y, off) }, radiance, truncated, lacks: 0.0 })
    };
    let mut found: Vec<Asked> = pixels.par_iter().map(ask).collect::<Result<_>>()?;
    let worth = usual_brightness(&found);
    found.iter_mut().for_each(|asked| asked.lacks = asked.truncated.abs().max_element() * worth);
    if found.iter().any(|asked| asked.is_in_doubt(bound)) {
        // The weight that ended bounds the light by far; wider limits tell most of it.
        let wide = Scene { settings: widened(&judge.settings), ..judge.clone() };
        let wide = Condition::new(&wide, Prepared::new(&wide, exact.fresnel), bound, observer);
        found.par_iter_mut().filter(|asked| asked.is_in_doubt(bound)).try_for_each(|asked| -> Result<()> {
            heeded()?;
            let Beyond { x, y, .. } = asked.pixel;
            let seen = wide.exact(x, y);
            asked.lacks = asked.lacks_under(&seen, worth);
            let off = off(film.at(x, y), seen.radiance.as_vec3().to_array());
            asked.pixel = Beyond { x, y, off, moves_at_ulps: excuse(x, y, off) };
            Ok(())
        })?;
    }
    let undecided = found.iter().filter(|asked| asked.is_in_doubt(bound)).count();
    let found: Vec<Beyond> = found.into_iter().map(|asked| asked.pixel).collect();
    let excused = |p: &Beyond| p.moves_at_ulps.is_some();
    let worst = found.iter().filter(|p| !excused(p)).map(|p| p.off).fold(0.0, f64::max);
    let beyond: Vec<Beyond> = found.into_iter().filter(|p| p.off > bound).collect();
    let count = beyond.len();
    let (ill, wrong) = if examined { beyond.into_iter().partition(excused) } else { Default::default() };
    let reference = reference::named(&exact);
    Ok(Check { asked: pixels.len(), reference, bound, undecided, worst, beyond: count, examined, ill, wrong })
}

/// Returns the brightness that 19 of 20 pixels do not exceed.
fn usual_brightness(found: &[Asked]) -> f64 {
    let mut bright: Vec<f64> = found.iter().map(|asked| asked.radiance.abs().max_element()).collect();
    bright.sort_unstable_by(f64::total_cmp);
    bright.get(bright.len() * 19 / 20).copied().unwrap_or(0.0)
}

/// Twice the depth and a quarter of the cut-off.
fn widened(settings: &Settings) -> Settings {
    Settings { max_depth: settings.max_depth.saturating_mul(2), cutoff: settings.cutoff / 4.0, ..settings.clone() }
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
