//! `vitrum price`, as typed.

use clap::Args;

use super::formulas::FormulasArgs;

/// Show what accuracy costs in time.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum price --formulas
  vitrum price --formulas --of refraction,fresnel --count 200000
  vitrum price --formulas --csv > formulas.csv

Each formula is timed in eight lanes, in one and in f64, and held against an
oracle of twice the digits of f64. The errors are the same in every run.")]
pub(in crate::cli) struct PriceArgs {
    #[command(flatten)]
    pub formulas: FormulasArgs,

    /// Print the figures as JSON
    #[arg(long)]
    pub json: bool,
}
