//! Surfaces that touch: faces of different objects that lie at the same place, and spheres that touch something at a
//! point.
//!
//! Rounding decides which of two coincident faces a ray meets first, and moves the start of the next ray past both. So
//! coincidence is found before the first ray, from the shapes alone, and looked up where a ray arrives
//! ([`Contacts::faces_at`]). Two faces coincide where their distance is below [`tolerance`], the bound on the rounding of
//! `f32` positions there. Nothing here knows materials; the caller says which pairs of objects matter.

mod face;
mod flat;
mod grid;
mod join;
mod overlap;
mod repeats;
mod round;

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;

use super::aabb::Aabb;
use super::{Geometry, Shape};
use crate::math::UNIT_ROUNDOFF;
pub use face::{Face, Form};
use grid::Partners;

/// Distance up to which two surfaces at a place of the given largest coordinate coincide, in scene units: eight units of
/// rounding. Each face is off by at most four, one for each coordinate of a corner and one for the transform.
#[must_use]
pub fn tolerance(largest_coordinate: f64) -> f64 {
    8.0 * f64::from(UNIT_ROUNDOFF) * largest_coordinate
}

/// The touching surfaces of a list of shapes.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// By object: where its faces are in `faces`.
    places: Vec<Places>,
    faces: Vec<Touching>,
    tangents: Vec<Tangent>,
    pairs: Vec<Pair>,
    /// Objects of which each face is there a second time the other way round.
    two_sided: Vec<u32>,
}

/// Entries of an object in the list of touching faces.
#[derive(Clone, Debug, Default)]
enum Places {
    /// Touches nothing.
    #[default]
    None,
    /// A plane or a sphere.
    One(u32),
    /// By triangle; `u32::MAX` where it touches nothing.
    Each(Vec<u32>),
}

/// A face with everything that touches it.
#[derive(Clone, Debug)]
struct Touching {
    face: Face,
    partners: Partners,
    tangents: Vec<u32>,
}

/// A sphere that touches a face at a point.
#[derive(Clone, Copy, Debug)]
pub struct Tangent {
    /// The touching sphere, a place in the list of faces.
    sphere: u32,
    /// The face that it touches, a place in the same list.
    other: u32,
    /// Point of contact, in scene units.
    pub contact: DVec3,
    /// Unit direction at the contact from the sphere to the other surface: from the gap into the other one.
    pub towards: DVec3,
    /// Distance from the contact within which the gap is below what the starts of rays are moved by, in scene units.
    pub zone: f64,
    /// True where the gap is outside the sphere, which is so unless the sphere holds the other one.
    pub gap_outside: bool,
}

/// Two objects that touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pair {
    /// Places in the list of shapes, the lower one first. Equal for duplicate faces within one mesh.
    pub objects: [u32; 2],
    /// Pairs of faces that coincide; 0 where the two touch at points alone.
    pub faces: u32,
    /// Those of them that face the same side.
    pub aligned: u32,
    /// Points at which a sphere touches.
    pub points: u32,
}

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

    /// Returns true if nothing touches anything.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// The pairs of objects that touch, by rising numbers.
    #[must_use]
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// The entry of a face that touches something.
    #[inline]
    fn entry(&self, object: u32, primitive: u32) -> Option<&Touching> {
        let place = self.places.get(object as usize)?.of(primitive)?;
        self.faces.get(place as usize)
    }

    /// Returns true if the face touches anything anywhere.
    #[inline]
    #[must_use]
    pub fn touches(&self, object: u32, primitive: u32) -> bool {
        self.entry(object, primitive).is_some()
    }

    /// Returns true if something else may lie at `point` of the face: a quick look before [`Contacts::faces_at`] and
    /// [`Contacts::tangent_at`], which decide. `slack` is that of the former.
    #[inline]
    #[must_use]
    pub fn may_meet(&self, object: u32, primitive: u32, point: DVec3, slack: f64) -> bool {
        let Some(entry) = self.entry(object, primitive) else { return false };
        let mut near = entry
            .tangents
            .iter()
            .map(|&i| &self.tangents[i as usize])
            .any(|tangent| point.distance_squared(tangent.contact) <= tangent.zone * tangent.zone);
        entry.partners.near(point, |partner| near = near || self.faces[partner as usize].face.covers(point, slack));
        near
    }

    /// Puts into `faces` the faces that lie at `point` of the given face, its own first. One of each object and side; one of
    /// each object that is two-sided. The point counts as on a face that ends up to `slack` before it (scene units).
    pub fn faces_at(&self, object: u32, primitive: u32, point: DVec3, slack: f64, faces: &mut Vec<Face>) {
        let Some(entry) = self.entry(object, primitive) else { return };
        let first = faces.len();
        faces.push(entry.face);
        let outward = entry.face.outward(point);
        entry.partners.near(point, |partner| {
            let other = self.faces[partner as usize].face;
            if !other.covers(point, slack) {
                return;
            }
            let same_side = |a: &Face| a.outward(point).dot(outward) > 0.0;
            let two_sided = self.two_sided.binary_search(&other.object).is_ok();
            let twin = |seen: &Face| seen.object == other.object && (two_sided || same_side(seen) == same_side(&other));
            match faces[first..].iter_mut().find(|seen| twin(seen)) {
                // The lowest counts, whichever was met and in whatever order they are found.
                Some(seen) if seen.primitive > other.primitive => *seen = other,
                Some(_) => {}
                None => faces.push(other),
            }
        });
        faces[first + 1..].sort_unstable_by_key(Face::id);
    }

    /// The tangent contact at `point` of a face, with the sphere and the other face: the first whose zone holds the point.
    #[must_use]
    pub fn tangent_at(&self, object: u32, primitive: u32, point: DVec3) -> Option<(&Tangent, Face, Face)> {
        let entry = self.entry(object, primitive)?;
        entry.tangents.iter().map(|&i| &self.tangents[i as usize]).find_map(|tangent| {
            let [sphere, other] = [tangent.sphere, tangent.other].map(|i| self.faces[i as usize].face);
            let near = point.distance_squared(tangent.contact) <= tangent.zone * tangent.zone;
            (near && other.covers(point, tangent.zone)).then_some((tangent, sphere, other))
        })
    }
}

/// Contacts that the searches have found so far.
#[derive(Default)]
struct Found {
    /// Coincident faces as pairs of (object, primitive), the lower one first.
    faces: Vec<[(u32, u32); 2]>,
    /// Spheres that touch a face, by (object, primitive).
    tangents: Vec<([(u32, u32); 2], Tangent)>,
    two_sided: Vec<u32>,
    /// Triangles that repeat an earlier one: object, triangle, and the earlier one, which stands for it.
    stand_ins: Vec<(u32, u32, u32)>,
    /// Objects in which triangles repeat earlier ones and this matters, with how many do.
    repeated: Vec<(u32, usize)>,
}

/// By pair of objects: coincident faces, those of them that face the same side, and points.
type Counts = BTreeMap<[u32; 2], [u32; 3]>;

impl Found {
    fn coincide(&mut self, a: (u32, u32), b: (u32, u32)) {
        self.faces.push([a.min(b), a.max(b)]);
    }

    fn finish(mut self, geometry: &[Geometry]) -> Contacts {
        self.faces.par_sort_unstable();
        self.faces.dedup();
        let tangents = self.tangents.iter().flat_map(|(ids, _)| *ids);
        let mut ids: Vec<(u32, u32)> = self.faces.iter().flatten().copied().chain(tangents).collect();
        ids.par_sort_unstable();
        ids.dedup();
        self.stand_ins.par_sort_unstable();
        self.stand_ins.dedup();
        let places = places(geometry, &ids, &self.stand_ins);
        let at = |(object, primitive): (u32, u32)| places[object as usize].of(primitive).unwrap_or(u32::MAX);
        let faces: Vec<Face> =
            ids.par_iter().map(|&(object, primitive)| Face::of(geometry, object, primitive)).collect();

        // The partners of all faces in one list, by face.
        let pairs: Vec<[u32; 2]> = self.faces.par_iter().map(|pair| pair.map(at)).collect();
        let mut ends = vec![0_usize; faces.len()];
        pairs.iter().flatten().for_each(|&i| ends[i as usize] += 1);
        let mut sum = 0;
        ends.iter_mut().for_each(|end| (*end, sum) = (sum, sum + *end));
        let mut partners = vec![0; 2 * pairs.len()];
        for &[i, j] in &pairs {
            for (i, j) in [(i, j), (j, i)] {
                partners[ends[i as usize]] = j;
                ends[i as usize] += 1;
            }
        }
        let mut touching: Vec<Touching> = (0..faces.len())
            .into_par_iter()
            .map(|i| {
                let mine = &partners[if i == 0 { 0 } else { ends[i - 1] }..ends[i]];
                let partners = Partners::new(&faces[i], mine.to_vec(), |i| faces[i as usize]);
                Touching { face: faces[i], partners, tangents: Vec::new() }
            })
            .collect();
        let mut tangents = Vec::with_capacity(self.tangents.len());
        for &([sphere, other], tangent) in &self.tangents {
            let [sphere, other] = [sphere, other].map(at);
            touching[sphere as usize].tangents.push(tangents.len() as u32);
            touching[other as usize].tangents.push(tangents.len() as u32);
            tangents.push(Tangent { sphere, other, ..tangent });
        }
        let pairs = self.counted(&pairs, &faces);
        Contacts { places, faces: touching, tangents, pairs, two_sided: self.two_sided }
    }

    /// The pairs of objects, with what was found of each.
    fn counted(&self, pairs: &[[u32; 2]], faces: &[Face]) -> Vec<Pair> {
        let add = |mut a: Counts, b: Counts| {
            for (objects, counts) in b {
                let sums = a.entry(objects).or_default();
                (0..3).for_each(|k| sums[k] += counts[k]);
            }
            a
        };
        let part = |pairs: &[[u32; 2]]| {
            let mut counts = Counts::new();
            for pair in pairs {
                let [a, b] = pair.map(|i| &faces[i as usize]);
                let counts = counts.entry([a.object, b.object]).or_default();
                counts[0] += 1;
                counts[1] += u32::from(a.faces_like(b));
            }
            counts
        };
        let mut counts = pairs.par_chunks(1 << 14).map(part).reduce(Counts::new, add);
        for &(object, repeats) in &self.repeated {
            let counts = counts.entry([object; 2]).or_default();
            counts[0] += repeats as u32;
            counts[1] += repeats as u32;
        }
        for ([sphere, other], _) in &self.tangents {
            counts.entry([sphere.0.min(other.0), sphere.0.max(other.0)]).or_default()[2] += 1;
        }
        let pair = |(objects, [faces, aligned, points]): ([u32; 2], [u32; 3])| Pair { objects, faces, aligned, points };
        counts.into_iter().map(pair).collect()
    }
}

/// By object, the places of its faces in the sorted list `ids`; `stand_ins` are at the places of others.
fn places(geometry: &[Geometry], ids: &[(u32, u32)], stand_ins: &[(u32, u32, u32)]) -> Vec<Places> {
    let mut places = vec![Places::None; geometry.len()];
    for (&(object, primitive), place) in ids.iter().zip(0..) {
        let places = &mut places[object as usize];
        match &geometry[object as usize].shape {
            Shape::Mesh(mesh) => {
                if let Places::None = places {
                    *places = Places::Each(vec![u32::MAX; mesh.triangles.len()]);
                }
                if let Places::Each(each) = places {
                    each[primitive as usize] = place;
                }
            }
            Shape::Sphere(_) | Shape::Plane(_) => *places = Places::One(place),
        }
    }
    for &(object, face, first) in stand_ins {
        if let Places::Each(each) = &mut places[object as usize] {
            each[face as usize] = each[first as usize];
        }
    }
    places
}

impl Places {
    /// The place of a face; none where it touches nothing.
    #[inline]
    fn of(&self, primitive: u32) -> Option<u32> {
        let place = match self {
            Self::None => return None,
            Self::One(place) => *place,
            Self::Each(places) => places[primitive as usize],
        };
        (place != u32::MAX).then_some(place)
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

/// A box in `f64` grown by the tolerance of its own coordinates.
fn grown(b: &Aabb) -> (DVec3, DVec3) {
    let margin = tolerance(f64::from(b.lo.abs().max(b.hi.abs()).max_element()));
    (b.lo.as_dvec3() - margin, b.hi.as_dvec3() + margin)
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
