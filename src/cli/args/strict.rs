//! The option by which a warning is an error.

use clap::Args;

/// For every command that reports warnings.
#[derive(Debug, Args)]
pub(in crate::cli) struct StrictArg {
    /// Make every warning, and everything dropped or clamped, an error
    #[arg(long)]
    pub strict: bool,
}
