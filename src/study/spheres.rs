//! Replacement of exact spheres by triangles.

use super::axis::Spheres;
use crate::geometry::{Shape, Sphere, TriMesh};
use crate::load::shapes;
use crate::scene::Scene;

/// Returns `scene` with exact or tessellated spheres.
#[must_use]
pub fn with_spheres(scene: &Scene, spheres: Spheres) -> Scene {
    let mut scene = scene.clone();
    if let Spheres::Bands(bands) = spheres {
        let unit = shapes::sphere(bands);
        for geometry in &mut scene.geometry {
            if let Shape::Sphere(sphere) = geometry.shape {
                geometry.shape = Shape::Mesh(placed(&unit, sphere));
            }
        }
    }
    scene
}

/// Returns the unit sphere mesh moved to `sphere`. Its corners lie on the sphere, so it is slightly smaller.
fn placed(unit: &TriMesh, sphere: Sphere) -> TriMesh {
    let mut mesh = unit.clone();
    for p in &mut mesh.positions {
        *p = (p.as_dvec3() * f64::from(sphere.radius) + sphere.centre.as_dvec3()).as_vec3();
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Geometry, GeometryMask};
    use glam::Vec3;

    #[test]
    fn a_sphere_of_triangles_has_its_corners_on_the_sphere_and_its_mask() {
        let sphere = Sphere { centre: Vec3::new(1.0, 2.0, 3.0), radius: 0.5 };
        let geometry = vec![Geometry { shape: Shape::Sphere(sphere), mask: GeometryMask::TRANSMISSIVE }];
        let scene = with_spheres(&Scene { geometry, ..Scene::default() }, Spheres::Bands(8));
        let Shape::Mesh(mesh) = &scene.geometry[0].shape else { panic!("still a sphere") };
        assert_eq!((mesh.triangles.len(), scene.geometry[0].mask), (4 * 8 * 7, GeometryMask::TRANSMISSIVE));
        for p in &mesh.positions {
            assert!((p.distance(sphere.centre) - 0.5).abs() < 1e-6);
        }
    }
}
