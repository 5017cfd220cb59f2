//! The choices that have a price, and the levels of each.

use std::fmt;

use crate::accel::Backend;
use crate::geometry::Shape;
use crate::geometry::triangle_test::TriangleModel;
use crate::optics::{FresnelModel, Oliveira, RefractionModel};
use crate::render::Reflection;
use crate::scene::{Interface, MirrorSource, Scene, ShadowRule};
use crate::simd::ReciprocalModel;

/// A choice that has a price.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Axis {
    /// Which formula splits light at a surface.
    Fresnel,
    /// Which formula bends light.
    Refraction,
    /// What becomes of reflected light.
    Reflection,
    /// What transparent surfaces do to shadows.
    Shadows,
    /// Exact spheres or triangles.
    Spheres,
    /// Below which weight a ray ends, or by what proof.
    Cutoff,
    /// How often a ray may reflect or refract.
    Depth,
    /// What finds hits.
    Backend,
    /// Which ray/triangle test, in a walk of one ray at a time.
    Triangles,
    /// What one over a number is, in the same walk.
    Reciprocal,
    /// Eight lanes of `f32`, or `f64`.
    Precision,
    /// Rays a pixel.
    Sampling,
}

/// What a picture is computed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Precision {
    /// Eight lanes of `f32`.
    Single,
    /// One ray at a time in `f64`, over its own hierarchy.
    Double,
}

/// What spheres are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Spheres {
    /// Spheres.
    Exact,
    /// Meshes of this many bands of latitude, twice as many of longitude, with smooth normals.
    Bands(u32),
}

/// One level of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Level {
    /// See [`Axis::Fresnel`].
    Fresnel(FresnelModel),
    /// See [`Axis::Refraction`]; the constant counts for Oliveira's formula alone, and is that for glass else.
    Refraction(RefractionModel, Oliveira),
    /// See [`Axis::Reflection`].
    Reflection(Reflection),
    /// See [`Axis::Shadows`].
    Shadows(ShadowRule),
    /// See [`Axis::Spheres`].
    Spheres(Spheres),
    /// See [`Axis::Cutoff`]; a fixed weight in 0..=1.
    Cutoff(f32),
    /// See [`Axis::Cutoff`]; what is cut changes no channel by more than this, above 0.
    Proven(f32),
    /// See [`Axis::Depth`].
    Depth(u32),
    /// See [`Axis::Backend`].
    Backend(Backend),
    /// See [`Axis::Triangles`]; none is the back end's own kernels.
    Triangles(Option<TriangleModel>),
    /// See [`Axis::Reciprocal`].
    Reciprocal(ReciprocalModel),
    /// See [`Axis::Precision`].
    Precision(Precision),
    /// See [`Axis::Sampling`]: a grid of so many by so many.
    Sampling(u32),
}

impl Axis {
    /// All of them, in the order in which they are studied.
    pub const ALL: [Self; 12] = [
        Self::Fresnel,
        Self::Refraction,
        Self::Reflection,
        Self::Shadows,
        Self::Spheres,
        Self::Cutoff,
        Self::Depth,
        Self::Backend,
        Self::Triangles,
        Self::Reciprocal,
        Self::Precision,
        Self::Sampling,
    ];

    /// The name in reports and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Fresnel => "fresnel",
            Self::Refraction => "refraction",
            Self::Reflection => "reflection",
            Self::Shadows => "shadows",
            Self::Spheres => "spheres",
            Self::Cutoff => "cutoff",
            Self::Depth => "depth",
            Self::Backend => "backend",
            Self::Triangles => "triangles",
            Self::Reciprocal => "reciprocal",
            Self::Precision => "precision",
            Self::Sampling => "sampling",
        }
    }

    /// The axis of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|axis| axis.name() == name)
    }

    /// Its levels, cheapest claim first.
    #[must_use]
    pub fn levels(self) -> Vec<Level> {
        match self {
            Self::Fresnel => [FresnelModel::Off, FresnelModel::Schlick, FresnelModel::Exact, FresnelModel::Polarised]
                .map(Level::Fresnel)
                .to_vec(),
            Self::Refraction => {
                let oliveira = [Oliveira::AS_PRINTED, Oliveira::WATER, Oliveira::GLASS]
                    .map(|c| Level::Refraction(RefractionModel::Oliveira, c));
                let others = [
                    RefractionModel::Bec,
                    RefractionModel::Heckbert,
                    RefractionModel::SlidesVector,
                    RefractionModel::Trigonometric,
                    RefractionModel::Stable,
                ];
                let level = |model| Level::Refraction(model, Oliveira::GLASS);
                let straight = std::iter::once(level(RefractionModel::StraightThrough));
                straight.chain(oliveira).chain(others.map(level)).collect()
            }
            Self::Reflection => {
                [Reflection::None, Reflection::Environment, Reflection::Traced].map(Level::Reflection).to_vec()
            }
            Self::Shadows => [ShadowRule::Opaque, ShadowRule::Straight].map(Level::Shadows).to_vec(),
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
                own.chain(TriangleModel::ALL.map(|test| Level::Triangles(Some(test)))).collect()
            }
            Self::Reciprocal => ReciprocalModel::ALL.map(Level::Reciprocal).to_vec(),
            Self::Precision => [Precision::Single, Precision::Double].map(Level::Precision).to_vec(),
            Self::Sampling => [1, 2, 4, 8].map(Level::Sampling).to_vec(),
        }
    }

    /// Why this axis cannot change pictures of `scene`, where it cannot.
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
            Self::Reflection
                if !any(|i| match i {
                    Interface::Mirror { source, .. } => *source == MirrorSource::Traced,
                    other => !matches!(other, Interface::Opaque | Interface::Alpha { .. }),
                }) =>
            {
                Some("no material of the scene reflects")
            }
            Self::Shadows if !scene.lights.iter().any(|l| l.shadows) => Some("no light of the scene casts shadows"),
            Self::Shadows if !scene.materials.iter().any(crate::scene::Material::is_transmissive) => {
                Some("nothing in the scene lets light through")
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
    /// The axis it is a level of.
    #[must_use]
    pub fn axis(self) -> Axis {
        match self {
            Self::Fresnel(_) => Axis::Fresnel,
            Self::Refraction(..) => Axis::Refraction,
            Self::Reflection(_) => Axis::Reflection,
            Self::Shadows(_) => Axis::Shadows,
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

    /// The level of `axis` that is called `name`, one of [`Axis::levels`] or any other number that can be one.
    #[must_use]
    pub fn parse(axis: Axis, name: &str) -> Option<Self> {
        let number = |text: &str| text.parse::<u32>().ok();
        match axis {
            Axis::Depth => number(name).map(Self::Depth),
            Axis::Sampling => number(name.split_once('x')?.0).map(Self::Sampling),
            Axis::Spheres if name != "exact" => number(name).map(|n| Self::Spheres(Spheres::Bands(n))),
            Axis::Refraction if name.starts_with("oliveira c=") => {
                let c = name["oliveira c=".len()..].parse::<f64>().ok().filter(|c| *c > -1.0)?;
                Some(Self::Refraction(RefractionModel::Oliveira, Oliveira { c }))
            }
            Axis::Cutoff => match name.strip_prefix("proven ") {
                Some(error) => share(error).filter(|e| *e > 0.0).map(Self::Proven),
                None => share(name).map(Self::Cutoff),
            },
            _ => axis.levels().into_iter().find(|level| level.to_string() == name),
        }
    }
}

/// A number in 0..=1, written as such or as a quotient.
fn share(text: &str) -> Option<f32> {
    let x = match text.split_once('/') {
        Some((one, n)) => one.parse::<f32>().ok()? / n.parse::<f32>().ok()?,
        None => text.parse().ok()?,
    };
    (0.0..=1.0).contains(&x).then_some(x)
}

/// `1/n` where it is one, else the number.
struct Share(f32);

impl fmt::Display for Share {
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

/// As the command line has it.
impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match *self {
            Self::Fresnel(FresnelModel::Exact) | Self::Spheres(Spheres::Exact) => f.write_str("exact"),
            Self::Fresnel(FresnelModel::Polarised) => f.write_str("polarised"),
            Self::Fresnel(FresnelModel::Schlick) => f.write_str("schlick"),
            Self::Fresnel(FresnelModel::Off) => f.write_str("off"),
            Self::Refraction(RefractionModel::Stable, _) => f.write_str("stable"),
            Self::Refraction(RefractionModel::Trigonometric, _) => f.write_str("trigonometric"),
            Self::Refraction(RefractionModel::Heckbert, _) => f.write_str("heckbert"),
            Self::Refraction(RefractionModel::Bec, _) => f.write_str("bec"),
            Self::Refraction(RefractionModel::SlidesVector, _) => f.write_str("slides"),
            Self::Refraction(RefractionModel::Oliveira, c) => write!(f, "oliveira c={}", c.c),
            Self::Refraction(RefractionModel::StraightThrough, _) => f.write_str("straight"),
            Self::Reflection(Reflection::Traced) => f.write_str("traced"),
            Self::Reflection(Reflection::Environment) => f.write_str("environment"),
            Self::Reflection(Reflection::None) => f.write_str("none"),
            Self::Shadows(ShadowRule::Opaque) => f.write_str("opaque"),
            Self::Shadows(ShadowRule::Straight) => f.write_str("straight"),
            Self::Spheres(Spheres::Bands(n)) | Self::Depth(n) => write!(f, "{n}"),
            Self::Cutoff(w) => write!(f, "{}", Share(w)),
            Self::Proven(e) => write!(f, "proven {}", Share(e)),
            Self::Triangles(None) => f.write_str("own"),
            Self::Triangles(Some(test)) => f.write_str(test.name()),
            Self::Reciprocal(model) => f.write_str(model.name()),
            Self::Backend(backend) => f.write_str(backend.name()),
            Self::Precision(Precision::Single) => f.write_str("f32x8"),
            Self::Precision(Precision::Double) => f.write_str("f64"),
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
