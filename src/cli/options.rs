//! The command line as types, checked as a whole: past this point there are no flags.

mod bench;
mod choices;
mod compare;
mod effects;
mod explain;
mod formulas;
mod map;
mod parity;
mod picture;
mod pixel;
mod price;
mod render;
mod verify;

use std::path::Path;

use crate::image::{Destination, Format};
use crate::{Error, Result};
pub(super) use bench::Bench;
pub(super) use compare::{Compare, Difference};
pub(super) use explain::Explain;
pub(super) use formulas::Formulas;
pub(super) use map::Map;
pub(super) use parity::Parity;
pub(super) use picture::{Overrides, SmallPicture};
pub(super) use pixel::Pixel;
pub(super) use price::Price;
pub(super) use render::{Exposure, Render};
pub(super) use verify::Verify;

/// Devices and pipes seldom have an extension; they get PNG.
fn format_of(output: &Destination) -> Result<Format> {
    if output.is_stream() && output.name().extension().is_none() {
        return Ok(Format::Png);
    }
    Format::from_path(output.name())
}

/// Keeps an input from being written over.
///
/// # Errors
/// Usage, where `output` is one of the inputs, under whatever name.
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
