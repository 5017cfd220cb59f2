//! Back ends to compare: native, and both modes of Embree if it is available.

use crate::Result;
use crate::accel::{Accel, Backend, BuildOptions, BuildQuality};
use crate::image::Film;
use crate::render::{Observer, Options, render};
use crate::scene::Scene;
use crate::trial::parity::{Answers, Set, ask};

/// The accelerators of all back ends over the same shapes, native first.
pub(super) struct Contenders {
    /// Quality of the hierarchies.
    pub bvh: BuildQuality,
    accels: Vec<Accel>,
    /// Reason why Embree is left out, if it is.
    pub left_out: Option<String>,
}

impl Contenders {
    /// Builds all accelerators over the shapes of `scene`.
    pub fn build(scene: &Scene, bvh: BuildQuality, threads: usize) -> Result<Self> {
        let build = |backend| Accel::build(backend, &scene.geometry, BuildOptions { quality: bvh, threads });
        let mut accels = vec![build(Backend::Native)?];
        let embree: Result<Vec<Accel>> = [Backend::Embree, Backend::EmbreeFast].into_iter().map(build).collect();
        let left_out = embree.map(|embree| accels.extend(embree)).err().map(|e| e.to_string());
        Ok(Self { bvh, accels, left_out })
    }

    /// Names, in order.
    pub fn names(&self) -> Vec<&'static str> {
        self.accels.iter().map(|accel| accel.backend().mode_name()).collect()
    }

    /// Answers of each contender to a set of rays.
    pub fn ask(&self, set: &Set) -> Vec<Answers> {
        self.accels.iter().map(|accel| ask(accel, &set.rays, set.coherence)).collect()
    }

    /// Pictures by each contender.
    ///
    /// # Errors
    /// As [`render`].
    pub fn films(&self, scene: &Scene, options: &Options, observer: &Observer) -> Result<Vec<Film>> {
        self.accels.iter().map(|accel| Ok(render(scene, accel, options, observer)?.film)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Intersector as _;
    use crate::accel::native::Native;
    use crate::error::Unavailable;
    use crate::geometry::{Geometry, GeometryMask, Shape};
    use crate::load::shapes;

    #[test]
    fn every_hierarchy_is_built_as_was_asked() {
        // Large enough that each quality builds a different tree.
        let ball = Geometry { shape: Shape::Mesh(shapes::sphere(40)), mask: GeometryMask::OPAQUE };
        let scene = Scene { geometry: vec![ball], ..Scene::default() };
        let built = BuildQuality::ALL.map(|bvh| Contenders::build(&scene, bvh, 1).unwrap());
        let nodes = [0, 1, 2].map(|i| built[i].accels[0].build_stats().nodes);
        assert_eq!(nodes, BuildQuality::ALL.map(|bvh| Native::build_as(&scene.geometry, bvh).build_stats().nodes));
        assert!(nodes[0] != nodes[1] && nodes[1] != nodes[2] && nodes[2] != nodes[0], "{nodes:?}");
        match Backend::Embree.availability() {
            Ok(()) => {
                // The spatial splits of its fast mode show in the bytes; LOW and MEDIUM take the same number.
                let bytes = [1, 2].map(|i| built[i].accels[2].build_stats().bytes);
                assert!(bytes[0] < bytes[1], "{bytes:?}");
            }
            Err(Unavailable::NotCompiledIn) => assert_eq!(built[0].names(), ["native"]),
            Err(why) => assert!(std::env::var_os("VITRUM_REQUIRE_EMBREE").is_none(), "{why}"),
        }
    }
}
