//! Errors of a picture against its reference.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::condition::Condition;
use crate::Result;
use crate::image::{self, Film};

/// Difference that an 8-bit display may show, in units of radiance; pixels beyond it are counted.
pub const VISIBLE: f64 = 1.0 / 255.0;

/// Number of pixels tested for their condition at once.
const BATCH: usize = 8;

/// Largest number of pixels tested for the largest difference: the worst first, until one is well-conditioned.
const WORST_ASKED: usize = 192;

/// Number of other pixels tested, evenly chosen from the rest, to estimate their share.
const OTHERS_ASKED: usize = 16;

/// Errors of a picture; see [`image::Comparison`] for the units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Root of the mean squared difference over all channels.
    pub rmse: f64,
    /// Largest difference of a channel.
    pub max: f64,
    /// Peak signal-to-noise ratio in dB; `None` if the pictures are equal as displayed.
    pub psnr: Option<f64>,
    /// Structural similarity, at most 1.
    pub ssim: f64,
    /// Share of pixels off by more than 1/255.
    pub visible: f64,
    /// Number of pixels off by more than 1/255.
    pub above: u64,
    /// Number of pixels that are not finite.
    pub non_finite: u64,
    /// Column and row of the worst pixel.
    pub worst: Option<[u32; 2]>,
    /// Effect of ill-conditioned pixels, if tested.
    pub apart: Option<Apart>,
}

/// Ill-conditioned pixels among those off by more than 1/255.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Apart {
    /// Number of pixels tested: the worst, until one was well-conditioned, and an even choice of the rest.
    pub asked: u64,
    /// Number of ill-conditioned pixels among these.
    pub ill: u64,
    /// Largest difference of a pixel that is not known to be ill-conditioned.
    pub max: f64,
    /// True if that pixel and all worse ones were tested. Otherwise time ran out, and `max` is an upper bound on the
    /// largest difference of a well-conditioned pixel.
    pub sure: bool,
    /// Root of the mean squared difference over all pixels except those found ill-conditioned.
    pub rmse: f64,
}

/// Returns the largest difference of a channel; infinite if one is NaN.
#[must_use]
pub fn off(a: [f32; 3], b: [f32; 3]) -> f64 {
    let d = |i: usize| (f64::from(a[i]) - f64::from(b[i])).abs();
    (0..3).map(d).fold(0.0, |worst: f64, d| if d.is_nan() { f64::INFINITY } else { worst.max(d) })
}

impl Errors {
    /// Computes the errors of a picture against its reference, which must have the same size. `condition`, if given,
    /// tests pixels that are off, until a point in time.
    ///
    /// # Errors
    /// - `Error::Usage` if the sizes differ.
    /// - `Error::Interrupted` if the observer requests a stop.
    pub fn of(film: &Film, reference: &Film, condition: Option<(&mut Condition, Instant)>) -> Result<Self> {
        let c = image::compare(film, reference, VISIBLE)?;
        let apart = condition.map(|(condition, until)| apart(film, reference, condition, until)).transpose()?;
        Ok(Self {
            rmse: c.rmse,
            max: c.max,
            psnr: c.psnr,
            ssim: c.ssim,
            visible: c.share_above(),
            above: c.above,
            non_finite: c.non_finite,
            worst: c.worst.map(|w| [w.x, w.y]),
            apart,
        })
    }

    /// Returns the number of ill-conditioned pixels off by more than 1/255, extrapolated from the tested ones.
    #[must_use]
    pub fn ill(&self) -> f64 {
        self.apart.map_or(0.0, |a| self.above as f64 * a.ill as f64 / a.asked.max(1) as f64)
    }

    /// Returns the root mean square that variants are ranked by; known ill-conditioned pixels are excluded.
    #[must_use]
    pub fn ranked(&self) -> f64 {
        self.apart.map_or(self.rmse, |a| a.rmse)
    }
}

fn apart(film: &Film, reference: &Film, condition: &mut Condition, until: Instant) -> Result<Apart> {
    let mut beyond: Vec<(f64, usize)> = film
        .pixels
        .iter()
        .zip(&reference.pixels)
        .enumerate()
        .map(|(i, (&p, &q))| (off(p, q), i))
        .filter(|(off, _)| *off > VISIBLE && off.is_finite())
        .collect();
    beyond.sort_by(|a, b| b.0.total_cmp(&a.0));
    let width = film.width as usize;
    let place = |&(_, i): &(f64, usize)| ((i % width) as u32, (i / width) as u32);
    let mut ask = |some: &[(f64, usize)]| condition.moves(&some.iter().map(place).collect::<Vec<_>>(), Some(until));
    let (mut asked, mut ill) = (0, Vec::new());
    let mut note = |some: &[(f64, usize)], moves: &[Option<bool>]| {
        asked += moves.iter().flatten().count() as u64;
        ill.extend(some.iter().zip(moves).filter(|(_, moves)| **moves == Some(true)).map(|((_, i), _)| *i));
    };

    // True if the worst well-conditioned pixel is known; all pixels may be ill-conditioned.
    let mut sure = beyond.len() <= WORST_ASKED;
    let mut rest = &beyond[..];
    for some in beyond[..beyond.len().min(WORST_ASKED)].chunks(BATCH) {
        let moves = ask(some)?;
        note(some, &moves);
        rest = &rest[some.len()..];
        if let Some(first) = moves.iter().find(|moves| **moves != Some(true)) {
            sure = *first == Some(false);
            break;
        }
    }
    let step = rest.len().div_ceil(OTHERS_ASKED).max(1);
    let others: Vec<(f64, usize)> = rest.iter().step_by(step).copied().collect();
    let moves = ask(&others)?;
    note(&others, &moves);

    ill.sort_unstable();
    let (mut max, mut squares, mut n) = (0.0_f64, 0.0, 0_u64);
    for (i, (p, q)) in film.pixels.iter().zip(&reference.pixels).enumerate() {
        if ill.binary_search(&i).is_ok() || !p.iter().chain(q).all(|x| x.is_finite()) {
            continue;
        }
        max = max.max(off(*p, *q));
        for (&a, &b) in p.iter().zip(q) {
            squares += (f64::from(a) - f64::from(b)).powi(2);
        }
        n += 3;
    }
    let rmse = (squares / n.max(1) as f64).sqrt();
    Ok(Apart { asked, ill: ill.len() as u64, max, sure, rmse })
}
