//! A scene is checked before it is rendered, so that a wrong index is an error and not a panic in the renderer.

mod error;
mod shape;

pub use error::{Part, SceneEntry, SceneError};

use std::fmt::Display;

use glam::{DVec3, Vec3};

use super::camera::{Camera, Projection};
use super::environment::Environment;
use super::light::{Light, LightKind};
use super::material::{Colour, FresnelRule, Interface, Material, Medium};
use super::ranges::{
    EXPONENTS, INDICES, LEAST_SINE_OF_EDGES, LEAST_SINE_OF_UP, LIGHT_SAMPLES, MOST_DEPTH, MOST_EXTINCTION,
    MOST_WAVELENGTHS, SAMPLES,
};
use super::settings::{Pattern, Settings};
use super::texture::Texture;
use super::{Rgb, Scene};

impl Scene {
    /// Checks every index, list length and value.
    ///
    /// The renderers take a scene that passes without a panic. Scenes that `load` returns pass. It takes time in proportion
    /// to the sizes of meshes and textures.
    ///
    /// # Errors
    /// The first rule that is broken. [`Scene::errors`] returns all.
    pub fn validate(&self) -> Result<(), SceneError> {
        self.errors().into_iter().next().map_or(Ok(()), Err)
    }

    /// Every rule that the scene breaks, at most one for each field of an entry; empty for a valid scene.
    #[must_use]
    pub fn errors(&self) -> Vec<SceneError> {
        let mut all = Errors::default();
        if self.geometry.len() != self.objects.len() {
            all.0.push(SceneError::Unpaired { shapes: self.geometry.len(), objects: self.objects.len() });
        }
        if self.media.is_empty() {
            all.0.push(SceneError::NoMedium);
        }
        for (index, (object, geometry)) in self.objects.iter().zip(&self.geometry).enumerate() {
            let mut check = all.at(Part::Object, index, &object.name);
            check.index("material", object.material, self.materials.len());
            if self.materials.get(object.material as usize).is_some_and(|m| m.mask() != geometry.mask) {
                check.mask();
            }
            shape::check(&mut check, &geometry.shape);
        }
        for (index, material) in self.materials.iter().enumerate() {
            self.material(&mut all.at(Part::Material, index, &material.name), material);
        }
        for (index, m) in self.media.iter().enumerate() {
            medium(&mut all.at(Part::Medium, index, &m.name), m);
        }
        for (index, l) in self.lights.iter().enumerate() {
            light(&mut all.at(Part::Light, index, &l.name), l);
        }
        for (index, t) in self.textures.iter().enumerate() {
            texture(&mut all.at(Part::Texture, index, &t.name), t);
        }
        self.environment(&mut all.at(Part::Environment, 0, ""));
        self.camera(&mut all.at(Part::Camera, 0, ""));
        settings(&mut all.at(Part::Settings, 0, ""), &self.settings);
        all.0
    }

    fn material(&self, check: &mut Check<'_>, material: &Material) {
        check.light("ambient", material.ambient);
        check.light("emission", material.emission);
        match &material.diffuse {
            Colour::Constant(colour) => check.share("diffuse", *colour),
            Colour::Image { texture, scale } => {
                check.index("the texture of diffuse", *texture, self.textures.len());
                check.light("the scale of diffuse", *scale);
            }
            Colour::Corners { texture, scale } => {
                if let Some(texture) = texture {
                    check.index("the texture of diffuse", *texture, self.textures.len());
                }
                check.light("the scale of diffuse", *scale);
            }
            Colour::Checker { even, odd, size, offset } => {
                check.share("the even colour of diffuse", *even);
                check.share("the odd colour of diffuse", *odd);
                check.that(*size > 0.0 && size.is_finite(), "the size of diffuse", size, "finite and above 0");
                check.place("the offset of diffuse", *offset);
            }
        }
        match &material.glow {
            None => {}
            Some(Colour::Constant(colour)) => check.light("glow", *colour),
            Some(Colour::Image { texture, scale }) => {
                check.index("the texture of glow", *texture, self.textures.len());
                check.light("the scale of glow", *scale);
            }
            Some(Colour::Corners { texture, scale }) => {
                if let Some(texture) = texture {
                    check.index("the texture of glow", *texture, self.textures.len());
                }
                check.light("the scale of glow", *scale);
            }
            Some(Colour::Checker { even, odd, size, offset }) => {
                check.light("the even colour of glow", *even);
                check.light("the odd colour of glow", *odd);
                check.that(*size > 0.0 && size.is_finite(), "the size of glow", size, "finite and above 0");
                check.place("the offset of glow", *offset);
            }
        }
        if let Some(relief) = material.relief {
            check.index("the texture of relief", relief.texture, self.textures.len());
            check.that(relief.strength.is_finite(), "the strength of relief", relief.strength, "finite");
        }
        if let Some(highlight) = &material.highlight {
            check.light("the colour of the highlight", highlight.colour);
            let exponent = highlight.exponent;
            let fits = EXPONENTS.contains(&f64::from(exponent));
            check.that(fits, "the exponent of the highlight", exponent, "from 0 to 1e6");
        }
        self.interface(check, &material.interface);
    }

    fn interface(&self, check: &mut Check<'_>, interface: &Interface) {
        match *interface {
            Interface::Opaque => {}
            Interface::Mirror { reflectance, .. } => check.share("reflectance", reflectance),
            Interface::Conductor { eta, k } => {
                let fits = eta.to_array().iter().all(|&n| INDICES.contains(&f64::from(n)));
                check.that(fits, "eta", eta, "between 0.001 and 1000");
                check.that(within(k, 0.0, MOST_EXTINCTION), "k", k, "from 0 to 1000");
            }
            Interface::Dielectric { medium, rule, tint } => {
                check.index("the medium of the interface", medium, self.media.len());
                check.split(rule, tint);
            }
            Interface::ThinDielectric { ior, rule, tint } => {
                check.ior("ior", f64::from(ior));
                check.split(rule, tint);
            }
            Interface::Coated { ior } => check.ior("ior", f64::from(ior)),
            Interface::Alpha { opacity, mask } => {
                check.that((0.0..=1.0).contains(&opacity), "opacity", opacity, "from 0 to 1");
                if let Some(mask) = mask {
                    check.index("mask", mask, self.textures.len());
                }
            }
        }
    }

    fn environment(&self, check: &mut Check<'_>) {
        check.light("ambient", self.ambient);
        match self.environment {
            Environment::Constant(colour) => check.light("its colour", colour),
            Environment::Gradient { nadir, horizon, zenith } => {
                check.light("nadir", nadir);
                check.light("horizon", horizon);
                check.light("zenith", zenith);
            }
            Environment::LatLong { texture, scale, rotation } | Environment::Map { texture, scale, rotation, .. } => {
                check.index("texture", texture, self.textures.len());
                check.light("scale", scale);
                check.that(rotation.is_finite(), "rotation", rotation, "finite");
            }
        }
    }

    fn camera(&self, check: &mut Check<'_>) {
        let Camera { eye, target, up, projection, medium } = self.camera;
        check.place("eye", eye);
        check.place("target", target);
        let view = target.as_dvec3() - eye.as_dvec3();
        let apart = view.length() > f64::from(f32::EPSILON) * f64::from(eye.abs().max_element());
        check.that(apart || !view.is_finite(), "target", target, "another point than the eye");
        let sine = view.normalize_or_zero().cross(up.as_dvec3().normalize_or_zero()).length();
        check.that(sine >= LEAST_SINE_OF_UP || !apart, "up", up, "a direction that is not along the view");
        match projection {
            Projection::Pinhole { vfov } => {
                check.that(vfov > 0.0 && vfov < 180.0, "vfov", vfov, "above 0 and below 180 degrees");
            }
            Projection::Orthographic { height } => {
                check.that(height > 0.0 && height.is_finite(), "height", height, "finite and above 0");
            }
            Projection::Map(_) => {}
        }
        if let Some(medium) = medium {
            check.index("medium", medium, self.media.len());
        }
    }
}

fn medium(check: &mut Check<'_>, medium: &Medium) {
    check.ior("ior", medium.ior);
    check.light("absorption", medium.absorption);
    if !medium.disperses() {
        return;
    }
    // Both ends of the visible range: the curve falls or is constant between them.
    let curve = [385.0, 705.0].map(|nm| medium.index_at(nm));
    let falls = curve.iter().all(|n| INDICES.contains(n)) && curve[0] >= curve[1];
    check.that(falls, "dispersion", format_args!("{curve:?} at 385 and 705 nm"), "falling, between 0.001 and 1000");
}

fn light(check: &mut Check<'_>, light: &Light) {
    check.light("intensity", light.intensity);
    match light.kind {
        LightKind::Point { position } => check.place("position", position),
        LightKind::Spot { position, direction, cos_inner, cos_outer } => {
            check.place("position", position);
            check.unit("direction", direction);
            let fits = -1.0 <= cos_outer && cos_outer <= cos_inner && cos_inner <= 1.0;
            check.that(fits, "cos_outer", cos_outer, "from -1 to cos_inner, which is at most 1");
        }
        LightKind::Directional { direction } => check.unit("direction", direction),
        LightKind::Sphere { position, radius } => {
            check.place("position", position);
            check.that(radius > 0.0 && radius.is_finite(), "radius", radius, "finite and above 0");
        }
        LightKind::Rectangle { corner, edges: [a, b], .. } => {
            check.place("corner", corner);
            let [long, wide] = [a, b].map(|e| e.as_dvec3());
            let area = long.cross(wide);
            let fits = area.length() > LEAST_SINE_OF_EDGES * long.length() * wide.length();
            let shown = format_args!("{a} and {b}");
            check.that(fits && area.is_finite() && spans(area), "edges", shown, "finite and not parallel");
        }
    }
}

/// Returns true if an area stays above zero in `f32`.
fn spans(area: DVec3) -> bool {
    area.as_vec3().length_squared() > 0.0
}

fn texture(check: &mut Check<'_>, texture: &Texture) {
    let Texture { width, height, ref pixels, .. } = *texture;
    check.that(width > 0 && height > 0, "its size", format_args!("{width} by {height}"), "at least 1 by 1");
    let wanted = usize::try_from(u64::from(width) * u64::from(height)).unwrap_or(usize::MAX);
    check.length("pixels", pixels.len(), wanted);
    if let Some(bad) = pixels.iter().find(|p| !within(*p, 0.0, f32::MAX)) {
        check.light("a pixel", bad);
    }
}

fn settings(check: &mut Check<'_>, settings: &Settings) {
    check.that(settings.width > 0, "width", settings.width, "at least 1");
    check.that(settings.height > 0, "height", settings.height, "at least 1");
    check.that(SAMPLES.contains(&settings.samples), "samples", settings.samples, "from 1 to 256");
    check.that(settings.max_depth <= MOST_DEPTH, "max_depth", settings.max_depth, "at most 10000");
    check.that((0.0..=1.0).contains(&settings.cutoff), "cutoff", settings.cutoff, "from 0 to 1");
    let wavelengths = settings.wavelengths;
    check.that(wavelengths <= MOST_WAVELENGTHS, "wavelengths", wavelengths, "at most 64");
    let count = settings.lamps.count;
    check.that(LIGHT_SAMPLES.contains(&count), "lamps.count", count, "from 1 to 4096");
    let square = settings.lamps.pattern != Pattern::Grid || count.isqrt() * count.isqrt() == count;
    check.that(square, "lamps.count", count, "a square number under `Pattern::Grid`");
}

/// Returns true if every channel is a number from `low` to `high`.
fn within(colour: Rgb, low: f32, high: f32) -> bool {
    colour.to_array().iter().all(|channel| (low..=high).contains(channel))
}

/// The rules found broken so far.
#[derive(Default)]
struct Errors(Vec<SceneError>);

impl Errors {
    fn at<'a>(&'a mut self, part: Part, index: usize, name: &'a str) -> Check<'a> {
        Check { errors: self, part, index, name }
    }
}

/// Checks of one entry.
struct Check<'a> {
    errors: &'a mut Errors,
    part: Part,
    index: usize,
    name: &'a str,
}

impl Check<'_> {
    fn fails(&mut self, error: impl FnOnce(SceneEntry) -> SceneError) {
        let place = SceneEntry { part: self.part, index: self.index, name: self.name.to_owned() };
        self.errors.0.push(error(place));
    }

    fn that(&mut self, fits: bool, field: &'static str, value: impl Display, must: &'static str) {
        if !fits {
            let value = value.to_string();
            self.fails(|place| SceneError::Value { place, field, value, must });
        }
    }

    fn index(&mut self, field: &'static str, index: u32, len: usize) {
        if index as usize >= len {
            self.fails(|place| SceneError::Index { place, field, index, len });
        }
    }

    fn length(&mut self, field: &'static str, len: usize, wanted: usize) {
        if len != wanted {
            self.fails(|place| SceneError::Length { place, field, len, wanted });
        }
    }

    fn mask(&mut self) {
        self.fails(|place| SceneError::Mask { place });
    }

    /// A radiance, an intensity or a factor that may exceed 1.
    fn light(&mut self, field: &'static str, colour: Rgb) {
        self.that(within(colour, 0.0, f32::MAX), field, colour, "finite and at least 0 in every channel");
    }

    /// A share of the light that arrives.
    fn share(&mut self, field: &'static str, colour: Rgb) {
        self.that(within(colour, 0.0, 1.0), field, colour, "from 0 to 1 in every channel");
    }

    fn split(&mut self, rule: FresnelRule, tint: Rgb) {
        self.share("tint", tint);
        if let FresnelRule::Fixed(share) = rule {
            self.share("the fixed share", share);
        }
    }

    fn ior(&mut self, field: &'static str, ior: f64) {
        self.that(INDICES.contains(&ior), field, ior, "between 0.001 and 1000");
    }

    fn place(&mut self, field: &'static str, place: Vec3) {
        self.that(place.is_finite(), field, place, "finite");
    }

    fn unit(&mut self, field: &'static str, direction: Vec3) {
        let fits = (direction.length_squared() - 1.0).abs() < 1e-3;
        self.that(fits, field, direction, "of unit length");
    }
}
