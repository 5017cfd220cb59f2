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
mod overlap;
mod round;

use std::collections::BTreeMap;

use glam::DVec3;

use super::{Aabb, Geometry, Shape};
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
        let place = match self.places.get(object as usize)? {
            Places::None => return None,
            Places::One(place) => *place,
            Places::Each(places) => places[primitive as usize],
        };
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
}

impl Found {
    fn coincide(&mut self, a: (u32, u32), b: (u32, u32)) {
        self.faces.push([a.min(b), a.max(b)]);
    }

    fn finish(mut self, geometry: &[Geometry]) -> Contacts {
        self.faces.sort_unstable();
        self.faces.dedup();
        let places = vec![Places::None; geometry.len()];
        let mut contacts = Contacts { places, two_sided: self.two_sided.clone(), ..Contacts::default() };
        let mut pairs: BTreeMap<[u32; 2], [u32; 3]> = BTreeMap::new();
        let mut partners: Vec<Vec<u32>> = Vec::new();
        let place = |contacts: &mut Contacts, partners: &mut Vec<Vec<u32>>, (object, primitive): (u32, u32)| -> u32 {
            let next = contacts.faces.len() as u32;
            let shape = &geometry[object as usize].shape;
            let places = &mut contacts.places[object as usize];
            let place = match (&mut *places, shape) {
                (Places::One(place), _) => return *place,
                (Places::Each(places), _) => &mut places[primitive as usize],
                (Places::None, Shape::Mesh(mesh)) => {
                    *places = Places::Each(vec![u32::MAX; mesh.triangles.len()]);
                    let Places::Each(places) = places else { unreachable!("it was just made so") };
                    &mut places[primitive as usize]
                }
                (Places::None, _) => {
                    *places = Places::One(next);
                    let Places::One(place) = places else { unreachable!("it was just made so") };
                    place
                }
            };
            if *place == u32::MAX || *place == next {
                *place = next;
                let face = Face::of(geometry, object, primitive);
                contacts.faces.push(Touching { face, partners: Partners::default(), tangents: Vec::new() });
                partners.push(Vec::new());
            }
            *place
        };
        for &[a, b] in &self.faces {
            let [i, j] = [a, b].map(|face| place(&mut contacts, &mut partners, face));
            partners[i as usize].push(j);
            partners[j as usize].push(i);
            let [a_face, b_face] = [i, j].map(|k| contacts.faces[k as usize].face);
            let counts = pairs.entry([a.0, b.0]).or_default();
            counts[0] += 1;
            counts[1] += u32::from(a_face.faces_like(&b_face));
        }
        for &([sphere, other], tangent) in &self.tangents {
            let [i, j] = [sphere, other].map(|face| place(&mut contacts, &mut partners, face));
            let number = contacts.tangents.len() as u32;
            contacts.tangents.push(Tangent { sphere: i, other: j, ..tangent });
            contacts.faces[i as usize].tangents.push(number);
            contacts.faces[j as usize].tangents.push(number);
            pairs.entry([sphere.0.min(other.0), sphere.0.max(other.0)]).or_default()[2] += 1;
        }
        for (place, partners) in partners.into_iter().enumerate() {
            let index = Partners::new(&contacts.faces[place].face, partners, |i| contacts.faces[i as usize].face);
            contacts.faces[place].partners = index;
        }
        contacts.pairs = pairs
            .into_iter()
            .map(|(objects, [faces, aligned, points])| Pair { objects, faces, aligned, points })
            .collect();
        contacts
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
