//! Built-in shapes as generated meshes.
//!
//! Neighbouring triangles share corners by index, so closed shapes are watertight to the bit. Triangles are
//! counter-clockwise seen from outside. Normals exist where the exact shape is smooth. Exact spheres and planes need no
//! mesh: they are [`crate::geometry::Sphere`] and [`crate::geometry::Plane`].

mod cuboid;
mod disc;
mod grid;
mod heightfield;
mod lathe;
mod profiles;
mod revolve;
mod sphere;
mod torus;

pub use cuboid::cuboid;
pub use disc::disc;
pub use grid::grid;
pub use heightfield::{Wave, heightfield};
pub use lathe::lathe;
pub use profiles::{capsule, cone, cylinder};
pub use sphere::sphere;
pub use torus::torus;

use crate::geometry::TriMesh;

/// Removes interpolated normals, so that every triangle uses its own.
pub(super) fn make_flat(mesh: &mut TriMesh) {
    mesh.normals.clear();
    mesh.normal_indices.clear();
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec2};

    use super::*;
    use crate::geometry::topology::{Edges, weld};

    fn volume(mesh: &TriMesh) -> f64 {
        (0..mesh.triangles.len())
            .map(|i| {
                let [a, b, c] = mesh.corners(i).map(|p| p.as_dvec3());
                a.dot(b.cross(c)) / 6.0
            })
            .sum()
    }

    fn area(mesh: &TriMesh) -> f64 {
        (0..mesh.triangles.len())
            .map(|i| {
                let [a, b, c] = mesh.corners(i).map(|p| p.as_dvec3());
                (b - a).cross(c - a).length() / 2.0
            })
            .sum()
    }

    /// Checks that a mesh is closed by index and by position, and has no unused corner. Checks that indices are in
    /// range, that unit normals agree with the triangles, and that every triangle has texture coordinates.
    fn check(name: &str, mesh: &TriMesh, closed: bool) {
        let n = mesh.triangles.len();
        assert!(n > 0, "{name}");
        let by_index: Vec<u32> = (0..mesh.positions.len() as u32).collect();
        assert_eq!(Edges::new(&mesh.triangles, &by_index).open().is_none(), closed, "{name}");
        assert_eq!(Edges::new(&mesh.triangles, &by_index).manifold(), closed, "{name}");
        let welded = weld(&mesh.positions);
        assert!(welded.iter().enumerate().all(|(i, &w)| i as u32 == w), "{name} has a corner twice");
        let mut used = vec![false; mesh.positions.len()];
        mesh.triangles.iter().flatten().for_each(|&i| used[i as usize] = true);
        assert!(used.iter().all(|&u| u), "{name} has a corner that no triangle uses");
        assert_eq!(mesh.uv_indices.len(), n, "{name}");
        assert!(mesh.uv_indices.iter().flatten().all(|&i| (i as usize) < mesh.uvs.len()), "{name}");
        assert!(mesh.uvs.iter().all(|uv| uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all()), "{name}");
        for normal in &mesh.normals {
            assert!((normal.length() - 1.0).abs() < 1e-6, "{name}: {normal}");
        }
        assert!(mesh.normal_indices.is_empty() || mesh.normal_indices.len() == n, "{name}");
        for i in 0..n {
            assert!(mesh.is_usable(i), "{name}: triangle {i}");
            let [a, b, c] = mesh.corners(i).map(|p| p.as_dvec3());
            let flat: DVec3 = (b - a).cross(c - a);
            assert!(flat.length() > 0.0, "{name}: triangle {i} has no area");
            for normal in mesh.corner_normals(i).into_iter().flatten() {
                assert!(normal.as_dvec3().dot(flat.normalize()) > 0.5, "{name}: triangle {i}");
            }
        }
    }

    #[test]
    fn spheres_are_closed_and_approach_their_volume() {
        for bands in [2, 3, 8, 50] {
            let mesh = sphere(bands);
            check("sphere", &mesh, true);
            assert_eq!(mesh.triangles.len() as u32, 4 * bands * (bands - 1));
        }
        let exact = 4.0 / 3.0 * std::f64::consts::PI;
        assert!((volume(&sphere(64)) / exact - 1.0).abs() < 3e-3);
        assert!((volume(&sphere(256)) / exact - 1.0).abs() < 2e-4);
    }

    #[test]
    fn tori_are_closed_and_approach_their_volume() {
        for n in [8, 9, 32] {
            check("torus", &torus(1.0, 0.25, n), true);
        }
        assert!(volume(&torus(1.0, 0.25, 3)) > 0.0);
        let exact = 2.0 * std::f64::consts::PI.powi(2) * 0.25f64.powi(2);
        assert!((volume(&torus(1.0, 0.25, 256)) / exact - 1.0).abs() < 2e-3);
    }

    #[test]
    fn a_box_holds_exactly_its_volume_at_any_tessellation() {
        for n in [1, 2, 5] {
            let mesh = cuboid(n);
            check("box", &mesh, true);
            assert_eq!(mesh.triangles.len() as u32, 12 * n * n);
            assert_eq!(mesh.positions.len() as u32, 6 * n * n + 2);
            assert!((volume(&mesh) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn discs_and_grids_are_open_and_face_up() {
        let mesh = disc(200);
        check("disc", &mesh, false);
        assert!((area(&mesh) / std::f64::consts::PI - 1.0).abs() < 1e-3);
        let mesh = grid(7);
        check("grid", &mesh, false);
        assert_eq!(mesh.triangles.len(), 98);
        assert!((area(&mesh) - 1.0).abs() < 1e-6);
        for mesh in [disc(9), grid(2)] {
            let [a, b, c] = mesh.corners(0);
            assert!((b - a).cross(c - a).y > 0.0);
        }
    }

    #[test]
    fn a_lathed_rectangle_is_a_cylinder_with_sharp_rims() {
        let profile = [[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 2.0]];
        let mesh = lathe(&profile, 256, 50.0).unwrap();
        check("cylinder", &mesh, true);
        assert!((volume(&mesh) / std::f64::consts::TAU - 1.0).abs() < 1e-3);
        for i in 0..mesh.triangles.len() {
            for (p, n) in mesh.corners(i).into_iter().zip(mesh.corner_normals(i).unwrap()) {
                let cap = n.y.abs() > 0.5;
                assert!(if cap { n.y.abs() == 1.0 } else { n.y == 0.0 && n.dot(p) > 0.99 }, "{p} {n}");
            }
        }
    }

    #[test]
    fn a_lathed_loop_is_a_closed_ring() {
        // Counter-clockwise in the (r, y) plane: outside is on the right.
        let profile = [[1.0, -0.5], [2.0, -0.5], [2.0, 0.5], [1.0, 0.5], [1.0, -0.5]];
        let mesh = lathe(&profile, 128, 50.0).unwrap();
        check("ring", &mesh, true);
        assert!((volume(&mesh) / (3.0 * std::f64::consts::PI) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_profile_walked_the_other_way_is_inside_out() {
        let mesh = lathe(&[[0.0, 1.0], [1.0, 0.0], [0.0, -1.0]], 64, 0.0).unwrap();
        assert!(volume(&mesh) < -2.0);
        let mesh = lathe(&[[0.0, -1.0], [1.0, 0.0], [0.0, 1.0]], 64, 0.0).unwrap();
        assert!(volume(&mesh) > 2.0);
        check("double cone", &mesh, true);
    }

    #[test]
    fn a_goblet_is_closed_from_pole_to_pole() {
        let goblet = [
            [0.0, 0.0],
            [0.4, 0.0],
            [0.4, 0.02],
            [0.05, 0.06],
            [0.04, 0.5],
            [0.3, 0.7],
            [0.35, 1.0],
            [0.34, 1.0],
            [0.29, 0.71],
            [0.0, 0.6],
        ];
        for crease in [0.0, 50.0, 180.0] {
            let mesh = lathe(&goblet, 48, crease).unwrap();
            let by_index: Vec<u32> = (0..mesh.positions.len() as u32).collect();
            assert!(Edges::new(&mesh.triangles, &by_index).manifold());
            assert!(volume(&mesh) > 0.0);
        }
    }

    #[test]
    fn impossible_profiles_are_refused_in_words() {
        let refused = |p: &[[f64; 2]]| lathe(p, 16, 50.0).unwrap_err();
        assert!(refused(&[[1.0, 0.0]]).contains("two points"));
        assert!(refused(&[[1.0, 0.0], [-1.0, 1.0]]).contains("-1"));
        assert!(refused(&[[1.0, 0.0], [1.0, 0.0]]).contains("same"));
        assert!(refused(&[[1.0, 0.0], [0.0, 1.0], [1.0, 2.0]]).contains("axis"));
        assert!(refused(&[[0.0, 0.0], [0.0, 1.0]]).contains("axis"));
        assert!(refused(&[[f64::NAN, 0.0], [1.0, 1.0]]).contains("NaN"));
    }

    #[test]
    fn water_is_closed_when_given_a_depth_and_holds_its_volume() {
        let waves = [
            Wave { amplitude: 0.05, wavelength: 0.7, direction: 30.0, phase: 10.0 },
            Wave { amplitude: 0.02, wavelength: 0.3, direction: -75.0, phase: 0.0 },
        ];
        let open = heightfield([2.0, 3.0], &waves, 0.5, None, 40).unwrap();
        check("open water", &open, false);
        let solid = heightfield([2.0, 3.0], &waves, 0.5, Some(1.0), 40).unwrap();
        check("water", &solid, true);
        assert!((volume(&solid) / 6.0 - 1.0).abs() < 0.02, "{}", volume(&solid));
        let lo = solid.bounds().lo.y;
        assert_eq!(lo, -0.5);
    }

    #[test]
    fn wave_normals_are_the_derivative_of_the_height() {
        let waves = [Wave { amplitude: 0.1, wavelength: 1.0, direction: 0.0, phase: 0.0 }];
        let mesh = heightfield([2.0, 2.0], &waves, 0.0, None, 16).unwrap();
        // At x = 0 the slope is 2 pi a.
        let slope = std::f32::consts::TAU * 0.1;
        let at = mesh.positions.iter().position(|p| p.x == 0.0).unwrap();
        assert!((-mesh.normals[at].x / mesh.normals[at].y - slope).abs() < 1e-5);
    }

    #[test]
    fn water_deeper_waves_than_depth_are_refused() {
        let waves = [Wave { amplitude: 0.5, wavelength: 0.7, direction: 30.0, phase: 10.0 }];
        assert!(heightfield([1.0, 1.0], &waves, 0.0, Some(0.4), 4).unwrap_err().contains("depth"));
    }
}
