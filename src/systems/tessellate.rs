//! Surfaces cut into triangles that are small as seen from a point.

use glam::{DVec2, DVec3};

use crate::geometry::{Plane, Shape};

/// Corner of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Place on the surface, in scene units.
    pub place: DVec3,
    /// Barycentric coordinates (of the second and the third corner) in the triangle of a mesh that it was cut from; 0 on
    /// other shapes.
    pub uv: DVec2,
}

/// Small triangle, and the primitive that it was cut from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Corners, in the order of the primitive's.
    pub corners: [Corner; 3],
    /// Triangle of a mesh; 0 on other shapes.
    pub primitive: u32,
}

/// Halvings of an edge at most.
const MOST_HALVINGS: u32 = 9;

/// Half the width of the part of an infinite plane that is cut up, in distances from the point plus the radius there.
const PLANE_REACH: f64 = 1e3;

/// Cuts `shape` into triangles whose edges span at most `angle` radians as seen from `from`, the middle of something of radius
/// `radius`.
///
/// An edge is halved by its own length and place alone, so that pieces on both sides of it have the same corners.
#[must_use]
pub fn tessellate(shape: &Shape, from: DVec3, radius: f64, angle: f64) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let flat = |p: DVec3| p;
    match shape {
        Shape::Mesh(mesh) => {
            for i in (0..mesh.triangles.len()).filter(|&i| mesh.is_usable(i)) {
                let [a, b, c] = mesh.corners(i).map(|p| p.as_dvec3());
                let uv = [DVec2::ZERO, DVec2::X, DVec2::Y];
                let corners = [(a, uv[0]), (b, uv[1]), (c, uv[2])].map(|(place, uv)| Corner { place, uv });
                let cut = Cut { from, angle, onto: &flat, primitive: i as u32, most: MOST_HALVINGS };
                halve(&cut, corners, 0, &mut pieces);
            }
        }
        Shape::Sphere(sphere) => {
            let (centre, own) = (sphere.centre.as_dvec3(), f64::from(sphere.radius));
            let onto = |p: DVec3| centre + (p - centre).normalize() * own;
            let axis = |a: DVec3| Corner { place: centre + a * own, uv: DVec2::ZERO };
            for eighth in 0..8 {
                let sign = |bit: i32| if eighth & bit == 0 { 1.0 } else { -1.0 };
                let [x, y, z] = [DVec3::X * sign(1), DVec3::Y * sign(2), DVec3::Z * sign(4)];
                let outwards = sign(1) * sign(2) * sign(4) > 0.0;
                let corners = if outwards { [x, y, z] } else { [x, z, y] }.map(axis);
                let cut = Cut { from, angle, onto: &onto, primitive: 0, most: MOST_HALVINGS };
                halve(&cut, corners, 0, &mut pieces);
            }
        }
        Shape::Plane(Plane { point, normal }) => {
            let normal = normal.as_dvec3().normalize();
            let height = normal.dot(from - point.as_dvec3());
            let foot = from - normal * height;
            let (u, v) = normal.any_orthonormal_pair();
            let reach = (height.abs() + radius) * PLANE_REACH;
            let at = |x: f64, y: f64| Corner { place: foot + (u * x + v * y) * reach, uv: DVec2::ZERO };
            for [[a, b], [c, d]] in [
                [[1.0, 1.0], [-1.0, 1.0]],
                [[-1.0, 1.0], [-1.0, -1.0]],
                [[-1.0, -1.0], [1.0, -1.0]],
                [[1.0, -1.0], [1.0, 1.0]],
            ] {
                let cut = Cut { from, angle, onto: &flat, primitive: 0, most: 3 * MOST_HALVINGS };
                halve(&cut, [at(0.0, 0.0), at(a, b), at(c, d)], 0, &mut pieces);
            }
        }
    }
    pieces
}

struct Cut<'a> {
    from: DVec3,
    angle: f64,
    /// Puts a place back onto the surface.
    onto: &'a dyn Fn(DVec3) -> DVec3,
    primitive: u32,
    /// Halvings of an edge, at most.
    most: u32,
}

impl Cut<'_> {
    /// The middle of an edge, where the edge is to be halved. The same for either order of its ends.
    fn middle(&self, a: &Corner, b: &Corner) -> Option<Corner> {
        let place = (self.onto)((a.place + b.place) * 0.5);
        let near =
            [place, a.place, b.place].map(|p| (p - self.from).length()).into_iter().fold(f64::INFINITY, f64::min);
        let long = (a.place - b.place).length() > self.angle * near;
        long.then(|| Corner { place, uv: (a.uv + b.uv) * 0.5 })
    }
}

fn halve(cut: &Cut, corners: [Corner; 3], depth: u32, pieces: &mut Vec<Piece>) {
    let [a, b, c] = corners;
    let middles =
        if depth < cut.most { [cut.middle(&a, &b), cut.middle(&b, &c), cut.middle(&c, &a)] } else { [None; 3] };
    let go = |corners: [Corner; 3]| halve(cut, corners, depth + 1, pieces);
    match middles {
        [None, None, None] => pieces.push(Piece { corners, primitive: cut.primitive }),
        [Some(ab), Some(bc), Some(ca)] => {
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].into_iter().for_each(go);
        }
        [Some(ab), None, None] => [[a, ab, c], [ab, b, c]].into_iter().for_each(go),
        [None, Some(bc), None] => [[a, b, bc], [a, bc, c]].into_iter().for_each(go),
        [None, None, Some(ca)] => [[a, b, ca], [ca, b, c]].into_iter().for_each(go),
        [Some(ab), Some(bc), None] => [[ab, b, bc], [a, ab, c], [ab, bc, c]].into_iter().for_each(go),
        [None, Some(bc), Some(ca)] => [[bc, c, ca], [a, b, ca], [b, bc, ca]].into_iter().for_each(go),
        [Some(ab), None, Some(ca)] => [[ca, a, ab], [ab, b, c], [ca, ab, c]].into_iter().for_each(go),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use glam::Vec3;

    use super::*;
    use crate::geometry::{Sphere, TriMesh};

    fn area(pieces: &[Piece]) -> f64 {
        let of = |Piece { corners: [a, b, c], .. }: &Piece| (b.place - a.place).cross(c.place - a.place).length() * 0.5;
        pieces.iter().map(of).sum()
    }

    /// Edges that are on one piece alone, by their ends.
    fn open_edges(pieces: &[Piece]) -> usize {
        let mut edges: HashMap<[[u64; 3]; 2], usize> = HashMap::new();
        for Piece { corners, .. } in pieces {
            for k in 0..3 {
                let mut ends = [corners[k], corners[(k + 1) % 3]].map(|c| c.place.to_array().map(f64::to_bits));
                ends.sort_unstable();
                *edges.entry(ends).or_default() += 1;
            }
        }
        edges.values().filter(|&&n| n == 1).count()
    }

    #[test]
    fn pieces_fill_the_surface_without_gaps_and_are_small_where_they_are_near() {
        let mesh = TriMesh {
            positions: vec![Vec3::ZERO, Vec3::X * 4.0, Vec3::new(4.0, 4.0, 0.0), Vec3::Y * 4.0],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..TriMesh::default()
        };
        let from = DVec3::new(1.0, 1.5, 0.3);
        let pieces = tessellate(&Shape::Mesh(mesh), from, 0.1, 0.2);
        assert!((area(&pieces) - 16.0).abs() < 1e-9);
        for Piece { corners, .. } in &pieces {
            for k in 0..3 {
                let (a, b) = (corners[k].place, corners[(k + 1) % 3].place);
                assert!((a - b).length() <= 0.2 * (a - from).length().min((b - from).length()) + 1e-12);
            }
        }
        // Open edges are those on the square's border alone.
        let on_border = |p: DVec3| p.x == 0.0 || p.y == 0.0 || p.x == 4.0 || p.y == 4.0;
        let border = pieces.iter().flat_map(|p| (0..3).map(|k| [p.corners[k].place, p.corners[(k + 1) % 3].place]));
        let border = border.filter(|[a, b]| on_border(*a) && on_border(*b) && (a.x == b.x || a.y == b.y)).count();
        assert_eq!(open_edges(&pieces), border);
        let far = tessellate(&Shape::Plane(Plane { point: Vec3::ZERO, normal: Vec3::Z }), from, 0.1, 0.5);
        assert!(far.len() < 20_000 && far.len() > 100, "{}", far.len());
    }

    #[test]
    fn a_ball_is_closed_and_wound_outwards() {
        let ball = Sphere { centre: Vec3::new(1.0, 2.0, 3.0), radius: 0.5 };
        let pieces = tessellate(&Shape::Sphere(ball), DVec3::new(1.0, 2.0, 5.0), 0.1, 0.05);
        assert_eq!(open_edges(&pieces), 0);
        for Piece { corners: [a, b, c], .. } in &pieces {
            let outwards = (b.place - a.place).cross(c.place - a.place).dot(a.place - ball.centre.as_dvec3());
            assert!(outwards > 0.0);
            assert!(((a.place - ball.centre.as_dvec3()).length() - 0.5).abs() < 1e-12);
        }
    }
}
