//! The bundled scenes of the notes' systems, and the systems that each of them is rendered by.

use crate::optics::RefractionModel;
use crate::render::{Options, Reflection};
use crate::systems::maps::Proxy;

/// Scene file that the program contains.
#[derive(Clone, Copy, Debug)]
pub struct Bundled {
    /// Name of the file.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

macro_rules! bundled {
    ($($name:literal),* $(,)?) => {
        /// All bundled scenes of `scenes/mirrors`.
        pub const SCENES: &[Bundled] =
            &[$(Bundled { name: $name, text: include_str!(concat!("../../../scenes/mirrors/", $name)) }),*];
    };
}

bundled!(
    "balls.toml",
    "bodies.toml",
    "egg.toml",
    "hall.toml",
    "lens.toml",
    "maps.toml",
    "planar.toml",
    "raised.toml",
    "tank.toml",
);

/// A system of the notes with its scenes.
#[derive(Clone, Copy, Debug)]
pub struct System {
    /// Its name.
    pub name: &'static str,
    /// Level of the reflection axis.
    pub reflection: Reflection,
    /// Stand-in for the surroundings.
    pub proxy: Proxy,
    /// Level of the refraction axis.
    pub refraction: RefractionModel,
    /// Names of its scenes.
    pub scenes: [&'static str; 2],
    /// The reason why it fails where it does.
    pub why: &'static str,
}

const TRACED: System = System {
    name: "",
    reflection: Reflection::Traced,
    proxy: Proxy::None,
    refraction: RefractionModel::Stable,
    scenes: ["maps.toml", "balls.toml"],
    why: "",
};

/// All systems, each with two scenes.
pub const SYSTEMS: [System; 9] = [
    System {
        name: "planar mirrors by matrix",
        reflection: Reflection::Planar,
        scenes: ["planar.toml", "hall.toml"],
        why: "Nothing fails but rounding at edges. Mirrors that are seen in curved mirrors or through glass are traced.",
        ..TRACED
    },
    System {
        name: "cube maps",
        reflection: Reflection::CubeMap,
        why: "A map knows directions and no places. What is near the reflector is seen at an angle that is off by up to the \
              reflector's radius over the distance. A reflector does not see itself.",
        ..TRACED
    },
    System {
        name: "cube maps with a box for the surroundings",
        reflection: Reflection::CubeMap,
        proxy: Proxy::Box,
        why: "The box is right for the walls of a room with the axes of the scene. Things before the walls are off by their \
              distance from the box.",
        ..TRACED
    },
    System {
        name: "cube maps with a sphere for the surroundings",
        reflection: Reflection::CubeMap,
        proxy: Proxy::Sphere,
        why: "One radius stands for all distances. What is nearer or farther is off by the difference.",
        ..TRACED
    },
    System {
        name: "sphere maps",
        reflection: Reflection::SphereMap,
        why: "As a cube map. Texels are stretched towards the rim of the map, which is one single direction.",
        ..TRACED
    },
    System {
        name: "virtual scenes of curved reflectors",
        reflection: Reflection::Virtual,
        scenes: ["balls.toml", "egg.toml"],
        why: "Edges between corners of the virtual scene are straight and not curved, most near the outline of the reflector. \
              What a reflector shows in other reflectors is traced.",
        ..TRACED
    },
    System {
        name: "raised objects",
        refraction: RefractionModel::Raised,
        scenes: ["raised.toml", "tank.toml"],
        why: "Exact along the normal. Elsewhere the tangent of the angle, and not its sine, changes by the ratio of indices. It \
              knows no total reflection.",
        ..TRACED
    },
    System {
        name: "maps after one bend",
        refraction: RefractionModel::MapOne,
        scenes: ["bodies.toml", "lens.toml"],
        why: "The way out of the body is left out: a lens shows an upright image, and a slab moves what is behind it.",
        ..TRACED
    },
    System {
        name: "maps after two bends",
        refraction: RefractionModel::MapTwo,
        scenes: ["bodies.toml", "lens.toml"],
        why: "The map knows directions and no places, light that is reflected inside the body ends, and the back side is taken \
              from where the straight line meets it.",
        ..TRACED
    },
];

impl System {
    /// Returns the options of a render by it.
    #[must_use]
    pub fn options(&self, threads: usize) -> Options {
        let &Self { reflection, proxy, refraction, .. } = self;
        Options { reflection, proxy, refraction, threads, ..Options::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_system_has_two_scenes_that_are_bundled_and_every_scene_a_system() {
        let known = |name: &str| SCENES.iter().any(|scene| scene.name == name);
        for system in &SYSTEMS {
            assert!(system.scenes.into_iter().all(known) && system.scenes[0] != system.scenes[1], "{}", system.name);
            assert!(system.why.ends_with('.'), "{}", system.name);
        }
        for scene in SCENES {
            assert!(SYSTEMS.iter().any(|system| system.scenes.contains(&scene.name)), "{}", scene.name);
        }
    }
}
