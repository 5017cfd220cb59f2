//! The build script's warning is true of a checkout and of a dependency alike.

#[path = "../build.rs"]
#[expect(dead_code, reason = "`main` is for Cargo")]
mod build;

use build::diagnosis;

/// Features that rustc enables for plain x86-64.
const PLAIN: &str = "fxsr,sse,sse2,x87";

#[test]
fn a_build_for_avx2_and_fma_or_for_a_cpu_that_was_named_gets_no_warning() {
    assert_eq!(diagnosis("x86_64", "avx,avx2,fma,fxsr,sse,sse2", ""), None);
    assert_eq!(diagnosis("x86_64", PLAIN, "-C target-cpu=x86-64"), None);
    assert_eq!(diagnosis("x86_64", PLAIN, "-Ctarget-cpu=sandybridge -C opt-level=3"), None);
    assert_eq!(diagnosis("aarch64", "neon", ""), None);
}

#[test]
fn without_flags_no_variable_is_blamed_for_replacing_any() {
    let warning = diagnosis("x86_64", PLAIN, "").expect("a warning");
    assert!(warning.contains("no compiler flags are set") && !warning.contains("replaces"), "{warning}");
    assert!(warning.contains("never in that of a dependency") && warning.contains("-C target-cpu=native"), "{warning}");
}

#[test]
fn flags_without_a_cpu_are_quoted() {
    for (features, flags) in [(PLAIN, "-C debuginfo=1"), ("avx,avx2,sse2", "-C target-feature=+avx2")] {
        let warning = diagnosis("x86_64", features, flags).expect("a warning");
        assert!(warning.contains(&format!("`{flags}`, hold no target-cpu")), "{warning}");
        assert!(warning.contains("RUSTFLAGS replaces") && !warning.contains('\n'), "{warning}");
    }
}
