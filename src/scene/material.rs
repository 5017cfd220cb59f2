//! Materials of surfaces, and media.
//!
//! A ray that arrives at a surface with weight `w` (per channel) yields:
//!
//! - the *base* times `w` and the interface's base share, where the base is
//!   `emission + ambient * scene ambient + sum over lights (diffuse + highlight)`;
//! - the secondary rays of the [`Interface`], each with `w` times its share.
//!
//! `R` is the Fresnel reflectance at the angle of incidence (at normal incidence under `--fresnel off`), from the ray's
//! medium to the one behind the surface.
//!
//! | interface | base share | reflected share | straight or refracted share |
//! |---|---|---|---|
//! | opaque | 1 | 0 | 0 |
//! | mirror | 1 | `reflectance` | 0 |
//! | conductor | 1 | `R` per channel | 0 |
//! | dielectric | 1 | `R` (or the fixed share) | `(1 - R) * tint` refracted |
//! | thin dielectric | 1 | `R' = 2R / (1 + R)` | `(1 - R') * tint` straight on |
//! | coated | `1 - R` | `R` | 0 |
//! | alpha | `opacity` | 0 | `1 - opacity` straight on |
//!
//! Radiance inside a medium of index `n` is larger by `n^2` than outside. Whitted's weights leave that factor out, as
//! every renderer of this kind does. It cancels for a ray that leaves the medium again. A camera inside a medium sees
//! the basic radiance `L / n^2`.

use glam::Vec3;

use super::Rgb;
use super::dispersion::Dispersion;

/// Material of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name used in scene files and messages.
    pub name: String,
    /// Factor on the scene's ambient colour.
    pub ambient: Rgb,
    /// Lambertian albedo, 0..=1.
    pub diffuse: Colour,
    /// Highlight of each light around its mirror direction.
    pub highlight: Option<Highlight>,
    /// Emitted radiance. It lights other surfaces where the setting [`super::LightsFrom`] says so.
    pub emission: Rgb,
    /// Emission that varies over the surface; `emission` is then its mean.
    pub glow: Option<Colour>,
    /// Picture of normals, for meshes with texture coordinates.
    pub relief: Option<Relief>,
    /// Interaction with the arriving ray.
    pub interface: Interface,
}

impl Default for Material {
    /// Returns a mid-grey Lambertian surface.
    fn default() -> Self {
        Self {
            name: String::from("default"),
            ambient: Rgb::ZERO,
            diffuse: Colour::Constant(Rgb::splat(0.5)),
            highlight: None,
            emission: Rgb::ZERO,
            glow: None,
            relief: None,
            interface: Interface::Opaque,
        }
    }
}

impl Material {
    /// Returns a material that reflects and emits nothing, to be given an interface or an emission.
    #[must_use]
    pub fn black(name: &str) -> Self {
        Self { name: name.into(), diffuse: Colour::Constant(Rgb::ZERO), ..Self::default() }
    }

    /// Returns true if the base reflects light of lamps.
    #[must_use]
    pub fn answers_light(&self) -> bool {
        self.diffuse != Colour::Constant(Rgb::ZERO) || self.highlight.is_some()
    }

    /// Returns true if the surface reflects its surroundings.
    #[must_use]
    pub fn reflects(&self) -> bool {
        match self.interface {
            Interface::Mirror { source, .. } => source == MirrorSource::Traced,
            Interface::Conductor { .. }
            | Interface::Dielectric { .. }
            | Interface::ThinDielectric { .. }
            | Interface::Coated { .. } => true,
            Interface::Opaque | Interface::Alpha { .. } => false,
        }
    }

    /// Returns true if light passes through the surface; shadow rays march through it.
    #[must_use]
    pub fn is_transmissive(&self) -> bool {
        match self.interface {
            Interface::Dielectric { .. } | Interface::ThinDielectric { .. } => true,
            Interface::Alpha { opacity, mask } => opacity < 1.0 || mask.is_some(),
            Interface::Opaque | Interface::Mirror { .. } | Interface::Conductor { .. } | Interface::Coated { .. } => {
                false
            }
        }
    }
}

/// Colour that may vary over a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Colour {
    /// One colour everywhere.
    Constant(Rgb),
    /// Picture, looked up bilinearly at the surface's texture coordinates, repeated, and multiplied by `scale`. A mesh
    /// has its own coordinates. Those of a sphere are its normal's in an equirectangular picture
    /// ([`super::Environment::LatLong`]). Planes, and meshes without coordinates, are at (0, 0) everywhere.
    Image {
        /// Index into `Scene::textures`.
        texture: u32,
        /// Factor on the picture's colours.
        scale: Rgb,
    },
    /// Colours at the corners of a mesh, interpolated and multiplied by `scale`; white on other shapes.
    Corners {
        /// Picture that multiplies the colours, as an index into `Scene::textures`.
        texture: Option<u32>,
        /// Factor on the colours.
        scale: Rgb,
    },
    /// Cubes of two colours by position: `even` where the sum of `floor((p - offset) / size)` over the three axes is
    /// even. A surface that lies exactly on a cube face needs an offset of half a cube along its normal.
    Checker {
        /// Colour of even cubes.
        even: Rgb,
        /// Colour of odd cubes.
        odd: Rgb,
        /// Edge of a cube, in scene units, above zero.
        size: f32,
        /// Corner where eight cubes meet, in scene units.
        offset: Vec3,
    },
}

/// Normals in a picture, which replace the normals that shade a mesh. A channel `c` stands for `2 c - 1`: red along the
/// direction in which `u` grows on the surface, green along that of `v`, blue along the normal of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relief {
    /// Index into `Scene::textures`, looked up as by [`Colour::Image`].
    pub texture: u32,
    /// Factor on red and green.
    pub strength: f32,
}

/// Highlight of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Highlight {
    /// Factor `ks`.
    pub colour: Rgb,
    /// Sharpness, at least 0.
    pub exponent: f32,
    /// Cosine that is raised to the exponent.
    pub model: HighlightModel,
}

/// Cosine that a highlight raises to its exponent. There is no highlight if the light is behind the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HighlightModel {
    /// Between the mirrored light direction and the viewer (Phong 1975).
    Phong,
    /// Between the normal and the half vector (Blinn 1977).
    BlinnPhong,
}

/// Interaction of a surface with the arriving ray; see the table at the head of this file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interface {
    /// No interaction beyond the base.
    Opaque,
    /// Reflects a fixed share.
    Mirror {
        /// Share per channel.
        reflectance: Rgb,
        /// Origin of the reflected light.
        source: MirrorSource,
    },
    /// Reflects like a metal.
    Conductor {
        /// Real part of the refractive index per channel.
        eta: Rgb,
        /// Imaginary part per channel (extinction), at least 0.
        k: Rgb,
    },
    /// Boundary of a transparent solid or liquid; its outside is where the geometric normal points.
    Dielectric {
        /// Medium inside, as an index into `Scene::media`.
        medium: u32,
        /// Division between reflection and transmission.
        rule: FresnelRule,
        /// Factor on refracted light.
        tint: Rgb,
    },
    /// Pane or film too thin to bend light. Both faces count as one surface, with all inner reflections summed.
    ThinDielectric {
        /// Refractive index of the pane.
        ior: f32,
        /// Division between reflection and transmission.
        rule: FresnelRule,
        /// Factor on transmitted light.
        tint: Rgb,
    },
    /// Clear coat on the base. Light that it does not reflect reaches the base (the notes' opaque case, R + A = 1).
    Coated {
        /// Refractive index of the coat.
        ior: f32,
    },
    /// Base with holes.
    Alpha {
        /// Share covered, 0..=1.
        opacity: f32,
        /// Picture whose red channel, 0..=1, multiplies the share: an index into `Scene::textures`.
        mask: Option<u32>,
    },
}

impl Interface {
    /// The untinted boundary of the medium at index `medium`, by the Fresnel equations.
    #[must_use]
    pub fn dielectric(medium: u32) -> Self {
        Self::Dielectric { medium, rule: FresnelRule::Fresnel, tint: Rgb::ONE }
    }
}

/// Origin of the light that a mirror reflects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MirrorSource {
    /// A reflected ray is traced.
    Traced,
    /// The environment is looked up in the mirror direction, ignoring occluders (MTL `illum` 8).
    Environment,
}

/// Division of light at a transparent surface between reflection and transmission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FresnelRule {
    /// By the Fresnel equations.
    Fresnel,
    /// By a fixed share per channel (MTL `illum` 6); total internal reflection still reflects everything.
    Fixed(Rgb),
}

/// Medium that fills space.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// Name used in scene files and messages.
    pub name: String,
    /// Refractive index, above zero. For a dispersive medium it is the index at the line d (587.6 nm), which white
    /// light uses. Kept in `f64`, because index ratios near 1 depend on its low digits.
    pub ior: f64,
    /// Index as a function of wavelength: above zero over the whole visible range, and falling or constant.
    pub dispersion: Dispersion,
    /// Absorption coefficient per channel and scene unit, at least 0 (Beer-Lambert: `exp(-absorption * distance)`).
    pub absorption: Rgb,
    /// Priority: where media overlap, the one with the highest priority fills the space (Schmidt & Budge 2002). Among
    /// equal ones [`super::Bodies`] decides.
    pub priority: i32,
}

impl Medium {
    /// A clear medium of index `ior` (at 587.6 nm), without dispersion and absorption.
    #[must_use]
    pub fn new(name: &str, ior: f64) -> Self {
        Self { name: name.into(), ior, dispersion: Dispersion::None, absorption: Rgb::ZERO, priority: 0 }
    }

    /// Returns true if two media are optically equal: same index, dispersion and absorption, whatever their names.
    #[must_use]
    pub fn is_like(&self, other: &Self) -> bool {
        self.ior == other.ior && self.dispersion == other.dispersion && self.absorption == other.absorption
    }

    /// Returns air, which surrounds everything unless a scene says otherwise.
    #[must_use]
    pub fn air() -> Self {
        Self {
            name: String::from("air"),
            ior: 1.0,
            dispersion: Dispersion::None,
            absorption: Rgb::ZERO,
            priority: i32::MIN,
        }
    }
}
