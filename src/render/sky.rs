//! Miss stage: the environment. Each kind is a type, so that a stage contains one kind and no branch.

use super::lookup::{Edge, bilinear, lat_long};
use super::queue::Rgb8;
use super::shading::Shading;
use super::{queue::Chunk, surface::HitRef};
use crate::math::Real;
use crate::scene::{Environment, Rgb, Texture};
use crate::simd::{F32x8, Vec3x8};

/// Kind of environment.
pub trait Sky: 'static {
    /// Returns the radiance in eight unit directions, or black if the environment is of another kind.
    fn radiance(environment: &Environment, textures: &[Texture], dir: &Vec3x8) -> Rgb8;
}

/// Constant radiance.
pub struct Constant;

/// Gradient between nadir, horizon and zenith.
pub struct Gradient;

/// Equirectangular picture.
pub struct LatLong;

/// Any kind, selected at run time.
pub struct Any;

impl Sky for Constant {
    #[inline(always)]
    fn radiance(environment: &Environment, _: &[Texture], _: &Vec3x8) -> Rgb8 {
        let Environment::Constant(colour) = environment else { return Vec3x8::splat(Rgb::ZERO) };
        Vec3x8::splat(*colour)
    }
}

impl Sky for Gradient {
    #[inline(always)]
    fn radiance(environment: &Environment, _: &[Texture], dir: &Vec3x8) -> Rgb8 {
        let Environment::Gradient { nadir, horizon, zenith } = environment else {
            return Vec3x8::splat(Rgb::ZERO);
        };
        let s = dir.y.max(F32x8::from(-1.0)).min(F32x8::ONE);
        let away = Vec3x8::select(s.lt(F32x8::ZERO), Vec3x8::splat(*nadir), Vec3x8::splat(*zenith));
        let level = Vec3x8::splat(*horizon);
        (away - level).fma(s.abs(), level)
    }
}

impl Sky for LatLong {
    #[inline(always)]
    fn radiance(environment: &Environment, textures: &[Texture], dir: &Vec3x8) -> Rgb8 {
        let mut out = Vec3x8::splat(Rgb::ZERO);
        if let Environment::LatLong { texture, scale, rotation } = environment {
            let picture = &textures[*texture as usize];
            for lane in 0..8 {
                out.set_lane(lane, bilinear(picture, lat_long(dir.lane(lane), *rotation), Edge::Clamp) * *scale);
            }
        }
        out
    }
}

impl Sky for Any {
    #[inline(always)]
    fn radiance(environment: &Environment, textures: &[Texture], dir: &Vec3x8) -> Rgb8 {
        match environment {
            Environment::Constant(_) => Constant::radiance(environment, textures, dir),
            Environment::Gradient { .. } => Gradient::radiance(environment, textures, dir),
            Environment::LatLong { .. } => LatLong::radiance(environment, textures, dir),
        }
    }
}

/// Function that adds the environment's radiance for the rays of a chunk that hit nothing.
pub type MissStage = fn(&mut Shading, &Chunk, &[HitRef]);

/// Picks the stage for an environment, or `None` if it is black.
#[must_use]
pub fn pick(environment: &Environment) -> Option<MissStage> {
    Some(match environment {
        Environment::Constant(Rgb::ZERO) => return None,
        Environment::Constant(_) => missed::<Constant>,
        Environment::Gradient { .. } => missed::<Gradient>,
        Environment::LatLong { .. } => missed::<LatLong>,
    })
}

/// Returns the stage that handles every kind of environment.
pub fn pick_any() -> MissStage {
    missed::<Any>
}

fn missed<S: Sky>(shading: &mut Shading, chunk: &Chunk, misses: &[HitRef]) {
    let scene = shading.scene;
    if scene.environment == Environment::Constant(Rgb::ZERO) {
        return;
    }
    // Misses of one packet are neighbours in the list and share one lookup.
    for packet in misses.chunk_by(|a, b| a >> 3 == b >> 3) {
        let lanes = packet.iter().fold(0_u8, |lanes, miss| lanes | 1 << (miss & 7));
        let place = packet[0] as usize >> 3;
        let state = &chunk.states[place];
        let seen = S::radiance(&scene.environment, &scene.textures, &chunk.rays[place].dir);
        shading.accumulator.add_radiance8(lanes, &state.pixel, &seen.times(state.weight));
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn a_gradient_meets_its_three_colours() {
        let sky = Environment::Gradient { nadir: Rgb::X, horizon: Rgb::Y, zenith: Rgb::Z };
        let mut dir = Vec3x8::splat(Vec3::X);
        dir.set_lane(1, Vec3::Y);
        dir.set_lane(2, Vec3::NEG_Y);
        dir.set_lane(3, Vec3::new(0.866, 0.5, 0.0));
        let got = Gradient::radiance(&sky, &[], &dir);
        assert_eq!(got.lane(0), Rgb::Y);
        assert_eq!(got.lane(1), Rgb::Z);
        assert_eq!(got.lane(2), Rgb::X);
        assert!((got.lane(3) - Rgb::new(0.0, 0.5, 0.5)).length() < 1e-6);
    }
}
