//! Closed meshes at every size and position, and odd meshes.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use crate::geometry::{Geometry, GeometryMask, Shape, TriMesh};
use crate::math::ulp;
use crate::measure::sample::Rng;

/// Closed mesh of which every point is visible from near its middle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Closed {
    /// Sphere of 24 slices and stacks, with two corners of valence 24.
    Ball,
    /// Sphere whose radius waves by a fifth.
    Bumpy,
    /// Sphere with random radii from 0.6 to 1: ridges and hollows.
    Crumpled,
    /// Sphere stretched to a hundred times its thickness: needles.
    Spindle,
    /// Cube with flat faces of 6 by 8 by 8 squares.
    Cube,
}

/// Scales of each mesh.
const SCALES: [f64; 7] = [1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3];

/// Positions of each mesh. The last one is that of Embree's own watertightness test.
const OFFSETS: [[f64; 3]; 6] = [
    [0.0, 0.0, 0.0],
    [1.0, -0.7, 0.3],
    [1e2, 3e1, -7e1],
    [-1e4, 2e3, 5e3],
    [4e5, -1e6, 7e5],
    [148_376.0, 1_234.0, -223_423.0],
];

/// Smallest extent of a mesh in spacings of `f32`, below which it is mostly rounding.
const LEAST_SPAN: f32 = 256.0;

/// Mesh at its position.
pub(super) struct Pair {
    /// Mesh.
    pub mesh: TriMesh,
    /// Middle of the mesh.
    pub centre: DVec3,
    /// Half extent along each axis.
    pub half: DVec3,
    /// Shape, scale and position, for messages.
    pub name: String,
    /// Shape.
    pub shape: Closed,
}

/// Returns every mesh at every scale and position where it spans enough `f32` numbers.
pub(super) fn pairs(shapes: &[Closed]) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for &shape in shapes {
        let unit = closed(shape);
        for scale in SCALES {
            for offset in OFFSETS.map(DVec3::from_array) {
                let positions: Vec<Vec3> = unit.iter().map(|&p| (p * scale + offset).as_vec3()).collect();
                let lo = positions.iter().copied().reduce(Vec3::min).unwrap_or_default();
                let hi = positions.iter().copied().reduce(Vec3::max).unwrap_or_default();
                if (hi - lo).min_element() >= LEAST_SPAN * ulp(lo.abs().max(hi.abs()).max_element()) {
                    let mesh = TriMesh { positions, triangles: faces(shape), ..TriMesh::default() };
                    let half = (hi.as_dvec3() - lo.as_dvec3()) * 0.5;
                    let name = format!("{shape:?} of size {scale:e} at {offset}");
                    pairs.push(Pair { mesh, centre: offset, half, name, shape });
                }
            }
        }
    }
    pairs
}

const N: u32 = 24;
/// Number of squares along an edge of the cube.
const SQUARES: u32 = 8;

fn closed(shape: Closed) -> Vec<DVec3> {
    if shape == Closed::Cube {
        return cube().0;
    }
    let mut rng = Rng::new("crumpled", 0);
    let mut radius = |theta: f64, phi: f64| match shape {
        Closed::Bumpy => 1.0 + 0.2 * (5.0 * phi).sin() * (3.0 * theta).sin(),
        Closed::Crumpled => rng.between(0.6, 1.0),
        _ => 1.0,
    };
    let mut positions = vec![DVec3::Y];
    for stack in 1..N {
        for slice in 0..N {
            let (theta, phi) = (PI * f64::from(stack) / f64::from(N), TAU * f64::from(slice) / f64::from(N));
            let towards = DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
            positions.push(towards * radius(theta, phi));
        }
    }
    positions.push(DVec3::NEG_Y);
    if shape == Closed::Spindle {
        for p in &mut positions {
            *p *= DVec3::new(1e-2, 1.0, 1e-2);
        }
    }
    positions
}

fn faces(shape: Closed) -> Vec<[u32; 3]> {
    if shape == Closed::Cube {
        return cube().1;
    }
    let at = |stack: u32, slice: u32| 1 + (stack - 1) * N + slice % N;
    let last = 1 + (N - 1) * N;
    let mut triangles = Vec::new();
    for slice in 0..N {
        triangles.push([0, at(1, slice + 1), at(1, slice)]);
        triangles.push([last, at(N - 1, slice), at(N - 1, slice + 1)]);
        for stack in 1..N - 1 {
            let (a, b) = (at(stack, slice), at(stack, slice + 1));
            let (c, d) = (at(stack + 1, slice), at(stack + 1, slice + 1));
            triangles.push([a, b, c]);
            triangles.push([b, d, c]);
        }
    }
    triangles
}

/// Returns corners on a lattice, so that faces share the corners of their edges.
fn cube() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut corners = std::collections::HashMap::new();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for axis in 0..3 {
        for far in [0, SQUARES] {
            for s in 0..SQUARES {
                for t in 0..SQUARES {
                    let mut square = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[ds, dt]| {
                        let mut place = [far; 3];
                        place[(axis + 1) % 3] = s + ds;
                        place[(axis + 2) % 3] = t + dt;
                        *corners.entry(place).or_insert_with(|| {
                            let at = |i: u32| 2.0 * f64::from(i) / f64::from(SQUARES) - 1.0;
                            positions.push(DVec3::from_array(place.map(at)));
                            positions.len() as u32 - 1
                        })
                    });
                    if far == 0 {
                        square.reverse();
                    }
                    let [a, b, c, d] = square;
                    triangles.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
    }
    (positions, triangles)
}

/// Returns points that lie exactly on an edge: halves and quarters of edges that `f32` represents.
pub(super) fn exact_edge_points(mesh: &TriMesh) -> Vec<Vec3> {
    let mut points = Vec::new();
    for triangle in &mesh.triangles {
        for k in 0..3 {
            let [a, b] = [triangle[k], triangle[(k + 1) % 3]].map(|i| mesh.positions[i as usize].as_dvec3());
            for share in [0.5, 0.25, 0.75, 0.125, 0.625] {
                let on = a + (b - a) * share;
                if on.as_vec3().as_dvec3() == on {
                    points.push(on.as_vec3());
                }
            }
        }
    }
    points
}

/// Returns a mesh that every ray can hit.
pub(super) fn opaque(mesh: TriMesh) -> Geometry {
    Geometry { shape: Shape::Mesh(mesh), mask: GeometryMask::OPAQUE }
}

/// Returns a mesh of separate triangles.
pub(super) fn of_triangles(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> TriMesh {
    let positions: Vec<Vec3> = triangles.into_iter().flatten().collect();
    let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    TriMesh { positions, triangles, ..TriMesh::default() }
}

/// Returns a closed mesh of size 1 at the origin.
pub(super) fn unit(shape: Closed) -> TriMesh {
    let positions = closed(shape).into_iter().map(DVec3::as_vec3).collect();
    TriMesh { positions, triangles: faces(shape), ..TriMesh::default() }
}
