//! Energy conservation over long chains of reflections, in a world of radiance 1 without absorption. The light that
//! arrives at a pixel and the truncated weight must sum to 1.

use glam::Vec3;

use super::VerifyPlan;
use super::candidate::Candidate;
use super::tally::CaseCounts;
use crate::Result;
use crate::geometry::{Geometry, Shape, Sphere, TriMesh};
use crate::render::{Observer, Options, render};
use crate::scene::{
    Camera, Dispersion, Environment, FresnelRule, Interface, Material, Medium, MirrorSource, Object, Origin,
    Projection, Rgb, Scene, Settings,
};

pub(super) const BATCHES: usize = 6;

/// Largest light lost or gained, of 1.
const BOUND: f64 = 1e-5;

/// Number of shells of the onion.
const SHELLS: u16 = 100;

pub(super) fn batch<C: Candidate>(candidate: &C, plan: &VerifyPlan, i: usize) -> Result<CaseCounts> {
    let (name, mut scene) = match i {
        0 => ("total reflection in a closed cube", cube()),
        1 => ("an onion of a hundred shells", onion()),
        2 => ("mirrors that face each other", mirrors()),
        3 => ("a gap of 16 ulp between glass and water", gap(1.0 + 16.0 * f32::EPSILON)),
        4 => ("a gap of 1e-3 between glass and water", gap(1.001)),
        _ => ("glass and water that touch", gap(1.0)),
    };
    let edge = plan.sized(96, 20) as u32;
    (scene.settings.width, scene.settings.height) = (edge, edge);
    let ways = candidate.build(&scene.geometry)?;
    let mut tally = CaseCounts::default();
    for way in &ways {
        // One thread per picture, because the batches are spread over threads.
        let outcome = render(&scene, &way.accel, &Options { threads: 1, ..Options::default() }, &Observer::default())?;
        for (k, (arrived, cut)) in outcome.film.pixels.iter().zip(&outcome.truncated.pixels).enumerate() {
            let off = (0..3)
                .map(|c| (f64::from(arrived[c]) + f64::from(cut[c]) - 1.0).abs())
                .fold(0.0, |worst: f64, x| if x > worst || x.is_nan() { x } else { worst });
            tally.measure("light lost or gained, of 1", off, BOUND, || {
                let (x, y) = (k % edge as usize, k / edge as usize);
                format!("{}, {name}: pixel {x}, {y} gets {arrived:?} with {cut:?} cut", way.name)
            });
        }
        let odd = outcome.non_finite + outcome.clamped;
        if odd > 0 {
            tally.fail(|| format!("{}, {name}: {odd} contributions not finite or too large", way.name));
        }
    }
    Ok(tally)
}

/// Returns an empty world of radiance 1, seen from `eye`.
fn world(eye: Vec3, target: Vec3, depth: u32, cutoff: f32) -> Scene {
    Scene {
        media: vec![Medium::air()],
        environment: Environment::Constant(Rgb::ONE),
        camera: Camera { eye, target, up: Vec3::Y, projection: Projection::Pinhole { vfov: 50.0 }, medium: None },
        settings: Settings { max_depth: depth, cutoff, ..Settings::default() },
        ..Scene::default()
    }
}

fn add(scene: &mut Scene, shape: Shape, interface: Interface) {
    let material = Material { interface, ..Material::black("bare") };
    let mask = material.mask();
    scene.geometry.push(Geometry { shape, mask });
    scene.objects.push(Object {
        name: String::from("bare"),
        material: scene.materials.len() as u32,
        origin: Origin::default(),
    });
    scene.materials.push(material);
}

/// Adds a transparent shape with an index.
fn clear(scene: &mut Scene, shape: Shape, ior: f64, priority: i32) {
    scene.media.push(Medium {
        name: String::from("clear"),
        ior,
        dispersion: Dispersion::None,
        absorption: Rgb::ZERO,
        priority,
    });
    let medium = scene.media.len() as u32 - 1;
    add(scene, shape, Interface::Dielectric { medium, rule: FresnelRule::Fresnel, tint: Rgb::ONE });
}

/// Returns a box of twelve triangles, counter-clockwise seen from outside.
fn cuboid(lo: Vec3, hi: Vec3) -> Shape {
    let corner = |i: u32| {
        Vec3::new(
            if i & 1 == 0 { lo.x } else { hi.x },
            if i & 2 == 0 { lo.y } else { hi.y },
            if i & 4 == 0 { lo.z } else { hi.z },
        )
    };
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Shape::Mesh(TriMesh { positions: (0..8).map(corner).collect(), triangles, ..TriMesh::default() })
}

/// The eye inside a cube of diamond: light that does not leave at the first faces circulates until its depth ends.
fn cube() -> Scene {
    let mut scene = world(Vec3::new(0.1, -0.2, 0.15), Vec3::new(1.0, 0.83, 0.47), 64, 1e-4);
    clear(&mut scene, cuboid(Vec3::splat(-1.0), Vec3::ONE), 2.42, 0);
    scene
}

/// Nested balls of glass and water in turn; an inner one has priority over an outer.
fn onion() -> Scene {
    let mut scene = world(Vec3::new(0.2, 0.1, 3.0), Vec3::ZERO, 400, 1e-2);
    for k in 0..SHELLS {
        let radius = 1.0 - f32::from(k) * 0.0095;
        let ball = Shape::Sphere(Sphere { centre: Vec3::ZERO, radius });
        clear(&mut scene, ball, if k % 2 == 0 { 1.5 } else { 1.33 }, i32::from(k));
    }
    scene
}

/// Two perfect mirrors face to face, with the eye between them.
fn mirrors() -> Scene {
    let mut scene = world(Vec3::new(0.1, 0.2, 0.0), Vec3::new(0.12, 0.21, -1.0), 64, 0.0);
    for (lo, hi) in [(-1.1, -1.0), (1.0, 1.1)] {
        let slab = cuboid(Vec3::new(-2.0, -2.0, lo), Vec3::new(2.0, 2.0, hi));
        add(&mut scene, slab, Interface::Mirror { reflectance: Rgb::ONE, source: MirrorSource::Traced });
    }
    scene
}

/// A block of glass that ends at x = 1 and a block of water that begins at `from`, seen from the side.
fn gap(from: f32) -> Scene {
    let mut scene = world(Vec3::new(0.2, 1.1, 4.0), Vec3::new(1.0, 0.0, 0.0), 64, 1e-4);
    clear(&mut scene, cuboid(Vec3::new(-0.5, -1.0, -1.0), Vec3::new(1.0, 1.0, 1.0)), 1.5, 0);
    clear(&mut scene, cuboid(Vec3::new(from, -0.9, -0.8), Vec3::new(2.5, 0.9, 0.8)), 1.33, 0);
    scene
}
