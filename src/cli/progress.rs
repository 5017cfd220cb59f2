//! Progress bar with the remaining time, on a terminal.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::render::Observer;
use crate::system::threads;

/// Interval between updates of the bar.
const TICK: Duration = Duration::from_millis(100);

/// Runs `work`. Meanwhile, if `show`, a bar on standard error follows `observer` up to `pixels`. Nothing is drawn if
/// standard error is no terminal, and the bar is removed afterwards.
pub(super) fn follow<T>(observer: &Observer, pixels: u64, show: bool, work: impl FnOnce() -> T) -> T {
    let bar = ProgressBar::with_draw_target(Some(pixels), ProgressDrawTarget::stderr());
    if !show || bar.is_hidden() {
        return work();
    }
    let style = ProgressStyle::with_template("{elapsed:>4} [{bar:40}] {percent:>3} %, {eta} left");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
    let done = AtomicBool::new(false);
    thread::scope(|scope| {
        let ticker = threads::worker().spawn_scoped(scope, || {
            while !done.load(Ordering::Relaxed) {
                bar.set_position(observer.pixels_done.load(Ordering::Relaxed));
                thread::park_timeout(TICK);
            }
            bar.finish_and_clear();
        });
        // Ends the ticker also if `work` unwinds; otherwise the scope would wait for it forever. If the ticker could
        // not be started, the bar stands still.
        let _end = ticker.ok().map(|ticker| EndTicker { done: &done, ticker: ticker.thread().clone() });
        work()
    })
}

/// Runs `work`, which may take up to `limit` and reports its current step. Meanwhile, if `show`, a bar on standard
/// error follows the clock. Nothing is drawn if standard error is no terminal, and the bar is removed afterwards.
pub(super) fn session<T>(limit: Duration, show: bool, work: impl FnOnce(&(dyn Fn(&str) + Sync)) -> T) -> T {
    let bar = ProgressBar::with_draw_target(Some(limit.as_secs()), ProgressDrawTarget::stderr());
    if !show || bar.is_hidden() {
        return work(&|_| {});
    }
    let style = ProgressStyle::with_template("{elapsed:>4} [{bar:24}] {prefix} left  {wide_msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
    let done = AtomicBool::new(false);
    thread::scope(|scope| {
        let ticker = threads::worker().spawn_scoped(scope, || {
            while !done.load(Ordering::Relaxed) {
                let left = limit.saturating_sub(bar.elapsed()).as_secs();
                bar.set_position(limit.as_secs() - left);
                bar.set_prefix(format!("{}:{:02}", left / 60, left % 60));
                thread::park_timeout(TICK);
            }
            bar.finish_and_clear();
        });
        let _end = ticker.ok().map(|ticker| EndTicker { done: &done, ticker: ticker.thread().clone() });
        work(&|what| bar.set_message(what.to_owned()))
    })
}

struct EndTicker<'a> {
    done: &'a AtomicBool,
    ticker: thread::Thread,
}

impl Drop for EndTicker<'_> {
    fn drop(&mut self) {
        self.done.store(true, Ordering::Relaxed);
        self.ticker.unpark();
    }
}
