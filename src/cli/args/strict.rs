//! The option that makes warnings errors.

use clap::Args;

/// Option of every command that reports warnings.
#[derive(Debug, Args)]
pub(in crate::cli) struct StrictArg {
    /// Make every warning, and everything dropped or clamped, an error
    #[arg(long)]
    pub strict: bool,
}
