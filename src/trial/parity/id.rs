//! Names of primitives.

/// Instance, geometry and primitive of a hit.
pub type Id = (u32, u32, u32);
