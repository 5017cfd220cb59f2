//! Meshes with every kind of boundary that real models have, at random sizes and places, and rays aimed at them.

use glam::{DMat3, DVec3, Vec3};
use vitrum::geometry::{Ray, TriMesh};

use super::Rng;
use super::shapes::closed_sphere;

/// A kind of boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Boundary {
    /// A bent sheet with a rim and holes.
    Open,
    /// A fan around a corner with a wedge left out, from a ten-thousandth of a degree to 60 degrees.
    Slit,
    /// A ball whose triangles have corners of their own, some of them an ulp or a few off.
    Unjoined,
    /// A sheet in which some edges have a corner in their middle on one side only.
    Junction,
    /// Three to eight leaves of a book, and a ball with fins.
    NonManifold,
    /// Cones that share nothing but their tips, some of them slit.
    Cones,
    /// A ball with triangles that are there twice or three times, some the other way round.
    Duplicated,
    /// A closed ball, a hundred times as long as it is thick.
    Spindle,
    /// A closed ball.
    Closed,
}

impl Boundary {
    pub const ALL: [Self; 9] = [
        Self::Open,
        Self::Slit,
        Self::Unjoined,
        Self::Junction,
        Self::NonManifold,
        Self::Cones,
        Self::Duplicated,
        Self::Spindle,
        Self::Closed,
    ];

    /// A mesh of this kind, of another shape, size and place for each `seed`. One in three is joined by equal coordinates
    /// instead of indices.
    pub fn mesh(self, seed: u64) -> TriMesh {
        let rng = &mut Rng::new(seed.wrapping_mul(16).wrapping_add(self as u64));
        let mesh = self.by_indices(rng);
        if rng.below(3) == 0 { apart(&mesh) } else { mesh }
    }

    fn by_indices(self, rng: &mut Rng) -> TriMesh {
        let mesh = match self {
            Self::Open => open(rng),
            Self::Slit => slit(rng),
            Self::Unjoined => return unjoined(&placed(ball(rng), rng), rng),
            Self::Junction => return junctions(&placed(sheet(rng), rng), rng),
            Self::NonManifold => non_manifold(rng),
            Self::Cones => cones(rng),
            Self::Duplicated => duplicated(rng),
            Self::Spindle => {
                let mut mesh = ball(rng);
                mesh.positions.iter_mut().for_each(|p| *p *= Vec3::new(1e-2, 1.0, 1e-2));
                mesh
            }
            Self::Closed => ball(rng),
        };
        placed(mesh, rng)
    }
}

fn of(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> TriMesh {
    TriMesh { positions, triangles, ..TriMesh::default() }
}

fn ball(rng: &mut Rng) -> TriMesh {
    closed_sphere(5 + rng.below(12) as u32, 0.3 * rng.unit(), 1.0, Vec3::ZERO)
}

/// Turned, scaled and moved at random, by up to a thousand times the size; rounded once.
fn placed(mut mesh: TriMesh, rng: &mut Rng) -> TriMesh {
    let random = |rng: &mut Rng| rng.point().as_dvec3();
    let turn = DMat3::from_axis_angle(rng.direction().as_dvec3().normalize(), f64::from(rng.unit()) * 6.3);
    let scale = 10.0_f64.powi(rng.below(7) as i32 - 3);
    let offset: DVec3 = [0.0, 0.0, 1.0, 30.0, 1e3][rng.below(5)] * scale * random(rng);
    mesh.positions.iter_mut().for_each(|p| *p = (turn * p.as_dvec3() * scale + offset).as_vec3());
    mesh
}

fn sheet(rng: &mut Rng) -> TriMesh {
    let n = 2 + rng.below(6) as u32;
    let height = 0.3 * rng.unit();
    let positions = (0..=n)
        .flat_map(|y| (0..=n).map(move |x| (x, y)))
        .map(|(x, y)| Vec3::new(x as f32 / n as f32, y as f32 / n as f32, height * rng.signed()))
        .collect();
    let at = |x: u32, y: u32| y * (n + 1) + x;
    let square = |x, y| [[at(x, y), at(x + 1, y), at(x + 1, y + 1)], [at(x, y), at(x + 1, y + 1), at(x, y + 1)]];
    of(positions, (0..n).flat_map(|y| (0..n).flat_map(move |x| square(x, y))).collect())
}

fn open(rng: &mut Rng) -> TriMesh {
    let mut mesh = if rng.below(2) == 0 { sheet(rng) } else { ball(rng) };
    mesh.triangles.retain(|_| rng.below(6) != 0);
    mesh
}

fn slit(rng: &mut Rng) -> TriMesh {
    let n = 4 + rng.below(12);
    let gap = 10.0_f32.powf(-5.5 * rng.unit());
    let height = rng.unit();
    let mut positions = vec![Vec3::ZERO];
    positions.extend((0..=n).map(|k| {
        let (sin, cos) = ((std::f32::consts::TAU - gap) * k as f32 / n as f32).sin_cos();
        Vec3::new(cos, sin, height * rng.signed()) * (0.3 + rng.unit())
    }));
    of(positions, (1..=n as u32).map(|k| [0, k, k + 1]).collect())
}

/// Each triangle with corners of its own.
fn apart(mesh: &TriMesh) -> TriMesh {
    let positions = (0..mesh.triangles.len()).flat_map(|i| mesh.corners(i)).collect();
    of(positions, (0..mesh.triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// Each triangle with corners of its own, one in four of them moved by up to four spacings of its coordinates.
fn unjoined(mesh: &TriMesh, rng: &mut Rng) -> TriMesh {
    let mut mesh = apart(mesh);
    for p in &mut mesh.positions {
        if rng.below(4) == 0 {
            let k = rng.below(3);
            p[k] += vitrum::math::ulp(p[k]) * (rng.below(9) as f32 - 4.0);
        }
    }
    mesh
}

/// One in three triangles divided in two at the middle of an edge, rounded, of which the neighbour has no corner.
fn junctions(mesh: &TriMesh, rng: &mut Rng) -> TriMesh {
    let mut made = of(mesh.positions.clone(), Vec::new());
    for &[a, b, c] in &mesh.triangles {
        if rng.below(3) == 0 {
            let middle = (mesh.positions[a as usize].as_dvec3() + mesh.positions[b as usize].as_dvec3()) * 0.5;
            made.positions.push(middle.as_vec3());
            let m = made.positions.len() as u32 - 1;
            made.triangles.extend([[a, m, c], [m, b, c]]);
        } else {
            made.triangles.push([a, b, c]);
        }
    }
    made
}

fn non_manifold(rng: &mut Rng) -> TriMesh {
    if rng.below(2) == 0 {
        let leaves = 3 + rng.below(6);
        let mut positions: Vec<Vec3> = (0..4).map(|k| Vec3::Z * k as f32 * 0.5).collect();
        let mut triangles = Vec::new();
        for _ in 0..leaves {
            let first = positions.len() as u32;
            let out = rng.direction() * Vec3::new(1.0, 1.0, 0.0);
            positions.extend((0..4).map(|k| out + Vec3::Z * (k as f32 * 0.5 + 0.1 * rng.signed())));
            triangles.extend((0..3).flat_map(|k| [[k, k + 1, first + k], [k + 1, first + k + 1, first + k]]));
        }
        return of(positions, triangles);
    }
    let mut mesh = ball(rng);
    for i in 0..mesh.triangles.len() {
        if rng.below(5) == 0 {
            let [a, b, _] = mesh.triangles[i];
            let out = mesh.positions[a as usize] * (1.2 + rng.unit());
            mesh.positions.push(out);
            mesh.triangles.push([a, b, mesh.positions.len() as u32 - 1]);
        }
    }
    mesh
}

fn cones(rng: &mut Rng) -> TriMesh {
    let (mut positions, mut triangles) = (vec![Vec3::ZERO], Vec::new());
    for _ in 0..2 + rng.below(3) {
        let axis = rng.direction().normalize();
        let (u, v) = axis.any_orthonormal_pair();
        let (sides, wide, slit) = (3 + rng.below(8) as u32, 0.1 + rng.unit(), rng.below(3) == 0);
        let gap = if slit { 10.0_f32.powf(-5.5 * rng.unit()) } else { 0.0 };
        let first = positions.len() as u32;
        positions.extend((0..sides + u32::from(slit)).map(|k| {
            let (sin, cos) = ((std::f32::consts::TAU - gap) * k as f32 / sides as f32).sin_cos();
            axis + (u * cos + v * sin) * wide
        }));
        let at = |k: u32| first + if slit { k } else { k % sides };
        triangles.extend((0..sides).map(|k| [0, at(k), at(k + 1)]));
    }
    of(positions, triangles)
}

fn duplicated(rng: &mut Rng) -> TriMesh {
    let mut mesh = if rng.below(2) == 0 { ball(rng) } else { open(rng) };
    for i in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.triangles[i];
        for _ in 0..rng.below(3) {
            mesh.triangles.push(if rng.below(2) == 0 { [b, c, a] } else { [a, c, b] });
        }
    }
    mesh
}

/// A ray at a corner, at a point of an edge or close by, from inside or outside, near or far; some along an axis.
pub fn ray(mesh: &TriMesh, rng: &mut Rng) -> Ray {
    let bounds = mesh.bounds();
    let (centre, size) = (bounds.centre(), bounds.diagonal());
    let [a, b, c] = mesh.corners(rng.below(mesh.triangles.len())).map(Vec3::as_dvec3);
    let mut target = match rng.below(8) {
        0..3 => a,
        3..6 => a.lerp(b, f64::from(rng.unit())),
        6 => a.lerp(b, 0.5),
        _ => (a + b + c) / 3.0,
    }
    .as_vec3();
    if rng.below(3) == 0 {
        let k = rng.below(3);
        target[k] += vitrum::math::ulp(target[k]) * (rng.below(33) as f32 - 16.0);
    }
    let far = [0.2, 0.7, 3.0, 100.0][rng.below(4)];
    let origin = if rng.below(6) == 0 {
        let mut origin = target;
        origin[rng.below(3)] += size * if rng.below(2) == 0 { 1.0 } else { -1.0 };
        origin
    } else {
        centre + rng.direction() * size * far
    };
    let mut ray = Ray::new(origin, target - origin);
    if ray.dir == Vec3::ZERO {
        ray.dir = Vec3::X;
    }
    if rng.below(2) == 0 {
        ray.dir = ray.dir.normalize_or(Vec3::X);
    }
    match rng.below(12) {
        0 => ray.t_max = rng.unit() * 2.0 + 1e-3,
        1 => ray.t_min = rng.unit() * 2.0,
        _ => {}
    }
    ray
}
