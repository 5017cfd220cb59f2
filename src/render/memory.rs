//! Memory checks before a render.

use super::accumulate::PixelMean;
use crate::Result;
use crate::scene::Settings;
use crate::system::memory;

/// Peak number of bytes per pixel. When tiles are copied to the film, radiance, truncated weight and limit exist twice.
/// While the film is encoded they exist once, beside up to 28 bytes for the encoder.
const BYTES_A_PIXEL: u64 = 2 * size_of::<PixelMean>() as u64;

/// Bytes per thread for queues, streams and scratch memory, excluding queues that grow with depth.
const BYTES_A_THREAD: u64 = 4 << 20;

/// Checks that a picture of this size fits in memory.
///
/// # Errors
/// Returns [`crate::Error::Limit`] if it does not fit.
pub fn need(settings: &Settings) -> Result<()> {
    let pixels = u64::from(settings.width) * u64::from(settings.height);
    let what = format!("a picture of {} by {} pixels", settings.width, settings.height);
    memory::need(&what, pixels.saturating_mul(BYTES_A_PIXEL), "ask for fewer pixels")
}

/// Checks that a picture of this size and the queues of `threads` threads fit in memory.
///
/// # Errors
/// Returns [`crate::Error::Limit`] if they do not fit.
pub(super) fn need_with(settings: &Settings, threads: usize) -> Result<()> {
    need(settings)?;
    let pixels = u64::from(settings.width) * u64::from(settings.height);
    let (width, height) = (settings.width, settings.height);
    let what = format!("a picture of {width} by {height} pixels and the queues of {threads} threads");
    let bytes = pixels.saturating_mul(BYTES_A_PIXEL).saturating_add(threads as u64 * BYTES_A_THREAD);
    memory::need(&what, bytes, "ask for fewer threads or pixels")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_that_no_memory_holds_is_a_limit_and_a_small_one_is_none() {
        let settings = |width, height| Settings { width, height, ..Settings::default() };
        assert!(need(&settings(640, 480)).is_ok());
        let refused = need(&settings(u32::MAX, u32::MAX)).unwrap_err();
        assert_eq!(refused.exit_code(), 4);
        assert!(refused.to_string().contains("4294967295 by 4294967295"), "{refused}");
    }
}
