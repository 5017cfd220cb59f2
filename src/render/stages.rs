//! Stages of a render: the function that each stream of rays runs through at each stage, picked once.
//!
//! Each stage is specialised only over the few choices that concern it, so the numbers of variants add up instead of
//! multiplying. No stage depends on an accelerator, so all back ends share the code. Code for properties that no
//! surface of a bin, no light and no medium has is not part of the picked functions.

use super::base::{self, BaseStage};
use super::class::{BINS, Class, bin_has_base, bin_of, class_of};
use super::light::{self, LightStage};
use super::medium::{self, MediumStage};
use super::options::Options;
use super::outcome::Stage;
use super::shine;
use super::sky::{self, MissStage};
use super::soft::{self, SoftStages};
use super::split::{self, SplitStage};
use super::surface::{self, GatherStage, Shapes};
use super::through::{self, FinishStage, PassStage};
use crate::effects::{Pipeline, Reach};
use crate::geometry::GeometryMask;
use crate::optics::RefractionModel;
use crate::scene::{Colour, Light, Material, Rgb, Scene, ShadowRule};

/// Number of hits per stream: enough to hide the cost of calling a stage, few enough that the surfaces stay in the
/// first-level cache.
pub const STREAM: usize = 128;

/// Functions of one render.
#[derive(Clone, Debug)]
pub struct Stages {
    /// Refraction formula, which the functions of `bins` are specialised for.
    pub refraction: RefractionModel,
    /// Absorption. `None` if no medium absorbs.
    pub medium: Option<MediumStage>,
    /// Environment. `None` if it is black.
    pub miss: Option<MissStage>,
    /// True if surfaces touch, so that hits are looked up among them.
    pub touching: bool,
    /// True if rays carry extras.
    pub carries: bool,
    /// Stages by bin. `None` if no object has such a surface, or a hit on it has no effect.
    pub bins: [Option<BinStages>; BINS],
    /// Classes of geometry that block a shadow ray.
    pub shadow_admits: GeometryMask,
    /// Stages for shadow rays that pass transmissive surfaces. `None` if there is nothing to pass.
    pub march: Option<March>,
}

/// The stages of one bin.
#[derive(Clone, Debug)]
pub struct BinStages {
    /// Converts hits to surface points.
    pub gather: GatherStage,
    /// Emits secondary rays. `None` if there are none.
    pub split: Option<(Stage, SplitStage)>,
    /// Gathers bases. `None` if there are none.
    pub base: Option<BaseStage>,
    /// Light stages of the lights without extent that the bases reflect, with their indices in the scene.
    pub lights: Vec<(usize, LightStage)>,
    /// Light stages of the area lamps, with their indices in the scene, and of what else shines ([`shine::Shiner`]).
    pub lamps: Vec<(usize, SoftStages)>,
}

/// Stages of shadow rays that pass through transmissive surfaces.
#[derive(Clone, Copy, Debug)]
pub struct March {
    /// Converts hits to surface points.
    pub gather: GatherStage,
    /// Passes through the surfaces.
    pub pass: PassStage,
    /// Applies absorption on the last segment. `None` if no medium absorbs.
    pub finish: Option<FinishStage>,
}

impl Stages {
    /// Picks the functions that a scene needs. Normally these cover the surfaces that rays can reach; under
    /// [`Pipeline::All`] they cover every property. `eye_media` are the media around the eye.
    #[must_use]
    pub fn of(scene: &Scene, reach: &Reach, eye_media: &[u32], touching: bool, options: &Options) -> Self {
        let all = options.effects.pipeline == Pipeline::All;
        let touching = touching || all;
        let picker = StagePicker { scene, reach, options, all, touching, missed: &reach.unmet };
        let shadows = StagePicker { missed: &reach.sealed, ..picker };
        let absorbs = |m: u32| scene.media[m as usize].absorption != Rgb::ZERO;
        let around = all || absorbs(0) || eye_media.iter().any(|&m| absorbs(m));
        let absorbing = around || picker.media().any(absorbs);
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
            miss: if picker.all { Some(sky::pick_any()) } else { sky::pick(&scene.environment) },
            touching,
            carries: options.carries(),
            bins: std::array::from_fn(|bin| picker.bin(bin)),
            shadow_admits: if march.is_some() { GeometryMask::OPAQUE } else { GeometryMask::ALL },
            march,
        }
    }
}

/// Inputs for picking the stages.
#[derive(Clone, Copy)]
struct StagePicker<'a> {
    scene: &'a Scene,
    reach: &'a Reach,
    options: &'a Options,
    all: bool,
    /// True if surfaces touch.
    touching: bool,
    /// By object: true if rays of the given kind cannot hit it.
    missed: &'a [bool],
}

impl<'a> StagePicker<'a> {
    /// Returns the objects that rays can hit.
    fn objects(self) -> impl Iterator<Item = usize> {
        (0..self.scene.objects.len()).filter(move |&o| self.all || !self.missed[o])
    }

    fn material(self, object: usize) -> &'a Material {
        &self.scene.materials[self.scene.objects[object].material as usize]
    }

    /// Returns the media that rays can enter.
    fn media(self) -> impl Iterator<Item = u32> {
        self.objects().filter_map(move |o| self.scene.medium_of(o))
    }

    /// Returns the kinds of shape of the selected objects.
    fn shapes(self, of: impl Fn(usize) -> bool) -> Shapes {
        let mut shapes = if self.all { Shapes::ALL } else { Shapes::default() };
        for o in self.objects().filter(|&o| of(o)) {
            shapes.add(&self.scene.geometry[o].shape);
            shapes.relief |= self.material(o).relief.is_some();
        }
        shapes
    }

    /// Picks the stages of a bin.
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
            let textured = any(&|m| !matches!(m.diffuse, Colour::Constant(_)) || m.glow.is_some());
            let shiny = any(&|m| m.highlight.is_some());
            let glowing = any(&|m| m.emission != Rgb::ZERO || m.ambient * scene.ambient != Rgb::ZERO);
            if any(&Material::answers_light) {
                // A light of intensity 0, or one that is walled in, contributes nothing.
                let adds = |i: usize, l: &Light| l.intensity != Rgb::ZERO && !self.reach.dark[i];
                let by_itself = |&(i, l): &(usize, &Light)| (all || adds(i, l)) && !scene.is_sampled(l);
                let shining = || scene.lights.iter().enumerate().filter(by_itself);
                lights = shining().filter_map(|(i, l)| Some((i, light::pick(l, shiny, all || l.shadows)?))).collect();
                let sampling = &scene.settings.lamps;
                lamps = shining().filter_map(|(i, l)| Some((i, soft::pick(l, shiny, sampling)?))).collect();
                lamps.extend(shine::stages(scene, all));
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
