//! The pipeline of a render: which function each stream of rays goes through at each stage, picked once.
//!
//! Every stage is specialised over its own few choices only, so that the choices of different stages add up instead of
//! multiplying, and knows no accelerator, so that all back ends share its code. What no surface of a bin, no light or
//! no medium calls for is not in the functions that its streams go through.

use super::base::{self, BaseStage};
use super::class::{BINS, Class, bin_has_base, bin_of, class_of};
use super::light::{self, LightStage};
use super::medium::{self, MediumStage};
use super::options::Options;
use super::outcome::Stage;
use super::sky::{self, MissStage};
use super::soft::{self, SoftStages};
use super::split::{self, SplitStage};
use super::surface::{self, GatherStage, Shapes};
use super::through::{self, FinishStage, PassStage};
use crate::effects::{Pipeline, Reach};
use crate::geometry::GeometryMask;
use crate::optics::{FresnelModel, RefractionModel};
use crate::scene::{Colour, Light, Material, Rgb, Scene, ShadowRule};

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
    /// What rays see that meet nothing; none where that is black.
    pub miss: Option<MissStage>,
    /// True if surfaces touch, so that hits are looked up among them.
    pub touching: bool,
    /// Whether rays carry extras.
    pub carries: bool,
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
    pub split: Option<(Stage, SplitStage)>,
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
    /// The functions that a scene calls for: those for what rays can reach, or under [`Pipeline::All`] those that know
    /// everything. `eye_media` are the media around the eye.
    #[must_use]
    pub fn of(scene: &Scene, reach: &Reach, eye_media: &[u32], touching: bool, options: &Options) -> Self {
        let all = options.effects.pipeline == Pipeline::All;
        let touching = touching || all;
        let call = Call { scene, reach, options, all, touching, missed: &reach.unmet };
        let shadows = Call { missed: &reach.sealed, ..call };
        let absorbs = |m: u32| scene.media[m as usize].absorption != Rgb::ZERO;
        let around = all || absorbs(0) || eye_media.iter().any(|&m| absorbs(m));
        let absorbing = around || call.media().any(absorbs);
        let absorbing_shadows = around || shadows.media().any(absorbs);
        let transmissive = |o: usize| scene.geometry[o].mask.meets(GeometryMask::TRANSMISSIVE);
        let through = all || absorbing_shadows || shadows.objects().any(transmissive);
        let march = (through && scene.settings.shadows == ShadowRule::Straight).then(|| March {
            gather: surface::pick(shadows.shapes(transmissive)),
            pass: through::pick(options.fresnel, absorbing_shadows, touching),
            finish: absorbing_shadows.then_some(through::finish as FinishStage),
        });
        Self {
            refraction: options.bending(),
            medium: absorbing.then_some(medium::absorb as MediumStage),
            miss: if call.all { Some(sky::pick_any()) } else { sky::pick(&scene.environment) },
            touching,
            carries: options.fresnel == FresnelModel::Polarised || options.cutoff_error.is_some(),
            bins: std::array::from_fn(|bin| call.bin(bin)),
            shadow_admits: if march.is_some() { GeometryMask::OPAQUE } else { GeometryMask::ALL },
            march,
        }
    }
}

/// What a render calls for.
#[derive(Clone, Copy)]
struct Call<'a> {
    scene: &'a Scene,
    reach: &'a Reach,
    options: &'a Options,
    all: bool,
    /// True if surfaces touch.
    touching: bool,
    /// By object: whether no ray of the kind that is looked at meets it.
    missed: &'a [bool],
}

impl<'a> Call<'a> {
    /// Objects that rays can meet.
    fn objects(self) -> impl Iterator<Item = usize> {
        (0..self.scene.objects.len()).filter(move |&o| self.all || !self.missed[o])
    }

    fn material(self, object: usize) -> &'a Material {
        &self.scene.materials[self.scene.objects[object].material as usize]
    }

    /// Media that rays can get into.
    fn media(self) -> impl Iterator<Item = u32> {
        self.objects().filter_map(move |o| self.scene.medium_of(o))
    }

    /// The shapes of some objects.
    fn shapes(self, of: impl Fn(usize) -> bool) -> Shapes {
        let mut shapes = if self.all { Shapes::ALL } else { Shapes::default() };
        self.objects().filter(|&o| of(o)).for_each(|o| shapes.add(&self.scene.geometry[o].shape));
        shapes
    }

    /// The stages of a bin.
    fn bin(self, bin: usize) -> Option<BinStages> {
        let (scene, all) = (self.scene, self.all);
        let here = |o: usize| bin_of(self.material(o)) == bin;
        let materials: Vec<&Material> = self.objects().filter(|&o| here(o)).map(|o| self.material(o)).collect();
        if materials.is_empty() && !all {
            return None;
        }
        let split = split::pick(class_of(bin), scene, self.options, self.touching);
        let (mut base, mut lights, mut lamps) = (None, Vec::new(), Vec::new());
        if bin_has_base(bin) {
            let any = |of: &dyn Fn(&Material) -> bool| all || materials.iter().any(|m| of(m));
            let textured = any(&|m| !matches!(m.diffuse, Colour::Constant(_)));
            let shiny = any(&|m| m.highlight.is_some());
            let glowing = any(&|m| m.emission != Rgb::ZERO || m.ambient * scene.ambient != Rgb::ZERO);
            if any(&Material::answers_light) {
                // A light without intensity adds nothing, and one that is walled in no more.
                let adds = |i: usize, l: &Light| l.intensity != Rgb::ZERO && !self.reach.dark[i];
                let shining = || scene.lights.iter().enumerate().filter(|&(i, l)| all || adds(i, l));
                lights = shining().filter_map(|(i, l)| Some((i, light::pick(l, shiny, all || l.shadows)?))).collect();
                let sampling = &scene.settings.lamps;
                lamps = shining().filter_map(|(i, l)| Some((i, soft::pick(l, shiny, sampling)?))).collect();
            }
            base = (glowing || !lights.is_empty() || !lamps.is_empty()).then(|| base::pick(textured, shiny, glowing));
        }
        let gather = surface::pick(self.shapes(here));
        let stage = match class_of(bin) {
            Class::Opaque => None,
            Class::Mirror | Class::MirrorOfEnvironment => Some(Stage::Mirror),
            Class::Conductor => Some(Stage::Conductor),
            Class::Dielectric => Some(Stage::Dielectric),
            Class::Thin => Some(Stage::Thin),
            Class::Coated => Some(Stage::Coated),
            Class::Alpha => Some(Stage::Alpha),
        };
        let split = stage.zip(split);
        (split.is_some() || base.is_some()).then_some(BinStages { gather, split, base, lights, lamps })
    }
}
