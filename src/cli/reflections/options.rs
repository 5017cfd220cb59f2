//! Validated options of `vitrum price --reflections`.

use std::path::PathBuf;

use crate::cli::price::args::PriceArgs;
use crate::cli::price::options::{default_backend, folder};
use crate::cli::repeat;
use crate::study::reflections::Plan;
use crate::{Error, Result};

/// Columns and rows of the pictures, where none are given.
const SIZE: [u32; 2] = [240, 160];

/// The study of the systems, and the place of its report.
#[derive(Debug)]
pub(in crate::cli) struct Reflections {
    pub plan: Plan,
    pub folder: PathBuf,
    pub json: bool,
    pub quiet: bool,
}

impl TryFrom<PriceArgs> for Reflections {
    type Error = Error;

    fn try_from(args: PriceArgs) -> Result<Self> {
        let Some(output) = args.output else {
            return Err(Error::Usage(String::from("price --reflections: name a folder for the page with -o DIR")));
        };
        let plan = Plan {
            backend: default_backend(args.backend)?,
            size: args.size.unwrap_or(SIZE),
            samples: args.samples,
            runs: args.runs as usize,
            threads: args.threads.unwrap_or(0) as usize,
            repeat: repeat::system,
        };
        Ok(Self { plan, folder: folder(output)?, json: args.json, quiet: args.quiet })
    }
}
