//! The command line: a folder per command, with its flags (`args`), their validation (`options`) and the command itself.

mod args;
mod backend;
mod bench;
mod budget;
mod choice;
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
mod render;
mod scene;
mod summary;
mod systems;
mod table;
mod unmatched;
mod usage;
mod verify;
mod view;
mod warnings;

use std::process::ExitCode;

use clap::Parser as _;
use clap::error::ErrorKind;

use crate::system::threads;
use crate::{Error, Result};
use args::{Cli, Command};

/// Result of a command that met no error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    /// Done, or a check that succeeded.
    Done,
    /// A comparison or check that failed.
    Negative,
}

/// Runs the program on the process's own arguments, on a thread of its own. An error is one line on standard error; the exit code is
/// [`crate::Error::exit_code`].
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
        Command::Render(args) => render::run(options::Render::try_from(args)?),
        Command::Info(args) => info::run(args),
        Command::Scene(args) => scene::run(args),
        Command::Explain(args) => explain::run(&options::Explain::try_from(args)?),
        Command::Compare(args) => compare::run(&options::Compare::try_from(args)?),
        Command::Parity(args) => parity::run(&options::Parity::from(args)),
        Command::Verify(args) => verify::run(&options::Verify::try_from(args)?),
        Command::Bench(args) => bench::run(&options::Bench::try_from(args)?),
        Command::Pixel(args) => pixel::run(&options::Pixel::try_from(args)?),
        Command::Price(args) if args.formulas.formulas => formulas::run(&options::Formulas::try_from(args)?),
        Command::Price(args) => price::run(options::Price::try_from(args)?),
        Command::Map(args) => map::run(&options::Map::try_from(args)?),
        Command::Doctor(args) => doctor::run(args.json),
    }
}
