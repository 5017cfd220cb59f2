//! What is wrong with a user's triangles, by name and place: what cannot be hit, slivers, duplicates, open edges of
//! dielectrics, and media that overlap without a priority to settle it.

use std::collections::{BTreeMap, HashMap};
use std::fmt;

use glam::{DVec3, Vec3};

use super::sample::Rng;
use crate::accel::reference::{Budget, Hit64, Ray64, Reference};
use crate::geometry::topology::{Edges, place};
use crate::geometry::{Geometry, GeometryMask, Shape};
use crate::scene::Scene;

/// Times as long as high: rounding may then move a hit by hundreds of its spacings.
const SLIVER: f64 = 1000.0;

/// Rays that look for overlapping media.
const PROBES: usize = 4000;

/// Units of [`Budget`] that they may take together.
const PROBE_UNITS: u64 = 200_000_000;

/// A kind of trouble.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// Cannot be hit: corners that coincide, are not finite or too far out.
    Unusable,
    /// A thousand times as long as high, or more.
    Sliver,
    /// The same three corners as an earlier triangle.
    Duplicate,
    /// An edge of a dielectric that no other triangle closes: rays get in that never come out.
    OpenEdge,
    /// In another medium of the same priority without being enclosed by it: which one fills the space depends on the
    /// way a ray came.
    Overlap,
    /// A face of one medium exactly on a face of another: a ray that leaves the one starts beyond both, and finds itself
    /// in neither. To be mended by letting them overlap a little, with a priority.
    Touch,
}

impl Kind {
    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Unusable => "cannot be hit",
            Self::Sliver => "sliver",
            Self::Duplicate => "duplicate",
            Self::OpenEdge => "open edge of a dielectric",
            Self::Overlap => "media overlap without priority",
            Self::Touch => "media touch exactly; let them overlap, with a priority",
        }
    }
}

/// A triangle, or another shape as a whole, and where it was read.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// The object's name.
    pub object: String,
    /// The triangle of the object, from 0; 0 for other shapes.
    pub triangle: u32,
    /// The file; empty for what was made in memory.
    pub file: String,
    /// The line of the triangle, or else of the object, from 1; 0 where unknown.
    pub line: u32,
}

impl Place {
    /// Of a primitive of a scene.
    #[must_use]
    pub fn of(scene: &Scene, geometry: u32, primitive: u32) -> Self {
        let object = &scene.objects[geometry as usize];
        let line = object.origin.triangle_lines.get(primitive as usize).copied().unwrap_or(object.origin.line);
        Self { object: object.name.clone(), triangle: primitive, file: object.origin.file.clone(), line }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.file.is_empty(), self.line) {
            (true, _) => {}
            (_, 0) => write!(f, "{}: ", self.file)?,
            (_, line) => write!(f, "{}:{line}: ", self.file)?,
        }
        write!(f, "triangle {} of `{}`", self.triangle, self.object)
    }
}

/// Trouble with a triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Trouble {
    /// What kind.
    pub kind: Kind,
    /// Where.
    pub place: Place,
    /// The figure or the other triangle.
    pub detail: String,
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}{}", self.place, self.kind.name(), self.detail)
    }
}

/// All trouble with a scene.
#[derive(Clone, Debug, Default)]
pub struct Troubles {
    /// By kind and then in the order of the scene.
    pub found: Vec<Trouble>,
    /// Probing rays for overlapping media that were left out because those before met too many shapes at once.
    pub probes_left_out: u64,
}

/// Looks for all kinds of trouble.
#[must_use]
pub fn find(scene: &Scene) -> Troubles {
    let mut found = Vec::new();
    let mut seen = HashMap::new();
    for (id, g) in (0_u32..).zip(&scene.geometry) {
        let Shape::Mesh(mesh) = &g.shape else { continue };
        let mut tell = |kind, i: usize, detail| {
            found.push(Trouble { kind, place: Place::of(scene, id, i as u32), detail });
        };
        for i in 0..mesh.triangles.len() {
            if !mesh.is_usable(i) {
                tell(Kind::Unusable, i, String::new());
                continue;
            }
            let corners = mesh.corners(i);
            let ratio = length_over_height(corners);
            if ratio >= SLIVER {
                tell(Kind::Sliver, i, format!(", {ratio:.0} times as long as high"));
            }
            let mut key = corners.map(place);
            key.sort_unstable();
            if let Some(&(earlier, first)) = seen.get(&key) {
                tell(Kind::Duplicate, i, format!(" of {}", Place::of(scene, earlier, first)));
            } else {
                seen.insert(key, (id, i as u32));
            }
        }
        if scene.medium_of(id as usize).is_some() {
            for i in Edges::usable(mesh).open_triangles() {
                tell(Kind::OpenEdge, i, String::new());
            }
        }
    }
    let (overlaps, probes_left_out) = overlaps(scene);
    found.extend(overlaps);
    found.sort_by_key(|t| t.kind);
    Troubles { found, probes_left_out }
}

/// The longest edge over the height above it; infinite where the corners are in line.
fn length_over_height([a, b, c]: [Vec3; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
    let longest = [b - a, c - b, a - c].map(DVec3::length_squared).into_iter().fold(0.0, f64::max);
    let twice_area = (b - a).cross(c - a).length();
    longest / twice_area
}

/// How near to each other two faces coincide, in lengths of the scene.
const COINCIDENT: f64 = 1e-7;

/// Pairs of objects that share a face, and pairs with media of one priority that cross each other: probing rays leave the one entered first before
/// the other. A medium wholly inside another is no trouble, since the one entered last fills the space.
///
/// Also returns the number of rays that were left out.
fn overlaps(scene: &Scene) -> (Vec<Trouble>, u64) {
    // Only of a closed shape can it be said by counting when a ray is inside.
    let is_closed = |shape: &Shape| match shape {
        Shape::Mesh(mesh) => Edges::usable(mesh).open().is_none(),
        Shape::Sphere(sphere) => sphere.is_usable(),
        Shape::Plane(_) => false,
    };
    let closed_medium = |(id, g): (u32, &Geometry)| scene.medium_of(id as usize).filter(|_| is_closed(&g.shape));
    let media: Vec<Option<u32>> = (0..).zip(&scene.geometry).map(closed_medium).collect();
    if media.iter().flatten().count() < 2 {
        return (Vec::new(), 0);
    }
    let clash = |a: u32, b: u32| match (media[a as usize], media[b as usize]) {
        (Some(m), Some(n)) => m != n && scene.media[m as usize].priority == scene.media[n as usize].priority,
        _ => false,
    };
    let arbiter = Reference::build(&scene.geometry);
    let bounds = super::scene::bounds(scene);
    let mut rng = Rng::new("overlaps", 0);
    let size = bounds.0.abs().max_element().max(bounds.1.max_element());
    let mut found: BTreeMap<(Kind, u32, u32), Trouble> = BTreeMap::new();
    let mut budget = Budget::new(PROBE_UNITS);
    for k in 0..PROBES {
        let (from, to) = (bounds.0 + bounds.1 * rng.point() * 2.0, bounds.0 + bounds.1 * rng.point());
        let ray = Ray64 {
            origin: from,
            dir: to - from,
            t_min: f64::NEG_INFINITY,
            t_max: f64::INFINITY,
            admits: GeometryMask::ALL,
        };
        let mut hits = arbiter.hits_within(&ray, &mut budget);
        if budget.is_spent() {
            return (found.into_values().collect(), (PROBES - k) as u64);
        }
        // A ray at an edge meets both triangles there.
        hits.dedup_by(|b, a| a.geometry == b.geometry && a.t == b.t);
        hits.retain(|hit| media[hit.geometry as usize].is_some());
        let mut note = |kind, a: &Hit64, b: u32, what: &str| {
            found.entry((kind, a.geometry.min(b), a.geometry.max(b))).or_insert_with(|| Trouble {
                kind,
                place: Place::of(scene, a.geometry, a.primitive),
                detail: format!(": `{}` {what}", scene.objects[b as usize].name),
            });
        };
        for pair in hits.windows(2) {
            let [a, b] = [&pair[0], &pair[1]];
            let between = (b.t - a.t) * ray.dir.length();
            if media[a.geometry as usize] != media[b.geometry as usize] && between <= COINCIDENT * size {
                note(Kind::Touch, a, b.geometry, "touches it");
            }
        }
        let mut inside: Vec<(u32, f64)> = Vec::new();
        for hit in &hits {
            let Some(entered) = inside.iter().position(|(g, _)| *g == hit.geometry) else {
                inside.push((hit.geometry, hit.t));
                continue;
            };
            let (_, since) = inside.remove(entered);
            for &(other, at) in &inside[entered..] {
                // Faces that touch are crossed at the same place but for rounding.
                let shared = hit.t - at;
                if clash(hit.geometry, other) && shared > 1e-5 * (hit.t - since) {
                    note(Kind::Overlap, hit, other, "crosses it");
                }
            }
        }
    }
    (found.into_values().collect(), 0)
}
