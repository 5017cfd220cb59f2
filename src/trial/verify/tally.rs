//! Results of test cases: counts, failures, and the figure nearest to its bound.

/// Largest number of failures described; further ones are only counted.
const EXAMPLES: usize = 6;

/// Figure with its bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// Name of the quantity, with its unit.
    pub what: &'static str,
    /// Measured value.
    pub value: f64,
    /// Upper bound; `None` if the figure is only reported.
    pub bound: Option<f64>,
}

impl Worst {
    /// Returns the figure relative to its bound, or the figure itself without a bound.
    fn share(&self) -> f64 {
        match self.bound {
            Some(bound) if bound > 0.0 => self.value / bound,
            _ => self.value,
        }
    }
}

/// Results of some test cases.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CaseCounts {
    /// Number of cases.
    pub cases: u64,
    /// Number of failures.
    pub failures: u64,
    /// Figure that is largest relative to its bound.
    pub worst: Option<Worst>,
    /// Descriptions of the first failures. Those with several lines contain the ray, each answer, and the command that
    /// repeats it.
    pub examples: Vec<String>,
    /// Number of rays left out because the work limit was reached.
    pub left_out: u64,
}

impl CaseCounts {
    /// Counts a case that passed.
    pub fn pass(&mut self) {
        self.cases += 1;
    }

    /// Counts a case; `say` describes its failure.
    pub fn check(&mut self, holds: bool, say: impl FnOnce() -> String) {
        self.cases += 1;
        if !holds {
            self.fail(say);
        }
    }

    /// Counts `cases` of one ray, `failures` of which failed; `say` describes them.
    pub fn check_all(&mut self, cases: u64, failures: u64, say: impl FnOnce() -> String) {
        self.cases += cases;
        if failures > 0 {
            self.fail(say);
            self.failures += failures - 1;
        }
    }

    /// Counts a failure of a case that is counted elsewhere.
    pub fn fail(&mut self, say: impl FnOnce() -> String) {
        self.failures += 1;
        if self.examples.len() < EXAMPLES {
            self.examples.push(say());
        }
    }

    /// Counts a case with a figure, which fails if the figure exceeds its bound or is NaN.
    pub fn measure(&mut self, what: &'static str, value: f64, bound: f64, say: impl FnOnce() -> String) {
        self.cases += 1;
        self.note(Worst { what, value, bound: Some(bound) });
        // Not `value > bound`, so that NaN fails, too.
        if !matches!(value.partial_cmp(&bound), Some(std::cmp::Ordering::Less | std::cmp::Ordering::Equal)) {
            self.fail(say);
        }
    }

    /// Keeps a figure if it is the worst so far.
    pub fn note(&mut self, figure: Worst) {
        let share = figure.share();
        if share.is_nan() || self.worst.as_ref().is_none_or(|w| share > w.share()) {
            self.worst = Some(figure);
        }
    }

    /// Adds the results of later cases.
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
