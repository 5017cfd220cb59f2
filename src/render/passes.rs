//! Planar mirrors by matrix: cameras mirrored in what a camera sees, and masks of the pixels that each of them fills.
//!
//! A pass is the scene as a mirror shows it: the matrix of the slides turns the camera's eye and frame into their mirror
//! image. The rays of the image begin at the mirror's plane, which clips away everything on the eye's side. The mask selects
//! the pixels in which the mirror was seen. A mirror seen in a pass has a pass of its own: its matrix is the product, and its
//! mask lies within the outer one. So passes are the levels of a hall of mirrors. All rays of a pass come from one point and
//! go through neighbouring pixels, as camera rays do.

use super::camera::Lens;
use super::media::StackId;
use super::outcome::MirrorLevel;
use super::queue::{Chunk, Rgb8, State8};
use super::surface::Surface8;
use super::tile::Tile;
use crate::geometry::Ray8;
use crate::math::{Real, UNIT_ROUNDOFF};
use crate::optics::PlanarReflection;
use crate::scene::{Rgb, Scene};
use crate::simd::{F32x8, Vec3x8, set_lanes};
use crate::systems::planar::{Mirror, Mirrors};

/// Roundings between the coordinates of eye and mirror and the parameter of a hit, along three axes. They are those of the
/// mirrored eye, the mirror's corners, their difference, and the products of an intersection test and their sum.
const ROUNDINGS: f32 = 16.0;

/// Mirrored cameras, the masks of pixels that they still have to render, and their counts.
#[derive(Debug, Default)]
pub struct Passes<'a> {
    mirrors: Option<&'a Mirrors>,
    /// The last level that is rendered.
    levels: u32,
    /// The camera's own pass first; each after the pass that it was seen in.
    tree: Vec<Pass>,
    /// The pass whose rays are shaded; none while other rays are.
    at: Option<usize>,
    /// By level, from the first mirror on.
    pub counts: Vec<MirrorLevel>,
    /// Reflections in planar mirrors that were seen in or through something else, and so traced.
    pub elsewhere: u64,
}

/// One camera.
#[derive(Debug)]
struct Pass {
    /// From the camera to its image.
    matrix: PlanarReflection<f64>,
    level: u32,
    /// The mirror that was looked into last; none for the camera itself.
    mirror: Option<u32>,
    mask: Vec<Masked>,
    /// By mirror, the passes of those seen in this one.
    inner: Vec<(u32, usize)>,
}

/// A camera ray's pixel that a mirror fills.
#[derive(Clone, Copy, Debug)]
struct Masked {
    pixel: u32,
    weight: Rgb,
    stack: StackId,
    /// Height above the mirror below which hits are clipped, in scene units: the offset of a reflected ray's origin.
    clear: f32,
}

impl<'a> Passes<'a> {
    /// Creates the passes for mirrors, with at most `levels` mirrors in a row.
    pub fn new(mirrors: &'a Mirrors, levels: u32) -> Self {
        Self { mirrors: Some(mirrors), levels, ..Self::default() }
    }

    /// Returns true if cameras are mirrored.
    pub fn is_on(&self) -> bool {
        self.mirrors.is_some()
    }

    /// Returns true if the current rays are camera rays, or rays of a mirror image of the camera.
    pub fn is_camera(&self) -> bool {
        self.at.is_some()
    }

    /// Drops all passes except the camera's, whose rays come next.
    pub fn begin(&mut self) {
        self.tree.clear();
        self.tree.push(Pass {
            matrix: PlanarReflection::identity(),
            level: 0,
            mirror: None,
            mask: Vec::new(),
            inner: Vec::new(),
        });
        self.at = Some(0);
    }

    /// Marks the following rays as belonging to no pass.
    pub fn leave(&mut self) {
        self.at = None;
    }

    /// Starts the rays of pass `number`. Returns its level, or none if there is no such pass.
    pub fn enter(&mut self, number: usize) -> Option<usize> {
        let level = self.tree.get(number)?.level;
        self.at = Some(number);
        Some(level as usize)
    }

    /// Returns the lanes of a surface whose reflections a mirror image of the camera sees.
    pub fn masked(&mut self, surface: &Surface8, lanes: u8) -> u8 {
        let Some(mirrors) = self.mirrors else { return 0 };
        let mut planar = 0;
        for lane in set_lanes(lanes) {
            let hit = &surface.hit[lane];
            // Between touching surfaces a ray is on its way without being traced.
            let touching = surface.returning[lane] != 0;
            planar |= u8::from(!touching && mirrors.at(hit.geometry, hit.primitive).is_some()) << lane;
        }
        if self.at.is_none() {
            self.elsewhere += u64::from(planar.count_ones());
            return 0;
        }
        planar
    }

    /// Returns true if a mirror that is seen now would be one too many.
    pub fn at_last_level(&self) -> bool {
        self.at.is_some_and(|at| self.tree[at].level >= self.levels)
    }

    /// Adds lanes of a surface to the masks of their mirrors.
    pub fn mask(&mut self, surface: &Surface8, lanes: u8, weight: &Rgb8) {
        let (Some(mirrors), Some(at)) = (self.mirrors, self.at) else { return };
        for lane in set_lanes(lanes) {
            let hit = &surface.hit[lane];
            let Some(mirror) = mirrors.at(hit.geometry, hit.primitive) else { continue };
            let pass = self.inner(mirrors, at, mirror);
            let weight = weight.lane(lane);
            let counts = &mut self.counts[self.tree[pass].level as usize - 1];
            counts.add(weight);
            self.tree[pass].mask.push(Masked {
                pixel: surface.pixel[lane],
                weight,
                stack: surface.stack[lane],
                clear: surface.reach.lane(lane),
            });
        }
    }

    /// Returns the pass of a mirror that is seen in pass `at`.
    fn inner(&mut self, mirrors: &Mirrors, at: usize, mirror: u32) -> usize {
        if let Some(&(_, pass)) = self.tree[at].inner.iter().find(|(m, _)| *m == mirror) {
            return pass;
        }
        let pass = self.tree.len();
        let outer = &mut self.tree[at];
        outer.inner.push((mirror, pass));
        // What the outer camera sees is mirrored first in the mirror that it sees last.
        let matrix = mirrors.list[mirror as usize].matrix().after(&outer.matrix);
        let level = outer.level + 1;
        self.tree.push(Pass { matrix, level, mirror: Some(mirror), mask: Vec::new(), inner: Vec::new() });
        if self.counts.len() < level as usize {
            self.counts.resize(level as usize, MirrorLevel::default());
        }
        self.counts[level as usize - 1].passes += 1;
        pass
    }

    /// Fills a chunk with rays of the current pass through the next pixels of its mask, at the given offset in the pixel. It
    /// takes at most `packets` packets. Returns true if there were any.
    pub fn rays(
        &mut self,
        scene: &Scene,
        tile: &Tile,
        (dx, dy): (F32x8, F32x8),
        packets: usize,
        chunk: &mut Chunk,
    ) -> bool {
        let (Some(mirrors), Some(at)) = (self.mirrors, self.at) else { return false };
        let Pass { matrix, mirror: Some(mirror), mask, .. } = &mut self.tree[at] else { return false };
        let mirror = &mirrors.list[*mirror as usize];
        let lens = Lens::mirrored(&scene.camera, scene.settings.width, scene.settings.height, matrix);
        let count = mask.len().min(8 * packets);
        for eight in mask[..count].chunks(8) {
            let of = |lane: usize| &eight[lane.min(eight.len() - 1)];
            let x = F32x8::from_fn(|k| (tile.x + of(k).pixel % tile.width) as f32) + dx;
            let y = F32x8::from_fn(|k| (tile.y + of(k).pixel / tile.width) as f32) + dy;
            let (origin, dir) = lens.rays8(x, y);
            let (t_clip, t_min) = clip(mirror, origin, dir, F32x8::from_fn(|k| of(k).clear));
            let active = ((1_u32 << eight.len()) - 1) as u8;
            chunk.rays.push(Ray8 { origin, dir, t_min, active, ..Ray8::default() });
            let mut weight = Vec3x8::splat(Rgb::ZERO);
            (0..8).for_each(|k| weight.set_lane(k, of(k).weight));
            chunk.states.push(State8 {
                weight,
                pixel: std::array::from_fn(|k| of(k).pixel),
                stack: std::array::from_fn(|k| of(k).stack),
                // Media take what the way from the mirror on is worth.
                lead: -t_clip,
                passes: [0; 8],
            });
        }
        mask.drain(..count);
        count != 0
    }
}

/// Returns the parameters at which rays of a mirror image pass the mirror's plane, and from which they are `clear` of it,
/// rounding included.
fn clip(mirror: &Mirror, origin: Vec3x8, dir: Vec3x8, clear: F32x8) -> (F32x8, F32x8) {
    let (point, normal) = (Vec3x8::splat(mirror.point.as_vec3()), Vec3x8::splat(mirror.normal.as_vec3()));
    let height = (point - origin).dot(normal);
    let speed = dir.dot(normal);
    let magnitude = normal.abs().dot(point.abs() + origin.abs());
    let margin = clear + F32x8::from(mirror.spread as f32) + magnitude * F32x8::from(ROUNDINGS * UNIT_ROUNDOFF);
    let t = height / speed;
    (t, t + margin / speed.abs())
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;

    #[test]
    fn a_ray_of_the_image_begins_where_it_is_clear_of_the_mirror() {
        let mirror = Mirror { object: 0, point: DVec3::new(0.0, 2.0, 0.0), normal: DVec3::Y, spread: 0.0 };
        // The image of an eye at a height of 1 is at 3; its ray goes down to the mirror.
        let dir = Vec3::new(0.6, -0.8, 0.0);
        let (t, t_min) = clip(&mirror, Vec3x8::splat(Vec3::new(5.0, 3.0, 1.0)), Vec3x8::splat(dir), F32x8::from(1e-3));
        assert!((t.lane(0) - 1.25).abs() < 1e-6);
        let below = 2.0 - (3.0 + dir.y * t_min.lane(0));
        assert!((1e-3..1.01e-3).contains(&below), "{below}");
    }
}
