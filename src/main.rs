//! The program: checks that this machine has the instructions of the build, and runs the command line.

mod allocator;

use std::process::ExitCode;

fn main() -> ExitCode {
    match vitrum::simd::level::check() {
        Ok(()) => {
            allocator::keep_to_limits();
            vitrum::cli::main()
        }
        Err(_) => ExitCode::from(vitrum::simd::level::EXIT_CODE),
    }
}
