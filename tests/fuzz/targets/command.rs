//! Whole command lines: arguments parted by line ends. The program is the one that `VITRUM_BIN` names.

#![no_main]

#[allow(dead_code, reason = "each target needs a part of it")]
#[path = "../command.rs"]
mod command;
#[allow(dead_code, reason = "each target needs a part of it")]
#[path = "../entry.rs"]
mod entry;

use std::path::PathBuf;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let program = std::env::var_os("VITRUM_BIN").map(PathBuf::from).expect("VITRUM_BIN names the program to run");
    let text = String::from_utf8_lossy(bytes);
    let words: Vec<String> = text.lines().map(str::to_owned).collect();
    command::run(&program, &words, 10);
});
