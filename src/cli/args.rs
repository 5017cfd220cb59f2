//! What may be typed, and the help for it. Values are checked one by one here, against each other in [`super::options`].

mod bench;
mod compare;
mod effects;
mod explain;
mod formulas;
mod numbers;
mod parity;
mod pixel;
mod price;
mod render;
mod settings;
mod strict;
mod verify;

use std::sync::LazyLock;

use clap::{Args, Parser, Subcommand};

use crate::simd::level;
pub(super) use bench::BenchArgs;
pub(super) use compare::CompareArgs;
pub(super) use effects::EffectArgs;
pub(super) use explain::ExplainArgs;
pub(super) use parity::ParityArgs;
pub(super) use pixel::PixelArgs;
pub(super) use price::PriceArgs;
pub(super) use render::RenderArgs;
pub(super) use settings::SettingsArgs;
pub(super) use strict::StrictArg;
pub(super) use verify::VerifyArgs;

static VERSION: LazyLock<String> = LazyLock::new(|| format!("{} ({})", env!("CARGO_PKG_VERSION"), level::BUILT));

/// A SIMD packet ray tracer: exact refraction and reflection.
#[derive(Debug, Parser)]
#[command(name = "vitrum", version = VERSION.as_str(), arg_required_else_help = true, subcommand_required = true)]
#[command(after_help = "Exit codes:
  0    done
  1    a comparison or check came out negative
  2    wrong input or usage
  3    reading or writing failed
  4    a limit, or a missing back end
  130  interrupted

`vitrum COMMAND --help` has examples.")]
pub(super) struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    Render(RenderArgs),
    Explain(ExplainArgs),
    Compare(CompareArgs),
    Parity(ParityArgs),
    Verify(VerifyArgs),
    Bench(BenchArgs),
    Price(PriceArgs),
    Pixel(PixelArgs),
    Doctor(DoctorArgs),
}

/// Say what this machine and this build can do, and what is missing.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum doctor
  vitrum doctor --json

Exits 4 when this binary cannot run here.")]
pub(super) struct DoctorArgs {
    /// Print the findings as JSON
    #[arg(long)]
    pub json: bool,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn the_definition_of_the_command_line_is_sound() {
        Cli::command().debug_assert();
    }
}
