//! Materials in one word, such as `glass:bk7`.

use std::fmt::Write;
use std::str::FromStr;

use super::assembly::Assembly;
use super::catalogue;
use super::colour::colour;
use crate::scene::ranges::INDICES;
use crate::scene::{Colour, Dispersion, FresnelRule, Interface, Material, Medium, MirrorSource, Rgb};

/// Material to replace one of a model.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface {
    /// Solid glass or a liquid: a name of the catalogue, or an index.
    Glass(Index),
    /// Pane that bends nothing.
    Thin(Index),
    /// Metal of the catalogue.
    Metal(&'static str),
    /// Mirror that reflects this share.
    Mirror(Rgb),
    /// Matt surface.
    Diffuse(Rgb),
    /// Surface that is seen by its own light.
    Emissive(Rgb),
}

/// Refractive index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Index {
    /// That of a glass or liquid of the catalogue.
    Named(&'static str, f64),
    /// A number.
    Number(f64),
}

impl Index {
    fn value(self) -> f64 {
        match self {
            Self::Named(_, ior) | Self::Number(ior) => ior,
        }
    }

    fn toml(self) -> String {
        match self {
            Self::Named(name, _) => format!("glass = \"{name}\""),
            Self::Number(ior) => format!("ior = {ior:?}"),
        }
    }
}

impl FromStr for Surface {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, value) = text.split_once(':').map_or((text, None), |(kind, value)| (kind, Some(value)));
        let need = |what: &str| value.ok_or_else(|| format!("`{kind}` needs {what} behind a colon"));
        let index = || -> Result<Index, String> {
            let value = need("a glass or an index, as `glass:bk7` or `glass:1.5`,")?;
            match value.parse::<f64>() {
                Ok(ior) if INDICES.contains(&ior) => Ok(Index::Number(ior)),
                Ok(ior) => Err(format!("the index {ior} is not between 0.001 and 1000")),
                Err(_) => catalogue::transparent(value).map(|t| Index::Named(t.names[0], t.ior)),
            }
        };
        let share = |text: &str| {
            colour(text).and_then(|c| match c.max_element() <= 1.0 {
                true => Ok(c),
                false => Err(format!("`{text}` reflects more light than arrives; a share is at most 1")),
            })
        };
        Ok(match kind {
            "glass" => Self::Glass(index()?),
            "thin" => Self::Thin(index()?),
            "metal" => Self::Metal(catalogue::metal(need("a metal, as `metal:gold`,")?).map(|m| m.names[0])?),
            "mirror" => Self::Mirror(value.map_or(Ok(Rgb::ONE), share)?),
            "diffuse" => Self::Diffuse(share(need("a colour, as `diffuse:#c02020`,")?)?),
            "emissive" => Self::Emissive(colour(need("a colour, as `emissive:1,1,1`,")?)?),
            _ => {
                return Err(format!(
                    "`{kind}` is no kind of material; take glass:NAME, thin:NAME, metal:NAME, mirror, diffuse:COLOUR or \
                     emissive:COLOUR"
                ));
            }
        })
    }
}

impl Surface {
    /// Returns the material called `name`; that of a glass adds its medium to the scene.
    pub(super) fn material(&self, name: &str, assembly: &mut Assembly<'_>) -> Material {
        let black = Material::black(name);
        match *self {
            Self::Glass(index) => {
                let (ior, dispersion) = (index.value(), Dispersion::None);
                let medium = Medium { dispersion, ..Medium::new(name, ior) };
                Material { interface: Interface::dielectric(assembly.add_medium(medium)), ..black }
            }
            Self::Thin(index) => {
                let (ior, rule) = (index.value() as f32, FresnelRule::Fresnel);
                Material { interface: Interface::ThinDielectric { ior, rule, tint: Rgb::ONE }, ..black }
            }
            Self::Metal(metal) => {
                let interface = catalogue::metal(metal).map(|m| Interface::Conductor { eta: m.eta, k: m.k });
                Material { interface: interface.unwrap_or(Interface::Opaque), ..black }
            }
            Self::Mirror(reflectance) => {
                Material { interface: Interface::Mirror { reflectance, source: MirrorSource::Traced }, ..black }
            }
            Self::Diffuse(colour) => Material { diffuse: Colour::Constant(colour), ..black },
            Self::Emissive(emission) => Material { emission, ..black },
        }
    }

    /// Returns the keys of a `[[material]]` that is the same, a line each.
    pub(super) fn toml(&self) -> String {
        let array = |c: Rgb| format!("[{:?}, {:?}, {:?}]", c.x, c.y, c.z);
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = match self {
            Self::Glass(index) => writeln!(text, "type = \"dielectric\"\n{}", index.toml()),
            Self::Thin(index) => writeln!(text, "type = \"thin\"\n{}", index.toml()),
            Self::Metal(metal) => writeln!(text, "type = \"conductor\"\nmetal = \"{metal}\""),
            Self::Mirror(share) => writeln!(text, "type = \"mirror\"\nreflectance = {}", array(*share)),
            Self::Diffuse(colour) => writeln!(text, "type = \"diffuse\"\ncolor = {}", array(*colour)),
            Self::Emissive(emission) => writeln!(text, "type = \"emissive\"\nemission = {}", array(*emission)),
        };
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_word_names_a_material() {
        assert_eq!("glass:bk7".parse(), Ok(Surface::Glass(Index::Named("bk7", 1.5168))));
        assert_eq!("thin:1.5".parse(), Ok(Surface::Thin(Index::Number(1.5))));
        assert_eq!("metal:Au".parse(), Ok(Surface::Metal("gold")));
        assert_eq!("mirror".parse(), Ok(Surface::Mirror(Rgb::ONE)));
        assert_eq!("diffuse:#ff0000".parse(), Ok(Surface::Diffuse(Rgb::X)));
        for (bad, part) in [
            ("glass", "glass:bk7"),
            ("glass:bk77", "bk7"),
            ("glass:0", "0.001"),
            ("metal:wood", "wood"),
            ("wood", "no kind"),
            ("diffuse:2,2,2", "at most 1"),
        ] {
            let error = bad.parse::<Surface>().unwrap_err();
            assert!(error.contains(part), "{bad}: {error}");
        }
    }
}
