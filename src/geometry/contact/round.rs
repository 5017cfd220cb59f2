//! Spheres that coincide, and spheres that touch something at a point.

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;

use super::contacts::Tangent;
use super::face::{Face, Form};
use super::found::Found;
use super::tolerance::tolerance;
use crate::geometry::mesh::TriMesh;
use crate::geometry::shape::{Geometry, Shape};
use crate::geometry::sphere::Sphere;

/// The gap next to a contact counts as closed below so many times the distance that the starts of rays are moved by.
const GAP: f64 = 4.0;

/// Finds coincident spheres and contacts of spheres with spheres, triangles and planes.
pub(super) fn find(
    geometry: &[Geometry],
    neighbours: &[Vec<u32>],
    matters: &(dyn Fn(usize, usize) -> bool + Sync),
    found: &mut Found,
) {
    let sphere_at = |o: usize| match &geometry[o].shape {
        Shape::Sphere(sphere) if sphere.is_usable() => Some(*sphere),
        _ => None,
    };
    let planes: Vec<usize> = (0..geometry.len())
        .filter(|&o| matches!(&geometry[o].shape, Shape::Plane(plane) if plane.is_usable()))
        .collect();
    let mut near_meshes: BTreeMap<usize, Vec<(u32, Sphere)>> = BTreeMap::new();
    for (object, near) in neighbours.iter().enumerate() {
        let Some(sphere) = sphere_at(object) else { continue };
        let id = (object as u32, 0);
        for &other in near {
            match &geometry[other as usize].shape {
                Shape::Sphere(_) if (other as usize) < object => {
                    let Some(second) = sphere_at(other as usize) else { continue };
                    match meet(&sphere, &second) {
                        Meet::Same => found.coincide(id, (other, 0)),
                        Meet::Touch(tangent) => {
                            // The smaller one touches the larger one, from outside or from inside.
                            let ids = if sphere.radius <= second.radius { [id, (other, 0)] } else { [(other, 0), id] };
                            found.tangents.push((ids, tangent));
                        }
                        Meet::Apart => {}
                    }
                }
                Shape::Mesh(_) => near_meshes.entry(other as usize).or_default().push((object as u32, sphere)),
                _ => {}
            }
        }
        for &plane in planes.iter().filter(|&&plane| matters(object, plane)) {
            touch_flat(geometry, id, &sphere, (plane as u32, 0), found);
        }
    }
    for (other, spheres) in near_meshes {
        if let Shape::Mesh(mesh) = &geometry[other].shape {
            touch_mesh(geometry, mesh, other as u32, spheres, found);
        }
    }
}

/// Contacts of spheres with the triangles of a mesh. Each triangle is held against the spheres at its height along x.
fn touch_mesh(geometry: &[Geometry], mesh: &TriMesh, object: u32, mut spheres: Vec<(u32, Sphere)>, found: &mut Found) {
    spheres.sort_unstable_by(|(i, a), (j, b)| a.centre.x.total_cmp(&b.centre.x).then(i.cmp(j)));
    // A little more than the tolerance makes of it.
    let reach = |sphere: &Sphere| sphere.radius + sphere.radius.max(sphere.centre.abs().max_element()) * 1e-5;
    let widest = spheres.iter().map(|(_, sphere)| reach(sphere)).fold(0.0, f32::max);
    let near = |i: u32| -> Vec<(u32, Sphere, u32)> {
        let [a, b, c] = mesh.corners(i as usize);
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        let first = spheres.partition_point(|(_, sphere)| sphere.centre.x < lo.x - widest);
        let along = spheres[first..].iter().take_while(|(_, s)| s.centre.x <= hi.x + widest);
        let meets = |(_, sphere): &&(u32, Sphere)| {
            let reach = reach(sphere);
            lo.cmple(sphere.centre + reach).all() && hi.cmpge(sphere.centre - reach).all()
        };
        along.filter(meets).map(|&(number, sphere)| (number, sphere, i)).collect()
    };
    let usable = (0..mesh.triangles.len() as u32).into_par_iter().filter(|&i| mesh.is_usable(i as usize));
    let met: Vec<_> = usable.flat_map_iter(near).collect();
    for (number, sphere, i) in met {
        touch_flat(geometry, (number, 0), &sphere, (object, i), found);
    }
}

/// A contact of a sphere with a plane, or with a triangle inside it.
fn touch_flat(
    geometry: &[Geometry],
    id: (u32, u32),
    sphere: &Sphere,
    (object, primitive): (u32, u32),
    found: &mut Found,
) {
    let face = Face::of(geometry, object, primitive);
    let (Form::Triangle { normal, .. } | Form::Plane { normal, .. }) = face.form else { return };
    let (centre, radius) = (sphere.centre.as_dvec3(), f64::from(sphere.radius));
    let height = face.height(centre);
    let contact = centre - normal * height;
    let near = tolerance(face.largest_coordinate(contact).max(centre.abs().max_element()).max(radius));
    if (height.abs() - radius).abs() > near || !face.covers(contact, near) || normal == DVec3::ZERO {
        return;
    }
    let towards = -normal * height.signum();
    let tangent = made(geometry, id, &face, contact, towards, 1.0 / radius, true);
    found.tangents.push(([id, (object, primitive)], tangent));
}

/// A contact with the zone in which its gap is too narrow for rays that start off its surfaces.
fn made(
    geometry: &[Geometry],
    sphere: (u32, u32),
    other: &Face,
    contact: DVec3,
    towards: DVec3,
    curvature: f64,
    gap_outside: bool,
) -> Tangent {
    let sphere = Face::of(geometry, sphere.0, sphere.1);
    let gap = GAP * (sphere.reach(contact) + other.reach(contact));
    // The gap grows by half of the curvature times the square of the distance.
    let zone = (2.0 * gap / curvature).sqrt();
    Tangent { sphere: 0, other: 0, contact, towards, zone, gap_outside }
}

/// Relative position of two spheres.
enum Meet {
    Same,
    Touch(Tangent),
    Apart,
}

fn meet(a: &Sphere, b: &Sphere) -> Meet {
    let (small, large) = if a.radius <= b.radius { (a, b) } else { (b, a) };
    let (c, r) = (small.centre.as_dvec3(), f64::from(small.radius));
    let (d, s) = (large.centre.as_dvec3(), f64::from(large.radius));
    let largest = c.abs().max(d.abs()).max_element().max(s);
    let near = tolerance(largest);
    let (way, apart) = (d - c, c.distance(d));
    if apart <= near && s - r <= near {
        return Meet::Same;
    }
    let geometry = [small, large].map(|sphere| Geometry { shape: Shape::Sphere(*sphere), mask: Default::default() });
    let large = Face::of(&geometry, 1, 0);
    if (apart - (r + s)).abs() <= near {
        let towards = way / apart;
        let contact = c + towards * r;
        Meet::Touch(made(&geometry, (0, 0), &large, contact, towards, 1.0 / r + 1.0 / s, true))
    } else if apart > near && (apart - (s - r)).abs() <= near && s - r > 0.0 {
        let towards = -way / apart;
        let contact = c + towards * r;
        Meet::Touch(made(&geometry, (0, 0), &large, contact, towards, 1.0 / r - 1.0 / s, true))
    } else {
        Meet::Apart
    }
}
