//! `vitrum price --formulas`.

pub(super) mod args;
pub(super) mod options;

use std::sync::Arc;
use std::sync::atomic::Ordering;

use self::options::Formulas;
use super::verdict::Verdict;
use super::{interrupt, output};
use crate::Result;
use crate::render::Observer;
use crate::simd::level;
use crate::study::formulas;

/// Result in the form of the JSON output.
#[derive(serde::Serialize)]
struct Report {
    version: &'static str,
    simd: &'static str,
    fused: bool,
    cpu: String,
    /// Number of rays drawn from each range.
    count: usize,
    formulas: Vec<formulas::Formula>,
}

/// Measures and prints the tables.
pub(super) fn run(job: &Formulas) -> Result<Verdict> {
    let observer = Arc::new(Observer::default());
    interrupt::listen(&observer)?;
    let measured = interrupt::heeded(|| formulas::measure(&job.plan, || !observer.stop.load(Ordering::SeqCst)))?;
    if job.csv {
        output::print(&formulas::csv(&measured))?;
    } else if job.json {
        output::print_json(&Report {
            version: env!("CARGO_PKG_VERSION"),
            simd: level::BUILT,
            fused: crate::math::FUSED,
            cpu: crate::measure::machine::cpu(),
            count: job.plan.count,
            formulas: measured,
        })?;
    } else {
        output::print(&(formulas::text(&measured) + "\n"))?;
    }
    Ok(Verdict::Done)
}
