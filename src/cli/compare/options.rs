//! Validated options of `vitrum compare`.

use std::path::PathBuf;

use super::args::CompareArgs;
use crate::cli::options::{format_of, refuse_input};
use crate::image::{Destination, Format};
use crate::{Error, Result};

/// Two pictures to compare.
#[derive(Debug)]
pub(in crate::cli) struct Compare {
    pub a: PathBuf,
    pub b: PathBuf,
    /// Largest difference that passes, if given.
    pub tolerance: Option<f64>,
    /// Share of pixels that may exceed the tolerance.
    pub allow_share: f64,
    pub diff: Option<Difference>,
    pub linear: bool,
    pub json: bool,
    pub quiet: bool,
}

/// Picture of the differences to write.
#[derive(Debug)]
pub(in crate::cli) struct Difference {
    pub output: Destination,
    pub format: Format,
    /// Factor on the differences; `None` scales the largest to 1.
    pub scale: Option<f64>,
}

impl TryFrom<CompareArgs> for Compare {
    type Error = Error;

    fn try_from(args: CompareArgs) -> Result<Self> {
        let diff = match args.diff {
            None => None,
            Some(name) => {
                refuse_input("--diff", &name, [args.a.as_path(), args.b.as_path()])?;
                let output = Destination::new(&name)?;
                let format = format_of(&output)?;
                Some(Difference { output, format, scale: args.diff_scale })
            }
        };
        Ok(Self {
            a: args.a,
            b: args.b,
            tolerance: args.tolerance,
            allow_share: args.allow_share,
            diff,
            linear: args.linear,
            json: args.json,
            quiet: args.quiet,
        })
    }
}
