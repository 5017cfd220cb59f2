//! Choices for reflected light: traced, looked up in the environment, or left out.

use glam::Vec3;
use vitrum::optics::{Boundary, Exact, FresnelFormula};
use vitrum::render::{Options, RayKind, Reflection};
use vitrum::scene::{Interface, Material, MirrorSource, Rgb, Scene};

use super::outcomes;
use crate::support::scenes::{bare, cuboid, empty, glass, material, sphere};

/// A mirror that faces a wall of light 5 in a room of light 1, and the other way round.
fn mirror_and_wall(source: MirrorSource) -> Scene {
    let mut scene = empty(1.0);
    scene.camera.eye = Vec3::new(0.0, 0.0, 3.0);
    let mirror = material(&mut scene, bare(Interface::Mirror { reflectance: Rgb::splat(0.5), source }));
    cuboid(&mut scene, Vec3::new(-9.0, -9.0, -1.0), Vec3::new(9.0, 9.0, 0.0), mirror);
    let wall = material(&mut scene, Material { emission: Rgb::splat(5.0), ..Material::black("wall") });
    cuboid(&mut scene, Vec3::new(-9.0, -9.0, 4.0), Vec3::new(9.0, 9.0, 5.0), wall);
    scene
}

fn seen(scene: &Scene, reflection: Reflection) -> Vec<(&'static str, f32, f32, u64)> {
    outcomes(scene, &Options { reflection, ..Options::default() })
        .into_iter()
        .map(|(name, o)| (name, o.film.at(16, 16)[0], o.truncated.at(16, 16)[0], o.rays.of(RayKind::Reflected)))
        .collect()
}

#[test]
fn a_mirror_sees_the_wall_or_the_sky_or_nothing() {
    for source in [MirrorSource::Traced, MirrorSource::Environment] {
        let scene = mirror_and_wall(source);
        let traced = if source == MirrorSource::Traced { 2.5 } else { 0.5 };
        for (name, light, lost, rays) in seen(&scene, Reflection::Traced) {
            assert_eq!((light, lost), (traced, 0.0), "{name}");
            assert_eq!(rays > 0, source == MirrorSource::Traced, "{name}");
        }
        for (name, light, lost, rays) in seen(&scene, Reflection::Environment) {
            assert_eq!((light, lost, rays), (0.5, 0.0, 0), "{name}");
        }
        // A mirror that shows the environment by itself goes on doing so.
        let without = if source == MirrorSource::Traced { (0.0, 0.5, 0) } else { (0.5, 0.0, 0) };
        for (name, light, lost, rays) in seen(&scene, Reflection::None) {
            assert_eq!((light, lost, rays), without, "{name}: what is left out is told");
        }
    }
}

#[test]
fn glass_without_reflections_is_short_of_what_both_faces_reflect() {
    let mut scene = empty(1.0);
    scene.camera.eye = Vec3::new(0.0, 0.0, 5.0);
    (scene.settings.width, scene.settings.height) = (33, 33);
    let crown = glass(&mut scene, 1.5, 0, Rgb::ZERO);
    sphere(&mut scene, Vec3::ZERO, 1.0, crown);
    let boundary = Boundary::<f64>::new(1.0, 1.5);
    let through = 1.0 - Exact::dielectric(&boundary, &boundary.cross(1.0));
    for (name, light, lost, rays) in seen(&scene, Reflection::None) {
        assert!((f64::from(light) - through * through).abs() < 1e-6, "{name}: {light}");
        assert!((light + lost - 1.0).abs() < 1e-6, "{name}: {light} and {lost}");
        assert_eq!(rays, 0, "{name}");
    }
    // In a room of even light, looking it up is as good as tracing.
    for (name, light, lost, rays) in seen(&scene, Reflection::Environment) {
        assert!((light - 1.0).abs() < 1e-6 && lost == 0.0 && rays == 0, "{name}: {light}");
    }
}

#[test]
fn panes_coats_and_metals_heed_the_choice_too() {
    let kinds = [
        bare(Interface::ThinDielectric { ior: 1.5, rule: vitrum::scene::FresnelRule::Fresnel, tint: Rgb::ONE }),
        bare(Interface::Coated { ior: 1.5 }),
        bare(Interface::Conductor { eta: Rgb::splat(0.2), k: Rgb::splat(3.0) }),
    ];
    for kind in kinds {
        let mut scene = mirror_and_wall(MirrorSource::Traced);
        scene.materials[0] = kind;
        let all = |reflection| seen(&scene, reflection);
        for ((traced, environment), none) in
            all(Reflection::Traced).iter().zip(all(Reflection::Environment)).zip(all(Reflection::None))
        {
            assert!(
                traced.1 > environment.1 + 0.05 && environment.1 > none.1 + 0.01,
                "{traced:?} {environment:?} {none:?}"
            );
            assert!(traced.3 > 0 && environment.3 == 0 && none.3 == 0);
        }
    }
}
