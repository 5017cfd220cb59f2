//! Joined and unjoined edges close to a ray, which tell leaks from cracks. A ray that slips through joined triangles is
//! a leak, and a fault of the kernel. One that slips through a crack is not.
//!
//! A watertight `f32` kernel gives exact answers for some mesh whose corners lie within a few roundings ([`SLIP`] times
//! a corner's distance) of the given ones. Each corner is moved alike in every triangle that has it. A ray may pass an
//! edge or a corner so closely that no single triangle is certain to be hit. But if the triangles are joined around the
//! ray, one of them has to be hit. That is decided without sampling, modulo 2:
//!
//! - An edge is *near* if the ray passes it, seen along the ray, within the slip of its ends. Two triangles are joined
//!   at an edge if both have its two corners, by equal coordinates.
//! - Take a set of triangles near the ray in which each near edge belongs to an even number of them. Its boundary then
//!   passes the ray at more than the slip. So moving the corners moves no part of the boundary across the ray, and the
//!   parity of its winding around the ray does not change. If it is odd, the set covers the ray in the given mesh and
//!   in every moved one, and one of its triangles has to be hit.
//! - The parity of a triangle is that of its crossings with a half line from the ray. Such a set exists unless the
//!   parities are a sum of the conditions of near edges, which elimination over the field of two elements decides. An
//!   edge of two triangles merges them, and an edge of one excludes it. Conditions of edges of three or more are
//!   solved.
//!
//! A duplicate, a fin at a third side or a surface behind does not matter, since any set will do. A slit, an unjoined
//! seam or a corner in the middle of an edge leaves edges with one side, which are never in such a set.
//!
//! `f64` is accurate enough: it moves a corner by 2^-50 of its distance, while a near edge is one within 2^-20. Only
//! edges that are not near decide the parity, and their sides are computed without error ([`super::primitive::edge`]).

use std::collections::{BTreeMap, BTreeSet, HashMap};

use glam::DVec2;

use super::margin::{Contact, SLIP, TINY};
use super::primitive::{Form, Primitive, Probe, edge};
use crate::geometry::topology::{Edges, Groups, place, weld};

/// Largest number of conditions times triangles that is solved for edges of three or more. Beyond it the ray is not
/// judged.
const MOST_TERMS: usize = 1 << 22;

/// Triangles close to a ray, and their near edges: those that the ray passes too closely for `f32` to tell the side.
/// Triangles with the same corners count as one.
#[derive(Clone, Debug, Default)]
pub(super) struct Seams {
    /// Indices in the list of primitives, ascending, each with the index of its triangle here.
    places: Vec<(usize, u32)>,
    /// Triangles at each near edge.
    near: Vec<Vec<u32>>,
    /// True if a half line from the ray leaves the triangle an odd number of times.
    odd: Vec<bool>,
    /// True if the triangle is connected, across near edges, to a near edge of an odd number of triangles.
    open: Vec<bool>,
}

impl Seams {
    /// Collects the triangles among `contacts` whose edges the ray passes too closely.
    pub fn of<'a>(primitives: &[Primitive], probe: &Probe, contacts: impl Iterator<Item = &'a Contact>) -> Self {
        let mut near_places: Vec<usize> = contacts.filter(|c| !c.edge.is_decided()).map(|c| c.place).collect();
        near_places.sort_unstable();
        let (mut places, mut seen) = (Vec::with_capacity(near_places.len()), HashMap::new());
        let (mut positions, mut flat) = (Vec::new(), Vec::new());
        for at in near_places {
            let Form::Triangle(corners) = &primitives[at].form else { continue };
            // Exact, since they were widened from `f32`.
            let narrow = corners.map(|p| p.as_vec3());
            let mut key = narrow.map(place);
            key.sort_unstable();
            let next = seen.len() as u32;
            let triangle = *seen.entry(key).or_insert(next);
            places.push((at, triangle));
            if triangle == next {
                positions.extend(narrow);
                let slip = corners.map(|p| SLIP * (p - probe.ray.origin).abs().max_element() + TINY);
                flat.extend(std::iter::zip(probe.triangle(corners).flat, slip));
            }
        }
        let count = seen.len();
        let triangles: Vec<[u32; 3]> = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let ends = |triangle: u32, corner: u8| {
            let at = |corner: u8| flat[3 * triangle as usize + usize::from(corner % 3)];
            (at(corner), at(corner + 1))
        };
        let near: Vec<Vec<u32>> = Edges::new(&triangles, &weld(&positions))
            .groups()
            .filter(|group| {
                let ((p, slip_p), (q, slip_q)) = ends(group[0].1.triangle, group[0].1.corner);
                distance(p, q) <= slip_p.max(slip_q)
            })
            .map(|group| group.iter().map(|(_, side)| side.triangle).collect())
            .collect();
        let odd = (0..count as u32)
            .map(|i| (0..3).filter(|&k| is_crossed(ends(i, k).0.0, ends(i, k).1.0)).count() % 2 == 1)
            .collect();

        let mut groups = Groups::new(count);
        near.iter().for_each(|sides| sides.iter().for_each(|&side| groups.join(side, sides[0])));
        let ending: BTreeSet<u32> =
            near.iter().filter(|sides| sides.len() % 2 == 1).map(|sides| groups.find(sides[0])).collect();
        let open = (0..count as u32).map(|i| ending.contains(&groups.find(i))).collect();
        Self { places, near, odd, open }
    }

    /// Returns true if the surface of the triangle at index `place` is open or not joined close to the ray.
    pub fn are_open_at(&self, place: usize) -> bool {
        self.places.binary_search_by_key(&place, |p| p.0).is_ok_and(|i| self.open[self.places[i].1 as usize])
    }

    /// Returns true if joined triangles among those at `places` surround the ray, so that one of them has to be hit.
    pub fn surround(&self, places: &BTreeSet<usize>) -> bool {
        // One more number stands for the triangles that are left out.
        let none = self.odd.len() as u32;
        let mut groups = Groups::new(self.odd.len() + 1);
        let mut kept = vec![false; self.odd.len()];
        self.places.iter().filter(|p| places.contains(&p.0)).for_each(|p| kept[p.1 as usize] = true);
        (0..none).filter(|&i| !kept[i as usize]).for_each(|i| groups.join(i, none));
        let mut conditions: Vec<&[u32]> = Vec::new();
        for sides in &self.near {
            let mut here = sides.iter().filter(|&&i| kept[i as usize]);
            match (here.next(), here.next(), here.next()) {
                (None, ..) => {}
                (Some(&a), None, _) => groups.join(a, none),
                (Some(&a), Some(&b), None) => groups.join(a, b),
                _ => conditions.push(sides),
            }
        }
        let none = groups.find(none);
        let mut sum_of = |triangles: &mut dyn Iterator<Item = u32>| {
            let mut sum = BTreeSet::new();
            for group in triangles.map(|i| groups.find(i)).filter(|&group| group != none) {
                toggle(&mut sum, group);
            }
            sum
        };
        let parity = sum_of(&mut (0..self.odd.len() as u32).filter(|&i| self.odd[i as usize]));
        if conditions.len().saturating_mul(self.odd.len()) > MOST_TERMS {
            return false;
        }
        let mut solved: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
        for sides in conditions {
            let condition = reduced(sum_of(&mut sides.iter().copied()), &solved);
            if let Some(&first) = condition.first() {
                solved.insert(first, condition);
            }
        }
        !reduced(parity, &solved).is_empty()
    }
}

/// Adds conditions to `sum` until no condition starts with its first term.
fn reduced(mut sum: BTreeSet<u32>, solved: &BTreeMap<u32, BTreeSet<u32>>) -> BTreeSet<u32> {
    while let Some(condition) = sum.first().and_then(|first| solved.get(first)) {
        condition.iter().for_each(|&term| toggle(&mut sum, term));
    }
    sum
}

fn toggle(sum: &mut BTreeSet<u32>, term: u32) {
    if !sum.remove(&term) {
        sum.insert(term);
    }
}

/// Distance of the ray from an edge, seen along the ray.
fn distance(p: DVec2, q: DVec2) -> f64 {
    let along = q - p;
    let share = (-p.dot(along) / along.length_squared()).clamp(0.0, 1.0);
    // Corners that coincide seen along the ray are an edge without a direction.
    if share.is_nan() { p.length() } else { (p + along * share).length() }
}

/// Returns true if the half line from the ray along x crosses the edge. The result is the same for either order of the
/// ends.
fn is_crossed(p: DVec2, q: DVec2) -> bool {
    let (p_above, q_above) = (p.y >= 0.0, q.y >= 0.0);
    p_above != q_above && (if q_above { edge(p, q) } else { edge(q, p) }) > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_is_crossed_where_it_passes_the_ray_on_its_right_whatever_the_order() {
        let (low, high) = (DVec2::new(2.0, -1.0), DVec2::new(1.0, 3.0));
        for x in [0.0, -4.0] {
            let (p, q) = (low + DVec2::X * x, high + DVec2::X * x);
            assert_eq!(is_crossed(p, q), x == 0.0);
            assert_eq!(is_crossed(q, p), x == 0.0);
        }
        assert!(!is_crossed(high, high + DVec2::X));
    }

    #[test]
    fn the_distance_of_an_edge_is_that_of_its_nearest_point_and_no_farther_than_its_line() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        assert_eq!(distance(at(-1.0, 2.0), at(5.0, 2.0)), 2.0);
        assert_eq!(distance(at(3.0, 4.0), at(6.0, 4.0)), 5.0);
        assert_eq!(distance(at(3.0, 4.0), at(3.0, 4.0)), 5.0);
    }
}
