//! One path against another, and both against the arbiter.

use std::hint::black_box;

use glam::Vec3;
use vitrum::accel::Backend;
use vitrum::accel::reference::{Ray64, Reference};
use vitrum::geometry::{GeometryMask, Ray};

use crate::support::aim::count;
use crate::support::kernels::{Held, KERNELS, sound};
use crate::support::{Rng, backends, contract, shapes};

/// PA-02: on triangles of sound proportions t is within 16 ulp of the largest length that takes part (the bound of
/// Embree's `TriangleHitTest`), and so are the weights, edges not left out.
#[test]
fn distances_and_weights_are_within_sixteen_ulp() {
    let mut rng = Rng::new(101);
    let mesh = shapes::closed_sphere(12, 0.1, 1.0, Vec3::ZERO);
    let mut rays = Vec::new();
    for i in 0..count(6000) {
        let [a, b, c] = mesh.corners(rng.below(mesh.triangles.len()));
        let target = [a.midpoint(b), a * 0.3 + b * 0.3 + c * 0.4, c, a * 0.01 + b * 0.01 + c * 0.98][i % 4];
        let origin = rng.direction() * [0.3, 3.0][i % 2];
        rays.push(Ray::new(origin, (target - origin).normalize()));
    }
    let geometry = [shapes::masked(mesh, GeometryMask::OPAQUE)];
    let (native, arbiter) = (sound(&geometry), Reference::build(&geometry));
    let bound = 16.0 * f64::from(f32::EPSILON);
    for kernel in KERNELS {
        let mut same = 0;
        for (ray, hit) in rays.iter().zip(contract::closest(&Held(native.clone(), kernel), &rays)) {
            let want = arbiter.closest(&Ray64::from(ray));
            assert!(hit.is_hit(), "{ray:?}");
            let reach = want.t.max(1.0);
            let vitrum::geometry::Shape::Mesh(mesh) = &geometry[0].shape else { unreachable!() };
            let [a, b, c] = mesh.corners(hit.primitive as usize).map(|p| p.as_dvec3());
            let cos = (b - a).cross(c - a).normalize().dot(ray.dir.as_dvec3()).abs();
            // Grazing rays are the arbiter's to judge: their t moves by more than its own rounding.
            if cos > 0.02 {
                let off = (f64::from(hit.t) - want.t).abs();
                assert!(off <= bound * reach / cos, "{hit:?} for {want:?}: {ray:?}");
                same += 1;
            }
        }
        assert!(same * 10 > rays.len() * 9, "{same} of {}", rays.len());
    }
}

/// PA-07: denormals are numbers here, on every thread, before and after building: no path flushes them to zero and none
/// leaves the processor set so.
#[test]
fn no_thread_flushes_denormals_to_zero() {
    let alive = || black_box(1e-40_f32) * black_box(0.5_f32) > 0.0 && black_box(1.2e-38_f32) * black_box(0.1_f32) > 0.0;
    assert!(alive());
    let mut rng = Rng::new(102);
    let geometry = [shapes::masked(shapes::soup(9000, 0.1, &mut rng), GeometryMask::OPAQUE)];
    let native = sound(&geometry);
    contract::closest(&native, &[Ray::new(Vec3::ZERO, Vec3::X)]);
    if let Some(embree) = backends::embree(Backend::Embree, &geometry) {
        contract::closest(&embree, &[Ray::new(Vec3::ZERO, Vec3::X)]);
    }
    assert!(alive());
    assert!(rayon::broadcast(|_| alive()).into_iter().all(|a| a));
}

/// PA-09: the same picture by either back end, as eight-bit codes, in at least 99.9 % of its pixels; said and passed over
/// where no library is found.
#[test]
fn pictures_by_both_back_ends_agree_in_999_of_1000_pixels() {
    use crate::support::scenes;
    use vitrum::render::{Observer, Options, render};
    use vitrum::scene::{Falloff, Light, LightKind, Material, Rgb};

    let mut scene = scenes::empty(0.5);
    (scene.settings.width, scene.settings.height) = (160, 120);
    (scene.settings.max_depth, scene.settings.cutoff) = (6, 1e-3);
    let crown = scenes::glass(&mut scene, 1.5, 0, Rgb::new(0.1, 0.2, 0.4));
    let floor = scenes::material(&mut scene, Material::default());
    scenes::plane(&mut scene, Vec3::Y * -1.0, Vec3::Y, floor);
    scenes::cuboid(&mut scene, Vec3::new(-1.1, -0.9, -0.5), Vec3::new(-0.3, 0.8, 0.6), crown);
    scenes::add(
        &mut scene,
        vitrum::geometry::Shape::Mesh(shapes::closed_sphere(24, 0.0, 0.6, Vec3::new(0.5, -0.3, 0.3))),
        floor,
    );
    scene.lights.push(Light {
        name: String::new(),
        kind: LightKind::Point { position: Vec3::new(-2.0, 4.0, 3.0) },
        intensity: Rgb::splat(30.0),
        falloff: Falloff::InverseSquare,
        shadows: true,
    });
    let Some(embree) = backends::embree(Backend::Embree, &scene.geometry) else { return };
    let ours = scenes::native(&scene, &Options::default()).film;
    let theirs = render(&scene, &embree, &Options::default(), &Observer::default()).unwrap().film;
    let apart = |a: &[f32; 3], b: &[f32; 3]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > 1.0 / 255.0);
    let differ = ours.pixels.iter().zip(&theirs.pixels).filter(|(a, b)| apart(a, b)).count();
    assert!(differ * 1000 <= ours.pixels.len(), "{differ} of {}", ours.pixels.len());
}
