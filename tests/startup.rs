//! The check at start-up on machines that lack what the binary was built for, played by an emulator.
#![cfg(all(target_arch = "x86_64", target_os = "linux"))]

use std::process::{Command, Output};

/// The program on an emulated CPU; none where there is no emulator (`apt-get install qemu-user`).
fn on_cpu(model: &str) -> Option<Output> {
    let program = assert_cmd::cargo::cargo_bin("vitrum");
    let output = Command::new("qemu-x86_64").args(["-cpu", model]).arg(program).arg("--version").output();
    if output.is_err() {
        eprintln!("SKIPPED: qemu-x86_64 is not there to play {model}; `apt-get install qemu-user` brings it");
    }
    output.ok()
}

#[test]
fn a_cpu_without_the_built_level_gets_a_message_and_not_an_illegal_instruction() {
    if !vitrum::simd::level::BUILT.contains("AVX") {
        return;
    }
    // From the plainest x86-64 over one without AVX to those that lack only what their names say.
    for model in ["qemu64", "Nehalem", "Haswell,-avx2", "max,-fma,-bmi1,-movbe", "max,-xsave"] {
        let Some(output) = on_cpu(model) else { return };
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(4), "{model}: {said}");
        let line = said.lines().find(|line| line.starts_with("error: this machine lacks")).unwrap_or_default();
        let words: Vec<_> = line.split([' ', ',']).collect();
        let lacking = if model.contains("avx2") { "avx2" } else { "fma" };
        assert!(words.contains(&lacking), "{model}: {said}");
        assert!(output.stdout.is_empty(), "{model}");
    }
}
