//! The groups fired at a user's own scene. Its meshes need not be closed nor anything else, so the `f64` arbiter says
//! which rays had to hit and which need not.

use glam::{DVec3, Vec3};

use super::sample::Rng;
use super::self_hits::leaving;
use super::{Candidate, Finding, Group, Place, Plan, Tally, in_batches, timed};
use crate::Result;
use crate::accel::Intersector;
use crate::accel::reference::{Fault, Hit64, Reference, Verdict};
use crate::geometry::{Aabb, Hit, Ray, Shape};
use crate::render::Observer;
use crate::scene::Scene;

const BATCHES: usize = 64;

/// Middle and half extent of what is finite in a scene.
pub(super) fn bounds(scene: &Scene) -> (DVec3, DVec3) {
    let all = scene.geometry.iter().fold(Aabb::EMPTY, |b, g| match &g.shape {
        Shape::Mesh(mesh) => b.union(mesh.bounds()),
        Shape::Sphere(sphere) if sphere.is_usable() => b.union(sphere.bounds()),
        _ => b,
    });
    let (lo, hi) = (all.lo.as_dvec3(), all.hi.as_dvec3());
    if lo.cmple(hi).all() {
        // Something flat is still looked at from all around.
        let half = (hi - lo) * 0.5;
        ((lo + hi) * 0.5, half.max(DVec3::splat((half.max_element() * 0.1).max(f64::from(f32::MIN_POSITIVE)))))
    } else {
        (scene.camera.eye.as_dvec3(), DVec3::ONE)
    }
}

/// Fires the planned groups of [`Group::OF_SCENE`] at a scene by every way through a path; failures name the triangle
/// and its place.
///
/// # Errors
/// Interrupted; what building the path comes to.
pub fn fire<C: Candidate>(candidate: &C, scene: &Scene, plan: &Plan, observer: &Observer) -> Result<Vec<Finding>> {
    let ways = candidate.build(&scene.geometry)?;
    let arbiter = Reference::build(&scene.geometry);
    let aim = Aim::at(scene);
    let mut findings = Vec::new();
    for &group in plan.groups.iter().filter(|g| Group::OF_SCENE.contains(g)) {
        let batch = |i: usize| -> Result<Tally> {
            let mut rng = Rng::new(group.name(), i);
            let mut tally = Tally::default();
            let mut scratch = <C::Accel as Intersector>::Scratch::default();
            let count = plan.sized(2_000_000, 64_000) as usize / BATCHES;
            let rays: Vec<Ray> = (0..count).map(|k| aim.ray(&mut rng, group == Group::Parity, k)).collect();
            let first = ways[0].closest(&rays, &mut scratch);
            if group == Group::SelfHits {
                let left: Vec<_> = rays
                    .iter()
                    .zip(&first)
                    .filter(|(_, hit)| hit.is_hit())
                    .flat_map(|(ray, hit)| leaving(&scene.geometry, ray, hit, &mut rng))
                    .collect();
                let rays: Vec<Ray> = left.iter().map(|l| l.ray).collect();
                for way in &ways {
                    for (l, hit) in left.iter().zip(way.closest(&rays, &mut scratch)) {
                        // Only what is flat cannot be met again.
                        let flat = !matches!(scene.geometry[l.from.geometry as usize].shape, Shape::Sphere(_));
                        tally.check(!(flat && hit.is_hit() && hit.id() == l.from.id()), || {
                            let place = Place::of(scene, l.from.geometry, l.from.primitive);
                            format!(
                                "{place}: met again by a {:?} ray that leaves it ({}): {}",
                                l.sent,
                                way.name,
                                told(scene, &l.ray)
                            )
                        });
                    }
                }
                return Ok(tally);
            }
            let answers: Vec<(Vec<Hit>, Vec<bool>)> =
                ways.iter().map(|way| (way.closest(&rays, &mut scratch), way.occluded(&rays, &mut scratch))).collect();
            for (k, ray) in rays.iter().enumerate() {
                let examined = arbiter.examine(ray);
                for (way, (hits, blocked)) in ways.iter().zip(&answers) {
                    let hit = &hits[k];
                    let judged = [examined.judge(hit), examined.judge_occluded(blocked[k])];
                    let fault = judged.into_iter().find_map(|v| match v {
                        Verdict::Wrong(fault) if counts(group, fault) => Some(format!("{fault:?}")),
                        _ => None,
                    });
                    let differs = group == Group::Parity && candidate.is_exact() && bits(hit) != bits(&first[k]);
                    let fault = fault.or_else(|| differs.then(|| format!("other bits than {}", ways[0].name)));
                    tally.check(fault.is_none(), || {
                        let (place, fault) = (at(scene, examined.truth(), hit), fault.unwrap_or_default());
                        format!("{place}: {fault} ({}): {}", way.name, told(scene, ray))
                    });
                }
            }
            Ok(tally)
        };
        findings.push(timed(group, Some(candidate.name()), || in_batches(BATCHES, observer, &batch))?);
    }
    Ok(findings)
}

/// Whether a group is about a fault.
fn counts(group: Group, fault: Fault) -> bool {
    group == Group::Parity || matches!(fault, Fault::Leak | Fault::MissedHit)
}

fn bits(h: &Hit) -> ([u32; 3], (u32, u32, u32)) {
    ([h.t, h.u, h.v].map(f32::to_bits), h.id())
}

/// A ray, its start in world coordinates.
fn told(scene: &Scene, ray: &Ray) -> String {
    if scene.is_in_world_coordinates() {
        return format!("{ray:?}");
    }
    let (from, along) = (scene.world(ray.origin.as_dvec3()), ray.dir.as_dvec3() * scene.unit());
    format!("a ray from {from} along {along}, t {} to {}", ray.t_min, ray.t_max)
}

/// The triangle that a ray should have met, or did.
fn at(scene: &Scene, truth: &Hit64, hit: &Hit) -> String {
    let (geometry, primitive) =
        if truth.is_hit() { (truth.geometry, truth.primitive) } else { (hit.geometry, hit.primitive) };
    if (geometry as usize) < scene.objects.len() {
        Place::of(scene, geometry, primitive).to_string()
    } else {
        String::from("nowhere")
    }
}

/// Rays at a scene.
struct Aim<'a> {
    scene: &'a Scene,
    /// Objects that rays are aimed at.
    targets: Vec<usize>,
    centre: DVec3,
    half: DVec3,
}

impl<'a> Aim<'a> {
    fn at(scene: &'a Scene) -> Self {
        let aimable = |i: &usize| match &scene.geometry[*i].shape {
            Shape::Mesh(m) => !m.triangles.is_empty(),
            Shape::Sphere(s) => s.is_usable(),
            Shape::Plane(_) => false,
        };
        let (centre, half) = bounds(scene);
        Self { scene, targets: (0..scene.geometry.len()).filter(aimable).collect(), centre, half }
    }

    /// A ray of unit direction: at a corner, at a point of an edge, or into the scene; where `anyhow` only one in four
    /// is aimed.
    fn ray(&self, rng: &mut Rng, anyhow: bool, k: usize) -> Ray {
        let from = match k % 5 {
            0 => self.scene.camera.eye.as_dvec3(),
            1 | 2 => self.centre + self.half * rng.point(),
            _ => self.centre + self.half.length() * rng.direction() * rng.between(1.0, 4.0),
        };
        let anywhere = |rng: &mut Rng| self.centre + self.half * rng.point();
        let target = if self.targets.is_empty() || (anyhow && !k.is_multiple_of(4)) {
            anywhere(rng)
        } else {
            let shape = &self.scene.geometry[self.targets[rng.below(self.targets.len())]].shape;
            match shape {
                Shape::Mesh(mesh) => {
                    let [a, b, c] = mesh.corners(rng.below(mesh.triangles.len())).map(Vec3::as_dvec3);
                    match k % 3 {
                        0 => a,
                        1 => a.lerp(b, rng.unit()),
                        _ => a.lerp(b, rng.unit()).lerp(c, rng.unit()),
                    }
                }
                Shape::Sphere(s) => s.centre.as_dvec3() + rng.direction() * f64::from(s.radius),
                Shape::Plane(_) => anywhere(rng),
            }
        };
        let dir = (target - from).as_vec3().normalize_or(rng.direction().as_vec3());
        Ray::new(from.as_vec3(), dir)
    }
}
