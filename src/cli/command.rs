//! The command line as a whole: its commands, each with its arguments.

use std::sync::LazyLock;

use clap::{Parser, Subcommand};

use super::bench::args::BenchArgs;
use super::compare::args::CompareArgs;
use super::doctor::DoctorArgs;
use super::explain::args::ExplainArgs;
use super::info::args::InfoArgs;
use super::map::args::MapArgs;
use super::parity::args::ParityArgs;
use super::pixel::args::PixelArgs;
use super::price::args::PriceArgs;
use super::render::args::RenderArgs;
use super::scene::args::SceneArgs;
use super::verify::args::VerifyArgs;
use crate::simd::level;

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

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn the_definition_of_the_command_line_is_sound() {
        Cli::command().debug_assert();
    }
}
