//! Settings whose price is studied, and the levels of each.

use std::fmt;

use crate::accel::Backend;
use crate::choice::{Choice, number_of};
use crate::geometry::Shape;
use crate::geometry::triangle_test::TriangleModel;
use crate::optics::{FresnelModel, RefractionModel};
use crate::render::Reflection;
use crate::scene::{Interface, LightsFrom, Material, Scene, ShadowRule};
use crate::simd::ReciprocalModel;

crate::choice! {
    /// Settings to study.
    pub enum Axis("axes", derive(Eq, Hash, PartialOrd, Ord)) {
        /// Formula for the share of light that a surface reflects.
        "fresnel" => Fresnel,
        /// Formula for the direction of refracted light.
        "refraction" => Refraction,
        /// Source of reflected light.
        "reflection" => Reflection,
        /// Effect of transparent surfaces on shadows.
        "shadows" => Shadows,
        /// Sources of the light on matt surfaces.
        "lights-from" => LightsFrom,
        /// Exact spheres, or meshes.
        "spheres" => Spheres,
        /// Weight below which a ray ends, or a proven bound on what that changes.
        "cutoff" => Cutoff,
        /// Largest number of reflections and refractions of a ray.
        "depth" => Depth,
        /// Back end that finds hits.
        "backend" => Backend,
        /// Ray/triangle test of the walk with one ray at a time.
        "triangles" => Triangles,
        /// Reciprocals of the same walk.
        "reciprocal" => Reciprocal,
        /// Eight lanes of f32, or f64.
        "precision" => Precision,
        /// Camera rays for each pixel.
        "sampling" => Sampling,
    }
}

crate::choice! {
    /// Arithmetic of a picture.
    pub enum Precision("precision", derive(Eq, Hash)) {
        /// Eight lanes of f32.
        "f32x8" => Single,
        /// One ray at a time in f64, with a hierarchy of its own.
        "f64" => Double,
    }
}

/// Representation of spheres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Spheres {
    /// Exact spheres.
    Exact,
    /// Meshes with this many bands of latitude, twice as many of longitude, and interpolated normals.
    Bands(u32),
}

/// One level of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Level {
    /// Level of [`Axis::Fresnel`].
    Fresnel(FresnelModel),
    /// Level of [`Axis::Refraction`].
    Refraction(RefractionModel),
    /// Level of [`Axis::Reflection`].
    Reflection(Reflection),
    /// Level of [`Axis::Shadows`].
    Shadows(ShadowRule),
    /// Level of [`Axis::LightsFrom`].
    LightsFrom(LightsFrom),
    /// Level of [`Axis::Spheres`].
    Spheres(Spheres),
    /// Level of [`Axis::Cutoff`]: a fixed weight in 0..=1.
    Cutoff(f32),
    /// Level of [`Axis::Cutoff`]: the largest change of a channel by the rays that end, above 0.
    Proven(f32),
    /// Level of [`Axis::Depth`].
    Depth(u32),
    /// Level of [`Axis::Backend`].
    Backend(Backend),
    /// Level of [`Axis::Triangles`]; none stands for the back end's own kernels.
    Triangles(Option<TriangleModel>),
    /// Level of [`Axis::Reciprocal`].
    Reciprocal(ReciprocalModel),
    /// Level of [`Axis::Precision`].
    Precision(Precision),
    /// Level of [`Axis::Sampling`]: a grid of so many by so many rays.
    Sampling(u32),
}

/// Name of the level of [`Axis::Triangles`] that is no choice of a test.
const OWN_KERNELS: &str = "own";

/// All levels of a choice.
fn of<C: Choice>(level: fn(C) -> Level) -> Vec<Level> {
    C::compared().into_iter().map(level).collect()
}

/// The level of a choice with this name.
fn read<C: Choice>(name: &str, level: fn(C) -> Level) -> Option<Level> {
    C::parse(name).ok().map(level)
}

impl Axis {
    /// The axis of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::parse(name).ok()
    }

    /// Levels of the axis, in order of the accuracy that they promise.
    #[must_use]
    pub fn levels(self) -> Vec<Level> {
        match self {
            Self::Fresnel => of(Level::Fresnel),
            Self::Refraction => of(Level::Refraction),
            Self::Reflection => of(Level::Reflection),
            Self::Shadows => of(Level::Shadows),
            Self::LightsFrom => of(Level::LightsFrom),
            Self::Spheres => {
                let bands = [8, 16, 32, 64, 128].map(Spheres::Bands);
                bands.into_iter().chain([Spheres::Exact]).map(Level::Spheres).collect()
            }
            Self::Cutoff => {
                let fixed = [4, 6, 8, 10, 12, 16].map(|bits| Level::Cutoff(2.0_f32.powi(-bits)));
                fixed.into_iter().chain([6, 9, 12].map(|bits| Level::Proven(2.0_f32.powi(-bits)))).collect()
            }
            Self::Depth => [1, 2, 4, 8, 16, 64].map(Level::Depth).to_vec(),
            Self::Backend => [Backend::EmbreeFast, Backend::Embree, Backend::Native].map(Level::Backend).to_vec(),
            Self::Triangles => {
                let own = std::iter::once(Level::Triangles(None));
                own.chain(of(|test| Level::Triangles(Some(test)))).collect()
            }
            Self::Reciprocal => of(Level::Reciprocal),
            Self::Precision => of(Level::Precision),
            Self::Sampling => [1, 2, 4, 8].map(Level::Sampling).to_vec(),
        }
    }

    /// Reason why this axis cannot change pictures of `scene`, if there is one.
    #[must_use]
    pub fn idle(self, scene: &Scene) -> Option<&'static str> {
        let any = |wanted: fn(&Interface) -> bool| scene.materials.iter().any(|m| wanted(&m.interface));
        match self {
            Self::Fresnel
                if !any(|i| !matches!(i, Interface::Opaque | Interface::Mirror { .. } | Interface::Alpha { .. })) =>
            {
                Some("no material of the scene splits light by Fresnel")
            }
            Self::Refraction if !any(|i| matches!(i, Interface::Dielectric { .. })) => {
                Some("no material of the scene bends light")
            }
            Self::Reflection if !scene.materials.iter().any(Material::reflects) => {
                Some("no material of the scene reflects")
            }
            Self::Shadows if !(scene.lights.iter().any(|l| l.shadows) || scene.shining().any()) => {
                Some("no light of the scene casts shadows")
            }
            Self::Shadows if !scene.materials.iter().any(Material::is_transmissive) => {
                Some("nothing in the scene lets light through")
            }
            Self::LightsFrom if !scene.has_shiners() => Some("nothing in the scene shines but its lamps"),
            Self::LightsFrom if !scene.materials.iter().any(Material::answers_light) => {
                Some("no surface of the scene answers light")
            }
            Self::Spheres if !scene.geometry.iter().any(|g| matches!(g.shape, Shape::Sphere(_))) => {
                Some("the scene has no exact sphere")
            }
            Self::Triangles | Self::Reciprocal if !scene.geometry.iter().any(|g| matches!(g.shape, Shape::Mesh(_))) => {
                Some("the scene has no triangle")
            }
            _ => None,
        }
    }
}

impl Level {
    /// Axis of the level.
    #[must_use]
    pub fn axis(self) -> Axis {
        match self {
            Self::Fresnel(_) => Axis::Fresnel,
            Self::Refraction(_) => Axis::Refraction,
            Self::Reflection(_) => Axis::Reflection,
            Self::Shadows(_) => Axis::Shadows,
            Self::LightsFrom(_) => Axis::LightsFrom,
            Self::Spheres(_) => Axis::Spheres,
            Self::Cutoff(_) | Self::Proven(_) => Axis::Cutoff,
            Self::Depth(_) => Axis::Depth,
            Self::Backend(_) => Axis::Backend,
            Self::Triangles(_) => Axis::Triangles,
            Self::Reciprocal(_) => Axis::Reciprocal,
            Self::Precision(_) => Axis::Precision,
            Self::Sampling(_) => Axis::Sampling,
        }
    }

    /// Returns the level of `axis` with this name: one of [`Axis::levels`], or another number that can be a level.
    #[must_use]
    pub fn parse(axis: Axis, name: &str) -> Option<Self> {
        let number = |text: &str| text.parse::<u32>().ok();
        match axis {
            Axis::Fresnel => read(name, Self::Fresnel),
            Axis::Refraction => read(name, Self::Refraction),
            Axis::Reflection => read(name, Self::Reflection),
            Axis::Shadows => read(name, Self::Shadows),
            Axis::LightsFrom => read(name, Self::LightsFrom),
            Axis::Spheres if name == "exact" => Some(Self::Spheres(Spheres::Exact)),
            Axis::Spheres => number(name).map(|n| Self::Spheres(Spheres::Bands(n))),
            Axis::Cutoff => match name.strip_prefix("proven ") {
                Some(error) => weight(error).filter(|e| *e > 0.0).map(Self::Proven),
                None => weight(name).map(Self::Cutoff),
            },
            Axis::Depth => number(name).map(Self::Depth),
            Axis::Backend => read(name, Self::Backend),
            Axis::Triangles if name == OWN_KERNELS => Some(Self::Triangles(None)),
            Axis::Triangles => read(name, |test| Self::Triangles(Some(test))),
            Axis::Reciprocal => read(name, Self::Reciprocal),
            Axis::Precision => read(name, Self::Precision),
            Axis::Sampling => number(name.split_once('x')?.0).map(Self::Sampling),
        }
    }
}

/// A number in 0..=1, written as such or as a quotient.
fn weight(text: &str) -> Option<f32> {
    let x = match text.contains('/') {
        true => number_of(text)? as f32,
        false => text.parse().ok()?,
    };
    (0.0..=1.0).contains(&x).then_some(x)
}

/// A weight, written as `1/n` where it is one over a whole number.
struct Quotient(f32);

impl fmt::Display for Quotient {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self(x) = *self;
        let whole = 1.0 / x;
        if x > 0.0 && x < 1.0 && whole.fract() == 0.0 && 1.0 / whole == x {
            write!(f, "1/{whole}")
        } else {
            write!(f, "{x}")
        }
    }
}

/// Writes the name that [`Level::parse`] reads.
impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match *self {
            Self::Fresnel(level) => level.fmt(f),
            Self::Refraction(level) => level.fmt(f),
            Self::Reflection(level) => level.fmt(f),
            Self::Shadows(level) => level.fmt(f),
            Self::LightsFrom(level) => level.fmt(f),
            Self::Spheres(Spheres::Exact) => f.write_str("exact"),
            Self::Spheres(Spheres::Bands(n)) | Self::Depth(n) => write!(f, "{n}"),
            Self::Cutoff(w) => write!(f, "{}", Quotient(w)),
            Self::Proven(e) => write!(f, "proven {}", Quotient(e)),
            Self::Triangles(None) => f.write_str(OWN_KERNELS),
            Self::Triangles(Some(level)) => level.fmt(f),
            Self::Reciprocal(level) => level.fmt(f),
            Self::Backend(level) => level.fmt(f),
            Self::Precision(level) => level.fmt(f),
            Self::Sampling(n) => write!(f, "{n}x{n}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_has_a_name_that_leads_back_to_it() {
        for axis in Axis::ALL {
            assert_eq!(Axis::named(axis.name()), Some(axis));
            for level in axis.levels() {
                assert_eq!(level.axis(), axis);
                assert_eq!(Level::parse(axis, &level.to_string()), Some(level), "{} {level}", axis.name());
            }
        }
        assert_eq!(Level::parse(Axis::Cutoff, "0.004"), Some(Level::Cutoff(0.004)));
        assert_eq!(Level::Cutoff(0.004).to_string(), "0.004");
        assert_eq!(Level::Cutoff(1.0 / 1024.0).to_string(), "1/1024");
        assert_eq!(Level::parse(Axis::Cutoff, "proven 0.01"), Some(Level::Proven(0.01)));
        assert_eq!(Level::parse(Axis::Cutoff, "proven 0"), None);
        assert_eq!((Level::parse(Axis::Cutoff, "2"), Level::parse(Axis::Fresnel, "some")), (None, None));
    }
}
