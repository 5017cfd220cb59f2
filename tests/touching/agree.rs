//! Random heaps on a lattice, so that faces coincide everywhere, of every kind of surface: all renderers agree.

use glam::{DQuat, DVec3, Vec3};
use vitrum::geometry::{Plane, Shape, Sphere};
use vitrum::scene::{
    Colour, Environment, Falloff, FresnelRule, Interface, Light, LightKind, Material, MirrorSource, Rgb, Scene,
};

use super::pictures;
use super::stacks::edges;
use crate::support::Rng;
use crate::support::scenes::{add, bare, cuboid_mesh, empty, glass, material};

/// Heaps; a hundred times as many where `VITRUM_ALL` is set.
fn heaps() -> u64 {
    if std::env::var_os("VITRUM_ALL").is_some() { 2000 } else { 40 }
}

/// A material of any kind.
fn any_material(rng: &mut Rng, scene: &mut Scene) -> u32 {
    let colour = |rng: &mut Rng| Rgb::new(rng.unit(), rng.unit(), rng.unit());
    let matt = |c: Rgb| Material { diffuse: Colour::Constant(c), ..Material::default() };
    match rng.below(12) {
        0..4 => {
            let absorption = colour(rng) * 0.5;
            let ior = [1.0, 1.2, 1.33, 1.5, 1.5, 1.7][rng.below(6)];
            let priority = rng.below(3) as i32;
            glass(scene, ior, priority, absorption)
        }
        4 | 5 => {
            let checker =
                Colour::Checker { even: colour(rng), odd: colour(rng), size: 0.37, offset: Vec3::splat(0.11) };
            material(scene, Material { diffuse: checker, ..Material::default() })
        }
        6 => {
            let interface = Interface::Mirror { reflectance: colour(rng), source: MirrorSource::Traced };
            material(scene, bare(interface))
        }
        7 => material(scene, bare(Interface::Conductor { eta: Rgb::new(0.2, 0.9, 1.1), k: Rgb::new(3.4, 2.4, 1.8) })),
        8 => {
            let c = colour(rng);
            material(scene, Material { interface: Interface::Coated { ior: 1.5 }, ..matt(c) })
        }
        9 => {
            let interface =
                Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fresnel, tint: Rgb::new(0.9, 1.0, 0.8) };
            material(scene, bare(interface))
        }
        10 => {
            let c = colour(rng);
            material(scene, Material { interface: Interface::Alpha { opacity: 0.4, mask: None }, ..matt(c) })
        }
        _ => {
            let c = colour(rng);
            material(scene, Material { emission: c, ..bare(Interface::Opaque) })
        }
    }
}

/// Boxes, balls and planes on the points of a lattice, turned, moved and scaled together.
fn heap(seed: u64) -> Scene {
    let mut rng = Rng::new(seed);
    let mut scene = empty(0.0);
    scene.environment = Environment::Gradient {
        nadir: Rgb::splat(0.2),
        horizon: Rgb::new(0.7, 0.6, 0.5),
        zenith: Rgb::new(0.3, 0.5, 0.9),
    };
    (scene.settings.width, scene.settings.height) = (24, 18);
    (scene.settings.max_depth, scene.settings.cutoff) = (6, 1e-3);
    let turned = rng.below(3) != 0;
    let axis = rng.direction().as_dvec3();
    let turn =
        if turned { DQuat::from_axis_angle(axis.normalize(), f64::from(rng.signed()) * 3.0) } else { DQuat::IDENTITY };
    let scale = [1e-3, 0.1, 1.0, 1.0, 37.0, 1e3][rng.below(6)];
    let offset = if rng.below(2) == 0 { DVec3::ZERO } else { DVec3::new(3.0, -7.0, 11.0) };
    let at = |p: DVec3| ((turn * p + offset) * scale).as_vec3();
    let lattice = |rng: &mut Rng| DVec3::new(rng.below(5) as f64, rng.below(5) as f64, rng.below(5) as f64) * 0.5 - 1.0;

    for _ in 0..2 + rng.below(5) {
        let kind = any_material(&mut rng, &mut scene);
        match rng.below(8) {
            0 | 1 => {
                let (centre, radius) = (lattice(&mut rng), 0.25 * (1 + rng.below(3)) as f64);
                let sphere = Sphere { centre: at(centre), radius: (radius * scale) as f32 };
                add(&mut scene, Shape::Sphere(sphere), kind);
            }
            2 => {
                let normal = [DVec3::Y, DVec3::X, DVec3::Z][rng.below(3)];
                let point = lattice(&mut rng);
                let plane = Plane { point: at(point), normal: (turn * normal).normalize().as_vec3().normalize() };
                // One plane at most, below everything else.
                if scene.geometry.iter().all(|g| !matches!(g.shape, Shape::Plane(_))) {
                    add(&mut scene, Shape::Plane(plane), kind);
                }
            }
            _ => {
                let (a, mut b) = (lattice(&mut rng), lattice(&mut rng));
                for k in 0..3 {
                    if a[k] == b[k] {
                        b[k] += 0.5;
                    }
                }
                let mut mesh = cuboid_mesh(a.min(b).as_vec3(), a.max(b).as_vec3());
                mesh.positions.iter_mut().for_each(|p| *p = at(p.as_dvec3()));
                add(&mut scene, Shape::Mesh(mesh), kind);
            }
        }
    }
    // Now and then the lamp stands where faces lie.
    let lamp = if rng.below(3) == 0 { lattice(&mut rng) } else { DVec3::new(2.3, 4.1, 3.7) };
    let intensity = Rgb::splat((30.0 * scale * scale) as f32);
    scene.lights.push(Light {
        name: String::from("lamp"),
        kind: LightKind::Point { position: at(lamp) },
        intensity,
        falloff: Falloff::InverseSquare,
        shadows: true,
    });
    for medium in &mut scene.media {
        medium.absorption /= scale as f32;
    }
    for material in &mut scene.materials {
        if let Colour::Checker { size, offset, .. } = &mut material.diffuse {
            (*size, *offset) = (*size * scale as f32, *offset * scale as f32);
        }
    }
    scene.camera.eye = at(DVec3::new(2.9, 2.3, 4.7));
    scene.camera.target = at(DVec3::new(0.03, 0.05, 0.02));
    scene.camera.up = (turn * DVec3::Y).as_vec3();
    scene
}

#[test]
fn heaps_of_touching_things_look_alike_to_all_renderers() {
    let (mut pixels, mut strays, mut worst) = (0, 0, (0, 0, ""));
    for seed in 0..heaps() {
        let scene = heap(seed);
        let edge = edges(&scene);
        let found = pictures(&scene);
        let truth = &found.iter().find(|(name, _)| *name == "f64").expect("it is there").1.film;
        for (name, outcome) in &found {
            let off = (0..edge.len()).filter(|&i| {
                let (a, b) = (outcome.film.pixels[i], truth.pixels[i]);
                !edge[i] && (0..3).any(|c| (a[c] - b[c]).abs() > 5e-4 * a[c].abs().max(1.0))
            });
            let off: Vec<usize> = off.collect();
            if off.len() > worst.0 {
                worst = (off.len(), seed, name);
            }
            strays += off.len();
            pixels += edge.len();
        }
    }
    println!(
        "{strays} of {pixels} pixels differ away from edges; most, {} in heap {} over {}",
        worst.0, worst.1, worst.2
    );
    // What is left lies next to edges that reflections show, where a ten-thousandth of a pixel does not reach.
    assert!(strays * 5000 <= pixels, "{strays} of {pixels} pixels differ");
    assert!(worst.0 <= 3, "heap {}: {} pixels differ over {}", worst.1, worst.0, worst.2);
}
