//! Who is compared: the native path, and Embree in both its modes where it is there.

use crate::Result;
use crate::accel::native::Native;
use crate::accel::{BuildQuality, Unbounded};
use crate::image::Film;
use crate::render::{Observer, Options, render};
use crate::scene::Scene;
use crate::trial::parity::{Answers, Set, ask};

/// The reason why Embree is left out of a build without it.
#[cfg(not(feature = "embree"))]
pub(super) const NOT_BUILT_IN: &str =
    "this program was built without it; `cargo build --release --features embree` builds one with it";

/// Every path over the same shapes, the native one first.
pub(super) struct Contenders {
    /// How they were built.
    pub bvh: BuildQuality,
    native: Unbounded<Native>,
    #[cfg(feature = "embree")]
    embree: Vec<(&'static str, Unbounded<crate::accel::embree::Embree>)>,
    /// Why Embree is not among them, where it is not.
    pub left_out: Option<String>,
}

impl Contenders {
    /// Builds all of them over the shapes of `scene`.
    pub fn build(scene: &Scene, bvh: BuildQuality, threads: usize) -> Result<Self> {
        let geometry = &scene.geometry;
        let native = Unbounded::new(Native::try_build_as(geometry, bvh)?, geometry);
        #[cfg(feature = "embree")]
        {
            let (embree, left_out) = match embree(scene, bvh, threads) {
                Ok(embree) => (embree, None),
                Err(e) => (Vec::new(), Some(e.to_string())),
            };
            Ok(Self { bvh, native, embree, left_out })
        }
        #[cfg(not(feature = "embree"))]
        {
            let _ = threads;
            Ok(Self { bvh, native, left_out: Some(NOT_BUILT_IN.into()) })
        }
    }

    /// Their names, in order.
    pub fn names(&self) -> Vec<&'static str> {
        #[cfg_attr(not(feature = "embree"), expect(unused_mut, reason = "Embree's names follow"))]
        let mut names = vec!["native"];
        #[cfg(feature = "embree")]
        names.extend(self.embree.iter().map(|(name, _)| *name));
        names
    }

    /// What each answers to a set of rays.
    pub fn ask(&self, set: &Set) -> Vec<Answers> {
        #[cfg_attr(not(feature = "embree"), expect(unused_mut, reason = "Embree's answers follow"))]
        let mut answers = vec![ask(&self.native, &set.rays, set.coherence)];
        #[cfg(feature = "embree")]
        answers.extend(self.embree.iter().map(|(_, accel)| ask(accel, &set.rays, set.coherence)));
        answers
    }

    /// The picture that each makes.
    ///
    /// # Errors
    /// As [`render`].
    pub fn films(&self, scene: &Scene, options: &Options, observer: &Observer) -> Result<Vec<Film>> {
        #[cfg_attr(not(feature = "embree"), expect(unused_mut, reason = "Embree's pictures follow"))]
        let mut films = vec![render(scene, &self.native, options, observer)?.film];
        #[cfg(feature = "embree")]
        for (_, accel) in &self.embree {
            films.push(render(scene, accel, options, observer)?.film);
        }
        Ok(films)
    }
}

#[cfg(feature = "embree")]
fn embree(
    scene: &Scene,
    bvh: BuildQuality,
    threads: usize,
) -> Result<Vec<(&'static str, Unbounded<crate::accel::embree::Embree>)>> {
    use crate::accel::embree::{Embree, Mode, Options};

    [("embree-robust", Mode::Robust), ("embree-fast", Mode::Fast)]
        .into_iter()
        .map(|(name, mode)| {
            let options = Options { mode, quality: bvh.into(), threads, ..Options::default() };
            Ok((name, Unbounded::new(Embree::build(&scene.geometry, &options)?, &scene.geometry)))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Intersector as _;
    use crate::geometry::{Geometry, GeometryMask, Shape};
    use crate::load::shapes;

    #[test]
    fn every_hierarchy_is_built_as_was_asked() {
        // Large enough that each quality makes another tree of it.
        let ball = Geometry { shape: Shape::Mesh(shapes::sphere(40)), mask: GeometryMask::OPAQUE };
        let scene = Scene { geometry: vec![ball], ..Scene::default() };
        let built = BuildQuality::ALL.map(|bvh| Contenders::build(&scene, bvh, 1).unwrap());
        let nodes = [0, 1, 2].map(|i| built[i].native.build_stats().nodes);
        assert_eq!(nodes, BuildQuality::ALL.map(|bvh| Native::build_as(&scene.geometry, bvh).build_stats().nodes));
        assert!(nodes[0] != nodes[1] && nodes[1] != nodes[2] && nodes[2] != nodes[0], "{nodes:?}");
        #[cfg(feature = "embree")]
        {
            if let Some(why) = &built[0].left_out {
                assert!(std::env::var_os("VITRUM_REQUIRE_EMBREE").is_none(), "{why}");
                return;
            }
            // The spatial splits of its fast mode show; LOW and MEDIUM take as many bytes.
            let bytes = [1, 2].map(|i| built[i].embree[1].1.build_stats().bytes);
            assert!(bytes[0] < bytes[1], "{bytes:?}");
        }
    }
}
