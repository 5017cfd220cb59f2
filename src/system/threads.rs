//! Threads, with stacks of a fixed size that is asked for before they start.

use std::sync::{Mutex, PoisonError};
use std::thread::{self, Builder};

use super::memory;
use crate::{Error, Result};

/// Bytes of a worker's stack.
const STACK: usize = 2 << 20;

/// Bytes of the stack that a command runs on. The limit on the main thread's stack (`ulimit -s`) is not its concern.
const COMMAND_STACK: usize = 8 << 20;

/// Address space that a thread takes beside its stack: guard pages, a stack for signals, its first small blocks.
const BESIDE: usize = 256 << 10;

const CURE: &str = "ask for fewer with --threads";

/// Checks that `count` workers can be given stacks.
///
/// # Errors
/// [`Error::Limit`], where there is no memory for them.
pub fn need(count: usize) -> Result<()> {
    let bytes = (count as u64).saturating_mul((STACK + BESIDE) as u64);
    memory::need(&counted(count), bytes, CURE)
}

/// Returns the number of threads for a request; 0 means one per processor.
#[must_use]
pub fn count(asked: usize) -> usize {
    match asked {
        0 => thread::available_parallelism().map_or(1, usize::from),
        n => n,
    }
}

fn counted(count: usize) -> String {
    if count == 1 { String::from("the stack of 1 thread") } else { format!("the stacks of {count} threads") }
}

/// A worker to be spawned, after [`need`].
pub fn worker() -> Builder {
    Builder::new().stack_size(STACK)
}

/// A pool of `count` workers.
///
/// # Errors
/// [`Error::Limit`], where they cannot be started.
pub fn pool(count: usize) -> Result<rayon::ThreadPool> {
    need(count)?;
    rayon::ThreadPoolBuilder::new().num_threads(count).stack_size(STACK).build().map_err(|e| refused(count, &e))
}

/// Checks that the system starts `count` threads now, on behalf of a library that would end the process where it does not.
///
/// # Errors
/// [`Error::Limit`], where it does not.
pub fn probe(count: usize) -> Result<()> {
    /// Bytes of a stack on which nothing is done.
    const LITTLE: usize = 64 << 10;
    let gate = Mutex::new(());
    thread::scope(|scope| {
        // All of them wait, so that they are there at once. The guard is dropped before the scope waits for them.
        let _closed = gate.lock().unwrap_or_else(PoisonError::into_inner);
        for _ in 0..count {
            let started = Builder::new().stack_size(LITTLE).spawn_scoped(scope, || drop(gate.lock()));
            started.map_err(|e| refused(count, &e))?;
        }
        Ok(())
    })
}

/// Starts rayon's own pool, once for the whole program.
///
/// # Errors
/// [`Error::Limit`], where its workers cannot be started.
pub fn start_global_pool(count: usize) -> Result<()> {
    need(count)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).stack_size(STACK);
    pool.build_global().map_err(|e| refused(count, &e))
}

/// The error for threads that the system did not start.
pub fn refused(count: usize, why: &dyn std::fmt::Display) -> Error {
    let threads = if count == 1 { "thread" } else { "threads" };
    Error::Limit(format!("cannot start {count} {threads}: {why}; raise the limit on processes (`ulimit -u`) or {CURE}"))
}

/// Runs `command` on a thread with a large stack of its own. The main thread's stack may be smaller than a command
/// needs, and it grows into address space that may be gone by then.
///
/// # Errors
/// [`Error::Limit`], where there is no memory for the stack.
///
/// # Panics
/// If `command` panics.
pub fn on_own_stack<T: Send>(command: impl FnOnce() -> T + Send) -> Result<T> {
    memory::need("the start of the program", (COMMAND_STACK + 8 * BESIDE) as u64, "run it on a larger machine")?;
    thread::scope(|scope| {
        let builder = Builder::new().name(String::from("vitrum")).stack_size(COMMAND_STACK);
        let running = builder.spawn_scoped(scope, command);
        let running = running.map_err(|e| Error::Limit(format!("cannot start a thread: {e}; raise `ulimit -u`")))?;
        Ok(running.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pool_has_as_many_threads_as_asked_for_and_what_no_memory_holds_is_a_limit() {
        assert_eq!(pool(3).unwrap().current_num_threads(), 3);
        probe(3).unwrap();
        let refused = need(usize::MAX / 4).unwrap_err();
        assert_eq!(refused.exit_code(), 4);
        assert!(refused.to_string().contains("--threads"), "{refused}");
    }

    #[test]
    fn a_command_finds_megabytes_of_stack_whoever_calls() {
        fn deep(n: u32) -> u64 {
            let frame = std::hint::black_box([u64::from(n); 128]);
            if n == 0 { 0 } else { deep(n - 1) + u64::from(frame[n as usize % 128] == u64::from(n)) }
        }
        // 1.5 MiB at least, from a thread of 64 KiB.
        let caller = Builder::new().stack_size(64 << 10).spawn(|| on_own_stack(|| deep(1500)).unwrap());
        assert_eq!(caller.unwrap().join().unwrap(), 1500);
    }
}
