//! Warnings about scenes and pictures: each fires on its case, says the same everywhere, and is silent on sound scenes.

mod support;

mod documented;
mod losses;
mod truncated;
