//! The report as a page of bar charts without references to other files.

use std::fmt::Write as _;

use super::contender::Mode;
use super::report::{Report, Row};
use crate::accel::Backend;
use crate::measure::html::escaped;

/// Width of the longest bar, in pixels.
const BAR: f64 = 420.0;

/// Height of a line of the chart, in pixels.
const LINE: f64 = 18.0;

/// Left end of bars, in pixels.
const LEFT: f64 = 200.0;

/// Colours of the back ends, in the order of [`Report::backends`].
const COLOURS: [&str; 3] = ["#2f6fb3", "#c8842a", "#8a8f98"];

/// Returns the page: a chart for each mesh and number of threads, and the build figures.
#[must_use]
pub fn page(report: &Report) -> String {
    let machine = &report.machine;
    let embree = match &machine.embree {
        Some(e) => format!("Embree {} ({}, {} tasking)", e.version, e.isa, e.tasking),
        None => String::from("<strong>without Embree</strong>"),
    };
    let mut text = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>Vitrum: rays a second</title>\n<style>\n\
         body {{ font: 14px/1.4 system-ui, sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em; color: #222; }}\n\
         table {{ border-collapse: collapse; }} td, th {{ padding: 2px 12px; text-align: right; }}\n\
         td:first-child, th:first-child {{ text-align: left; }} svg {{ max-width: 100%; height: auto; }}\n\
         svg text {{ font: 12px system-ui, sans-serif; fill: #222; }}\n</style>\n</head>\n<body>\n\
         <h1>Rays a second</h1>\n<p>{}, {} processors; Vitrum {} built for {}; {embree}. Every contender traces the \
         same rays, by turns; bars are medians over the rounds, whiskers the 10th to the 90th percentile. For Embree \
         the best mode is shown, by its name.</p>\n",
        escaped(&machine.cpu),
        machine.processors,
        escaped(machine.vitrum),
        escaped(machine.simd)
    );
    for mesh in report.meshes() {
        let _ = writeln!(text, "<h2>{}, {} triangles</h2>", escaped(mesh), report.triangles(mesh));
        for threads in report.threads() {
            let _ = writeln!(text, "<h3>Mrays/s, threads: {threads}</h3>");
            text += &chart(report, mesh, threads);
        }
        text += &builds(report, mesh);
    }
    text + "</body>\n</html>\n"
}

/// Returns the row to draw for each back end: native as renders use it, Embree's fastest.
fn shown<'a>(report: &'a Report, mesh: &'a str, kind: &'a str, threads: usize) -> Vec<(usize, &'a Row)> {
    let backends = report.backends();
    let best = |(k, backend): (usize, &Backend)| {
        let rows = report.rows_of(mesh, kind, threads).filter(|r| r.backend == *backend);
        let row = rows
            .filter(|r| *backend != Backend::Native || r.mode == Mode::Auto)
            .max_by(|a, b| a.mrays_per_s.total_cmp(&b.mrays_per_s))?;
        Some((k, row))
    };
    backends.iter().enumerate().filter_map(best).collect()
}

fn chart(report: &Report, mesh: &str, threads: usize) -> String {
    let kinds = report.kinds();
    let groups: Vec<_> = kinds.iter().map(|kind| (*kind, shown(report, mesh, kind, threads))).collect();
    let all = || groups.iter().flat_map(|(_, rows)| rows);
    let most = all().map(|(_, r)| r.spread[1].max(r.mrays_per_s)).fold(f64::MIN_POSITIVE, f64::max);
    let scale = BAR / most;
    let height = LINE * (all().count() + groups.len()) as f64;
    let width = LEFT + BAR + 130.0;
    let mut text = format!(
        "<svg viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" role=\"img\" \
         aria-label=\"Mrays/s by kind of rays\">\n"
    );
    let mut y = 0.0;
    for (kind, rows) in &groups {
        for (i, (colour, row)) in rows.iter().enumerate() {
            let (middle, length) = (y + LINE * 0.5, row.mrays_per_s * scale);
            let name = format!("{} {}", row.backend.mode_name(), row.mode.name());
            if i == 0 {
                let _ = writeln!(text, "<text x=\"0\" y=\"{:.1}\" font-weight=\"bold\">{kind}</text>", middle + 4.0);
            }
            let ratio = report.ratios_of(mesh, kind, threads).find(|r| r.against == row.backend);
            let ratio = ratio.map_or_else(String::new, |r| format!(" (native {:.2} x)", r.ratio));
            let colour = COLOURS[*colour % COLOURS.len()];
            let [low, high] = row.spread.map(|s| LEFT + s * scale);
            let _ = writeln!(
                text,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{name}</text>\n\
                 <rect x=\"{LEFT}\" y=\"{:.1}\" width=\"{length:.1}\" height=\"{:.1}\" fill=\"{colour}\"/>\n\
                 <path d=\"M{low:.1} {middle:.1}H{high:.1}\" stroke=\"#222\"/>\n\
                 <text x=\"{:.1}\" y=\"{:.1}\">{:.2}{ratio}</text>",
                LEFT - 6.0,
                middle + 4.0,
                y + 2.0,
                LINE - 4.0,
                high.max(LEFT + length) + 6.0,
                middle + 4.0,
                row.mrays_per_s,
            );
            y += LINE;
        }
        y += LINE;
    }
    text + "</svg>\n"
}

fn builds(report: &Report, mesh: &str) -> String {
    let mut text = String::from(
        "<h3>Build</h3>\n<table>\n<tr><th>back end</th><th>quality</th><th>threads</th><th>ms</th>\
         <th>bytes a triangle</th></tr>\n",
    );
    for b in report.builds.iter().filter(|b| b.mesh == mesh) {
        let _ = writeln!(
            text,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{:.1}</td><td>{:.1}</td></tr>",
            b.backend.mode_name(),
            b.quality,
            b.threads,
            b.ms,
            b.bytes_per_triangle
        );
    }
    text + "</table>\n"
}

#[cfg(test)]
mod tests {
    use super::super::report::example;
    use super::*;

    #[test]
    fn the_page_loads_nothing_and_escapes_names() {
        let text = page(&example());
        assert!(text.contains("a&lt;b, 69630 triangles") && !text.contains("a<b"));
        for foreign in ["http", "src=", "href=", "@import", "url(", "<script", "<link"] {
            assert!(!text.contains(foreign), "{foreign}");
        }
    }

    #[test]
    fn bars_are_as_long_as_their_figures() {
        let text = page(&example());
        // The longest whisker, 27.5, is 420 pixels: 20 are 305.5, 16 are 244.4, 25 are 381.8.
        for bar in ["width=\"305.5\"", "width=\"244.4\"", "width=\"381.8\""] {
            assert!(text.contains(bar), "{bar} in {text}");
        }
        // Only Embree's fastest row, not the 15.0 of its `auto`.
        assert_eq!(text.matches("<rect").count(), 5);
        assert!(text.contains("16.00 (native 1.25 x)") && text.matches("<svg").count() == 1);
    }
}
