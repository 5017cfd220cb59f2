//! Sources of light beside lamps: emissive shapes and the environment.

use super::{Environment, Falloff, Interface, LampChoice, Light, LightKind, LightsFrom, Rgb, Scene};
use crate::geometry::Shape;

/// Kinds of source that light the surfaces of a scene by samples, beside lamps that light every surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shining {
    /// True if emissive shapes do.
    pub emissive: bool,
    /// True if some lamps do.
    pub lamps: bool,
    /// True if the environment does.
    pub sky: bool,
}

impl Shining {
    /// Returns true if any kind but lamps does.
    #[must_use]
    pub fn any(self) -> bool {
        self.emissive || self.sky
    }

    /// Returns true if emissive shapes or lamps do.
    #[must_use]
    pub fn emitters(self) -> bool {
        self.emissive || self.lamps
    }
}

impl Scene {
    /// Returns the kinds of source that the settings admit and the scene has.
    #[must_use]
    pub fn shining(&self) -> Shining {
        let admitted = self.admitted();
        Shining {
            emissive: admitted.emissive && (0..self.objects.len()).any(|o| self.can_light(o)),
            lamps: self.lights.iter().any(|light| self.is_sampled(light)),
            sky: admitted.sky && self.environment != Environment::Constant(Rgb::ZERO),
        }
    }

    /// Returns true if an emissive shape or the environment could light surfaces, whatever the settings say.
    #[must_use]
    pub fn has_shiners(&self) -> bool {
        let black = self.environment == Environment::Constant(Rgb::ZERO);
        !black || (0..self.objects.len()).any(|o| self.can_light(o))
    }

    /// Returns the kinds of source that the settings admit, if the scene has them.
    #[must_use]
    pub fn admitted(&self) -> Shining {
        let (emissive, sky) = match self.settings.lights_from {
            LightsFrom::Auto => {
                let unlit = self.lights.is_empty() && self.ambient == Rgb::ZERO;
                (unlit, unlit)
            }
            LightsFrom::Lamps => (false, false),
            LightsFrom::Emissive => (true, false),
            LightsFrom::Sky => (false, true),
            LightsFrom::All => (true, true),
        };
        Shining { emissive, sky, lamps: self.settings.lamp_choice == LampChoice::Sampled }
    }

    /// Returns true if a lamp is one of those of which a sample lights each point.
    #[must_use]
    pub fn is_sampled(&self, light: &Light) -> bool {
        let at_a_point = matches!(light.kind, LightKind::Point { .. } | LightKind::Spot { .. });
        let fits = at_a_point && light.falloff == Falloff::InverseSquare && light.shadows;
        self.settings.lamp_choice == LampChoice::Sampled && fits && light.intensity != Rgb::ZERO
    }

    /// Returns true if an object emits light and has a finite area, so that it can light surfaces.
    #[must_use]
    pub fn can_light(&self, object: usize) -> bool {
        let material = &self.materials[self.objects[object].material as usize];
        let seen = !matches!(material.interface, Interface::Alpha { opacity, .. } if opacity <= 0.0);
        let bounded = !matches!(self.geometry[object].shape, Shape::Plane(_));
        material.emission != Rgb::ZERO && seen && bounded
    }
}
