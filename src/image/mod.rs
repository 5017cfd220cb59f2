//! Pictures: the film, and reading, writing and comparing picture files.

mod common;
mod compare;
mod encode;
mod exr;
mod file;
mod film;
mod format;
mod hdr;
mod part;
mod pfm;
mod png;
mod read;
mod samples;
mod save;
mod ssim;
mod write;

pub use compare::{Comparison, Worst, compare, difference};
pub use encode::{Clipped, linear_from_srgb, srgb_from_linear};
pub use file::{Encoding, encode};
pub use film::{Film, MOST_PIXELS};
pub use format::{Bits, Encoded, Format};
pub use read::{Limits, Picture, ReadOptions, decode_stored, read, read_stored};
pub use samples::{Samples, Stored};
pub use save::save;
pub use write::{Destination, discard_unfinished, discard_unfinished_at_once};
