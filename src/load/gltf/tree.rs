//! The tree of nodes: transforms into the world, in the order of the file.

use glam::{DMat4, DQuat, DVec3, DVec4};
use gltf_json::Root;
use gltf_json::scene::Node;

use super::extension::{Extensions, Fields};

/// A node of the scene that is shown.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    /// Index in the file.
    pub node: usize,
    /// Map from the node to the world.
    pub world: DMat4,
    /// True if the node, or one that it belongs to, is hidden.
    pub hidden: bool,
}

/// Nodes of the scene that is shown.
#[derive(Debug, Default)]
pub(super) struct Tree {
    pub nodes: Vec<Placed>,
    /// Number of nodes that were reached twice, the second time left out.
    pub repeated: usize,
}

/// Returns the nodes of the file's scene, or of its first one. A file without scenes shows all of its nodes.
pub(super) fn tree(root: &Root) -> Tree {
    let scene = root.scene.and_then(|s| root.scenes.get(s.value())).or_else(|| root.scenes.first());
    let roots: Vec<usize> = match scene {
        Some(scene) => scene.nodes.iter().map(|n| n.value()).collect(),
        None => {
            let mut child = vec![false; root.nodes.len()];
            for c in root.nodes.iter().flat_map(|n| n.children.iter().flatten()) {
                child.get_mut(c.value()).into_iter().for_each(|c| *c = true);
            }
            (0..root.nodes.len()).filter(|&n| !child[n]).collect()
        }
    };
    let mut tree = Tree::default();
    let mut seen = vec![false; root.nodes.len()];
    let mut waiting: Vec<Placed> =
        roots.into_iter().rev().map(|node| Placed { node, world: DMat4::IDENTITY, hidden: false }).collect();
    while let Some(Placed { node, world, hidden }) = waiting.pop() {
        let Some(found) = root.nodes.get(node) else { continue };
        if std::mem::replace(&mut seen[node], true) {
            tree.repeated += 1;
            continue;
        }
        let world = world * local(found);
        let visibility = Fields::of(extensions(found), "KHR_node_visibility");
        let hidden =
            hidden || visibility.and_then(|v| v.get("visible")).and_then(serde_json::Value::as_bool) == Some(false);
        tree.nodes.push(Placed { node, world, hidden });
        let children = found.children.iter().flatten().rev();
        waiting.extend(children.map(|c| Placed { node: c.value(), world, hidden }));
    }
    tree
}

/// Returns the extensions of a node.
pub(super) fn extensions(node: &Node) -> Option<&Extensions> {
    node.extensions.as_ref().map(|e| &e.others)
}

/// Returns the map from a node to its parent.
fn local(node: &Node) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix.map(f64::from));
    }
    let rotation = node.rotation.map_or([0.0, 0.0, 0.0, 1.0], |r| r.0);
    let [scale, move_by] = [node.scale.unwrap_or([1.0; 3]), node.translation.unwrap_or([0.0; 3])];
    placement(scale.map(f64::from), rotation.map(f64::from), move_by.map(f64::from))
}

/// Returns the map that scales, turns by a quaternion (x, y, z, w) and moves.
pub(super) fn placement(scale: [f64; 3], rotation: [f64; 4], move_by: [f64; 3]) -> DMat4 {
    let turn = DVec4::from(rotation).try_normalize().map_or(DQuat::IDENTITY, DQuat::from_vec4);
    DMat4::from_scale_rotation_translation(DVec3::from(scale), turn, DVec3::from(move_by))
}
