//! Mirror directions from normals that are hardly any.

use glam::Vec3;
use vitrum::geometry::Shape;
use vitrum::render::Options;
use vitrum::scene::{Environment, Interface, MirrorSource, Rgb};

use crate::support::scenes;

/// RV-03: corner normals that cancel in the middle, or all point the wrong way, leave the geometric normal: no NaN, and
/// exactly the flat mirror's picture where nothing else is known.
#[test]
fn normals_that_cancel_give_way_to_the_geometric_one() {
    let mut scene = scenes::empty(0.0);
    scene.environment =
        Environment::Gradient { nadir: Rgb::X, horizon: Rgb::new(0.2, 0.9, 0.4), zenith: Rgb::new(0.3, 0.1, 1.0) };
    let mirror = Interface::Mirror { reflectance: Rgb::ONE, source: MirrorSource::Traced };
    let mirror = scenes::material(&mut scene, scenes::bare(mirror));
    let mut sheet = scenes::cuboid_mesh(Vec3::splat(-1.0), Vec3::ONE);
    scenes::add(&mut scene, Shape::Mesh(sheet.clone()), mirror);
    let flat = scenes::native(&scene, &Options::default());
    for normals in [[Vec3::Z; 3], [Vec3::X, -Vec3::X, Vec3::ZERO], [Vec3::ZERO; 3], [Vec3::splat(1e-25); 3]] {
        sheet.normals = normals.to_vec();
        sheet.normal_indices = vec![[0, 1, 2]; sheet.triangles.len()];
        scene.geometry[0].shape = Shape::Mesh(sheet.clone());
        let outcome = scenes::native(&scene, &Options::default());
        assert_eq!((outcome.non_finite, outcome.clamped), (0, 0), "{normals:?}");
        assert!(outcome.film.pixels.as_flattened().iter().all(|x| x.is_finite() && (0.0..=1.0).contains(x)));
        if normals[0].length() < 0.1 {
            assert!(outcome.film == flat.film, "{normals:?}");
        }
    }
}
