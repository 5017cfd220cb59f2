//! Arguments of `vitrum price --formulas`.

use clap::{Args, value_parser};

use crate::cli::choice::levels;
use crate::study::formulas::FormulaKind;

/// The options of `price --formulas`.
#[derive(Debug, Args)]
#[command(next_help_heading = "Formulas")]
pub(in crate::cli) struct FormulasArgs {
    /// Time and judge single formulas instead of pictures
    #[arg(long)]
    pub formulas: bool,

    /// Groups of formulas [default: all]
    #[arg(long, value_parser = levels::<FormulaKind>(), value_name = "KIND,...", value_delimiter = ',', requires = "formulas")]
    pub of: Vec<FormulaKind>,

    /// Rays drawn of each range
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(8..=10_000_000), default_value_t = 20_000,
        requires = "formulas")]
    pub count: u32,

    /// Judge only: the same figures on every machine of this kind
    #[arg(long, requires = "formulas")]
    pub untimed: bool,

    /// Print comma-separated values
    #[arg(long, requires = "formulas", conflicts_with = "json")]
    pub csv: bool,
}
