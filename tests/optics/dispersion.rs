//! Indices over wavelengths, and white light as a sum of wavelengths.

use vitrum::load::catalogue;
use vitrum::optics::{
    Bands, FEWEST_BANDS, LINE_C, LINE_D, LINE_F, Spectrum, VISIBLE, abbe_number, cauchy_from_abbe, colour_matching,
    daylight, linear_srgb, white_at,
};
use vitrum::scene::Dispersion;

fn index(name: &str, nm: f64) -> f64 {
    catalogue::transparent(name).expect("it is known").dispersion.index_at(nm).expect("its curve is known")
}

#[test]
fn the_curves_of_named_substances_give_the_published_indices_at_three_lines() {
    // n_F, n_d, n_C: Schott's data sheets; Malitson 1965.
    for (name, published) in [
        ("bk7", [1.52238, 1.51680, 1.51432]),
        ("n-f2", [1.63208, 1.62005, 1.61506]),
        ("n-sf11", [1.80651, 1.78472, 1.77596]),
        ("fused silica", [1.46313, 1.45846, 1.45637]),
    ] {
        for (nm, n) in [LINE_F, LINE_D, LINE_C].into_iter().zip(published) {
            assert!((index(name, nm) - n).abs() < 1e-5, "{name} at {nm} nm: {} instead of {n}", index(name, nm));
        }
    }
}

#[test]
fn the_curves_of_named_substances_give_the_published_abbe_numbers() {
    for (name, published, within) in [
        ("bk7", 64.17, 0.01),
        ("n-f2", 36.43, 0.01),
        ("n-sf10", 28.53, 0.01),
        ("n-sf11", 25.68, 0.01),
        ("fused silica", 67.82, 0.02),
        ("sapphire", 72.31, 0.1),
        ("fluorite", 95.0, 0.1),
        ("diamond", 55.3, 0.1),
        ("water", 55.8, 0.1),
        ("soda lime", 63.97, 0.02),
    ] {
        let got = abbe_number(|nm| index(name, nm));
        assert!((got - published).abs() < within, "{name}: {got} instead of {published}");
    }
}

#[test]
fn every_curve_of_the_catalogue_meets_its_index_and_falls_over_the_whole_visible_range() {
    for substance in catalogue::TRANSPARENT.iter().filter(|t| t.dispersion != Dispersion::None) {
        let at = |nm: f64| substance.dispersion.index_at(nm).expect("it has a curve");
        assert!((at(LINE_D) - substance.ior).abs() < 1e-3, "{}: {}", substance.names[0], at(LINE_D));
        let mut nm = VISIBLE[0];
        while nm < VISIBLE[1] {
            assert!(at(nm) > at(nm + 1.0), "{} at {nm} nm", substance.names[0]);
            nm += 1.0;
        }
    }
}

#[test]
fn cauchy_coefficients_of_an_abbe_number_have_that_number_and_index_again() {
    for (n_d, v_d) in [(1.5168, 64.17), (1.78472, 25.68), (2.417, 55.3), (1.33, 5.0)] {
        let [a, b] = cauchy_from_abbe(n_d, v_d);
        let curve = Dispersion::Cauchy([a, b, 0.0]);
        let at = |nm| curve.index_at(nm).expect("it has a curve");
        assert!((at(LINE_D) - n_d).abs() < 1e-15);
        assert!((abbe_number(at) / v_d - 1.0).abs() < 1e-12);
    }
    // By hand for BK7: B = 0.5168 / 64.17 / (1 / 0.4861327^2 - 1 / 0.6562725^2) = 0.0080536 / 1.909637 = 0.0042174.
    assert!((cauchy_from_abbe(1.5168, 64.17)[1] - 0.004_217_4).abs() < 1e-7);
}

#[test]
fn the_matching_functions_are_those_of_the_standard_observer() {
    // CIE 018:2019, the table in steps of 1 nm: rows that lie between those of the table in steps of 5 nm, and two of it.
    for (nm, table) in [
        (418.0, [0.108_406, 0.003_118, 0.519_695]),
        (443.0, [0.350_013, 0.026_959, 1.776_264]),
        (467.0, [0.229_851, 0.080_266, 1.439_522]),
        (500.0, [0.004_9, 0.323_0, 0.272_0]),
        (502.0, [0.002_945, 0.354_686, 0.246_484]),
        (533.0, [0.201_169, 0.895_494, 0.034_458]),
        (557.0, [0.544_692, 0.999_305, 0.004_900]),
        (592.0, [1.040_986, 0.732_422, 0.001_049]),
        (600.0, [1.062_2, 0.631_0, 0.000_8]),
        (611.0, [0.991_368, 0.490_469, 0.000_307]),
        (648.0, [0.313_019, 0.118_779, 0.000_003]),
    ] {
        for (got, want) in colour_matching(nm).into_iter().zip(table) {
            assert!((got - want).abs() < 0.002_5, "{nm} nm: {got} instead of {want}");
        }
    }
    for outside in [-1.0, 0.0, 379.9, 780.1, 1e9, f64::NAN] {
        assert_eq!((colour_matching(outside), daylight(outside)), ([0.0; 3], 0.0), "{outside} nm");
    }
}

#[test]
fn the_illuminant_has_the_white_point_of_srgb_and_equal_energy_is_equal_in_x_y_and_z() {
    let sum = |power: fn(f64) -> f64| {
        let mut xyz = [0.0; 3];
        for nm in (380..=780).map(f64::from) {
            colour_matching(nm).into_iter().enumerate().for_each(|(i, value)| xyz[i] += power(nm) * value);
        }
        xyz
    };
    // CIE 15:2004: X, Y and Z of D65 are 95.04, 100 and 108.88.
    let [x, y, z] = sum(daylight);
    assert!((x / y - 0.950_4).abs() < 2e-4 && (z / y - 1.088_8).abs() < 3e-4, "{} {}", x / y, z / y);
    for channel in linear_srgb([x / y, 1.0, z / y]) {
        assert!((channel - 1.0).abs() < 5e-4, "{channel}");
    }
    let [x, y, z] = sum(|_| 1.0);
    assert!((x / y - 1.0).abs() < 2e-4 && (z / y - 1.0).abs() < 3e-4, "{} {}", x / y, z / y);
}

#[test]
fn bands_have_the_colours_of_their_wavelengths_in_daylight() {
    // Many bands need next to no scaling to be white together.
    let bands = Bands::new(64, 0.5);
    let width = (VISIBLE[1] - VISIBLE[0]) / 64.0;
    let mut luminance = 0.0;
    for nm in (380..=780).map(f64::from) {
        luminance += colour_matching(nm)[1] * daylight(nm);
    }
    for (nm, weight) in bands.nm.iter().zip(&bands.weight) {
        for (got, want) in weight.iter().zip(white_at(*nm)) {
            let want = want * width / luminance;
            assert!((f64::from(*got) - want).abs() < 2e-4 + 2e-3 * want.abs(), "{nm} nm: {got} instead of {want}");
        }
    }
}

#[test]
fn the_weights_of_all_bands_sum_to_exactly_one_in_any_order() {
    for count in FEWEST_BANDS..=64 {
        for offset in [0.0, 0.1, 0.5, 0.99] {
            let bands = Bands::new(count, offset);
            assert_eq!((bands.nm.len(), bands.weight.len()), (count as usize, count as usize));
            for channel in 0..3 {
                let forward = bands.weight.iter().fold(0.0_f32, |sum, w| sum + w[channel]);
                let backward = bands.weight.iter().rev().fold(0.0_f32, |sum, w| sum + w[channel]);
                assert_eq!((forward, backward), (1.0, 1.0), "{count} bands at {offset}");
            }
        }
    }
}

#[test]
fn blue_comes_before_green_before_red_and_cyan_has_less_than_no_red() {
    let bands = Bands::new(64, 0.5);
    let peak = |channel: usize| {
        let at = (0..64).max_by(|&a, &b| bands.weight[a][channel].total_cmp(&bands.weight[b][channel]));
        bands.nm[at.expect("there are bands")]
    };
    let [red, green, blue] = [peak(0), peak(1), peak(2)];
    assert!((435.0..465.0).contains(&blue) && (525.0..555.0).contains(&green) && (595.0..620.0).contains(&red));
    let cyan = bands.nm.iter().position(|&nm| nm > 500.0).expect("it is visible");
    assert!(bands.weight[cyan][0] < 0.0 && bands.weight[cyan][1] > 0.0);
}

#[test]
fn the_sets_of_a_pixels_samples_together_sample_the_spectrum_evenly() {
    for (samples, sets) in [(1, 1), (2, 4), (3, 9), (4, 16), (8, 64), (100, 64)] {
        let spectrum = Spectrum::new(8, samples);
        assert_eq!(spectrum.sets().len(), sets);
        let mut all: Vec<f64> = spectrum.sets().iter().flat_map(|s| s.nm.iter().copied()).collect();
        all.sort_by(f64::total_cmp);
        let step = (VISIBLE[1] - VISIBLE[0]) / all.len() as f64;
        for (i, nm) in all.iter().enumerate() {
            assert!((nm - VISIBLE[0] - (i as f64 + 0.5) * step).abs() < 1e-9);
        }
    }
    assert_eq!(Spectrum::new(8, 2).set_of(7), 3);
}
