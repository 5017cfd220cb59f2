//! Catalogue of substances: refractive indices, dispersion curves, and complex indices of metals.
//!
//! Lookup of names ignores case, spaces, underscores and hyphens.

use glam::Vec3;

use super::suggest::hint;
use crate::scene::Dispersion;

/// Transparent substance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transparent {
    /// Names; the first is the usual one.
    pub names: &'static [&'static str],
    /// Refractive index against air, near 587.6 nm (helium d) unless the source says otherwise.
    pub ior: f64,
    /// Dispersion curve, if known. At 587.6 nm it equals `ior` to within the rounding of the source of `ior`.
    pub dispersion: Dispersion,
    /// Source of the numbers.
    pub source: &'static str,
}

/// Metal with complex indices for three channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal {
    /// Names; the first is the usual one.
    pub names: &'static [&'static str],
    /// Real part of the index for red, green and blue.
    pub eta: Vec3,
    /// Imaginary part (extinction).
    pub k: Vec3,
}

const fn clear(names: &'static [&'static str], ior: f64, dispersion: Dispersion, source: &'static str) -> Transparent {
    Transparent { names, ior, dispersion, source }
}

/// Creates a curve of three Sellmeier terms as glass makers print them: all `B`, then all `C`.
const fn glass(b: [f64; 3], c: [f64; 3]) -> Dispersion {
    Dispersion::Sellmeier([[b[0], c[0]], [b[1], c[1]], [b[2], c[2]], [0.0, 0.0]])
}

/// Creates a curve of three Sellmeier terms by their resonances in micrometres, the square roots of `C`.
const fn resonances(b: [f64; 3], um: [f64; 3]) -> Dispersion {
    glass(b, [um[0] * um[0], um[1] * um[1], um[2] * um[2]])
}

const fn cauchy(a: f64, b: f64, c: f64) -> Dispersion {
    Dispersion::Cauchy([a, b, c])
}

/// Glasses, crystals, plastics and liquids.
pub const TRANSPARENT: &[Transparent] = &[
    clear(&["air", "vacuum"], 1.0, Dispersion::None, "by definition: indices here are against air"),
    clear(
        &["bk7", "n-bk7", "crown"],
        1.51680,
        glass([1.039_612_12, 0.231_792_344, 1.010_469_45], [0.006_000_698_67, 0.020_017_914_4, 103.560_653]),
        "Schott data sheet N-BK7, V_d 64.17",
    ),
    clear(
        &["sf11", "n-sf11"],
        1.78472,
        glass([1.737_596_95, 0.313_747_346, 1.898_781_01], [0.013_188_707, 0.062_306_814_2, 155.236_29]),
        "Schott data sheet N-SF11, V_d 25.68",
    ),
    clear(
        &["sf10", "n-sf10"],
        1.72828,
        glass([1.621_539_02, 0.256_287_842, 1.644_475_52], [0.012_224_145_7, 0.059_573_677_5, 147.468_793]),
        "Schott data sheet N-SF10, V_d 28.53",
    ),
    clear(
        &["flint", "f2", "n-f2"],
        1.62005,
        glass([1.397_570_37, 0.159_201_403, 1.268_654_3], [0.009_959_061_43, 0.054_693_175_2, 119.248_346]),
        "Schott data sheet N-F2, V_d 36.43",
    ),
    clear(
        &["fused silica", "silica", "quartz glass"],
        1.45846,
        resonances([0.696_166_3, 0.407_942_6, 0.897_479_4], [0.068_404_3, 0.116_241_4, 9.896_161]),
        "Malitson 1965",
    ),
    clear(
        &["soda lime", "window glass", "glass"],
        1.523,
        // Its formula has a term in the square of the wavelength; the Abbe number of that formula is 63.97.
        cauchy(1.510_971, 0.004_284_58, 0.0),
        "Rubin 1985, clear float glass",
    ),
    clear(&["borosilicate", "pyrex"], 1.474, Dispersion::None, "Corning 7740 data sheet, 589.3 nm"),
    clear(
        &["quartz", "rock crystal"],
        1.54426,
        glass([0.286_041_41, 1.070_440_83, 1.102_022_42], [0.0, 0.010_058_599_7, 100.0]),
        "Ghosh 1999, ordinary ray",
    ),
    clear(
        &["sapphire"],
        1.76817,
        resonances([1.431_349_3, 0.650_547_13, 5.341_402_1], [0.072_663_1, 0.119_324_2, 18.028_251]),
        "Malitson 1962, ordinary ray, V_d 72.3",
    ),
    clear(
        &["fluorite"],
        1.43385,
        resonances([0.567_588_8, 0.471_091_4, 3.848_472_3], [0.050_263_605, 0.100_390_9, 34.649_040]),
        "Malitson 1963, V_d 95.0",
    ),
    clear(&["diamond"], 2.417, resonances([0.3306, 4.3356, 0.0], [0.175, 0.106, 0.0]), "Peter 1923, 589 nm; V_d 55.3"),
    clear(
        &["cubic zirconia", "zirconia"],
        2.159,
        resonances([1.347_091, 2.117_788, 9.452_943], [0.062_543, 0.166_739, 24.320_570]),
        "Wood & Nassau 1982, V_d 33.5",
    ),
    clear(
        &["acrylic", "pmma", "plexiglass"],
        1.4906,
        glass([1.1819, 0.0, 0.0], [0.011_313, 0.0, 0.0]),
        "Sultanova 2009",
    ),
    clear(&["polycarbonate"], 1.585, glass([1.4182, 0.0, 0.0], [0.021_304, 0.0, 0.0]), "Sultanova 2009, V_d 27.9"),
    clear(&["amber"], 1.54, Dispersion::None, "gemmological tables, 1.539 to 1.545"),
    clear(&["ice"], 1.31, Dispersion::None, "Warren & Brandt 2008"),
    clear(
        &["water"],
        1.333,
        Dispersion::Sellmeier([
            [0.568_402_756_5, 0.005_101_829_712],
            [0.172_617_739_1, 0.018_211_539_36],
            [0.020_861_895_78, 0.026_207_222_93],
            [0.113_074_868_8, 10.697_927_21],
        ]),
        "Hale & Querry 1973; the curve from Daimon & Masumura 2007, V_d 55.8; 20 degrees C",
    ),
    clear(
        &["ethanol", "alcohol"],
        1.361,
        cauchy(1.352_65, 0.003_06, 0.000_02),
        "CRC handbook, 589.3 nm; the curve from Rheims 1997; 20 degrees C",
    ),
    clear(
        &["glycerol", "glycerine"],
        1.473,
        cauchy(1.457_97, 0.005_98, -0.000_36),
        "CRC handbook, 589.3 nm; the curve from Rheims 1997; 20 degrees C",
    ),
    clear(&["oil", "vegetable oil", "olive oil"], 1.47, Dispersion::None, "CRC handbook, 1.467 to 1.473"),
    clear(&["immersion oil"], 1.515, Dispersion::None, "ISO 8036, n_e 1.518"),
];

/// Metals, from the measured spectra of Palik, "Handbook of Optical Constants of Solids" (gold, silver, copper and
/// aluminium 1985, chromium 1991). The reflectance of white light (D65) was integrated over the spectrum against the
/// CIE 1931 matching functions, per channel of linear sRGB. `eta` and `k` reproduce that reflectance at normal
/// incidence, and approximate it best at all other angles: within 0.005. Gold's red lies outside the sRGB gamut
/// (1.021); its value is the highest reflectance that `eta` = 0.001 allows. `tests/optics/metals_by_spectrum.rs`
/// contains the spectra and the integration.
pub const METALS: &[Metal] = &[
    Metal { names: &["silver", "ag"], eta: Vec3::new(0.129_3, 0.125_2, 0.151_3), k: Vec3::new(4.105_8, 3.35, 2.412_3) },
    Metal { names: &["gold", "au"], eta: Vec3::new(0.001, 0.412_3, 1.564_8), k: Vec3::new(3.391_7, 2.348_5, 1.723_8) },
    Metal {
        names: &["copper", "cu"],
        eta: Vec3::new(0.172_6, 0.972_4, 1.210_4),
        k: Vec3::new(3.638_9, 2.624_7, 2.364_9),
    },
    Metal {
        names: &["aluminium", "aluminum", "al"],
        eta: Vec3::new(1.426_1, 0.929_8, 0.590_7),
        k: Vec3::new(7.727, 6.602_3, 5.360_3),
    },
    Metal {
        names: &["chromium", "chrome", "cr"],
        eta: Vec3::new(3.687, 3.08, 1.867_8),
        k: Vec3::new(4.289_5, 4.452_6, 4.131_3),
    },
];

/// Finds a transparent substance by name.
///
/// # Errors
/// Returns a message that suggests the nearest name.
pub fn transparent(name: &str) -> Result<&'static Transparent, String> {
    find(TRANSPARENT, |t| t.names, name, "glass or liquid")
}

/// Finds a metal by name.
///
/// # Errors
/// Returns a message that suggests the nearest name.
pub fn metal(name: &str) -> Result<&'static Metal, String> {
    find(METALS, |m| m.names, name, "metal")
}

fn find<T>(
    table: &'static [T],
    names: fn(&T) -> &'static [&'static str],
    name: &str,
    what: &str,
) -> Result<&'static T, String> {
    let plain = |s: &str| s.chars().filter(|c| !matches!(c, ' ' | '_' | '-')).collect::<String>().to_lowercase();
    let wanted = plain(name);
    table.iter().find(|entry| names(entry).iter().any(|n| plain(n) == wanted)).ok_or_else(|| {
        let all = table.iter().flat_map(|entry| names(entry).iter().copied());
        format!("no {what} is called `{name}`{}", hint(name, all))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_however_they_are_written_and_slips_get_a_hint() {
        assert_eq!(transparent("Fused_Silica").unwrap().ior, 1.45846);
        assert_eq!(transparent("N-BK7").unwrap().ior, 1.5168);
        assert_eq!(metal("Aluminum").unwrap().names[0], "aluminium");
        assert!(transparent("watr").unwrap_err().contains("`water`"));
        assert!(metal("sliver").unwrap_err().contains("`silver`"));
    }

    #[test]
    fn no_name_stands_for_two_substances() {
        let mut names: Vec<&str> = TRANSPARENT.iter().flat_map(|t| t.names).copied().collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|w| w[0] != w[1]));
    }
}
