//! Plot of the cost of size: rays per second, and nanoseconds of building per triangle, against the number of
//! triangles.

use super::contender::Mode;
use super::report::Report;
use crate::accel::Backend;

/// Colours of the lines, in turn.
const COLOURS: [&str; 4] = ["#0b6e99", "#c0561f", "#4e9f3d", "#8a4fb0"];
const DASH: [&str; 2] = ["", "6 4"];

/// Width of a panel, in pixels.
const WIDTH: f64 = 420.0;
const HEIGHT: f64 = 260.0;

/// A line of a plot; the x axis is the number of triangles.
struct Line {
    name: String,
    points: Vec<(f64, f64)>,
}

/// Returns an SVG of two panels with logarithmic axes, from a report over meshes of one family.
#[must_use]
pub fn svg(report: &Report) -> String {
    let rates = panel(&rates(report), "million rays a second, one thread", 0.0);
    let builds = panel(&builds(report), "ns of building a triangle, one thread", WIDTH + 110.0);
    let (width, height) = (2.0 * WIDTH + 240.0, HEIGHT + 170.0);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{rates}{builds}</svg>\n"
    )
}

/// Median rates by number of triangles, for each kind of rays: native auto and the fastest mode of robust Embree.
fn rates(report: &Report) -> Vec<Line> {
    let mut lines = Vec::new();
    for kind in report.kinds() {
        for backend in [Backend::Native, Backend::Embree] {
            let best = |mesh: &&str| {
                let of = report.rows_of(mesh, kind, 1).filter(|r| r.backend == backend);
                let rate = of.filter(|r| backend != Backend::Native || r.mode == Mode::Auto).map(|r| r.mrays_per_s);
                rate.max_by(f64::total_cmp).map(|rate| (report.triangles(mesh) as f64, rate))
            };
            let points: Vec<_> = report.meshes().iter().filter_map(best).collect();
            lines.push(Line { name: format!("{kind}, {}", backend.mode_name()), points });
        }
    }
    lines.retain(|l| !l.points.is_empty());
    lines
}

/// Nanoseconds per triangle by number of triangles, and an n log n curve through the first native point.
fn builds(report: &Report) -> Vec<Line> {
    let of = |backend: Backend| {
        let of = report.builds.iter().filter(move |b| b.backend == backend && b.threads == 1);
        let point = |b: &super::report::Build| {
            let n = report.triangles(&b.mesh) as f64;
            (n, b.ms * 1e6 / n)
        };
        Line { name: backend.mode_name().to_owned(), points: of.map(point).collect() }
    };
    let native = of(Backend::Native);
    let middle = native.points.get(native.points.len() / 2).copied();
    let law = |&(n, _): &(f64, f64)| middle.map(|(m, ns)| (n, ns * n.ln() / m.ln()));
    let law = Line { name: String::from("n log n"), points: native.points.iter().filter_map(law).collect() };
    let mut lines = vec![native, of(Backend::Embree), law];
    lines.retain(|l| !l.points.is_empty());
    lines
}

fn panel(lines: &[Line], title: &str, left: f64) -> String {
    let all = || lines.iter().flat_map(|l| &l.points);
    let range = |of: fn(&(f64, f64)) -> f64| {
        let (lo, hi) = all().map(of).fold((f64::MAX, 0.0_f64), |(lo, hi), x| (lo.min(x), hi.max(x)));
        (lo.log10() - 0.05, hi.log10() + 0.05)
    };
    let ((x0, x1), (y0, y1)) = (range(|p| p.0), range(|p| p.1));
    let (ox, oy) = (left + 60.0, 30.0);
    let x = |n: f64| ox + (n.log10() - x0) / (x1 - x0) * WIDTH;
    let y = |v: f64| oy + HEIGHT - (v.log10() - y0) / (y1 - y0) * HEIGHT;
    let mut text = format!("<text x=\"{ox}\" y=\"18\">{title}</text>\n");
    text +=
        &format!("<rect x=\"{ox}\" y=\"{oy}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"none\" stroke=\"#888\"/>\n");
    for (value, label) in ticks(x0, x1, &[1.0]) {
        let (at, below) = (x(value), oy + HEIGHT);
        text += &format!("<path d=\"M{at:.1} {oy}V{below}\" stroke=\"#ddd\"/>");
        text += &format!("<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{label}</text>\n", below + 18.0);
    }
    for (value, label) in ticks(y0, y1, &[1.0, 2.0, 5.0]) {
        let at = y(value);
        text += &format!("<path d=\"M{ox} {at:.1}H{}\" stroke=\"#ddd\"/>", ox + WIDTH);
        text += &format!("<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>\n", ox - 6.0, at + 4.0);
    }
    text += &format!(
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">triangles</text>\n",
        ox + WIDTH / 2.0,
        oy + HEIGHT + 36.0
    );
    for (i, line) in lines.iter().enumerate() {
        let (colour, dash) = (COLOURS[i / 2 % 4], DASH[i % 2]);
        let path: Vec<String> = line.points.iter().map(|&(n, v)| format!("{:.1},{:.1}", x(n), y(v))).collect();
        let path = path.join(" ");
        text += &format!(
            "<polyline points=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\" stroke-dasharray=\"{dash}\"/>\n"
        );
        let (kx, ky) = (ox + 10.0, oy + HEIGHT + 56.0 + 18.0 * i as f64);
        text += &format!(
            "<path d=\"M{kx} {ky}h34\" stroke=\"{colour}\" stroke-width=\"2\" stroke-dasharray=\"{dash}\"/><text x=\"{}\" y=\"{}\">{}</text>\n",
            kx + 42.0,
            ky + 4.0,
            line.name
        );
    }
    text
}

/// Values of the axis from 10^`lo` to 10^`hi`: each of `steps` times each power of ten, with their labels.
fn ticks(lo: f64, hi: f64, steps: &[f64]) -> Vec<(f64, String)> {
    let named = |value: f64| {
        let name = match value {
            v if v >= 1e6 => format!("{} M", v / 1e6),
            v if v >= 1e3 => format!("{} k", v / 1e3),
            v => format!("{v}"),
        };
        (value, name)
    };
    let powers = lo.floor() as i32..=hi.ceil() as i32;
    let values = powers.flat_map(|p| steps.iter().map(move |s| s * 10_f64.powi(p)));
    values.filter(|v| (lo..=hi).contains(&v.log10())).map(named).collect()
}

#[cfg(test)]
mod tests {
    use super::super::report::example;
    use super::*;

    #[test]
    fn ticks_lie_within_the_axis_and_are_round() {
        let names = |lo, hi| ticks(lo, hi, &[1.0, 2.0, 5.0]).into_iter().map(|(_, name)| name).collect::<Vec<_>>();
        assert_eq!(names(0.9, 2.35), ["10", "20", "50", "100", "200"]);
        assert_eq!(
            ticks(3.0, 6.1, &[1.0]).into_iter().map(|(_, name)| name).collect::<Vec<_>>(),
            ["1 k", "10 k", "100 k", "1 M"]
        );
    }

    #[test]
    fn each_contender_has_a_line_and_the_builds_their_law() {
        let text = svg(&example());
        for name in ["primary, native", "primary, embree-robust", "diffuse, native", "n log n"] {
            assert!(text.contains(&format!(">{name}</text>")), "{name} in\n{text}");
        }
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }
}
