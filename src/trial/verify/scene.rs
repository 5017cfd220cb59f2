//! Groups that run on a user's own scene. Its meshes need not be closed, so the `f64` arbiter decides which rays must
//! hit.

use glam::{DVec3, Vec3};

use super::candidate::{Candidate, NamedAccel};
use super::group::Group;
use super::self_hits::{Leaving, leaving};
use super::tally::CaseCounts;
use super::trouble::TriangleLocation;
use super::{GroupResult, VerifyPlan, in_batches, timed};
use crate::Result;
use crate::accel::Intersector;
use crate::accel::reference::{Budget, Examined, Fault, Reference, Verdict};
use crate::geometry::{Aabb, Hit, Ray, Shape};
use crate::measure::sample::Rng;
use crate::render::Observer;
use crate::scene::Scene;
use crate::trial::parity::fault_name;
use crate::trial::shown;

const BATCHES: usize = 64;

/// Number of rays traced together.
const CHUNK: usize = 256;

/// Mean units of [`Budget`] per ray in a batch: several times that of a ray in a large model.
const UNITS_A_RAY: u64 = 2_400;

/// Rays that the budget of a batch is made for at the least, so that a single costly ray does not end a small one.
const FEWEST: u64 = 64;

/// Units of [`Budget`] after which no more rays are traced together.
const CHUNK_UNITS: u64 = 2_000_000;

/// Returns the middle and half extent of the finite part of a scene.
pub(super) fn bounds(scene: &Scene) -> (DVec3, DVec3) {
    let all = scene.geometry.iter().fold(Aabb::EMPTY, |b, g| match &g.shape {
        Shape::Mesh(mesh) => b.union(mesh.bounds()),
        Shape::Sphere(sphere) if sphere.is_usable() => b.union(sphere.bounds()),
        _ => b,
    });
    let (lo, hi) = (all.lo.as_dvec3(), all.hi.as_dvec3());
    if lo.cmple(hi).all() {
        // A flat scene still gets rays from all around.
        let half = (hi - lo) * 0.5;
        ((lo + hi) * 0.5, half.max(DVec3::splat((half.max_element() * 0.1).max(f64::from(f32::MIN_POSITIVE)))))
    } else {
        (scene.camera.eye.as_dvec3(), DVec3::ONE)
    }
}

/// Runs the selected groups of [`Group::OF_SCENE`] on a scene with every traversal of a back end. Failures name the
/// triangle and its location, and give a command that repeats the ray on the file `name`.
///
/// # Errors
/// Returns [`Error::Interrupted`](crate::Error::Interrupted) if stopped, or an error if the back end cannot be built.
pub fn fire<C: Candidate>(
    candidate: &C,
    scene: &Scene,
    name: &str,
    plan: &VerifyPlan,
    observer: &Observer,
) -> Result<Vec<GroupResult>> {
    let target = Target { scene, name, ways: candidate.build(&scene.geometry)?, exact: candidate.is_exact() };
    Reference::need(&scene.geometry)?;
    let arbiter = Reference::build(&scene.geometry);
    let aim = Aim::at(scene);
    let mut findings = Vec::new();
    for &group in plan.groups.iter().filter(|g| Group::OF_SCENE.contains(g)) {
        let batch = |i: usize| -> Result<CaseCounts> {
            let mut rng = Rng::new(group.name(), i);
            let count = plan.rays.unwrap_or(plan.sized(2_000_000, 64_000)) as usize / BATCHES;
            let rays: Vec<Ray> = (0..count).map(|k| aim.ray(&mut rng, group == Group::Parity, k)).collect();
            let budget = Budget::new(UNITS_A_RAY * (count as u64).max(FEWEST));
            Ok(match group {
                Group::SelfHits => target.left_behind(&arbiter, &rays, budget, &mut rng),
                _ => target.judged(group, &arbiter, &rays, budget),
            })
        };
        findings.push(timed(group, Some(candidate.name()), || in_batches(BATCHES, observer, &batch))?);
    }
    Ok(findings)
}

/// Back end built over a scene.
struct Target<'a, I> {
    scene: &'a Scene,
    /// File of the scene, as typed.
    name: &'a str,
    ways: Vec<NamedAccel<I>>,
    /// True if all traversals promise the same bits.
    exact: bool,
}

impl<I: Intersector> Target<'_, I> {
    /// Sends rays from the hits of `rays`, and finds those that hit the flat primitive they leave.
    fn left_behind(&self, arbiter: &Reference, rays: &[Ray], mut budget: Budget, rng: &mut Rng) -> CaseCounts {
        let geometry = &self.scene.geometry;
        let mut tally = CaseCounts::default();
        let mut scratch = I::Scratch::default();
        let mut rest = rays;
        while !rest.is_empty() {
            let measured = measured(arbiter, rest, &mut budget);
            if measured == 0 {
                tally.left_out += rest.len() as u64;
                break;
            }
            let (chunk, after) = rest.split_at(measured);
            rest = after;
            let first = self.ways[0].closest(chunk, &mut scratch);
            let met = chunk.iter().zip(&first).filter(|(_, hit)| hit.is_hit());
            let left: Vec<Leaving> = met.flat_map(|(ray, hit)| leaving(geometry, ray, hit, rng)).collect();
            let rays: Vec<Ray> = left.iter().map(|l| l.ray).collect();
            for way in &self.ways {
                for (l, hit) in left.iter().zip(way.closest(&rays, &mut scratch)) {
                    // Only a flat primitive cannot be hit again.
                    let flat = !matches!(geometry[l.from.geometry as usize].shape, Shape::Sphere(_));
                    tally.check(!(flat && hit.is_hit() && hit.id() == l.from.id()), || {
                        let place = TriangleLocation::of(self.scene, l.from.geometry, l.from.primitive);
                        let answers = [(way.name, self.hit(&hit))];
                        self.failure(
                            &format!("{place}: met again by a {:?} ray that leaves it", l.sent),
                            &l.ray,
                            &answers,
                        )
                    });
                }
            }
        }
        tally
    }

    /// Judges the answers of every traversal to `rays` by the arbiter.
    fn judged(&self, group: Group, arbiter: &Reference, rays: &[Ray], mut budget: Budget) -> CaseCounts {
        let mut tally = CaseCounts::default();
        let mut scratch = I::Scratch::default();
        let mut rest = rays;
        while !rest.is_empty() {
            // Fewer rays at a time if each has many contacts, to save memory.
            let mut examined = Vec::new();
            let end = budget.left().saturating_sub(CHUNK_UNITS);
            while examined.len() < CHUNK.min(rest.len()) && (examined.is_empty() || budget.left() > end) {
                let Some(of_one) = arbiter.examine_within(&rest[examined.len()], &mut budget) else { break };
                examined.push(of_one);
            }
            if examined.is_empty() {
                tally.left_out += rest.len() as u64;
                break;
            }
            let (chunk, after) = rest.split_at(examined.len());
            rest = after;
            let answers: Vec<(Vec<Hit>, Vec<bool>)> = self
                .ways
                .iter()
                .map(|way| (way.closest(chunk, &mut scratch), way.occluded(chunk, &mut scratch)))
                .collect();
            for (k, (ray, examined)) in chunk.iter().zip(&examined).enumerate() {
                let answers: Vec<(Hit, bool)> = answers.iter().map(|(hits, blocked)| (hits[k], blocked[k])).collect();
                let faults: Vec<String> =
                    answers.iter().filter_map(|a| self.fault(group, examined, a, &answers[0].0)).collect();
                tally.check_all(answers.len() as u64, faults.len() as u64, || {
                    let (truth, hit) = (examined.truth(), &answers[0].0);
                    let (geometry, primitive) =
                        if truth.is_hit() { (truth.geometry, truth.primitive) } else { (hit.geometry, hit.primitive) };
                    let place = if (geometry as usize) < self.scene.objects.len() {
                        TriangleLocation::of(self.scene, geometry, primitive).to_string()
                    } else {
                        String::from("nowhere")
                    };
                    let truth =
                        Hit { t: truth.t as f32, geometry: truth.geometry, primitive: truth.primitive, ..Hit::MISS };
                    let blocked = |yes: bool| if yes { "blocked" } else { "not blocked" };
                    let says = self.ways.iter().zip(&answers);
                    let says = says.map(|(way, (hit, b))| (way.name, format!("{}; {}", self.hit(hit), blocked(*b))));
                    let all: Vec<_> = [("f64", self.hit(&truth))].into_iter().chain(says).collect();
                    self.failure(&format!("{place}: {}", faults[0]), ray, &all)
                });
            }
        }
        tally
    }

    /// Returns the fault of one traversal's answers, if the group tests for it.
    fn fault(&self, group: Group, examined: &Examined, answers: &(Hit, bool), first: &Hit) -> Option<String> {
        let counts = |fault: Fault| group == Group::Parity || matches!(fault, Fault::Leak | Fault::MissedHit);
        let judged = [examined.judge(&answers.0), examined.judge_occluded(answers.1)];
        let fault = judged.into_iter().find_map(|v| match v {
            Verdict::Wrong(fault) if counts(fault) => Some(fault_name(fault).replace('_', " ")),
            _ => None,
        });
        let differs = group == Group::Parity && self.exact && bits(&answers.0) != bits(first);
        fault.or_else(|| differs.then(|| format!("other bits than {}", self.ways[0].name)))
    }

    /// Describes a hit in words.
    fn hit(&self, hit: &Hit) -> String {
        match self.scene.objects.get(hit.geometry as usize) {
            Some(object) if hit.is_hit() => format!("triangle {} of `{}` at t = {}", hit.primitive, object.name, hit.t),
            _ => String::from("nothing"),
        }
    }

    /// Returns the report of a failure: the fault, the ray, the answers, and the command that repeats it, one per line.
    fn failure(&self, what: &str, ray: &Ray, answers: &[(&str, String)]) -> String {
        let mut text = format!("{what}\n  {:<7} {}", "ray", shown::ray(ray));
        if !self.scene.is_in_world_coordinates() {
            let start = self.scene.world(ray.origin.as_dvec3());
            text += &format!("; numbers count from the scene's origin, in the world it starts at {start}");
        }
        for (path, answer) in answers {
            text += &format!("\n  {path:<7} {answer}");
        }
        text + &format!("\n  {:<7} {}", "repeat", shown::command(self.name, ray))
    }
}

/// Returns the number of `rays` traced together for which `budget` suffices. Of cheap rays one in eight is measured and
/// counts eight times.
fn measured(arbiter: &Reference, rays: &[Ray], budget: &mut Budget) -> usize {
    let end = budget.left().saturating_sub(CHUNK_UNITS);
    let mut count = 0;
    while count < CHUNK.min(rays.len()) && (count == 0 || budget.left() > end) {
        let before = budget.left();
        if arbiter.examine_within(&rays[count], budget).is_none() {
            break;
        }
        let units = before - budget.left();
        let alike = if units > CHUNK_UNITS / CHUNK as u64 { 1 } else { 8 };
        budget.spend((alike - 1) * units);
        count += alike as usize;
    }
    count.min(rays.len())
}

fn bits(h: &Hit) -> ([u32; 3], (u32, u32, u32)) {
    ([h.t, h.u, h.v].map(f32::to_bits), h.id())
}

/// Generator of rays at a scene.
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

    /// Returns a ray of unit direction: at a corner, at a point of an edge, or into the scene. With `anyhow` only one
    /// in four is aimed.
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
