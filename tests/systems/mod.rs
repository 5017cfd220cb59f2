//! Promise: the lecture notes' reflection systems show what the traced picture shows, as nearly as each of them claims, in
//! every renderer.

use crate::support;

mod bodies;
mod curved;
mod lighting;
mod maps;
mod planar;
mod raised;

use vitrum::image::Film;
use vitrum::render::{Observer, Options, Outcome, reference};
use vitrum::scene::Scene;

/// Every renderer's outcome, with its name.
fn outcomes(scene: &Scene, options: &Options) -> Vec<(&'static str, Outcome)> {
    let by_reference = reference::render(scene, options, &Observer::default()).expect("nobody interrupts a test");
    let mut all = fast_outcomes(scene, options);
    all.push(("reference", by_reference));
    all
}

/// The outcomes of the renderers of eight lanes.
fn fast_outcomes(scene: &Scene, options: &Options) -> Vec<(&'static str, Outcome)> {
    #[cfg_attr(not(feature = "embree"), expect(unused_mut, reason = "Embree's outcome is added where it is built in"))]
    let mut all = vec![("native", support::scenes::native(scene, options))];
    #[cfg(feature = "embree")]
    {
        use vitrum::accel::{Unbounded, embree};
        let built = embree::Embree::build(&scene.geometry, &embree::Options::default()).expect("Embree is there");
        let accel = Unbounded::new(built, &scene.geometry);
        let outcome = vitrum::render::render(scene, &accel, options, &Observer::default()).expect("as above");
        all.push(("embree", outcome));
    }
    all
}

/// The largest difference of a pixel's channels.
fn difference(a: &Film, b: &Film, pixel: usize) -> f32 {
    a.pixels[pixel].iter().zip(b.pixels[pixel]).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// Returns true if a pixel of a picture differs from a neighbour by more than `step`, or lies at its border.
fn is_at_edge(film: &Film, pixel: usize, step: f32) -> bool {
    let (w, h) = (film.width as usize, film.height as usize);
    let (x, y) = (pixel % w, pixel / w);
    if x == 0 || y == 0 || x + 1 == w || y + 1 == h {
        return true;
    }
    let around =
        [pixel - 1, pixel + 1, pixel - w, pixel + w, pixel - w - 1, pixel - w + 1, pixel + w - 1, pixel + w + 1];
    let colour = |p: usize, c: usize| film.pixels[p][c];
    around.iter().any(|&p| (0..3).any(|c| (colour(p, c) - colour(pixel, c)).abs() > step))
}
