//! Surfaces that touch: faces of different objects that lie at the same place, and spheres that touch something at a
//! point.
//!
//! Rounding decides which of two coincident faces a ray meets first, and moves the start of the next ray past both. So
//! coincidence is found before the first ray, from the shapes alone, and looked up where a ray arrives
//! ([`Contacts::faces_at`]). Two faces coincide where their distance is below [`tolerance`], the bound on the rounding of
//! `f32` positions there. Nothing here knows materials; the caller says which pairs of objects matter.

mod contacts;
mod face;
mod flat;
mod found;
mod grid;
mod join;
mod overlap;
mod repeats;
mod round;
mod tolerance;

use glam::DVec3;

use super::aabb::Aabb;
use super::shape::{Geometry, Shape};
pub use contacts::{Contacts, Pair, Tangent};
pub use face::{Face, Form};
use found::Found;
use tolerance::grown;
pub use tolerance::tolerance;

impl Contacts {
    /// Finds what touches in a list of shapes, for the pairs of objects that `matters` admits. A pair of equal numbers
    /// asks for duplicate triangles within one mesh.
    #[must_use]
    pub fn find(geometry: &[Geometry], matters: &(dyn Fn(usize, usize) -> bool + Sync)) -> Self {
        let bounds: Vec<Option<Aabb>> = geometry.iter().map(|g| bounds_of(&g.shape)).collect();
        let neighbours = neighbours(&bounds, matters);
        let mut found = Found::default();
        flat::find(geometry, &bounds, &neighbours, matters, &mut found);
        round::find(geometry, &neighbours, matters, &mut found);
        found.finish(geometry)
    }
}

/// None for a plane, which no box holds.
fn bounds_of(shape: &Shape) -> Option<Aabb> {
    match shape {
        Shape::Mesh(mesh) => Some(mesh.bounds()),
        Shape::Sphere(sphere) => Some(sphere.bounds()),
        Shape::Plane(_) => None,
    }
}

/// By object: the bounded objects whose boxes touch its own and that matter with it. Planes are in nobody's list.
fn neighbours(bounds: &[Option<Aabb>], matters: &(dyn Fn(usize, usize) -> bool + Sync)) -> Vec<Vec<u32>> {
    let mut neighbours = vec![Vec::new(); bounds.len()];
    let mut sorted: Vec<(usize, DVec3, DVec3)> = bounds
        .iter()
        .enumerate()
        .filter_map(|(o, b)| {
            let b = b.as_ref().filter(|b| !b.is_empty())?;
            let (lo, hi) = grown(b);
            Some((o, lo, hi))
        })
        .collect();
    sorted.sort_unstable_by(|a, b| a.1.x.total_cmp(&b.1.x).then(a.0.cmp(&b.0)));
    let mut active: Vec<(usize, DVec3, DVec3)> = Vec::new();
    for (object, lo, hi) in sorted {
        active.retain(|&(_, _, end)| end.x >= lo.x);
        for &(other, other_lo, other_hi) in &active {
            if lo.cmple(other_hi).all() && other_lo.cmple(hi).all() && matters(object, other) {
                neighbours[object].push(other as u32);
                neighbours[other].push(object as u32);
            }
        }
        active.push((object, lo, hi));
    }
    neighbours
}

#[cfg(test)]
mod tests;
