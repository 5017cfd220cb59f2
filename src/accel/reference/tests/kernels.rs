//! The judge against two `f32` kernels written out here: a watertight one, which must never be found wrong, and a
//! leaky one, which must be.

use glam::Vec3;

use super::shapes::{Numbers, ball, geometry, mesh};
use crate::accel::reference::{Fault, Reference, Verdict};
use crate::geometry::{Hit, Ray, Shape, TriMesh};

/// Woop, Benthin & Wald 2013 in plain `f32`, edge tests in `f64` where they come out 0.
fn woop(ray: &Ray, [a, b, c]: [Vec3; 3]) -> Option<(f32, f32, f32)> {
    let z = ray.dir.abs().max_position();
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let (sx, sy, sz) = (ray.dir[x] / ray.dir[z], ray.dir[y] / ray.dir[z], 1.0 / ray.dir[z]);
    let shear = |p: Vec3| {
        let p = p - ray.origin;
        (p[x] - sx * p[z], p[y] - sy * p[z], sz * p[z])
    };
    let (a, b, c) = (shear(a), shear(b), shear(c));
    let edge = |p: (f32, f32, f32), q: (f32, f32, f32)| p.0 * q.1 - p.1 * q.0;
    let mut edges = [edge(c, b), edge(a, c), edge(b, a)];
    if edges.contains(&0.0) {
        let edge = |p: (f32, f32, f32), q: (f32, f32, f32)| {
            (f64::from(p.0) * f64::from(q.1) - f64::from(p.1) * f64::from(q.0)) as f32
        };
        edges = [edge(c, b), edge(a, c), edge(b, a)];
    }
    let [u, v, w] = edges;
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return None;
    }
    let whole = u + v + w;
    (whole != 0.0).then(|| ((u * a.2 + v * b.2 + w * c.2) / whole, v / whole, w / whole))
}

/// Moeller & Trumbore 1997 in plain `f32`.
fn moeller_trumbore(ray: &Ray, [a, b, c]: [Vec3; 3]) -> Option<(f32, f32, f32)> {
    let (e1, e2) = (b - a, c - a);
    let p = ray.dir.cross(e2);
    let det = e1.dot(p);
    let s = ray.origin - a;
    let u = s.dot(p) / det;
    let q = s.cross(e1);
    let v = ray.dir.dot(q) / det;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| (e2.dot(q) / det, u, v))
}

type Kernel = fn(&Ray, [Vec3; 3]) -> Option<(f32, f32, f32)>;

fn nearest(kernel: Kernel, ray: &Ray, mesh: &TriMesh) -> Hit {
    let mut best = Hit::MISS;
    for i in 0..mesh.triangles.len() {
        let met = kernel(ray, mesh.corners(i)).filter(|&(t, ..)| t > ray.t_min && t <= ray.t_max && t < best.t);
        if let Some((t, u, v)) = met {
            best = Hit { t, u, v, instance: 0, geometry: 0, primitive: i as u32 };
        }
    }
    best
}

/// Verdicts on `rays` rays within and around a mesh, half of them aimed at corners and edges.
#[derive(Default, Debug)]
struct Count {
    agree: u32,
    undecidable: u32,
    leaks: u32,
    other_faults: Vec<(Ray, Hit, Verdict)>,
}

fn count(kernel: Kernel, mesh: &TriMesh, centre: Vec3, size: f32, rays: usize) -> Count {
    let world = Reference::build(&[geometry(Shape::Mesh(mesh.clone()))]);
    let mut numbers = Numbers(11);
    let mut judged = Count::default();
    for k in 0..rays {
        let [a, b, c] = mesh.corners(k % mesh.triangles.len());
        let target = match k % 4 {
            0 => a,
            1 => (b + c) * 0.5,
            2 => a * 0.2 + b * 0.3 + c * 0.5,
            _ => centre + numbers.vector() * size,
        };
        let origin = centre + numbers.vector() * size * if k % 3 == 0 { 0.4 } else { 5.0 };
        let ray = Ray::new(origin, target - origin);
        let claim = nearest(kernel, &ray, mesh);
        match world.judge(&ray, &claim) {
            Verdict::Agrees => judged.agree += 1,
            Verdict::Undecidable(_, margin) => {
                assert!(margin.distance <= margin.bound, "{margin:?}");
                judged.undecidable += 1;
            }
            Verdict::Wrong(Fault::Leak) => judged.leaks += 1,
            wrong => judged.other_faults.push((ray, claim, wrong)),
        }
    }
    judged
}

const PLACES: [(Vec3, f32); 4] =
    [(Vec3::ZERO, 1.0), (Vec3::new(148_376.0, 1234.0, -223_423.0), 100.0), (Vec3::ZERO, 1e-8), (Vec3::ZERO, 1e8)];

#[test]
fn a_watertight_kernel_is_never_wrong_and_mostly_decidable() {
    for (centre, radius) in PLACES {
        let count = count(woop, &ball(centre, radius, 10), centre, radius, 4000);
        assert_eq!((count.leaks, count.other_faults.len()), (0, 0), "{centre} {radius}: {count:?}");
        assert!(count.agree > 2400, "{centre} {radius}: {} agree, {} undecidable", count.agree, count.undecidable);
    }
}

#[test]
fn a_leaky_kernel_is_caught_leaking() {
    let leaky = count(moeller_trumbore, &ball(Vec3::ZERO, 1.0, 10), Vec3::ZERO, 1.0, 4000);
    assert!(leaky.leaks > 50, "{leaky:?}");
    assert!(leaky.other_faults.is_empty(), "{leaky:?}");
}

#[test]
fn slivers_excuse_what_they_must_and_no_more() {
    let mut numbers = Numbers(5);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..300 {
        let a = numbers.vector() * 4.0;
        let along = numbers.vector();
        positions.extend([a, a + along, a + along * 0.6 + numbers.vector() * 1e-4]);
        triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let shape = mesh(positions, triangles);
    let Shape::Mesh(slivers) = &shape.shape else { unreachable!() };
    let tight = count(woop, slivers, Vec3::ZERO, 4.0, 4000);
    assert!(tight.other_faults.is_empty(), "{:?}", &tight.other_faults[..1]);
    assert!(tight.agree > 1000, "{tight:?}");
    // Its `t` is no mean of the corners' depths, and falls outside them on slivers (Embree issue 387).
    let loose = count(moeller_trumbore, slivers, Vec3::ZERO, 4.0, 4000);
    let of_t = |f: &&(Ray, Hit, Verdict)| f.2 == Verdict::Wrong(Fault::TOutOfBounds);
    assert!(loose.other_faults.iter().filter(of_t).count() > 0);
    assert!(loose.other_faults.iter().all(|f| of_t(&f)), "{:?}", loose.other_faults);
}
