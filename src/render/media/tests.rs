//! Nested media by hand: stacks, priorities, unmatched exits and wavelengths.

use super::*;
use crate::scene::Dispersion;

fn medium(name: &str, ior: f64, priority: i32) -> Medium {
    Medium { name: name.into(), ior, dispersion: Dispersion::None, absorption: Rgb::ZERO, priority }
}

/// Air, glass, water, ice. Ice floats in water in a glass; ice has priority over glass, and glass over water.
fn drink() -> Vec<Medium> {
    vec![Medium::air(), medium("glass", 1.5, 10), medium("water", 1.33, 5), medium("ice", 1.31, 20)]
}

#[test]
fn water_that_overlaps_its_glass_begins_where_the_glass_ends() {
    let media = drink();
    let bodies = Bodies::one_each(&media);
    let mut table = MediaTable::new(&media, &bodies);
    let air = StackId::default();
    // Into the glass wall: air to glass.
    let into_glass = table.cross(air, 1, true);
    assert!(into_glass.real);
    assert!((into_glass.boundary.eta - 1.0 / 1.5).abs() < 1e-6);
    // The water surface inside the wall is passed.
    let water_in_wall = table.cross(into_glass.beyond, 2, true);
    assert!(!water_in_wall.real);
    assert_eq!(table.top(water_in_wall.beyond), 1);
    // Leaving the wall: glass to water.
    let into_water = table.cross(water_in_wall.beyond, 1, false);
    assert!(into_water.real);
    assert!((into_water.boundary.eta - (1.5 / 1.33) as f32).abs() < 1e-6);
    assert_eq!(table.top(into_water.beyond), 2);
    // Ice has priority over water; beyond the ice the water continues.
    let into_ice = table.cross(into_water.beyond, 3, true);
    assert!(into_ice.real);
    let out_of_ice = table.cross(into_ice.beyond, 3, false);
    assert_eq!(out_of_ice.beyond, into_water.beyond);
}

/// Case AB-08 of the catalogue.
#[test]
fn leaving_what_was_never_entered_is_counted_and_does_not_underflow() {
    let media = drink();
    let bodies = Bodies::one_each(&media);
    let mut table = MediaTable::new(&media, &bodies);
    let t = table.cross(StackId::default(), 1, false);
    assert!(t.real && t.unmatched);
    assert_eq!(t.beyond, StackId::default());
    assert!((t.boundary.eta - 1.5).abs() < 1e-6);
}

#[test]
fn entering_twice_needs_leaving_twice() {
    let media = drink();
    let bodies = Bodies::one_each(&media);
    let mut table = MediaTable::new(&media, &bodies);
    let once = table.cross(StackId::default(), 1, true).beyond;
    let twice = table.cross(once, 1, true);
    assert!(twice.real, "among equals the latest wins");
    assert_eq!(twice.boundary.kc, 0.0, "glass to glass is no boundary to see");
    assert_eq!(table.cross(twice.beyond, 1, false).beyond, once);
    assert_eq!(table.cross(once, 1, false).beyond, StackId::default());
}

#[test]
fn an_onion_of_a_hundred_shells_interns_a_hundred_and_one_stacks() {
    let media: Vec<Medium> = std::iter::once(Medium::air())
        .chain((1..=100).map(|i| medium("shell", 1.0 + f64::from(i) * 0.01, i)))
        .collect();
    let bodies = Bodies::one_each(&media);
    let mut table = MediaTable::new(&media, &bodies);
    let mut stack = StackId::default();
    for m in 1..=100 {
        stack = table.cross(stack, m, true).beyond;
        assert_eq!(table.top(stack), m);
    }
    for m in (1..=100).rev() {
        stack = table.cross(stack, m, false).beyond;
    }
    assert_eq!(stack, StackId::default());
    assert_eq!(table.stacks.len(), 101);
}

/// Flint in water in air. The water's index does not depend on the wavelength.
fn dispersing() -> Vec<Medium> {
    let flint = Medium { dispersion: Dispersion::Cauchy([1.59, 0.01, 0.0]), ..medium("flint", 1.618_97, 5) };
    vec![Medium::air(), medium("water", 1.33, 1), flint]
}

#[test]
fn a_wavelength_keeps_its_own_index_in_every_medium_until_it_ends() {
    let media = dispersing();
    let bodies = Bodies::one_each(&media);
    let mut table = MediaTable::dispersing(&media, &bodies, Spectrum::new(8, 2));
    let mut eye = StackId::default();
    for sample in 0..4 {
        table.begin_sample(sample);
        eye = table.stack_of(&[1]);
        let into = table.cross(eye, 2, true);
        let white = table.media[2].ior;
        assert!((f64::from(into.boundary.eta) - 1.33 / white).abs() < 1e-6, "white light goes by the line d");
        let id = into.fan.expect("flint disperses");
        table.learn_fan(id);
        let fan = table.known_fan(id).clone();
        assert_eq!(fan.outermost, [0, 7], "blue has the smallest ratio, red the largest");
        let bands = Spectrum::new(8, 2).sets()[sample as usize].clone();
        for (k, band) in fan.bands.iter().enumerate() {
            let index = media[2].index_at(bands.nm[k]);
            assert!((f64::from(band.boundary.eta) - 1.33 / index).abs() < 1e-6);
            assert_eq!(table.band_weight(k).to_array(), bands.weight[k]);
            assert_eq!((table.top(band.beyond), table.ior(band.beyond)), (2, index));
            let out = table.cross(band.beyond, 2, false);
            assert!(out.real && out.fan.is_none(), "what has a wavelength does not divide");
            assert!((f64::from(out.boundary.eta) - index / 1.33).abs() < 1e-6);
            assert_eq!((table.top(out.beyond), table.ior(out.beyond)), (1, 1.33));
        }
    }
    assert!(table.cross(eye, 1, false).fan.is_none(), "water to air disperses nothing");
}

#[test]
fn without_a_spectrum_nothing_divides_and_the_line_d_counts() {
    let media = dispersing();
    let bodies = Bodies::one_each(&media);
    let mut table = MediaTable::new(&media, &bodies);
    let into = table.cross(StackId::default(), 2, true);
    assert!(into.fan.is_none());
    assert!((f64::from(into.boundary.eta) - 1.0 / media[2].ior).abs() < 1e-6);
}

/// Glass to water at a common face is one boundary; two faces of one glass are none.
#[test]
fn faces_that_coincide_are_crossed_as_one_boundary() {
    let mut media = drink();
    media.push(medium("other glass", 1.5, 10));
    let bodies = Bodies::one_each(&media);
    let mut table = MediaTable::new(&media, &bodies);
    let glass = table.cross(StackId::default(), 1, true).beyond;
    let into_water = table.cross_all(glass, &[(1, false), (2, true)]);
    assert!(into_water.real && !into_water.unmatched);
    assert!((into_water.boundary.eta - (1.5 / 1.33) as f32).abs() < 1e-6);
    assert_eq!(table.entered(into_water.beyond), [2]);
    let on = table.cross_all(glass, &[(1, false), (4, true)]);
    assert!(!on.real);
    assert_eq!(table.entered(on.beyond), [4]);
    // Out of both at once, and into both at once.
    let both = table.cross_all(StackId::default(), &[(2, true), (1, true)]);
    assert_eq!((table.entered(both.beyond), both.media), (vec![2, 1], [0, 1]));
    let out = table.cross_all(both.beyond, &[(1, false), (2, false)]);
    assert_eq!((out.beyond, out.media), (StackId::default(), [1, 0]));
    assert!(table.cross_all(StackId::default(), &[(1, false), (2, false)]).unmatched);
}
