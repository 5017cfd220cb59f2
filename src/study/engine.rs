//! From a variant to its picture.

use std::time::Instant;

use super::axis::{Backend, Precision, Spheres};
use super::spheres::with_spheres;
use super::variant::Variant;
#[cfg(not(feature = "embree"))]
use crate::Error;
use crate::Result;
use crate::accel::native::Native;
use crate::accel::reference::Reference;
use crate::accel::walk::{TestCounts, Walk};
use crate::accel::{BuildQuality, Intersector, Unbounded};
use crate::geometry::triangle_test::TriangleModel;
use crate::render::reference::{self, Prepared};
use crate::render::{Observer, Options, Outcome, render};
use crate::scene::Scene;
use crate::simd::ReciprocalModel;

/// A picture, and how long it took.
#[derive(Clone, Debug)]
pub struct Shot {
    /// The picture and what was counted.
    pub outcome: Outcome,
    /// Wall time of the render, without building the hierarchy.
    pub seconds: f64,
    /// Wall time of building the hierarchy, now or the first time.
    pub build_seconds: f64,
    /// TestCounts of triangle tests, where a walk of choice found the hits.
    pub lanes: Option<TestCounts>,
}

/// Makes pictures of one scene, and keeps the hierarchies between them.
#[derive(Debug)]
pub struct Engine<'a> {
    scene: &'a Scene,
    threads: usize,
    /// One for each tessellation and each way to build that was asked for.
    stages: Vec<Stage>,
}

#[derive(Debug)]
struct Stage {
    spheres: Spheres,
    bvh: BuildQuality,
    scene: Scene,
    native: Option<Built<Native>>,
    /// By triangle test and reciprocal.
    walks: Vec<((TriangleModel, ReciprocalModel), Built<Walk>)>,
    #[cfg(feature = "embree")]
    fast: Option<Built<crate::accel::embree::Embree>>,
    #[cfg(feature = "embree")]
    robust: Option<Built<crate::accel::embree::Embree>>,
}

/// A hierarchy and the seconds that building it took.
struct Built<I> {
    accel: Unbounded<I>,
    seconds: f64,
}

impl<I> std::fmt::Debug for Built<I> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("Built").field("seconds", &self.seconds).finish_non_exhaustive()
    }
}

impl<'a> Engine<'a> {
    /// For pictures of `scene`, of the size that its settings have, by `threads` threads (0: one a processor).
    #[must_use]
    pub fn new(scene: &'a Scene, threads: usize) -> Self {
        Self { scene, threads, stages: Vec::new() }
    }

    /// The picture of a variant.
    ///
    /// # Errors
    /// `Interrupted`; a limit, where the back end is not there.
    pub fn shoot(&mut self, variant: &Variant, observer: &Observer) -> Result<Shot> {
        let options = variant.options(self.threads);
        let threads = self.threads;
        let stage = self.stage(variant);
        stage.scene.settings = variant.settings(&stage.scene.settings);
        if let Some(choice) = variant.walk() {
            return stage.walked(choice, &options, observer);
        }
        let Stage { scene, native, .. } = stage;
        match (variant.precision, variant.backend) {
            (Precision::Double, _) => {
                let start = Instant::now();
                Reference::need(&scene.geometry)?;
                let prepared = Prepared::with(scene, &options);
                let build_seconds = start.elapsed().as_secs_f64();
                let start = Instant::now();
                let outcome = reference::picture(&prepared, &options, observer)?;
                Ok(Shot { outcome, seconds: start.elapsed().as_secs_f64(), build_seconds, lanes: None })
            }
            (Precision::Single, Backend::Native) => {
                let native = built(native, scene, || Native::try_build_as(&scene.geometry, variant.bvh))?;
                timed(scene, native, &options, observer)
            }
            #[cfg(feature = "embree")]
            (Precision::Single, backend) => {
                use crate::accel::embree::{self, Embree, Mode};
                let (slot, mode) = match backend {
                    Backend::EmbreeFast => (&mut stage.fast, Mode::Fast),
                    _ => (&mut stage.robust, Mode::Robust),
                };
                let build =
                    embree::Options { mode, quality: variant.bvh.into(), threads, ..embree::Options::default() };
                let embree = built(slot, scene, || Embree::build(&scene.geometry, &build))?;
                timed(scene, embree, &options, observer)
            }
            #[cfg(not(feature = "embree"))]
            (Precision::Single, _) => {
                let _ = threads;
                Err(Error::Limit(String::from(
                    "this program was built without Embree; `cargo build --release --features embree` builds one with it",
                )))
            }
        }
    }

    fn stage(&mut self, &Variant { spheres, bvh, .. }: &Variant) -> &mut Stage {
        let place = self.stages.iter().position(|s| (s.spheres, s.bvh) == (spheres, bvh)).unwrap_or_else(|| {
            self.stages.push(Stage {
                spheres,
                bvh,
                scene: with_spheres(self.scene, spheres),
                native: None,
                walks: Vec::new(),
                #[cfg(feature = "embree")]
                fast: None,
                #[cfg(feature = "embree")]
                robust: None,
            });
            self.stages.len() - 1
        });
        &mut self.stages[place]
    }
}

impl Stage {
    fn walked(
        &mut self,
        choice: (TriangleModel, ReciprocalModel),
        options: &Options,
        observer: &Observer,
    ) -> Result<Shot> {
        let place = self.walks.iter().position(|(of, _)| *of == choice);
        let mut slot = place.map(|i| self.walks.swap_remove(i).1);
        let (test, reciprocal) = choice;
        let walk = built(&mut slot, &self.scene, || Walk::try_build(&self.scene.geometry, self.bvh, test, reciprocal))?;
        let before = walk.accel.inner().test_counts();
        let shot = timed(&self.scene, walk, options, observer);
        let lanes = walk.accel.inner().test_counts().since(before);
        self.walks.extend(slot.map(|walk| (choice, walk)));
        Ok(Shot { lanes: Some(lanes), ..shot? })
    }
}

/// Whether this program and this machine have what a back end needs.
///
/// # Errors
/// A limit that says what is missing.
pub fn available(backend: Backend) -> Result<()> {
    match backend {
        Backend::Native => Ok(()),
        #[cfg(feature = "embree")]
        _ => crate::accel::embree::device::Library::open(None).map(|_| ()),
        #[cfg(not(feature = "embree"))]
        _ => Err(Error::Limit(String::from("this program was built without Embree"))),
    }
}

fn built<'b, I>(
    slot: &'b mut Option<Built<I>>,
    scene: &Scene,
    build: impl FnOnce() -> Result<I>,
) -> Result<&'b Built<I>>
where
    I: Intersector,
{
    let kept = match slot.take() {
        Some(kept) => kept,
        None => {
            let start = Instant::now();
            let accel = Unbounded::new(build()?, &scene.geometry);
            Built { accel, seconds: start.elapsed().as_secs_f64() }
        }
    };
    Ok(slot.insert(kept))
}

fn timed<I: Intersector>(scene: &Scene, built: &Built<I>, options: &Options, observer: &Observer) -> Result<Shot> {
    let start = Instant::now();
    let outcome = render(scene, &built.accel, options, observer)?;
    Ok(Shot { outcome, seconds: start.elapsed().as_secs_f64(), build_seconds: built.seconds, lanes: None })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Geometry, GeometryMask, Shape};
    use crate::load::shapes;
    use crate::scene::{Material, Medium, Object, Origin, Settings};

    #[test]
    fn every_hierarchy_is_built_as_the_variant_says_and_kept_apart() {
        // Large enough that each quality makes another tree of it.
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
        let native = |s: &Stage| s.native.as_ref().map_or(0, |built| built.accel.build_stats().nodes);
        let walk = |s: &Stage| s.walks[0].1.accel.build_stats().nodes;
        assert_eq!(engine.stages.iter().map(native).collect::<Vec<_>>(), want);
        assert_eq!(engine.stages.iter().map(walk).collect::<Vec<_>>(), want);
        assert!(want[0] != want[1] && want[1] != want[2] && want[2] != want[0], "{want:?}");
    }
}
