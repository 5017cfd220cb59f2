//! The report for a terminal of 80 columns: a table, and time against error as a plot of characters.

use super::report::{Report, Row};
use crate::measure::Figure;

/// Columns and rows inside the frame of the plot.
const PLOT: [usize; 2] = [66, 16];

/// Returns the whole report.
#[must_use]
pub fn report(report: &Report) -> String {
    let mut text = heading(report);
    text += &table(report);
    text += &plot(&report.rows);
    if !report.left_out.is_empty() {
        text += "\nLeft out\n";
        text += &report.left_out.iter().map(|why| wrapped(why, "  ")).collect::<String>();
    }
    text
}

fn heading(report: &Report) -> String {
    let (m, s) = (&report.machine, &report.subject);
    let mut text = wrapped(&format!("{}, {} threads; Vitrum {} for {}", m.cpu, report.threads, m.vitrum, m.simd), "");
    text += &wrapped(&format!("{}, {} x {} pixels", s.scene, s.width, s.height), "");
    if let Some(default) = report.rows.first() {
        text += &wrapped(&format!("default: {}", default.levels), "");
        text += &format!("         {:.1} ms, {} rays\n", default.seconds.median * 1e3, default.rays.total);
    }
    if let Some(own) = &report.own {
        text += &wrapped(
            &format!(
                "errors are against f64, depth {}, cut-off {} ({:.1} s; cut: {:.1e} in the mean)",
                own.variant.depth, own.variant.cutoff, own.seconds, own.cut
            ),
            "",
        );
    }
    if let Some(fine) = &report.fine {
        text += &wrapped(&format!("rows with ^ are against 16 x 16 rays a pixel ({})", fine.variant), "");
    }
    text
}

fn table(report: &Report) -> String {
    let mut text = format!(
        "\n{:<2}{:<24}{:>7} {:>13}{:>9}{:>9}{:>7}{:>8}\n",
        "", "", "time", "interval", "RMSE", "max", ">1/255", "light"
    );
    let mut marks = marks(&report.rows).into_iter();
    for row in &report.rows {
        let mark = marks.next().flatten().map_or(' ', |c| c);
        let interval = within(&row.ratio, row.same_time);
        let cells = row.judged().map_or_else(Default::default, |e| {
            let sure = e.apart.is_none_or(|a| a.sure);
            let max = format!("{}{:.1e}", if sure { "" } else { "<" }, e.apart.map_or(e.max, |a| a.max));
            [format!("{:.1e}", e.ranked()), max, percent(e.visible)]
        });
        let [rmse, max, visible] = cells;
        let rmse = if row.own.is_none() && row.fine.is_some() { format!("^{rmse}") } else { rmse };
        let light = format!("{:+.2}%", row.ledger.error() * 100.0);
        let mut names = name_lines(&row.name).into_iter();
        let first = names.next().unwrap_or_default();
        let time = if row.is_default { String::from("1") } else { short(row.ratio.median) };
        text += &format!("{mark:<2}{first:<24}{time:>7} {interval:>13}{rmse:>9}{max:>9}{visible:>7}{light:>8}\n");
        for more in names {
            text += &format!("    {more}\n");
        }
        if let Some(walk) = row.walk.filter(|_| row.levels.plain_walk() != Some(row.levels)) {
            let interval = within(&walk, walk.may_be(1.0));
            text += &format!("    {:<22}{:>7} {interval:>13}\n", "over watertight's walk", short(walk.median));
        }
        if let Some(settled) = row.settled.filter(|share| *share > 0.0) {
            text += &format!("    {settled:.1e} of its triangle tests fell to f64\n");
        }
    }
    text += "letters: on the front, nothing is both faster and more right\n";
    text += "=: no measurable difference in time; RMSE and max without ill-conditioned pixels\n";
    if report.rows.iter().any(|r| r.judged().and_then(|e| e.apart).is_some_and(|a| !a.sure)) {
        text += "<: at most, since time ran out before every worse pixel was asked\n";
    }
    if report.rows.iter().any(|r| r.walk.is_some()) {
        text += "triangles, reciprocal: one ray at a time; compare them with one another\n";
    }
    text
}

/// Breaks a name into lines of at most 23 characters, between words.
fn name_lines(name: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in name.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= 23 => {
                line.push(' ');
                *line += word;
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Writes the interval of a figure in at most 13 characters, or `same` if it may be 1.
fn within(figure: &Figure, same: bool) -> String {
    let number = |x: f64| match x {
        _ if x < 10.0 => format!("{x:.2}"),
        _ if x < 100.0 => format!("{x:.1}"),
        _ => format!("{x:.0}"),
    };
    let [low, high] = figure.interval.map(number);
    match figure.runs {
        1 => String::from("1 run"),
        2 => String::from("2 runs"),
        _ => format!("{}{low}..{high}", if same { "= " } else { "" }),
    }
}

fn short(ratio: f64) -> String {
    if ratio < 10.0 { format!("{ratio:.3}") } else { format!("{ratio:.1}") }
}

fn percent(share: f64) -> String {
    let p = share * 100.0;
    if p == 0.0 || p >= 9.95 { format!("{p:.0}%") } else { format!("{p:.2}%") }
}

/// Letters for the rows on the front, in the order of time; none for the others.
fn marks(rows: &[Row]) -> Vec<Option<char>> {
    let mut on: Vec<usize> = (0..rows.len()).filter(|&i| rows[i].front).collect();
    on.sort_by(|&a, &b| rows[a].ratio.median.total_cmp(&rows[b].ratio.median));
    let mut marks = vec![None; rows.len()];
    for (i, letter) in on.into_iter().zip(('a'..='z').chain('A'..='Z').chain(std::iter::repeat('*'))) {
        marks[i] = Some(letter);
    }
    marks
}

/// Plots time against error, both in decades, for variants with the default's rays per pixel.
fn plot(rows: &[Row]) -> String {
    let marks = marks(rows);
    let points: Vec<(f64, f64, char)> = rows
        .iter()
        .zip(marks)
        .filter_map(|(r, mark)| {
            let error = r.own.as_ref()?.ranked();
            let c = mark.unwrap_or(if r.is_default { 'D' } else { '.' });
            (error > 0.0).then_some((r.ratio.median.log10(), error.log10(), c))
        })
        .collect();
    if points.len() < 2 {
        return String::new();
    }
    let range = |of: fn(&(f64, f64, char)) -> f64| {
        let (lo, hi) = points.iter().map(of).fold((f64::MAX, f64::MIN), |(lo, hi), x| (lo.min(x), hi.max(x)));
        (lo, (hi - lo).max(0.01))
    };
    let ((x0, dx), (y0, dy)) = (range(|p| p.0), range(|p| p.1));
    let [columns, lines] = PLOT;
    let mut grid = vec![vec![' '; columns]; lines];
    // The front is drawn last, over the other points.
    let (front, others): (Vec<_>, Vec<_>) = points.into_iter().partition(|p| p.2 != '.');
    for (x, y, c) in others.into_iter().chain(front) {
        let column = ((x - x0) / dx * (columns - 1) as f64).round() as usize;
        let line = lines - 1 - ((y - y0) / dy * (lines - 1) as f64).round() as usize;
        grid[line][column] = c;
    }
    let mut text = String::from("\nRMSE\n");
    for (i, line) in grid.iter().enumerate() {
        let value = 10.0_f64.powf(y0 + dy * (lines - 1 - i) as f64 / (lines - 1) as f64);
        let label = if i % 5 == 0 { format!("{value:.1e}") } else { String::new() };
        text += format!("{label:>8} |{}", line.iter().collect::<String>()).trim_end();
        text.push('\n');
    }
    let (left, right) = (10.0_f64.powf(x0), 10.0_f64.powf(x0 + dx));
    text += &format!("{:>8} +{}\n", "", "-".repeat(columns));
    let (left, right) = (format!("{left:.2}"), format!("{right:.2} times the default's time"));
    text += &format!("{:>10}{left}{right:>width$}\n", "", width = columns - left.len());
    text + "          D: default, where it is not on the front\n"
}

/// Breaks `text` into lines of at most 80 columns; all but the first are indented.
fn wrapped(text: &str, indent: &str) -> String {
    let mut out = String::new();
    let mut line = indent.to_owned();
    for word in text.split_whitespace() {
        if line.chars().count() + 1 + word.chars().count() > 80 && line.trim() != "" {
            out += line.trim_end();
            out.push('\n');
            line = format!("{indent}    ");
        }
        line += word;
        line.push(' ');
    }
    out + line.trim_end() + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_are_broken_between_words() {
        assert_eq!(name_lines("default"), ["default"]);
        assert_eq!(name_lines("fresnel schlick, depth 4, cutoff 1/16"), ["fresnel schlick, depth", "4, cutoff 1/16"]);
        assert_eq!(name_lines("refraction oliveira c=0.6645"), ["refraction oliveira", "c=0.6645"]);
        assert_eq!((percent(0.0), percent(0.001), percent(0.5)), ("0%".into(), "0.10%".into(), "50%".into()));
        let figure = |interval, runs| Figure { median: 1.0, interval, confidence: 0.97, runs };
        assert_eq!(within(&figure([0.567, 217.81], 6), true), "= 0.57..218");
        assert_eq!(
            (within(&figure([17.98, 19.16], 6), false), within(&figure([1.0, 2.0], 2), true)),
            ("18.0..19.2".into(), "2 runs".into())
        );
        assert!(
            wrapped(&"word ".repeat(40), "  ")
                .lines()
                .all(|l| l.len() <= 80 && l.starts_with("  w") || l.starts_with("      "))
        );
    }
}
