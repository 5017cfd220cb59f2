//! Rays that leave a surface: reflected, refracted and towards a light, started by the rule of [`Spot`]. None may hit
//! the surface that it leaves, and none may miss another one a few error bounds away.

use glam::{DVec3, Vec3};

use super::VerifyPlan;
use super::candidate::Candidate;
use super::meshes::{Closed, Pair, of_triangles, opaque};
use super::tally::CaseCounts;
use crate::Result;
use crate::accel::Intersector;
use crate::geometry::{Geometry, GeometryMask, Hit, Plane, Ray, Shape, Sphere, Spot};
use crate::math::Vector3;
use crate::measure::sample::Rng;
use crate::optics::{Boundary, reflect};
use crate::trial::shown;

pub(super) const MESHES: [Closed; 4] = [Closed::Ball, Closed::Bumpy, Closed::Spindle, Closed::Cube];

/// Number of rays traced together.
const CHUNK: usize = 1024;

/// Distance of two surfaces, in error bounds, at which both must be hit.
const APART: f64 = 4.0;

pub(super) fn batch<C: Candidate>(candidate: &C, plan: &VerifyPlan, pairs: &[Pair], i: usize) -> Result<CaseCounts> {
    let pair = &pairs[i];
    let mut rng = Rng::new("self-hits", i);
    let mut tally = CaseCounts::default();
    let wanted = plan.sized(4_000_000, 200_000).div_ceil(pairs.len() as u64);
    let mut geometry = vec![opaque(pair.mesh.clone())];
    leave(candidate, &geometry, pair, wanted * 3 / 4, &mut rng, &mut tally)?;
    let ball = Sphere { centre: pair.centre.as_vec3(), radius: pair.half.max_element() as f32 };
    geometry[0].shape = Shape::Sphere(ball);
    leave(candidate, &geometry, pair, wanted / 4, &mut rng, &mut tally)?;
    planes(candidate, pair, &mut rng, &mut tally)?;
    plates(candidate, pair, &mut rng, &mut tally)?;
    Ok(tally)
}

/// Purpose of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sent {
    Reflected,
    Refracted,
    Shadow,
}

/// Ray that leaves a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaving {
    pub ray: Ray,
    pub sent: Sent,
    /// Hit from which it starts.
    pub from: Hit,
    /// True if it continues outside the shape.
    outside: bool,
}

/// Returns the three rays that may leave where `ray`, of unit direction, hit `hit`.
pub(super) fn leaving(geometry: &[Geometry], ray: &Ray, hit: &Hit, rng: &mut Rng) -> Vec<Leaving> {
    let spot = Spot::at(&geometry[hit.geometry as usize].shape, ray, hit);
    let incident = Vector3::from(ray.dir);
    if !(spot.reach.is_finite() && spot.outward.x.is_finite()) {
        // A triangle without area has no side.
        return Vec::new();
    }
    let front = incident.dot(spot.outward) < 0.0;
    let normal = if front { spot.outward } else { -spot.outward };
    let mut rays = Vec::with_capacity(3);
    let mut send = |dir: Vector3<f32>, above: bool, sent| {
        let side = if above { normal } else { -normal };
        if dir.dot(side) > 0.0 {
            let ray = Ray::new(spot.leave(side).into(), dir.into());
            rays.push(Leaving { ray, sent, from: *hit, outside: above == front });
        }
    };
    send(reflect(incident, normal), true, Sent::Reflected);
    let boundary = if front { Boundary::new(1.0, 1.5) } else { Boundary::new(1.5, 1.0) };
    let at = boundary.cross(-incident.dot(normal));
    if !at.total {
        send(boundary.refract(incident, normal, &at), false, Sent::Refracted);
    }
    // Towards a light anywhere above, often low over the surface.
    let n = Vec3::from(normal).as_dvec3();
    let across = n.cross(rng.direction()).normalize_or(n.any_orthonormal_vector());
    let height = if rng.below(2) == 0 { rng.unit() } else { 10.0_f64.powf(rng.between(-6.0, 0.0)) };
    let towards = across * (1.0 - height * height).max(0.0).sqrt() + n * height;
    send(towards.as_vec3().into(), true, Sent::Shadow);
    rays
}

/// Sends rays at the single shape of `geometry` from outside and inside, and rays that leave from their hits.
fn leave<C: Candidate>(
    candidate: &C,
    geometry: &[Geometry],
    pair: &Pair,
    wanted: u64,
    rng: &mut Rng,
    tally: &mut CaseCounts,
) -> Result<()> {
    let ways = candidate.build(geometry)?;
    let mut scratch = <C::Accel as Intersector>::Scratch::default();
    let is_ball = matches!(geometry[0].shape, Shape::Sphere(_));
    // Rays behind a flat face of the cube stay inside; the rounded facets of the others may see each other.
    let convex = is_ball || pair.shape == Closed::Cube;
    let mut left = wanted as i64;
    while left > 0 {
        let arriving: Vec<Ray> = (0..CHUNK.min(left as usize / 2 + 8)).map(|k| arriving(rng, pair, k)).collect();
        let hits = ways[0].closest(&arriving, &mut scratch);
        let spawned: Vec<Leaving> = arriving
            .iter()
            .zip(&hits)
            .filter(|(_, hit)| hit.is_hit())
            .flat_map(|(ray, hit)| leaving(geometry, ray, hit, rng))
            .collect();
        left -= (spawned.len() as i64).max(1);
        let rays: Vec<Ray> = spawned.iter().map(|l| l.ray).collect();
        let mut caught: Vec<Vec<&str>> = vec![Vec::new(); rays.len()];
        for way in &ways {
            for ((caught, hit), l) in caught.iter_mut().zip(way.closest(&rays, &mut scratch)).zip(&spawned) {
                let again = if l.outside && convex {
                    hit.is_hit()
                } else if is_ball {
                    // From inside, the ball is hit at the far side, 2 r cos away.
                    hit.is_hit() && f64::from(hit.t) < way_through(l, pair)
                } else {
                    hit.is_hit() && hit.id() == l.from.id()
                };
                if again {
                    caught.push(way.name);
                }
            }
        }
        for (l, caught) in spawned.iter().zip(caught) {
            tally.check(caught.is_empty(), || {
                let what = if is_ball { "exact sphere like " } else { "" };
                let names = caught.join(", ");
                let ray = shown::ray(&l.ray);
                format!("{names}: {:?} ray meets what it leaves, {what}{}: {ray}", l.sent, pair.name)
            });
        }
    }
    Ok(())
}

/// Returns half the path through the ball from the origin of `l`, in `f64`.
fn way_through(l: &Leaving, pair: &Pair) -> f64 {
    let to_centre = f64::from(pair.half.max_element() as f32);
    let inwards = (pair.centre.as_vec3().as_dvec3() - l.ray.origin.as_dvec3()) / to_centre;
    let along = inwards.dot(l.ray.dir.as_dvec3());
    along * to_centre
}

/// Returns a ray of unit direction from outside or inside, at a corner, at the middle of an edge, or anywhere.
fn arriving(rng: &mut Rng, pair: &Pair, k: usize) -> Ray {
    let mesh = &pair.mesh;
    let from = if k.is_multiple_of(4) {
        pair.centre + rng.point() * pair.half * 0.25
    } else {
        pair.centre + rng.direction() * pair.half.length() * rng.between(1.1, 6.0)
    };
    let [a, b, c] = mesh.corners(rng.below(mesh.triangles.len())).map(Vec3::as_dvec3);
    let target = match k % 3 {
        0 => a,
        1 => a.lerp(b, rng.unit()),
        _ => {
            let (u, v) = (rng.unit(), rng.unit());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            a + (b - a) * u + (c - a) * v
        }
    };
    Ray::new(from.as_vec3(), (target - from).normalize().as_vec3())
}

/// Tests infinite planes along an axis and tilted, through the position of `pair` and through or near the origin, at
/// heights of all exponents. Rays that leave a plane on either side must miss it.
fn planes<C: Candidate>(candidate: &C, pair: &Pair, rng: &mut Rng, tally: &mut CaseCounts) -> Result<()> {
    let mut scratch = <C::Accel as Intersector>::Scratch::default();
    let size = pair.half.max_element();
    for k in 0..8 {
        let normal = if k % 2 == 0 { Vec3::AXES[rng.below(3)] } else { rng.direction().as_vec3().normalize() };
        let height = if k < 2 { 0.0 } else { size * 10.0_f64.powf(rng.between(-42.0, 0.0)) };
        let anchor = if k < 6 { DVec3::ZERO } else { pair.centre };
        let point = (anchor + normal.as_dvec3() * height).as_vec3();
        let shape = Shape::Plane(Plane { point, normal });
        let geometry = [Geometry { shape, mask: GeometryMask::OPAQUE }];
        let ways = candidate.build(&geometry)?;
        let arriving: Vec<Ray> = (0..32)
            .map(|_| {
                let target = point.as_dvec3() + rng.point() * size;
                let from = target + rng.direction() * (size * 10.0_f64.powf(rng.between(-1.0, 5.0)));
                Ray::new(from.as_vec3(), (target - from).normalize().as_vec3())
            })
            .collect();
        for way in &ways {
            let hits = way.closest(&arriving, &mut scratch);
            let met = arriving.iter().zip(&hits).filter(|(_, hit)| hit.is_hit());
            let left: Vec<Leaving> = met.flat_map(|(ray, hit)| leaving(&geometry, ray, hit, rng)).collect();
            let rays: Vec<Ray> = left.iter().map(|l| l.ray).collect();
            for (l, hit) in left.iter().zip(way.closest(&rays, &mut scratch)) {
                tally.check(!hit.is_hit(), || {
                    format!(
                        "{}: {:?} ray meets the plane it leaves, {normal} at {point}: {:?}",
                        way.name, l.sent, l.ray
                    )
                });
            }
        }
    }
    Ok(())
}

/// Tests two parallel plates a few error bounds apart, at the scale and position of `pair`. A ray from one towards the
/// other must hit it.
fn plates<C: Candidate>(candidate: &C, pair: &Pair, rng: &mut Rng, tally: &mut CaseCounts) -> Result<()> {
    let mut scratch = <C::Accel as Intersector>::Scratch::default();
    // The gap is up to a third of a plate's size if that spans only 256 ulps, so rays are aimed well inside.
    for _ in 0..8 {
        let n = rng.direction();
        let (x, y) = n.any_orthonormal_pair();
        let size = pair.half.max_element();
        let corner = |s: f64, t: f64| pair.centre + (x * s + y * t) * size;
        let at = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let plate = |shift: DVec3| {
            let [a, b, c, d] = at.map(|p| (p + shift).as_vec3());
            [[a, b, c], [a, c, d]]
        };
        let reach = plate(DVec3::ZERO)
            .iter()
            .flat_map(|t| {
                [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(u, v)| Spot::on_triangle(t.map(Vector3::from), u, v))
            })
            .map(|s| f64::from(s.reach))
            .fold(0.0, f64::max);
        let gap = APART * reach;
        let shape = |triangles| Geometry { shape: Shape::Mesh(of_triangles(triangles)), mask: GeometryMask::OPAQUE };
        let geometry = [shape(plate(DVec3::ZERO)), shape(plate(-n * gap))];
        let ways = candidate.build(&geometry)?;
        // At the upper plate from above and at the lower one from below, both towards the other plate.
        for (side, hit_first) in [(1.0, 0), (-1.0, 1)] {
            let arriving: Vec<Ray> = (0..32)
                .map(|_| {
                    let over = n * side + x * rng.between(-0.7, 0.7) + y * rng.between(-0.7, 0.7);
                    let target = corner(rng.between(-0.25, 0.25), rng.between(-0.25, 0.25));
                    let from = target + over * size;
                    Ray::new(from.as_vec3(), (target - from).normalize().as_vec3())
                })
                .collect();
            for way in &ways {
                let hits = way.closest(&arriving, &mut scratch);
                let through: Vec<Ray> = arriving
                    .iter()
                    .zip(&hits)
                    .filter(|(_, hit)| hit.is_hit())
                    .map(|(ray, hit)| {
                        let spot = Spot::at(&geometry[hit.geometry as usize].shape, ray, hit);
                        let outward = Vec3::from(spot.outward);
                        let down = if ray.dir.dot(outward) > 0.0 { outward } else { -outward };
                        Ray::new(spot.leave(down.into()).into(), ray.dir)
                    })
                    .collect();
                let next = way.closest(&through, &mut scratch);
                for (ray, hit) in arriving.iter().zip(&hits) {
                    let holds = hit.geometry == hit_first;
                    tally.check(holds, || {
                        let ray = shown::ray(ray);
                        format!("{}: plate {hit_first} overlooked, {}: {ray}", way.name, pair.name)
                    });
                }
                for (ray, hit) in through.iter().zip(&next) {
                    let holds = hit.geometry == 1 - hit_first;
                    tally.check(holds, || {
                        let ray = shown::ray(ray);
                        format!("{}: plate {gap:e} behind another overlooked, {}: {ray}", way.name, pair.name)
                    });
                }
            }
        }
    }
    Ok(())
}
