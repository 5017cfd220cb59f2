//! Small scenes on which the two renderers once disagreed, with answers by hand that both must give.

use glam::Vec3;
use vitrum::geometry::Shape;
use vitrum::optics::{Boundary, Exact, FresnelFormula};
use vitrum::render::{Options, Outcome, RayKind};
use vitrum::scene::{
    Camera, Colour, Environment, Falloff, FresnelRule, Interface, Light, LightKind, Material, Projection, Rgb, Scene,
    ShadowRule,
};

use crate::support::scenes::{add, bare, cuboid, cuboid_mesh, empty, glass, material, native, plane, sphere};

/// Looks along -z from (0, 0, 5) at an odd number of pixels, so that the middle one looks straight down the axis.
fn head_on(environment: f32) -> Scene {
    let mut scene = empty(environment);
    scene.camera.eye = Vec3::new(0.0, 0.0, 5.0);
    (scene.settings.width, scene.settings.height) = (9, 9);
    scene
}

/// Both renderers' pictures.
fn both(scene: &Scene) -> [Outcome; 2] {
    let options = Options::default();
    let reference = vitrum::render::reference::render(scene, &options, &Default::default());
    [native(scene, &options), reference.expect("nobody interrupts a test")]
}

#[track_caller]
fn centres_are(scene: &Scene, want: Vec3) {
    for (name, outcome) in ["native", "reference"].iter().zip(both(scene)) {
        let seen = Vec3::from(outcome.film.at(4, 4));
        assert!((seen - want).abs().max_element() < 2e-6, "{name}: {seen} is not {want}");
    }
}

/// A white wall at z = 0, which a lamp straight above the middle lights with 1.
fn lit_wall() -> Scene {
    let mut scene = head_on(0.0);
    let white = material(&mut scene, Material { diffuse: Colour::Constant(Rgb::ONE), ..Material::default() });
    plane(&mut scene, Vec3::ZERO, Vec3::Z, white);
    scene.lights = vec![Light {
        name: "lamp".into(),
        kind: LightKind::Point { position: Vec3::new(0.0, 0.0, 4.0) },
        intensity: Rgb::ONE,
        falloff: Falloff::None,
        shadows: true,
    }];
    scene
}

#[test]
fn a_metal_under_water_reflects_by_its_index_relative_to_water() {
    let mut scene = head_on(1.0);
    scene.media[0].ior = 1.5;
    let metal = material(&mut scene, bare(Interface::Conductor { eta: Rgb::splat(3.0), k: Rgb::splat(4.5) }));
    plane(&mut scene, Vec3::ZERO, Vec3::Z, metal);
    // ((2 - 1)^2 + 3^2) / ((2 + 1)^2 + 3^2)
    centres_are(&scene, Vec3::splat(10.0 / 18.0));
}

#[test]
fn murky_surroundings_weaken_light_even_where_nothing_is_transparent() {
    let mut scene = lit_wall();
    scene.media[0].absorption = Rgb::new(0.0, 0.1, 0.5);
    // Five on the way to the eye, four from the lamp.
    centres_are(&scene, (-scene.media[0].absorption * 9.0).exp());
    scene.settings.shadows = ShadowRule::Opaque;
    centres_are(&scene, (-scene.media[0].absorption * 5.0).exp());
}

#[test]
fn a_pane_of_fixed_share_still_reflects_totally() {
    let mut scene = head_on(1.0);
    scene.media[0].ior = 1.5;
    let rule = FresnelRule::Fixed(Rgb::splat(0.25));
    let pane = material(&mut scene, bare(Interface::ThinDielectric { ior: 1.0, rule, tint: Rgb::splat(0.5) }));
    plane(&mut scene, Vec3::ZERO, Vec3::Z, pane);
    centres_are(&scene, Vec3::splat(0.25 + 0.75 * 0.5));
    plane(&mut scene, Vec3::ZERO, Vec3::Z, pane);
    scene.geometry.remove(0);
    scene.objects.remove(0);
    // At 60 degrees, beyond the critical angle.
    scene.camera.eye = Vec3::new(5.0 * 3.0_f32.sqrt(), 0.0, 5.0);
    centres_are(&scene, Vec3::ONE);
    // Nor does it let a shadow ray through.
    let mut scene = lit_wall();
    scene.media[0].ior = 1.5;
    let pane = material(&mut scene, bare(Interface::ThinDielectric { ior: 1.0, rule, tint: Rgb::ONE }));
    let normal = Vec3::new(3.0_f32.sqrt() * 0.5, 0.0, 0.5);
    let mut sheet = vitrum::load::shapes::grid(1);
    let turn = glam::Quat::from_rotation_arc(Vec3::Y, normal);
    sheet.positions.iter_mut().for_each(|p| *p = turn * *p + Vec3::new(0.0, 0.0, 2.0));
    add(&mut scene, Shape::Mesh(sheet), pane);
    scene.camera.eye = Vec3::new(-4.0, 0.0, 2.0);
    centres_are(&scene, Vec3::ZERO);
}

#[test]
fn what_has_a_lower_priority_than_the_surroundings_is_not_there() {
    let mut scene = head_on(1.0);
    scene.media[0].priority = 0;
    let hidden = glass(&mut scene, 1.5, -1, Rgb::ONE);
    cuboid(&mut scene, Vec3::splat(-1.0), Vec3::splat(1.0), hidden);
    centres_are(&scene, Vec3::ONE);
    for outcome in both(&scene) {
        // In and out again, neither bent nor split.
        assert_eq!(outcome.rays.of(RayKind::Camera), 81);
        assert_eq!(outcome.rays.by_depth.len(), 1);
        let passes = outcome.rays.of(RayKind::Transmitted);
        assert!(passes > 50 && passes.is_multiple_of(2), "{passes}");
        assert_eq!(outcome.unmatched_exits, 0);
    }
}

#[test]
fn an_eye_in_the_half_space_of_an_upright_plane_is_in_its_medium() {
    let mut scene = head_on(1.0);
    let tinted = glass(&mut scene, 1.5, 0, Rgb::new(0.0, 0.1, 0.2));
    plane(&mut scene, Vec3::ZERO, Vec3::NEG_Z, tinted);
    let boundary = Boundary::<f64>::new(1.5, 1.0);
    let r = Exact::dielectric(&boundary, &boundary.cross(1.0)) as f32;
    // Five to the plane; what is reflected goes on without end.
    let through = (-Vec3::new(0.0, 0.1, 0.2) * 5.0).exp();
    centres_are(&scene, through * (1.0 - r) + Vec3::new(r, 0.0, 0.0));
    assert!(both(&scene).iter().all(|o| o.unmatched_exits == 0));
}

#[test]
fn an_eye_at_the_wall_of_an_upright_box_is_in_its_medium() {
    let mut scene = head_on(1.0);
    let clear = glass(&mut scene, 1.5, 0, Rgb::ZERO);
    // The diagonal of the lid is straight above the eye.
    cuboid(&mut scene, Vec3::new(-1.0, -1.0, 4.0), Vec3::new(1.0, 1.0, 6.0), clear);
    assert!(both(&scene).iter().all(|o| o.unmatched_exits == 0));
}

#[test]
fn a_shadow_ray_passes_256_surfaces_and_no_more() {
    for (panes, want) in [(256, 1.0), (257, 0.0)] {
        let mut scene = lit_wall();
        let clear = material(&mut scene, bare(Interface::Alpha { opacity: 0.0, mask: None }));
        for i in 0..panes {
            // Out of the eye's sight, which looks from the side.
            plane(&mut scene, Vec3::new(0.0, 0.0, 1.0 + 0.01 * i as f32), Vec3::Z, clear);
        }
        scene.camera.eye = Vec3::new(3.0, 0.0, 0.5);
        centres_are(&scene, Vec3::splat(want));
    }
}

#[test]
fn exits_without_an_entry_count_on_shadow_rays_too() {
    let mut scene = lit_wall();
    let clear = glass(&mut scene, 1.5, 0, Rgb::ZERO);
    // The lamp stands above the plane's outside, the wall within: the eye beside it has to be told that it is in air.
    plane(&mut scene, Vec3::new(0.0, 0.0, 2.0), Vec3::Z, clear);
    scene.camera.eye = Vec3::new(3.0, 0.0, 0.5);
    scene.camera.medium = Some(0);
    scene.camera.projection = Projection::Pinhole { vfov: 5.0 };
    for outcome in both(&scene) {
        assert_eq!(outcome.unmatched_exits, outcome.rays.of(RayKind::Shadow));
        assert!(outcome.unmatched_exits > 0);
    }
}

#[test]
fn light_between_equal_indices_goes_on_as_it_came_at_any_angle() {
    let mut scene = head_on(0.0);
    scene.environment = Environment::Gradient { nadir: Rgb::X, horizon: Rgb::Y, zenith: Rgb::Z };
    let same = glass(&mut scene, 1.0, 0, Rgb::ZERO);
    let mut sheet = cuboid_mesh(Vec3::new(-2.0, -1.0, -2.0), Vec3::new(2.0, 0.0, 2.0));
    sheet.normals = vec![Vec3::Y];
    sheet.normal_indices = vec![[0; 3]; 12];
    add(&mut scene, Shape::Mesh(sheet), same);
    // Less than a twentieth of a degree above the top.
    let rise = 0.0004_f32;
    scene.camera = Camera {
        eye: Vec3::new(0.0, 4.0 * rise, 4.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        projection: Projection::Pinhole { vfov: 0.01 },
        medium: None,
    };
    centres_are(&scene, Vec3::new(rise, 1.0 - rise, 0.0));
}

#[test]
fn a_picture_on_a_shape_without_texture_coordinates_shows_its_corner() {
    let pixels = vec![Rgb::X, Rgb::Y, Rgb::ZERO, Rgb::ZERO, Rgb::ZERO, Rgb::ZERO, Rgb::Z, Rgb::ONE, Rgb::ZERO];
    let mut scene = head_on(0.0);
    scene.textures = vec![vitrum::scene::Texture::new("picture", 3, 3, pixels)];
    scene.ambient = Rgb::ONE;
    let pictured = Material { diffuse: Colour::Image { texture: 0, scale: Rgb::ONE }, ..Material::default() };
    let pictured = material(&mut scene, pictured);
    scene.lights = lit_wall().lights;
    // The corner where the picture's repetitions meet: a quarter of each corner pixel.
    let want = (Rgb::X + Rgb::ZERO + Rgb::Z + Rgb::ZERO) * 0.25;
    plane(&mut scene, Vec3::ZERO, Vec3::Z, pictured);
    centres_are(&scene, want);
    scene.geometry.clear();
    scene.objects.clear();
    cuboid(&mut scene, Vec3::splat(-1.0), Vec3::new(1.0, 1.0, 0.0), pictured);
    centres_are(&scene, want);
    scene.geometry.clear();
    scene.objects.clear();
    sphere(&mut scene, Vec3::new(0.0, 0.0, -1.0), 1.0, pictured);
    // Due +z: half a turn from -z, at half height, where the columns' ends meet in the middle row.
    centres_are(&scene, Rgb::ZERO);
}

#[test]
fn a_mask_and_colours_of_corners_are_seen_alike_by_every_renderer() {
    let mut scene = head_on(0.0);
    scene.environment = Environment::Constant(Rgb::splat(2.0));
    scene.textures = vec![vitrum::scene::Texture::new("mask", 2, 1, vec![Rgb::ZERO, Rgb::ONE])];
    scene.textures[0].wrap = [vitrum::scene::Wrap::Clamp; 2];
    scene.ambient = Rgb::ONE;
    scene.lights = lit_wall().lights;
    let cover = Material {
        diffuse: Colour::Corners { texture: None, scale: Rgb::splat(0.5) },
        emission: Rgb::splat(0.25),
        ..bare(Interface::Alpha { opacity: 0.5, mask: Some(0) })
    };
    let cover = material(&mut scene, cover);
    let corners = [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -1.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
    let mut mesh = vitrum::geometry::TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]);
    mesh.colours = vec![Rgb::X, Rgb::Y, Rgb::Z];
    mesh.uvs = [0.75, 0.25].map(|u| glam::Vec2::new(u, 0.5)).to_vec();
    mesh.uv_indices = vec![[0, 0, 0]];
    add(&mut scene, Shape::Mesh(mesh.clone()), cover);
    // Half of the sky, half of the emission, and half of the light that the colour between the corners reflects.
    centres_are(&scene, 1.0 + 0.125 + 0.25 * Rgb::new(0.25, 0.25, 0.5));
    scene.geometry.clear();
    scene.objects.clear();
    mesh.uv_indices = vec![[1, 1, 1]];
    add(&mut scene, Shape::Mesh(mesh), cover);
    centres_are(&scene, Rgb::splat(2.0));
}
