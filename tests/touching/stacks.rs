//! Random stacks of touching bodies against the same bodies with overlaps and priorities.

use std::fmt::Write;

use vitrum::render::reference::Prepared;
use vitrum::scene::Scene;

use super::{apart, pictures, scene};
use crate::support::Rng;

/// Stacks of each kind; a hundred times as many where `VITRUM_ALL` is set.
fn stacks() -> u64 {
    if std::env::var_os("VITRUM_ALL").is_some() { 250 } else { 10 }
}

const HEAD: &str = r#"
render = { width = 32, height = 24, depth = 7, cutoff = 1e-3 }
environment = { type = "gradient", nadir = 0.2, horizon = 0.6, zenith = [0.4, 0.6, 1.0] }
light = [{ type = "point", position = [2, 6, 3], intensity = 60 }]
"#;

/// A random transparent material. The priority tells it from the others of its scene: a boundary between equal media
/// costs depth, where touching faces of equal media are not there.
fn medium(rng: &mut Rng, name: &str, priority: i32) -> String {
    let ior = 1.2 + 0.05 * f64::from(priority) + 0.03 * f64::from(rng.unit());
    let absorption = [0.0, 0.3, 1.0][rng.below(3)];
    format!(
        r#"{{ name = "{name}", type = "dielectric", ior = {ior}, absorption = [{absorption}, 0.1, 0.2], priority = {priority} }}"#
    )
}

fn camera(rng: &mut Rng) -> String {
    let turn = f64::from(rng.signed()) * 3.0;
    let height = 2.0 + f64::from(rng.unit()) * 2.0;
    format!(
        "camera = {{ eye = [{}, {height}, {}], target = [0.03, 0.8, 0.02], fov = 34 }}",
        4.0 * turn.sin(),
        4.0 * turn.cos()
    )
}

/// Boxes that narrow upwards, standing on each other and on a matt plane; or each sunk into the one below, which has the
/// higher priority, and the lowest into the plane.
fn tower(rng: &mut Rng) -> [String; 2] {
    let floors = 2 + rng.below(3);
    let mut materials = vec![String::from(
        r#"{ name = "floor", type = "diffuse", checker = { even = 0.7, odd = 0.2, size = 0.37, offset = [0.1, 0.2, 0] } }"#,
    )];
    let mut meshes = [vec![], vec![]];
    let (mut width, mut y) = (1.6, 0.0);
    for i in 0..floors {
        materials.push(medium(rng, &format!("m{i}"), 10 - i as i32));
        let height = 0.3 + f64::from(rng.unit()) * 0.5;
        for (k, sunk) in [0.0, 0.2].into_iter().enumerate() {
            meshes[k].push(format!(
                r#"{{ shape = "box", size = [{width}, {}, {width}], center = [0, {}, 0], material = "m{i}" }}"#,
                height + sunk,
                y + (height - sunk) / 2.0
            ));
        }
        y += height;
        width *= 0.6 + 0.3 * f64::from(rng.unit());
    }
    let head = format!("{HEAD}{}\nmaterial = [{}]\n", camera(rng), materials.join(", "));
    meshes.map(|m| format!(r#"{head}mesh = [{}, {{ shape = "plane", material = "floor" }}]"#, m.join(", ")))
}

/// A ball of glass with a core that two balls share; or the one alone that wins, being of the higher priority.
fn core(rng: &mut Rng) -> [String; 2] {
    let materials = [medium(rng, "shell", 1), medium(rng, "weak", 2), medium(rng, "strong", 3)].join(", ");
    let radius = 0.4 + f64::from(rng.unit()) * 0.4;
    let ball =
        |r: f64, m: &str| format!(r#"{{ shape = "sphere", center = [0, 1, 0], radius = {r}, material = "{m}" }}"#);
    let head = format!("{HEAD}{}\nmaterial = [{materials}]\n", camera(rng));
    let mut three = [ball(1.0, "shell"), ball(radius, "weak"), ball(radius, "strong")];
    three.rotate_left(rng.below(3));
    let two = [ball(1.0, "shell"), ball(radius, "strong")];
    [format!("{head}mesh = [{}]", three.join(", ")), format!("{head}mesh = [{}]", two.join(", "))]
}

/// A cup with its liquid, of the same tessellation and to the wall; or the liquid reaching into the wall, which wins.
fn cup(rng: &mut Rng) -> [String; 2] {
    let materials = [medium(rng, "glass", 2), medium(rng, "liquid", 1)].join(", ");
    let (inner, level, n) = (0.45 + 0.1 * f64::from(rng.unit()), 0.5 + 0.3 * f64::from(rng.unit()), 24);
    let head = format!("{HEAD}{}\nmaterial = [{materials}]\n", camera(rng));
    let glass = format!(
        r#"{{ shape = "lathe", profile = [[0, 0], [0.7, 0], [0.7, 1], [{inner}, 1], [{inner}, 0.1], [0, 0.1]], smooth = false, tessellation = {n}, material = "glass" }}"#
    );
    let liquid = |r: f64, bottom: f64| {
        format!(
            r#"{{ shape = "lathe", profile = [[0, {bottom}], [{r}, {bottom}], [{r}, {level}], [0, {level}]], smooth = false, tessellation = {n}, material = "liquid" }}"#
        )
    };
    [(inner, 0.1), (inner + 0.05, 0.05)].map(|(r, bottom)| {
        let mut text = head.clone();
        let _ = write!(text, "mesh = [{glass}, {}]", liquid(r, bottom));
        text
    })
}

/// Pixels whose value moves where the camera ray moves by a ten-thousandth of a pixel or of the scene: edges.
pub fn edges(scene: &Scene) -> Vec<bool> {
    let prepared = Prepared::new(scene, vitrum::optics::FresnelModel::Exact);
    let (width, height) = (scene.settings.width, scene.settings.height);
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (f64::from(x) + 0.5, f64::from(y) + 0.5)));
    let at = |x: f64, y: f64| prepared.radiance_at(x, y);
    pixels
        .map(|(x, y)| {
            let here = at(x, y);
            [(1e-3, 0.0), (-1e-3, 0.0), (0.0, 1e-3), (0.0, -1e-3)].iter().any(|(dx, dy)| {
                let there = at(x + dx, y + dy);
                (0..3).any(|c| (here[c] - there[c]).abs() > 2e-4)
            })
        })
        .collect()
}

/// Every renderer makes of touching bodies what it makes of overlapping ones.
fn is_as_merged(kind: &str, make: fn(&mut Rng) -> [String; 2]) {
    let found: Vec<[usize; 2]> =
        (0..stacks()).map(|seed| compare(kind, seed, make(&mut Rng::new(seed * 77 + kind.len() as u64)))).collect();
    let [compared, at_edges] = [0, 1].map(|k| found.iter().map(|counts| counts[k]).sum::<usize>());
    println!("{kind}: {compared} pixels compared, {at_edges} differ, all at edges");
}

/// Compares a scene of touching bodies with the same one merged: pixels, and those of them that differ at edges.
fn compare(kind: &str, seed: u64, [touching, merged]: [String; 2]) -> [usize; 2] {
    let (touching_scene, merged_scene) = (scene(&touching), scene(&merged));
    let edge = edges(&merged_scene);
    let truth = pictures(&merged_scene).swap_remove(1).1.film;
    let (mut compared, mut at_edges) = (0, 0);
    for (name, outcome) in pictures(&touching_scene) {
        let off: Vec<usize> = (0..edge.len())
            .filter(|&i| (0..3).any(|c| (outcome.film.pixels[i][c] - truth.pixels[i][c]).abs() > 5e-4))
            .collect();
        let wrong: Vec<usize> = off.iter().copied().filter(|&i| !edge[i]).collect();
        compared += edge.len();
        at_edges += off.len() - wrong.len();
        assert!(wrong.is_empty(), "{kind} {seed}, {name}: pixels {wrong:?} differ, {} in all\n{touching}", off.len());
    }
    [compared, at_edges]
}

/// A row of bricks of one glass is one long brick.
#[test]
fn bricks_of_one_glass_are_one_piece() {
    for seed in 0..stacks() {
        let mut rng = Rng::new(seed);
        let (glass, count) = (medium(&mut rng, "g", 4), 2 + rng.below(4));
        let head = format!("{HEAD}{}\nmaterial = [{glass}]\n", camera(&mut rng));
        let (mut x, mut bricks) = (-0.9, Vec::new());
        for _ in 0..count {
            let length = 0.2 + f64::from(rng.unit()) * 0.4;
            bricks.push(format!(
                r#"{{ shape = "box", size = [{length}, 0.7, 0.6], center = [{}, 0.8, 0], material = "g" }}"#,
                x + length / 2.0
            ));
            x += length;
        }
        let whole = format!(
            r#"{{ shape = "box", size = [{}, 0.7, 0.6], center = [{}, 0.8, 0], material = "g" }}"#,
            x + 0.9,
            (x - 0.9) / 2.0
        );
        let texts = [format!("{head}mesh = [{}]", bricks.join(", ")), format!("{head}mesh = [{whole}]")];
        compare("bricks", seed, texts);
    }
}

#[test]
fn towers_of_touching_boxes_are_as_boxes_sunk_into_each_other() {
    is_as_merged("tower", tower);
}

#[test]
fn balls_that_share_a_core_are_as_the_winner_alone() {
    is_as_merged("core", core);
}

#[test]
fn a_cup_filled_to_the_wall_is_as_one_whose_liquid_reaches_into_it() {
    is_as_merged("cup", cup);
}

/// The whole of a scene scaled and moved is the same picture.
#[test]
fn touching_survives_scales_and_moves() {
    for (seed, scale, offset) in [(1, 1e-3, 0.0), (2, 1e3, 0.0), (3, 1.0, 20.0), (4, 10.0, -30.0)] {
        let [touching, _] = tower(&mut Rng::new(seed));
        let plain = scene(&touching);
        let mut moved = scene(&touching);
        transform(&mut moved, scale, offset);
        let films = [&plain, &moved].map(pictures);
        for ((name, a), (_, b)) in films[0].iter().zip(&films[1]) {
            let differing = apart(&a.film, &b.film, 2e-3);
            assert!(differing <= 12, "{name}, {scale}, {offset}: {differing} pixels differ");
        }
    }
}

/// Scales everything about the origin, then moves it along the diagonal of x and z. Lengths in media go along.
fn transform(scene: &mut Scene, scale: f32, offset: f32) {
    use vitrum::geometry::Shape;
    let by = glam::Vec3::new(offset, 0.0, offset);
    let at = |p: glam::Vec3| p * scale + by * scale;
    for geometry in &mut scene.geometry {
        match &mut geometry.shape {
            Shape::Mesh(mesh) => mesh.positions.iter_mut().for_each(|p| *p = at(*p)),
            Shape::Sphere(sphere) => (sphere.centre, sphere.radius) = (at(sphere.centre), sphere.radius * scale),
            Shape::Plane(plane) => plane.point = at(plane.point),
        }
    }
    for material in &mut scene.materials {
        if let vitrum::scene::Colour::Checker { size, offset, .. } = &mut material.diffuse {
            (*size, *offset) = (*size * scale, at(*offset));
        }
    }
    scene.media.iter_mut().for_each(|m| m.absorption /= scale);
    for light in &mut scene.lights {
        if let vitrum::scene::LightKind::Point { position } = &mut light.kind {
            *position = at(*position);
        }
        light.intensity *= scale * scale;
    }
    (scene.camera.eye, scene.camera.target) = (at(scene.camera.eye), at(scene.camera.target));
}
