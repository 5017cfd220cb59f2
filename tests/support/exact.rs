//! Rays and triangles in rational numbers: what is so, whatever any kernel rounds to.

use glam::Vec3;
use num_rational::BigRational;
use vitrum::accel::reference::Fault;
use vitrum::geometry::{Hit, Ray, TriMesh};

type Vector = [BigRational; 3];

fn number(x: f64) -> BigRational {
    BigRational::from_float(x).expect("a finite number")
}

fn vector(v: Vec3) -> Vector {
    v.to_array().map(|x| number(f64::from(x)))
}

fn minus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| &a[i] - &b[i])
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &a[j] * &b[k] - &a[k] * &b[j]
    })
}

fn dot(a: &Vector, b: &Vector) -> BigRational {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// A ray without any rounding.
struct Exact {
    origin: Vector,
    dir: Vector,
}

impl Exact {
    fn of(ray: &Ray) -> Self {
        Self { origin: vector(ray.origin), dir: vector(ray.dir) }
    }

    /// The ray with its start moved by `x` and `y` along the two axes that its direction is shortest along.
    fn moved(ray: &Ray, x: f64, y: f64) -> Self {
        let z = ray.dir.abs().max_position();
        let mut moved = Self::of(ray);
        moved.origin[(z + 1) % 3] += number(x);
        moved.origin[(z + 2) % 3] += number(y);
        moved
    }

    /// `t` in the plane of the triangle, and whether its line passes through the triangle, edges included. None where the
    /// line is parallel to it.
    fn meets(&self, corners: [Vec3; 3]) -> Option<(BigRational, bool)> {
        let zero = number(0.0);
        let [a, b, c] = corners.map(|p| minus(&vector(p), &self.origin));
        let normal = cross(&minus(&b, &a), &minus(&c, &a));
        let along = dot(&normal, &self.dir);
        if along == zero {
            return None;
        }
        let sides = [(&a, &b), (&b, &c), (&c, &a)].map(|(p, q)| dot(&cross(p, q), &self.dir));
        let inside = sides.iter().all(|s| *s >= zero) || sides.iter().all(|s| *s <= zero);
        Some((dot(&normal, &a) / along, inside))
    }
}

/// Returns true if `t` lies in the interval of `ray`.
fn sees(ray: &Ray, t: &BigRational) -> bool {
    let below = |end: f32| !end.is_finite() || *t <= number(f64::from(end));
    number(f64::from(ray.t_min)) < *t && below(ray.t_max)
}

/// Triangles that `ray` does not pass by at more than a hundred-thousandth of their distance, which `f64` tells: far more
/// than it rounds by, and ten times as far as any ray is moved here.
fn close(ray: &Ray, mesh: &TriMesh) -> Vec<usize> {
    let dir = ray.dir.as_dvec3();
    let passes = |i: &usize| {
        let [a, b, c] = mesh.corners(*i).map(|p| p.as_dvec3() - ray.origin.as_dvec3());
        let sides =
            [(a, b), (b, c), (c, a)].map(|(p, q)| dir.dot(p.cross(q)) / (dir.length() * p.length() * q.length()));
        !(sides.iter().any(|&s| s > 1e-5) && sides.iter().any(|&s| s < -1e-5))
    };
    (0..mesh.triangles.len()).filter(passes).collect()
}

/// Every triangle that the line of `ray` really passes through within its interval, with its `t`.
fn met(ray: &Ray, mesh: &TriMesh) -> Vec<(usize, BigRational)> {
    let exact = Exact::of(ray);
    let all = close(ray, mesh).into_iter().filter_map(|i| exact.meets(mesh.corners(i)).map(|m| (i, m)));
    all.filter(|(_, (t, inside))| *inside && sees(ray, t)).map(|(i, (t, _))| (i, t)).collect()
}

/// Returns true if the accusation that `claim`, an answer for `ray` among the triangles of `mesh`, has this fault is right.
pub fn confirms(fault: Fault, ray: &Ray, claim: &Hit, mesh: &TriMesh) -> bool {
    let claimed = claim.is_hit().then(|| number(f64::from(claim.t)));
    let nearer = || {
        let before = |t: &BigRational| claimed.as_ref().is_none_or(|claimed| t < claimed);
        met(ray, mesh).into_iter().filter(|(i, t)| *i as u32 != claim.primitive && before(t)).count() > 0
    };
    let of_claim = || Exact::of(ray).meets(mesh.corners(claim.primitive as usize));
    match fault {
        Fault::MissedHit => !claim.is_hit() && !met(ray, mesh).is_empty(),
        Fault::OtherPrimitive => claim.is_hit() && nearer(),
        Fault::Leak => {
            (if claim.is_hit() { nearer() } else { !met(ray, mesh).is_empty() }) && goes_on_around(ray, mesh)
        }
        Fault::FalseHit => !of_claim().is_some_and(|(t, inside)| inside && sees(ray, &t)),
        Fault::TOutOfBounds => {
            let reach = mesh.positions.iter().fold(0.0_f32, |m, p| m.max((*p - ray.origin).abs().max_element()));
            let room = number(f64::from(vitrum::math::ulp(reach)) / f64::from(ray.dir.length()));
            of_claim().zip(claimed).is_none_or(|((t, _), claimed)| t > &claimed + &room || t < &claimed - &room)
        }
        // Of rays that leave a surface alone, which these do not.
        Fault::SelfHit => false,
        Fault::OutsideInterval => claimed.is_some_and(|t| !sees(ray, &t)),
    }
}

/// Returns true if the line of `ray` really passes through no triangle within its interval.
pub fn meets_nothing(ray: &Ray, mesh: &TriMesh) -> bool {
    met(ray, mesh).is_empty()
}

/// Returns true if rays all around, as far away as `f32` may carry a corner at the least, meet something, too.
fn goes_on_around(ray: &Ray, mesh: &TriMesh) -> bool {
    const RAYS: usize = 24;
    let reach = mesh.positions.iter().fold(f32::INFINITY, |m, p| m.min((*p - ray.origin).abs().max_element()));
    let aside = 8.0 * f64::from(f32::EPSILON / 2.0) * f64::from(reach);
    let close = close(ray, mesh);
    (0..RAYS).all(|k| {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / RAYS as f64).sin_cos();
        let moved = Exact::moved(ray, aside * cos, aside * sin);
        close.iter().any(|&i| moved.meets(mesh.corners(i)).is_some_and(|(t, inside)| inside && sees(ray, &t)))
    })
}

#[test]
fn a_ray_through_an_edge_meets_both_sides_and_one_beside_it_one() {
    let mesh = TriMesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE - Vec3::Z],
        triangles: vec![[0, 1, 2], [1, 3, 2]],
        ..TriMesh::default()
    };
    let at = |x: f32, y: f32| Ray::new(Vec3::new(x, y, 1.0), -Vec3::Z);
    assert_eq!(met(&at(0.5, 0.5), &mesh).len(), 2);
    assert_eq!(met(&at(0.5, 0.5_f32.next_down()), &mesh), vec![(0, number(1.0))]);
    assert_eq!(met(&at(1.0, 1.0_f32.next_up()), &mesh), vec![]);
    assert!(confirms(Fault::Leak, &at(0.5, 0.5), &Hit::MISS, &mesh));
    assert!(!confirms(Fault::Leak, &at(0.0, 0.5), &Hit::MISS, &mesh), "the mesh ends there");
    assert!(!confirms(Fault::MissedHit, &at(-1.0, 0.0), &Hit::MISS, &mesh));
    assert!(confirms(Fault::FalseHit, &at(0.1, 0.1), &Hit { t: 1.0, geometry: 0, primitive: 1, ..Hit::MISS }, &mesh));
}
