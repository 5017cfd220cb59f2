//! The program: fit for this machine? Then do what the command line says.

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
