//! Hierarchies over garbage: any bits as coordinates, random indices. Nothing may panic, geometry that cannot be hit
//! must be counted, and the hierarchy must be valid. Also reports the size of a hierarchy of ordinary triangles.

use std::panic::{AssertUnwindSafe, catch_unwind};

use glam::Vec3;

use super::VerifyPlan;
use super::candidate::Candidate;
use super::meshes::opaque;
use super::tally::CaseCounts;
use super::tally::Worst;
use crate::Result;
use crate::accel::Intersector;
use crate::geometry::{Geometry, GeometryMask, Ray, Shape, Sphere, TriMesh};
use crate::measure::sample::Rng;

pub(super) const BATCHES: usize = 20;

/// Number of meshes per scene.
const MESHES: usize = 20;

pub(super) fn batch<C: Candidate>(candidate: &C, plan: &VerifyPlan, i: usize) -> Result<CaseCounts> {
    let mut rng = Rng::new("builds", i);
    let mut tally = CaseCounts::default();
    if i == 0 {
        weight(candidate, &mut tally)?;
    }
    for _ in 0..plan.sized(1000, 40) / BATCHES as u64 {
        let geometry: Vec<Geometry> = (0..MESHES).map(|_| garbage(&mut rng)).collect();
        let triangles = |g: &Geometry| if let Shape::Mesh(m) = &g.shape { m.triangles.len() } else { 1 };
        let all: usize = geometry.iter().map(triangles).sum();
        let usable: usize = geometry.iter().map(usable).sum();
        let rays: Vec<Ray> = (0..64).map(|_| any_ray(&mut rng)).collect();
        // Panics are caught and reported; their messages have gone to standard error.
        let built = catch_unwind(AssertUnwindSafe(|| -> Result<_> {
            let ways = candidate.build(&geometry)?;
            let mut scratch = <C::Accel as Intersector>::Scratch::default();
            for way in &ways {
                way.closest(&rays, &mut scratch);
                way.occluded(&rays, &mut scratch);
            }
            let stats = ways[0].accel.build_stats();
            Ok((stats, candidate.validate(&geometry)))
        }));
        let fault = match built {
            Err(_) => Some(String::from("a panic")),
            Ok(built) => match built? {
                (_, Err(unsound)) => Some(unsound),
                (s, Ok(())) if s.dropped != all - usable || s.triangles + s.spheres != usable => {
                    let (kept, dropped) = (s.triangles + s.spheres, s.dropped);
                    Some(format!("{kept} kept and {dropped} dropped of {all}, of which {usable} can be hit"))
                }
                _ => None,
            },
        };
        tally.check(fault.is_none(), || format!("garbage: {}", fault.unwrap_or_default()));
    }
    Ok(tally)
}

fn usable(g: &Geometry) -> usize {
    match &g.shape {
        Shape::Mesh(m) => (0..m.triangles.len()).filter(|&i| m.is_usable(i)).count(),
        Shape::Sphere(s) => usize::from(s.is_usable()),
        Shape::Plane(p) => usize::from(p.is_usable()),
    }
}

/// Creates a mesh of arbitrary bits, or, one time in eight, a sphere. Half of the meshes have small coordinates.
fn garbage(rng: &mut Rng) -> Geometry {
    if rng.below(8) == 0 {
        let centre = Vec3::new(rng.awkward(), rng.awkward(), rng.awkward());
        return Geometry { shape: Shape::Sphere(Sphere { centre, radius: rng.awkward() }), mask: GeometryMask::ALL };
    }
    let n = 1 + rng.below(255);
    let tame = rng.below(2) == 0;
    let positions: Vec<Vec3> = (0..n + 3)
        .map(|_| {
            if tame && rng.below(32) != 0 {
                rng.point().as_vec3()
            } else {
                Vec3::from_array([0; 3].map(|_| rng.awkward()))
            }
        })
        .collect();
    let triangles = (0..n as u32)
        .map(|k| if rng.below(32) == 0 { [0; 3].map(|_| rng.below(n + 3) as u32) } else { [k, k + 1, k + 2] })
        .collect();
    opaque(TriMesh { positions, triangles, ..TriMesh::default() })
}

fn any_ray(rng: &mut Rng) -> Ray {
    let mut ray = Ray::new((rng.point() * 2.0).as_vec3(), rng.direction().as_vec3());
    if rng.below(2) == 0 {
        ray.origin[rng.below(3)] = rng.awkward();
        ray.dir[rng.below(3)] = rng.awkward();
    }
    ray
}

/// Reports the bytes per triangle for a hilly surface of 32 768 triangles. There is no bound, since back ends count
/// differently.
fn weight<C: Candidate>(candidate: &C, tally: &mut CaseCounts) -> Result<()> {
    const N: u32 = 128;
    let height = |x: f32, z: f32| 0.05 * (9.0 * x).sin() * (7.0 * z).cos();
    let positions = (0..=N)
        .flat_map(|z| (0..=N).map(move |x| (x as f32 / N as f32, z as f32 / N as f32)))
        .map(|(x, z)| Vec3::new(x, height(x, z), z))
        .collect();
    let at = |x: u32, z: u32| z * (N + 1) + x;
    let square = |x, z| [[at(x, z), at(x, z + 1), at(x + 1, z)], [at(x + 1, z), at(x, z + 1), at(x + 1, z + 1)]];
    let triangles = (0..N).flat_map(|z| (0..N).flat_map(move |x| square(x, z))).collect();
    let ways = candidate.build(&[opaque(TriMesh { positions, triangles, ..TriMesh::default() })])?;
    let stats = ways[0].accel.build_stats();
    tally.pass();
    tally.note(Worst { what: "bytes a triangle", value: stats.bytes as f64 / stats.triangles as f64, bound: None });
    Ok(())
}
