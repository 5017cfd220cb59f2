//! The `f64` arbiter.
