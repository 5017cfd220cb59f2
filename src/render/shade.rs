//! Eight surfaces of one kind at a time: their bases and their secondary rays.

use glam::Vec3;

use super::direct;
use super::lookup::environment8;
use super::media::{StackId, Transition};
use super::outcome::RayKind;
use super::queue::{Rgb8, Spawn8};
use super::surface::Surface8;
use super::worker::{MOST_PASSES, Worker};
use crate::accel::Intersector;
use crate::geometry::GeometryMask;
use crate::math::{Real, Vector3};
use crate::optics::{Boundary, FresnelFormula, below_surface, reflect, thin_reflectance};
use crate::scene::{FresnelRule, Interface, Material, MirrorSource};
use crate::simd::{F32x8, Mask8, Vec3x8};

/// Kinds of surface that are shaded by different code. Hits are sorted into these, so that a packet holds one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    Opaque,
    Mirror,
    MirrorOfEnvironment,
    Conductor,
    Dielectric,
    Thin,
    Coated,
    Alpha,
}

impl Class {
    /// How many there are.
    pub const COUNT: usize = 8;

    /// The kind of a material.
    #[must_use]
    pub fn of(material: &Material) -> Self {
        match material.interface {
            Interface::Opaque => Self::Opaque,
            Interface::Mirror { source: MirrorSource::Traced, .. } => Self::Mirror,
            Interface::Mirror { source: MirrorSource::Environment, .. } => Self::MirrorOfEnvironment,
            Interface::Conductor { .. } => Self::Conductor,
            Interface::Dielectric { .. } => Self::Dielectric,
            Interface::ThinDielectric { .. } => Self::Thin,
            Interface::Coated { .. } => Self::Coated,
            Interface::Alpha { .. } => Self::Alpha,
        }
    }
}

const WHITE: Vec3x8 = Vector3::new(F32x8::ONE, F32x8::ONE, F32x8::ONE);

impl<I: Intersector> Worker<'_, I> {
    /// Shades eight surfaces of one class, found by rays of depth `depth`.
    pub(super) fn shade<F: FresnelFormula>(&mut self, class: Class, surface: &Surface8, depth: usize) {
        match class {
            Class::Opaque => self.base(surface, surface.active, WHITE),
            Class::Mirror | Class::MirrorOfEnvironment => self.mirror(class, surface, depth),
            Class::Conductor => self.conductor::<F>(surface, depth),
            Class::Dielectric => self.dielectric::<F>(surface, depth),
            Class::Thin => self.thin::<F>(surface, depth),
            Class::Coated => self.coated::<F>(surface, depth),
            Class::Alpha => self.alpha(surface, depth),
        }
    }

    fn material(&self, surface: &Surface8, k: usize) -> &Material {
        &self.scene.materials[surface.material[k] as usize]
    }

    /// A colour per lane from its material's interface.
    fn gather(&self, surface: &Surface8, colour: impl Fn(&Interface) -> Vec3) -> Rgb8 {
        let mut out = Vec3x8::splat(Vec3::ZERO);
        for k in 0..8 {
            out.set_lane(k, colour(&self.material(surface, k).interface));
        }
        out
    }

    fn base(&mut self, surface: &Surface8, lanes: u8, share: Rgb8) {
        if (0..8).any(|k| self.has_base[surface.material[k] as usize]) {
            let admits = self.shadow_admits;
            direct::shade_base(self.scene, surface, lanes, share, &mut self.accumulator, &mut self.shadows, admits);
        }
    }

    fn mirror(&mut self, class: Class, surface: &Surface8, depth: usize) {
        self.base(surface, surface.active, WHITE);
        let reflectance = self.gather(surface, |i| match i {
            Interface::Mirror { reflectance, .. } => *reflectance,
            _ => Vec3::ZERO,
        });
        let dir = reflect(surface.incident, surface.shading);
        let weight = surface.weight.times(reflectance);
        if class == Class::Mirror {
            self.reflected(surface, surface.active, dir, weight, depth);
        } else {
            let seen = environment8(&self.scene.environment, &self.scene.textures, &dir);
            self.accumulator.add_radiance8(surface.active, &surface.pixel, &seen.times(weight));
        }
    }

    fn conductor<F: FresnelFormula>(&mut self, surface: &Surface8, depth: usize) {
        self.base(surface, surface.active, WHITE);
        // A metal's index counts relative to what the light comes through.
        let outside = F32x8::from_fn(|k| self.media.ior(surface.stack[k]) as f32);
        let relative = F32x8::ONE / outside;
        let eta = self.gather(surface, |i| if let Interface::Conductor { eta, .. } = i { *eta } else { Vec3::ONE });
        let k = self.gather(surface, |i| if let Interface::Conductor { k, .. } = i { *k } else { Vec3::ZERO });
        let cos_i = -surface.incident.dot(surface.shading);
        let reflectance = F::conductor_rgb(cos_i, eta * relative, k * relative);
        let dir = reflect(surface.incident, surface.shading);
        self.reflected(surface, surface.active, dir, surface.weight.times(reflectance), depth);
    }

    fn coated<F: FresnelFormula>(&mut self, surface: &Surface8, depth: usize) {
        let reflected = Vec3x8::all(self.interface_reflectance::<F>(surface).0);
        self.base(surface, surface.active, WHITE - reflected);
        let dir = reflect(surface.incident, surface.shading);
        self.reflected(surface, surface.active, dir, surface.weight.times(reflected), depth);
    }

    fn thin<F: FresnelFormula>(&mut self, surface: &Surface8, depth: usize) {
        self.base(surface, surface.active, WHITE);
        let (face, total) = self.interface_reflectance::<F>(surface);
        let reflected = self.ruled(surface, Vec3x8::all(thin_reflectance(face)), total);
        let tint =
            self.gather(surface, |i| if let Interface::ThinDielectric { tint, .. } = i { *tint } else { Vec3::ONE });
        let dir = reflect(surface.incident, surface.shading);
        self.reflected(surface, surface.active, dir, surface.weight.times(reflected), depth);
        let weight = surface.weight.times(WHITE - reflected).times(tint);
        self.straight_on(surface, surface.active, weight, depth);
    }

    fn alpha(&mut self, surface: &Surface8, depth: usize) {
        let opacity =
            self.gather(surface, |i| Vec3::splat(if let Interface::Alpha { opacity } = i { *opacity } else { 1.0 }));
        self.base(surface, surface.active, opacity);
        self.straight_on(surface, surface.active, surface.weight.times(WHITE - opacity), depth);
    }

    fn dielectric<F: FresnelFormula>(&mut self, surface: &Surface8, depth: usize) {
        let mut transitions = [None::<Transition>; 8];
        for (k, slot) in transitions.iter_mut().enumerate() {
            if let Interface::Dielectric { medium, .. } = self.material(surface, k).interface {
                let crossing = self.media.cross(surface.stack[k], medium, surface.front.lane(k));
                self.unmatched_exits += u64::from(crossing.unmatched && surface.active >> k & 1 != 0);
                *slot = Some(crossing);
            }
        }
        let beyond = transitions.map(|t| t.map_or(StackId::default(), |t| t.beyond));
        let real = Mask8::from_bits(lane_bits(|k| transitions[k].is_some_and(|t| t.real)));

        let absent = surface.active & !real.bits();
        if absent != 0 {
            self.pass(surface, absent, &beyond, depth);
        }
        let lanes = surface.active & real.bits();
        if lanes == 0 {
            return;
        }
        self.base(surface, lanes, WHITE);

        let boundary = gather_boundaries(|k| transitions[k].map_or(Boundary::new(1.0, 1.0), |t| t.boundary));
        let cos_i = -surface.incident.dot(surface.shading);
        let at = boundary.cross(cos_i);
        let reflectance = F::dielectric(&boundary, &at);
        let reflected = self.ruled(surface, Vec3x8::all(reflectance), at.total);
        let tint = self.gather(surface, |i| if let Interface::Dielectric { tint, .. } = i { *tint } else { Vec3::ONE });

        let dir = reflect(surface.incident, surface.shading);
        self.reflected(surface, lanes, dir, surface.weight.times(reflected), depth);

        let refracting = lanes & !at.total.bits();
        if refracting != 0 {
            let dir = boundary.refract(surface.incident, surface.shading, &at);
            let dir = dir.normalized();
            let dir = Vec3x8::select(surface.interpolated, below_surface(dir, surface.normal), dir);
            // Light that is not bent at all stays so to the bit.
            let straight = boundary.kc.eq(F32x8::ZERO);
            let dir = Vec3x8::select(straight, surface.incident, dir);
            let weight = surface.weight.times(WHITE - reflected).times(tint);
            let new = Spawn8 {
                origin: surface.below(),
                dir,
                t_max: F32x8::INFINITY,
                admits: GeometryMask::ALL,
                weight,
                pixel: &surface.pixel,
                stack: &beyond,
                lead: surface.lead(dir),
                passes: &[0; 8],
            };
            self.spawn(refracting, &new, RayKind::Transmitted, depth);
        }
    }

    /// Fresnel reflectance of coats and panes (one face, from the medium the ray is in), and where it is total.
    fn interface_reflectance<F: FresnelFormula>(&self, surface: &Surface8) -> (F32x8, Mask8) {
        let boundary = gather_boundaries(|k| match self.material(surface, k).interface {
            Interface::Coated { ior } | Interface::ThinDielectric { ior, .. } => {
                Boundary::new(self.media.ior(surface.stack[k]), f64::from(ior))
            }
            _ => Boundary::new(1.0, 1.0),
        });
        let at = boundary.cross(-surface.incident.dot(surface.shading));
        (F::dielectric(&boundary, &at), at.total)
    }

    /// The reflected share by each lane's rule: Fresnel's, or a fixed one unless the reflection is total.
    fn ruled(&self, surface: &Surface8, fresnel: Rgb8, total: Mask8) -> Rgb8 {
        let mut fixed = 0;
        let mut share = fresnel;
        for k in 0..8 {
            if let Interface::Dielectric { rule: FresnelRule::Fixed(colour), .. }
            | Interface::ThinDielectric { rule: FresnelRule::Fixed(colour), .. } =
                self.material(surface, k).interface
            {
                fixed |= 1 << k;
                share.set_lane(k, colour);
            }
        }
        Vec3x8::select(Mask8::from_bits(fixed) & !total, share, fresnel)
    }

    fn reflected(&mut self, surface: &Surface8, lanes: u8, dir: Vec3x8, weight: Rgb8, depth: usize) {
        let dir = dir.normalized();
        let new = Spawn8 {
            origin: surface.above(),
            dir,
            t_max: F32x8::INFINITY,
            admits: GeometryMask::ALL,
            weight,
            pixel: &surface.pixel,
            stack: &surface.stack,
            lead: surface.lead(dir),
            passes: &[0; 8],
        };
        self.spawn(lanes, &new, RayKind::Reflected, depth);
    }

    fn straight_on(&mut self, surface: &Surface8, lanes: u8, weight: Rgb8, depth: usize) {
        let new = Spawn8 {
            origin: surface.below(),
            dir: surface.incident,
            t_max: F32x8::INFINITY,
            admits: GeometryMask::ALL,
            weight,
            pixel: &surface.pixel,
            stack: &surface.stack,
            lead: surface.lead(surface.incident),
            passes: &[0; 8],
        };
        self.spawn(lanes, &new, RayKind::Transmitted, depth);
    }

    /// Sends rays on through surfaces that are not there: same depth, same weight.
    fn pass(&mut self, surface: &Surface8, lanes: u8, beyond: &[StackId; 8], depth: usize) {
        let passes = surface.passes.map(|n| n + 1);
        let spent = lane_bits(|k| passes[k] > MOST_PASSES) & lanes;
        self.accumulator.add_truncated8(spent, &surface.pixel, &surface.weight);
        let new = Spawn8 {
            origin: surface.below(),
            dir: surface.incident,
            t_max: F32x8::INFINITY,
            admits: GeometryMask::ALL,
            weight: surface.weight,
            pixel: &surface.pixel,
            stack: beyond,
            lead: surface.lead(surface.incident),
            passes: &passes,
        };
        self.queue(RayKind::Transmitted, depth).push8(lanes & !spent, &new);
    }

    /// Queues secondary rays of a hit at `depth`, but for those that the depth limit or the cut-off ends.
    fn spawn(&mut self, lanes: u8, new: &Spawn8, kind: RayKind, depth: usize) {
        let heaviest = new.weight.max_component();
        let carrying = lanes & !heaviest.eq(F32x8::ZERO).bits();
        let too_deep = depth >= self.scene.settings.max_depth as usize;
        // A NaN weight compares false and lives on, to be counted where it lands.
        let light = heaviest.lt(F32x8::from(self.scene.settings.cutoff)).bits();
        let ended = if too_deep { carrying } else { carrying & light };
        self.accumulator.add_truncated8(ended, new.pixel, &new.weight);
        self.queue(kind, depth + 1).push8(carrying & !ended, new);
    }
}

/// Bits by a predicate of the lane number.
pub(super) fn lane_bits(f: impl Fn(usize) -> bool) -> u8 {
    (0..8).fold(0, |bits, k| bits | u8::from(f(k)) << k)
}

/// Eight boundaries in structure-of-arrays.
pub(super) fn gather_boundaries(at: impl Fn(usize) -> Boundary<f32>) -> Boundary<F32x8> {
    let all: [Boundary<f32>; 8] = std::array::from_fn(at);
    Boundary {
        eta: F32x8::from_fn(|k| all[k].eta),
        kc: F32x8::from_fn(|k| all[k].kc),
        kc_low: F32x8::from_fn(|k| all[k].kc_low),
        r0: F32x8::from_fn(|k| all[k].r0),
    }
}
