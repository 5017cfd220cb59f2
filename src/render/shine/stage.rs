//! Light stages of what shines beside lamps, in eight lanes.

use super::{Around, Emitters, Shiner};
use crate::math::{Real, Vector3};
use crate::render::base::Base8;
use crate::render::light::lobe;
use crate::render::pattern::Scramble;
use crate::render::queue::{Rgb8, Spawn8};
use crate::render::shading::Shading;
use crate::render::sky::{Any, Sky};
use crate::render::soft::{SoftStages, surfaces_at_once};
use crate::render::surface::Surface8;
use crate::scene::{Rgb, Scene};
use crate::simd::{F32x8, Vec3x8, set_lanes};

/// Returns the stages of the sources that light surfaces, with their numbers. With `all`, those of all sources.
pub fn stages(scene: &Scene, all: bool) -> impl Iterator<Item = (usize, SoftStages)> {
    let shining = scene.shining();
    let wanted = [shining.emitters(), shining.sky];
    let stages = move |kind: Shiner| {
        let surfaces = surfaces_at_once(&scene.settings.lamps);
        let shadows = scene.settings.shine_shadows;
        match kind {
            Shiner::Emitters => {
                SoftStages { shadows, unoccluded: unoccluded::<Emitters>, shadowed: shadowed::<Emitters>, surfaces }
            }
            Shiner::Around => {
                SoftStages { shadows, unoccluded: unoccluded::<Around>, shadowed: shadowed::<Around>, surfaces }
            }
        }
    };
    let kinds = Shiner::ALL.into_iter().zip(wanted).filter(move |&(_, wanted)| all || wanted);
    kinds.map(move |(kind, _)| (kind.number(scene), stages(kind)))
}

/// Light of one sample at eight shaded points.
struct Arriving {
    dir: Vec3x8,
    distance: F32x8,
    /// Radiance times the solid angle that the sample stands for.
    light: Rgb8,
    lanes: u8,
}

/// Source that shines beside lamps.
trait Source {
    /// True if highlights answer to it.
    const SHINY: bool;

    /// Returns the source, if the scene is lit by it.
    fn of<'a>(shading: &Shading<'a>) -> Option<&'a Self>;

    /// Returns the light of a sample, by its place in the unit cube for each lane in `lanes`.
    fn arriving(&self, scene: &Scene, surface: &Surface8, origin: Vec3x8, at: [[f32; 3]; 8]) -> Arriving;
}

impl Source for Emitters {
    const SHINY: bool = true;

    fn of<'a>(shading: &Shading<'a>) -> Option<&'a Self> {
        shading.shine?.emitters.as_ref()
    }

    fn arriving(&self, _: &Scene, surface: &Surface8, origin: Vec3x8, at: [[f32; 3]; 8]) -> Arriving {
        let zero = Vec3x8::splat(Rgb::ZERO);
        let mut arriving = Arriving { dir: zero, distance: F32x8::ONE, light: zero, lanes: 0 };
        for lane in set_lanes(surface.base_lanes) {
            let (from, normal) = (origin.lane(lane), surface.shading.lane(lane));
            let seen = (from.as_dvec3(), normal.as_dvec3());
            if let Some(glint) = self.sample::<f32>(from.into(), seen, at[lane]) {
                arriving.dir.set_lane(lane, glint.dir.into());
                arriving.distance.set_lane(lane, glint.distance);
                arriving.light.set_lane(lane, glint.light.into());
                arriving.lanes |= 1 << lane;
            }
        }
        arriving
    }
}

impl Source for Around {
    const SHINY: bool = false;

    fn of<'a>(shading: &Shading<'a>) -> Option<&'a Self> {
        shading.shine?.around.as_ref()
    }

    fn arriving(&self, scene: &Scene, surface: &Surface8, _: Vec3x8, at: [[f32; 3]; 8]) -> Arriving {
        let mut dir = Vec3x8::splat(glam::Vec3::Y);
        let mut solid = F32x8::ZERO;
        for lane in set_lanes(surface.base_lanes) {
            let normal = Vector3::<f32>::from(surface.shading.lane(lane));
            let ray = self.sample(normal, at[lane], |dir| glam::Vec3::from(dir).as_dvec3());
            dir.set_lane(lane, ray.dir.into());
            solid.set_lane(lane, ray.solid);
        }
        let seen = Any::radiance(&scene.environment, &scene.textures, &dir);
        let lanes = solid.gt(F32x8::ZERO).bits() & surface.base_lanes;
        Arriving { dir, distance: F32x8::INFINITY, light: seen * solid, lanes }
    }
}

/// One source and the points of eight lanes that it may light.
struct Shine8<'a> {
    surface: &'a Surface8,
    base: &'a Base8,
    origin: Vec3x8,
    scrambles: [Scramble; 8],
}

impl<'a> Shine8<'a> {
    fn new(shading: &Shading, number: usize, surface: &'a Surface8, base: &'a Base8, depth: usize) -> Self {
        let scramble = |p| shading.points.scramble(shading.film_pixel(p), depth as u32, number as u32);
        Self { surface, base, origin: surface.above(), scrambles: surface.pixel.map(scramble) }
    }

    /// Returns the light that the surfaces reflect of a sample: directions, distances, light, and the lanes that it reaches if
    /// unoccluded.
    fn sent<S: Source>(&self, shading: &Shading, source: &S, i: u32) -> Arriving {
        let Self { surface, base, origin, scrambles } = self;
        let at = shading.points.in_cubes(*scrambles, shading.sample, i);
        let arriving = source.arriving(shading.scene, surface, *origin, at);
        let dir = arriving.dir;
        let cos = dir.dot(surface.shading);
        let facing = cos.gt(F32x8::ZERO) & dir.dot(surface.normal).gt(F32x8::ZERO);
        let mut sent = base.diffuse * (cos * F32x8::splat(std::f64::consts::FRAC_1_PI));
        if S::SHINY && base.shiny.bits() != 0 {
            let bright = sent + base.highlight * lobe(base, surface, dir);
            sent = Vec3x8::select(base.shiny, bright, sent);
        }
        let share = F32x8::splat(1.0 / f64::from(shading.points.count()));
        let light = sent.times(arriving.light * share).times(surface.base_weight);
        let zero = light.x.eq(F32x8::ZERO) & light.y.eq(F32x8::ZERO) & light.z.eq(F32x8::ZERO);
        let lanes = arriving.lanes & facing.bits() & surface.base_lanes & !zero.bits();
        Arriving { light, lanes, ..arriving }
    }
}

fn unoccluded<S: Source>(shading: &mut Shading, number: usize, surfaces: &[Surface8], bases: &[Base8], depth: usize) {
    let Some(source) = S::of(shading) else { return };
    for (surface, base) in surfaces.iter().zip(bases).filter(|(_, base)| base.lit) {
        let shine = Shine8::new(shading, number, surface, base, depth);
        for i in 0..shading.points.count() {
            let sent = shine.sent(shading, source, i);
            shading.accumulator.add_light8(sent.lanes, &surface.pixel, &sent.light);
        }
    }
}

fn shadowed<S: Source>(shading: &mut Shading, number: usize, surfaces: &[Surface8], bases: &[Base8], depth: usize) {
    let Some(source) = S::of(shading) else { return };
    for (surface, base) in surfaces.iter().zip(bases).filter(|(_, base)| base.lit) {
        let shine = Shine8::new(shading, number, surface, base, depth);
        for i in 0..shading.points.count() {
            let sent = shine.sent(shading, source, i);
            if sent.lanes == 0 {
                continue;
            }
            let (origin, t_max, admits) = (shine.origin, sent.distance, shading.shadow_admits);
            let new = Spawn8 { origin, t_max, admits, ..surface.reflected(sent.dir, sent.light) };
            shading.shadows.push8(sent.lanes, &new);
        }
    }
}
