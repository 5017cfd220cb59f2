//! Curved reflectors by virtual scenes.

use glam::{DVec2, DVec3, Vec3};
use vitrum::accel::native::Native;
use vitrum::accel::{Coherence, Intersector, Unbounded};
use vitrum::geometry::{Hit8, Ray, Ray8, Shape, TriMesh};
use vitrum::render::{Observer, Options, RayKind, Reflection, reference, render};
use vitrum::scene::{Colour, Environment, Falloff, Interface, Light, LightKind, Material, MirrorSource, Rgb, Scene};
use vitrum::systems::alhazen::MirrorBall;
use vitrum::systems::images::{Image, Surface};

use super::{difference, is_at_edge, outcomes};
use crate::support::scenes::{bare, cuboid, empty, material, native, plane, sphere};

fn by_virtual_scene() -> Options {
    Options { reflection: Reflection::Virtual, ..Options::default() }
}

fn mirror() -> Material {
    bare(Interface::Mirror { reflectance: Rgb::splat(0.9), source: MirrorSource::Traced })
}

/// A mirror ball over a floor, between a box, a smaller ball and a wall.
fn scene() -> Scene {
    let mut scene = empty(0.0);
    scene.environment = Environment::Gradient {
        nadir: Rgb::splat(0.1),
        horizon: Rgb::new(0.4, 0.3, 0.2),
        zenith: Rgb::new(0.1, 0.2, 0.6),
    };
    scene.camera.eye = Vec3::new(0.4, 0.8, 3.5);
    (scene.settings.width, scene.settings.height, scene.settings.samples) = (64, 64, 1);
    let silver = material(&mut scene, mirror());
    sphere(&mut scene, Vec3::ZERO, 0.7, silver);
    let checker = Colour::Checker { even: Rgb::splat(0.8), odd: Rgb::splat(0.2), size: 0.9, offset: Vec3::splat(0.03) };
    let floor = material(&mut scene, Material { diffuse: checker, ..Material::default() });
    plane(&mut scene, Vec3::new(0.0, -1.2, 0.0), Vec3::Y, floor);
    let red =
        material(&mut scene, Material { diffuse: Colour::Constant(Rgb::new(0.8, 0.2, 0.1)), ..Material::default() });
    cuboid(&mut scene, Vec3::new(-1.8, -1.2, 0.6), Vec3::new(-1.2, 0.4, 1.2), red);
    let blue =
        material(&mut scene, Material { diffuse: Colour::Constant(Rgb::new(0.1, 0.3, 0.8)), ..Material::default() });
    sphere(&mut scene, Vec3::new(1.4, -0.4, 0.9), 0.4, blue);
    scene.lights.push(Light {
        name: String::from("lamp"),
        kind: LightKind::Point { position: Vec3::new(1.0, 4.0, 3.0) },
        intensity: Rgb::splat(14.0),
        falloff: Falloff::InverseSquare,
        shadows: true,
    });
    scene
}

#[test]
fn what_is_infinitely_far_is_seen_as_traced_rays_see_it() {
    let mut scene = scene();
    scene.geometry.truncate(1);
    scene.objects.truncate(1);
    for ((name, virtual_scene), (_, traced)) in
        outcomes(&scene, &by_virtual_scene()).iter().zip(outcomes(&scene, &Options::default()))
    {
        assert!((0..64 * 64).all(|p| difference(&virtual_scene.film, &traced.film, p) < 1e-5), "{name}");
        assert_eq!(virtual_scene.rays.of(RayKind::Reflected), traced.rays.of(RayKind::Reflected), "{name}");
    }
}

#[test]
fn the_picture_is_near_that_of_a_traced_ball_and_nearer_than_a_map() {
    let scene = scene();
    let traced = outcomes(&scene, &Options::default());
    for ((name, outcome), (_, traced)) in outcomes(&scene, &by_virtual_scene()).iter().zip(&traced) {
        let far = (0..64 * 64).filter(|&p| difference(&outcome.film, &traced.film, p) > 0.02);
        let (edges, others): (Vec<usize>, Vec<usize>) = far.partition(|&p| is_at_edge(&traced.film, p, 0.05));
        assert!(others.len() * 200 <= 64 * 64, "{name}: {} pixels that are no edges", others.len());
        assert!(edges.len() * 15 <= 64 * 64, "{name}: {} pixels at edges", edges.len());
        let report = outcome.images.clone().expect("it was asked for");
        assert_eq!((report.reflectors, report.points.inside, report.left_out), (1, 0, 0), "{name}");
        assert_eq!((report.points.none, report.points.several), (0, 0), "{name}");
        assert!(report.points.seen > 0 && report.points.seen <= report.points.all, "{name}");
    }
    let squares = |options: &Options| {
        let film = native(&scene, options).film;
        (0..64 * 64).map(|p| f64::from(difference(&film, &traced[0].1.film, p)).powi(2)).sum::<f64>()
    };
    let map = squares(&Options { reflection: Reflection::CubeMap, ..Options::default() });
    let moved = squares(&by_virtual_scene());
    assert!(moved < 0.8 * map, "{moved} by virtual points, {map} by a map");
}

#[test]
fn half_the_angle_of_the_pieces_is_a_quarter_of_the_error() {
    let scene = scene();
    let (eye, ball) = (DVec3::new(0.4, 0.8, 3.5), MirrorBall { centre: DVec3::ZERO, radius: 0.699_999_988 });
    let rays: Vec<Ray> = (0..400)
        .map(|i| Vec3::new(-0.45 + 0.047 * (i % 20) as f32, -0.45 + 0.047 * (i / 20) as f32, 0.5))
        .map(|p| Ray::new(eye.as_vec3(), (p - eye.as_vec3()).normalize()))
        .collect();
    let error = |angle: f64| {
        let image = Image::of(&scene, 0, true, &Surface::Ball(ball), eye, angle);
        let accel = Native::build(&image.geometry);
        let packets = Ray8::pack(&rays);
        let mut hits = vec![Hit8::default(); packets.len()];
        accel.closest(&packets, &mut hits, Coherence::Coherent, &mut Default::default());
        let mut errors: Vec<f64> = Vec::new();
        for (i, ray) in rays.iter().enumerate() {
            let hit = hits[i / 8].lane(i % 8);
            if !hit.is_hit() {
                continue;
            }
            let shown = image.shown(&scene, hit.geometry, hit.primitive, DVec2::new(hit.u.into(), hit.v.into()));
            // What is shown there is seen elsewhere in the ball.
            let truly = ball.mirror_point(eye, shown.place).expect("it is outside").point;
            let seen = (truly - eye).normalize();
            errors.push(seen.cross(ray.dir.as_dvec3()).length());
        }
        errors.sort_by(f64::total_cmp);
        assert!(errors.len() > 100, "{}", errors.len());
        errors[errors.len() * 3 / 4]
    };
    let [coarse, middle, fine] = [0.4, 0.2, 0.1].map(error);
    assert!(coarse > 2.5 * middle && middle > 2.5 * fine, "{coarse} {middle} {fine}");
}

#[test]
fn reflectors_that_are_no_balls_seen_from_outside_are_traced_or_refused_by_name() {
    let mut scene = scene();
    let silver = material(&mut scene, mirror());
    cuboid(&mut scene, Vec3::new(0.9, 0.5, -1.0), Vec3::new(1.5, 1.2, -0.5), silver);
    let report = native(&scene, &by_virtual_scene()).images.expect("it was asked for");
    assert_eq!(report.without, [(scene.objects.len() as u32 - 1, "has no normals to interpolate")]);
    assert!(report.traced > 0);
    scene.camera.eye = Vec3::new(0.0, 0.1, 0.2);
    let accel = Unbounded::new(Native::build(&scene.geometry), &scene.geometry);
    let error = render(&scene, &accel, &by_virtual_scene(), &Observer::default()).expect_err("nothing is convex");
    let text = error.to_string();
    assert!(text.contains("`object 0` is seen from inside") && text.contains("--reflection traced"), "{text}");
    assert_eq!(text, reference::render(&scene, &by_virtual_scene(), &Observer::default()).unwrap_err().to_string());
}

/// The part of a ball of triangles around the origin that `keep` wants, stretched, with the normals of the true surface.
fn smooth(stretch: Vec3, keep: impl Fn(Vec3) -> bool) -> Shape {
    const ROWS: u32 = 32;
    let at = |row: u32, column: u32| {
        let theta = std::f32::consts::PI * row as f32 / ROWS as f32;
        let phi = std::f32::consts::PI * (column % (2 * ROWS)) as f32 / ROWS as f32;
        match row {
            0 => Vec3::Y,
            ROWS => Vec3::NEG_Y,
            _ => Vec3::new(theta.sin() * phi.cos(), theta.cos(), -theta.sin() * phi.sin()),
        }
    };
    let mut mesh = TriMesh::default();
    for row in 0..ROWS {
        for column in 0..2 * ROWS {
            let [a, b, c, d] = [(row, column), (row + 1, column), (row + 1, column + 1), (row, column + 1)]
                .map(|(row, column)| at(row, column));
            for corners in [(row + 1 < ROWS).then_some([a, b, c]), (row > 0).then_some([a, c, d])].into_iter().flatten()
            {
                if !keep(corners.iter().sum::<Vec3>() / 3.0) {
                    continue;
                }
                let first = mesh.positions.len() as u32;
                mesh.positions.extend(corners.map(|p| p * stretch));
                mesh.normals.extend(corners.map(|p| (p / stretch).normalize()));
                mesh.triangles.push([first, first + 1, first + 2]);
                mesh.normal_indices.push([first, first + 1, first + 2]);
            }
        }
    }
    Shape::Mesh(mesh)
}

#[test]
fn a_smooth_convex_mesh_is_near_its_traced_picture_by_an_explosion_map() {
    let mut scene = scene();
    // The ball becomes an egg of triangles.
    scene.geometry[0].shape = smooth(Vec3::new(0.7, 0.9, 0.6), |_| true);
    let traced = native(&scene, &Options::default());
    for (name, outcome) in outcomes(&scene, &by_virtual_scene()) {
        let report = outcome.images.clone().expect("it was asked for");
        assert_eq!((report.reflectors, report.without.len(), report.points.inside), (1, 0, 0), "{name}");
        let far = (0..64 * 64).filter(|&p| difference(&outcome.film, &traced.film, p) > 0.02);
        let (edges, others): (Vec<usize>, Vec<usize>) = far.partition(|&p| is_at_edge(&traced.film, p, 0.05));
        assert!(others.len() * 200 <= 64 * 64, "{name}: {} pixels that are no edges", others.len());
        assert!(edges.len() * 12 <= 64 * 64, "{name}: {} pixels at edges", edges.len());
    }
}

#[test]
fn a_bowl_shows_what_is_nearer_than_its_focus_and_the_rest_is_traced_and_counted() {
    let mut scene = scene();
    // The hollow side of a shell of radius 2, whose focus is 1 before it; a box stands before it at 0.3 to 0.6.
    scene.geometry[0].shape = smooth(Vec3::splat(2.0), |p| p.z < -0.8);
    scene.geometry.truncate(2);
    scene.objects.truncate(2);
    let red = scene.objects[1].material;
    cuboid(&mut scene, Vec3::new(-0.3, -0.2, -1.7), Vec3::new(0.2, 0.3, -1.4), red);
    let traced = native(&scene, &Options::default());
    for (name, outcome) in outcomes(&scene, &by_virtual_scene()) {
        let report = outcome.images.clone().expect("it was asked for");
        // The floor reaches to where it is seen nowhere in the bowl, and to where it is seen twice.
        assert!(report.points.none > 0 && report.left_out > 0 && report.traced > 0, "{name}: {report:?}");
        let off = (0..64 * 64).filter(|&p| difference(&outcome.film, &traced.film, p) > 0.05).count();
        assert!(off * 10 <= 64 * 64, "{name}: {off} pixels");
    }
}
