//! Rays that leave a surface do not hit it again, and hit the next one at any distance.
//!
//! Tested through whole pictures, since the renderer decides where a ray starts. A convex mirror's rays hit nothing. A
//! body of the surrounding index is entered once and left once. Shadows change nothing on a convex body.

use glam::{DVec3, Vec3};
use vitrum::geometry::{Shape, TriMesh};
use vitrum::load::{self, LoadOptions};
use vitrum::render::{Options, Outcome, RayKind};
use vitrum::scene::{
    Camera, Colour, Falloff, Interface, Light, LightKind, Material, MirrorSource, Projection, Rgb, Scene,
};

use crate::support::aim::{count, placed, places};
use crate::support::{Rng, scenes, shapes};

/// Twenty triangles, each in a plane of its own: convex however it is rounded.
pub fn icosahedron() -> TriMesh {
    let g = (1.0 + 5.0_f32.sqrt()) * 0.5;
    let mut positions = Vec::new();
    for (a, b) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
        positions.extend([Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)].map(|p| p.normalize()));
    }
    let near = |a: usize, b: usize| positions[a].distance(positions[b]) < 1.1;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in (b + 1..12).filter(|&c| near(a, b) && near(b, c) && near(c, a)) {
                let (pa, pb, pc) = (positions[a], positions[b], positions[c]);
                let outward = (pb - pa).cross(pc - pa).dot(pa) > 0.0;
                triangles.push(if outward { [a, b, c] } else { [a, c, b] }.map(|k| k as u32));
            }
        }
    }
    assert_eq!(triangles.len(), 20);
    TriMesh { positions, triangles, ..Default::default() }
}

/// Random turns make every test see other facets.
fn turned(mut mesh: TriMesh, rng: &mut Rng) -> TriMesh {
    let turn = glam::Quat::from_axis_angle(rng.direction(), rng.unit() * 6.0);
    mesh.positions.iter_mut().for_each(|p| *p = turn * *p);
    mesh
}

fn mirror() -> Interface {
    Interface::Mirror { reflectance: Rgb::ONE, source: MirrorSource::Traced }
}

/// An empty bright scene that looks at a body of radius `scale` at `offset` from `from`.
fn looking_at(offset: DVec3, scale: f64, from: Vec3) -> Scene {
    let mut scene = scenes::empty(1.0);
    scene.camera = Camera {
        eye: (offset + from.as_dvec3() * (3.0 * scale)).as_vec3(),
        target: offset.as_vec3(),
        up: from.any_orthogonal_vector(),
        projection: Projection::Pinhole { vfov: 40.0 },
        medium: None,
    };
    let edge = 24 * count(1).isqrt() as u32;
    (scene.settings.width, scene.settings.height) = (edge, edge);
    scene
}

fn render(scene: &Scene) -> Outcome {
    let outcome = scenes::native(scene, &Options::default());
    assert_eq!((outcome.non_finite, outcome.clamped), (0, 0));
    outcome
}

fn rays(outcome: &Outcome, depth: usize, kind: RayKind) -> u64 {
    outcome.rays.by_depth.get(depth).map_or(0, |row| row[kind as usize])
}

/// A mirror's reflected rays, which must meet nothing.
fn assert_mirror_is_left(mut scene: Scene, shapes: Vec<Shape>, what: &str) {
    let material = scenes::material(&mut scene, scenes::bare(mirror()));
    shapes.into_iter().for_each(|s| scenes::add(&mut scene, s, material));
    let outcome = render(&scene);
    let left = rays(&outcome, 1, RayKind::Reflected);
    assert!(left > 100, "{what}: only {left} rays are reflected");
    assert_eq!(rays(&outcome, 2, RayKind::Reflected), 0, "{what}: of {left}");
}

/// A body of the index around it: rays enter once and leave once.
fn assert_entered_and_left(mut scene: Scene, shape: Shape, what: &str) {
    let same = scenes::glass(&mut scene, 1.0, 0, Rgb::ZERO);
    scenes::add(&mut scene, shape, same);
    let outcome = render(&scene);
    let (entered, left) = (rays(&outcome, 1, RayKind::Transmitted), rays(&outcome, 2, RayKind::Transmitted));
    assert!(entered > 100, "{what}: only {entered} rays enter");
    assert_eq!(outcome.unmatched_exits, 0, "{what}: left without having entered");
    assert_eq!(rays(&outcome, 3, RayKind::Transmitted), 0, "{what}: met a third time");
    // Past the outline a chord may be shorter than the roundings of its ends.
    assert!(left <= entered && left * 10 >= entered * 9, "{what}: {entered} enter, {left} leave");
}

/// Lambert's light on a convex body, the same with and without shadows.
fn assert_not_in_its_own_shadow(mut scene: Scene, shape: Shape, what: &str) {
    let white = Material { diffuse: Colour::Constant(Rgb::ONE), ..Material::default() };
    let white = scenes::material(&mut scene, white);
    scenes::add(&mut scene, shape, white);
    let mut rng = Rng::new(50);
    let view = (scene.camera.target - scene.camera.eye).normalize();
    for direction in [view, (view + rng.direction()).normalize(), (view + rng.direction()).normalize()] {
        scene.lights.push(Light {
            name: String::new(),
            kind: LightKind::Directional { direction },
            intensity: Rgb::ONE,
            falloff: Falloff::None,
            shadows: true,
        });
    }
    let shaded = render(&scene);
    assert!(shaded.rays.of(RayKind::Shadow) > 100, "{what}");
    scene.lights.iter_mut().for_each(|l| l.shadows = false);
    assert!(shaded.film == render(&scene).film, "{what}: in its own shadow");
}

/// SI-01, SI-02, SI-04, SI-10: reflected, transmitted and shadow rays from a convex mesh at scales 1e-3 to 1e3 and places
/// up to 1e6 and Embree's, three views each: none meets what it left.
#[test]
fn a_convex_mesh_of_any_scale_anywhere_is_left_at_once() {
    let mut rng = Rng::new(51);
    let mut configurations = 0;
    for (scale, offset) in places() {
        for view in 0..3 {
            let mesh = turned(icosahedron(), &mut rng);
            let Some(mesh) = placed(&mesh, scale, offset) else { continue };
            configurations += 1;
            let (from, what) = (rng.direction(), format!("scale {scale} at {offset}, view {view}"));
            let scene = || looking_at(offset, scale, from);
            assert_mirror_is_left(scene(), vec![Shape::Mesh(mesh.clone())], &what);
            assert_not_in_its_own_shadow(scene(), Shape::Mesh(mesh.clone()), &what);
            assert_entered_and_left(scene(), Shape::Mesh(mesh), &what);
        }
    }
    assert!(configurations >= 27, "{configurations}");
}

/// SI-10: as above, for exact spheres.
#[test]
fn a_sphere_of_any_scale_anywhere_is_left_at_once() {
    let mut rng = Rng::new(52);
    for (scale, offset) in places() {
        if placed(&icosahedron(), scale, offset).is_none() {
            continue;
        }
        let from = rng.direction();
        let ball = Shape::Sphere(vitrum::geometry::Sphere { centre: offset.as_vec3(), radius: scale as f32 });
        let what = format!("radius {scale} at {offset}");
        let scene = || looking_at(offset, scale, from);
        assert_mirror_is_left(scene(), vec![ball.clone()], &what);
        assert_not_in_its_own_shadow(scene(), ball.clone(), &what);
        assert_entered_and_left(scene(), ball, &what);
    }
}

/// SI-09: sizes and places over all exponents that areas allow: no step that counts in ulps goes wrong near zero, because
/// none is taken.
#[test]
fn every_exponent_of_size_and_place_is_left_at_once() {
    let mut rng = Rng::new(53);
    for exponent in (-50..=50).step_by(5) {
        let scale = 2_f64.powi(exponent);
        let place = rng.direction().as_dvec3() * scale * [0.0, 1.0, 100.0][exponent.unsigned_abs() as usize % 3];
        let Some(mesh) = placed(&turned(icosahedron(), &mut rng), scale, place) else { continue };
        let from = rng.direction();
        let what = format!("scale 2^{exponent}");
        assert_mirror_is_left(looking_at(place, scale, from), vec![Shape::Mesh(mesh.clone())], &what);
        assert_not_in_its_own_shadow(looking_at(place, scale, from), Shape::Mesh(mesh.clone()), &what);
        assert_entered_and_left(looking_at(place, scale, from), Shape::Mesh(mesh), &what);
    }
}

/// SI-05: meshes scaled by their scene file, where offsets in object space would be too small or too large by as much.
#[test]
fn a_body_scaled_by_its_scene_file_is_left_at_once() {
    let folder = tempfile::tempdir().unwrap();
    for (scale, place) in [(100.0, 1e3), (1e-2, 1.0), (1e3, 1e5), (1e-3, 0.0), (1e4, 0.0)] {
        let text = format!(
            "[camera]\neye = [{}, {}, {}]\ntarget = [{place}, 0, 0]\nfov = 40\n\
             [render]\nwidth = 32\nheight = 32\ncutoff = 0\n\
             [environment]\ntype = 'constant'\ncolor = 1\n\
             [[material]]\nname = 'm'\ntype = 'mirror'\nreflectance = 1\n\
             [[mesh]]\nshape = 'box'\nmaterial = 'm'\n\
             transform = {{ scale = {scale}, rotate = [31, 17, 5], translate = [{place}, 0, 0] }}\n",
            place + 2.0 * scale,
            1.5 * scale,
            2.5 * scale,
        );
        let file = folder.path().join("a.toml");
        std::fs::write(&file, text).unwrap();
        let scene = load::scene(&file, &LoadOptions::default()).unwrap().scene;
        let outcome = render(&scene);
        assert!(rays(&outcome, 1, RayKind::Reflected) > 100);
        assert_eq!(rays(&outcome, 2, RayKind::Reflected), 0, "scale {scale} at {place}");
    }
}

/// SI-05: the same under any linear map that a scene file can ask for: stretched a thousandfold along one axis, mirrored,
/// turned, sheared, carried far away, and several of these at once. What is convex stays so, and a mirror ray that meets
/// anything met the face that it left.
#[test]
fn a_body_stretched_sheared_and_carried_away_by_its_scene_file_is_left_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let maps = [
        ("scale = [1, 30, 0.03], rotate = [10, 20, 30]", 0.0, 30.0),
        ("scale = [0.001, 1, 1], rotate = [45, 45, 0]", 10.0, 1.0),
        ("scale = [-1, 2, 3], rotate = [5, 85, 40]", 1e4, 3.0),
        ("scale = [100, 0.1, 100], rotate = [1, 2, 3]", 1e5, 100.0),
        // Rows of a shear along x by y and z, and one along two axes at once.
        ("matrix = [1, 4, -2, PLACE, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]", 100.0, 4.0),
        ("matrix = [2, 0.5, 0, PLACE, -7, 1, 3, 0, 0.25, 0, 0.1, 0, 0, 0, 0, 1]", 5e3, 7.0),
        ("matrix = [1e-3, 4e-3, 0, PLACE, 0, 1e-3, 9e-3, 0, 0, 0, 1e-3, 0, 0, 0, 0, 1]", 0.125, 0.01),
    ];
    for (map, place, reach) in maps {
        // The map may hold the translation itself.
        let carried = if map.contains("PLACE") { String::new() } else { format!(", translate = [{place}, 0, 0]") };
        let map = map.replace("PLACE", &place.to_string()) + &carried;
        for shape in ["shape = 'box'", "shape = 'sphere'\ntessellation = 12\nsmooth = false"] {
            let text = format!(
                "[camera]\neye = [{}, {}, {}]\ntarget = [{place}, 0, 0]\nfov = 40\n\
                 [render]\nwidth = 48\nheight = 48\ncutoff = 0\n\
                 [environment]\ntype = 'constant'\ncolor = 1\n\
                 [[material]]\nname = 'm'\ntype = 'mirror'\nreflectance = 1\n\
                 [[mesh]]\n{shape}\nmaterial = 'm'\ntransform = {{ {map} }}\n",
                place + 1.1 * reach,
                1.3 * reach,
                1.7 * reach,
            );
            let file = folder.path().join("a.toml");
            std::fs::write(&file, text).unwrap();
            let scene = load::scene(&file, &LoadOptions::default()).unwrap().scene;
            let outcome = render(&scene);
            assert!(rays(&outcome, 1, RayKind::Reflected) > 20, "{map} is seen");
            assert_eq!(rays(&outcome, 2, RayKind::Reflected), 0, "{map}");
        }
    }
}

/// SI-06, RF-09: from glass in a bright room the reflected ray starts outside and the refracted one inside, for either
/// side of arrival. No exit is unmatched, and arriving light plus truncated weight is the room's light.
#[test]
fn reflected_and_refracted_rays_start_on_their_own_sides() {
    let mut rng = Rng::new(54);
    for (scale, offset) in places() {
        let Some(mesh) = placed(&turned(icosahedron(), &mut rng), scale, offset) else { continue };
        let mut scene = looking_at(offset, scale, rng.direction());
        (scene.settings.max_depth, scene.settings.cutoff) = (24, 1e-6);
        let crown = scenes::glass(&mut scene, 1.5, 0, Rgb::ZERO);
        scenes::add(&mut scene, Shape::Mesh(mesh), crown);
        let outcome = render(&scene);
        assert_eq!(outcome.unmatched_exits, 0, "scale {scale} at {offset}");
        let met = rays(&outcome, 1, RayKind::Transmitted);
        assert_eq!(met, rays(&outcome, 1, RayKind::Reflected));
        assert!(rays(&outcome, 2, RayKind::Reflected) <= met, "a reflected ray got in");
        for (seen, lost) in outcome.film.pixels.iter().zip(&outcome.truncated.pixels) {
            assert!((seen[0] + lost[0] - 1.0).abs() <= 1e-5, "{} + {}", seen[0], lost[0]);
        }
    }
}

/// SI-03, SI-07: a sheet four error bounds thick has both its faces, at every scale and place. The least thickness is the
/// bound itself: 9 u of the coordinates across it and 4 u of the triangles' longest edge.
#[test]
fn both_faces_of_a_sheet_a_few_error_bounds_thick_are_met() {
    let u = 2.0_f64.powi(-24);
    for (size, height) in [(1.0, 0.0), (1e-3, 0.0), (1e3, 0.0), (1.0, 1.0), (1.0, 1e3), (1e-3, 10.0), (300.0, 1e5)] {
        let bound = 9.0 * u * height + 4.0 * u * size * 2.0;
        let (lo, hi) = (height as f32, (height + 4.0 * bound) as f32);
        assert!(hi > lo);
        let s = size as f32;
        let sheet = scenes::cuboid_mesh(Vec3::new(-s, -s, lo), Vec3::new(s, s, hi));
        let mut scene =
            looking_at(DVec3::new(0.01 * size, 0.02 * size, height), size * 0.8, Vec3::new(0.3, 0.2, 1.0).normalize());
        scene.camera.target = Vec3::new(0.0, 0.0, lo);
        let same = scenes::glass(&mut scene, 1.0, 0, Rgb::ZERO);
        scenes::add(&mut scene, Shape::Mesh(sheet), same);
        let outcome = render(&scene);
        let (entered, left) = (rays(&outcome, 1, RayKind::Transmitted), rays(&outcome, 2, RayKind::Transmitted));
        assert!(entered > 100, "size {size} at {height}: {entered}");
        assert_eq!((left, outcome.unmatched_exits), (entered, 0), "size {size} at {height}");
    }
}

/// SI-08, RV-05: a floor of many coplanar triangles, seen at all angles down to grazing: a guard against the same triangle
/// would miss its neighbours, a fixed distance would not do at grazing angles.
#[test]
fn a_floor_of_coplanar_triangles_reflects_at_grazing_angles_without_meeting_itself() {
    for (scale, offset) in [(1.0, 0.0), (0.1, 1e3), (1e-3, 0.0), (100.0, -1e5)] {
        for rise in [1.0, 0.1, 1e-2, 1e-3] {
            let mut grid = shapes::grid(20);
            // Exactly one height, so that all of it is one plane.
            let z = 0.1 * scale + offset;
            grid.positions.iter_mut().for_each(|p| *p = Vec3::new(p.x * scale + offset, p.y * scale, z));
            let centre = Vec3::new(10.0 * scale + offset, 10.0 * scale, z);
            let mut scene = scenes::empty(1.0);
            scene.camera = Camera {
                eye: centre + Vec3::new(0.1, -12.0, 12.0 * rise) * scale,
                target: centre,
                up: Vec3::Z,
                projection: Projection::Pinhole { vfov: (0.8 * rise).atan().to_degrees() },
                medium: None,
            };
            let what = format!("scale {scale} at {offset}, rise {rise}");
            assert_mirror_is_left(scene, vec![Shape::Mesh(grid)], &what);
        }
    }
}
