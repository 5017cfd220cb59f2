//! Ctrl-C, and the system's request to end the program.
//!
//! The first one asks the render to stop, which it does between packets. Work that still runs after [`PATIENCE`] is ended
//! from outside. The second one, and any outside a render, ends the program at once. Neither leaves a file behind.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use super::output;
use crate::image::discard_unfinished;
use crate::render::Observer;
use crate::system::threads;
use crate::{Error, Result};

/// Time that the program may take to end by itself.
const PATIENCE: Duration = Duration::from_millis(800);

/// True if the current work tests [`Observer::stop`].
static HEEDED: AtomicBool = AtomicBool::new(false);

/// True if only results remain to be saved.
static WAIT: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C set `observer.stop`.
///
/// # Errors
/// A limit if the system refuses the signal handler.
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
    // For the library's own thread, since the library does not report why it could not start one.
    threads::need(1)?;
    ctrlc::set_handler(on_signal)
        .map_err(|e| Error::Limit(format!("cannot listen for Ctrl-C: {e}; raise the limit on processes (`ulimit -u`)")))
}

/// Makes a write beyond the limit on file sizes (`ulimit -f`) fail. By default the system's signal for it (SIGXFSZ)
/// would end the program.
pub(super) fn survive_large_files() {
    // The handler only sets a flag that nothing reads. If it cannot be set, the signal still ends the program, as
    // before.
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
}

/// Runs `work`, which tests [`Observer::stop`].
pub(super) fn heeded<T>(work: impl FnOnce() -> T) -> T {
    HEEDED.store(true, Ordering::SeqCst);
    let result = work();
    HEEDED.store(false, Ordering::SeqCst);
    result
}

/// Lets the work end by itself, however long that takes. A second Ctrl-C still ends the program at once.
pub(super) fn wait_for_the_end() {
    WAIT.store(true, Ordering::SeqCst);
}

fn leave() -> ! {
    discard_unfinished();
    output::log_failure(&Error::Interrupted);
    let code = i32::from(Error::Interrupted.exit_code());
    // Other threads are still running, some of them in Embree, whose cleanup at a proper exit would free what they use.
    #[cfg(unix)]
    signal_hook::low_level::exit(code);
    #[cfg(not(unix))]
    std::process::exit(code)
}
