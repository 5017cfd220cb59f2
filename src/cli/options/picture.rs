//! Settings of the scene's picture that the command line replaces.

use clap::{Args, value_parser};

use crate::cli::args::{OpticsArgs, SettingsArgs};
use crate::image::MOST_PIXELS;
use crate::scene::{LightsFrom, Settings, ShadowRule};
use crate::{Error, Result};

/// Settings given on the command line.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::cli) struct Overrides {
    width: Option<u32>,
    height: Option<u32>,
    samples: Option<u32>,
    depth: Option<u32>,
    cutoff: Option<f32>,
    shadows: Option<ShadowRule>,
    lights_from: Option<LightsFrom>,
    wavelengths: Option<u32>,
}

impl Overrides {
    /// Converts the arguments.
    pub fn new(args: SettingsArgs, optics: OpticsArgs) -> Self {
        let SettingsArgs { width, height, samples, depth, cutoff, wavelengths } = args;
        let OpticsArgs { shadows, lights_from, .. } = optics;
        Self { width, height, samples, depth, cutoff, shadows, lights_from, wavelengths }
    }

    /// Replaces the settings that were given.
    ///
    /// # Errors
    /// A limit if the picture is then too large.
    pub fn apply(&self, settings: &mut Settings) -> Result<()> {
        settings.width = self.width.unwrap_or(settings.width);
        settings.height = self.height.unwrap_or(settings.height);
        settings.samples = self.samples.unwrap_or(settings.samples);
        settings.max_depth = self.depth.unwrap_or(settings.max_depth);
        settings.cutoff = self.cutoff.unwrap_or(settings.cutoff);
        settings.shadows = self.shadows.unwrap_or(settings.shadows);
        settings.lights_from = self.lights_from.unwrap_or(settings.lights_from);
        settings.wavelengths = self.wavelengths.unwrap_or(settings.wavelengths);
        refuse_large(settings)
    }
}

/// Size of a picture that is traced in `f64` as well.
#[derive(Clone, Copy, Debug, Args)]
pub(in crate::cli) struct SmallPicture {
    /// Columns of the picture [default: the scene's, at most 320]
    #[arg(long, value_name = "PIXELS", value_parser = value_parser!(u32).range(1..=65536))]
    width: Option<u32>,

    /// Rows of the picture [default: the scene's, at most 240]
    #[arg(long, value_name = "PIXELS", value_parser = value_parser!(u32).range(1..=65536))]
    height: Option<u32>,
}

impl SmallPicture {
    /// Largest size that is chosen by default.
    const MOST: [u32; 2] = [320, 240];

    /// Sets the size of the picture: the requested one, or a small one with the same aspect ratio as far as whole
    /// pixels allow.
    ///
    /// # Errors
    /// A limit if it is too large.
    pub fn fit(self, settings: &mut Settings) -> Result<()> {
        let (width, height) = (f64::from(settings.width), f64::from(settings.height));
        let scale = match (self.width, self.height) {
            (Some(w), _) => f64::from(w) / width,
            (None, Some(h)) => f64::from(h) / height,
            (None, None) => (f64::from(Self::MOST[0]) / width).min(f64::from(Self::MOST[1]) / height).min(1.0),
        };
        let scaled = |x: f64| (x * scale).round().max(1.0) as u32;
        settings.width = self.width.unwrap_or(scaled(width));
        settings.height = self.height.unwrap_or(scaled(height));
        refuse_large(settings)
    }
}

/// Checks the size of the picture.
///
/// # Errors
/// A limit if it is too large.
fn refuse_large(settings: &Settings) -> Result<()> {
    let (width, height) = (settings.width, settings.height);
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        return Err(Error::Limit(format!(
            "a picture of {width} by {height} pixels is too large; at most {MOST_PIXELS} pixels are rendered"
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_to_be_traced_in_f64_is_small_and_keeps_its_shape_unless_told() {
        let fit = |width, height, asked: (Option<u32>, Option<u32>)| {
            let mut settings = Settings { width, height, ..Settings::default() };
            SmallPicture { width: asked.0, height: asked.1 }
                .fit(&mut settings)
                .map(|()| (settings.width, settings.height))
        };
        assert_eq!(fit(1920, 1080, (None, None)).unwrap(), (320, 180));
        assert_eq!(fit(100, 1000, (None, None)).unwrap(), (24, 240));
        assert_eq!(fit(64, 48, (None, None)).unwrap(), (64, 48));
        assert_eq!(fit(1_000_000, 1, (None, None)).unwrap(), (320, 1));
        assert_eq!(fit(640, 480, (Some(1000), None)).unwrap(), (1000, 750));
        assert_eq!(fit(640, 480, (None, Some(48))).unwrap(), (64, 48));
        assert_eq!(fit(640, 480, (Some(7), Some(9))).unwrap(), (7, 9));
        assert_eq!(fit(640, 480, (Some(65536), None)).unwrap_err().exit_code(), 4);
    }
}
