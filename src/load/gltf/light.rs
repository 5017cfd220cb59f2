//! Cameras, and lights of `KHR_lights_punctual`.

use glam::{DMat4, DVec3};
use gltf_json::camera::Camera;
use serde_json::Value;

use super::document::Document;
use super::extension::Fields;
use super::tree::{Tree, extensions};
use crate::load::extras::{Lamp, LampKind, View};
use crate::scene::{Projection, Rgb};

/// Largest intensity; products with it stay finite.
const MOST: f64 = 1e30;

/// Camera with the name that selects it.
pub(super) struct NamedView {
    pub names: Vec<String>,
    pub view: View,
}

/// Returns the cameras of the scene, in its order.
pub(super) fn views(document: &Document<'_>, tree: &Tree) -> Vec<NamedView> {
    let root = &document.root;
    let nodes = tree.nodes.iter().filter_map(|placed| Some((placed.world, root.nodes.get(placed.node)?)));
    nodes
        .filter_map(|(world, node)| {
            let camera = root.cameras.get(node.camera?.value())?;
            let names = [node.name.clone(), camera.name.clone()].into_iter().flatten().collect();
            Some(NamedView { names, view: view(camera, world)? })
        })
        .collect()
}

fn view(camera: &Camera, world: DMat4) -> Option<View> {
    let projection = match (&camera.perspective, &camera.orthographic) {
        (Some(p), _) => {
            let vfov = f64::from(p.yfov).to_degrees();
            Projection::Pinhole { vfov: Some(vfov as f32).filter(|v| *v > 0.0 && *v < 180.0)? }
        }
        (None, Some(o)) => {
            Projection::Orthographic { height: Some(2.0 * o.ymag.abs()).filter(|h| *h > 0.0 && h.is_finite())? }
        }
        (None, None) => return None,
    };
    let forward = world.transform_vector3(-DVec3::Z).try_normalize()?;
    let up = world.transform_vector3(DVec3::Y).try_normalize()?;
    let eye = world.transform_point3(DVec3::ZERO);
    (eye.is_finite() && forward.cross(up).length() > 1e-3).then_some(View {
        eye,
        forward,
        up: up.as_vec3(),
        projection,
    })
}

/// Returns the lights of the scene, and remarks on what was left out of them. A light's intensity is in candela, or in
/// lux for a directional one, and is taken as our radiant intensity and irradiance; so emission in nits fits to it.
pub(super) fn lamps(document: &Document<'_>, tree: &Tree) -> (Vec<Lamp>, Vec<String>) {
    let root = &document.root;
    let all = Fields::of(root.extensions.as_ref().map(|e| &e.others), "KHR_lights_punctual");
    let all = all.and_then(|f| f.get("lights")).and_then(Value::as_array);
    let (mut lamps, mut remarks) = (Vec::new(), Vec::new());
    for placed in &tree.nodes {
        let Some(node) = root.nodes.get(placed.node) else { continue };
        let Some(index) = Fields::of(extensions(node), "KHR_lights_punctual").and_then(|f| f.index("light")) else {
            continue;
        };
        if placed.hidden {
            continue;
        }
        let fields = all.and_then(|all| all.get(index)).map(Fields::from);
        let Some(lamp) = fields.and_then(|f| lamp(f, node.name.as_deref(), placed.world, &mut remarks)) else {
            remarks.push(format!("light {index} left out: it has no known type, or no place"));
            continue;
        };
        lamps.push(lamp);
    }
    (lamps, remarks)
}

fn lamp(fields: Fields<'_>, node: Option<&str>, world: DMat4, remarks: &mut Vec<String>) -> Option<Lamp> {
    let name = fields.text("name").or(node).unwrap_or("light").to_owned();
    let place = world.transform_point3(DVec3::ZERO);
    let direction = || Some(world.transform_vector3(-DVec3::Z).try_normalize()?.as_vec3());
    if !place.is_finite() {
        return None;
    }
    let kind = match fields.text("type")? {
        "directional" => LampKind::Distant { direction: direction()? },
        "point" => LampKind::Point { place },
        "spot" => {
            let cone = fields.object("spot");
            let half = std::f64::consts::FRAC_PI_2;
            let outer = cone.number("outerConeAngle", half * 0.5).clamp(1e-3, half);
            let inner = cone.number("innerConeAngle", 0.0).clamp(0.0, outer);
            let [cos_inner, cos_outer] = [inner, outer].map(|a| a.cos() as f32);
            LampKind::Spot { place, direction: direction()?, cos_inner, cos_outer }
        }
        _ => return None,
    };
    if fields.get("range").is_some() && !matches!(kind, LampKind::Distant { .. }) {
        remarks.push(String::from("the range of lights is left out: light falls off by the square of the distance"));
    }
    let colour = fields.numbers("color", [1.0; 3]).map(|c| c.clamp(0.0, MOST));
    let intensity = fields.number("intensity", 1.0).max(0.0);
    let intensity = colour.map(|c| (c * intensity).min(MOST) as f32);
    Some(Lamp { name, kind, intensity: Rgb::from(intensity) })
}
