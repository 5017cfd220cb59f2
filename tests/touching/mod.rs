//! Surfaces that touch: a clean picture by the rules of `src/README.md`, the same over every back end and in `f64`.

mod agree;
mod cases;
mod rules;
mod stacks;

use crate::support::backends;
use vitrum::accel::Backend;
use vitrum::image::Film;
use vitrum::load;
use vitrum::render::{Observer, Options, Outcome, reference, render};
use vitrum::scene::Scene;

/// The scene of a TOML text.
fn scene(text: &str) -> Scene {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("scene.toml");
    std::fs::write(&file, text).expect("writable");
    load::scene(&file, &load::LoadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}")).scene
}

/// The results of each renderer for a scene, by name; the first is native.
fn pictures(scene: &Scene) -> Vec<(&'static str, Outcome)> {
    let (options, observer) = (Options::default(), Observer::default());
    let native = render(scene, &backends::native(&scene.geometry), &options, &observer).expect("renders");
    let double = reference::render(scene, &options, &observer).expect("renders");
    let mut pictures = vec![("native", native), ("f64", double)];
    if let Some(embree) = backends::embree(Backend::Embree, &scene.geometry) {
        pictures.push(("embree", render(scene, &embree, &options, &observer).expect("renders")));
    }
    pictures
}

/// Pixels of which a channel differs by more than `tolerance`.
fn apart(a: &Film, b: &Film, tolerance: f32) -> usize {
    let off = |(a, b): &(&[f32; 3], &[f32; 3])| a.iter().zip(*b).any(|(a, b)| (a - b).abs() > tolerance);
    a.pixels.iter().zip(&b.pixels).filter(off).count()
}

/// All renderers make the same picture of a scene, but for `edges` pixels, and count no unmatched exit.
#[track_caller]
fn all_agree(text: &str, edges: usize) -> Film {
    let scene = scene(text);
    let mut pictures = pictures(&scene);
    for (name, outcome) in &pictures {
        assert_eq!((outcome.non_finite, outcome.clamped), (0, 0), "{name}");
        assert_eq!(outcome.unmatched_exits, 0, "{name}");
        let apart = apart(&outcome.film, &pictures[0].1.film, 5e-4);
        assert!(apart <= edges, "{name} differs in {apart} pixels, {edges} may");
    }
    pictures.swap_remove(0).1.film
}

/// Every pixel of a picture is `value` in its red channel.
#[track_caller]
fn all_are(film: &Film, value: f32, within: f32) {
    for (i, pixel) in film.pixels.iter().enumerate() {
        assert!((pixel[0] - value).abs() <= within, "pixel {i}: {} for {value}", pixel[0]);
    }
}
