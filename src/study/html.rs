//! The report as one page that needs no network: it contains the figures as JSON, the pictures as PNG, and a script
//! that draws them.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use super::axis::Axis;
use super::errors::off;
use super::report::Report;
use crate::Result;
use crate::image::{self, Bits, Encoding, Film, Format, linear_from_srgb};
use crate::measure::html::escaped;

const PAGE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/page.css");
const SCRIPT: &str = include_str!("page/page.js");

/// False colours of differences up to 1, in sRGB: black, violet, orange, yellow, white, spaced evenly over the decades
/// from [`DARK`] to 1.
const RAMP: [[u8; 3]; 7] =
    [[0, 0, 4], [40, 11, 84], [101, 21, 110], [159, 42, 99], [212, 72, 66], [250, 193, 39], [252, 255, 220]];

/// Largest difference that is drawn black.
const DARK: f64 = 1e-5;

/// Colours of the axes, which colour-blind readers can tell apart, too.
const fn colour(axis: Axis) -> &'static str {
    match axis {
        Axis::Fresnel => "#0072b2",
        Axis::Refraction => "#b0467b",
        Axis::Reflection => "#4f5bd5",
        Axis::Shadows => "#e69f00",
        Axis::LightsFrom => "#a65628",
        Axis::Spheres => "#e58ab0",
        Axis::Cutoff => "#d55e00",
        Axis::Depth => "#6a3d9a",
        Axis::Backend => "#009e73",
        Axis::Triangles => "#8c564b",
        Axis::Reciprocal => "#17a2a2",
        Axis::Precision => "#7a6a00",
        Axis::Sampling => "#56b4e9",
    }
}

/// Picture of a variant and its reference.
#[derive(Clone, Debug)]
pub struct Pair {
    /// Picture of the variant.
    pub film: Film,
    /// Reference that it is compared with.
    pub reference: Option<Film>,
}

/// The two references, if they exist.
#[derive(Clone, Debug, Default)]
pub struct References {
    /// With the default's rays per pixel.
    pub own: Option<Film>,
    /// With 16 by 16 rays per pixel.
    pub fine: Option<Film>,
}

#[derive(Serialize)]
struct Data<'a> {
    report: &'a Report,
    pictures: Vec<Option<Shown>>,
    references: Shared,
}

#[derive(Serialize)]
struct Shown {
    picture: String,
    difference: Option<String>,
}

#[derive(Serialize)]
struct Shared {
    own: Option<String>,
    fine: Option<String>,
}

/// Returns the page. `pictures` correspond to the rows of the report.
///
/// # Errors
/// Usage, if pictures that are compared differ in size; a limit, if one is empty.
pub fn page(report: &Report, pictures: &[Option<Pair>], references: &References) -> Result<String> {
    let shown = |pair: &Pair| {
        let difference = pair.reference.as_ref().map(|r| png(&false_colours(&pair.film, r))).transpose()?;
        Ok(Shown { picture: png(&pair.film)?, difference })
    };
    let pictures = pictures.iter().map(|p| p.as_ref().map(shown).transpose()).collect::<Result<Vec<_>>>()?;
    let reference = |film: &Option<Film>| film.as_ref().map(png).transpose();
    let references = Shared { own: reference(&references.own)?, fine: reference(&references.fine)? };
    let data = serde_json::to_string(&Data { report, pictures, references }).unwrap_or_default();
    // A script element must not contain its own end tag.
    let data = data.replace('<', "\\u003c");
    let colours: Vec<String> = Axis::ALL.iter().map(|&a| format!("\"{}\": \"{}\"", a.name(), colour(a))).collect();
    let title = escaped(&report.subject.scene);
    let script = SCRIPT.replace("@COLOURS@", &format!("{{ {} }}", colours.join(", ")));
    // The data come last, so that their content is never taken for a placeholder.
    let page = PAGE.replace("@STYLE@", &style()).replace("@SCRIPT@", &script).replace("@TITLE@", &title);
    Ok(page.replacen("@DATA@", &data, 1))
}

/// Returns the style sheet of all pages.
pub(super) fn style() -> String {
    let ramp: Vec<String> = RAMP.iter().map(|[r, g, b]| format!("rgb({r},{g},{b})")).collect();
    STYLE.replace("@RAMP@", &ramp.join(", "))
}

/// Returns a film as the `src` of an image.
pub(super) fn png(film: &Film) -> Result<String> {
    let encoding = Encoding { format: Format::Png, bits: Bits::Eight, metadata: Vec::new() };
    Ok(format!("data:image/png;base64,{}", STANDARD.encode(image::encode(film, &encoding)?.bytes)))
}

/// Draws the largest difference of each pixel's channels in false colours.
#[must_use]
pub fn false_colours(film: &Film, reference: &Film) -> Film {
    let pixels = film.pixels.iter().zip(&reference.pixels).map(|(&a, &b)| ramp(off(a, b)));
    Film { width: film.width, height: film.height, pixels: pixels.collect() }
}

fn ramp(difference: f64) -> [f32; 3] {
    let last = (RAMP.len() - 1) as f64;
    let at = ((difference / DARK).max(1.0).log10() / -DARK.log10() * last).clamp(0.0, last);
    let low = (at.floor() as usize).min(RAMP.len() - 2);
    let share = at - low as f64;
    std::array::from_fn(|c| {
        let [a, b] = [RAMP[low][c], RAMP[low + 1][c]].map(|code| f64::from(code) / 255.0);
        linear_from_srgb(a + (b - a) * share) as f32
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn false_colours_run_from_black_to_white_over_five_decades() {
        let code = |d: f64| ramp(d).map(|x| (image::srgb_from_linear(f64::from(x)) * 255.0).round() as u8);
        assert_eq!((code(0.0), code(1e-5), code(1.0)), (RAMP[0], RAMP[0], RAMP[6]));
        assert_eq!(code(f64::INFINITY), RAMP[6]);
        // The middle of the decades.
        assert_eq!(code(10.0_f64.powf(-2.5)), RAMP[3]);
    }
}
