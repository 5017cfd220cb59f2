//! Validated options that several commands share. Code past this point has no flags.

pub(super) mod choices;
pub(super) mod effects;
pub(super) mod exposure;
pub(super) mod picture;
pub(super) mod reading;

use std::path::Path;

use crate::image::{Destination, Format};
use crate::{Error, Result};
pub(super) use exposure::Exposure;
pub(super) use picture::{Overrides, SmallPicture};
pub(super) use reading::Reading;

/// Devices and pipes seldom have an extension; they get PNG.
pub(super) fn format_of(output: &Destination) -> Result<Format> {
    if output.is_stream() && output.name().extension().is_none() {
        return Ok(Format::Png);
    }
    Format::from_path(output.name())
}

/// Keeps an input from being overwritten.
///
/// # Errors
/// Usage if `output` is one of the inputs, under whatever name.
pub(super) fn refuse_input<'a>(flag: &str, output: &Path, inputs: impl IntoIterator<Item = &'a Path>) -> Result<()> {
    let Ok(output_file) = output.canonicalize() else {
        return Ok(());
    };
    for input in inputs {
        if output_file.is_file() && input.canonicalize().is_ok_and(|input| input == output_file) {
            return Err(Error::Usage(format!(
                "{flag} {} would overwrite the input {}; choose another name",
                output.display(),
                input.display()
            )));
        }
    }
    Ok(())
}
