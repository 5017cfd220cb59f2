//! The program: fit for this machine? Then do what the command line says.

use std::process::ExitCode;

fn main() -> ExitCode {
    match vitrum::simd::level::check() {
        Ok(()) => vitrum::cli::main(),
        Err(_) => ExitCode::from(vitrum::simd::level::EXIT_CODE),
    }
}
