//! Mirrors, metals, coats, holes, panes, patterns and smooth normals.

use glam::{DVec3, Vec2, Vec3};
use vitrum::geometry::{Shape, TriMesh};
use vitrum::render::RayKind;
use vitrum::scene::{
    Colour, Environment, Falloff, FresnelRule, Interface, LightKind, Material, MirrorSource, Rgb, Scene, Texels,
    Texture, Wrap,
};

use super::build::*;

const DOWN: [f64; 3] = [0.0, 0.0, -1.0];

/// The interface on a wall at z = 0 with a base that sends 1, under a sky of 2 and before a lamp of 8 that stands
/// behind the wall.
fn wall(interface: Interface) -> Scene {
    let mut scene = empty();
    put(&mut scene, plane(Vec3::ZERO, Vec3::Z), Material { emission: Rgb::ONE, ..bare(interface) });
    put(&mut scene, plane(Vec3::Z * -5.0, Vec3::Z), emitter(8.0));
    scene.environment = Environment::Constant(Rgb::splat(2.0));
    scene
}

#[test]
fn every_interface_divides_light_as_the_table_says() {
    let angle = 1.1_f64;
    let r = fresnel(1.0, 1.5, angle);
    let thin = 2.0 * r / (1.0 + r);
    let tint = Rgb::splat(0.5);
    for (interface, want) in [
        (Interface::Opaque, 1.0),
        (Interface::Mirror { reflectance: Rgb::splat(0.75), source: MirrorSource::Traced }, 1.0 + 2.0 * 0.75),
        (Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fresnel, tint }, {
            1.0 + 2.0 * thin + 8.0 * 0.5 * (1.0 - thin)
        }),
        (Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fixed(Rgb::splat(0.25)), tint }, {
            1.0 + 2.0 * 0.25 + 8.0 * 0.5 * 0.75
        }),
        (Interface::Coated { ior: 1.5 }, (1.0 - r) + 2.0 * r),
        (Interface::Alpha { opacity: 0.25, mask: None }, 0.25 + 8.0 * 0.75),
    ] {
        let seen = trace(&wall(interface), [0.0, 0.0, 3.0], [angle.sin(), 0.0, -angle.cos()]);
        close(seen.radiance.x, want, 1e-14);
        assert_eq!(seen.truncated.x, 0.0);
    }
}

#[test]
fn a_metal_reflects_per_channel_what_its_complex_index_says() {
    let (eta, k) = (Rgb::new(0.25, 0.5, 1.5), Rgb::new(3.0, 2.5, 2.0));
    let seen = trace(&wall(Interface::Conductor { eta, k }), [0.0, 0.0, 3.0], DOWN).radiance;
    for i in 0..3 {
        let (n, k) = (f64::from(eta[i]), f64::from(k[i]));
        let r = ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
        close(seen[i], 1.0 + 2.0 * r, 1e-14);
    }
}

#[test]
fn a_mirror_of_the_environment_sees_it_past_what_stands_between() {
    for (source, want) in [(MirrorSource::Traced, 8.0), (MirrorSource::Environment, 2.0)] {
        let mut scene = empty();
        scene.environment = Environment::Constant(Rgb::splat(2.0));
        put(&mut scene, plane(Vec3::ZERO, Vec3::Z), bare(Interface::Mirror { reflectance: Rgb::splat(0.5), source }));
        put(&mut scene, sphere(0.0, 0.0, 9.0, 1.0), emitter(8.0));
        close(radiance(&scene, [0.0, 0.0, 3.0], DOWN), 0.5 * want, 0.0);
    }
}

#[test]
fn a_hall_of_mirrors_is_a_geometric_series() {
    let mut scene = empty();
    let material = Material {
        emission: Rgb::ONE,
        ..bare(Interface::Mirror { reflectance: Rgb::splat(0.875), source: MirrorSource::Traced })
    };
    put(&mut scene, plane(Vec3::Z, -Vec3::Z), material.clone());
    put(&mut scene, plane(-Vec3::Z, Vec3::Z), material);
    for depth in [0, 1, 2, 7, 5000] {
        scene.settings.max_depth = depth;
        let seen = trace(&scene, [0.0; 3], [0.1, 0.2, -1.0]);
        let left = 0.875_f64.powi(depth as i32 + 1);
        close(seen.radiance.x, (1.0 - left) / 0.125, 1e-13);
        close(seen.truncated.x, left, 1e-14);
        if depth < 1000 {
            assert_eq!(seen.rays.total(), u64::from(depth) + 1);
        }
    }
    scene.settings.max_depth = 5000;
    scene.settings.cutoff = 0.5;
    // 0.875^5 is above a half, 0.875^6 below.
    close(trace(&scene, [0.0; 3], DOWN).truncated.x, 0.875_f64.powi(6), 1e-15);
}

#[test]
fn a_checker_counts_cubes_in_world_space() {
    let mut scene = empty();
    let colour =
        Colour::Checker { even: Rgb::splat(0.25), odd: Rgb::splat(0.75), size: 2.0, offset: Vec3::new(0.5, 1.0, 0.0) };
    put(&mut scene, plane(Vec3::ZERO, Vec3::Y), Material { diffuse: colour, ..Material::default() });
    scene.lights.push(light(LightKind::Directional { direction: -Vec3::Y }, Falloff::None));
    let at = |x, z| radiance(&scene, [x, 1.0, z], [0.0, -1.0, 0.0]) / 3.0;
    // At height 0 the cube is -1 in y.
    close(at(1.0, 1.0), 0.75, 1e-15);
    close(at(0.4, 1.0), 0.25, 1e-15);
    close(at(0.4, -1.0), 0.75, 1e-15);
    close(at(2.6, -0.1), 0.75, 1e-15);
    close(at(2.6, 0.1), 0.25, 1e-15);
}

/// A square over 0..1 in x and y facing +z, v upwards, with a picture of 2 by 2: 1 2 above 3 4 (hundredths).
#[test]
fn a_picture_lies_the_right_way_up() {
    let mut scene = empty();
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    let mesh = TriMesh {
        positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
        uvs: corners.map(|(x, y)| Vec2::new(x, y)).to_vec(),
        uv_indices: triangles.clone(),
        triangles,
        ..TriMesh::default()
    };
    let diffuse = Colour::Image { texture: 0, scale: Rgb::splat(0.5) };
    put(&mut scene, Shape::Mesh(mesh), Material { diffuse, ..Material::default() });
    let pixels = [1.0, 2.0, 3.0, 4.0].map(Rgb::splat).to_vec();
    scene.textures.push(Texture::new("", 2, 2, pixels));
    scene.lights.push(light(LightKind::Directional { direction: -Vec3::Z }, Falloff::None));
    let at = |x, y| radiance(&scene, [x, y, 1.0], DOWN) / 1.5;
    close(at(0.25, 0.75), 1.0, 1e-14);
    close(at(0.75, 0.75), 2.0, 1e-14);
    close(at(0.25, 0.25), 3.0, 1e-14);
    close(at(0.75, 0.25), 4.0, 1e-14);
    close(at(0.5, 0.5), 2.5, 1e-14);
}

/// A square over 0..1 in x and y that shines by 1, seen before a sky of 3.
fn shining_square(colour: Colour, interface: Interface) -> Scene {
    let mut scene = empty();
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    let mesh = TriMesh {
        positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
        uvs: corners.map(|(x, y)| Vec2::new(x, y)).to_vec(),
        uv_indices: triangles.clone(),
        triangles,
        colours: corners.map(|(x, y)| Vec3::new(x, y, 0.5)).to_vec(),
        ..TriMesh::default()
    };
    put(&mut scene, Shape::Mesh(mesh), Material { diffuse: colour, emission: Rgb::ONE, ..bare(interface) });
    scene.environment = Environment::Constant(Rgb::splat(3.0));
    scene
}

#[test]
fn a_mask_covers_where_its_picture_is_white_for_camera_rays_and_for_shadow_rays() {
    let mask = Interface::Alpha { opacity: 0.5, mask: Some(0) };
    let mut scene = shining_square(Colour::Constant(Rgb::ZERO), mask);
    let light = Box::new(std::array::from_fn(|code| code as f32 / 255.0));
    scene.textures.push(Texture::new("mask", 2, 1, Texels::Grey { codes: vec![0, 255], light }));
    let at = |scene: &Scene, x| radiance(scene, [x, 0.5, 1.0], DOWN);
    close(at(&scene, 0.25), 3.0, 1e-14);
    close(at(&scene, 0.75), 0.5 + 0.5 * 3.0, 1e-14);
    close(at(&scene, 0.5), 0.25 + 0.75 * 3.0, 1e-14);
    scene.textures[0].wrap = [Wrap::Clamp; 2];
    close(at(&scene, 0.001), 3.0, 1e-14);
    // A floor below, which the lamp lights through the square.
    put(&mut scene, plane(Vec3::Z * -1.0, Vec3::Z), Material::default());
    scene.lights.push(super::build::light(LightKind::Directional { direction: -Vec3::Z }, Falloff::None));
    scene.settings.shadows = vitrum::scene::ShadowRule::Straight;
    let below = |x| radiance(&scene, [x, 0.5, -0.5], DOWN);
    close(below(0.75) / below(0.25), 0.5, 1e-6);
    close(below(0.5) / below(0.25), 0.75, 1e-6);
}

#[test]
fn colours_of_corners_are_interpolated_and_multiply_the_picture() {
    let mut scene = shining_square(Colour::Corners { texture: None, scale: Rgb::splat(0.5) }, Interface::Opaque);
    scene.materials[0].emission = Rgb::ZERO;
    scene.lights.push(light(LightKind::Directional { direction: -Vec3::Z }, Falloff::None));
    let at = |scene: &Scene, x, y| trace(scene, [x, y, 1.0], DOWN).radiance / 3.0;
    let near = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-7, "{a} {b}");
    near(at(&scene, 0.3, 0.6), DVec3::new(0.15, 0.3, 0.25));
    scene.textures.push(Texture::new("", 1, 1, vec![Rgb::new(1.0, 0.5, 0.0)]));
    scene.materials[0].diffuse = Colour::Corners { texture: Some(0), scale: Rgb::ONE };
    near(at(&scene, 0.3, 0.6), DVec3::new(0.3, 0.3, 0.0));
}

#[test]
fn an_equirectangular_sky_has_its_middle_towards_minus_z_and_turns_towards_plus_x() {
    let mut scene = empty();
    // Four columns, two rows; columns are centred towards -z turned by -135, -45, 45 and 135 degrees.
    let pixels = (0..8).map(|i| Rgb::splat(i as f32)).collect::<Vec<_>>();
    scene.textures.push(Texture::new("", 4, 2, pixels));
    let look = |scene: &Scene, azimuth: f64, height: f64| {
        let (s, c) = azimuth.to_radians().sin_cos();
        let (sin, cos) = height.to_radians().sin_cos();
        radiance(scene, [0.0; 3], [s * cos, sin, -c * cos])
    };
    scene.environment = Environment::LatLong { texture: 0, scale: Rgb::splat(2.0), rotation: 0.0 };
    for (azimuth, column) in [(-135.0, 0.0), (-45.0, 1.0), (45.0, 2.0), (135.0, 3.0)] {
        close(look(&scene, azimuth, 45.0), 2.0 * column, 1e-13);
        close(look(&scene, azimuth, 80.0), 2.0 * column, 1e-13);
        close(look(&scene, azimuth, -45.0), 2.0 * (4.0 + column), 1e-13);
    }
    close(look(&scene, 180.0, 60.0), 2.0 * 1.5, 1e-13);
    let quarter = std::f32::consts::FRAC_PI_2;
    scene.environment = Environment::LatLong { texture: 0, scale: Rgb::ONE, rotation: quarter };
    close(look(&scene, 45.0, 45.0), 1.0, 1e-6);
}

#[test]
fn a_gradient_sky_is_linear_in_height() {
    let mut scene = empty();
    scene.environment =
        Environment::Gradient { nadir: Rgb::splat(8.0), horizon: Rgb::splat(2.0), zenith: Rgb::splat(1.0) };
    for (height, want) in [(-1.0, 8.0), (-0.5, 5.0), (0.0, 2.0), (0.5, 1.5), (1.0, 1.0)] {
        let level = (1.0_f64 - height * height).sqrt();
        close(radiance(&scene, [0.0; 3], [level, height, 0.0]), want, 1e-14);
    }
}

/// One triangle in z = 0 whose normals all lean by `lean` radians towards +x.
fn leaning(lean: f32, interface: Interface) -> Scene {
    let mut scene = empty();
    let mesh = TriMesh {
        positions: vec![Vec3::new(-9.0, -9.0, 0.0), Vec3::new(9.0, -9.0, 0.0), Vec3::new(0.0, 9.0, 0.0)],
        triangles: vec![[0, 1, 2]],
        normals: vec![Vec3::new(lean.sin(), 0.0, lean.cos())],
        normal_indices: vec![[0, 0, 0]],
        ..TriMesh::default()
    };
    put(&mut scene, Shape::Mesh(mesh), bare(interface));
    scene
}

#[test]
fn a_mirror_reflects_about_the_interpolated_normal_on_the_side_the_ray_is_on() {
    let mirror = Interface::Mirror { reflectance: Rgb::ONE, source: MirrorSource::Traced };
    let mut scene = leaning(0.25, mirror);
    let towards = DVec3::new(0.5_f64.sin(), 0.0, 0.5_f64.cos());
    let lamp = (towards * 50.0).as_vec3();
    put(&mut scene, sphere(lamp.x, lamp.y, lamp.z, 0.01), emitter(1.0));
    close(radiance(&scene, [0.0, 0.0, 3.0], DOWN), 1.0, 0.0);
    scene.geometry[1].shape = sphere(lamp.x, lamp.y, -lamp.z, 0.01);
    assert_eq!(radiance(&scene, [0.0, 0.0, 3.0], DOWN), 0.0);
    // From behind, the turned normal (-sin, 0, -cos) sends +z to (-sin 2a, 0, -cos 2a).
    scene.geometry[1].shape = sphere(-lamp.x, lamp.y, -lamp.z, 0.01);
    close(radiance(&scene, [0.0, 0.0, -3.0], [0.0, 0.0, 1.0]), 1.0, 0.0);
}

#[test]
fn an_interpolated_normal_never_sends_light_through_the_surface() {
    let mirror = Interface::Mirror { reflectance: Rgb::ONE, source: MirrorSource::Traced };
    let mut scene = leaning(1.2, mirror);
    put(&mut scene, plane(Vec3::Z * -1.0, Vec3::Z), emitter(5.0));
    white(&mut scene);
    for angle in [0.0, 0.5, 1.0, 1.5] {
        let (s, c) = f64::sin_cos(angle);
        close(radiance(&scene, [-3.0 * s, 0.0, 3.0 * c], [s, 0.0, -c]), 1.0, 0.0);
        close(radiance(&scene, [3.0 * s, 0.0, 3.0 * c], [-s, 0.0, -c]), 1.0, 0.0);
    }
}

/// Case RF-09 of the catalogue.
#[test]
fn what_is_refracted_about_an_interpolated_normal_ends_up_below_the_surface() {
    for lean in [0.5, 1.0, 1.3, 1.5] {
        for angle in [-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5] {
            for from_glass in [false, true] {
                let mut scene = leaning(lean, Interface::Opaque);
                let glass = medium(&mut scene, if from_glass { 0.8 } else { 2.5 }, 0.0, 0);
                scene.materials[0] = dielectric(glass);
                put(&mut scene, plane(Vec3::Z * -1.0, Vec3::Z), emitter(1.0));
                scene.settings.max_depth = 1;
                let (s, c) = f64::sin_cos(angle);
                let seen = trace(&scene, [-3.0 * s, 0.0, 3.0 * c], [s, 0.0, -c]);
                // The sky is black: whatever is seen was refracted.
                if seen.rays.of(RayKind::Transmitted) == 1 {
                    assert!(seen.radiance.x > 0.0, "lean {lean}, angle {angle}: {seen:?}");
                } else {
                    assert!(from_glass, "only from the denser side is reflection total");
                }
            }
        }
    }
}

/// Case CL-05 of the catalogue.
#[test]
fn no_light_from_behind_the_true_surface_is_let_in_by_an_interpolated_normal() {
    let mut scene = leaning(1.2, Interface::Opaque);
    scene.materials[0] = lambert(0.5);
    let towards = |x: f32, z: f32| LightKind::Directional { direction: -Vec3::new(x, 0.0, z).normalize() };
    scene.lights.push(light(towards(1.0, -0.1), Falloff::None));
    scene.lights[0].shadows = false;
    assert_eq!(radiance(&scene, [0.0, 0.0, 3.0], DOWN), 0.0);
    scene.lights[0].kind = towards(1.0, 0.1);
    assert!(radiance(&scene, [0.0, 0.0, 3.0], DOWN) > 1.0);
    // In front of the surface, and behind the interpolated normal.
    scene.lights[0].kind = towards(-1.0, 0.1);
    assert_eq!(radiance(&scene, [0.0, 0.0, 3.0], DOWN), 0.0);
    // From behind, the normal is turned to where the viewer and the light are.
    scene.lights[0].kind = towards(-1.0, -0.5);
    let cos = DVec3::new(1.2_f64.sin(), 0.0, 1.2_f64.cos()).dot(DVec3::new(1.0, 0.0, 0.5).normalize());
    close(radiance(&scene, [0.0, 0.0, -1.0], [2.57, 0.0, 1.0]), 0.5 * 3.0 * cos, 1e-6);
}
