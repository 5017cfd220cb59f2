//! The pipeline of a render: which function each stream of rays goes through at each stage, picked once.
//!
//! Every stage is specialised over its own few choices only, so that the choices of different stages add up instead of
//! multiplying, and knows no accelerator, so that all back ends share its code. What no surface of a bin, no light or
//! no medium calls for is not in the functions that its streams go through.

use super::base::{self, BaseStage};
use super::class::{BINS, bin_has_base, bin_of, class_of};
use super::light::{self, LightStage};
use super::medium::{self, MediumStage};
use super::options::Options;
use super::sky::{self, MissStage};
use super::soft::{self, SoftStages};
use super::split::{self, SplitStage};
use super::surface::{self, GatherStage, Shapes};
use super::through::{self, FinishStage, PassStage};
use crate::geometry::GeometryMask;
use crate::optics::RefractionModel;
use crate::scene::{Colour, Material, Rgb, Scene, ShadowRule};

/// Hits that go through the stages of a bin at a time: enough to hide what calling a stage costs, few enough that their
/// surfaces stay in the first-level cache.
pub const STREAM: usize = 128;

/// The functions of one render.
#[derive(Clone, Debug)]
pub struct Stages {
    /// The formula that bends light, which the functions of `bins` have in them.
    pub refraction: RefractionModel,
    /// What media take; none where none takes anything.
    pub medium: Option<MediumStage>,
    /// What rays see that meet nothing.
    pub miss: MissStage,
    /// By bin; none where no object has such a surface, or nothing comes of meeting one.
    pub bins: [Option<BinStages>; BINS],
    /// What stops a shadow ray at once.
    pub shadow_admits: GeometryMask,
    /// How shadow rays pass what does not stop them; none where they meet nothing more.
    pub march: Option<March>,
}

/// The stages of one bin.
#[derive(Clone, Debug)]
pub struct BinStages {
    /// From hits to surfaces.
    pub gather: GatherStage,
    /// Secondary rays; none where there are none.
    pub split: Option<SplitStage>,
    /// Bases; none where there are none.
    pub base: Option<BaseStage>,
    /// Lights that bases answer to, by their numbers in the scene.
    pub lights: Vec<(usize, LightStage)>,
    /// Those of them that have an extent.
    pub lamps: Vec<(usize, SoftStages)>,
}

/// The stages of shadow rays that pass through transmissive surfaces.
#[derive(Clone, Copy, Debug)]
pub struct March {
    /// From hits to surfaces.
    pub gather: GatherStage,
    /// Through them.
    pub pass: PassStage,
    /// The last stretch; none where it takes nothing.
    pub finish: Option<FinishStage>,
}

impl Stages {
    /// The functions that a scene calls for.
    #[must_use]
    pub fn of(scene: &Scene, options: &Options) -> Self {
        let absorbing = scene.media.iter().any(|m| m.absorption != Rgb::ZERO);
        let transmissive = scene.geometry.iter().any(|g| g.mask.meets(GeometryMask::TRANSMISSIVE));
        let straight = scene.settings.shadows == ShadowRule::Straight && (transmissive || absorbing);
        let march = straight.then(|| March {
            gather: surface::pick(shapes(scene, |object| {
                scene.geometry[object].mask.meets(GeometryMask::TRANSMISSIVE)
            })),
            pass: through::pick(options.fresnel, absorbing),
            finish: absorbing.then_some(through::finish as FinishStage),
        });
        Self {
            refraction: options.refraction,
            medium: absorbing.then_some(medium::absorb as MediumStage),
            miss: sky::pick(&scene.environment),
            bins: std::array::from_fn(|bin| BinStages::of(bin, scene, options)),
            shadow_admits: if march.is_some() { GeometryMask::OPAQUE } else { GeometryMask::ALL },
            march,
        }
    }
}

impl BinStages {
    fn of(bin: usize, scene: &Scene, options: &Options) -> Option<Self> {
        let material_of = |object: usize| &scene.materials[scene.objects[object].material as usize];
        let here = |object: usize| bin_of(material_of(object)) == bin;
        let materials: Vec<&Material> = (0..scene.objects.len()).filter(|&o| here(o)).map(material_of).collect();
        if materials.is_empty() {
            return None;
        }
        let split = split::pick(class_of(bin), scene, options);
        let (mut base, mut lights, mut lamps) = (None, Vec::new(), Vec::new());
        if bin_has_base(bin) {
            let any = |of: fn(&Material) -> bool| materials.iter().any(|m| of(m));
            let textured = any(|m| !matches!(m.diffuse, Colour::Constant(_)));
            let shiny = any(|m| m.highlight.is_some());
            let glowing = materials.iter().any(|m| m.emission != Rgb::ZERO || m.ambient * scene.ambient != Rgb::ZERO);
            if any(base::answers_light) {
                let all = || scene.lights.iter().enumerate();
                lights = all().filter_map(|(i, l)| Some((i, light::pick(l, shiny, l.shadows)?))).collect();
                lamps = all().filter_map(|(i, l)| Some((i, soft::pick(l, shiny, &scene.settings.lamps)?))).collect();
            }
            base = (glowing || !lights.is_empty() || !lamps.is_empty()).then(|| base::pick(textured, shiny, glowing));
        }
        let gather = surface::pick(shapes(scene, here));
        (split.is_some() || base.is_some()).then_some(Self { gather, split, base, lights, lamps })
    }
}

/// The shapes of some objects.
fn shapes(scene: &Scene, of: impl Fn(usize) -> bool) -> Shapes {
    let mut shapes = Shapes::default();
    for (_, geometry) in scene.geometry.iter().enumerate().filter(|&(object, _)| of(object)) {
        shapes.add(&geometry.shape);
    }
    shapes
}
