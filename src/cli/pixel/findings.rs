//! Results of `vitrum pixel`.

use super::align::Row;
use super::condition::Condition;
use super::options::Pixel;
use crate::render::record::Tree;
use crate::scene::Scene;

/// A pixel in one renderer.
pub(super) struct Side {
    pub radiance: [f64; 3],
    pub truncated: [f64; 3],
    pub tree: Tree,
}

/// Results on the pixel.
pub(super) struct Findings<'a> {
    pub job: &'a Pixel,
    pub scene: &'a Scene,
    pub narrow: Side,
    pub wide: Side,
    pub rows: Vec<Row>,
    /// One condition for each ray of the pixel that is shown.
    pub conditions: Vec<Condition>,
}
