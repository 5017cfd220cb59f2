//! Skins at rest: vertices moved by the joints as the file leaves them.

use glam::{DMat3, DMat4};

use super::accessor;
use super::document::Document;
use super::primitive::Binding;
use super::tree::Tree;
use crate::load::indexed::Indexed;

/// Returns the map of each joint of a skin: from where vertices were bound to the world.
pub(super) fn joints(document: &Document<'_>, skin: usize, tree: &Tree) -> Result<Vec<DMat4>, String> {
    let skin = document.root.skins.get(skin).ok_or_else(|| format!("there is no skin {skin}"))?;
    let bound = match skin.inverse_bind_matrices {
        Some(index) => accessor::read::<16>(document, index.value())?,
        None => Vec::new(),
    };
    let world =
        |node: usize| tree.nodes.iter().find(|p| p.node == node).map(|p| p.world).ok_or("a joint is not in the scene");
    let matrix = |i: usize| bound.get(i).map_or(DMat4::IDENTITY, DMat4::from_cols_array);
    skin.joints.iter().enumerate().map(|(i, joint)| Ok(world(joint.value())? * matrix(i))).collect()
}

/// Moves vertices by their joints. A vertex without influences stays in place.
pub(super) fn pose(mesh: &mut Indexed, binding: &Binding, joints: &[DMat4]) {
    for (i, influences) in binding.influences.iter().enumerate() {
        let known = || influences.iter().filter_map(|&(joint, weight)| Some((joints.get(joint)?, weight)));
        let total: f64 = known().map(|(_, weight)| weight).sum();
        if total <= 0.0 {
            continue;
        }
        let sum = known().fold(DMat4::ZERO, |sum, (joint, weight)| sum + *joint * (weight / total));
        if let Some(p) = mesh.positions.get_mut(i) {
            *p = sum.transform_point3(*p);
        }
        if let Some(n) = mesh.normals.get_mut(i) {
            let normal = DMat3::from_mat4(sum).inverse().transpose() * n.as_dvec3();
            *n = normal.try_normalize().map_or(*n, |n| n.as_vec3());
        }
    }
}
