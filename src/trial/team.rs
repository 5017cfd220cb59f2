//! Threads that wait for work between runs, so that none is started during a timing.

use std::sync::{Mutex, PoisonError};

use crate::Result;
use crate::system::threads;

/// Group of threads.
pub struct Team {
    pool: rayon::ThreadPool,
    threads: usize,
}

impl Team {
    /// Starts `threads` threads, at least one.
    ///
    /// # Errors
    /// A limit, if the system starts no more threads.
    pub fn new(threads: usize) -> Result<Self> {
        let pool = threads::pool(threads.max(1))?;
        Ok(Self { pool, threads: threads.max(1) })
    }

    /// Number of threads.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// Runs `work` with the team as rayon's pool.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.pool.install(work)
    }

    /// Distributes `pieces` one by one to free threads. Each thread creates a state first.
    pub fn share<T: Send, S>(
        &self,
        pieces: impl Iterator<Item = T> + Send,
        state: impl Fn() -> S + Sync,
        work: impl Fn(&mut S, T) + Sync,
    ) {
        let pieces = Mutex::new(pieces);
        self.pool.broadcast(|_| {
            let mut state = state();
            loop {
                let piece = pieces.lock().unwrap_or_else(PoisonError::into_inner).next();
                let Some(piece) = piece else { break };
                work(&mut state, piece);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    #[test]
    fn every_piece_is_worked_on_once() {
        for threads in [1, 2, 5] {
            let mut done = vec![0; 1000];
            let states = AtomicUsize::new(0);
            let team = Team::new(threads).unwrap();
            team.share(done.iter_mut(), || states.fetch_add(1, Ordering::Relaxed), |_, piece| *piece += 1);
            assert!(done.iter().all(|&n| n == 1));
            assert_eq!((states.into_inner(), team.threads()), (threads, threads));
        }
    }
}
