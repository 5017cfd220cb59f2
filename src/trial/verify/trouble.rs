//! Faults of a user's triangles, by name and location: unusable triangles, slivers, duplicates, open edges of
//! dielectrics, and overlapping media without a priority to decide between them.

use std::collections::{BTreeMap, HashMap};
use std::fmt;

use glam::{DVec3, Vec3};

use crate::accel::reference::{Budget, Hit64, Ray64, Reference};
use crate::geometry::topology::{Edges, place};
use crate::geometry::{Geometry, GeometryMask, Shape};
use crate::measure::sample::Rng;
use crate::scene::Scene;

/// Ratio of length to height from which a triangle is a sliver. Rounding may then move a hit by hundreds of spacings.
const SLIVER: f64 = 1000.0;

/// Number of rays that probe for overlapping media.
const PROBES: usize = 4000;

/// Units of [`Budget`] for all of them together.
const PROBE_UNITS: u64 = 200_000_000;

/// Kind of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TroubleKind {
    /// The triangle cannot be hit: its corners coincide, are not finite or too far out.
    Unusable,
    /// The triangle is at least a thousand times as long as high.
    Sliver,
    /// The triangle has the same three corners as an earlier one.
    Duplicate,
    /// An edge of a dielectric is not closed by another triangle, so rays enter that never leave.
    OpenEdge,
    /// The object overlaps another medium of the same priority without being enclosed by it. The medium that fills the
    /// overlap then depends on the path of a ray.
    Overlap,
    /// A face of one medium lies exactly on a face of another. A ray that leaves one starts beyond both, in neither
    /// medium. Cure: a small overlap, with a priority.
    Touch,
}

impl TroubleKind {
    /// Returns a description.
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

/// Triangle, or another shape as a whole, and the location it was read from.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TriangleLocation {
    /// Name of the object.
    pub object: String,
    /// Index of the triangle in the object, from 0; 0 for other shapes.
    pub triangle: u32,
    /// File; empty for shapes made in memory.
    pub file: String,
    /// Line of the triangle, or else of the object, from 1; 0 if unknown.
    pub line: u32,
}

impl TriangleLocation {
    /// Returns the location of a primitive of a scene.
    #[must_use]
    pub fn of(scene: &Scene, geometry: u32, primitive: u32) -> Self {
        let object = &scene.objects[geometry as usize];
        let line = object.origin.triangle_lines.get(primitive as usize).copied().unwrap_or(object.origin.line);
        Self { object: object.name.clone(), triangle: primitive, file: object.origin.file.clone(), line }
    }
}

impl fmt::Display for TriangleLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.file.is_empty(), self.line) {
            (true, _) => {}
            (_, 0) => write!(f, "{}: ", self.file)?,
            (_, line) => write!(f, "{}:{line}: ", self.file)?,
        }
        write!(f, "triangle {} of `{}`", self.triangle, self.object)
    }
}

/// Fault of a triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Trouble {
    /// Kind of fault.
    pub kind: TroubleKind,
    /// Location.
    pub place: TriangleLocation,
    /// Figure, or the other triangle.
    pub detail: String,
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}{}", self.place, self.kind.name(), self.detail)
    }
}

/// All faults of a scene.
#[derive(Clone, Debug, Default)]
pub struct Troubles {
    /// Faults by kind and then in the order of the scene.
    pub found: Vec<Trouble>,
    /// Number of probing rays left out because the work limit was reached.
    pub probes_left_out: u64,
}

/// Searches for all kinds of fault.
#[must_use]
pub fn find(scene: &Scene) -> Troubles {
    let mut found = Vec::new();
    let mut seen = HashMap::new();
    for (id, g) in (0_u32..).zip(&scene.geometry) {
        let Shape::Mesh(mesh) = &g.shape else { continue };
        let mut tell = |kind, i: usize, detail| {
            found.push(Trouble { kind, place: TriangleLocation::of(scene, id, i as u32), detail });
        };
        for i in 0..mesh.triangles.len() {
            if !mesh.is_usable(i) {
                tell(TroubleKind::Unusable, i, String::new());
                continue;
            }
            let corners = mesh.corners(i);
            let ratio = length_over_height(corners);
            if ratio >= SLIVER {
                tell(TroubleKind::Sliver, i, format!(", {ratio:.0} times as long as high"));
            }
            let mut key = corners.map(place);
            key.sort_unstable();
            if let Some(&(earlier, first)) = seen.get(&key) {
                tell(TroubleKind::Duplicate, i, format!(" of {}", TriangleLocation::of(scene, earlier, first)));
            } else {
                seen.insert(key, (id, i as u32));
            }
        }
        if scene.medium_of(id as usize).is_some() {
            for i in Edges::usable(mesh).open_triangles() {
                tell(TroubleKind::OpenEdge, i, String::new());
            }
        }
    }
    let (overlaps, probes_left_out) = overlaps(scene);
    found.extend(overlaps);
    found.sort_by_key(|t| t.kind);
    Troubles { found, probes_left_out }
}

/// Returns the longest edge over the height above it; infinite for collinear corners.
fn length_over_height([a, b, c]: [Vec3; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
    let longest = [b - a, c - b, a - c].map(DVec3::length_squared).into_iter().fold(0.0, f64::max);
    let twice_area = (b - a).cross(c - a).length();
    longest / twice_area
}

/// Distance at which two faces coincide, relative to the scene.
const COINCIDENT: f64 = 1e-7;

/// Finds pairs of objects that share a face, and pairs with media of one priority that cross each other: probing rays
/// leave the one entered first before the other. A medium wholly inside another is no fault, since the one entered last
/// fills the space.
///
/// Also returns the number of rays that were left out.
fn overlaps(scene: &Scene) -> (Vec<Trouble>, u64) {
    // Counting crossings tells the inside only of a closed shape.
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
    let mut found: BTreeMap<(TroubleKind, u32, u32), Trouble> = BTreeMap::new();
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
        // A ray at an edge hits both triangles there.
        hits.dedup_by(|b, a| a.geometry == b.geometry && a.t == b.t);
        hits.retain(|hit| media[hit.geometry as usize].is_some());
        let mut note = |kind, a: &Hit64, b: u32, what: &str| {
            found.entry((kind, a.geometry.min(b), a.geometry.max(b))).or_insert_with(|| Trouble {
                kind,
                place: TriangleLocation::of(scene, a.geometry, a.primitive),
                detail: format!(": `{}` {what}", scene.objects[b as usize].name),
            });
        };
        for pair in hits.windows(2) {
            let [a, b] = [&pair[0], &pair[1]];
            let between = (b.t - a.t) * ray.dir.length();
            if media[a.geometry as usize] != media[b.geometry as usize] && between <= COINCIDENT * size {
                note(TroubleKind::Touch, a, b.geometry, "touches it");
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
                // Touching faces are crossed at the same point up to rounding.
                let shared = hit.t - at;
                if clash(hit.geometry, other) && shared > 1e-5 * (hit.t - since) {
                    note(TroubleKind::Overlap, hit, other, "crosses it");
                }
            }
        }
    }
    (found.into_values().collect(), 0)
}
