//! Extensions of glTF, as raw JSON: those that are read, those that change no picture, and the cures for those that a
//! file requires and that are not read.

use gltf_json::Root;
use serde_json::{Map, Value};

/// Extensions of an object by name.
pub(super) type Extensions = Map<String, Value>;

/// Extensions that are read.
const READ: [&str; 18] = [
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// Extensions that change nothing in a picture of the model at rest.
const WITHOUT_EFFECT: [&str; 7] = [
    "EXT_meshopt_compression_fallback",
    "KHR_animation_pointer",
    "KHR_materials_variants",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "KHR_node_selectability",
    "KHR_node_hoverability",
];

/// Returns the message for the first extension that a file requires and that is not read.
pub(super) fn unsupported(root: &Root) -> Option<String> {
    let known = |name: &str| READ.contains(&name) || WITHOUT_EFFECT.contains(&name);
    let name = root.extensions_required.iter().find(|name| !known(name))?;
    let cure = match name.as_str() {
        "KHR_draco_mesh_compression" | "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
            "save the model without compression, for example by `gltf-transform copy IN OUT`"
        }
        "KHR_texture_basisu" => {
            "save its pictures as PNG or JPEG, for example by `gltf-transform ktxdecompress IN OUT`"
        }
        "EXT_texture_avif" | "MSFT_texture_dds" => "save its pictures as PNG or JPEG",
        "KHR_materials_pbrSpecularGlossiness" => {
            "convert its materials, for example by `gltf-transform metalrough IN OUT`"
        }
        _ => "save the model without it",
    };
    let name: String = name.chars().take(80).collect();
    Some(format!("requires the extension `{name}`, which is not read; {cure}"))
}

/// Returns the extensions that the file uses without requiring them, and that are left out.
pub(super) fn left_out(root: &Root) -> impl Iterator<Item = &str> {
    let names = root.extensions_used.iter().map(String::as_str);
    names.filter(|name| !READ.contains(name) && !WITHOUT_EFFECT.contains(name))
}

/// Fields of a JSON object. Those that are missing or of another type have the default.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fields<'a>(Option<&'a Value>);

impl<'a> From<&'a Value> for Fields<'a> {
    fn from(value: &'a Value) -> Self {
        Self(Some(value))
    }
}

impl<'a> Fields<'a> {
    /// Returns the fields of an extension; `None` if the object lacks it.
    pub(super) fn of(extensions: Option<&'a Extensions>, name: &str) -> Option<Self> {
        extensions.and_then(|all| all.get(name)).map(|value| Self(Some(value)))
    }

    /// Returns the fields of an object within.
    pub(super) fn object(self, name: &str) -> Self {
        Self(self.get(name))
    }

    /// Returns the value of a field.
    pub(super) fn get(self, name: &str) -> Option<&'a Value> {
        self.0.and_then(|value| value.get(name))
    }

    /// Returns a finite number.
    pub(super) fn number(self, name: &str, default: f64) -> f64 {
        self.get(name).and_then(Value::as_f64).filter(|x| x.is_finite()).unwrap_or(default)
    }

    /// Returns `N` finite numbers.
    pub(super) fn numbers<const N: usize>(self, name: &str, default: [f64; N]) -> [f64; N] {
        let list = self.get(name).and_then(Value::as_array);
        let numbers: Option<Vec<f64>> = list.and_then(|l| l.iter().map(Value::as_f64).collect());
        numbers
            .and_then(|n| n.try_into().ok())
            .filter(|n: &[f64; N]| n.iter().all(|x| x.is_finite()))
            .unwrap_or(default)
    }

    /// Returns an index.
    pub(super) fn index(self, name: &str) -> Option<usize> {
        self.get(name).and_then(Value::as_u64).and_then(|i| usize::try_from(i).ok())
    }

    pub(super) fn text(self, name: &str) -> Option<&'a str> {
        self.get(name).and_then(Value::as_str)
    }
}
