//! Results of the searches for contacts, and their conversion to [`Contacts`].

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::contacts::{Contacts, Pair, Places, Tangent, Touching};
use super::face::Face;
use super::grid::Partners;
use crate::geometry::shape::{Geometry, Shape};

/// Contacts that the searches have found so far.
#[derive(Default)]
pub(super) struct Found {
    /// Coincident faces as pairs of (object, primitive), the lower one first.
    pub faces: Vec<[(u32, u32); 2]>,
    /// Spheres that touch a face, by (object, primitive).
    pub tangents: Vec<([(u32, u32); 2], Tangent)>,
    pub two_sided: Vec<u32>,
    /// Triangles that repeat an earlier one: object, triangle, and the earlier one, which stands for it.
    pub stand_ins: Vec<(u32, u32, u32)>,
    /// Objects in which triangles repeat earlier ones and this matters, with how many do.
    pub repeated: Vec<(u32, usize)>,
}

/// By pair of objects: coincident faces, those of them that face the same side, and points.
type Counts = BTreeMap<[u32; 2], [u32; 3]>;

impl Found {
    pub fn coincide(&mut self, a: (u32, u32), b: (u32, u32)) {
        self.faces.push([a.min(b), a.max(b)]);
    }

    pub fn finish(mut self, geometry: &[Geometry]) -> Contacts {
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
