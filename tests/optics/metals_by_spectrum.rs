//! The indices of the catalogue are those of measured spectra, integrated over the visible range.

use vitrum::load::catalogue;
use vitrum::math::Real;
use vitrum::optics::{Boundary, Exact, FresnelFormula, conductor_exact, white_at};

/// Photon energy in electronvolts, index and extinction.
type Sample = [f64; 3];

/// Palik, "Handbook of Optical Constants of Solids" (1985): Lynch & Hunter.
const SILVER: [Sample; 20] = [
    [3.4, 0.186, 1.61],
    [3.3, 0.2, 1.67],
    [3.2, 0.192, 1.81],
    [3.1, 0.173, 1.95],
    [3.0, 0.173, 2.11],
    [2.9, 0.16, 2.26],
    [2.8, 0.157, 2.4],
    [2.7, 0.144, 2.56],
    [2.6, 0.132, 2.72],
    [2.5, 0.13, 2.88],
    [2.4, 0.13, 3.07],
    [2.3, 0.129, 3.25],
    [2.2, 0.12, 3.45],
    [2.1, 0.121, 3.66],
    [2.0, 0.131, 3.88],
    [1.9, 0.14, 4.15],
    [1.8, 0.14, 4.44],
    [1.7, 0.148, 4.74],
    [1.6, 0.143, 5.09],
    [1.5, 0.145, 5.5],
];

/// Palik 1985: Lynch & Hunter.
const GOLD: [Sample; 20] = [
    [3.4, 1.716, 1.862],
    [3.3, 1.696, 1.906],
    [3.2, 1.674, 1.936],
    [3.1, 1.658, 1.956],
    [3.0, 1.636, 1.958],
    [2.9, 1.616, 1.94],
    [2.8, 1.562, 1.904],
    [2.7, 1.426, 1.846],
    [2.6, 1.242, 1.796],
    [2.5, 0.916, 1.84],
    [2.4, 0.608, 2.12],
    [2.3, 0.402, 2.54],
    [2.2, 0.306, 2.88],
    [2.1, 0.236, 2.97],
    [2.0, 0.194, 3.06],
    [1.9, 0.166, 3.15],
    [1.8, 0.16, 3.8],
    [1.7, 0.164, 4.357],
    [1.6, 0.176, 4.86],
    [1.5, 0.188, 5.39],
];

/// Palik 1985: Lynch & Hunter.
const COPPER: [Sample; 20] = [
    [3.4, 1.27, 1.95],
    [3.3, 1.225, 2.015],
    [3.2, 1.18, 2.21],
    [3.1, 1.175, 2.13],
    [3.0, 1.18, 2.21],
    [2.9, 1.175, 2.289],
    [2.8, 1.17, 2.362],
    [2.7, 1.16, 2.433],
    [2.6, 1.15, 2.504],
    [2.5, 1.135, 2.564],
    [2.4, 1.12, 2.605],
    [2.3, 1.04, 2.583],
    [2.2, 0.826, 2.599],
    [2.1, 0.468, 2.809],
    [2.0, 0.272, 3.24],
    [1.9, 0.214, 3.67],
    [1.8, 0.213, 4.05],
    [1.7, 0.223, 4.43],
    [1.6, 0.25, 4.817],
    [1.5, 0.26, 5.26],
];

/// Palik 1985: Smith, Shiles & Inokuti.
#[expect(clippy::approx_constant, reason = "a measured number that is near a constant")]
const ALUMINIUM: [Sample; 20] = [
    [3.4, 0.407, 4.43],
    [3.3, 0.432, 4.56],
    [3.2, 0.46, 4.71],
    [3.1, 0.49, 4.86],
    [3.0, 0.523, 5.02],
    [2.9, 0.558, 5.2],
    [2.8, 0.598, 5.38],
    [2.7, 0.644, 5.58],
    [2.6, 0.695, 5.8],
    [2.5, 0.755, 6.03],
    [2.4, 0.826, 6.28],
    [2.3, 0.912, 6.55],
    [2.2, 1.02, 6.85],
    [2.1, 1.15, 7.15],
    [2.0, 1.3, 7.48],
    [1.9, 1.49, 7.82],
    [1.8, 1.74, 8.21],
    [1.7, 2.14, 8.57],
    [1.6, 2.63, 8.6],
    [1.5, 2.74, 8.31],
];

/// Wavelength in nanometres, index and extinction: Palik, volume II (1991), Lynch & Hunter.
const CHROMIUM: [Sample; 18] = [
    [351.218, 1.33, 3.18],
    [362.515, 1.39, 3.24],
    [372.312, 1.43, 3.31],
    [385.031, 1.44, 3.4],
    [396.102, 1.48, 3.54],
    [409.175, 1.54, 3.71],
    [424.589, 1.65, 3.89],
    [438.092, 1.8, 4.06],
    [455.809, 1.99, 4.22],
    [471.407, 2.22, 4.36],
    [490.04, 2.49, 4.44],
    [512.314, 2.75, 4.46],
    [532.103, 2.98, 4.45],
    [558.468, 3.18, 4.41],
    [582.066, 3.34, 4.38],
    [610.739, 3.48, 4.36],
    [700.452, 3.84, 4.37],
    [815.658, 4.23, 4.34],
];

/// Product of photon energy and wavelength, in electronvolts and nanometres.
const EV_NM: f64 = 1239.842;

/// The spectrum of a metal of the catalogue, by rising wavelength in nanometres.
fn spectrum(name: &str) -> Vec<Sample> {
    let by_energy = |table: &[Sample]| table.iter().map(|&[ev, n, k]| [EV_NM / ev, n, k]).collect();
    match name {
        "silver" => by_energy(&SILVER),
        "gold" => by_energy(&GOLD),
        "copper" => by_energy(&COPPER),
        "aluminium" => by_energy(&ALUMINIUM),
        "chromium" => CHROMIUM.to_vec(),
        _ => panic!("no spectrum of {name}"),
    }
}

/// Index and extinction at a wavelength, linear between samples.
fn at(spectrum: &[Sample], nm: f64) -> [f64; 2] {
    let above = spectrum.iter().position(|s| s[0] >= nm).expect("the table covers the visible range");
    let ([a, b], t) = ([spectrum[above - 1], spectrum[above]], |a: f64, b: f64| (nm - a) / (b - a));
    let t = t(a[0], b[0]);
    [a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])]
}

/// Linear sRGB of white light times `reflectance`, by wavelength in nanometres.
fn colour(reflectance: impl Fn(f64) -> f64) -> [f64; 3] {
    let (mut sum, mut white) = ([0.0; 3], [0.0; 3]);
    for nm in (380..=780).step_by(5).map(f64::from) {
        let (weight, share) = (white_at(nm), reflectance(nm));
        for c in 0..3 {
            sum[c] += weight[c] * share;
            white[c] += weight[c];
        }
    }
    std::array::from_fn(|c| sum[c] / white[c])
}

/// Integrated reflectance of a spectrum at an angle.
fn metal_colour(spectrum: &[Sample], cos_i: f64) -> [f64; 3] {
    colour(|nm| {
        let [n, k] = at(spectrum, nm);
        conductor_exact(cos_i, n, k)
    })
}

#[test]
fn white_light_on_a_metal_has_the_published_colour() {
    // Akenine-Möller et al., Real-Time Rendering, 4th edition, table 9.2: linear sRGB at normal incidence.
    for (name, published) in [
        ("gold", [1.022, 0.782, 0.344]),
        ("silver", [0.972, 0.960, 0.915]),
        ("copper", [0.955, 0.638, 0.538]),
        ("aluminium", [0.913, 0.922, 0.924]),
    ] {
        let got = metal_colour(&spectrum(name), 1.0);
        for (got, want) in got.into_iter().zip(published) {
            assert!((got - want).abs() < 0.0025, "{name}: {got}, published {want}");
        }
    }
}

#[test]
fn named_metals_reflect_as_their_spectra_do_at_every_angle() {
    for metal in catalogue::METALS {
        let (name, spectrum) = (metal.names[0], spectrum(metal.names[0]));
        for step in 1..=50 {
            let cos_i = f64::from(step) / 50.0;
            let want = metal_colour(&spectrum, cos_i);
            for (c, want) in want.into_iter().enumerate() {
                let got = conductor_exact(cos_i, f64::from(metal.eta[c]), f64::from(metal.k[c]));
                // No surface reflects more light than arrives, as gold's red would have to.
                let out_of_gamut = name == "gold" && c == 0;
                let within = if out_of_gamut { 0.015 } else { 0.005 };
                let off = (got - want.min(1.0)).abs();
                assert!(off < within, "{name}, channel {c} at {cos_i}: {got}, not {want}");
                assert!(step < 50 || off < 5e-4, "{name}, channel {c} at normal incidence: {got}, not {want}");
            }
        }
    }
}

#[test]
fn no_other_index_with_the_same_reflectance_at_normal_incidence_fits_the_other_angles_better() {
    for metal in catalogue::METALS {
        let (name, spectrum) = (metal.names[0], spectrum(metal.names[0]));
        let cosines: Vec<f64> = (0..50).map(|i| (f64::from(i) + 0.5) / 50.0).collect();
        let wanted: Vec<[f64; 3]> = cosines.iter().map(|&c| metal_colour(&spectrum, c)).collect();
        let normal = metal_colour(&spectrum, 1.0);
        for c in (0..3).filter(|&c| normal[c] < 1.0) {
            let error = |eta: f64| {
                // k from the reflectance r: k^2 (1 - r) = r (eta + 1)^2 - (eta - 1)^2.
                let r = normal[c];
                let k = ((r * (eta + 1.0).powi(2) - (eta - 1.0).powi(2)) / (1.0 - r)).sqrt();
                let off = |(&cos_i, want): (&f64, &[f64; 3])| (conductor_exact(cos_i, eta, k) - want[c]).powi(2);
                cosines.iter().zip(&wanted).map(off).sum::<f64>()
            };
            let eta = f64::from(metal.eta[c]);
            let best = error(eta);
            for other in [0.8, 0.95, 1.05, 1.25] {
                assert!(error(eta * other) > best, "{name}, channel {c}: {} fits better than {eta}", eta * other);
            }
        }
    }
}

#[test]
fn a_glass_without_dispersion_reflects_nearly_as_its_spectrum_does() {
    for glass in catalogue::TRANSPARENT {
        let Some(_) = glass.dispersion.index_at(587.6) else { continue };
        let reflectance = |n: f64| {
            let boundary = Boundary::<f64>::new(1.0, n);
            Exact::dielectric(&boundary, &boundary.cross(f64::one()))
        };
        let white = colour(|nm| reflectance(glass.dispersion.index_at(nm).expect("it has a curve")));
        for got in white {
            let off = (got - reflectance(glass.ior)).abs();
            assert!(off < 0.006, "{}: {got}, and {} at the line d", glass.names[0], reflectance(glass.ior));
        }
    }
}
