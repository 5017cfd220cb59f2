//! Warns where flags from the environment have taken the place of the project's own `target-cpu`.

use std::env::var;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=RUSTFLAGS");
    println!("cargo:rerun-if-env-changed=CARGO_ENCODED_RUSTFLAGS");

    let features = var("CARGO_CFG_TARGET_FEATURE").unwrap_or_default();
    let has = |name| features.split(',').any(|f| f == name);
    let x86 = var("CARGO_CFG_TARGET_ARCH").is_ok_and(|arch| arch == "x86_64");
    // Cargo hands on the flags in force, with 0x1f between them, wherever they came from.
    let flags = var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default().replace('\x1f', " ");
    if x86 && !(has("avx2") && has("fma")) && !flags.contains("target-cpu") {
        println!(
            "cargo:warning=built without AVX2 and FMA: eight lanes become two halves, slower and less exact. The flags in \
             force (`{flags}`) hold no target-cpu, since RUSTFLAGS or CARGO_ENCODED_RUSTFLAGS in the environment replaces \
             the one in .cargo/config.toml. Cure: unset them, or add `-C target-cpu=native`."
        );
    }
}
