//! Errors that Embree reports, as errors of this crate.

use std::ffi::c_int;

use crate::error::{Error, Unavailable};
use crate::system::memory;

/// Cure in messages about a lack of memory for Embree.
pub(super) const WITHOUT: &str = "use the native back end";

/// The code of `RTC_ERROR_OUT_OF_MEMORY`.
const OUT_OF_MEMORY: c_int = 4;

/// Converts an error code of Embree with its message.
pub(super) fn reported(code: c_int, message: String) -> Error {
    if code == OUT_OF_MEMORY {
        memory::ran_out("Embree's hierarchy", WITHOUT)
    } else {
        Unavailable::Failed(message).into()
    }
}

/// Name of an `RTCError` in words.
pub(super) fn error_name(code: c_int) -> &'static str {
    match code {
        1 => "unknown error",
        2 => "invalid argument",
        3 => "invalid operation",
        4 => "out of memory",
        5 => "unsupported CPU",
        6 => "cancelled",
        _ => "error",
    }
}
