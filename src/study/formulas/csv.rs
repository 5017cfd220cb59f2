//! The figures as comma-separated values, one line per formula and range.

use std::fmt::Write as _;

use super::Formula;

/// Returns the whole table. Fields without a number are empty.
#[must_use]
pub fn csv(formulas: &[Formula]) -> String {
    let mut text = String::from(
        "kind,formula,range,ns_eight_f32,ns_one_f32,ns_one_f64,unit,compared,worst,worst_ulp,worst_relative,mean,\
         mean_ulp,mean_relative,worst_f64,misjudged,settled,noted,noted_ours,why\n",
    );
    let number = |x: Option<f64>| x.map(|x| x.to_string()).unwrap_or_default();
    for formula in formulas {
        let kind = formula.kind;
        let time = formula.time;
        for e in &formula.ranges {
            let noted = e.noted;
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{kind},\"{}\",\"{}\",{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},\"{}\"",
                formula.name,
                e.range,
                number(time.map(|t| t.eight)),
                number(time.map(|t| t.one)),
                number(time.map(|t| t.double)),
                formula.kind.unit(),
                e.compared,
                e.worst.absolute,
                e.worst.ulp,
                number(e.worst.relative),
                e.mean.absolute,
                e.mean.ulp,
                number(e.mean.relative),
                number(e.worst_f64),
                e.misjudged,
                e.settled,
                number(noted.map(|n| n.value)),
                number(noted.map(|n| n.ours)),
                noted.map_or("", |n| n.why),
            );
        }
    }
    text
}
