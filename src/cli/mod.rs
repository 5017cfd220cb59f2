//! The command line: a folder per command, with its flags (`args`), their validation (`options`) and the command itself.

mod args;
mod backend;
mod bench;
mod choice;
mod command;
mod compare;
mod doctor;
mod explain;
mod formulas;
mod info;
mod interrupt;
mod map;
mod metadata;
mod options;
mod output;
mod parity;
mod pixel;
mod price;
mod progress;
mod reflections;
mod render;
mod repeat;
mod scene;
mod table;
mod unmatched;
mod usage;
mod verdict;
mod verify;
mod view;
mod warnings;
mod wording;

use std::process::ExitCode;

use clap::Parser as _;
use clap::error::ErrorKind;

use crate::system::threads;
use crate::{Error, Result};
use bench::options::Bench;
use command::{Cli, Command};
use compare::options::Compare;
use explain::options::Explain;
use formulas::options::Formulas;
use map::options::Map;
use parity::options::Parity;
use pixel::options::Pixel;
use price::options::Price;
use reflections::options::Reflections;
use render::options::Render;
use verdict::Verdict;
use verify::options::Verify;

/// Runs the program on the process's own arguments, on a thread of its own. An error is one line on standard error; the
/// exit code is [`crate::Error::exit_code`].
#[must_use]
pub fn main() -> ExitCode {
    threads::on_own_stack(command).unwrap_or_else(|e| failed(&e))
}

fn command() -> ExitCode {
    interrupt::survive_large_files();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(e) => {
            match e.kind() {
                ErrorKind::DisplayHelp
                | ErrorKind::DisplayVersion
                | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => match e.print() {
                    Err(unwritten) if unwritten.kind() != std::io::ErrorKind::BrokenPipe => {
                        return failed(&Error::io("standard output", "write", unwritten));
                    }
                    _ => (),
                },
                _ => output::log(&output::one_line(&usage::one_line(&e, std::env::args_os()))),
            }
            return ExitCode::from(u8::try_from(e.exit_code()).unwrap_or(2));
        }
    };
    match run(cli) {
        Ok(Verdict::Done) => ExitCode::SUCCESS,
        Ok(Verdict::Negative) => ExitCode::from(1),
        Err(e) => failed(&e),
    }
}

fn failed(e: &Error) -> ExitCode {
    output::log_failure(e);
    ExitCode::from(e.exit_code())
}

fn run(cli: Cli) -> Result<Verdict> {
    match cli.command {
        Command::Render(args) => render::run(Render::try_from(args)?),
        Command::Info(args) => info::run(args),
        Command::Scene(args) => scene::run(args),
        Command::Explain(args) => explain::run(&Explain::try_from(args)?),
        Command::Compare(args) => compare::run(&Compare::try_from(args)?),
        Command::Parity(args) => parity::run(&Parity::from(args)),
        Command::Verify(args) => verify::run(&Verify::try_from(args)?),
        Command::Bench(args) => bench::run(&Bench::try_from(args)?),
        Command::Pixel(args) => pixel::run(&Pixel::try_from(args)?),
        Command::Price(args) if args.formulas.formulas => {
            formulas::run(&Formulas::new(args.formulas, args.bvh, args.json)?)
        }
        Command::Price(args) if args.reflections.reflections => reflections::run(&Reflections::try_from(args)?),
        Command::Price(args) => price::run(Price::try_from(args)?),
        Command::Map(args) => map::run(&Map::try_from(args)?),
        Command::Doctor(args) => doctor::run(args.json),
    }
}
