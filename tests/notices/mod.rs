//! Warnings about scenes and pictures: each fires on its case, says the same everywhere, and is silent on sound scenes.

mod support;

mod bundled;
#[cfg(feature = "cli")]
mod commands;
mod documented;
mod empty;
#[cfg(feature = "cli")]
mod inside_out;
mod losses;
mod low_poly;
mod truncated;
mod unlit;
