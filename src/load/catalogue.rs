//! Substances by name: refractive indices at the sodium-yellow line and metals' complex indices.
//!
//! Names are found whatever their case, spaces, underscores and hyphens.

use glam::Vec3;

use super::suggest::hint;

/// A transparent substance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transparent {
    /// Its names; the first is the usual one.
    pub names: &'static [&'static str],
    /// Refractive index against air, near 587.6 nm (helium d) unless the source says otherwise.
    pub ior: f64,
    /// Where the index is from.
    pub source: &'static str,
}

/// A metal, as three complex indices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal {
    /// Its names; the first is the usual one.
    pub names: &'static [&'static str],
    /// Real part of the index for red, green and blue.
    pub eta: Vec3,
    /// Imaginary part (extinction).
    pub k: Vec3,
}

const fn clear(names: &'static [&'static str], ior: f64, source: &'static str) -> Transparent {
    Transparent { names, ior, source }
}

/// Glasses, crystals, plastics and liquids.
pub const TRANSPARENT: &[Transparent] = &[
    clear(&["air", "vacuum"], 1.0, "by definition: indices here are against air"),
    clear(&["bk7", "n-bk7", "crown"], 1.51680, "Schott data sheet N-BK7, n_d"),
    clear(&["sf11", "n-sf11"], 1.78472, "Schott data sheet N-SF11, n_d"),
    clear(&["sf10", "n-sf10"], 1.72828, "Schott data sheet N-SF10, n_d"),
    clear(&["flint", "f2", "n-f2"], 1.62005, "Schott data sheet N-F2, n_d"),
    clear(&["fused silica", "silica", "quartz glass"], 1.45846, "Malitson 1965"),
    clear(&["soda lime", "window glass", "glass"], 1.523, "Rubin 1985, clear float glass"),
    clear(&["borosilicate", "pyrex"], 1.474, "Corning 7740 data sheet, 589.3 nm"),
    clear(&["quartz", "rock crystal"], 1.54426, "Ghosh 1999, ordinary ray"),
    clear(&["sapphire"], 1.76817, "Malitson 1962, ordinary ray"),
    clear(&["fluorite"], 1.43385, "Malitson 1963"),
    clear(&["diamond"], 2.417, "Peter 1923, 589 nm"),
    clear(&["cubic zirconia", "zirconia"], 2.159, "Wood & Nassau 1982"),
    clear(&["acrylic", "pmma", "plexiglass"], 1.4906, "Sultanova 2009"),
    clear(&["polycarbonate"], 1.585, "Sultanova 2009"),
    clear(&["amber"], 1.54, "gemmological tables, 1.539 to 1.545"),
    clear(&["ice"], 1.31, "Warren & Brandt 2008"),
    clear(&["water"], 1.333, "Hale & Querry 1973; 20 degrees C"),
    clear(&["ethanol", "alcohol"], 1.361, "CRC handbook; 20 degrees C, 589.3 nm"),
    clear(&["glycerol", "glycerine"], 1.473, "CRC handbook; 20 degrees C, 589.3 nm"),
    clear(&["oil", "vegetable oil", "olive oil"], 1.47, "CRC handbook, 1.467 to 1.473"),
    clear(&["immersion oil"], 1.515, "ISO 8036, n_e 1.518"),
];

/// Metals, from measured spectra weighted to linear sRGB (the table that Mitsuba and Tungsten use, after Palik 1985
/// and the SOPRA data base).
pub const METALS: &[Metal] = &[
    Metal {
        names: &["silver", "ag"],
        eta: Vec3::new(0.155_265, 0.116_723, 0.138_381),
        k: Vec3::new(4.828_343, 3.122_246, 2.147_05),
    },
    Metal {
        names: &["gold", "au"],
        eta: Vec3::new(0.143_119, 0.374_957, 1.442_479),
        k: Vec3::new(3.983_16, 2.385_721, 1.603_215),
    },
    Metal {
        names: &["copper", "cu"],
        eta: Vec3::new(0.200_438, 0.924_033, 1.102_212),
        k: Vec3::new(3.912_949, 2.452_848, 2.142_188),
    },
    Metal {
        names: &["aluminium", "aluminum", "al"],
        eta: Vec3::new(1.657_46, 0.880_369, 0.521_229),
        k: Vec3::new(9.223_869, 6.269_523, 4.837_001),
    },
    Metal {
        names: &["chromium", "chrome", "cr"],
        eta: Vec3::new(4.369_683, 2.916_702, 1.654_701),
        k: Vec3::new(5.206_434, 4.231_365, 3.754_947),
    },
];

/// The transparent substance of that name.
///
/// # Errors
/// A message that names the nearest one.
pub fn transparent(name: &str) -> Result<&'static Transparent, String> {
    find(TRANSPARENT, |t| t.names, name, "glass or liquid")
}

/// The metal of that name.
///
/// # Errors
/// A message that names the nearest one.
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
