//! Trials: comparisons of back ends on the same rays, and hard cases for each. All but `verify` and `frames`, which
//! also render, depend on shapes and accelerators, and not on scenes or materials.

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
pub mod streams;
pub mod team;
pub mod text;
pub mod timing;
pub mod verify;

pub use rays::{Picture, RayKind, RaySet, View};
pub use report::Report;
pub use run::{BenchPlan, BenchSubject, Outcome};
pub use timing::Watch;
