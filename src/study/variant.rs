//! Variants: combinations of one level of each axis.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::axis::{Axis, Level, Precision, Spheres};
use crate::accel::{Backend, BuildQuality};
use crate::choice::Choice;
use crate::geometry::triangle_test::TriangleModel;
use crate::optics::{FresnelModel, RefractionModel};
use crate::render::{Options, Reflection};
use crate::scene::{LightsFrom, Settings, ShadowRule};
use crate::simd::ReciprocalModel;

/// One level of each axis, and the build quality.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// Fresnel formula.
    pub fresnel: FresnelModel,
    /// Refraction formula.
    pub refraction: RefractionModel,
    /// Source of reflected light.
    pub reflection: Reflection,
    /// Effect of transparent surfaces on shadows.
    pub shadows: ShadowRule,
    /// Sources of the light on matt surfaces.
    pub lights_from: LightsFrom,
    /// Representation of spheres.
    pub spheres: Spheres,
    /// Weight below which a ray ends, 0..=1.
    pub cutoff: f32,
    /// Proven bound on the change of a channel by rays that end, instead of a fixed cut-off.
    pub proven: Option<f32>,
    /// Largest number of reflections and refractions of a ray.
    pub depth: u32,
    /// Back end that finds hits, if `precision` is single.
    pub backend: Backend,
    /// Build quality of its hierarchy. This is no axis, since the picture is the same.
    pub bvh: BuildQuality,
    /// Ray/triangle test of the single-ray walk, if one is chosen.
    pub triangles: Option<TriangleModel>,
    /// Reciprocal of the single-ray walk.
    pub reciprocal: ReciprocalModel,
    /// Precision of the picture.
    pub precision: Precision,
    /// Edge of the regular grid of rays per pixel.
    pub samples: u32,
}

impl Variant {
    /// Returns the choices of a render with these settings.
    #[must_use]
    pub fn of(settings: &Settings, backend: Backend) -> Self {
        Self {
            fresnel: FresnelModel::Exact,
            refraction: RefractionModel::Stable,
            reflection: Reflection::Traced,
            shadows: settings.shadows,
            lights_from: settings.lights_from,
            spheres: Spheres::Exact,
            cutoff: settings.cutoff,
            proven: None,
            depth: settings.max_depth,
            backend,
            bvh: BuildQuality::Default,
            triangles: None,
            reciprocal: ReciprocalModel::Exact,
            precision: Precision::Single,
            samples: settings.samples,
        }
    }

    /// Returns its level of one axis.
    #[must_use]
    pub fn level(&self, axis: Axis) -> Level {
        match axis {
            Axis::Fresnel => Level::Fresnel(self.fresnel),
            Axis::Refraction => Level::Refraction(self.refraction),
            Axis::Reflection => Level::Reflection(self.reflection),
            Axis::Shadows => Level::Shadows(self.shadows),
            Axis::LightsFrom => Level::LightsFrom(self.lights_from),
            Axis::Spheres => Level::Spheres(self.spheres),
            Axis::Cutoff => self.proven.map_or(Level::Cutoff(self.cutoff), Level::Proven),
            Axis::Depth => Level::Depth(self.depth),
            Axis::Backend => Level::Backend(self.backend),
            Axis::Triangles => Level::Triangles(self.triangles),
            Axis::Reciprocal => Level::Reciprocal(self.reciprocal),
            Axis::Precision => Level::Precision(self.precision),
            Axis::Sampling => Level::Sampling(self.samples),
        }
    }

    /// Returns the same variant with another level of one axis.
    #[must_use]
    pub fn with(mut self, level: Level) -> Self {
        match level {
            Level::Fresnel(x) => self.fresnel = x,
            Level::Refraction(x) => self.refraction = x,
            Level::Reflection(x) => self.reflection = x,
            Level::Shadows(x) => self.shadows = x,
            Level::LightsFrom(x) => self.lights_from = x,
            Level::Spheres(x) => self.spheres = x,
            Level::Cutoff(x) => (self.cutoff, self.proven) = (x, None),
            // A proof replaces the cut-off.
            Level::Proven(x) => (self.cutoff, self.proven) = (0.0, Some(x)),
            Level::Depth(x) => self.depth = x,
            Level::Backend(x) => self.backend = x,
            Level::Triangles(x) => self.triangles = x,
            Level::Reciprocal(x) => self.reciprocal = x,
            Level::Precision(x) => self.precision = x,
            Level::Sampling(x) => self.samples = x,
        }
        self
    }

    /// Returns the triangle test and the reciprocal of the single-ray walk ([`crate::accel::walk::Walk`]), if either is
    /// chosen. With a reciprocal alone the test is the watertight one.
    #[must_use]
    pub fn walk(&self) -> Option<(TriangleModel, ReciprocalModel)> {
        let chosen = self.triangles.is_some() || self.reciprocal != ReciprocalModel::Exact;
        let walks = chosen && self.precision == Precision::Single;
        walks.then_some((self.triangles.unwrap_or(TriangleModel::Watertight), self.reciprocal))
    }

    /// Returns the same walk with the watertight test and true division, which its time is compared with.
    #[must_use]
    pub fn plain_walk(&self) -> Option<Self> {
        let plain = Self { triangles: Some(TriangleModel::Watertight), reciprocal: ReciprocalModel::Exact, ..*self };
        self.walk().map(|_| plain)
    }

    /// Returns the levels that differ from those of `o`.
    #[must_use]
    pub fn apart_from(&self, o: &Self) -> Vec<Level> {
        let levels = Axis::ALL.map(|axis| self.level(axis));
        levels.into_iter().filter(|level| *level != o.level(level.axis())).collect()
    }

    /// Returns its name beside `default`: the levels that differ, or `default`.
    #[must_use]
    pub fn name(&self, default: &Self) -> String {
        let named = |level: &Level| format!("{} {level}", level.axis().name());
        let names: Vec<String> = self.apart_from(default).iter().map(named).collect();
        if names.is_empty() { String::from("default") } else { names.join(", ") }
    }

    /// Returns settings with these choices.
    #[must_use]
    pub fn settings(&self, of: &Settings) -> Settings {
        Settings {
            samples: self.samples,
            max_depth: self.depth,
            cutoff: self.cutoff,
            shadows: self.shadows,
            lights_from: self.lights_from,
            ..of.clone()
        }
    }

    /// Returns options of a render with these choices.
    #[must_use]
    pub fn options(&self, threads: usize) -> Options {
        Options {
            fresnel: self.fresnel,
            refraction: self.refraction,
            reflection: self.reflection,
            cutoff_error: self.proven,
            threads,
            ..Options::default()
        }
    }
}

/// Name of the build quality, which is no axis.
const BVH: &str = BuildQuality::OPTION;

/// Writes the names of its levels.
impl Serialize for Variant {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let levels = Axis::ALL.map(|axis| (axis.name(), self.level(axis).to_string()));
        serializer.collect_map(levels.into_iter().chain([(BVH, self.bvh.name().to_owned())]))
    }
}

impl<'de> Deserialize<'de> for Variant {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let names: BTreeMap<String, String> = BTreeMap::deserialize(deserializer)?;
        let mut variant = Self::of(&Settings::default(), Backend::Native);
        for axis in Axis::ALL {
            let name = names.get(axis.name()).ok_or_else(|| serde::de::Error::missing_field(axis.name()))?;
            let level = Level::parse(axis, name)
                .ok_or_else(|| serde::de::Error::custom(format!("{} has no level `{name}`", axis.name())))?;
            variant = variant.with(level);
        }
        let name = names.get(BVH).ok_or_else(|| serde::de::Error::missing_field(BVH))?;
        variant.bvh =
            BuildQuality::parse(name).map_err(|_| serde::de::Error::custom(format!("{BVH} has no level `{name}`")))?;
        Ok(variant)
    }
}

/// Writes every axis with its level.
impl fmt::Display for Variant {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let levels = Axis::ALL.map(|axis| format!("{} {}", axis.name(), self.level(axis)));
        f.write_str(&levels.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn default() -> Variant {
        Variant::of(&Settings::default(), Backend::Native)
    }

    #[test]
    fn a_variant_is_called_by_what_it_has_else() {
        let other = default().with(Level::Depth(4)).with(Level::Fresnel(FresnelModel::Schlick));
        assert_eq!(default().name(&default()), "default");
        assert_eq!(other.name(&default()), "fresnel schlick, depth 4");
    }

    #[test]
    fn a_variant_survives_the_journal() {
        for axis in Axis::ALL {
            for level in axis.levels() {
                let variant = default().with(level);
                let text = serde_json::to_string(&variant).unwrap();
                assert_eq!(serde_json::from_str::<Variant>(&text).unwrap(), variant);
            }
        }
        for bvh in BuildQuality::ALL {
            let variant = Variant { bvh, ..default() };
            let text = serde_json::to_string(&variant).unwrap();
            assert_eq!(serde_json::from_str::<Variant>(&text).unwrap(), variant);
        }
    }
}
