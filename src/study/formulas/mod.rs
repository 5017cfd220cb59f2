//! Time and accuracy of single formulas: nanoseconds per evaluation, and errors against an oracle with twice the digits
//! of `f64`, over ranges of media and angles.
//!
//! The errors are the same in every run, because rays are drawn from a fixed seed. Times are those of this machine.

mod csv;
mod evaluate;
mod fresnel;
mod ranges;
mod reciprocal;
mod reflection;
mod refraction;
mod text;
mod timing;
mod triangle;

pub use csv::csv;
pub use text::text;
pub use timing::Time;

use crate::Error;

crate::choice! {
    /// Groups of formulas.
    pub enum FormulaKind("of", derive(Eq)) {
        /// Refracted directions; errors are angles in radians.
        "refraction" => Refraction,
        /// Reflectances; errors are differences of the reflectance.
        "fresnel" => Fresnel,
        /// Mirrored directions; errors are angles in radians.
        "reflection" => Reflection,
        /// Reciprocals; errors are relative.
        "reciprocal" => Reciprocal,
        /// Ray/triangle tests; errors of t are relative.
        "triangle" => Triangle,
    }
}

impl serde::Serialize for FormulaKind {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl FormulaKind {
    /// Unit of the group's errors.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Refraction | Self::Reflection => "rad",
            Self::Fresnel => "of 1",
            Self::Reciprocal | Self::Triangle => "of itself",
        }
    }
}

/// Formulas to measure, and the effort.
#[derive(Clone, Debug)]
pub struct FormulaPlan {
    /// Number of rays drawn from each range, at least 8.
    pub count: usize,
    /// True if formulas are timed as well.
    pub time: bool,
    /// Groups to measure.
    pub kinds: Vec<FormulaKind>,
}

/// Time and errors of a formula.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Formula {
    /// Group of the formula.
    pub kind: FormulaKind,
    /// Name, as in the option of the renderer that chooses it.
    pub name: String,
    /// Nanoseconds, if it was timed.
    pub time: Option<Time>,
    /// Errors by range.
    pub ranges: Vec<Errors>,
}

/// Errors of a formula in one range.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Errors {
    /// Name of the range.
    pub range: &'static str,
    /// Number of answers compared with the oracle.
    pub compared: u64,
    /// Largest error in `f32`.
    pub worst: Off,
    /// Mean error in `f32`.
    pub mean: Off,
    /// Largest error in `f64`, in the group's unit, if it was measured.
    pub worst_f64: Option<f64>,
    /// Share of answers that exist although they should not, or are missing: total reflection misjudged, rays that slip
    /// through a closed mesh.
    pub misjudged: f64,
    /// Share that fell back to `f64`.
    pub settled: f64,
    /// Figure published or measured elsewhere for this range.
    pub noted: Option<Noted>,
}

/// An error in several units.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Off {
    /// In ulps of the right answer, or of 1 for the components of a direction.
    pub ulp: f64,
    /// In the group's unit.
    pub absolute: f64,
    /// Relative to the right answer, if that is a number.
    pub relative: Option<f64>,
}

/// Figure from elsewhere, measured with 80-bit arithmetic and without fused products, and ours.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct Noted {
    /// Figure from elsewhere.
    pub value: f64,
    /// Figure measured here.
    pub ours: f64,
    /// Reason why the two differ by more than a factor of two; empty if they do not.
    pub why: &'static str,
}

impl Noted {
    /// Returns true if the two agree within a factor of two.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.value == self.ours || (self.ours <= 2.0 * self.value && self.value <= 2.0 * self.ours)
    }
}

/// Measures every formula of the groups in `plan`. `done` is called after each group; it returns false to end the work.
///
/// # Errors
/// `Interrupted` if `done` returns false.
pub fn measure(plan: &FormulaPlan, mut done: impl FnMut() -> bool) -> crate::Result<Vec<Formula>> {
    let mut formulas = Vec::new();
    for kind in &plan.kinds {
        formulas.extend(match kind {
            FormulaKind::Refraction => refraction::measure(plan),
            FormulaKind::Fresnel => fresnel::measure(plan),
            FormulaKind::Reflection => reflection::measure(plan),
            FormulaKind::Reciprocal => reciprocal::measure(plan),
            FormulaKind::Triangle => triangle::measure(plan),
        });
        if !done() {
            return Err(Error::Interrupted);
        }
    }
    Ok(formulas)
}

/// Errors accumulated over a range.
#[derive(Clone, Copy, Debug, Default)]
struct ErrorSums {
    compared: u64,
    worst: Off,
    sum: Off,
    worst_f64: f64,
    misjudged: u64,
    settled: u64,
    asked: u64,
}

impl ErrorSums {
    fn add(&mut self, ulp: f64, absolute: f64, relative: Option<f64>) {
        self.compared += 1;
        let both = |a: Option<f64>, b: Option<f64>, f: fn(f64, f64) -> f64| match (a, b) {
            (Some(a), Some(b)) => Some(f(a, b)),
            (a, b) => a.or(b),
        };
        self.worst = Off {
            ulp: self.worst.ulp.max(ulp),
            absolute: self.worst.absolute.max(absolute),
            relative: both(self.worst.relative, relative, f64::max),
        };
        self.sum = Off {
            ulp: self.sum.ulp + ulp,
            absolute: self.sum.absolute + absolute,
            relative: both(self.sum.relative, relative, |a, b| a + b),
        };
    }

    fn errors(&self, range: &'static str) -> Errors {
        let n = self.compared.max(1) as f64;
        Errors {
            range,
            compared: self.compared,
            worst: self.worst,
            mean: Off {
                ulp: self.sum.ulp / n,
                absolute: self.sum.absolute / n,
                relative: self.sum.relative.map(|x| x / n),
            },
            worst_f64: (self.worst_f64 > 0.0).then_some(self.worst_f64),
            misjudged: self.misjudged as f64 / self.asked.max(1) as f64,
            settled: self.settled as f64 / self.asked.max(1) as f64,
            noted: None,
        }
    }
}
