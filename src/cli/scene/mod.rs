//! `vitrum scene`.

pub(super) mod args;

use std::path::Path;

use self::args::SceneArgs;
use super::options::{Reading, refuse_input};
use super::verdict::Verdict;
use super::warnings::Warnings;
use super::{backend, output};
use crate::image::Destination;
use crate::load;
use crate::{Error, Result};

/// Writes the scene of a model.
pub(super) fn run(args: SceneArgs) -> Result<Verdict> {
    if args.output.extension().is_none_or(|e| !e.eq_ignore_ascii_case("toml")) {
        let name = args.output.display();
        return Err(Error::Usage(format!("-o {name}: a scene file ends in .toml; name it so")));
    }
    refuse_input("-o", &args.output, [args.model.as_path()])?;
    backend::start_threads(0)?;
    let destination = Destination::new(&args.output)?;
    let options = Reading::from(args.options).options(&args.model, args.strict.strict)?;
    let folder = args.output.parent().unwrap_or(Path::new(""));
    let (text, report) = load::sketch(&args.model, folder, &options)?;
    destination.write(text.as_bytes(), || true)?;
    if !args.quiet {
        Warnings::new(&report, Vec::new()).log();
        output::log(&format!("scene      {}; render it by `vitrum render`", args.output.display()));
    }
    Ok(Verdict::Done)
}
