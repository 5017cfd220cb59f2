//! Copies of a node's mesh (`EXT_mesh_gpu_instancing`).

use glam::DMat4;
use gltf_json::scene::Node;

use super::accessor;
use super::document::Document;
use super::extension::Fields;
use super::tree::{extensions, placement};

/// Returns the maps from copies of a node's mesh to the node; `None` without the extension.
pub(super) fn maps(document: &Document<'_>, node: &Node) -> Result<Option<Vec<DMat4>>, String> {
    let Some(fields) = Fields::of(extensions(node), "EXT_mesh_gpu_instancing") else { return Ok(None) };
    let attributes = fields.object("attributes");
    fn list<const N: usize>(
        document: &Document<'_>,
        attributes: Fields<'_>,
        name: &str,
    ) -> Result<Option<Vec<[f64; N]>>, String> {
        attributes.index(name).map(|index| accessor::read::<N>(document, index)).transpose()
    }
    let moves = list::<3>(document, attributes, "TRANSLATION")?;
    let turns = list::<4>(document, attributes, "ROTATION")?;
    let scales = list::<3>(document, attributes, "SCALE")?;
    let counts = [moves.as_ref().map(Vec::len), turns.as_ref().map(Vec::len), scales.as_ref().map(Vec::len)];
    let Some(count) = counts.into_iter().flatten().min() else {
        return Err(String::from("they have no translation, rotation or scale"));
    };
    let map = |i: usize| {
        placement(
            scales.as_ref().map_or([1.0; 3], |s| s[i]),
            turns.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |t| t[i]),
            moves.as_ref().map_or([0.0; 3], |m| m[i]),
        )
    };
    Ok(Some((0..count).map(map).collect()))
}
