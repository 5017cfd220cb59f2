//! Reader of a material's refractive index and dispersion.

use super::table::{Table, Value};
use crate::Result;
use crate::load::catalogue;
use crate::optics::{LINE_D, VISIBLE, cauchy_from_abbe};
use crate::scene::Dispersion;

/// Reads `ior`, or the index of the named `glass`.
pub(super) fn ior(table: &Table<'_>, default: Option<f64>) -> Result<f64> {
    match (table.get("ior"), table.get("glass")) {
        (Some(v), None) => v.ior(),
        (None, Some(v)) => Ok(catalogue::transparent(v.text()?).map_err(|e| v.error(e))?.ior),
        (Some(_), Some(v)) => Err(v.error("give either `ior` or `glass`, not both")),
        (None, None) => {
            default.ok_or_else(|| table.error(format!("{} of this type needs `ior` or `glass`", table.what)))
        }
    }
}

/// Reads a dielectric's index at the line d and its curve, from `ior` or `glass` with `abbe`, `cauchy` or `sellmeier`.
/// The curve of a named glass is used if `dispersion = true`.
pub(super) fn index(table: &Table<'_>) -> Result<(f64, Dispersion)> {
    let wanted = table.opt("dispersion", Value::boolean)?;
    let abbe = table.get("abbe");
    let (cauchy, sellmeier) = (table.get("cauchy"), table.get("sellmeier"));
    let (at, n_d, curve) = match (cauchy, sellmeier) {
        (Some(_), Some(v)) => return Err(v.error("give either `cauchy` or `sellmeier`, not both")),
        (Some(v), None) | (None, Some(v)) => {
            for key in ["ior", "glass", "abbe"] {
                if let Some(other) = table.get(key) {
                    return Err(
                        other.error(format!("`{}` gives the index at every wavelength; leave `{key}` out", v.key()))
                    );
                }
            }
            let curve = if v.key() == "cauchy" { cauchy_series(&v)? } else { sellmeier_terms(&v)? };
            let n_d = curve.index_at(LINE_D).unwrap_or(1.0);
            (Some(v), n_d, curve)
        }
        (None, None) => {
            let ior = ior(table, None)?;
            match (abbe, table.get("glass")) {
                (Some(v), _) => {
                    let number = v.number_where("from 5 to 1000", |x| (5.0..=1000.0).contains(&x))?;
                    let [a, b] = cauchy_from_abbe(ior, number);
                    (Some(v), ior, Dispersion::Cauchy([a, b, 0.0]))
                }
                (None, Some(v)) if wanted == Some(true) => {
                    let known = catalogue::transparent(v.text()?).map_err(|e| v.error(e))?;
                    let Some(n_d) = known.dispersion.index_at(LINE_D) else {
                        let name = known.names[0];
                        return Err(v.error(format!(
                            "the dispersion of `{name}` is not known; give its Abbe number as `abbe`"
                        )));
                    };
                    (Some(v), n_d, known.dispersion)
                }
                _ => (None, ior, Dispersion::None),
            }
        }
    };
    let Some(value) = at else {
        if let (Some(true), Some(v)) = (wanted, table.get("dispersion")) {
            return Err(v.error(
                "`ior` alone does not define the dispersion; give `abbe`, `cauchy` or `sellmeier`, or a `glass`",
            ));
        }
        return Ok((n_d, Dispersion::None));
    };
    check(&value, &curve)?;
    let [violet, red] = VISIBLE.map(|nm| curve.index_at(nm));
    Ok((n_d, if wanted == Some(false) || violet == red { Dispersion::None } else { curve }))
}

fn cauchy_series(v: &Value<'_>) -> Result<Dispersion> {
    let given = v.list()?;
    if !(2..=3).contains(&given.len()) {
        return Err(v.error(format!("`cauchy` is [A, B] or [A, B, C], not a list of {}", given.len())));
    }
    let mut series = [0.0; 3];
    for (coefficient, value) in series.iter_mut().zip(&given) {
        *coefficient = value.number()?;
    }
    Ok(Dispersion::Cauchy(series))
}

fn sellmeier_terms(v: &Value<'_>) -> Result<Dispersion> {
    let given = v.list()?;
    if !(1..=4).contains(&given.len()) {
        return Err(v.error(format!("`sellmeier` is a list of one to four pairs [B, C], not of {}", given.len())));
    }
    let mut terms = [[0.0; 2]; 4];
    for (term, value) in terms.iter_mut().zip(&given) {
        *term = value.numbers()?;
    }
    Ok(Dispersion::Sellmeier(terms))
}

/// Refuses a curve that leaves the range of indices, or rises with the wavelength, anywhere in the visible range. A
/// substance absorbs where its index rises, so its index alone does not determine its look.
fn check(v: &Value<'_>, curve: &Dispersion) -> Result<()> {
    let mut last = f64::INFINITY;
    for nm in VISIBLE[0] as u32..=VISIBLE[1] as u32 {
        let index = curve.index_at(f64::from(nm)).unwrap_or(1.0);
        if !(1e-3..=1e3).contains(&index) {
            let message =
                format!("`{}` makes the index {index} at {nm} nm; it must be between 0.001 and 1000", v.key());
            return Err(v.error(message));
        }
        if index > last {
            let message = format!(
                "`{}` makes the index rise from {last} to {index} at {nm} nm; it must not rise with the wavelength \
                 where light is seen",
                v.key()
            );
            return Err(v.error(message));
        }
        last = index;
    }
    Ok(())
}
