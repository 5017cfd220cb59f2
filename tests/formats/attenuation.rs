//! Light through glTF solids of known thickness, by hand.

use serde_json::json;
use vitrum::render::Options;
use vitrum::scene::{Camera, Environment, Projection, Rgb, Scene};

use super::load_as;
use crate::support::gltf::Model;
use crate::support::scenes::native;

const COLOUR: [f64; 3] = [0.1, 0.5, 0.9];

/// A cube from -1/2 to 1/2.
fn cube() -> Model {
    let mut model = Model::new();
    let corners: Vec<f32> = (0..8).flat_map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|b| b as f32 - 0.5)).collect();
    let positions = model.floats("VEC3", 3, &corners);
    // Two triangles a face, counter-clockwise from outside.
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let indices: Vec<u16> = faces.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect();
    let indices = model.indices(&indices);
    model.with(
        "meshes",
        json!([{ "primitives": [{
        "attributes": { "POSITION": positions }, "indices": indices, "material": 0
    }] }]),
    )
}

/// The middle of a picture of a cube of edge `edge` that hangs in white.
fn seen(edge: f64, distance: f64, thickness: f64) -> [f32; 3] {
    let glass = json!({
        "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0 },
        "extensions": {
            "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_volume": {
                "thicknessFactor": thickness, "attenuationDistance": distance, "attenuationColor": COLOUR
            }
        }
    });
    let model =
        cube().with("materials", json!([glass])).with("nodes", json!([{ "mesh": 0, "scale": [edge, edge, edge] }]));
    let mut scene: Scene = load_as("a.glb", model.binary()).unwrap().scene;
    scene.environment = Environment::Constant(Rgb::ONE);
    scene.lights.clear();
    scene.camera = Camera {
        eye: glam::Vec3::new(0.0, 0.0, 9.0),
        target: glam::Vec3::ZERO,
        projection: Projection::Orthographic { height: 0.01 },
        ..Camera::default()
    };
    (scene.settings.width, scene.settings.height, scene.settings.cutoff) = (3, 3, 1e-7);
    native(&scene, &Options::default()).film.at(1, 1)
}

/// `R + (1 - R)^2 T / (1 - R T)`: what the front reflects, and what crosses the cube after 1, 2, 3 ... passes, the
/// surroundings being white on all sides; `T` is the colour to the power of thickness over distance.
fn by_hand(edge: f64, distance: f64) -> [f64; 3] {
    let r = 0.04;
    COLOUR.map(|c| {
        let t = c.powf(edge / distance);
        r + (1.0 - r) * (1.0 - r) * t / (1.0 - r * t)
    })
}

#[test]
fn a_cube_absorbs_by_its_edge_in_the_world_whatever_its_thickness_factor_and_its_nodes_scale() {
    // Rows 2 to 4 of the Khronos test of attenuation by edges, and row 5 by distances.
    let edges = [0.25, 0.5, 1.0, 1.5, 2.0].map(|edge| (edge, 1.0));
    let distances = [4.0, 2.0, 1.0, 2.0 / 3.0, 0.5].map(|distance| (1.0, distance));
    for (edge, distance) in edges.into_iter().chain(distances) {
        for thickness in [edge, 0.01] {
            let (seen, want) = (seen(edge, distance, thickness), by_hand(edge, distance));
            for (seen, want) in seen.into_iter().zip(want) {
                assert!((f64::from(seen) - want).abs() < 2e-5, "edge {edge}, distance {distance}: {seen}, not {want}");
            }
        }
    }
}
