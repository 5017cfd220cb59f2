//! Hits against testing every triangle: to the bit if the back end promises it, else by the `f64` arbiter.

use std::collections::HashSet;

use glam::{DVec3, Vec3};

use super::VerifyPlan;
use super::candidate::Candidate;
use super::meshes::{Closed, of_triangles, opaque, unit};
use super::tally::CaseCounts;
use crate::Result;
use crate::accel::Intersector;
use crate::accel::reference::{Reference, Verdict};
use crate::geometry::{Geometry, Hit, Ray, Shape, TriMesh, intersect_triangle};
use crate::measure::sample::Rng;
use crate::trial::shown;

/// Number of scenes of odd meshes.
const SCENES: usize = 20;
/// Number of batches per scene.
const PARTS: usize = 8;

pub(super) const BATCHES: usize = SCENES * PARTS;

pub(super) fn batch<C: Candidate>(candidate: &C, plan: &VerifyPlan, i: usize) -> Result<CaseCounts> {
    let (name, geometry) = scene(i / PARTS);
    let mut rng = Rng::new("traversal", i);
    let mut tally = CaseCounts::default();
    let mut scratch = <C::Accel as Intersector>::Scratch::default();
    // If all hits are equally near, no box can be skipped, and a ray costs as much as a hundred thousand triangles.
    // That is too much for a quick run, and for the arbiter, which tests each in `f64`.
    let many = geometry.iter().any(|g| matches!(&g.shape, Shape::Mesh(m) if m.triangles.len() > 50_000));
    let share = if many && !(plan.full && candidate.is_exact()) { 50 } else { 1 };
    let rays = rays(&geometry, plan.sized(100_000, 2_000) as usize / share / PARTS, &mut rng);
    let ways = candidate.build(&geometry)?;
    let all = (candidate.is_exact()).then(|| Everything::of(&geometry));
    let want: Vec<Hit> = all.iter().flat_map(|all| rays.iter().map(|ray| all.closest(ray))).collect();
    let arbiter = all.is_none().then(|| Reference::build(&geometry));
    for way in &ways {
        let (hits, blocked) = (way.closest(&rays, &mut scratch), way.occluded(&rays, &mut scratch));
        for (k, ray) in rays.iter().enumerate() {
            let (hit, blocked) = (&hits[k], blocked[k]);
            let fault = match &arbiter {
                None => {
                    let bits = |h: &Hit| ([h.t, h.u, h.v].map(f32::to_bits), h.id());
                    let same = bits(hit) == bits(&want[k]) && blocked == want[k].is_hit();
                    (!same).then(|| format!("{hit:?} (blocked: {blocked}) instead of {:?}", want[k]))
                }
                Some(arbiter) => {
                    let examined = arbiter.examine(ray);
                    match (examined.judge(hit), examined.judge_occluded(blocked)) {
                        (Verdict::Wrong(fault), _) | (_, Verdict::Wrong(fault)) => Some(format!("{fault:?}: {hit:?}")),
                        _ => None,
                    }
                }
            };
            tally.check(fault.is_none(), || {
                format!("{}, {name}: {} for a ray {}", way.name, fault.unwrap_or_default(), shown::ray(ray))
            });
        }
    }
    Ok(tally)
}

/// Triangles to be tested one after the other. Of triangles with the same corners only the first is kept, which wins
/// ties.
struct Everything {
    triangles: Vec<([Vec3; 3], u32, u32)>,
}

impl Everything {
    fn of(geometry: &[Geometry]) -> Self {
        let mut seen = HashSet::new();
        let mut triangles = Vec::new();
        for (g, id) in geometry.iter().zip(0..) {
            let Shape::Mesh(mesh) = &g.shape else { continue };
            for i in (0..mesh.triangles.len()).filter(|&i| mesh.is_usable(i)) {
                let corners = mesh.corners(i);
                if seen.insert(corners.map(|p| p.to_array().map(f32::to_bits))) {
                    triangles.push((corners, id, i as u32));
                }
            }
        }
        Self { triangles }
    }

    fn closest(&self, ray: &Ray) -> Hit {
        let mut best = Hit::MISS;
        for &(corners, geometry, primitive) in &self.triangles {
            if let Some((t, u, v)) = intersect_triangle(ray, corners) {
                let hit = Hit { t, u, v, instance: 0, geometry, primitive };
                if t < best.t || (t == best.t && hit.id() < best.id()) {
                    best = hit;
                }
            }
        }
        best
    }
}

/// Returns rays from everywhere, most of them at corners, edges and middles of triangles, some along axes, some with
/// ends.
fn rays(geometry: &[Geometry], count: usize, rng: &mut Rng) -> Vec<Ray> {
    let meshes: Vec<&TriMesh> =
        geometry.iter().filter_map(|g| if let Shape::Mesh(m) = &g.shape { Some(m) } else { None }).collect();
    (0..count)
        .map(|k| {
            let mesh = meshes[rng.below(meshes.len())];
            let [a, b, c] = mesh.corners(rng.below(mesh.triangles.len())).map(Vec3::as_dvec3);
            let size = (b - a).length().max((c - a).length()).max(1e-6);
            let target = match k % 4 {
                0 => a,
                1 => a.lerp(b, rng.unit()),
                2 => a + (b - a) * 0.5 * rng.unit() + (c - a) * 0.5 * rng.unit(),
                _ => rng.point() * size + a,
            };
            let away = rng.direction() * size * [0.5, 3.0, 30.0, 1000.0][rng.below(4)];
            let mut dir = -away;
            let mut from = target + away;
            match k % 7 {
                0 => dir[rng.below(3)] = 0.0,
                1 => {
                    let axis = rng.below(3);
                    dir = DVec3::AXES[axis] * if rng.below(2) == 0 { size } else { -size };
                    from = target - dir * 2.0;
                }
                _ => {}
            }
            let mut ray = Ray::new(from.as_vec3(), dir.as_vec3());
            if k % 5 == 0 {
                (ray.t_min, ray.t_max) = (0.25, rng.between(0.5, 2.0) as f32);
            }
            ray
        })
        .collect()
}

/// Returns the `i`th scene of odd meshes.
fn scene(i: usize) -> (&'static str, Vec<Geometry>) {
    let (e, x, y) = (Vec3::ZERO, Vec3::X, Vec3::Y);
    let base = [e, x, y];
    let one = |name, mesh| (name, vec![opaque(mesh)]);
    let mut rng = Rng::new("odd meshes", i);
    match i {
        0 => one("one triangle", of_triangles([base])),
        1 => one("two that share an edge", shared(vec![e, x, y, x + y], vec![[0, 1, 2], [1, 3, 2]])),
        2 => {
            let c = x * 0.5;
            one("corners that coincide", of_triangles([base, [e, e, x], [x, x, x], [e, c, c], [y, e, x]]))
        }
        3 => one("corners in line", of_triangles([base, [e, x, x * 2.0], [e, x * 0.5, x], [y, x, (x + y) * 0.5]])),
        4 => one("one triangle 100 000 times", shared(base.to_vec(), vec![[0, 1, 2]; 100_000])),
        5 => one("each twice", of_triangles((0..200).map(|k| base.map(|p| p + Vec3::Z * (k / 2) as f32)))),
        6 => one("sizes that double", of_triangles((0..100).map(|k| base.map(|p| p * 2.0_f32.powi(50 - k))))),
        7 => {
            let beside = |k: i32| base.map(|p| p * 2.0_f32.powi(-k) + Vec3::splat(2.0_f32.powi(-k)));
            one("sizes that double, side by side", of_triangles((0..90).map(beside)))
        }
        8 => {
            let tiny = |k: i32| base.map(|p| if k == 0 { p * 1e7 } else { p * 1e-3 + Vec3::splat(k as f32 * 1e-2) });
            one("a giant beside the tiny", of_triangles((0..400).map(tiny)))
        }
        9 => one("a lattice on whole numbers", lattice(16)),
        10 => one("one in the other", of_triangles((1..300).map(|k| [x, y, -x - y].map(|p| p * k as f32)))),
        11 => one("in a row", of_triangles((0..600).map(|k| base.map(|p| p + x * k as f32)))),
        12 => one("a soup", soup(500, 0.3, 1.0, &mut rng)),
        13 => one("a soup of needles", soup(500, 1.0, 1e-5, &mut rng)),
        14 => one("a fan of 64", fan(64)),
        15 => one("a closed ball", unit(Closed::Crumpled)),
        16 => one("a spindle of slivers", unit(Closed::Spindle)),
        17 => {
            let mut far = unit(Closed::Bumpy);
            far.positions.iter_mut().for_each(|p| *p += Vec3::new(148_376.0, 1_234.0, -223_423.0));
            one("a ball far off", far)
        }
        18 => {
            let cube = unit(Closed::Cube);
            ("the same mesh in three objects", vec![opaque(cube.clone()), opaque(unit(Closed::Ball)), opaque(cube)])
        }
        _ => {
            let huge = |k: i32| base.map(|p| p * if k % 2 == 0 { 1e9 } else { -1e9 } + Vec3::splat(k as f32));
            one("as large as a planet's orbit", of_triangles((0..100).map(huge)))
        }
    }
}

fn shared(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> TriMesh {
    TriMesh { positions, triangles, ..TriMesh::default() }
}

fn lattice(n: u32) -> TriMesh {
    let positions = (0..=n).flat_map(|y| (0..=n).map(move |x| Vec3::new(x as f32, y as f32, 0.0))).collect();
    let at = |x: u32, y: u32| y * (n + 1) + x;
    let square = |x, y| [[at(x, y), at(x + 1, y), at(x + 1, y + 1)], [at(x, y), at(x + 1, y + 1), at(x, y + 1)]];
    shared(positions, (0..n).flat_map(|y| (0..n).flat_map(move |x| square(x, y))).collect())
}

fn fan(n: u32) -> TriMesh {
    let rim = |k: u32| (f64::from(k) * std::f64::consts::TAU / f64::from(n)).sin_cos();
    let mut positions = vec![Vec3::new(0.1, 0.2, 0.3)];
    positions.extend((0..n).map(rim).map(|(s, c)| DVec3::new(c, s, 0.2 * c * s).as_vec3()));
    shared(positions, (0..n).map(|k| [0, 1 + k, 1 + (k + 1) % n]).collect())
}

/// Returns triangles anywhere in a cube, of a size, `width` times as wide as they are long.
fn soup(n: usize, size: f64, width: f64, rng: &mut Rng) -> TriMesh {
    of_triangles((0..n).map(|_| {
        let (a, along, aside) = (rng.point(), rng.point() * size, rng.point() * size);
        [a, a + along, a + along * rng.unit() + aside * width].map(DVec3::as_vec3)
    }))
}
