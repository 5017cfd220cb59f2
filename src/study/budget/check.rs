//! A picture held against `f64` at a sample of its own pixels.

use rayon::prelude::*;
use serde::Serialize;

use crate::Result;
use crate::image::Film;
use crate::render::Observer;
use crate::render::reference::Prepared;
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
    /// The most that a channel may be off.
    pub bound: f64,
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

/// Holds `film`, a picture of `scene` by whatever choices, against the exact choices in `f64`: at all its pixels where
/// they are few, else at a sample that covers it evenly (the R2 sequence of Roberts 2018). Only where `examined` are
/// pixels beyond the bound asked for their condition, which takes a hundred times as long as their value.
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
    let exact = reference::exact(default);
    let judge = Scene { settings: exact.settings(&scene.settings), ..scene.clone() };
    let prepared = Prepared::new(&judge, exact.fresnel);
    let condition = Condition::new(&judge, prepared, bound, observer);
    let pixels = sample(film.width, film.height);
    let ask = |&(x, y): &(u32, u32)| {
        if observer.stop.load(std::sync::atomic::Ordering::Relaxed) {
            return Err(crate::Error::Interrupted);
        }
        let off = off(film.at(x, y), condition.value(x, y).map(|v| v as f32));
        let moves_at_ulps = if examined && off > bound { condition.moves_at(x, y) } else { None };
        Ok(Beyond { x, y, off, moves_at_ulps })
    };
    let found: Vec<Beyond> = pixels.par_iter().map(ask).collect::<Result<_>>()?;
    let excused = |p: &Beyond| p.moves_at_ulps.is_some();
    let worst = found.iter().filter(|p| !excused(p)).map(|p| p.off).fold(0.0, f64::max);
    let beyond: Vec<Beyond> = found.into_iter().filter(|p| p.off > bound).collect();
    let count = beyond.len();
    let (ill, wrong) = if examined { beyond.into_iter().partition(excused) } else { Default::default() };
    Ok(Check { asked: pixels.len(), bound, worst, beyond: count, examined, ill, wrong })
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
