//! Maps of the surroundings of bodies that bend light, and their back sides.

use glam::{DVec2, DVec3};

use super::maps::Taken;
use super::outcome::MapsReport;
use super::queue::Rgb8;
use super::surface::Surface8;
use crate::Result;
use crate::accel::native::{Native, Scratch};
use crate::accel::{BuildQuality, Coherence, Intersector};
use crate::geometry::{Hit8, Ray, Ray8, Shape};
use crate::optics::{RefractionModel, transmittance};
use crate::scene::{Rgb, Scene};
use crate::simd::{Vec3x8, set_lanes};
use crate::systems::bent::{Back, Entry, outward};
use crate::systems::maps::Proxy;

/// Maps of bodies and, for a second interface, a hierarchy of each body's own.
#[derive(Debug)]
pub(super) struct Bodies8 {
    taken: Taken,
    /// By object; none where a body has no map, or the second interface is left out.
    backs: Vec<Option<Body>>,
}

/// Hierarchy of a body's own.
#[derive(Debug)]
struct Body {
    accel: Native,
    /// Distance from each place on the body beyond which none of it lies.
    far: f64,
}

/// Light that enters bodies, as a stage has it.
pub(super) struct Entering<'a> {
    pub surface: &'a Surface8,
    pub lanes: u8,
    /// Unit directions inside.
    pub dir: Vec3x8,
    pub weight: &'a Rgb8,
    /// Indices before the surface over those behind it.
    pub eta: crate::simd::F32x8,
}

/// Light that maps show, and the lanes that have none.
pub(super) struct LookedUp {
    pub radiance: Rgb8,
    /// Weight that the second interface reflects back into the body.
    pub ended: Rgb8,
    pub left: u8,
}

impl Bodies8 {
    /// Makes the hierarchies that `refraction` needs for bodies with a map.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] if there is no memory for a hierarchy.
    pub fn new(scene: &Scene, refraction: RefractionModel, taken: Taken) -> Result<Self> {
        let back = |object: usize| -> Result<Option<Body>> {
            if refraction != RefractionModel::MapTwo || taken.maps.of(object as u32).is_none() {
                return Ok(None);
            }
            let own = &scene.geometry[object];
            let accel = Native::try_build_as(std::slice::from_ref(own), BuildQuality::Default)?;
            Ok(Some(Body { accel, far: 2.0 * f64::from(own.shape.bounds().diagonal()) }))
        };
        let backs = (0..scene.objects.len()).map(back).collect::<Result<_>>()?;
        Ok(Self { taken, backs })
    }

    /// Returns the report on the maps. `traced` is the number of rays that entered a body without a map.
    pub fn report(&self, traced: u64) -> MapsReport {
        self.taken.report(traced)
    }

    /// Looks up what light sees that enters bodies from outside.
    pub fn look_up(&self, scene: &Scene, proxy: Proxy, entering: &Entering, scratch: &mut Scratch) -> LookedUp {
        let Entering { surface, lanes, dir, weight, eta } = entering;
        let maps = &self.taken.maps;
        let zero = Vec3x8::splat(Rgb::ZERO);
        let mut result = LookedUp { radiance: zero, ended: zero, left: *lanes };
        let mut seen = 0;
        for lane in set_lanes(*lanes).filter(|&lane| surface.front.lane(lane)) {
            seen |= u8::from(maps.of(surface.hit[lane].geometry).is_some()) << lane;
        }
        result.left &= !seen;
        let mut waiting = seen;
        while let Some(first) = set_lanes(waiting).next() {
            let object = surface.hit[first].geometry;
            let same = set_lanes(waiting).filter(|&k| surface.hit[k].geometry == object).fold(0, |m, k| m | 1 << k);
            waiting &= !same;
            let Some(map) = maps.of(object) else { continue };
            let Some(back) = &self.backs[object as usize] else {
                for k in set_lanes(same) {
                    let shown = maps.look_up(map, proxy, surface.point.lane(k), dir.lane(k).normalize());
                    result.radiance.set_lane(k, shown * weight.lane(k));
                }
                continue;
            };
            let entry = |k: usize| Entry {
                point: surface.point.lane(k).as_dvec3(),
                normal: surface.shading.lane(k).as_dvec3(),
                incident: surface.incident.lane(k).as_dvec3(),
                inside: dir.lane(k).as_dvec3().normalize(),
                eta: f64::from(eta.lane(k)),
            };
            let shape = &scene.geometry[object as usize].shape;
            let mut behind = |lines: [Option<(DVec3, DVec3)>; 8]| back_sides(back, shape, &lines, scratch);
            let of = |line: fn(&Entry) -> (DVec3, DVec3)| {
                std::array::from_fn(|k| (same >> k & 1 != 0).then(|| line(&entry(k))))
            };
            let along = behind(of(|entry| (entry.point, entry.incident)));
            let beneath = behind(of(|entry| (entry.point, -entry.normal)));
            let end = |k: usize| entry(k).end(along[k], beneath[k]);
            let ends = std::array::from_fn(|k| (same >> k & 1 != 0).then(|| (end(k), entry(k).incident)));
            let there = behind(ends);
            let absorption = scene.medium_of(object as usize).map_or(Rgb::ZERO, |m| scene.media[m as usize].absorption);
            for k in set_lanes(same) {
                let entry = entry(k);
                let back = there[k].or(along[k]).unwrap_or(Back { point: entry.point, normal: -entry.normal });
                let left = entry.leave(end(k), back);
                let kept = transmittance(absorption.as_dvec3().into(), left.thickness);
                let arriving = weight.lane(k) * DVec3::from(kept).as_vec3();
                let shown = maps.look_up(map, proxy, left.point.as_vec3(), left.dir.as_vec3());
                let share = left.share as f32;
                result.radiance.set_lane(k, shown * arriving * share);
                result.ended.set_lane(k, arriving * (1.0 - share));
            }
        }
        result
    }
}

/// Returns the last surface of a body on each line, given by a place and a unit direction.
fn back_sides(
    body: &Body,
    shape: &Shape,
    lines: &[Option<(DVec3, DVec3)>; 8],
    scratch: &mut Scratch,
) -> [Option<Back>; 8] {
    let mut packet = Ray8::default();
    for (k, line) in lines.iter().enumerate() {
        let Some((place, dir)) = line else { continue };
        // A line that leaves the body is met from behind, where its last surface is the first.
        packet.set_lane(k, &Ray::new((*place + *dir * body.far).as_vec3(), (-*dir).as_vec3()));
    }
    let mut hits = [Hit8::default()];
    body.accel.closest(&[packet], &mut hits, Coherence::Coherent, scratch);
    std::array::from_fn(|k| {
        let (place, dir) = lines[k]?;
        let hit = hits[0].lane(k);
        hit.is_hit().then(|| {
            let point = place + dir * (body.far - f64::from(hit.t));
            let uv = DVec2::new(f64::from(hit.u), f64::from(hit.v));
            Back { point, normal: outward(shape, hit.primitive, uv, point) }
        })
    })
}
