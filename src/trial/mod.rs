//! Trials: back ends side by side on the same rays, and the hard cases fired at each. All but `verify` and `frames`,
//! which also render, know shapes and accelerators, neither scenes nor materials.

pub mod agree;
pub mod contender;
pub mod frames;
pub mod html;
pub mod parity;
pub mod plot;
mod prepacked;
pub mod rays;
pub mod report;
pub mod run;
pub mod shown;
pub mod team;
pub mod text;
pub mod timing;
pub mod verify;

pub use rays::{Picture, RayKind, RaySet, View};
pub use report::Report;
pub use run::{BenchPlan, Outcome, Subject};
pub use timing::Watch;
