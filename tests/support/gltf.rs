//! Builder of small glTF models.

#![allow(dead_code, reason = "each test binary needs a part of it")]

use base64::Engine;
use serde_json::{Value, json};

/// Model under construction: one buffer, and the fields of the text.
pub struct Model {
    pub buffer: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    /// Fields beside buffers and accessors.
    pub fields: Value,
}

pub const U8: u32 = 5121;
pub const U16: u32 = 5123;
pub const U32: u32 = 5125;
pub const F32: u32 = 5126;

impl Model {
    /// From the fields of the text: nodes, meshes, materials and so on.
    pub fn new() -> Self {
        let fields = json!({ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }] });
        Self { buffer: Vec::new(), views: Vec::new(), accessors: Vec::new(), fields }
    }

    /// With a field set.
    pub fn with(mut self, name: &str, value: Value) -> Self {
        self.fields[name] = value;
        self
    }

    /// Adds bytes as a view and returns its index.
    pub fn view(&mut self, bytes: &[u8], stride: Option<usize>) -> usize {
        while !self.buffer.len().is_multiple_of(4) {
            self.buffer.push(0);
        }
        let mut view = json!({ "buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len() });
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        self.buffer.extend(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    /// Adds an accessor by its fields and returns its index.
    pub fn accessor(&mut self, fields: Value) -> usize {
        self.accessors.push(fields);
        self.accessors.len() - 1
    }

    /// Adds numbers of 32 bits as an accessor of `kind`, of `width` numbers each, and returns its index.
    pub fn floats(&mut self, kind: &str, width: usize, numbers: &[f32]) -> usize {
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        let view = self.view(&bytes, None);
        let count = numbers.len() / width;
        self.accessor(json!({ "bufferView": view, "componentType": F32, "type": kind, "count": count }))
    }

    /// Adds indices of 16 bits and returns their accessor.
    pub fn indices(&mut self, indices: &[u16]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let view = self.view(&bytes, None);
        self.accessor(json!({ "bufferView": view, "componentType": U16, "type": "SCALAR", "count": indices.len() }))
    }

    fn fields(&self, uri: Option<String>) -> Value {
        let mut fields = self.fields.clone();
        let mut buffer = json!({ "byteLength": self.buffer.len() });
        if let Some(uri) = uri {
            buffer["uri"] = uri.into();
        }
        fields["buffers"] = json!([buffer]);
        fields["bufferViews"] = self.views.clone().into();
        fields["accessors"] = self.accessors.clone().into();
        fields
    }

    /// The text, with the buffer within it.
    pub fn text(&self) -> String {
        let data = base64::engine::general_purpose::STANDARD.encode(&self.buffer);
        self.fields(Some(format!("data:application/octet-stream;base64,{data}"))).to_string()
    }

    /// The binary file.
    pub fn binary(&self) -> Vec<u8> {
        let chunk = |kind: &[u8; 4], bytes: &[u8], fill: u8| {
            let length = bytes.len().next_multiple_of(4);
            let mut chunk = (length as u32).to_le_bytes().to_vec();
            chunk.extend(kind);
            chunk.extend(bytes);
            chunk.resize(8 + length, fill);
            chunk
        };
        let chunks =
            [chunk(b"JSON", self.fields(None).to_string().as_bytes(), b' '), chunk(b"BIN\0", &self.buffer, 0)].concat();
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend((12 + chunks.len() as u32).to_le_bytes());
        file.extend(chunks);
        file
    }
}

/// A square of two triangles in the plane z = 0, facing +z, from (0, 0) to (1, 1), with normals and texture coordinates.
pub fn square() -> Model {
    let mut model = Model::new();
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let positions = corners.map(|[x, y]| [x, y, 0.0]);
    let at = model.floats("VEC3", 3, positions.as_flattened());
    let normals = model.floats("VEC3", 3, [[0.0, 0.0, 1.0]; 4].as_flattened());
    let places = model.floats("VEC2", 2, corners.map(|[x, y]| [x, 1.0 - y]).as_flattened());
    let indices = model.indices(&[0, 1, 2, 0, 2, 3]);
    let attributes = json!({ "POSITION": at, "NORMAL": normals, "TEXCOORD_0": places });
    let primitive = json!({ "attributes": attributes, "indices": indices, "material": 0 });
    model
        .with("meshes", json!([{ "name": "square", "primitives": [primitive] }]))
        .with("nodes", json!([{ "mesh": 0 }]))
        .with("materials", json!([{ "name": "paper", "pbrMetallicRoughness": { "metallicFactor": 0 } }]))
}

/// A model with most of what is read.
pub fn rich() -> Model {
    let mut model = square();
    let moves = model.floats("VEC3", 3, &[0.0, 0.0, 1.0, 0.0, 0.0, 2.0]);
    let turns = model.floats("VEC4", 4, &[0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0]);
    let strip = model.accessor(json!({ "bufferView": 3, "componentType": U16, "type": "SCALAR", "count": 4 }));
    let changed = model.view(&[2, 0], None);
    let values = model.view(&1.5_f32.to_le_bytes().repeat(6), None);
    let sparse = json!({
        "count": 2,
        "indices": { "bufferView": changed, "componentType": U8 },
        "values": { "bufferView": values }
    });
    let bent =
        model.accessor(json!({ "bufferView": 0, "componentType": F32, "type": "VEC3", "count": 4, "sparse": sparse }));
    let bytes: Vec<u8> = (0..64).collect();
    let packed = model.view(&bytes, Some(12));
    let small = model.accessor(json!({
        "bufferView": packed, "componentType": U16, "type": "VEC3", "count": 4, "normalized": true
    }));
    let colours = model.accessor(json!({
        "bufferView": packed, "byteOffset": 6, "componentType": U8, "type": "VEC4", "count": 4, "normalized": true
    }));
    let joints = model.accessor(json!({ "bufferView": changed, "componentType": U8, "type": "VEC4", "count": 0 }));
    let png = [
        0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n', 0, 0, 0, 13, b'I', b'H', b'D', b'R', 0, 0, 0, 1, 0, 0, 0, 1,
        8, 2, 0, 0, 0, 0x90, 0x77, 0x53, 0xde, 0, 0, 0, 12, b'I', b'D', b'A', b'T', 8, 0xd7, 0x63, 0xf8, 0xcf, 0xc0, 0,
        0, 3, 1, 1, 0, 0x18, 0xdd, 0x8d, 0xb0, 0, 0, 0, 0, b'I', b'E', b'N', b'D', 0xae, 0x42, 0x60, 0x82,
    ];
    let picture = model.view(&png, None);
    let moved = json!({ "KHR_texture_transform": { "offset": [0.1, 0.2], "rotation": 0.3, "scale": [2, 3] } });
    let texture = json!({ "index": 0, "texCoord": 0, "extensions": moved });
    let glass = json!({
        "name": "glass",
        "alphaMode": "MASK",
        "pbrMetallicRoughness": { "baseColorTexture": texture, "roughnessFactor": 0 },
        "normalTexture": { "index": 0 },
        "extensions": {
            "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 0.1] },
            "KHR_materials_ior": { "ior": 1.7 },
            "KHR_materials_dispersion": { "dispersion": 0.4 }
        }
    });
    let coated = json!({
        "alphaMode": "BLEND",
        "emissiveFactor": [1, 0.5, 0],
        "emissiveTexture": { "index": 0 },
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.4, 0.3, 0.9], "roughnessFactor": 0.2, "metallicFactor": 0.5,
            "metallicRoughnessTexture": { "index": 0 }
        },
        "extensions": {
            "KHR_materials_clearcoat": { "clearcoatFactor": 1, "clearcoatTexture": { "index": 0 } },
            "KHR_materials_specular": { "specularFactor": 0.5, "specularColorFactor": [1, 0.5, 1] },
            "KHR_materials_emissive_strength": { "emissiveStrength": 3 },
            "KHR_materials_iridescence": { "iridescenceFactor": 1 }
        }
    });
    let morph = json!([{ "POSITION": 0, "NORMAL": 1 }]);
    let meshes = json!([
        { "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "indices": 3, "material": 0 }] },
        { "primitives": [
            { "attributes": { "POSITION": bent, "COLOR_0": colours }, "indices": strip, "mode": 5, "material": 1 },
            { "attributes": { "POSITION": small }, "mode": 6, "material": 2 },
            { "attributes": { "POSITION": 0, "JOINTS_0": joints, "WEIGHTS_0": turns }, "targets": morph }
        ], "weights": [0.5] }
    ]);
    let nodes = json!([
        { "name": "root", "children": [1, 2, 3], "rotation": [0, 0.6, 0, 0.8] },
        { "mesh": 0, "scale": [-1, 1, 1], "extensions": {
            "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": moves, "ROTATION": turns } }
        } },
        { "mesh": 1, "skin": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 3, 1] },
        { "name": "eye", "camera": 0, "translation": [0, 0, 5], "extensions": { "KHR_lights_punctual": { "light": 0 } } }
    ]);
    let lamps = json!({ "lights": [{ "type": "spot", "intensity": 40, "color": [1, 1, 0.5], "spot": { "outerConeAngle": 0.5 } }] });
    model
        .with("meshes", meshes)
        .with("nodes", nodes)
        .with("skins", json!([{ "joints": [0, 1] }]))
        .with("materials", json!([glass, coated, { "extensions": { "KHR_materials_unlit": {} } }]))
        .with("textures", json!([{ "source": 0, "sampler": 0 }]))
        .with("samplers", json!([{ "wrapS": 33071, "magFilter": 9728 }]))
        .with("images", json!([{ "bufferView": picture, "mimeType": "image/png" }]))
        .with("cameras", json!([{ "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.1 } }]))
        .with("extensions", json!({ "KHR_lights_punctual": lamps }))
        .with("extensionsUsed", json!(["KHR_lights_punctual", "ODD_extension"]))
}
