//! Validated options of `vitrum explain`.

use std::path::PathBuf;

use super::args::ExplainArgs;
use crate::cli::options::{Reading, SmallPicture, effects};
use crate::{Error, Result, render};

/// A scene to explain.
#[derive(Debug)]
pub(in crate::cli) struct Explain {
    pub scene: PathBuf,
    pub reading: Reading,
    /// Rounds of measurement; `None` for no measurement.
    pub rounds: Option<usize>,
    pub picture: SmallPicture,
    pub options: render::Options,
    /// True if warnings are errors.
    pub strict: bool,
    pub json: bool,
    pub quiet: bool,
}

impl TryFrom<ExplainArgs> for Explain {
    type Error = Error;

    fn try_from(args: ExplainArgs) -> Result<Self> {
        let options = render::Options {
            effects: effects::effects(&args.effects)?,
            threads: args.threads.unwrap_or(0) as usize,
            ..render::Options::default()
        };
        Ok(Self {
            scene: args.scene,
            reading: args.model.into(),
            rounds: args.measure.then_some(args.rounds as usize),
            picture: args.picture,
            options,
            strict: args.strict.strict,
            json: args.json,
            quiet: args.quiet,
        })
    }
}
