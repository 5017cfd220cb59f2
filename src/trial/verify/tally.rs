//! Cases, failures, and the figure that came nearest to its bound.

/// Failures told one by one; the rest is only counted.
const EXAMPLES: usize = 6;

/// A figure beside its bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// What was measured, with its unit.
    pub what: &'static str,
    /// The figure.
    pub value: f64,
    /// What it must not exceed; none where it is reported only.
    pub bound: Option<f64>,
}

impl Worst {
    /// How much of its bound the figure takes up; of a figure without a bound, the figure.
    fn share(&self) -> f64 {
        match self.bound {
            Some(bound) if bound > 0.0 => self.value / bound,
            _ => self.value,
        }
    }
}

/// What some cases came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Cases tried.
    pub cases: u64,
    /// Those that fell short.
    pub failures: u64,
    /// The figure that takes up the most of its bound.
    pub worst: Option<Worst>,
    /// The first few failures, in words; one with several lines has the ray, what each path answers, and how to repeat it.
    pub examples: Vec<String>,
    /// Rays that were left out because they and those before them meet too many shapes at once.
    pub left_out: u64,
}

impl Tally {
    /// Counts a case that came out well.
    pub fn pass(&mut self) {
        self.cases += 1;
    }

    /// Counts a case that may have fallen short; `say` tells of it.
    pub fn check(&mut self, holds: bool, say: impl FnOnce() -> String) {
        self.cases += 1;
        if !holds {
            self.fail(say);
        }
    }

    /// Counts `cases` of one ray, of which so many fell short; `say` tells of all of them.
    pub fn check_all(&mut self, cases: u64, failures: u64, say: impl FnOnce() -> String) {
        self.cases += cases;
        if failures > 0 {
            self.fail(say);
            self.failures += failures - 1;
        }
    }

    /// Counts a shortcoming of a case that is counted elsewhere.
    pub fn fail(&mut self, say: impl FnOnce() -> String) {
        self.failures += 1;
        if self.examples.len() < EXAMPLES {
            self.examples.push(say());
        }
    }

    /// Counts a case with a figure, which falls short where it exceeds its bound or is NaN.
    pub fn measure(&mut self, what: &'static str, value: f64, bound: f64, say: impl FnOnce() -> String) {
        self.cases += 1;
        self.note(Worst { what, value, bound: Some(bound) });
        // Not `value > bound`: a NaN falls short, too.
        if !matches!(value.partial_cmp(&bound), Some(std::cmp::Ordering::Less | std::cmp::Ordering::Equal)) {
            self.fail(say);
        }
    }

    /// Keeps a figure where it is the worst so far.
    pub fn note(&mut self, figure: Worst) {
        let share = figure.share();
        if share.is_nan() || self.worst.as_ref().is_none_or(|w| share > w.share()) {
            self.worst = Some(figure);
        }
    }

    /// Adds what came after.
    pub fn merge(&mut self, o: Self) {
        self.cases += o.cases;
        self.failures += o.failures;
        self.left_out += o.left_out;
        if let Some(worst) = o.worst {
            self.note(worst);
        }
        let room = EXAMPLES.saturating_sub(self.examples.len());
        self.examples.extend(o.examples.into_iter().take(room));
    }
}
