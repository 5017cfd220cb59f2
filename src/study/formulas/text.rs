//! The figures for a terminal of 80 columns.

use super::{Errors, Formula, FormulaKind};

/// Largest number of formulas side by side in a table.
const ACROSS: usize = 5;

/// Returns the tables of every group: times and errors of its formulas in the first range, then the largest error by
/// range, and the differences from published figures.
#[must_use]
pub fn text(formulas: &[Formula]) -> String {
    let mut parts = Vec::new();
    for kind in FormulaKind::ALL {
        let of_kind: Vec<&Formula> = formulas.iter().filter(|f| f.kind == kind).collect();
        if of_kind.is_empty() {
            continue;
        }
        parts.push(costs(kind, &of_kind));
        parts.extend(of_kind.chunks(ACROSS).map(|some| by_range(kind, some)));
        if kind == FormulaKind::Triangle {
            parts.extend(of_kind.chunks(ACROSS).map(leaks));
        }
        let differing: Vec<String> =
            of_kind.iter().flat_map(|f| f.ranges.iter().filter_map(|e| differs(f, e))).collect();
        if !differing.is_empty() {
            parts.push(format!(
                "More than twice or less than half of what was noted elsewhere:\n{}",
                differing.join("\n")
            ));
        }
    }
    parts.join("\n\n")
}

fn costs(kind: FormulaKind, formulas: &[&Formula]) -> String {
    let first = formulas[0].ranges[0].range;
    let title = match kind {
        FormulaKind::Refraction => "Refracted direction",
        FormulaKind::Fresnel => "Reflectance",
        FormulaKind::Reflection => "Mirrored direction",
        FormulaKind::Reciprocal => "Reciprocal",
        FormulaKind::Triangle => "Ray/triangle test (error of t)",
    };
    let mut lines = vec![
        format!("{title}\n  nanoseconds; errors over `{first}` [{}]", kind.unit()),
        format!(
            "  {:<17} {:>7} {:>6} {:>6}  {:>8} {:>8} {:>6} {:>8}",
            "", "8 x f32", "f32", "f64", "worst", "mean", "ulp", "f64"
        ),
    ];
    for formula in formulas {
        let e = &formula.ranges[0];
        let ns = |x: Option<f64>| x.map_or(String::from("-"), |x| format!("{x:.1}"));
        let time = formula.time;
        lines.push(format!(
            "  {:<17} {:>7} {:>6} {:>6}  {:>8} {:>8} {:>6} {:>8}",
            formula.name,
            ns(time.map(|t| t.eight)),
            ns(time.map(|t| t.one)),
            ns(time.map(|t| t.double)),
            small(e.worst.absolute),
            small(e.mean.absolute),
            ulps(e.worst.ulp),
            e.worst_f64.map_or(String::from("-"), small),
        ));
    }
    lines.join("\n")
}

/// Returns the largest errors of several formulas in each range.
fn by_range(kind: FormulaKind, formulas: &[&Formula]) -> String {
    table(&format!("Largest error [{}]", kind.unit()), formulas, |e| small(e.worst.absolute))
}

fn leaks(formulas: &[&Formula]) -> String {
    let share = |x: f64| if x == 0.0 { String::from("0") } else { format!("{:.2}%", x * 100.0) };
    let lost = table("Rays lost by a closed mesh", formulas, |e| share(e.misjudged));
    let fell = table("Rays for which f64 was asked", formulas, |e| share(e.settled));
    format!("{lost}\n\n{fell}")
}

fn table(title: &str, formulas: &[&Formula], cell: impl Fn(&Errors) -> String) -> String {
    let heads: Vec<String> = formulas.iter().map(|f| format!("{:>7}", short(&f.name))).collect();
    let mut lines = vec![format!("  {:<35} {}", title, heads.join(" "))];
    for (r, range) in formulas[0].ranges.iter().enumerate() {
        let cells: Vec<String> = formulas.iter().map(|f| format!("{:>7}", cell(&f.ranges[r]))).collect();
        lines.push(format!("  {:<35} {}", range.range, cells.join(" ")));
    }
    lines.join("\n")
}

/// Head of a narrow column: the number in the formula's name, else the first letters of the name.
fn short(name: &str) -> String {
    name.find('=').map_or(name, |at| &name[at..]).chars().take(7).collect()
}

/// Returns a sentence on a figure that differs from the published one, if it does.
fn differs(formula: &Formula, errors: &Errors) -> Option<String> {
    let noted = errors.noted.filter(|n| !n.agrees())?;
    let place = format!("  {}, {}:", formula.name, errors.range);
    Some(format!("{place}\n    {} here, {} noted: {}", small(noted.ours), small(noted.value), noted.why))
}

fn small(x: f64) -> String {
    if x == 0.0 { String::from("0") } else { format!("{x:.1e}") }
}

fn ulps(x: f64) -> String {
    if x < 1e4 { format!("{x:.1}") } else { format!("{x:.0e}") }
}
