//! Sums of many samples.

use vitrum::render::Options;

use crate::support::scenes;

/// AC-02: a running sum in `f32` stalls near 2^24 samples and drifts long before; a pixel of 65,536 equal samples is that
/// sample to the bit.
#[test]
fn the_mean_of_many_equal_samples_is_the_sample() {
    let mut scene = scenes::empty(0.1);
    (scene.settings.width, scene.settings.height, scene.settings.samples) = (2, 1, 256);
    let outcome = scenes::native(&scene, &Options::default());
    assert_eq!(outcome.rays.total(), 2 * 65_536);
    assert!(outcome.film.pixels.iter().all(|p| *p == [0.1; 3]), "{:?}", outcome.film.pixels);
    let stalled = (0..65_536).fold(0.0_f32, |sum, _| sum + 0.1) / 65_536.0;
    assert!((stalled - 0.1).abs() > 1e-5, "the case must be hard: {stalled}");
}
