//! The eight-wide renderer and the one in `f64` give the same picture of anything: random scenes with every kind of
//! surface, shape, light, medium and sky are rendered by both.

mod found;
use crate::support;

use glam::DVec3;
use support::random;
use support::scenes::native;
use vitrum::render::reference::{self, Prepared, Tally};
use vitrum::render::{Observer, Options, Outcome, RayKind};
use vitrum::scene::Scene;

/// Most that a channel of a pixel may differ, as a share of its value where that is above 1.
const TOLERANCE: f64 = 2e-4;

/// Movements of a camera ray, in ulps of 1, that test if a pixel is well-conditioned. In `f32` the origins of secondary
/// rays are offset by some ten ulps at each surface.
const ULPS: [f64; 4] = [1.0, 4.0, 16.0, 64.0];

/// Scenes that are rendered.
const SCENES: u64 = 300;

/// Numbers of pixel values, in one scene and in all, that may differ although a moved camera ray does not change them.
/// Light that grazes the inside of a ball leaves it at an angle that depends on the root of its offset from the
/// surface. Smooth normals are bent (`optics::consistent_normal`) to a threshold that parallel facets meet exactly.
const STRAY: (usize, usize) = (8, 16);

/// Compared quantity of a pixel.
type Quantity = fn(&Tally) -> DVec3;

fn differs(a: DVec3, b: DVec3) -> bool {
    let scale = DVec3::ONE.max(a.abs()).max(b.abs());
    ((a - b).abs() / scale).max_element() > TOLERANCE
}

/// Returns true if the quantity `of` of a pixel in the `f64` renderer changes by more than the tolerance when the
/// camera rays move by a few ulps of `f32`.
fn is_ill_conditioned(prepared: &Prepared<'_>, scene: &Scene, pixel: [u32; 2], of: Quantity) -> bool {
    let n = scene.settings.samples;
    let reach = scene.camera.eye.as_dvec3().abs().max_element() + 1.0;
    let (mut here, mut moved_most) = (DVec3::ZERO, 0.0);
    for sample in 0..n * n {
        let within = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
        let (x, y) = (f64::from(pixel[0]) + within(sample % n), f64::from(pixel[1]) + within(sample / n));
        let (origin, dir) = prepared.camera_ray(x, y);
        let at = of(&prepared.trace(origin, dir));
        let (right, up) = dir.any_orthonormal_pair();
        let moved = ULPS.iter().flat_map(|ulps| (0..8).map(move |turn| (ulps, turn))).flat_map(|(ulps, turn)| {
            let (s, c) = (f64::from(turn) * std::f64::consts::FRAC_PI_4).sin_cos();
            let step = (right * c + up * s) * (ulps * f64::from(f32::EPSILON));
            [(origin, (dir + step).normalize()), (origin + step * reach, dir)]
        });
        let most = moved.map(|(o, d)| (of(&prepared.trace(o, d)) - at).abs().max_element());
        moved_most += most.fold(0.0, f64::max);
        here += at;
    }
    let samples = f64::from(n * n);
    moved_most / samples > TOLERANCE * (here / samples).abs().max_element().max(1.0)
}

fn nearly(a: u64, b: u64) -> bool {
    a.abs_diff(b) * 50 <= a.max(b) + 500
}

/// Describes the differences between the renderers: single values of pixels, and counts.
fn disagreements(scene: &Scene, ours: &Outcome, theirs: &Outcome, prepared: &Prepared<'_>) -> [Vec<String>; 2] {
    let (mut stray, mut found) = (Vec::new(), Vec::new());
    let films: [(_, _, _, Quantity); 2] = [
        ("radiance", &ours.film, &theirs.film, |t| t.radiance),
        ("truncated", &ours.truncated, &theirs.truncated, |t| t.truncated),
    ];
    for (name, ours, theirs, of) in films {
        for (y, x) in (0..ours.height).flat_map(|y| (0..ours.width).map(move |x| (y, x))) {
            let [a, b] = [ours.at(x, y), theirs.at(x, y)].map(|p| DVec3::from(p.map(f64::from)));
            if differs(a, b) && !is_ill_conditioned(prepared, scene, [x, y], of) {
                stray.push(format!("{name} at ({x}, {y}): {a} for {b}"));
            }
        }
    }
    for kind in RayKind::ALL {
        let (a, b) = (ours.rays.of(kind), theirs.rays.of(kind));
        if !nearly(a, b) {
            found.push(format!("{} rays: {a} for {b}", kind.name()));
        }
    }
    let counts = [
        ("unmatched exits", ours.unmatched_exits, theirs.unmatched_exits),
        ("contributions not finite", ours.non_finite, theirs.non_finite),
        ("contributions clamped", ours.clamped, theirs.clamped),
    ];
    found.extend(counts.iter().filter(|c| !nearly(c.1, c.2)).map(|(name, a, b)| format!("{name}: {a} for {b}")));
    [stray, found]
}

#[test]
fn random_scenes_look_the_same_to_both_renderers() {
    let (mut wrong, mut strays) = (Vec::new(), 0);
    for seed in 0..SCENES {
        let (scene, fresnel) = random::scene(seed);
        let options = Options { fresnel, ..Options::default() };
        let ours = native(&scene, &options);
        let theirs = reference::render(&scene, &options, &Observer::default()).expect("nobody interrupts a test");
        let prepared = Prepared::new(&scene, fresnel);
        let [stray, mut found] = disagreements(&scene, &ours, &theirs, &prepared);
        strays += stray.len();
        if stray.len() > STRAY.0 {
            found.extend(stray);
        }
        if !found.is_empty() {
            let first = &found[..found.len().min(3)];
            wrong.push(format!("scene {seed}: {} disagreements, {first:#?}", found.len()));
        }
    }
    println!("{strays} values of pixels stray");
    assert!(wrong.is_empty(), "{} scenes: {}", wrong.len(), wrong.join("\n"));
    assert!(strays <= STRAY.1, "{strays} values of pixels differ");
}
