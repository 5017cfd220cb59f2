//! Accelerators of each back end.

use std::io::Write as _;

use vitrum::accel::{Accel, Backend, BuildOptions};
use vitrum::error::Unavailable;
use vitrum::geometry::Geometry;

/// Native over `geometry`.
pub fn native(geometry: &[Geometry]) -> Accel {
    Accel::build(Backend::Native, geometry, BuildOptions::default()).expect("there is memory for a test")
}

/// Embree over `geometry`; none where it is not compiled in or not on this machine. The second is said on the terminal, and
/// is a failure where VITRUM_REQUIRE_EMBREE is set.
pub fn embree(backend: Backend, geometry: &[Geometry]) -> Option<Accel> {
    is_there(backend)
        .then(|| Accel::build(backend, geometry, BuildOptions::default()).unwrap_or_else(|e| panic!("{e}")))
}

/// Returns true if a back end is compiled in and on this machine, as [`embree`] needs it.
pub fn is_there(backend: Backend) -> bool {
    let there = backend.availability();
    if let Err(why) = &there
        && *why != Unavailable::NotCompiledIn
    {
        assert!(std::env::var_os("VITRUM_REQUIRE_EMBREE").is_none(), "{why}");
        // Past the test harness, which shows nothing of what passes.
        writeln!(std::io::stderr(), "SKIPPED a part with Embree: {why}").ok();
    }
    there.is_ok()
}
