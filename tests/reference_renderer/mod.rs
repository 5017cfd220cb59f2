//! The `f64` renderer gives the values that can be worked out by hand.

mod build;
mod glass;
mod lights;
mod media;
mod picture;
mod soft;
mod surfaces;
