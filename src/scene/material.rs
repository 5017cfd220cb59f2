//! Surfaces, and what fills space between them.
//!
//! What leaves a surface towards the viewer, for a ray that arrives with weight `w` (per channel):
//!
//! * the *base*, `emission + ambient * scene ambient + sum over lights (diffuse + highlight)`, times `w` and the
//!   interface's base share;
//! * the secondary rays of the [`Interface`], each with `w` times its share.
//!
//! `R` is the Fresnel reflectance of the ray's own angle (under `--fresnel off`, of normal incidence), from the
//! medium the ray is in to the one behind the surface.
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
//! Radiance inside a medium of index `n` is larger by `n^2` than outside. Whitted's weights leave that factor out,
//! as every renderer of this kind does: it cancels for a ray that leaves the medium again, and a camera inside a
//! medium sees basic radiance `L / n^2`.

use glam::Vec3;

use super::{Dispersion, Rgb};

/// A surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name scene files and messages use.
    pub name: String,
    /// Factor on the scene's ambient colour.
    pub ambient: Rgb,
    /// Lambert albedo, 0..=1.
    pub diffuse: Colour,
    /// Bright spot around the mirror direction of each light.
    pub highlight: Option<Highlight>,
    /// Radiance it sends by itself; seen, but no light source.
    pub emission: Rgb,
    /// What it does with the ray that arrives.
    pub interface: Interface,
}

impl Default for Material {
    /// A mid-grey Lambert surface.
    fn default() -> Self {
        Self {
            name: String::from("default"),
            ambient: Rgb::ZERO,
            diffuse: Colour::Constant(Rgb::splat(0.5)),
            highlight: None,
            emission: Rgb::ZERO,
            interface: Interface::Opaque,
        }
    }
}

impl Material {
    /// A surface that sends nothing at all, to be given an interface or an emission.
    #[must_use]
    pub fn black(name: &str) -> Self {
        Self { name: name.into(), diffuse: Colour::Constant(Rgb::ZERO), ..Self::default() }
    }

    /// Returns true if light makes a difference to its base.
    #[must_use]
    pub fn answers_light(&self) -> bool {
        self.diffuse != Colour::Constant(Rgb::ZERO) || self.highlight.is_some()
    }

    /// Whether light passes through it: what shadow rays are marched over.
    #[must_use]
    pub fn is_transmissive(&self) -> bool {
        match self.interface {
            Interface::Dielectric { .. } | Interface::ThinDielectric { .. } => true,
            Interface::Alpha { opacity } => opacity < 1.0,
            Interface::Opaque | Interface::Mirror { .. } | Interface::Conductor { .. } | Interface::Coated { .. } => {
                false
            }
        }
    }
}

/// A colour that may vary over a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Colour {
    /// The same everywhere.
    Constant(Rgb),
    /// A picture, looked up bilinearly at the surface's texture coordinates, repeated; times `scale`. A mesh brings its
    /// own coordinates; a sphere's are those of its normal in an equirectangular picture
    /// ([`super::Environment::LatLong`]); planes, and meshes that bring none, are at (0, 0) everywhere.
    Image {
        /// Place in `Scene::textures`.
        texture: u32,
        /// Factor on the picture.
        scale: Rgb,
    },
    /// Cubes of two colours, by world position: `even` where the sum of `floor((p - offset) / size)` over the three
    /// axes is even. A surface that lies exactly on a cube face wants an offset of half a cube along its normal.
    Checker {
        /// Colour of even cubes.
        even: Rgb,
        /// Colour of odd cubes.
        odd: Rgb,
        /// Edge of a cube, in scene units, above zero.
        size: f32,
        /// A corner where eight cubes meet, in scene units.
        offset: Vec3,
    },
}

/// A bright spot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Highlight {
    /// Factor `ks`.
    pub colour: Rgb,
    /// How sharp it is, at least 0.
    pub exponent: f32,
    /// Which cosine is raised to the exponent.
    pub model: HighlightModel,
}

/// Which cosine a highlight raises to its exponent; none where the light is behind the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HighlightModel {
    /// Between the mirrored light direction and the viewer (Phong 1975).
    Phong,
    /// Between the normal and the half vector (Blinn 1977).
    BlinnPhong,
}

/// What a surface does with the ray that arrives; see the table at the head of this file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interface {
    /// Nothing more than its base.
    Opaque,
    /// Reflects a fixed share.
    Mirror {
        /// Share per channel.
        reflectance: Rgb,
        /// Where the reflected light is found.
        source: MirrorSource,
    },
    /// Reflects as a metal does.
    Conductor {
        /// Real part of the refractive index per channel.
        eta: Rgb,
        /// Imaginary part per channel (extinction), at least 0.
        k: Rgb,
    },
    /// The boundary of a transparent solid or liquid; its outside is where the geometric normal points.
    Dielectric {
        /// What is inside, a place in `Scene::media`.
        medium: u32,
        /// How the split is decided.
        rule: FresnelRule,
        /// Factor on refracted light.
        tint: Rgb,
    },
    /// A pane or film too thin to bend light: both faces at once, all inner reflections summed.
    ThinDielectric {
        /// Index of the pane.
        ior: f32,
        /// How the split is decided.
        rule: FresnelRule,
        /// Factor on light that passes.
        tint: Rgb,
    },
    /// A clear coat on the base: what it does not reflect reaches the base (the notes' opaque case, R + A = 1).
    Coated {
        /// Index of the coat.
        ior: f32,
    },
    /// The base covers a share; the rest is a hole.
    Alpha {
        /// Share covered, 0..=1.
        opacity: f32,
    },
}

impl Interface {
    /// The untinted boundary of the medium at index `medium`, by the Fresnel equations.
    #[must_use]
    pub fn dielectric(medium: u32) -> Self {
        Self::Dielectric { medium, rule: FresnelRule::Fresnel, tint: Rgb::ONE }
    }
}

/// Where a mirror finds what it reflects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MirrorSource {
    /// A reflected ray is traced.
    Traced,
    /// The environment is looked up in the mirror direction, whatever stands between (MTL `illum` 8).
    Environment,
}

/// How a transparent surface divides light between reflection and transmission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FresnelRule {
    /// By the Fresnel equations.
    Fresnel,
    /// By a fixed share per channel (MTL `illum` 6); total internal reflection still reflects everything.
    Fixed(Rgb),
}

/// What fills space.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// The name scene files and messages use.
    pub name: String,
    /// Refractive index, above zero; where the medium disperses, that at the line d (587.6 nm), which white light goes
    /// by. Kept in `f64`: index ratios near 1 live in its low digits.
    pub ior: f64,
    /// How the index depends on the wavelength: above zero over the whole visible range, and falling or constant.
    pub dispersion: Dispersion,
    /// Absorption coefficient per channel and scene unit, at least 0 (Beer-Lambert: `exp(-absorption * distance)`).
    pub absorption: Rgb,
    /// Where media overlap, the one with the highest priority fills the space (Schmidt & Budge 2002); among equals
    /// [`super::Bodies`] decides.
    pub priority: i32,
}

impl Medium {
    /// A clear medium of index `ior` (at 587.6 nm), without dispersion and absorption.
    #[must_use]
    pub fn new(name: &str, ior: f64) -> Self {
        Self { name: name.into(), ior, dispersion: Dispersion::None, absorption: Rgb::ZERO, priority: 0 }
    }

    /// Returns true if light cannot tell the two apart: equal index, dispersion and absorption, whatever their names.
    #[must_use]
    pub fn is_like(&self, other: &Self) -> bool {
        self.ior == other.ior && self.dispersion == other.dispersion && self.absorption == other.absorption
    }

    /// What surrounds everything unless a scene says otherwise.
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
