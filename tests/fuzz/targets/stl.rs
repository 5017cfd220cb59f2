#![no_main]

#[allow(dead_code, reason = "each target needs a part of it")]
#[path = "../entry.rs"]
mod entry;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    entry::load(entry::Kind::Stl, bytes);
});
