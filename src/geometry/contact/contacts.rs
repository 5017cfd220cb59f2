//! Contacts of a list of shapes, looked up by face.

use glam::DVec3;

use super::face::Face;
use super::grid::Partners;

/// The touching surfaces of a list of shapes.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// By object: where its faces are in `faces`.
    pub(super) places: Vec<Places>,
    pub(super) faces: Vec<Touching>,
    pub(super) tangents: Vec<Tangent>,
    pub(super) pairs: Vec<Pair>,
    /// Objects of which each face is there a second time the other way round.
    pub(super) two_sided: Vec<u32>,
}

/// Entries of an object in the list of touching faces.
#[derive(Clone, Debug, Default)]
pub(super) enum Places {
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
pub(super) struct Touching {
    pub face: Face,
    pub partners: Partners,
    pub tangents: Vec<u32>,
}

/// A sphere that touches a face at a point.
#[derive(Clone, Copy, Debug)]
pub struct Tangent {
    /// The touching sphere, a place in the list of faces.
    pub(super) sphere: u32,
    /// The face that it touches, a place in the same list.
    pub(super) other: u32,
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

impl Places {
    /// The place of a face; none where it touches nothing.
    #[inline]
    pub fn of(&self, primitive: u32) -> Option<u32> {
        let place = match self {
            Self::None => return None,
            Self::One(place) => *place,
            Self::Each(places) => places[primitive as usize],
        };
        (place != u32::MAX).then_some(place)
    }
}
