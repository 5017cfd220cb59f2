//! What accuracy costs.

pub mod formulas;
