//! Pictures of normals and of emission on a mesh, in both renderers, by hand.

use glam::{Vec2, Vec3};
use serde_json::json;
use vitrum::effects::{self, Effect, EffectSet, Pipeline};
use vitrum::geometry::{Geometry, Shape, TriMesh};
use vitrum::render::{Options, reference};
use vitrum::scene::{Colour, Falloff, Light, LightKind, Material, Object, Relief, Rgb, Scene, Texture};

use super::load_as;
use crate::support::gltf::square;
use crate::support::scenes::{empty, material, native};

/// A white square that faces the camera, with texture coordinates `uvs` at its corners, lit along `direction` with 1.
fn lit(uvs: [[f32; 2]; 4], direction: Vec3) -> Scene {
    let mut scene = empty(0.0);
    scene.camera.eye = Vec3::new(0.0, 0.0, 5.0);
    (scene.settings.width, scene.settings.height) = (9, 9);
    let white = material(&mut scene, Material { diffuse: Colour::Constant(Rgb::ONE), ..Material::default() });
    let positions = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec();
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    let mesh = TriMesh {
        uvs: uvs.map(Vec2::from).to_vec(),
        uv_indices: triangles.clone(),
        ..TriMesh::new(positions, triangles)
    };
    scene.geometry.push(Geometry { shape: Shape::Mesh(mesh), mask: scene.materials[white as usize].mask() });
    scene.objects.push(Object { name: "wall".into(), material: white, origin: Default::default() });
    scene.lights = vec![Light {
        name: "lamp".into(),
        kind: LightKind::Directional { direction },
        intensity: Rgb::ONE,
        falloff: Falloff::None,
        shadows: true,
    }];
    scene
}

const UPRIGHT: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

#[track_caller]
fn centres_are(scene: &Scene, want: f32) {
    scene.validate().unwrap();
    let options = Options::default();
    let all =
        Options { effects: effects::Options { pipeline: Pipeline::All, ..Default::default() }, ..options.clone() };
    let [auto, all] = [native(scene, &options), native(scene, &all)];
    assert_eq!(auto.film.pixels, all.film.pixels);
    let exact = reference::render(scene, &options, &Default::default()).unwrap();
    for (name, film) in [("native", &auto.film), ("reference", &exact.film)] {
        let seen = film.at(4, 4)[0];
        assert!((seen - want).abs() < 2e-6, "{name}: {seen} is not {want}");
    }
}

#[test]
fn normals_lean_the_way_the_picture_runs_on_the_surface() {
    // The normal (0.6, 0, 0.8) of a picture whose u runs to the right, and to the left, and upwards.
    let code = Rgb::new(0.8, 0.5, 0.9);
    let mirrored = UPRIGHT.map(|[u, v]| [1.0 - u, v]);
    let turned = UPRIGHT.map(|[u, v]| [v, -u]);
    for (uvs, normal) in
        [(UPRIGHT, Vec3::new(0.6, 0.0, 0.8)), (mirrored, Vec3::new(-0.6, 0.0, 0.8)), (turned, Vec3::new(0.0, 0.6, 0.8))]
    {
        for towards in [Vec3::Z, Vec3::new(0.8, 0.0, 0.6), Vec3::new(0.0, 0.8, 0.6)] {
            let mut scene = lit(uvs, -towards);
            let texture = scene.add_texture(Texture::new("normals", 1, 1, vec![code]));
            scene.materials[0].relief = Some(Relief { texture, strength: 1.0 });
            centres_are(&scene, normal.dot(towards).max(0.0));
            let flat = effects::without(&scene, EffectSet::EMPTY.with(Effect::InterpolatedNormals));
            centres_are(&flat, towards.z);
        }
    }
}

#[test]
fn a_strength_of_nothing_is_flat() {
    let mut scene = lit(UPRIGHT, -Vec3::Z);
    let texture = scene.add_texture(Texture::new("normals", 1, 1, vec![Rgb::new(0.8, 0.3, 0.9)]));
    scene.materials[0].relief = Some(Relief { texture, strength: 0.0 });
    centres_are(&scene, 1.0);
}

#[test]
fn a_picture_of_emission_is_seen_and_without_textures_its_mean() {
    let mut scene = lit(UPRIGHT, -Vec3::Z);
    scene.lights.clear();
    // The middle of a picture of 3 by 3.
    let pixels = (0..9).map(|i| Rgb::splat(i as f32)).collect::<Vec<_>>();
    let texture = scene.add_texture(Texture::new("glow", 3, 3, pixels));
    scene.materials[0].emission = Rgb::splat(40.0);
    scene.materials[0].glow = Some(Colour::Image { texture, scale: Rgb::splat(0.5) });
    centres_are(&scene, 2.0);
    centres_are(&effects::without(&scene, EffectSet::EMPTY.with(Effect::Textures)), 40.0);
    centres_are(&effects::without(&scene, EffectSet::EMPTY.with(Effect::Emission)), 0.0);
    scene.materials[0].glow = Some(Colour::Image { texture: 7, scale: Rgb::ONE });
    assert!(scene.validate().is_err());
}

#[test]
fn pictures_of_a_gltf_material_become_albedo_holes_emission_and_normals() {
    let folder = tempfile::tempdir().unwrap();
    let picture = image::RgbaImage::from_fn(2, 2, |x, y| image::Rgba([255, 128, 0, if x == y { 255 } else { 100 }]));
    picture.save(folder.path().join("a.png")).unwrap();
    let model = square()
        .with("images", json!([{ "uri": "a.png" }]))
        .with("textures", json!([{ "source": 0, "sampler": 0 }]))
        .with("samplers", json!([{ "wrapS": 33071, "wrapT": 33648 }]))
        .with(
            "materials",
            json!([{
                "alphaMode": "MASK", "alphaCutoff": 0.3,
                "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicFactor": 0 },
                "emissiveTexture": { "index": 0 }, "emissiveFactor": [1, 1, 1],
                "normalTexture": { "index": 0, "scale": 0.5 }
            }]),
        );
    std::fs::write(folder.path().join("a.gltf"), model.text()).unwrap();
    let scene = vitrum::load::scene(&folder.path().join("a.gltf"), &Default::default()).unwrap().scene;
    scene.validate().unwrap();
    let material = &scene.materials[scene.objects[0].material as usize];
    let Colour::Image { texture, .. } = material.diffuse else { panic!("{material:?}") };
    let base = &scene.textures[texture as usize];
    assert_eq!(base.wrap, [vitrum::scene::Wrap::Clamp, vitrum::scene::Wrap::Mirror]);
    assert!((base.pixels.get(0) - Rgb::new(1.0, 0.215_86, 0.0)).abs().max_element() < 1e-5);
    // 100 of 255 is above the cut at 0.3.
    let vitrum::scene::Interface::Alpha { opacity, mask: Some(mask) } = material.interface else { panic!() };
    assert_eq!(opacity, 1.0);
    assert!(scene.textures[mask as usize].pixels.iter().all(|p| p == Rgb::ONE));
    assert!(matches!(material.glow, Some(Colour::Image { .. })));
    // Codes of normals are shares, not colours.
    let relief = material.relief.unwrap();
    assert_eq!(relief.strength, 0.5);
    assert!((scene.textures[relief.texture as usize].pixels.get(0).y - 128.0 / 255.0).abs() < 1e-6);
    assert!(load_as("a.gltf", model.text()).is_ok());
}
