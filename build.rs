//! Warns where the build is for less than AVX2 and FMA although nobody asked for that.

use std::env::var;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=RUSTFLAGS");
    println!("cargo:rerun-if-env-changed=CARGO_ENCODED_RUSTFLAGS");

    let architecture = var("CARGO_CFG_TARGET_ARCH").unwrap_or_default();
    let features = var("CARGO_CFG_TARGET_FEATURE").unwrap_or_default();
    // Cargo sets this for build scripts: the flags in force, wherever they came from, with 0x1f between them.
    let flags = var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default().replace('\x1f', " ");
    if let Some(warning) = diagnosis(&architecture, &features, &flags) {
        println!("cargo:warning={warning}");
    }
}

/// The warning for a target architecture, its enabled features (with commas between them) and the compiler flags in force.
///
/// A script cannot tell whether the flags come from a `.cargo/config.toml` or from RUSTFLAGS, nor whose crate is the main
/// one. Each sentence is true in all of these cases.
pub(crate) fn diagnosis(architecture: &str, features: &str, flags: &str) -> Option<String> {
    let has = |name| features.split(',').any(|feature| feature == name);
    if architecture != "x86_64" || (has("avx2") && has("fma")) || flags.contains("target-cpu") {
        return None;
    }
    let (found, because) = if flags.trim().is_empty() {
        (
            String::from("no compiler flags are set"),
            "Cargo reads .cargo/config.toml in the folder that it is started in and those above, never in that of a \
             dependency.",
        )
    } else {
        (
            format!("the compiler flags in force, `{flags}`, hold no target-cpu"),
            "RUSTFLAGS replaces those of a config.toml.",
        )
    };
    Some(format!(
        "built without AVX2 and FMA, slower and less exact: {found}. {because} Cure: put `-C target-cpu=native` (for \
         every machine with AVX2: `-C target-cpu=x86-64-v3`) into RUSTFLAGS if that is set, else write [build] rustflags = \
         [\"-C\", \"target-cpu=native\"] into the .cargo/config.toml of the project that you build."
    ))
}
