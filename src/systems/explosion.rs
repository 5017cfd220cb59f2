//! Explosion map of a smooth convex surface of triangles: its points by their normals.
//!
//! The triangles of the surface, drawn with their unit normals as corners, cover a part of the sphere of directions, each
//! direction once. A map of that sphere has in each texel the triangle that is drawn there. So the point with a given normal
//! is found in constant time, with the weights of the renderer's interpolation. Ofek and Rappoport draw such a map for one
//! eye, by the directions of reflected rays. By normals, one map serves every eye.

use glam::DVec3;

use super::alhazen::{MirrorBall, MirrorPoint};
use crate::geometry::TriMesh;
use crate::geometry::topology::Edges;

/// Texels along an edge of a face of the cube on which directions are mapped.
const CELLS: usize = 16;

/// Squared distance of two unit normals that are taken for one.
const SAME_NORMAL: f32 = 1e-6;

/// By how many roundings of `f32`, of the largest coordinate, a corner may lie on the wrong side of a face beside it.
const ROUNDINGS: f64 = 16.0;

/// Steps of Newton's method, and halvings of a step.
const STEPS: usize = 40;
const HALVINGS: usize = 10;

/// Sine of the angle between the two halves of a path by which a reflection point may be off.
const CLOSE: f64 = 1e-9;

/// Places from which reflection points of a concave side are looked for.
const STARTS: usize = 12;

/// In place of the number of a triangle.
const NONE: u32 = u32::MAX;

/// Triangle with unit normals that point outwards.
#[derive(Clone, Copy, Debug)]
struct Facet {
    corners: [DVec3; 3],
    normals: [DVec3; 3],
    /// Triangles beyond the edges from corner to corner.
    beside: [u32; 3],
}

/// Explosion map of a surface that bulges to one side.
#[derive(Clone, Debug)]
pub struct Explosion {
    facets: Vec<Facet>,
    /// By texel, a triangle near it.
    cells: Vec<u32>,
    /// Ball around the middle, as large as the mean distance of the corners, and the largest distance.
    ball: MirrorBall,
    reach: f64,
    /// True if the surface has no border.
    pub closed: bool,
    /// True if triangles are counter-clockwise as seen from the bulging side.
    pub outwards: bool,
}

/// Reflection points of an eye and a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Points {
    /// None.
    None,
    /// One.
    One(MirrorPoint),
    /// More than one.
    Several,
}

/// Side of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The bulging one.
    Convex,
    /// The hollow one.
    Concave,
}

/// Point of the surface with a given normal.
#[derive(Clone, Copy, Debug)]
struct At {
    point: DVec3,
    facet: u32,
    /// False beyond the border, where the last triangle is continued.
    inside: bool,
}

impl Explosion {
    /// Makes the map of a mesh, or gives the reason why it has none.
    ///
    /// # Errors
    /// The reason, to follow the name of the object.
    pub fn of(mesh: &TriMesh) -> Result<Self, &'static str> {
        let (mut facets, place) = facets(mesh)?;
        let coordinate = mesh.positions.iter().fold(0.0_f64, |m, p| m.max(f64::from(p.abs().max_element())));
        let rounding = ROUNDINGS * f64::from(f32::EPSILON) * coordinate;
        let (mut bulges, mut hollows, mut closed) = (false, false, true);
        for group in Edges::usable(mesh).groups() {
            let &[(_, a), (_, b)] = group else {
                if group.len() > 2 {
                    return Err("has an edge of more than two faces");
                }
                closed = false;
                continue;
            };
            if a.upwards == b.upwards {
                return Err("has neighbouring faces that are wound opposite ways");
            }
            let [i, k] = [a, b].map(|side| place[side.triangle as usize] as usize);
            let [from, to] = [a, b].map(|side| usize::from(side.corner));
            let same = |x: usize, y: usize| {
                facets[i].normals[x % 3].distance_squared(facets[k].normals[y % 3]) < f64::from(SAME_NORMAL)
            };
            if !same(from, to + 1) || !same(from + 1, to) {
                return Err("has a crease");
            }
            (facets[i].beside[from], facets[k].beside[to]) = (k as u32, i as u32);
            let height = facets[i].height(facets[k].corners[(to + 2) % 3]);
            bulges |= height < -rounding;
            hollows |= height > rounding;
        }
        if bulges == hollows {
            return Err(if bulges { "is neither convex nor concave" } else { "is flat" });
        }
        if hollows {
            facets.iter_mut().for_each(Facet::turn);
        }
        if facets.iter().any(|facet| facet.turn_of_normals() <= 0.0) {
            return Err("has normals that do not turn with its surface");
        }
        if !is_one_part(&facets) {
            return Err("has several parts");
        }
        if facets.iter().map(Facet::solid_angle).sum::<f64>() > 1.001 * 4.0 * std::f64::consts::PI {
            return Err("has several points with the same normal");
        }
        Ok(Self::with(facets, closed, bulges))
    }

    fn with(facets: Vec<Facet>, closed: bool, outwards: bool) -> Self {
        let corners = || facets.iter().flat_map(|facet| facet.corners);
        let count = corners().count() as f64;
        let centre = corners().sum::<DVec3>() / count;
        let radius = corners().map(|p| p.distance(centre)).sum::<f64>() / count;
        let reach = corners().map(|p| p.distance(centre)).fold(0.0, f64::max);
        let ball = MirrorBall { centre, radius };
        let mut map = Self { facets, cells: Vec::new(), ball, reach, closed, outwards };
        let mut near = 0;
        let cells = (0..6 * CELLS * CELLS).map(|cell| {
            if let Some(at) = map.walk(direction(cell), near) {
                near = at.facet;
            }
            near
        });
        map.cells = cells.collect();
        map
    }

    /// Returns a ball in place of the surface.
    #[must_use]
    pub fn ball(&self) -> MirrorBall {
        self.ball
    }

    /// Returns the sides that face a point.
    #[must_use]
    pub fn faces(&self, point: DVec3) -> [bool; 2] {
        let any = |sign: f64| self.facets.iter().any(|facet| sign * facet.height(point) > 0.0);
        [any(1.0), any(-1.0)]
    }

    /// Returns true if a point is enclosed.
    #[must_use]
    pub fn encloses(&self, point: DVec3) -> bool {
        self.closed && point.distance(self.ball.centre) <= self.reach && !self.faces(point)[0]
    }

    /// Finds the triangle with a normal, from triangle `near` on, by steps over the edges that it lies beyond.
    fn walk(&self, normal: DVec3, near: u32) -> Option<At> {
        let mut facet = near;
        for _ in 0..self.facets.len() + 16 {
            let Facet { corners, normals, beside } = self.facets[facet as usize];
            let weight = |k: usize| normal.dot(normals[(k + 1) % 3].cross(normals[(k + 2) % 3]));
            let weights = [weight(0), weight(1), weight(2)];
            let sum: f64 = weights.iter().sum();
            let mut beyond = [0, 1, 2];
            beyond.sort_by(|&i, &k| weights[i].total_cmp(&weights[k]));
            let rounding = -1e-12 * sum.abs();
            let next = beyond.iter().filter(|&&k| weights[k] < rounding).map(|&k| beside[(k + 1) % 3]);
            match next.clone().find(|&f| f != NONE) {
                Some(next) => facet = next,
                None => {
                    let point = (0..3).map(|k| corners[k] * weights[k]).sum::<DVec3>() / sum;
                    return (sum > 0.0 && point.is_finite()).then_some(At { point, facet, inside: next.count() == 0 });
                }
            }
        }
        None
    }

    /// Returns the part across the normal by which eye and point break the law of reflection: 0 at a reflection point.
    fn off(&self, normal: DVec3, near: u32, [eye, other]: [DVec3; 2]) -> Option<(DVec3, At)> {
        let at = self.walk(normal, near)?;
        let [e, q] = [eye, other].map(|p| (p - at.point).normalize_or_zero());
        let across = |d: DVec3| d - normal * d.dot(normal);
        Some((across(e) * q.dot(normal) + across(q) * e.dot(normal), at))
    }

    /// Finds a reflection point by Newton's method from a normal on.
    fn root(&self, start: DVec3, ends: [DVec3; 2]) -> Option<(DVec3, At)> {
        const H: f64 = 1e-6;
        let mut normal = start;
        let (mut off, mut at) = self.off(normal, self.cells[cell(normal)], ends)?;
        for _ in 0..STEPS {
            if off.length() < CLOSE {
                return Some((normal, at));
            }
            let (u, v) = normal.any_orthonormal_pair();
            let slope = |d: DVec3| {
                let (there, _) = self.off((normal + d * H).normalize(), at.facet, ends)?;
                Some((there - off) / H)
            };
            let (a, b) = (slope(u)?, slope(v)?);
            let [[au, av], [bu, bv]] = [a, b].map(|d| [d.dot(u), d.dot(v)]);
            let (ou, ov) = (off.dot(u), off.dot(v));
            let det = au * bv - av * bu;
            let step = u * ((bu * ov - bv * ou) / det) + v * ((av * ou - au * ov) / det);
            let mut step = if step.is_finite() { step.clamp_length_max(0.5) } else { return None };
            let mut better = None;
            for _ in 0..HALVINGS {
                let there = (normal + step).normalize();
                better = self.off(there, at.facet, ends).map(|(o, a)| (there, o, a));
                if better.is_some_and(|(_, o, _)| o.length() < off.length()) {
                    break;
                }
                (step, better) = (step * 0.5, None);
            }
            match better {
                Some(better) => (normal, off, at) = better,
                None => break,
            }
        }
        (off.length() < 1e3 * CLOSE).then_some((normal, at))
    }

    /// Returns the reflection points of an eye and a point on one side. On the convex side there is at most one.
    #[must_use]
    pub fn points(&self, side: Side, eye: DVec3, other: DVec3) -> Points {
        let ends = [eye, other];
        let of = |(normal, at): (DVec3, At), seen: bool| MirrorPoint { point: at.point, normal, seen };
        match side {
            Side::Convex => {
                let middle = [eye, other].map(|p| (p - self.ball.centre).normalize_or_zero());
                let half = (middle[0] + middle[1]).normalize_or(middle[0]);
                let by_ball = self.ball.mirror_point(eye, other).map(|mirror| mirror.normal);
                let found = by_ball.and_then(|n| self.root(n, ends)).or_else(|| self.root(half, ends));
                found.map_or(Points::None, |(normal, at)| {
                    let seen = at.inside && normal.dot(eye - at.point) > 0.0 && normal.dot(other - at.point) > 0.0;
                    Points::One(of((normal, at), seen))
                })
            }
            Side::Concave => {
                let mut found: Option<(DVec3, At)> = None;
                for i in 0..STARTS {
                    let facet = &self.facets[(2 * i + 1) * self.facets.len() / (2 * STARTS)];
                    let start = facet.normals.iter().sum::<DVec3>().normalize();
                    let Some((normal, at)) = self.root(start, ends) else { continue };
                    let before = ends.iter().all(|&p| normal.dot(p - at.point) < 0.0);
                    if !(at.inside && before) {
                        continue;
                    }
                    match found {
                        Some((_, first)) if first.point.distance(at.point) > 1e-5 * self.ball.radius => {
                            return Points::Several;
                        }
                        _ => found = Some((normal, at)),
                    }
                }
                found.map_or(Points::None, |(normal, at)| Points::One(of((-normal, at), true)))
            }
        }
    }
}

impl Facet {
    /// Height of a point above its plane.
    fn height(&self, point: DVec3) -> f64 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a).normalize_or_zero().dot(point - a)
    }

    /// Turns it over.
    fn turn(&mut self) {
        self.corners.swap(1, 2);
        self.normals.swap(1, 2);
        self.normals = self.normals.map(|n| -n);
        // The edges from corner to corner are now met the other way.
        self.beside.swap(0, 2);
    }

    /// Volume that its normals span, above 0 where they turn as its surface does.
    fn turn_of_normals(&self) -> f64 {
        let [a, b, c] = self.normals;
        a.dot(b.cross(c))
    }

    /// Solid angle that its normals span.
    fn solid_angle(&self) -> f64 {
        let [a, b, c] = self.normals;
        2.0 * self.turn_of_normals().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
    }
}

/// The usable triangles of a mesh with their normals and, by triangle of the mesh, their place in the list.
fn facets(mesh: &TriMesh) -> Result<(Vec<Facet>, Vec<u32>), &'static str> {
    let (mut facets, mut place) = (Vec::new(), vec![NONE; mesh.triangles.len()]);
    for i in (0..mesh.triangles.len()).filter(|&i| mesh.is_usable(i)) {
        let normals = mesh.corner_normals(i).ok_or("has no normals to interpolate")?;
        let normals = normals.map(|n| n.as_dvec3().normalize_or_zero());
        if normals.contains(&DVec3::ZERO) {
            return Err("has a normal of length zero");
        }
        place[i] = facets.len() as u32;
        facets.push(Facet { corners: mesh.corners(i).map(|p| p.as_dvec3()), normals, beside: [NONE; 3] });
    }
    if facets.is_empty() { Err("has no triangle") } else { Ok((facets, place)) }
}

/// Returns true if every triangle is reached from the first over shared edges.
fn is_one_part(facets: &[Facet]) -> bool {
    let (mut met, mut waiting) = (vec![false; facets.len()], vec![0]);
    met[0] = true;
    while let Some(i) = waiting.pop() {
        for &k in facets[i as usize].beside.iter().filter(|&&k| k != NONE) {
            if !std::mem::replace(&mut met[k as usize], true) {
                waiting.push(k);
            }
        }
    }
    met.into_iter().all(|met| met)
}

/// The texel of a direction.
fn cell(dir: DVec3) -> usize {
    let most = dir.abs().max_element();
    let axis = (0..3).find(|&k| dir[k].abs() == most).unwrap_or(0);
    let face = 2 * axis + usize::from(dir[axis] < 0.0);
    let at = |k: usize| {
        let along = dir[(axis + k) % 3] / most;
        (((along + 1.0) * 0.5 * CELLS as f64) as usize).min(CELLS - 1)
    };
    (face * CELLS + at(1)) * CELLS + at(2)
}

/// The direction of the middle of a texel.
fn direction(cell: usize) -> DVec3 {
    let (face, row, column) = (cell / (CELLS * CELLS), cell / CELLS % CELLS, cell % CELLS);
    let axis = face / 2;
    let along = |i: usize| (i as f64 + 0.5) / CELLS as f64 * 2.0 - 1.0;
    let mut dir = DVec3::ZERO;
    dir[axis] = if face % 2 == 0 { 1.0 } else { -1.0 };
    (dir[(axis + 1) % 3], dir[(axis + 2) % 3]) = (along(row), along(column));
    dir.normalize()
}

#[cfg(test)]
mod tests;
