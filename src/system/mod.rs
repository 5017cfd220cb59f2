//! Limits of the machine: memory, threads and files, checked before they are used.

pub mod files;
pub mod left;
pub mod memory;
pub mod threads;
