//! Cost of accuracy: pictures of one scene by different choices, each timed beside the default and compared with the
//! `f64` renderer with the exact choices.
//!
//! [`Axis`] lists the choices, [`Variant`] holds one level of each, and [`Engine`] renders its picture.
//! [`run`](run::run) times and judges every level of every axis with the others at their defaults. It then measures the
//! product of the axes that matter, within a time limit. Measurements are kept in a [`Journal`], from which a later run
//! continues. [`formulas`] studies one formula at a time.

pub mod axis;
pub mod budget;
pub mod condition;
pub mod csv;
pub mod digest;
pub mod energy;
pub mod engine;
pub mod errors;
pub mod formulas;
pub mod front;
pub mod html;
pub mod journal;
pub mod plan;
pub mod reference;
pub mod reflections;
pub mod report;
pub mod run;
mod session;
pub mod size;
pub mod spheres;
mod subject;
pub mod systems;
pub mod text;
mod turns;
pub mod variant;

pub use axis::{Axis, Level, Precision, Spheres};
pub use engine::Engine;
pub use errors::Errors;
pub use journal::Journal;
pub use report::Report;
pub use subject::{Subject, Watch};
pub use variant::Variant;
