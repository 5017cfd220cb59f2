//! `vitrum compare`.

pub(super) mod args;
pub(super) mod options;

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use self::options::{Compare, Difference};
use super::verdict::Verdict;
use super::{interrupt, output};
use crate::Result;
use crate::image::{self, Comparison, Encoding, Film, ReadOptions};
use crate::render::Observer;

/// Difference of a channel above which a pixel is counted, if no tolerance is given: a step of an 8-bit channel.
const STEP: f64 = 1.0 / 255.0;

/// Result in the form of the JSON output.
#[derive(serde::Serialize)]
struct Report<'a> {
    a: &'a Path,
    b: &'a Path,
    #[serde(flatten)]
    comparison: &'a Comparison,
    share_above: f64,
    allowed_share: f64,
    /// `None` without a tolerance.
    passed: Option<bool>,
}

/// Compares, prints, and writes the picture of differences.
pub(super) fn run(job: &Compare) -> Result<Verdict> {
    interrupt::listen(&Arc::new(Observer::default()))?;
    let (a, b) = (film(&job.a, job)?, film(&job.b, job)?);
    let comparison = image::compare(&a, &b, job.tolerance.unwrap_or(STEP))?;
    let passed = job.tolerance.map(|_| comparison.share_above() <= job.allow_share);

    if let Some(diff) = &job.diff {
        write_difference(&a, &b, &comparison, diff, job.quiet)?;
    }
    if job.json {
        let share_above = comparison.share_above();
        let (comparison, allowed_share) = (&comparison, job.allow_share);
        output::print_json(&Report { a: &job.a, b: &job.b, comparison, share_above, allowed_share, passed })?;
    } else if !job.quiet {
        output::print(&text(&comparison, job.allow_share, passed))?;
    }
    Ok(if passed == Some(false) { Verdict::Negative } else { Verdict::Done })
}

fn film(path: &Path, job: &Compare) -> Result<Film> {
    let picture = image::read(path, &ReadOptions { linear: job.linear, ..ReadOptions::default() })?;
    if picture.alpha_dropped && !job.quiet {
        output::log(&format!("warning: {}: its alpha channel is left out", path.display()));
    }
    Ok(picture.film)
}

fn write_difference(a: &Film, b: &Film, comparison: &Comparison, diff: &Difference, quiet: bool) -> Result<()> {
    let scale = diff.scale.unwrap_or(if comparison.max > 0.0 { 1.0 / comparison.max } else { 1.0 });
    let metadata = vec![(String::from("vitrum:difference-scale"), scale.to_string())];
    let encoding = Encoding { format: diff.format, bits: image::Bits::Eight, metadata };
    let encoded = image::encode(&image::difference(a, b, scale)?, &encoding)?;
    diff.output.write(&encoded.bytes, || true)?;
    if !quiet {
        output::log(&format!("{}: differences times {scale:.6}", diff.output.name().display()));
    }
    Ok(())
}

fn text(c: &Comparison, allowed: f64, passed: Option<bool>) -> String {
    let mut s = String::new();
    let mut line = |name: &str, value: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(s, "{name:<10} {value}");
    };
    line("size", format!("{} x {}", c.width, c.height));
    line("max", format!("{:.9}", c.max));
    line("mean", format!("{:.9}", c.mean));
    line("RMSE", format!("{:.9}", c.rmse));
    line("PSNR", c.psnr.map_or(String::from("infinite (equal as seen)"), |x| format!("{x:.3} dB")));
    line("SSIM", format!("{:.7}", c.ssim));
    line("above", format!("{} pixels ({:.4} %) by more than {}", c.above, 100.0 * c.share_above(), c.tolerance));
    if c.non_finite > 0 {
        line("not finite", format!("{} pixels, counted as above and left out of the rest", c.non_finite));
    }
    match c.worst {
        Some(w) => line("worst", format!("at {}, {}: {:?} and {:?}", w.x, w.y, w.a, w.b)),
        None => line("worst", String::from("none")),
    }
    if let Some(passed) = passed {
        let share = 100.0 * allowed;
        line("verdict", format!("{} ({share} % may be above)", if passed { "passed" } else { "FAILED" }));
    }
    s
}
