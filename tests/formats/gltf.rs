//! glTF models.

use glam::{Vec2, Vec3};
use serde_json::{Value, json};
use vitrum::load::{self, LoadOptions, Loaded};
use vitrum::scene::{Colour, Dispersion, Falloff, Interface, LightKind, Material, Projection, Rgb};

use super::{Folder, corners, load_as, mesh, refused, warnings, warns};
use crate::support::gltf::{F32, Model, U8, U16, U32, square};

fn loaded(model: &Model) -> Loaded {
    load_as("a.gltf", model.text()).unwrap()
}

/// The square with a material.
fn of_material(material: Value) -> Loaded {
    loaded(&square().with("materials", json!([material])))
}

fn only_material(loaded: &Loaded) -> &Material {
    &loaded.scene.materials[loaded.scene.objects[0].material as usize]
}

#[test]
fn the_text_with_its_buffer_and_the_binary_file_are_the_same_model() {
    let [text, binary] = [load_as("a.gltf", square().text()).unwrap(), load_as("a.glb", square().binary()).unwrap()];
    for loaded in [&text, &binary] {
        let mesh = mesh(loaded, 0);
        assert_eq!(corners(mesh)[1], [Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
        assert_eq!(mesh.corner_normals(0), Some([Vec3::Z; 3]));
        // The file's v runs downwards.
        assert_eq!(mesh.corner_uvs(0), Some([Vec2::ZERO, Vec2::X, Vec2::ONE]));
        assert_eq!(loaded.scene.objects[0].name, "a/square");
    }
    assert_eq!(text.scene.camera, binary.scene.camera);
}

#[test]
fn a_buffer_may_be_a_file_whose_name_is_escaped() {
    let model = square();
    let mut fields: Value = serde_json::from_str(&model.text()).unwrap();
    fields["buffers"][0]["uri"] = "two%20words.bin".into();
    let folder = Folder::new().with("two words.bin", &model.buffer).with("a.gltf", fields.to_string());
    assert_eq!(mesh(&folder.load("a.gltf").unwrap(), 0).triangles.len(), 2);
    fields["buffers"][0]["uri"] = "missing.bin".into();
    refused(load_as("a.gltf", fields.to_string()), "has no triangles");
}

#[test]
fn indices_of_every_type_and_none_give_the_same_triangles() {
    for (component, width) in [(U8, 1), (U16, 2), (U32, 4)] {
        let mut model = square();
        let bytes: Vec<u8> = [0_u32, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()[..width].to_vec()).collect();
        let view = model.view(&bytes, None);
        let fields = json!({ "bufferView": view, "componentType": component, "type": "SCALAR", "count": 6 });
        model.fields["meshes"][0]["primitives"][0]["indices"] = model.accessor(fields).into();
        assert_eq!(mesh(&loaded(&model), 0).triangles, [[0, 1, 2], [0, 2, 3]], "{component}");
    }
    let mut model = square();
    model.fields["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices");
    // Four vertices in order: one triangle, and a remark on the last one.
    let loaded = loaded(&model);
    assert_eq!(mesh(&loaded, 0).triangles, [[0, 1, 2]]);
    warns(&loaded, "1 indices at the end");
}

#[test]
fn strips_and_fans_face_the_way_of_their_first_triangle() {
    for (mode, indices) in [(5, [0, 1, 3, 2]), (6, [0, 1, 2, 3])] {
        let mut model = square();
        let indices = model.indices(&indices);
        model.fields["meshes"][0]["primitives"][0]["mode"] = mode.into();
        model.fields["meshes"][0]["primitives"][0]["indices"] = indices.into();
        let loaded = loaded(&model);
        let triangles = corners(mesh(&loaded, 0));
        assert_eq!(triangles.len(), 2);
        for [a, b, c] in triangles {
            assert!(((b - a).cross(c - a) - Vec3::Z).length() < 1e-6, "mode {mode}: {a} {b} {c}");
        }
    }
}

#[test]
fn interleaved_normalised_and_sparse_positions_are_read() {
    let mut model = square();
    // Three shorts and a filler; 32767 is 1.
    let shorts = [[0, 0, 0, 9], [32_767, 0, 0, 9], [32_767, 32_767, 0, 9], [0, -32_768, 0, 9]];
    let bytes: Vec<u8> = shorts.as_flattened().iter().flat_map(|x: &i16| x.to_le_bytes()).collect();
    let view = model.view(&bytes, Some(8));
    let changed = model.view(&[3], None);
    let value: Vec<u8> = [0_i16, 16_384, 0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let value = model.view(&value, None);
    let sparse = json!({ "count": 1, "indices": { "bufferView": changed, "componentType": U8 },
        "values": { "bufferView": value } });
    let at = |sparse: Option<Value>| {
        let mut fields = json!({ "bufferView": view, "componentType": 5122, "type": "VEC3", "count": 4,
            "normalized": true });
        if let Some(sparse) = sparse {
            fields["sparse"] = sparse;
        }
        fields
    };
    for (sparse, y) in [(None, -1.0), (Some(sparse), 16_384.0 / 32_767.0)] {
        let accessor = model.accessor(at(sparse));
        model.fields["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = accessor.into();
        model.fields["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
        let loaded = loaded(&model);
        let corners = corners(mesh(&loaded, 0));
        assert_eq!(corners[0], [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0)]);
        assert_eq!(corners[1][2], Vec3::new(0.0, y, 0.0));
    }
}

#[test]
fn nodes_compose_and_a_mirror_keeps_the_outside_outside() {
    let nodes = json!([
        { "children": [1], "translation": [10, 0, 0], "rotation": [0, 0, 0.5_f64.sqrt(), 0.5_f64.sqrt()] },
        { "mesh": 0, "scale": [2, 1, -1] }
    ]);
    let loaded = loaded(&square().with("nodes", nodes));
    let mesh = mesh(&loaded, 0);
    // Scaled by 2 along x, turned from x to y, moved along x.
    let far = Vec3::new(9.0, 2.0, 0.0);
    assert!(mesh.positions.iter().any(|p| (*p - far).length() < 1e-5), "{:?}", mesh.positions);
    // The mirror turns the normal, and the triangles are turned with it.
    for [a, b, c] in corners(mesh) {
        assert!((b - a).cross(c - a).z < 0.0);
    }
    assert!((mesh.normals[0] - -Vec3::Z).length() < 1e-6);
}

#[test]
fn instances_are_placed_one_by_one() {
    let mut model = square();
    let moves = model.floats("VEC3", 3, &[0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 3.0]);
    let scales = model.floats("VEC3", 3, &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0]);
    let attributes = json!({ "TRANSLATION": moves, "SCALE": scales });
    model.fields["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    let loaded = loaded(&model);
    for i in 0..3 {
        let size = i as f32 + 1.0;
        assert_eq!(mesh(&loaded, i).positions[2], Vec3::new(size, size, size));
    }
    assert_eq!(loaded.scene.objects.len(), 3);
}

#[test]
fn a_skinned_mesh_stands_where_its_joints_do() {
    let mut model = square();
    let bytes = [0_u8, 1, 0, 0].repeat(4);
    let joints = model.view(&bytes, None);
    let joints = model.accessor(json!({ "bufferView": joints, "componentType": U8, "type": "VEC4", "count": 4 }));
    // The first two vertices follow the first joint, the others both of them in halves.
    let weights = [[1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0]];
    let weights = model.floats("VEC4", 4, weights.as_flattened());
    let attributes = &mut model.fields["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = joints.into();
    attributes["WEIGHTS_0"] = weights.into();
    let nodes = json!([
        { "children": [1, 2, 3], "translation": [5, 0, 0] },
        { "mesh": 0, "skin": 0, "translation": [0, 100, 0] },
        { "translation": [0, 0, 1] },
        { "translation": [0, 0, 3] }
    ]);
    let loaded = loaded(&model.with("nodes", nodes).with("skins", json!([{ "joints": [2, 3] }])));
    let positions = &mesh(&loaded, 0).positions;
    assert_eq!(positions[1], Vec3::new(6.0, 0.0, 1.0));
    assert_eq!(positions[2], Vec3::new(6.0, 1.0, 2.0));
    assert!(loaded.report.defaults.iter().any(|d| d.contains("skinned model at rest")), "{:?}", loaded.report.defaults);
}

#[test]
fn morph_targets_move_vertices_by_their_weights() {
    let mut model = square();
    let moves = model.floats("VEC3", 3, &[0.0, 0.0, 4.0].repeat(4));
    model.fields["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": moves }]);
    model.fields["meshes"][0]["weights"] = json!([0.25]);
    assert_eq!(mesh(&loaded(&model), 0).positions[0].z, 1.0);
    model.fields["nodes"][0]["weights"] = json!([0.5]);
    assert_eq!(mesh(&loaded(&model), 0).positions[0].z, 2.0);
}

#[test]
fn cameras_are_taken_in_order_or_by_name() {
    let cameras = json!([
        { "type": "perspective", "perspective": { "yfov": std::f64::consts::FRAC_PI_2, "znear": 0.1 } },
        { "name": "plan", "type": "orthographic", "orthographic": { "xmag": 2, "ymag": 3, "znear": 0, "zfar": 9 } }
    ]);
    let nodes = json!([
        { "mesh": 0, "children": [1, 2] },
        { "name": "front", "camera": 0, "translation": [1, 2, 5] },
        { "camera": 1, "rotation": [-(0.5_f64.sqrt()), 0, 0, 0.5_f64.sqrt()], "translation": [0, 7, 0] }
    ]);
    let folder = Folder::new().with("a.gltf", square().with("nodes", nodes).with("cameras", cameras).text());
    let by_name = |name: Option<&str>| {
        let options = LoadOptions { camera: name.map(str::to_owned), ..LoadOptions::default() };
        load::scene(&folder.path("a.gltf"), &options)
    };
    let first = by_name(None).unwrap().scene.camera;
    assert_eq!(first.eye, Vec3::new(1.0, 2.0, 5.0));
    assert!(((first.target - first.eye).normalize() + Vec3::Z).length() < 1e-6);
    assert_eq!(first.projection, Projection::Pinhole { vfov: 90.0 });
    assert_eq!(by_name(Some("front")).unwrap().scene.camera, first);
    let plan = by_name(Some("plan")).unwrap().scene.camera;
    assert!(((plan.target - plan.eye).normalize() + Vec3::Y).length() < 1e-6);
    assert_eq!(plan.projection, Projection::Orthographic { height: 6.0 });
    refused(by_name(Some("side")), "no camera is called `side`; it has front, plan");
}

#[test]
fn lights_keep_their_units_and_replace_the_default_ones() {
    let lights = json!({ "lights": [
        { "name": "bulb", "type": "point", "intensity": 40, "color": [1, 0.5, 0] },
        { "type": "directional", "intensity": 3 },
        { "type": "spot", "intensity": 7, "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.3 } }
    ] });
    let light = |i: usize| json!({ "KHR_lights_punctual": { "light": i } });
    let nodes = json!([
        { "mesh": 0, "children": [1, 2, 3] },
        { "extensions": light(0), "translation": [0, 0, 2] },
        { "extensions": light(1) },
        { "extensions": light(2), "translation": [0, 4, 0] }
    ]);
    let loaded = loaded(&square().with("nodes", nodes).with("extensions", json!({ "KHR_lights_punctual": lights })));
    let [bulb, sun, spot] = loaded.scene.lights.as_slice() else { panic!("{:?}", loaded.scene.lights) };
    assert_eq!((bulb.name.as_str(), bulb.intensity), ("bulb", Rgb::new(40.0, 20.0, 0.0)));
    assert_eq!(bulb.kind, LightKind::Point { position: Vec3::new(0.0, 0.0, 2.0) });
    assert!(loaded.scene.lights.iter().all(|l| l.falloff == Falloff::InverseSquare && l.shadows));
    assert_eq!((sun.kind, sun.intensity), (LightKind::Directional { direction: -Vec3::Z }, Rgb::splat(3.0)));
    let LightKind::Spot { direction, cos_inner, cos_outer, .. } = spot.kind else { panic!("{spot:?}") };
    assert_eq!(direction, -Vec3::Z);
    assert!((cos_inner - 0.1_f32.cos()).abs() < 1e-6 && (cos_outer - 0.3_f32.cos()).abs() < 1e-6);
}

#[test]
fn the_scene_file_of_a_model_keeps_its_spot_light_and_its_parallel_camera() {
    let lights = json!({ "lights": [
        { "type": "spot", "intensity": 7, "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.3 } }
    ] });
    let nodes = json!([
        { "mesh": 0, "children": [1, 2] },
        { "extensions": { "KHR_lights_punctual": { "light": 0 } }, "translation": [0, 4, 0] },
        { "camera": 0, "translation": [0, 0, 7] }
    ]);
    let cameras = json!([{ "type": "orthographic", "orthographic": { "xmag": 2, "ymag": 3, "znear": 0, "zfar": 9 } }]);
    let model = square().with("nodes", nodes).with("cameras", cameras);
    let model = model.with("extensions", json!({ "KHR_lights_punctual": lights }));
    let folder = Folder::new().with("a.gltf", model.text());
    let own = folder.load("a.gltf").unwrap().scene;
    let (text, _) = load::sketch(&folder.path("a.gltf"), &folder.path(""), &LoadOptions::default()).unwrap();
    let written = folder.with("a.toml", &text).load("a.toml").unwrap().scene;
    assert_eq!((&written.camera, &written.lights[0].kind), (&own.camera, &own.lights[0].kind), "{text}");
    assert_eq!((written.lights.len(), written.lights[0].intensity), (1, own.lights[0].intensity));
}

#[test]
fn alpha_holds_for_unlit_surfaces_and_costs_others_their_reflection_with_a_warning() {
    let of = |extensions: Value| {
        of_material(json!({
            "alphaMode": "BLEND",
            "pbrMetallicRoughness": { "baseColorFactor": [0.25, 0.5, 1, 0.5], "metallicFactor": 1, "roughnessFactor": 0 },
            "extensions": extensions
        }))
    };
    let half = Interface::Alpha { opacity: 0.5, mask: None };
    let unlit = of(json!({ "KHR_materials_unlit": {} }));
    assert_eq!(only_material(&unlit).interface, half);
    assert_eq!(only_material(&unlit).emission, Rgb::new(0.25, 0.5, 1.0));
    let metal = of(json!({}));
    assert_eq!(only_material(&metal).interface, half);
    warns(&metal, "the reflection of a material with alpha is left out");
}

#[test]
fn transmission_with_a_thickness_is_a_solid_that_absorbs_and_without_one_a_pane() {
    let material = |volume: Value| {
        json!({
            "name": "glass",
            "pbrMetallicRoughness": { "baseColorFactor": [1, 0.5, 0.25, 1], "metallicFactor": 0, "roughnessFactor": 0 },
            "extensions": {
                "KHR_materials_transmission": { "transmissionFactor": 1 },
                "KHR_materials_ior": { "ior": 1.75 },
                "KHR_materials_dispersion": { "dispersion": 0.5 },
                "KHR_materials_volume": volume
            }
        })
    };
    let tinted = Rgb::new(1.0, 0.5, 0.25);
    let solid = json!({ "thicknessFactor": 0.1, "attenuationDistance": 2, "attenuationColor": [0.5, 0.25, 1] });
    let loaded = of_material(material(solid));
    let Interface::Dielectric { medium, tint, .. } = only_material(&loaded).interface else { panic!() };
    let medium = &loaded.scene.media[medium as usize];
    assert_eq!((tint, medium.ior), (tinted, 1.75));
    // Half of the red is left after a distance of 2: a transmittance of exp(-2 s) = 1/2.
    let want = Rgb::new(2_f32.ln() / 2.0, 4_f32.ln() / 2.0, 0.0);
    assert!((medium.absorption - want).abs().max_element() < 1e-6, "{}", medium.absorption);
    // An Abbe number of 20 / 0.5.
    let index = |nm| medium.dispersion.index_at(nm).unwrap();
    let abbe = (index(587.5618) - 1.0) / (index(486.1327) - index(656.2725));
    assert!((abbe - 40.0).abs() < 1e-2, "{abbe}");

    for volume in [json!({}), json!({ "thicknessFactor": 0, "attenuationDistance": 1 })] {
        let loaded = of_material(material(volume));
        let Interface::ThinDielectric { ior, tint, .. } = only_material(&loaded).interface else { panic!() };
        assert_eq!((ior, tint), (1.75, tinted));
    }
}

#[test]
fn a_model_that_a_scene_enlarges_absorbs_as_much_light_as_before() {
    let glass = json!({ "extensions": {
        "KHR_materials_transmission": { "transmissionFactor": 1 },
        "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 1, "attenuationColor": [0.5, 0.5, 0.5] }
    }, "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0 } });
    let scene = "[[mesh]]\nfile = \"a.gltf\"\ntransform = { scale = 10 }\n";
    let folder = Folder::new().with("a.gltf", square().with("materials", json!([glass])).text()).with("a.toml", scene);
    let loaded = folder.load("a.toml").unwrap();
    assert!((loaded.scene.media[1].absorption.x - 2_f32.ln() / 10.0).abs() < 1e-6);
    assert_eq!(loaded.scene.media[1].dispersion, Dispersion::None);
}

#[test]
fn metals_are_mirrors_and_smooth_plastics_have_a_coat_of_their_index() {
    let of = |metallic: f64, roughness: f64| {
        let colour = [0.8, 0.6, 0.2, 1.0];
        of_material(json!({ "pbrMetallicRoughness": {
            "baseColorFactor": colour, "metallicFactor": metallic, "roughnessFactor": roughness
        } }))
    };
    let colour = Rgb::new(0.8, 0.6, 0.2);
    let gold = of(1.0, 0.0);
    let Interface::Mirror { reflectance, .. } = only_material(&gold).interface else { panic!() };
    assert!((reflectance - colour).abs().max_element() < 1e-6);
    assert_eq!(only_material(&gold).diffuse, Colour::Constant(Rgb::ZERO));
    let plastic = of(0.0, 0.0);
    let Interface::Coated { ior } = only_material(&plastic).interface else { panic!() };
    assert!((ior - 1.5).abs() < 1e-5, "{ior}");
    assert!(warnings(&plastic).is_empty());
    let chalk = of(0.0, 1.0);
    assert_eq!(only_material(&chalk).interface, Interface::Opaque);
    assert_eq!(only_material(&chalk).diffuse, Colour::Constant(colour));
    warns(&chalk, "rough surfaces are drawn as smooth ones");
}

#[test]
fn emission_has_its_strength_and_an_unlit_surface_only_its_colour() {
    let lamp = of_material(json!({ "emissiveFactor": [1, 0.5, 0], "extensions": {
        "KHR_materials_emissive_strength": { "emissiveStrength": 8 } } }));
    assert_eq!(only_material(&lamp).emission, Rgb::new(8.0, 4.0, 0.0));
    let unlit = of_material(json!({
        "pbrMetallicRoughness": { "baseColorFactor": [0.25, 0.5, 1, 1] },
        "extensions": { "KHR_materials_unlit": {} }
    }));
    assert_eq!(only_material(&unlit).emission, Rgb::new(0.25, 0.5, 1.0));
    assert_eq!(only_material(&unlit).diffuse, Colour::Constant(Rgb::ZERO));
}

#[test]
fn a_required_extension_that_is_not_read_is_an_error_with_its_cure_and_an_optional_one_a_warning() {
    for (name, cure) in [
        ("KHR_draco_mesh_compression", "without compression"),
        ("EXT_meshopt_compression", "without compression"),
        ("KHR_texture_basisu", "PNG or JPEG"),
        ("ACME_unheard_of", "without it"),
    ] {
        let required = square().with("extensionsRequired", json!([name])).with("extensionsUsed", json!([name]));
        let text = load_as("a.gltf", required.text()).unwrap_err().to_string();
        assert!(text.contains(name) && text.contains(cure), "{text}");
        let used = loaded(&square().with("extensionsUsed", json!([name])));
        warns(&used, &format!("the extension `{name}` is left out"));
    }
}

#[test]
fn one_faulty_primitive_is_left_out_and_the_others_are_drawn() {
    let faults = [
        (json!({ "attributes": { "POSITION": 99 } }), "there is no accessor 99"),
        (json!({ "attributes": {} }), "no positions"),
        (json!({ "attributes": { "POSITION": 0 }, "mode": 1 }), "points and lines"),
        (json!({ "attributes": { "POSITION": 4 } }), "reaches beyond"),
        (json!({ "attributes": { "POSITION": 5 } }), "announces 4000000000 elements"),
        (json!({ "attributes": { "POSITION": 6 } }), "stride of 4 bytes"),
    ];
    for (primitive, why) in faults {
        let mut model = square();
        model.accessor(json!({ "bufferView": 0, "componentType": F32, "type": "VEC3", "count": 5 }));
        model.accessor(json!({ "componentType": F32, "type": "VEC3", "count": 4_000_000_000_u32 }));
        let view = model.view(&[0; 64], Some(4));
        model.accessor(json!({ "bufferView": view, "componentType": F32, "type": "VEC3", "count": 3 }));
        model.fields["meshes"][0]["primitives"].as_array_mut().unwrap().push(primitive.clone());
        let loaded = loaded(&model);
        assert_eq!(loaded.scene.objects.len(), 1, "{primitive}");
        warns(&loaded, why);
        model.fields["meshes"][0]["primitives"] = json!([primitive]);
        refused(load_as("a.gltf", model.text()), "has no triangles");
    }
}

#[test]
fn nodes_within_themselves_end() {
    let nodes = json!([{ "mesh": 0, "children": [1, 1] }, { "children": [0] }]);
    let loaded = loaded(&square().with("nodes", nodes));
    assert_eq!(loaded.scene.objects.len(), 1);
    warns(&loaded, "two parents");
}

#[test]
fn what_is_no_gltf_is_refused_in_one_line() {
    refused(load_as("a.gltf", "{\"asset\":{\"version\":\"2.0\"},\n\"meshes\": 3}"), "line 2");
    refused(load_as("a.glb", "glTF"), "ends in its header");
    refused(load_as("a.gltf", "{\"asset\":{\"version\":\"2.0\"}}"), "no mesh in it");
}

#[test]
fn an_obj_and_a_gltf_of_the_same_model_give_the_same_scene() {
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nusemtl paper\n\
               f 1//1 2//1 3//1\nf 1//1 3//1 4//1\n";
    let folder = Folder::new().with("a.obj", obj).with("a.mtl", "newmtl paper\nKd 0.8 0.6 0.2\nillum 1\n");
    let obj = folder.load("a.obj").unwrap().scene;
    let gltf = of_material(json!({ "name": "paper", "pbrMetallicRoughness": {
        "baseColorFactor": [0.8, 0.6, 0.2, 1], "metallicFactor": 0, "roughnessFactor": 1
    }, "extensions": { "KHR_materials_specular": { "specularFactor": 0 } } }));
    let options = vitrum::render::Options::default();
    let pictures = [obj, gltf.scene].map(|mut scene| {
        (scene.settings.width, scene.settings.height) = (24, 18);
        crate::support::scenes::native(&scene, &options).film.pixels
    });
    assert_eq!(pictures[0], pictures[1]);
}
