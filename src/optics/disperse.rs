//! Spectral lines at which glass is measured, and the constants that catalogues derive from the indices there.

/// Wavelength of the yellow helium line d in air, in nanometres, at which the index of a glass is `n_d`.
pub const LINE_D: f64 = 587.5618;

/// Wavelength of the blue hydrogen line F in air, in nanometres.
pub const LINE_F: f64 = 486.1327;

/// Wavelength of the red hydrogen line C in air, in nanometres.
pub const LINE_C: f64 = 656.2725;

/// Abbe number `V_d = (n_d - 1) / (n_F - n_C)` of an index as a function of nanometres. Lower numbers mean more
/// dispersion; it is infinite without dispersion.
#[must_use]
pub fn abbe_number(index_at: impl Fn(f64) -> f64) -> f64 {
    (index_at(LINE_D) - 1.0) / (index_at(LINE_F) - index_at(LINE_C))
}

/// Returns Cauchy's `A` (without unit) and `B` (in µm²) of the curve `A + B / λ²` that has index `n_d` at the line d
/// and Abbe number `v_d` (not zero).
#[must_use]
pub fn cauchy_from_abbe(n_d: f64, v_d: f64) -> [f64; 2] {
    let per_square = |nm: f64| 1e6 / (nm * nm);
    let b = (n_d - 1.0) / v_d / (per_square(LINE_F) - per_square(LINE_C));
    [n_d - b * per_square(LINE_D), b]
}
