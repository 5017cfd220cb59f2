//! Ctrl-C, and the system's own wish that the program ended.
//!
//! The first one asks the render to stop, which it does between packets; whatever still runs after [`PATIENCE`] is
//! ended from outside. The second one, and any outside a render, ends the program at once. Neither leaves a file behind.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use super::output;
use crate::image::discard_unfinished;
use crate::render::Observer;
use crate::system::threads;
use crate::{Error, Result};

/// How long the program may take to end by itself.
const PATIENCE: Duration = Duration::from_millis(800);

/// Whether the work under way looks at [`Observer::stop`].
static HEEDED: AtomicBool = AtomicBool::new(false);

/// Whether what is left to do is to keep what was done.
static WAIT: AtomicBool = AtomicBool::new(false);

/// Has Ctrl-C set `observer.stop`.
///
/// # Errors
/// A limit, where the system does not let the program listen.
pub(super) fn listen(observer: &Arc<Observer>) -> Result<()> {
    let observer = Arc::clone(observer);
    let on_signal = move || {
        let again = observer.stop.swap(true, Ordering::SeqCst);
        if again || !HEEDED.load(Ordering::SeqCst) {
            leave();
        }
        let waiting = threads::worker().spawn(|| {
            thread::sleep(PATIENCE);
            if !WAIT.load(Ordering::SeqCst) {
                leave();
            }
        });
        if waiting.is_err() {
            leave();
        }
    };
    // Its own thread; the library does not say why it failed to start one.
    threads::need(1)?;
    ctrlc::set_handler(on_signal)
        .map_err(|e| Error::Limit(format!("cannot listen for Ctrl-C: {e}; raise the limit on processes (`ulimit -u`)")))
}

/// Has a write beyond the limit on file sizes (`ulimit -f`) fail, where the system's signal for it (SIGXFSZ) would end the
/// program.
pub(super) fn survive_large_files() {
    // A handler that does nothing but set a flag, which nobody reads. Without it the signal stays deadly, no worse.
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
}

/// Runs `work`, which looks at [`Observer::stop`].
pub(super) fn heeded<T>(work: impl FnOnce() -> T) -> T {
    HEEDED.store(true, Ordering::SeqCst);
    let result = work();
    HEEDED.store(false, Ordering::SeqCst);
    result
}

/// From here on the work ends by itself, however long that takes; a second Ctrl-C still ends the program at once.
pub(super) fn wait_for_the_end() {
    WAIT.store(true, Ordering::SeqCst);
}

fn leave() -> ! {
    discard_unfinished();
    output::log_failure(&Error::Interrupted);
    let code = i32::from(Error::Interrupted.exit_code());
    // Other threads are at work yet, some of them in Embree, whose own tidying up at a proper exit would pull the ground
    // from under them.
    #[cfg(unix)]
    signal_hook::low_level::exit(code);
    #[cfg(not(unix))]
    std::process::exit(code)
}
