//! Split stages: secondary rays at surfaces, one function for each class over a stream of its surfaces.

mod dielectric;
mod disperse;
mod film;
mod lobes;
mod mirror;
pub mod mirrored;

use super::class::Class;
use super::options::Options;
use super::outcome::RayKind;
use super::queue::{Rgb8, Spawn8};
use super::shading::{Shading, disperses};
use super::sky;
use super::surface::Surface8;
use crate::effects::Pipeline;
use crate::math::Vector3;
use crate::optics::Boundary;
use crate::scene::{Environment, Scene};
use crate::simd::{F32x8, Vec3x8};

/// Function that queues the secondary rays of a stream of surfaces of one class, and sets the weights of their bases.
/// The last argument is the depth of the arriving rays.
pub type SplitStage = fn(&mut Shading, &mut [Surface8], usize);

pub use lobes::{Optics, OpticsVisitor, dispatch};

const WHITE: Vec3x8 = Vector3::new(F32x8::ONE, F32x8::ONE, F32x8::ONE);

/// Picks the stage of a class, or `None` if it emits no secondary rays.
#[must_use]
pub fn pick(class: Class, scene: &Scene, options: &Options, touching: bool) -> Option<SplitStage> {
    dispatch(options.fresnel, Pick { class, scene, options, touching })
}

/// Picks the stage for the optics that it is called with.
struct Pick<'a> {
    class: Class,
    scene: &'a Scene,
    options: &'a Options,
    touching: bool,
}

impl OpticsVisitor for Pick<'_> {
    type Output = Option<SplitStage>;

    fn visit<O: Optics>(self) -> Option<SplitStage> {
        pick_for::<O>(self.class, self.scene, self.options, self.touching)
    }
}

fn pick_for<O: Optics>(class: Class, scene: &Scene, options: &Options, touching: bool) -> Option<SplitStage> {
    match class {
        Class::Opaque => None,
        Class::Mirror => Some(mirror::traced::<O>),
        Class::MirrorOfEnvironment if options.effects.pipeline == Pipeline::All => {
            Some(mirror::of_environment::<sky::Any>)
        }
        Class::MirrorOfEnvironment => Some(match scene.environment {
            Environment::Constant(_) => mirror::of_environment::<sky::Constant>,
            Environment::Gradient { .. } => mirror::of_environment::<sky::Gradient>,
            Environment::LatLong { .. } => mirror::of_environment::<sky::LatLong>,
            Environment::Map { .. } => mirror::of_environment::<sky::Mapped>,
        }),
        Class::Conductor => Some(mirror::conductor::<O>),
        Class::Dielectric => Some(dielectric::pick::<O>(options.bending(), disperses(scene, options), touching)),
        Class::Thin => Some(film::thin::<O>),
        Class::Coated => Some(film::coated::<O>),
        Class::Alpha => Some(film::alpha::<O>),
    }
}

/// Handles reflected light as the render's options say.
#[inline(always)]
fn reflected<O: Optics>(
    shading: &mut Shading,
    surface: &Surface8,
    lanes: u8,
    dir: Vec3x8,
    weight: Rgb8,
    carried: &O::Carried,
    depth: usize,
) {
    let extra = O::leaving(carried, dir);
    (shading.reflect)(shading, surface, lanes, dir, weight, extra.as_ref(), depth);
}

/// Queues rays that continue in their direction.
#[inline(always)]
fn straight_on<O: Optics>(
    shading: &mut Shading,
    surface: &Surface8,
    lanes: u8,
    weight: Rgb8,
    carried: &O::Carried,
    depth: usize,
) {
    let extra = O::leaving(carried, surface.incident);
    let new = Spawn8 { extra: extra.as_ref(), ..surface.transmitted(surface.incident, weight) };
    shading.spawn(lanes, &new, RayKind::Transmitted, depth);
}

/// Collects a predicate over the lane indices into a bit mask.
pub(super) fn lane_bits(f: impl Fn(usize) -> bool) -> u8 {
    (0..8).fold(0, |bits, k| bits | u8::from(f(k)) << k)
}

/// Gathers eight boundaries in structure-of-arrays form.
pub(super) fn gather_boundaries(at: impl Fn(usize) -> Boundary<f32>) -> Boundary<F32x8> {
    let all: [Boundary<f32>; 8] = std::array::from_fn(at);
    Boundary {
        eta: F32x8::from_fn(|k| all[k].eta),
        kc: F32x8::from_fn(|k| all[k].kc),
        kc_low: F32x8::from_fn(|k| all[k].kc_low),
        r0: F32x8::from_fn(|k| all[k].r0),
    }
}
