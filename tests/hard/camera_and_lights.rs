//! Cameras, frames and lights at their limits.

use glam::Vec3;
use vitrum::load::{self, LoadOptions};
use vitrum::render::Options;
use vitrum::scene::{Colour, Falloff, Light, LightKind, Material, Rgb};

use crate::support::{Rng, scenes};

fn lamp(position: Vec3) -> Light {
    Light {
        name: String::new(),
        kind: LightKind::Point { position },
        intensity: Rgb::ONE,
        falloff: Falloff::InverseSquare,
        shadows: true,
    }
}

/// CL-02: pictures of one pixel, one row, one column, and sizes that no packet or tile divides are rendered in full, and
/// each pixel is that of the whole picture.
#[test]
fn pictures_of_any_size_are_rendered_in_full() {
    let mut scene = scenes::empty(0.25);
    for (width, height) in [(1, 1), (1, 9), (9, 1), (7, 5), (8, 4), (33, 17), (65_535, 1), (1, 4099), (0, 0), (3, 0)] {
        (scene.settings.width, scene.settings.height) = (width, height);
        let outcome = scenes::native(&scene, &Options::default());
        assert_eq!(outcome.film.pixels.len(), width as usize * height as usize);
        assert!(outcome.film.pixels.iter().all(|p| *p == [0.25; 3]), "{width} by {height}");
        assert_eq!(outcome.rays.total(), u64::from(width) * u64::from(height));
    }
}

/// CL-03: discs that face along each axis, the two directions that break frames made near -z (Duff et al. 2017) and a
/// thousand others lie across the direction asked for.
#[test]
fn a_frame_around_any_direction_is_square_to_it() {
    let mut rng = Rng::new(81);
    let mut directions = vec![Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z];
    directions.push(Vec3::new(0.000_385_273_16, 0.000_384_600_16, -0.999_999_9));
    directions.push(Vec3::new(-0.000_198_135_81, -0.000_089_468_39, -0.999_999_9));
    directions.extend([1e-4, 1e-6, 1e-8, -1e-7].map(|x| Vec3::new(x, x * 0.5, -1.0)));
    directions.extend((0..1000).map(|_| rng.direction()));
    let mut text = String::from("[[material]]\nname = 'm'\ntype = 'diffuse'\n");
    for d in &directions {
        let [x, y, z] = d.to_array();
        text +=
            &format!("[[mesh]]\nshape = 'disc'\nmaterial = 'm'\ntessellation = 8\nnormal = [{x:?}, {y:?}, {z:?}]\n");
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.toml"), text).unwrap();
    let scene = load::scene(&folder.path().join("a.toml"), &LoadOptions::default()).unwrap().scene;
    for (g, d) in scene.geometry.iter().zip(&directions) {
        let vitrum::geometry::Shape::Mesh(mesh) = &g.shape else { panic!("a disc is triangles") };
        let d = d.as_dvec3().normalize();
        for i in 0..mesh.triangles.len() {
            let [a, b, c] = mesh.corners(i).map(|p| p.as_dvec3());
            let normal = (b - a).cross(c - a).normalize();
            assert!((normal - d).length() < 1e-6, "{normal} for {d}");
        }
        let around = mesh.positions.iter().filter(|p| (p.length() - 1.0).abs() < 1e-6).count();
        assert!(around >= 8, "the disc is round: {around}");
    }
}

/// CL-04: lamps on the surface, at the eye, a hair above the surface and inside of things give finite pixels, in both
/// conventions.
#[test]
fn lamps_in_impossible_places_give_finite_pixels() {
    for falloff in [Falloff::InverseSquare, Falloff::None] {
        let mut scene = scenes::empty(0.1);
        let white = Material { diffuse: Colour::Constant(Rgb::ONE), ..Material::default() };
        let white = scenes::material(&mut scene, white);
        scenes::plane(&mut scene, Vec3::new(0.0, -1.0, 0.0), Vec3::Y, white);
        scenes::sphere(&mut scene, Vec3::ZERO, 0.5, white);
        scenes::cuboid(&mut scene, Vec3::new(0.6, -1.0, -0.5), Vec3::new(1.2, 0.0, 0.5), white);
        let mut places = vec![scene.camera.eye, Vec3::ZERO, Vec3::new(0.0, 0.5, 0.0), Vec3::new(0.6, -1.0, -0.5)];
        places.extend([0.0, 1e-30, 1e-7, 1e-5].map(|h| Vec3::new(0.3, -1.0 + h, 1.0)));
        // Where a camera ray arrives, exactly.
        let (eye, middle) = (scene.camera.eye, Vec3::new(0.0, -1.0, 2.0));
        scene.camera.target = middle;
        places.push(middle);
        for place in places {
            scene.lights = vec![Light { falloff, ..lamp(place) }];
            let outcome = scenes::native(&scene, &Options::default());
            assert_eq!(outcome.clamped, 0, "{place}");
            assert!(outcome.film.pixels.as_flattened().iter().all(|x| x.is_finite() && *x >= 0.0), "{place}");
        }
        assert_eq!(scene.camera.eye, eye);
    }
}

/// CL-05: a coarse sphere with interpolated normals and a light that shines along its facets' planes: what the geometric
/// normal faces away from stays dark.
#[test]
fn no_light_leaks_round_a_facet_that_faces_away() {
    let mut scene = scenes::empty(0.0);
    let white = Material { diffuse: Colour::Constant(Rgb::ONE), ..Material::default() };
    let white = scenes::material(&mut scene, white);
    let mut ball = super::self_intersection::icosahedron();
    ball.normals.clone_from(&ball.positions);
    ball.normal_indices.clone_from(&ball.triangles);
    let flat = vitrum::geometry::TriMesh { normals: vec![], normal_indices: vec![], ..ball.clone() };
    let mut rng = Rng::new(82);
    let mut dark = 0;
    for _ in 0..20 {
        let direction = rng.direction().normalize();
        let kind = LightKind::Directional { direction };
        scene.lights = vec![Light { kind, falloff: Falloff::None, shadows: false, ..lamp(Vec3::ZERO) }];
        let mut film = |mesh: &vitrum::geometry::TriMesh| {
            scene.geometry.clear();
            scene.objects.clear();
            scenes::add(&mut scene, vitrum::geometry::Shape::Mesh(mesh.clone()), white);
            scenes::native(&scene, &Options::default()).film
        };
        for (smooth, flat) in film(&ball).pixels.iter().zip(&film(&flat).pixels) {
            assert!(flat[0] > 0.0 || smooth[0] == 0.0, "{smooth:?} where the facet faces away");
            dark += usize::from(flat[0] == 0.0);
        }
    }
    assert!(dark > 1000, "{dark}");
}

/// CL-09: a hundred thousand lamps take memory for one packet of shadow rays at a time, and add up.
#[test]
fn a_hundred_thousand_lamps_add_up() {
    let mut scene = scenes::empty(0.0);
    (scene.settings.width, scene.settings.height) = (3, 3);
    scene.camera.eye = Vec3::new(0.0, 0.0, 5.0);
    let white = Material { diffuse: Colour::Constant(Rgb::ONE), ..Material::default() };
    let white = scenes::material(&mut scene, white);
    scenes::plane(&mut scene, Vec3::ZERO, Vec3::Z, white);
    let one = Light { intensity: Rgb::splat(1e-5), falloff: Falloff::None, ..lamp(Vec3::new(0.0, 3.0, 4.0)) };
    scene.lights = vec![one; 100_000];
    let seen = scenes::native(&scene, &Options::default()).film.at(1, 1)[0];
    assert!((seen - 0.8).abs() < 1e-5, "{seen}");
}
