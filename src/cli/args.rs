//! Commands, and flags that several commands share. Each value is validated here; combinations of values are in
//! [`super::options`].

pub(super) mod effects;
pub(super) mod model;
pub(super) mod numbers;
pub(super) mod optics;
pub(super) mod settings;
pub(super) mod strict;

use std::sync::LazyLock;

use clap::{Args, Parser, Subcommand};

pub(super) use super::bench::args::BenchArgs;
pub(super) use super::compare::args::CompareArgs;
pub(super) use super::explain::args::ExplainArgs;
pub(super) use super::info::args::InfoArgs;
pub(super) use super::map::args::MapArgs;
pub(super) use super::parity::args::ParityArgs;
pub(super) use super::pixel::args::PixelArgs;
pub(super) use super::price::args::PriceArgs;
pub(super) use super::render::args::RenderArgs;
pub(super) use super::scene::args::SceneArgs;
pub(super) use super::verify::args::VerifyArgs;
use crate::simd::level;
pub(super) use effects::EffectArgs;
pub(super) use model::ModelArgs;
pub(super) use optics::OpticsArgs;
pub(super) use settings::SettingsArgs;
pub(super) use strict::StrictArg;

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
    Info(InfoArgs),
    Scene(SceneArgs),
    Explain(ExplainArgs),
    Compare(CompareArgs),
    Parity(ParityArgs),
    Verify(VerifyArgs),
    Bench(BenchArgs),
    Price(PriceArgs),
    Pixel(PixelArgs),
    Map(MapArgs),
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
