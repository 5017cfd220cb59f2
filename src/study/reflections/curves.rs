//! Errors of the systems against what they depend on: the distance of the neighbours of a map, the angle and the
//! tessellation of a virtual scene, the angle of raised objects.

use glam::{DVec2, DVec3, Vec3};
use serde::Serialize;

use crate::Result;
use crate::accel::native::{Native, Scratch};
use crate::accel::{Accel, Backend, BuildOptions, BuildQuality, Coherence, Intersector};
use crate::geometry::{Geometry, GeometryMask, Hit8, Plane, Ray, Ray8, Shape, Sphere};
use crate::optics::{Boundary, Raised, RefractionFormula, Stable};
use crate::render::{Observer, Options, Reflection, render};
use crate::scene::{
    Camera, Interface, Material, Medium, MirrorSource, Object, Origin, Projection, Rgb, Scene, Settings,
};
use crate::systems::alhazen::MirrorBall;
use crate::systems::images::{Image, Surface};
use crate::systems::maps::Proxy;

/// Distances of the walls from the middle of a ball, in its radii.
pub const DISTANCES: [f32; 10] = [1.25, 1.5, 2.0, 3.0, 4.0, 6.0, 10.0, 20.0, 50.0, 100.0];

/// Largest angles of the pieces of a virtual scene, in radians.
pub const PIECES: [f64; 4] = [0.4, 0.2, 0.1, 0.05];

/// Bins of the angle of incidence, in degrees.
pub(super) const BIN: usize = 15;

/// Errors of maps, a line a variant.
#[derive(Clone, Debug, Serialize)]
pub struct Line {
    /// Name of the variant.
    pub name: &'static str,
    /// Root of the mean squared difference on the ball, by distance.
    pub errors: Vec<f64>,
}

/// Errors of a virtual scene of one tessellation.
#[derive(Clone, Debug, Serialize)]
pub struct Pieces {
    /// Largest angle of its pieces, in radians.
    pub angle: f64,
    /// Number of its triangles.
    pub triangles: usize,
    /// Median angle between the place that is shown and that where it is truly seen, in milliradians, by bins of 15 degrees
    /// of the angle of incidence; none where a bin has no ray.
    pub errors: Vec<Option<f64>>,
    /// Largest of all.
    pub most: f64,
}

/// An angle of incidence at water.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct AtWater {
    /// Angle of incidence, in degrees.
    pub incidence: f64,
    /// Refracted angle by Snell's law, in degrees.
    pub exact: f64,
    /// Refracted angle of a raised object, in degrees.
    pub raised: f64,
}

/// All of them.
#[derive(Clone, Debug, Serialize)]
pub struct Curves {
    /// Distances of the walls, in radii of the ball.
    pub distances: Vec<f64>,
    /// Errors of maps of these distances.
    pub maps: Vec<Line>,
    /// Errors of virtual scenes.
    pub pieces: Vec<Pieces>,
    /// Errors of raised objects.
    pub water: Vec<AtWater>,
}

/// Measures all of them.
///
/// # Errors
/// Errors of the renderer.
pub fn curves(threads: usize, observer: &Observer) -> Result<Curves> {
    Ok(Curves {
        distances: DISTANCES.map(f64::from).to_vec(),
        maps: maps(threads, observer)?,
        pieces: PIECES.into_iter().map(pieces).collect::<Result<_>>()?,
        water: (0..=8).map(|i| at_water(10.0 * f64::from(i))).collect(),
    })
}

/// A mirror ball of radius 1 in a room of glowing walls of two colours each.
fn room(half: f32) -> Scene {
    let mut scene = Scene {
        media: vec![Medium::air()],
        camera: Camera {
            eye: Vec3::new(0.5, 0.7, 1.15),
            target: Vec3::ZERO,
            up: Vec3::Y,
            projection: Projection::Pinhole { vfov: 80.0 },
            medium: None,
        },
        settings: Settings { width: 128, height: 128, samples: 1, ..Settings::default() },
        ..Scene::default()
    };
    // The eye is between the ball and the nearest wall.
    scene.camera.eye *= 1.2 / scene.camera.eye.length();
    let mut add = |shape: Shape, material: Material| {
        let material = scene.add_material(material);
        scene.geometry.push(Geometry { shape, mask: GeometryMask::OPAQUE });
        scene.objects.push(Object { name: String::from("room"), material, origin: Origin::default() });
    };
    let interface = Interface::Mirror { reflectance: Rgb::ONE, source: MirrorSource::Traced };
    add(Shape::Sphere(Sphere { centre: Vec3::ZERO, radius: 1.0 }), Material { interface, ..Material::black("ball") });
    let walls = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    for (k, normal) in walls.into_iter().enumerate() {
        let emission = Rgb::new((k % 2) as f32, (k / 2 % 2) as f32, (k / 4) as f32) * 0.8 + 0.1;
        let wall = Material { emission, ..Material::black("wall") };
        add(Shape::Plane(Plane { point: -normal * half, normal }), wall);
    }
    scene
}

fn maps(threads: usize, observer: &Observer) -> Result<Vec<Line>> {
    let variants = [
        ("cube map", Reflection::CubeMap, Proxy::None),
        ("cube map, box", Reflection::CubeMap, Proxy::Box),
        ("cube map, sphere", Reflection::CubeMap, Proxy::Sphere),
        ("sphere map", Reflection::SphereMap, Proxy::None),
    ];
    let mut lines: Vec<Line> = variants.iter().map(|(name, ..)| Line { name, errors: Vec::new() }).collect();
    for half in DISTANCES {
        let scene = room(half);
        let accel = Accel::build(Backend::Native, &scene.geometry, BuildOptions::default())?;
        let picture = |options: &Options| render(&scene, &accel, options, observer).map(|outcome| outcome.film);
        let traced = picture(&Options { threads, ..Options::default() })?;
        for ((_, reflection, proxy), line) in variants.iter().zip(&mut lines) {
            let (reflection, proxy) = (*reflection, *proxy);
            let film = picture(&Options { reflection, proxy, threads, ..Options::default() })?;
            line.errors.push(crate::image::compare(&film, &traced, 0.0)?.rmse);
        }
    }
    Ok(lines)
}

/// Holds the virtual scene of a ball over a floor against Alhazen's problem.
fn pieces(angle: f64) -> Result<Pieces> {
    let ball = MirrorBall { centre: DVec3::ZERO, radius: 1.0 };
    let eye = DVec3::new(0.0, 0.8, 5.0);
    let mut scene = room(4.0);
    scene.camera.eye = eye.as_vec3();
    let image = Image::of(&scene, 0, true, &Surface::Ball(ball), eye, angle);
    let accel = Native::try_build_as(&image.geometry, BuildQuality::Default)?;
    let mut bins = vec![Vec::new(); 90 / BIN];
    let mut most = 0.0_f64;
    let (right, up) = (DVec3::X, DVec3::new(0.0, 5.0, -0.8).normalize());
    let rays: Vec<Ray> = (0..96 * 96)
        .map(|i| (f64::from(i % 96) + 0.5, f64::from(i / 96) + 0.5))
        .map(|(x, y)| (right * (x / 48.0 - 1.0) + up * (y / 48.0 - 1.0)) * 1.02)
        .map(|p| Ray::new(eye.as_vec3(), (p - eye).normalize().as_vec3()))
        .collect();
    let packets = Ray8::pack(&rays);
    let mut hits = vec![Hit8::default(); packets.len()];
    accel.closest(&packets, &mut hits, Coherence::Coherent, &mut Scratch::default());
    for (i, ray) in rays.iter().enumerate() {
        let dir = ray.dir.as_dvec3();
        let along = -eye.dot(dir);
        let inside = along * along - (eye.length_squared() - 1.0);
        let hit = hits[i / 8].lane(i % 8);
        if inside <= 0.0 || !hit.is_hit() {
            continue;
        }
        let point = eye + dir * (along - inside.sqrt());
        let uv = DVec2::new(f64::from(hit.u), f64::from(hit.v));
        let shown = image.shown(&scene, hit.geometry, hit.primitive, uv);
        let Some(truly) = ball.mirror_point(eye, shown.place) else { continue };
        // The angle at the ball's own scale: between the point that is looked at and that which shows the place.
        let error = 1e3 * (truly.point - eye).normalize().angle_between(dir);
        let incidence = (-dir.dot(point)).clamp(0.0, 1.0).acos().to_degrees();
        bins[(incidence as usize / BIN).min(90 / BIN - 1)].push(error);
        most = most.max(error);
    }
    let median = |mut bin: Vec<f64>| {
        bin.sort_by(f64::total_cmp);
        (!bin.is_empty()).then(|| bin[bin.len() / 2])
    };
    Ok(Pieces { angle, triangles: image.triangles(), errors: bins.into_iter().map(median).collect(), most })
}

fn at_water(incidence: f64) -> AtWater {
    let (sin, cos) = incidence.to_radians().sin_cos();
    let boundary = Boundary::<f64>::new(1.0, 1.333);
    let (incident, normal) = (DVec3::new(sin, -cos, 0.0), DVec3::Y);
    let at = boundary.cross(cos);
    let angle = |dir: DVec3| dir.x.atan2(-dir.y).to_degrees();
    let exact = Stable.refract(&boundary, incident.into(), normal.into(), &at).direction;
    let raised = Raised.refract(&boundary, incident.into(), normal.into(), &at).direction;
    AtWater { incidence, exact: angle(exact.into()), raised: angle(raised.into()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_fall_with_distance_and_with_finer_pieces() {
        let curves = curves(1, &Observer::default()).unwrap();
        for line in &curves.maps {
            let (first, last) = (line.errors[1], line.errors[DISTANCES.len() - 1]);
            // The box is right for this room at any distance, but for the blur of the lookup.
            let falls = if line.name == "cube map, box" { last < 0.03 && first < 0.03 } else { last < 0.5 * first };
            assert!(falls, "{}: {:?}", line.name, line.errors);
        }
        let [none, boxed] = [0, 1].map(|i| curves.maps[i].errors[2]);
        assert!(boxed < none, "a box in a room of this shape: {boxed} and {none}");
        for pair in curves.pieces.windows(2) {
            assert!(pair[1].triangles > 2 * pair[0].triangles, "{pair:?}");
            for (coarse, fine) in pair[0].errors.iter().zip(&pair[1].errors).take(4) {
                assert!(fine.unwrap() < 0.6 * coarse.unwrap(), "{pair:?}");
            }
        }
        let water = &curves.water[6];
        assert!((water.raised - water.exact - 11.9).abs() < 0.02, "{water:?}");
    }
}
