//! Primitives of meshes: lists, strips and fans of triangles with the attributes of their vertices.

use glam::{DVec3, Vec2, Vec3};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;

use super::accessor;
use super::document::Document;
use super::texture::Placement;
use crate::load::indexed::Indexed;
use crate::scene::Rgb;

/// Sets of joints and weights of a vertex that are read, with four of each in a set.
const SETS: u32 = 2;

/// Vertices of a primitive that its skin moves.
#[derive(Debug, Default)]
pub(super) struct Binding {
    /// Joint and weight of each influence, by vertex.
    pub influences: Vec<Vec<(usize, f64)>>,
}

/// Primitive with remarks on what was left out of it.
#[derive(Debug, Default)]
pub(super) struct Read {
    pub mesh: Indexed,
    pub binding: Option<Binding>,
    pub remarks: Vec<String>,
}

/// Reads a primitive, or returns the reason why it has no triangles. `placement` gives the texture coordinates, and
/// `weights` those of the morph targets.
pub(super) fn read(
    document: &Document<'_>,
    primitive: &Primitive,
    placement: &Placement,
    weights: &[f32],
) -> Result<Read, String> {
    let Checked::Valid(mode) = primitive.mode else { return Err(String::from("its mode is not known")) };
    if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        return Err(String::from("points and lines have no surface"));
    }
    let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(|a| a.value());
    let positions = attribute(Semantic::Positions).ok_or("it has no positions")?;
    let mut read = Read::default();
    read.mesh.positions = accessor::read::<3>(document, positions)?.into_iter().map(DVec3::from).collect();
    let count = read.mesh.positions.len();
    let mut remarks = Vec::new();
    if let Some(list) = optional::<3>(document, attribute(Semantic::Normals), count, "normals", &mut remarks) {
        read.mesh.normals = list.into_iter().map(|n| DVec3::from(n).as_vec3()).collect();
    }
    if let Some(list) = optional::<4>(document, attribute(Semantic::Colors(0)), count, "colours", &mut remarks) {
        if list.iter().any(|c| c[3] < 1.0) {
            remarks.push(String::from("the alpha of colours at vertices is left out"));
        }
        read.mesh.colours = list.into_iter().map(|[r, g, b, _]| DVec3::new(r, g, b).as_vec3()).collect::<Vec<Rgb>>();
    }
    let accessor = attribute(Semantic::TexCoords(placement.set));
    if let Some(list) = optional::<2>(document, accessor, count, "texture coordinates", &mut remarks) {
        read.mesh.uvs = list.into_iter().map(|uv| placement.place(uv)).collect();
    }
    morph(document, primitive, weights, &mut read.mesh, &mut remarks);
    read.binding = binding(document, primitive, count, &mut remarks);
    let indices: Vec<u32> = match primitive.indices {
        // A restart value, or any other beyond the vertices, is a vertex that does not exist.
        Some(index) => accessor::read::<1>(document, index.value())?.into_iter().map(|[i]| i as u32).collect(),
        None => (0..count as u32).collect(),
    };
    read.mesh.triangles = triangles(mode, &indices);
    if mode == Mode::Triangles && !indices.len().is_multiple_of(3) {
        remarks.push(format!("{} indices at the end make no triangle", indices.len() % 3));
    }
    compact(&mut read);
    read.remarks = remarks;
    Ok(read)
}

/// Reads an attribute that a primitive may lack. One that is faulty, or shorter than the positions, is left out.
fn optional<const N: usize>(
    document: &Document<'_>,
    index: Option<usize>,
    count: usize,
    what: &str,
    remarks: &mut Vec<String>,
) -> Option<Vec<[f64; N]>> {
    let why = match accessor::read::<N>(document, index?) {
        Ok(mut list) if list.len() >= count => {
            list.truncate(count);
            return Some(list);
        }
        Ok(list) => format!("{} for {count} vertices", list.len()),
        Err(e) => e,
    };
    remarks.push(format!("{what} left out: {why}"));
    None
}

fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    // Repeated vertices turn a strip, and are no triangles.
    let real = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    match mode {
        Mode::TriangleStrip => {
            let turned = |(i, t): (usize, &[u32])| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
            indices.windows(3).enumerate().map(turned).filter(real).collect()
        }
        Mode::TriangleFan => match indices.split_first() {
            Some((&first, rest)) => rest.windows(2).map(|t| [first, t[0], t[1]]).filter(real).collect(),
            None => Vec::new(),
        },
        _ => indices.as_chunks::<3>().0.to_vec(),
    }
}

/// Adds the weighted displacements of morph targets.
fn morph(
    document: &Document<'_>,
    primitive: &Primitive,
    weights: &[f32],
    mesh: &mut Indexed,
    remarks: &mut Vec<String>,
) {
    let count = mesh.positions.len();
    for (target, &weight) in primitive.targets.iter().flatten().zip(weights) {
        if weight == 0.0 || !weight.is_finite() {
            continue;
        }
        let positions = target.positions.map(|a| a.value());
        if let Some(list) = optional::<3>(document, positions, count, "a morph target", remarks) {
            for (p, d) in mesh.positions.iter_mut().zip(list) {
                *p += DVec3::from(d) * f64::from(weight);
            }
        }
        let normals = target.normals.map(|a| a.value());
        if let Some(list) = optional::<3>(document, normals, count, "a morph target", remarks) {
            for (n, d) in mesh.normals.iter_mut().zip(list) {
                *n += DVec3::from(d).as_vec3() * weight;
            }
        }
    }
}

fn binding(document: &Document<'_>, primitive: &Primitive, count: usize, remarks: &mut Vec<String>) -> Option<Binding> {
    let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(|a| a.value());
    let mut binding: Option<Binding> = None;
    for set in 0..SETS {
        let (joints, weights) = (attribute(Semantic::Joints(set)), attribute(Semantic::Weights(set)));
        let joints = optional::<4>(document, joints, count, "joints", remarks);
        let weights = optional::<4>(document, weights, count, "weights", remarks);
        let (Some(joints), Some(weights)) = (joints, weights) else { break };
        let binding = binding.get_or_insert_with(|| Binding { influences: vec![Vec::new(); count] });
        for (influences, (joints, weights)) in binding.influences.iter_mut().zip(joints.into_iter().zip(weights)) {
            let pairs = joints.into_iter().zip(weights).filter(|(_, w)| *w > 0.0);
            influences.extend(pairs.map(|(joint, weight)| (joint as usize, weight)));
        }
    }
    binding
}

/// Removes vertices that no triangle uses, if most are such: primitives may share one list of vertices.
fn compact(read: &mut Read) {
    let mesh = &mut read.mesh;
    let count = mesh.positions.len();
    if count <= 3 * mesh.triangles.len() {
        return;
    }
    let mut place = vec![u32::MAX; count];
    let mut kept = Vec::new();
    for index in mesh.triangles.as_flattened_mut() {
        // An index beyond the vertices stays beyond them.
        let Some(new) = place.get_mut(*index as usize) else {
            *index = u32::MAX;
            continue;
        };
        if *new == u32::MAX {
            *new = kept.len() as u32;
            kept.push(*index as usize);
        }
        *index = *new;
    }
    fn some<T: Clone>(list: &[T], kept: &[usize]) -> Vec<T> {
        if list.is_empty() { Vec::new() } else { kept.iter().map(|&i| list[i].clone()).collect() }
    }
    mesh.positions = some(&mesh.positions, &kept);
    mesh.normals = some::<Vec3>(&mesh.normals, &kept);
    mesh.uvs = some::<Vec2>(&mesh.uvs, &kept);
    mesh.colours = some(&mesh.colours, &kept);
    if let Some(binding) = &mut read.binding {
        binding.influences = some(&binding.influences, &kept);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_keep_their_winding_and_fans_share_their_first_vertex() {
        assert_eq!(triangles(Mode::TriangleStrip, &[0, 1, 2, 3, 3, 4]), [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(triangles(Mode::TriangleFan, &[7, 1, 2, 3]), [[7, 1, 2], [7, 2, 3]]);
        assert_eq!(triangles(Mode::Triangles, &[0, 1, 2, 3, 4]), [[0, 1, 2]]);
        assert!(triangles(Mode::TriangleFan, &[]).is_empty());
    }

    #[test]
    fn vertices_that_nothing_uses_are_removed() {
        let mut read = Read::default();
        read.mesh.positions = (0..9).map(|i| DVec3::splat(f64::from(i))).collect();
        read.mesh.triangles = vec![[8, 2, 5], [5, 2, 99]];
        compact(&mut read);
        assert_eq!(read.mesh.positions, [8.0, 2.0, 5.0].map(DVec3::splat));
        assert_eq!(read.mesh.triangles, [[0, 1, 2], [2, 1, u32::MAX]]);
    }
}
