//! Comparison of two pictures.

use super::encode::srgb_from_linear;
use super::film::Film;
use super::ssim::ssim;
use crate::{Error, Result};

/// Difference of two pictures of the same size. Differences are between linear channel values, in units of radiance.
/// PSNR and SSIM are of the displayed pictures: clamped to 0..=1 and encoded as sRGB.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Comparison {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Largest absolute difference of a channel.
    pub max: f64,
    /// Mean absolute difference over all channels.
    pub mean: f64,
    /// Root of the mean squared difference over all channels.
    pub rmse: f64,
    /// Peak signal-to-noise ratio of the encoded pictures in dB, with a peak of 1; `None` if they are equal.
    pub psnr: Option<f64>,
    /// Structural similarity of the encoded pictures, at most 1.
    pub ssim: f64,
    /// Tolerance, in units of radiance.
    pub tolerance: f64,
    /// Number of pixels with a channel that differs by more than the tolerance, or is not finite in either picture.
    pub above: u64,
    /// Number of pixels with a channel that is NaN or infinite in either picture; left out of all other figures.
    pub non_finite: u64,
    /// Pixel of the largest difference, the first of equal ones; `None` if no pixel differs.
    pub worst: Option<Worst>,
}

/// Pixel of the largest difference.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Worst {
    /// Column, from 0 at the left.
    pub x: u32,
    /// Row, from 0 at the top.
    pub y: u32,
    /// Its colour in the first picture.
    pub a: [f32; 3],
    /// Its colour in the second.
    pub b: [f32; 3],
}

impl Comparison {
    /// Returns the share of pixels above the tolerance, 0..=1.
    #[must_use]
    pub fn share_above(&self) -> f64 {
        self.above as f64 / (f64::from(self.width) * f64::from(self.height))
    }
}

fn same_size(a: &Film, b: &Film) -> Result<()> {
    if (a.width, a.height) == (b.width, b.height) && a.width > 0 && a.height > 0 {
        return Ok(());
    }
    Err(Error::Usage(format!(
        "the pictures differ in size: {} by {} and {} by {} pixels",
        a.width, a.height, b.width, b.height
    )))
}

/// Compares two pictures; `tolerance` is in units of radiance.
///
/// # Errors
/// Returns [`Error::Usage`] if the sizes differ or are 0.
pub fn compare(a: &Film, b: &Film, tolerance: f64) -> Result<Comparison> {
    same_size(a, b)?;
    let (mut max, mut sum, mut squares, mut seen_squares) = (0.0_f64, 0.0, 0.0, 0.0);
    let (mut above, mut non_finite, mut finite) = (0, 0, 0_u64);
    let mut worst = None;
    for (i, (p, q)) in a.pixels.iter().zip(&b.pixels).enumerate() {
        if !p.iter().chain(q).all(|x| x.is_finite()) {
            non_finite += 1;
            above += 1;
            continue;
        }
        finite += 1;
        let mut largest = 0.0_f64;
        for (&x, &y) in p.iter().zip(q) {
            let d = (f64::from(x) - f64::from(y)).abs();
            largest = largest.max(d);
            sum += d;
            squares += d * d;
            let e = seen(x) - seen(y);
            seen_squares += e * e;
        }
        above += u64::from(largest > tolerance);
        if largest > max {
            max = largest;
            let width = a.width as usize;
            worst = Some(Worst { x: (i % width) as u32, y: (i / width) as u32, a: *p, b: *q });
        }
    }
    let n = (3 * finite.max(1)) as f64;
    let encoded = |film: &Film| film.pixels.iter().map(|p| p.map(seen)).collect::<Vec<_>>();
    Ok(Comparison {
        width: a.width,
        height: a.height,
        max,
        mean: sum / n,
        rmse: (squares / n).sqrt(),
        psnr: (seen_squares > 0.0).then(|| -10.0 * (seen_squares / n).log10()),
        ssim: ssim(&encoded(a), &encoded(b), a.width as usize, a.height as usize),
        tolerance,
        above,
        non_finite,
        worst,
    })
}

/// Returns a channel as displayed, 0..=1. Values that are not finite are displayed as black.
fn seen(x: f32) -> f64 {
    if x.is_finite() { srgb_from_linear(f64::from(x).clamp(0.0, 1.0)) } else { 0.0 }
}

/// Returns the absolute differences times `scale`, per channel. Pixels that are not finite in either picture are
/// magenta.
///
/// # Errors
/// Returns [`Error::Usage`] if the sizes differ or are 0.
pub fn difference(a: &Film, b: &Film, scale: f64) -> Result<Film> {
    same_size(a, b)?;
    let pixels = a.pixels.iter().zip(&b.pixels).map(|(p, q)| {
        if p.iter().chain(q).all(|x| x.is_finite()) {
            std::array::from_fn(|c| ((f64::from(p[c]) - f64::from(q[c])).abs() * scale) as f32)
        } else {
            [1.0, 0.0, 1.0]
        }
    });
    Ok(Film { width: a.width, height: a.height, pixels: pixels.collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_pictures_are_equal() {
        let mut film = Film::new(20, 13);
        film.pixels[7] = [0.3, 9.0, -1.0];
        let c = compare(&film, &film, 0.0).unwrap();
        assert_eq!((c.max, c.mean, c.rmse, c.psnr, c.above, c.worst), (0.0, 0.0, 0.0, None, 0, None));
        assert!((c.ssim - 1.0).abs() < 1e-12);
    }

    #[test]
    fn figures_are_those_worked_out_by_hand() {
        // Two pixels, six channels: one of them off by 0.5, one by 0.25.
        let mut a = Film::new(2, 1);
        a.pixels = vec![[0.0, 1.0, 0.0], [0.0; 3]];
        let mut b = a.clone();
        b.pixels[0][1] = 0.5;
        b.pixels[1][2] = 0.25;
        let c = compare(&a, &b, 0.25).unwrap();
        assert_eq!((c.max, c.mean), (0.5, 0.125));
        assert!((c.rmse - (0.3125_f64 / 6.0).sqrt()).abs() < 1e-15);
        assert_eq!((c.above, c.share_above()), (1, 0.5));
        assert_eq!(c.worst, Some(Worst { x: 0, y: 0, a: a.pixels[0], b: b.pixels[0] }));
        let (d, e) = (1.0 - srgb_from_linear(0.5), srgb_from_linear(0.25));
        assert!((c.psnr.unwrap() + 10.0 * ((d * d + e * e) / 6.0).log10()).abs() < 1e-12);
        let shown = difference(&a, &b, 2.0).unwrap();
        assert_eq!(shown.pixels, [[0.0, 1.0, 0.0], [0.0, 0.0, 0.5]]);
    }

    #[test]
    fn a_pixel_that_is_not_finite_never_passes_for_equal() {
        let mut a = Film::new(3, 1);
        a.pixels[1][0] = f32::NAN;
        let c = compare(&a, &a, 1e30).unwrap();
        assert_eq!((c.above, c.non_finite, c.max), (1, 1, 0.0));
        assert!(c.ssim.is_finite());
    }

    #[test]
    fn pictures_of_different_size_are_not_compared() {
        assert_eq!(compare(&Film::new(2, 3), &Film::new(3, 2), 0.0).unwrap_err().exit_code(), 2);
        assert!(difference(&Film::new(2, 3), &Film::new(3, 2), 1.0).is_err());
    }
}
