//! Refraction that ends in an environment map.

use super::formula::RefractionFormula;

/// One bend by Snell's law where light enters a body. A map of the body's surroundings is looked up in the direction of
/// the bent light. Its way out of the body is left out.
#[derive(Clone, Copy, Debug, Default)]
pub struct MapOne;

/// Two bends by Snell's law, where light enters a body and where it leaves, and then a lookup in a map of the body's
/// surroundings. The thickness in between is estimated from the back side of the body.
#[derive(Clone, Copy, Debug, Default)]
pub struct MapTwo;

impl RefractionFormula for MapOne {
    const MAPPED: bool = true;
}

impl RefractionFormula for MapTwo {
    const MAPPED: bool = true;
}
