//! Viewpoints of scenes for trials, which do not depend on scenes.

use crate::scene::{LightKind, Projection, Scene};
use crate::trial::View;
use crate::trial::rays::bounds;

/// Returns the viewpoint of the scene's camera with its first light. For a parallel projection it is the eye, with an
/// angle of view that covers the same width at the target. Without lights, one above is used.
pub(super) fn of(scene: &Scene) -> View {
    let camera = &scene.camera;
    let distance = camera.eye.distance(camera.target);
    let fov = match camera.projection {
        Projection::Pinhole { vfov } => vfov,
        Projection::Map(_) => 90.0,
        Projection::Orthographic { height } => 2.0 * (0.5 * height).atan2(distance).to_degrees(),
    };
    let bounds = bounds(&scene.geometry);
    let (centre, far) =
        if bounds.is_empty() { (camera.target, 10.0 * distance) } else { (bounds.centre(), 2.0 * bounds.diagonal()) };
    let light = match scene.lights.first().map(|l| l.kind) {
        Some(LightKind::Directional { direction }) => centre - direction * far,
        Some(kind) => kind.position().unwrap_or(centre + far),
        None if bounds.is_empty() => centre + far,
        None => View::light_over(&bounds),
    };
    View { eye: camera.eye, target: camera.target, up: camera.up, fov, light }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::scene::{Camera, Falloff, Light, Rgb};

    #[test]
    fn parallel_rays_become_a_pinhole_as_wide_at_the_target() {
        let projection = Projection::Orthographic { height: 6.0 };
        let camera = Camera { eye: Vec3::Z * 3.0, target: Vec3::ZERO, projection, ..Camera::default() };
        let scene = Scene { camera, ..Scene::default() };
        assert!((of(&scene).fov - 90.0).abs() < 1e-4);
    }

    #[test]
    fn a_directional_light_stands_far_off_on_the_side_it_comes_from() {
        let mut scene = Scene::default();
        let kind = LightKind::Directional { direction: Vec3::NEG_Y };
        scene.lights.push(Light {
            name: String::new(),
            kind,
            intensity: Rgb::ONE,
            falloff: Falloff::InverseSquare,
            shadows: true,
        });
        assert!(of(&scene).light.y > 10.0);
    }
}
