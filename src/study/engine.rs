//! Rendering of variants.

use std::time::Instant;

use super::axis::{Precision, Spheres};
use super::spheres::with_spheres;
use super::variant::Variant;
use crate::Result;
use crate::accel::reference::Reference;
use crate::accel::walk::{TestCounts, Walk};
use crate::accel::{Accel, Backend, BuildOptions, BuildQuality, Intersector, Unbounded};
use crate::geometry::triangle_test::TriangleModel;
use crate::render::reference::{self, Prepared};
use crate::render::{Observer, Options, Outcome, render};
use crate::scene::Scene;
use crate::simd::ReciprocalModel;

/// Picture and its cost.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Picture, with the counts of its render.
    pub outcome: Outcome,
    /// Wall time of the render, without building the hierarchy.
    pub seconds: f64,
    /// Wall time of building the hierarchy, in this render or the first one that used it.
    pub build_seconds: f64,
    /// Numbers of triangle tests, if the single-ray walk found the hits.
    pub lanes: Option<TestCounts>,
}

/// Renderer of one scene that keeps hierarchies between pictures.
#[derive(Debug)]
pub struct Engine<'a> {
    scene: &'a Scene,
    threads: usize,
    /// One stage for each tessellation and each way to build that was used.
    stages: Vec<Stage>,
}

#[derive(Debug)]
struct Stage {
    spheres: Spheres,
    bvh: BuildQuality,
    scene: Scene,
    accels: Kept<Backend, Accel>,
    walks: Kept<(TriangleModel, ReciprocalModel), Unbounded<Walk>>,
}

/// Hierarchies with the choice that each was built for.
type Kept<K, I> = Vec<(K, Built<I>)>;

/// Hierarchy and the seconds that building it took.
struct Built<I> {
    accel: I,
    seconds: f64,
}

impl<I> std::fmt::Debug for Built<I> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("Built").field("seconds", &self.seconds).finish_non_exhaustive()
    }
}

impl<'a> Engine<'a> {
    /// Creates an engine for pictures of `scene`, of the size in its settings, by `threads` threads (0: one per
    /// processor).
    #[must_use]
    pub fn new(scene: &'a Scene, threads: usize) -> Self {
        Self { scene, threads, stages: Vec::new() }
    }

    /// Renders the picture of a variant.
    ///
    /// # Errors
    /// `Interrupted`; a limit, if the back end is not available.
    pub fn shoot(&mut self, variant: &Variant, observer: &Observer) -> Result<Shot> {
        let options = variant.options(self.threads);
        let threads = self.threads;
        let stage = self.stage(variant);
        stage.scene.settings = variant.settings(&stage.scene.settings);
        let Stage { scene, accels, walks, .. } = stage;
        if let Some((test, reciprocal)) = variant.walk() {
            let built = built(walks, (test, reciprocal), || {
                let walk = Walk::try_build(&scene.geometry, variant.bvh, test, reciprocal)?;
                Ok(Unbounded::new(walk, &scene.geometry))
            })?;
            let before = built.accel.inner().test_counts();
            let shot = timed(scene, built, &options, observer)?;
            return Ok(Shot { lanes: Some(built.accel.inner().test_counts().since(before)), ..shot });
        }
        match variant.precision {
            Precision::Double => {
                let start = Instant::now();
                Reference::need(&scene.geometry)?;
                let prepared = Prepared::complete(scene, &options, observer)?;
                let build_seconds = start.elapsed().as_secs_f64();
                let start = Instant::now();
                let outcome = reference::picture(&prepared, &options, observer)?;
                Ok(Shot { outcome, seconds: start.elapsed().as_secs_f64(), build_seconds, lanes: None })
            }
            Precision::Single => {
                let build = BuildOptions { quality: variant.bvh, threads };
                let built = built(accels, variant.backend, || Accel::build(variant.backend, &scene.geometry, build))?;
                timed(scene, built, &options, observer)
            }
        }
    }

    fn stage(&mut self, &Variant { spheres, bvh, .. }: &Variant) -> &mut Stage {
        let place = self.stages.iter().position(|s| (s.spheres, s.bvh) == (spheres, bvh)).unwrap_or_else(|| {
            let scene = with_spheres(self.scene, spheres);
            self.stages.push(Stage { spheres, bvh, scene, accels: Vec::new(), walks: Vec::new() });
            self.stages.len() - 1
        });
        &mut self.stages[place]
    }
}

/// Returns the hierarchy kept under `key`; builds it first if there is none.
fn built<K: PartialEq, I>(kept: &mut Kept<K, I>, key: K, build: impl FnOnce() -> Result<I>) -> Result<&Built<I>> {
    let place = match kept.iter().position(|(of, _)| *of == key) {
        Some(place) => place,
        None => {
            let start = Instant::now();
            let accel = build()?;
            kept.push((key, Built { accel, seconds: start.elapsed().as_secs_f64() }));
            kept.len() - 1
        }
    };
    Ok(&kept[place].1)
}

fn timed<I: Intersector>(scene: &Scene, built: &Built<I>, options: &Options, observer: &Observer) -> Result<Shot> {
    let start = Instant::now();
    let outcome = render(scene, &built.accel, options, observer)?;
    Ok(Shot { outcome, seconds: start.elapsed().as_secs_f64(), build_seconds: built.seconds, lanes: None })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::native::Native;
    use crate::geometry::{Geometry, GeometryMask, Shape};
    use crate::load::shapes;
    use crate::scene::{Material, Medium, Object, Origin, Settings};

    #[test]
    fn every_hierarchy_is_built_as_the_variant_says_and_kept_apart() {
        // Large enough that each quality builds a different tree.
        let ball = Geometry { shape: Shape::Mesh(shapes::sphere(40)), mask: GeometryMask::OPAQUE };
        let scene = Scene {
            geometry: vec![ball],
            objects: vec![Object { name: String::new(), material: 0, origin: Origin::default() }],
            materials: vec![Material::black("black")],
            media: vec![Medium::air()],
            settings: Settings { width: 2, height: 2, samples: 1, ..Settings::default() },
            ..Scene::default()
        };
        let mut engine = Engine::new(&scene, 1);
        let default = Variant::of(&scene.settings, Backend::Native);
        for bvh in BuildQuality::ALL.into_iter().chain(BuildQuality::ALL) {
            for triangles in [None, Some(TriangleModel::Watertight)] {
                engine.shoot(&Variant { bvh, triangles, ..default }, &Observer::default()).unwrap();
            }
        }
        let want = BuildQuality::ALL.map(|bvh| Native::build_as(&scene.geometry, bvh).build_stats().nodes);
        let native = |s: &Stage| s.accels[0].1.accel.build_stats().nodes;
        let walk = |s: &Stage| s.walks[0].1.accel.build_stats().nodes;
        assert_eq!(engine.stages.iter().map(native).collect::<Vec<_>>(), want);
        assert_eq!(engine.stages.iter().map(walk).collect::<Vec<_>>(), want);
        assert!(want[0] != want[1] && want[1] != want[2] && want[2] != want[0], "{want:?}");
    }
}
