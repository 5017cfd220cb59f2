//! Reader of glTF 2.0 models (Khronos, ISO/IEC 12113), as text with files beside it or as one binary file.
//!
//! `gltf-json`, the part of the crate `gltf` that knows the format's fields, reads the text. Extensions are read from
//! their raw JSON, for it knows half of those that matter here. The rest of that crate is not used. Without its
//! validation it panics on indices out of range. With it, it refuses files for faults that change no picture. Its reader of
//! binary files subtracts the header from a length that may be smaller. So every index and every range of
//! bytes is checked here (`accessor`, `document`).

mod accessor;
mod container;
mod document;
mod extension;
mod instance;
mod light;
mod material;
mod picture;
mod primitive;
mod skin;
mod texture;
mod tree;

use std::collections::HashMap;
use std::path::Path;

use glam::DMat4;
use gltf_json::mesh::{Mesh, Semantic};
use gltf_json::scene::Node;
use gltf_json::validation::Checked;

use self::document::Document;
use self::material::Materials;
use self::tree::{Placed, Tree};
use super::assembly::Assembly;
use super::draft::MeshDraft;
use super::extras::Extras;
use super::request::Request;
use super::transform::Transform;
use crate::system::files::read;
use crate::{Error, Result};

/// Reads a model into the scene, one shape for each primitive of each node, and returns its camera and its lights.
pub(super) fn load(path: &Path, request: &Request<'_>, assembly: &mut Assembly<'_>) -> Result<Extras> {
    let bytes = read(path, assembly.options.limits.file_bytes)?;
    let container = container::open(&bytes).map_err(|e| Error::file(path, e))?;
    let document = Document::read(path, container, assembly)?;
    if let Some(message) = extension::unsupported(&document.root) {
        return Err(Error::file(path, message));
    }
    for name in extension::left_out(&document.root) {
        let name: String = name.chars().take(80).collect();
        let kind = format!("the extension `{name}` is left out");
        assembly.reporter.warn(path, 0, &kind, String::new)?;
    }
    let tree = tree::tree(&document.root);
    if tree.repeated > 0 {
        let kind = "nodes with two parents, or within themselves, count once";
        assembly.reporter.warn(path, 0, kind, String::new)?;
    }
    let dropped_before = assembly.reporter.dropped_so_far();
    let mut reading = Reading {
        request,
        document: &document,
        tree: &tree,
        materials: Materials::new(&document, request.transform.scale()),
        known: HashMap::new(),
        faces: 0,
        shown: 0,
    };
    for placed in tree.nodes.iter().filter(|p| !p.hidden) {
        reading.node(placed, assembly)?;
    }
    let (faces, shown) = (reading.faces, reading.shown);
    assembly.reporter.model(path, faces, dropped_before);
    if shown == 0 {
        return Err(Error::file(path, nothing(&document, faces)));
    }
    notes(&document, assembly);
    extras(&document, &tree, assembly)
}

/// Returns the message for a file in which nothing can be drawn.
fn nothing(document: &Document<'_>, faces: usize) -> String {
    let root = &document.root;
    if faces > 0 {
        return format!("has no triangles: none of its faces ({faces}) can be drawn");
    }
    match root.meshes.len() {
        0 => format!("has no triangles: there is no mesh in it, but {} nodes", root.nodes.len()),
        n => format!("has no triangles: its meshes ({n}) hold none, or no node of the scene shows them"),
    }
}

/// Notes what a picture of a model at rest does not show.
fn notes(document: &Document<'_>, assembly: &mut Assembly<'_>) {
    let root = &document.root;
    if !root.animations.is_empty() || !root.skins.is_empty() {
        let what = if root.animations.is_empty() { "skinned" } else { "animated" };
        assembly.reporter.default_used(format!("the {what} model at rest, as its nodes stand in the file"));
    }
}

/// Returns the camera that the options name, or the first one, and the lights.
fn extras(document: &Document<'_>, tree: &Tree, assembly: &mut Assembly<'_>) -> Result<Extras> {
    let views = light::views(document, tree);
    let (lamps, remarks) = light::lamps(document, tree);
    for remark in remarks {
        assembly.reporter.warn(document.path, 0, &remark, String::new)?;
    }
    let view = match &assembly.options.camera {
        None => views.first(),
        Some(name) => Some(views.iter().find(|v| v.names.contains(name)).ok_or_else(|| {
            let known: Vec<&str> = views.iter().filter_map(|v| Some(v.names.first()?.as_str())).take(20).collect();
            let known =
                if known.is_empty() { String::from("it has none") } else { format!("it has {}", known.join(", ")) };
            Error::file(document.path, format!("no camera is called `{name}`; {known}"))
        })?),
    };
    Ok(Extras { view: view.map(|v| v.view), lamps, ..Extras::default() })
}

struct Reading<'r, 'd, 'p> {
    request: &'r Request<'r>,
    document: &'d Document<'p>,
    tree: &'d Tree,
    materials: Materials<'d, 'p>,
    /// Checked primitives of meshes without skin, by mesh and primitive; `None` for those without triangles.
    known: HashMap<(usize, usize), Option<MeshDraft>>,
    /// Number of faces, drawn or not.
    faces: usize,
    /// Number of shapes added.
    shown: usize,
}

impl Reading<'_, '_, '_> {
    fn warn(&self, what: &str, mesh: &str, assembly: &mut Assembly<'_>) -> Result<()> {
        let mesh: String = mesh.chars().take(80).collect();
        assembly.reporter.warn(self.document.path, 0, what, || format!(": mesh {mesh}"))
    }

    fn node(&mut self, placed: &Placed, assembly: &mut Assembly<'_>) -> Result<()> {
        let root = &self.document.root;
        let Some(node) = root.nodes.get(placed.node) else { return Ok(()) };
        let Some(index) = node.mesh.map(|m| m.value()) else { return Ok(()) };
        let Some(mesh) = root.meshes.get(index) else {
            return self.warn("a node of a mesh that does not exist is left out", &index.to_string(), assembly);
        };
        let name = [&node.name, &mesh.name].into_iter().flatten().find(|n| !n.is_empty()).cloned();
        let name = name.unwrap_or_else(|| format!("mesh {index}"));
        let worlds = match instance::maps(self.document, node) {
            Ok(Some(maps)) => maps.into_iter().map(|map| placed.world * map).collect(),
            Ok(None) => vec![placed.world],
            Err(e) => {
                self.warn(&format!("instances left out: {e}"), &name, assembly)?;
                vec![placed.world]
            }
        };
        for primitive in 0..mesh.primitives.len() {
            self.primitive(node, (index, mesh, primitive), &worlds, &name, assembly)?;
        }
        Ok(())
    }

    /// Adds a primitive of a mesh at each of its places.
    fn primitive(
        &mut self,
        node: &Node,
        (index, mesh, primitive): (usize, &Mesh, usize),
        worlds: &[DMat4],
        name: &str,
        assembly: &mut Assembly<'_>,
    ) -> Result<()> {
        let given = &mesh.primitives[primitive];
        let made = match self.request.material {
            Some(_) => None,
            None => {
                let painted = given.attributes.contains_key(&Checked::Valid(Semantic::Colors(0)));
                Some(self.materials.get(given.material.map(|m| m.value()), painted, assembly)?)
            }
        };
        let skinned = node.skin.is_some();
        let own = skinned || node.weights.is_some();
        let known = if own { None } else { self.known.get(&(index, primitive)) };
        let draft = match known {
            Some(known) => known.clone(),
            None => {
                // A material that replaces the file's own may have a picture.
                let placement = made.and_then(|m| m.placement).unwrap_or_default();
                let read = self.read(node, (mesh, primitive), placement, name, assembly)?;
                if !own {
                    self.known.insert((index, primitive), read.clone());
                }
                read
            }
        };
        let Some(mut draft) = draft else { return Ok(()) };
        if made.is_none() {
            draft.mesh.colours.clear();
        }
        let Some(material) = made.map(|m| m.material).or(self.request.material) else { return Ok(()) };
        let replaced = self.request.replacement(&assembly.scene.materials[material as usize].name);
        let material = replaced.filter(|_| made.is_some()).unwrap_or(material);
        let part = match mesh.primitives.len() {
            1 => name.to_owned(),
            _ => format!("{name}/{primitive}"),
        };
        // The joints of a skin place it, whatever its node.
        let worlds = if skinned { &[DMat4::IDENTITY][..] } else { worlds };
        for world in worlds {
            let transform = match Transform::new(*world) {
                Ok(transform) => transform,
                Err(e) => {
                    self.warn("a mesh whose transform cannot be undone is left out", &format!("{name} {e}"), assembly)?;
                    continue;
                }
            };
            assembly.take_triangles(draft.mesh.triangles.len() as u64)?;
            let mut placed = draft.clone();
            if let Err(e) = transform.mesh(&mut placed) {
                self.warn("a mesh beyond the largest coordinate is left out", &format!("{name} {e}"), assembly)?;
                continue;
            }
            let part = self.request.material.is_none().then_some(part.as_str());
            self.request.add(self.document.path, part, placed, material, Vec::new(), assembly)?;
            self.shown += 1;
        }
        Ok(())
    }

    /// Reads and checks a primitive.
    fn read(
        &mut self,
        node: &Node,
        (mesh, primitive): (&Mesh, usize),
        placement: texture::Placement,
        name: &str,
        assembly: &mut Assembly<'_>,
    ) -> Result<Option<MeshDraft>> {
        let weights = node.weights.as_ref().or(mesh.weights.as_ref()).map_or(&[][..], Vec::as_slice);
        let read = primitive::read(self.document, &mesh.primitives[primitive], &placement, weights);
        let mut read = match read {
            Ok(read) => read,
            Err(e) => {
                self.warn(&format!("a primitive is left out: {e}"), name, assembly)?;
                return Ok(None);
            }
        };
        for remark in &read.remarks {
            self.warn(remark, name, assembly)?;
        }
        if let (Some(skin), Some(binding)) = (node.skin, &read.binding) {
            match skin::joints(self.document, skin.value(), self.tree) {
                Ok(joints) => skin::pose(&mut read.mesh, binding, &joints),
                Err(e) => self.warn(&format!("a skin is left out: {e}"), name, assembly)?,
            }
        }
        self.faces += read.mesh.triangles.len();
        let (path, limit) = (self.document.path, self.request.limit);
        let (draft, _) = read.mesh.checked(path, limit, &mut assembly.reporter)?;
        Ok(Some(draft).filter(|d| !d.mesh.triangles.is_empty()))
    }
}
