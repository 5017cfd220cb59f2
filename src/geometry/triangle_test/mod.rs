//! Ray/triangle tests to be compared. Each is a type, so that measurements contain no branch on the choice.
//!
//! The renderer uses [`Watertight`]. The others are measured against it, by speed and by lost hits. Speed: `cargo bench --bench
//! triangle`, `vitrum price --formulas --of triangle`; on whole pictures `vitrum render --triangles` and `vitrum price --axes
//! triangles,reciprocal`. Lost hits: shares of 2000 rays that leave a closed ball with bumps (1520 triangles, about the
//! origin) and hit nothing, with fused products:
//!
//! | test | at random | at corners | at edges |
//! |---|---|---|---|
//! | plane and areas | 0 | 6.4 % | 14.3 % |
//! | Möller-Trumbore | 0 | 26.3 % | 16.5 % |
//! | Plücker | 0 | 0.05 % | 0 |
//! | watertight | 0 | 0 | 0 |
//! | certified | 0 | 0 | 0 |
//!
//! Random rays reveal no leak of any test: a check for leaks must aim at corners and edges. (Far from the origin, at
//! (148376, 1234, -223423), the plane-and-area test loses 2.8 % of the random rays, too.)

mod certified;
mod exact;
mod formula;
mod lanes;
mod moller_trumbore;
mod plane_area;
mod pluecker;
mod watertight;

pub use certified::Certified;
pub use formula::{Meeting, TriangleTest};
pub use lanes::Lanes;
pub use moller_trumbore::MollerTrumbore;
pub use plane_area::PlaneArea;
pub use pluecker::Pluecker;
pub use watertight::Watertight;

crate::choice! {
    /// Ray/triangle test of the walk with one ray at a time.
    pub enum TriangleModel("triangles", derive(Eq, Hash), visitor(TriangleVisitor, TriangleTest)) {
        /// Plane and signed areas, from the lecture notes.
        "plane-area" => PlaneArea by PlaneArea,
        /// Test of Möller and Trumbore.
        "moller-trumbore" => MollerTrumbore by MollerTrumbore,
        /// Plücker coordinates, as in Embree's robust mode.
        "pluecker" => Pluecker by Pluecker,
        /// Watertight test of Woop, Benthin and Wald, as in the native back end.
        "watertight" | "woop" => Watertight by Watertight,
        /// f32 with a bound on its error, and f64 where that does not decide.
        "certified" => Certified by Certified,
    }
}
