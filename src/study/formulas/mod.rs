//! One formula at a time: what it costs, in nanoseconds, and how far off it is, held against an oracle of twice the
//! digits of `f64`, over the ranges that matter.
//!
//! The errors are the same in every run: rays are drawn from a fixed seed. Times are this machine's.

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
    pub enum Kind("of", derive(Eq)) {
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

impl serde::Serialize for Kind {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl Kind {
    /// What its errors are.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Refraction | Self::Reflection => "rad",
            Self::Fresnel => "of 1",
            Self::Reciprocal | Self::Triangle => "of itself",
        }
    }
}

/// What is to be found out.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Rays drawn of each range, at least 8.
    pub count: usize,
    /// Whether formulas are timed, too.
    pub time: bool,
    /// Which formulas.
    pub kinds: Vec<Kind>,
}

/// A formula: what it costs, and how far off it is.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Formula {
    /// What it is of.
    pub kind: Kind,
    /// Its name, as in the option of the renderer that chooses it.
    pub name: String,
    /// Nanoseconds, where it was timed.
    pub time: Option<Time>,
    /// How far off it is, by range.
    pub ranges: Vec<Errors>,
}

/// How far off a formula is in one range.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Errors {
    /// The range.
    pub range: &'static str,
    /// Answers that were held against the oracle.
    pub compared: u64,
    /// The largest error in `f32`.
    pub worst: Off,
    /// The mean error in `f32`.
    pub mean: Off,
    /// The largest error in `f64`, in the kind's unit, where it was looked at.
    pub worst_f64: Option<f64>,
    /// Share that got no answer where there is one, or the other way round: total reflection misjudged, rays that slip
    /// through a closed mesh.
    pub misjudged: f64,
    /// Share that fell to `f64`.
    pub settled: f64,
    /// What was published or measured elsewhere for this range.
    pub noted: Option<Noted>,
}

/// An error in its units.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Off {
    /// In units of the last place: of the number itself, or of 1 for the components of a direction.
    pub ulp: f64,
    /// In the kind's unit.
    pub absolute: f64,
    /// In parts of the right answer, where that is a number.
    pub relative: Option<f64>,
}

/// A figure for the same thing from elsewhere: 80-bit arithmetic, without fused products.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct Noted {
    /// The figure.
    pub value: f64,
    /// Ours for it.
    pub ours: f64,
    /// Why the two differ by more than a factor of two, where they do; empty where they do not.
    pub why: &'static str,
}

impl Noted {
    /// Whether the two agree within a factor of two.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.value == self.ours || (self.ours <= 2.0 * self.value && self.value <= 2.0 * self.ours)
    }
}

/// Measures every formula asked for. `done` is called after each kind, and ends the work by saying so.
///
/// # Errors
/// `Interrupted`, where `done` says false.
pub fn measure(plan: &Plan, mut done: impl FnMut() -> bool) -> crate::Result<Vec<Formula>> {
    let mut formulas = Vec::new();
    for kind in &plan.kinds {
        formulas.extend(match kind {
            Kind::Refraction => refraction::measure(plan),
            Kind::Fresnel => fresnel::measure(plan),
            Kind::Reflection => reflection::measure(plan),
            Kind::Reciprocal => reciprocal::measure(plan),
            Kind::Triangle => triangle::measure(plan),
        });
        if !done() {
            return Err(Error::Interrupted);
        }
    }
    Ok(formulas)
}

/// The sum of errors over a range.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    compared: u64,
    worst: Off,
    sum: Off,
    worst_f64: f64,
    misjudged: u64,
    settled: u64,
    asked: u64,
}

impl Tally {
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
