//! Our own 8-wide hierarchy.
