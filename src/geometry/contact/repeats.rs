//! Triangles of one mesh that are there more than once.

use glam::Vec3;
use rayon::prelude::*;

use super::found::Found;
use crate::geometry::mesh::TriMesh;

/// Bits of the filter for each triangle.
const BITS: usize = 8;

/// Finds duplicates among the triangles of one mesh: the same three corners, in any order. Faces that run alike are one
/// surface, for which the first of them stands. A mesh of which each triangle has one that runs the other way round is
/// two-sided, as some programs export thin sheets.
pub(super) fn find(object: usize, mesh: &TriMesh, found: &mut Found) {
    let usable = || (0..mesh.triangles.len() as u32).filter(|&i| mesh.is_usable(i as usize));
    let mut turned = 0;
    for same in repeats(mesh, &usable().collect::<Vec<_>>()) {
        let ways = [true, false].map(|way| same.iter().filter(move |(_, alike)| *alike == way).map(|&(i, _)| i));
        let counts = ways.clone().map(Iterator::count);
        let firsts = ways.map(|mut way| way.next());
        found.repeated.extend(counts.iter().filter(|&&count| count > 1).map(|count| (object as u32, count - 1)));
        if let [Some(a), Some(b)] = firsts {
            found.coincide((object as u32, a), (object as u32, b));
            turned += same.len();
        }
        stand_in(object, &same, found);
    }
    let all = usable().count();
    if all > 0 && turned == all {
        found.two_sided.push(object as u32);
    }
}

/// The faces among `faces` that no earlier one repeats in the same direction. The others are written down as its repeats.
pub(super) fn distinct(object: usize, mesh: &TriMesh, faces: Vec<u32>, found: &mut Found) -> Vec<u32> {
    let repeats = repeats(mesh, &faces);
    if repeats.is_empty() {
        return faces;
    }
    let before = found.stand_ins.len();
    repeats.iter().for_each(|same| stand_in(object, same, found));
    let mut left_out: Vec<u32> = found.stand_ins[before..].iter().map(|&(_, face, _)| face).collect();
    left_out.sort_unstable();
    faces.into_iter().filter(|face| left_out.binary_search(face).is_err()).collect()
}

fn stand_in(object: usize, same: &[(u32, bool)], found: &mut Found) {
    for way in [true, false] {
        let mut alike = same.iter().filter(|(_, alike)| *alike == way).map(|&(i, _)| i);
        if let Some(first) = alike.next() {
            found.stand_ins.extend(alike.map(|face| (object as u32, face, first)));
        }
    }
}

/// Sets of at least two triangles with the same corners, by rising numbers; each with true if it runs as the first one does.
fn repeats(mesh: &TriMesh, faces: &[u32]) -> Vec<Vec<(u32, bool)>> {
    let corners = |i: u32| mesh.corners(i as usize).map(|p| p + Vec3::ZERO);
    // A sum of hashes does not depend on the order of the corners.
    let hash = |i: u32| {
        corners(i).iter().fold(0_u64, |sum, p| {
            let [x, y, z] = p.to_array().map(|c| u64::from(c.to_bits()));
            let mixed = (x.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ y.rotate_left(21)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            sum.wrapping_add((mixed ^ z.rotate_left(42)).wrapping_mul(0x94d0_49bb_1331_11eb))
        })
    };
    let hashes: Vec<u64> = faces.par_iter().map(|&i| hash(i)).collect();
    // Most hashes are met once, which a filter of a few bits tells without sorting them.
    let words = (faces.len() * BITS / 64).next_power_of_two().max(1);
    let (mut once, mut again) = (vec![0_u64; words], vec![0_u64; words]);
    let bit = |hash: u64| ((hash >> 32) as usize % words, 1_u64 << (hash >> 26 & 63));
    for &hash in &hashes {
        let (word, bit) = bit(hash);
        again[word] |= once[word] & bit;
        once[word] |= bit;
    }
    let mut met: Vec<(u64, u32)> = hashes
        .iter()
        .zip(faces)
        .filter(|(hash, _)| {
            let (word, bit) = bit(**hash);
            again[word] & bit != 0
        })
        .map(|(&hash, &face)| (hash, face))
        .collect();
    met.par_sort_unstable();
    let key = |i: u32| {
        let mut key = corners(i).map(|p| p.to_array().map(f32::to_bits));
        key.sort_unstable();
        key
    };
    let mut sets = Vec::new();
    for alike in met.chunk_by(|a, b| a.0 == b.0).filter(|alike| alike.len() > 1) {
        let mut keyed: Vec<_> = alike.iter().map(|&(_, face)| (key(face), face)).collect();
        keyed.sort_unstable();
        for same in keyed.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1) {
            let first = corners(same[0].1);
            sets.push(same.iter().map(|&(_, face)| (face, runs_alike(first, corners(face)))).collect());
        }
    }
    sets
}

/// Returns true if two triangles with the same corners run through them in the same direction.
fn runs_alike([a, b, c]: [Vec3; 3], other: [Vec3; 3]) -> bool {
    [[a, b, c], [b, c, a], [c, a, b]].contains(&other)
}
