//! Planar mirrors: faces of reflectors that lie in one plane, which a matrix mirrors a camera in.

use std::fmt;

use glam::DVec3;

use super::reflector::reflectors;
use crate::geometry::{Shape, TriMesh};
use crate::math::UNIT_ROUNDOFF;
use crate::optics::PlanarReflection;
use crate::scene::Scene;

/// Planes that the faces of one object may lie in. A body of more is taken for a curved one.
const MOST_PLANES: usize = 64;

/// By how many roundings of `f32`, of the largest coordinate, a corner may lie off the plane of its face.
const ROUNDINGS: f64 = 16.0;

/// By how much the length of the cross product of an interpolated normal and that of its plane may differ from 0.
const NORMAL_ROUNDINGS: f64 = 16.0 * UNIT;

/// [`UNIT_ROUNDOFF`] of `f32` in `f64`.
const UNIT: f64 = UNIT_ROUNDOFF as f64;

/// A plane that reflects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// The object whose face it is.
    pub object: u32,
    /// A point on it, in scene units.
    pub point: DVec3,
    /// Unit normal.
    pub normal: DVec3,
    /// Largest distance of a corner of its triangles from the plane, in scene units.
    pub spread: f64,
}

impl Mirror {
    /// Returns the reflection matrix of the slides, with V of unit length.
    #[must_use]
    pub fn matrix(&self) -> PlanarReflection<f64> {
        PlanarReflection::new(self.point.into(), self.normal.into())
    }
}

/// Reasons why a matrix serves no face of a reflector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curved {
    /// It is a sphere.
    Sphere,
    /// Its triangles lie in more planes than `MOST_PLANES`.
    ManyPlanes,
    /// A face is not flat.
    Bent,
    /// Normals are interpolated over a face.
    Smooth,
    /// It has no triangle with an area.
    Empty,
}

impl fmt::Display for Curved {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Sphere => f.write_str("is a sphere"),
            Self::ManyPlanes => write!(f, "has faces in more than {MOST_PLANES} planes"),
            Self::Bent => f.write_str("has a face that is not flat"),
            Self::Smooth => f.write_str("has normals that are interpolated over a face"),
            Self::Empty => f.write_str("has no triangle with an area"),
        }
    }
}

/// The mirror of each face of an object.
#[derive(Clone, Debug)]
enum Faces {
    /// None has one.
    None,
    /// All have the same.
    One(u32),
    /// By triangle; [`NONE`] where it has no area.
    Each(Vec<u32>),
}

/// In place of the number of a mirror.
const NONE: u32 = u32::MAX;

/// The planar mirrors of a scene.
#[derive(Clone, Debug)]
pub struct Mirrors {
    /// All of them.
    pub list: Vec<Mirror>,
    /// Reflectors that are not planar, with the reasons.
    pub curved: Vec<(u32, Curved)>,
    faces: Vec<Faces>,
}

impl Mirrors {
    /// Finds the planar mirrors among the faces of all reflectors.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let mut mirrors = Self { list: Vec::new(), curved: Vec::new(), faces: Vec::new() };
        mirrors.faces.resize(scene.objects.len(), Faces::None);
        for object in reflectors(scene) {
            let first = mirrors.list.len() as u32;
            let number = object as u32;
            match &scene.geometry[object].shape {
                Shape::Plane(plane) => {
                    let (point, normal) = (plane.point.as_dvec3(), plane.normal.as_dvec3().normalize());
                    mirrors.list.push(Mirror { object: number, point, normal, spread: 0.0 });
                    mirrors.faces[object] = Faces::One(first);
                }
                Shape::Sphere(_) => mirrors.curved.push((number, Curved::Sphere)),
                Shape::Mesh(mesh) => match flat_faces(mesh) {
                    Err(why) => mirrors.curved.push((number, why)),
                    Ok((planes, faces)) => {
                        let mirror = |Flat { point, normal, spread }| Mirror { object: number, point, normal, spread };
                        let one = planes.len() == 1 && !faces.contains(&NONE);
                        mirrors.list.extend(planes.into_iter().map(mirror));
                        mirrors.faces[object] = if one {
                            Faces::One(first)
                        } else {
                            Faces::Each(faces.into_iter().map(|f| if f == NONE { NONE } else { first + f }).collect())
                        };
                    }
                },
            }
        }
        mirrors
    }

    /// The mirror that a face of an object lies in.
    #[inline]
    #[must_use]
    pub fn at(&self, object: u32, primitive: u32) -> Option<u32> {
        match &self.faces[object as usize] {
            Faces::None => None,
            Faces::One(mirror) => Some(*mirror),
            Faces::Each(mirrors) => mirrors.get(primitive as usize).copied().filter(|&m| m != NONE),
        }
    }
}

/// A plane that some triangles lie in.
#[derive(Clone, Copy, Debug)]
struct Flat {
    point: DVec3,
    normal: DVec3,
    spread: f64,
}

/// A triangle, or the sum of several that face the same way.
#[derive(Clone, Copy)]
struct Patch {
    /// Twice the area, along the normal.
    area: DVec3,
    /// Centroid times twice the area.
    moment: DVec3,
}

/// The planes of a mesh and, by triangle, the plane it lies in.
fn flat_faces(mesh: &TriMesh) -> Result<(Vec<Flat>, Vec<u32>), Curved> {
    let patches: Vec<Patch> = (0..mesh.triangles.len()).map(|i| patch(mesh, i)).collect();
    let mut order: Vec<usize> = (0..patches.len()).filter(|&i| patches[i].area != DVec3::ZERO).collect();
    // The larger a triangle is, the better it tells where its plane lies.
    order.sort_by(|&a, &b| patches[b].area.length_squared().total_cmp(&patches[a].area.length_squared()));
    let largest = |i: usize| mesh.corners(i).iter().fold(0.0_f64, |m, p| m.max(f64::from(p.abs().max_element())));
    let coordinate = order.iter().map(|&i| largest(i)).fold(0.0, f64::max);
    let rounding = ROUNDINGS * UNIT * coordinate;

    let mut seeds: Vec<(Flat, f64)> = Vec::new();
    let mut faces = vec![NONE; patches.len()];
    for &i in &order {
        let Patch { area, .. } = patches[i];
        let corners = mesh.corners(i).map(|p| p.as_dvec3());
        let lies_in = |(flat, size): &(Flat, f64)| {
            // Rounding tilts a small triangle, which takes places far from it off their plane.
            let near = |p: DVec3| {
                let away = p - flat.point;
                flat.normal.dot(away).abs() <= rounding * (1.0 + 2.0 * away.length() / size)
            };
            flat.normal.dot(area) > 0.0 && corners.iter().all(|&p| near(p))
        };
        if let Some(face) = seeds.iter().position(lies_in) {
            faces[i] = face as u32;
            continue;
        }
        if seeds.len() == MOST_PLANES {
            return Err(Curved::ManyPlanes);
        }
        faces[i] = seeds.len() as u32;
        let sides = [corners[1] - corners[0], corners[2] - corners[1], corners[0] - corners[2]];
        let longest = sides.iter().map(|s| s.length()).fold(0.0, f64::max);
        let flat = Flat { point: corners[0], normal: area.normalize(), spread: 0.0 };
        seeds.push((flat, area.length() / longest));
    }
    if seeds.is_empty() {
        return Err(Curved::Empty);
    }
    let planes =
        (0..seeds.len() as u32).map(|face| plane(mesh, &patches, &faces, face, rounding)).collect::<Result<_, _>>()?;
    Ok((planes, faces))
}

fn patch(mesh: &TriMesh, i: usize) -> Patch {
    let [a, b, c] = mesh.corners(i).map(|p| p.as_dvec3());
    let area = (b - a).cross(c - a);
    let usable = mesh.is_usable(i) && area.is_finite();
    let area = if usable { area } else { DVec3::ZERO };
    Patch { area, moment: (a + b + c) / 3.0 * area.length() }
}

/// The plane of the triangles of one face, by the sum of their areas, once all are found to lie in it.
fn plane(mesh: &TriMesh, patches: &[Patch], faces: &[u32], face: u32, rounding: f64) -> Result<Flat, Curved> {
    let own = || (0..faces.len()).filter(|&i| faces[i] == face);
    let (area, moment, size) = own().fold((DVec3::ZERO, DVec3::ZERO, 0.0), |(area, moment, size), i| {
        (area + patches[i].area, moment + patches[i].moment, size + patches[i].area.length())
    });
    let (normal, point) = (area.normalize(), moment / size);
    let height = |p: DVec3| normal.dot(p - point).abs();
    let corners = || own().flat_map(|i| mesh.corners(i)).map(|p| p.as_dvec3());
    let spread = corners().map(height).fold(0.0, f64::max);
    if spread > rounding {
        return Err(Curved::Bent);
    }
    let turned = |n: glam::Vec3| n.as_dvec3().normalize_or_zero().cross(normal).length() > NORMAL_ROUNDINGS;
    if own().filter_map(|i| mesh.corner_normals(i)).flatten().any(turned) {
        return Err(Curved::Smooth);
    }
    Ok(Flat { point, normal, spread })
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// A square of `n` by `n` pairs of triangles around `middle`, across `normal`.
    fn square(middle: Vec3, normal: Vec3, edge: f32, n: usize) -> TriMesh {
        let (u, v) = normal.normalize().any_orthonormal_pair();
        let at = |i: usize, k: usize| {
            let along = |x: usize| (x as f32 / n as f32 - 0.5) * edge;
            middle + u * along(i) + v * along(k)
        };
        let positions = (0..=n).flat_map(|k| (0..=n).map(move |i| at(i, k))).collect();
        let row = n as u32 + 1;
        let triangles = (0..n as u32)
            .flat_map(|k| (0..n as u32).map(move |i| k * row + i))
            .flat_map(|a| [[a, a + 1, a + 1 + row], [a, a + 1 + row, a + row]])
            .collect();
        TriMesh { positions, triangles, ..TriMesh::default() }
    }

    #[test]
    fn a_square_anywhere_is_one_plane_however_fine_its_triangles_are() {
        for (middle, normal) in [
            (Vec3::ZERO, Vec3::Y),
            (Vec3::new(3.0, -70.0, 11.0), Vec3::new(0.3, -0.4, 0.9)),
            (Vec3::new(-1e3, 2e3, 0.1), Vec3::new(-1.0, 1e-3, 0.2)),
        ] {
            for n in [1, 2, 7, 40] {
                let mesh = square(middle, normal, 5.0, n);
                let (planes, faces) = flat_faces(&mesh).unwrap();
                assert_eq!((planes.len(), faces), (1, vec![0; 2 * n * n]), "{n} pieces at {middle}");
                let n = planes[0].normal.cross(normal.as_dvec3().normalize()).length();
                // Corners are rounded to the spacing of numbers there.
                assert!(n < 1e-7 * f64::from(middle.length().max(5.0)), "{n}");
            }
        }
    }

    #[test]
    fn the_two_faces_of_a_thin_sheet_and_the_steps_of_a_stair_are_planes_apart() {
        let mut mesh = square(Vec3::ZERO, Vec3::Y, 4.0, 1);
        for (height, turned) in [(-1e-3, true), (1e-4, false)] {
            let mut other = square(Vec3::Y * height, Vec3::Y, 4.0, 1);
            let first = mesh.positions.len() as u32;
            other.triangles.iter_mut().flatten().for_each(|i| *i += first);
            if turned {
                other.triangles.iter_mut().for_each(|t| t.swap(0, 1));
            }
            mesh.positions.extend(other.positions);
            mesh.triangles.extend(other.triangles);
        }
        let (planes, faces) = flat_faces(&mesh).unwrap();
        assert_eq!(planes.len(), 3);
        assert_eq!(faces, [0, 0, 1, 1, 2, 2]);
    }

    #[test]
    fn a_bent_square_and_one_with_turned_normals_are_curved() {
        let mut bent = square(Vec3::ZERO, Vec3::Y, 2.0, 40);
        for p in &mut bent.positions {
            p.y = 1e-3 * p.x * p.x;
        }
        assert!(matches!(flat_faces(&bent), Err(Curved::ManyPlanes | Curved::Bent)));
        let mut smooth = square(Vec3::ZERO, Vec3::Y, 2.0, 1);
        smooth.normal_indices.clone_from(&smooth.triangles);
        smooth.normals = vec![Vec3::Y; 4];
        assert!(flat_faces(&smooth).is_ok(), "normals that are the plane's turn nothing");
        smooth.normals[2] = Vec3::new(0.01, 1.0, 0.0).normalize();
        assert_eq!(flat_faces(&smooth).err(), Some(Curved::Smooth));
        let point = TriMesh { positions: vec![Vec3::ONE; 3], triangles: vec![[0, 1, 2]], ..TriMesh::default() };
        assert_eq!(flat_faces(&point).err(), Some(Curved::Empty));
    }
}
