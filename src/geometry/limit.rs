//! The limit on coordinates.

/// The largest magnitude of a coordinate that takes part in intersection, in scene units. Below it areas stay finite in
/// `f32`. It is the largest number below Embree's exclusive bound, 1.844e18 (`FLT_LARGE`).
pub const COORDINATE_LIMIT: f32 = 1.844e18_f32.next_down();
