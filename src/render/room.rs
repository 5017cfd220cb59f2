//! Whether there is memory for a picture, asked before the work and not found out in its middle.

use super::accumulate::PixelMean;
use crate::scene::Settings;
use crate::{Error, Result};

/// Bytes a pixel takes at the worst moment, when the tiles become the film: radiance, truncated weight and limit in each.
/// The encoded file, made when the tiles are gone, is smaller.
const BYTES_A_PIXEL: usize = 2 * size_of::<PixelMean>();

/// What everything else may take meanwhile: queues, stacks of threads, the pieces between blocks.
const ASIDE: usize = 64 << 20;

/// Asks the system for as much memory as a picture of this size will take, and gives it back.
///
/// # Errors
/// [`Error::Limit`], where the system does not give it.
pub(super) fn check(settings: &Settings) -> Result<()> {
    let pixels = settings.width as usize * settings.height as usize;
    let needed = pixels.saturating_mul(BYTES_A_PIXEL);
    let given = Vec::<u8>::new().try_reserve_exact(needed.saturating_add(needed / 16).saturating_add(ASIDE));
    given.map_err(|_| {
        let gibibytes = needed as f64 / f64::from(1 << 30);
        Error::Limit(format!(
            "a picture of {} by {} pixels takes {gibibytes:.1} GiB while it is rendered, more than the system gives this \
             program; ask for fewer pixels",
            settings.width, settings.height
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_that_no_memory_holds_is_a_limit_and_a_small_one_is_none() {
        let settings = |width, height| Settings { width, height, ..Settings::default() };
        assert!(check(&settings(640, 480)).is_ok());
        let refused = check(&settings(u32::MAX, u32::MAX)).unwrap_err();
        assert_eq!(refused.exit_code(), 4);
        assert!(refused.to_string().contains("4294967295 by 4294967295"), "{refused}");
    }
}
