//! Virtual scenes in the eight-wide renderer: rays of the eye that meet a mirror ball go on into its virtual scene.

use glam::{DVec2, Vec3};

use super::media::StackId;
use super::outcome::ImagesReport;
use super::queue::{Chunk, Rgb8, State8};
use super::surface::Surface8;
use crate::accel::native::{Native, Scratch};
use crate::accel::{BuildQuality, Coherence, Intersector};
use crate::geometry::{Hit, Hit8, Ray, Ray8};
use crate::scene::{Rgb, Scene};
use crate::simd::set_lanes;
use crate::systems::images::{Images, PointCounts, Shown};
use crate::{Error, Result};

/// Virtual scenes, and native's hierarchies over them, whichever back end traces the other rays.
#[derive(Debug)]
pub(super) struct Virtual {
    pub images: Images,
    accels: Vec<Native>,
}

/// A ray of the eye that met a reflector.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    /// Place of the virtual scene in the list.
    image: usize,
    pixel: u32,
    weight: Rgb,
    stack: StackId,
    /// From the eye to the reflector.
    eye: Vec3,
    dir: Vec3,
    t: f32,
    /// Start of rays that leave the reflector, how far off it that is, its normal, and the mirror direction.
    above: Vec3,
    reach: f32,
    normal: Vec3,
    mirrored: Vec3,
}

/// Rays that are to go on in virtual scenes.
#[derive(Debug, Default)]
pub(super) struct VirtualRays<'a> {
    scenes: Option<&'a Virtual>,
    waiting: Vec<Waiting>,
    /// Reflections that were traced for want of a virtual scene, or because no ray of the eye met the reflector.
    pub traced: u64,
}

impl Virtual {
    /// Of a scene whose reflectors are balls.
    ///
    /// # Errors
    /// [`Error::Usage`], where there are reflectors and none has a virtual scene; [`Error::Limit`], where there is no memory
    /// for a hierarchy.
    pub fn of(scene: &Scene) -> Result<Self> {
        let images = checked(scene)?;
        // A hierarchy of one picture: a quick build costs less than it saves.
        let build = |image: &crate::systems::images::Image| Native::try_build_as(&image.geometry, BuildQuality::Fast);
        let accels = images.list.iter().map(build).collect::<Result<_>>()?;
        Ok(Self { images, accels })
    }
}

/// Makes the virtual scenes of a scene's reflectors.
///
/// # Errors
/// [`Error::Usage`] if there are reflectors and none has a virtual scene.
pub(super) fn checked(scene: &Scene) -> Result<Images> {
    let images = Images::of(scene);
    if let (Some((object, why)), true) = (images.without.first(), images.list.is_empty()) {
        return Err(Error::Usage(format!(
            "--reflection virtual: `{}` {why}, and no other reflector has a virtual scene; make it a sphere, or a \
                 convex or concave mesh with `smooth` normals, that a pinhole camera sees from outside, or take \
                 --reflection traced",
            scene.objects[*object as usize].name
        )));
    }
    Ok(images)
}

/// Returns the report on virtual scenes. `traced` reflections were traced.
pub(super) fn report(images: &Images, traced: u64) -> ImagesReport {
    let list = &images.list;
    ImagesReport {
        reflectors: list.len(),
        triangles: list.iter().map(|image| image.triangles() as u64).sum(),
        points: list.iter().fold(PointCounts::default(), |mut sum, image| {
            sum.add(&image.points);
            sum
        }),
        left_out: list.iter().map(|image| image.left_out).sum(),
        traced,
        without: images.without.clone(),
    }
}

impl<'a> VirtualRays<'a> {
    /// None waiting.
    pub fn new(scenes: &'a Virtual) -> Self {
        Self { scenes: Some(scenes), ..Self::default() }
    }

    /// Returns true if there are virtual scenes.
    pub fn is_on(&self) -> bool {
        self.scenes.is_some()
    }

    /// Returns the lanes of a surface whose reflections a virtual scene shows.
    pub fn shown(&mut self, surface: &Surface8, lanes: u8, depth: usize) -> u8 {
        let Some(scenes) = self.scenes else { return 0 };
        let mut shown = 0;
        for lane in set_lanes(lanes).filter(|_| depth == 0) {
            let image = scenes.images.at(surface.hit[lane].geometry, surface.front.lane(lane));
            shown |= u8::from(image.is_some() && surface.returning[lane] == 0) << lane;
        }
        self.traced += u64::from((lanes & !shown).count_ones());
        shown
    }

    /// Has lanes of a surface wait, with their mirror directions and weights.
    pub fn wait(&mut self, eye: Vec3, surface: &Surface8, lanes: u8, mirrored: crate::simd::Vec3x8, weight: &Rgb8) {
        let Some(scenes) = self.scenes else { return };
        let above = surface.above();
        for lane in set_lanes(lanes) {
            let Some(image) = scenes.images.at(surface.hit[lane].geometry, surface.front.lane(lane)) else { continue };
            let point = surface.point.lane(lane);
            self.waiting.push(Waiting {
                image,
                pixel: surface.pixel[lane],
                weight: weight.lane(lane),
                stack: surface.stack[lane],
                eye,
                dir: surface.incident.lane(lane),
                t: (point - eye).length(),
                above: above.lane(lane),
                reach: surface.reach.lane(lane),
                normal: surface.normal.lane(lane),
                mirrored: mirrored.lane(lane).normalize(),
            });
        }
    }

    /// Takes up to `packets` packets of the rays that wait for one virtual scene: rays from the reflector to what it shows, with
    /// the hits there. Rays that meet nothing where pieces were left out are to be traced. Returns true if there were any.
    pub fn take(&mut self, scene: &Scene, packets: usize, scratch: &mut Scratch, found: &mut Found) -> bool {
        let (Some(scenes), Some(last)) = (self.scenes, self.waiting.last().copied()) else { return false };
        let same = self.waiting.iter().rev().take(8 * packets).take_while(|ray| ray.image == last.image).count();
        let rays = self.waiting.split_off(self.waiting.len() - same);
        let image = &scenes.images.list[last.image];
        let into = |ray: &Waiting| Ray { t_min: ray.t, ..Ray::new(ray.eye, ray.dir) };
        let eye_rays = Ray8::pack(&rays.iter().map(into).collect::<Vec<_>>());
        let mut met = vec![Hit8::default(); eye_rays.len()];
        scenes.accels[last.image].closest(&eye_rays, &mut met, Coherence::Coherent, scratch);
        let (mut shown, mut unknown) = (Vec::new(), Vec::new());
        for (i, waiting) in rays.iter().enumerate() {
            let met = met[i / 8].lane(i % 8);
            if met.is_hit() {
                let uv = DVec2::new(f64::from(met.u), f64::from(met.v));
                shown.push((waiting, onto(waiting, image.shown(scene, met.geometry, met.primitive, uv))));
            } else if image.left_out == 0 {
                shown.push((waiting, (waiting.mirrored, Hit::MISS)));
            } else {
                unknown.push((waiting, (waiting.mirrored, Hit::MISS)));
            }
        }
        self.traced += unknown.len() as u64;
        found.hits.extend(fill(&shown, &mut found.shown));
        fill(&unknown, &mut found.unknown);
        true
    }
}

/// Rays that leave reflectors of virtual scenes.
#[derive(Debug, Default)]
pub(super) struct Found {
    /// Those of which the hit is known.
    pub shown: Chunk,
    /// Their hits.
    pub hits: Vec<Hit8>,
    /// Those to be traced.
    pub unknown: Chunk,
}

impl Found {
    pub fn clear(&mut self) {
        self.shown.clear();
        self.hits.clear();
        self.unknown.clear();
    }
}

/// Fills a chunk with rays, and returns their hits.
fn fill(rays: &[(&Waiting, (Vec3, Hit))], chunk: &mut Chunk) -> Vec<Hit8> {
    let mut hits = Vec::with_capacity(rays.len().div_ceil(8));
    for eight in rays.chunks(8) {
        let (mut ray, mut state, mut hit) = (Ray8::default(), State8::default(), Hit8::default());
        for (lane, (waiting, (dir, real))) in eight.iter().enumerate() {
            ray.set_lane(lane, &Ray::new(waiting.above, *dir));
            hit.set_lane(lane, real);
            state.weight.set_lane(lane, waiting.weight);
            state.pixel[lane] = waiting.pixel;
            state.stack[lane] = waiting.stack;
            state.lead.set_lane(lane, waiting.reach * dir.dot(waiting.normal).abs());
        }
        chunk.rays.push(ray);
        chunk.states.push(state);
        hits.push(hit);
    }
    hits
}

/// The direction from a reflector to what it shows, and the hit there.
fn onto(waiting: &Waiting, shown: Shown) -> (Vec3, Hit) {
    let way = shown.place.as_vec3() - waiting.above;
    let t = way.length();
    let Some(dir) = way.try_normalize() else { return (waiting.mirrored, Hit::MISS) };
    let [u, v] = shown.uv.as_vec2().to_array();
    (dir, Hit { t, u, v, instance: 0, geometry: shown.object, primitive: shown.primitive })
}
