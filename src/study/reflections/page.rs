//! The study of the notes' systems as one page without scripts: pictures inside it, plots as SVG.

use std::fmt::Write as _;

use super::curves::BIN;
use super::{Curves, Reflections, Row};
use crate::Result;
use crate::measure::html::escaped;
use crate::study::html::{false_colours, png, style};

/// Colours of lines.
const COLOURS: [&str; 4] = ["#0072b2", "#d55e00", "#009e73", "#6a3d9a"];

/// Returns the page.
///
/// # Errors
/// Errors of encoding pictures.
pub fn page(study: &Reflections) -> Result<String> {
    let mut body = String::from(
        "<header><h1>Reflections without tracing</h1><p class=\"scene\">The notes' systems on the bundled scenes</p></header>\n<main>\n",
    );
    body += &table(study);
    for row in &study.rows {
        body += &section(row)?;
    }
    body += &curves(&study.curves);
    let machine = &study.machine;
    _ = writeln!(
        body,
        "<section><h2>How it was measured</h2><p class=\"note\">Each row: the system and the traced picture by turns, \
         {} rounds; the ratio of a round is one value, the figure their median with its interval. Times include all that a \
         system prepares: maps, virtual scenes. Back end {}, {}. Errors are against the traced picture, in units of \
         radiance.</p><p><code>{}</code></p></section>",
        study.rows.first().map_or(0, |row| row.ratio.runs),
        study.backend,
        escaped(&machine.cpu),
        escaped(&study.command),
    );
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<title>Reflections without tracing</title>\n<style>\n{}\n.three \
         {{ display: grid; grid-template-columns: 1fr 1fr 1fr; gap: 12px; }}\n.three img {{ width: 100%; display: block; \
         image-rendering: pixelated; }}\n.plot svg {{ max-width: 720px; }}\n</style>\n</head>\n<body>\n{body}</main>\n</body>\n</html>\n",
        style()
    ))
}

fn ratio(row: &Row) -> String {
    let [low, high] = row.ratio.interval;
    format!("{:.2} ({low:.2} to {high:.2})", row.ratio.median)
}

fn places(row: &Row) -> String {
    let named = |(name, share): &(String, f64)| format!("{name} {:.0} %", 100.0 * share);
    row.places.iter().map(named).collect::<Vec<_>>().join(", ")
}

fn table(study: &Reflections) -> String {
    let mut text = String::from(
        "<section><h2>All of them</h2><div class=\"scroll\"><table><thead><tr><th>system</th><th>scene</th><th>time over \
         traced</th><th>rmse</th><th>largest</th><th>pixels off by 1/255</th><th>at edges</th><th class=\"prose\">where</th></tr></thead><tbody>\n",
    );
    for row in &study.rows {
        let Row { system, scene, errors, at_edges, .. } = row;
        _ = writeln!(
            text,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{:.2e}</td><td>{:.3}</td><td>{:.2} %</td><td>{:.0} %</td>\
             <td class=\"prose\">{}</td></tr>",
            escaped(system),
            escaped(scene),
            ratio(row),
            errors.rmse,
            errors.max,
            100.0 * errors.visible,
            100.0 * at_edges,
            escaped(&places(row)),
        );
    }
    text + "</tbody></table></div></section>\n"
}

fn section(row: &Row) -> Result<String> {
    let [film, traced] = &row.films;
    let figure = |picture: &str, caption: &str| {
        format!("<figure><img alt=\"{caption}\" src=\"{picture}\"><figcaption>{caption}</figcaption></figure>")
    };
    let pictures = [
        figure(&png(film)?, "by the system"),
        figure(&png(traced)?, "traced"),
        figure(&png(&false_colours(film, traced))?, "difference, black 1e-5 to white 1"),
    ];
    let errors = &row.errors;
    let worst = errors.worst.map_or_else(String::new, |[x, y]| format!(" at column {x}, row {y}"));
    let mut text = format!(
        "<section><h2>{}: {}</h2>\n<div class=\"three\">{}</div>\n<dl><dt>time over traced</dt><dd>{} of {:.3} s</dd>\
         <dt>error</dt><dd>rmse {:.2e}, largest {:.3}{worst}, {:.2} % of pixels off by more than 1/255</dd>",
        escaped(row.system),
        escaped(&row.scene),
        pictures.concat(),
        ratio(row),
        row.traced_seconds,
        errors.rmse,
        errors.max,
        100.0 * errors.visible,
    );
    if row.capture > 0.0 {
        _ = write!(
            text,
            "<dt>capture of maps</dt><dd>{:.0} % of its time; maps serve other cameras</dd>",
            100.0 * row.capture
        );
    }
    _ = write!(
        text,
        "<dt>where</dt><dd>{}; {:.0} % of the squared error at edges</dd><dt>why</dt><dd>{}</dd>",
        escaped(&places(row)),
        100.0 * row.at_edges,
        escaped(row.why),
    );
    for count in &row.counts {
        _ = write!(text, "<dt>counted</dt><dd>{}</dd>", escaped(count));
    }
    _ = writeln!(text, "<dt>again</dt><dd><code>{}</code></dd></dl></section>", escaped(&row.command));
    Ok(text)
}

fn curves(curves: &Curves) -> String {
    let mut text = String::from(
        "<section><h2>Maps: error against the distance of the neighbours</h2><p class=\"note\">A mirror ball of radius 1 in \
         a room whose walls are at this distance from its middle.</p>\n",
    );
    text += &plot(curves);
    text += "<div class=\"scroll\"><table><thead><tr><th>distance in radii</th>";
    for line in &curves.maps {
        _ = write!(text, "<th>{}</th>", line.name);
    }
    text += "</tr></thead><tbody>\n";
    for (i, distance) in curves.distances.iter().enumerate() {
        _ = write!(text, "<tr><td>{distance}</td>");
        for line in &curves.maps {
            _ = write!(text, "<td>{:.4}</td>", line.errors[i]);
        }
        text += "</tr>\n";
    }
    text += "</tbody></table></div></section>\n<section><h2>Virtual scenes: error by angle and tessellation</h2><p \
             class=\"note\">A mirror ball of radius 1 in a room: the angle at the eye, in milliradians, between a pixel and \
             the place where the ball truly shows what the pixel shows; medians by angle of incidence.</p><div \
             class=\"scroll\"><table><thead><tr><th>pieces of at most</th><th>triangles</th>";
    for bin in 0..curves.pieces.first().map_or(0, |pieces| pieces.errors.len()) {
        _ = write!(text, "<th>{} to {}&deg;</th>", BIN * bin, BIN * (bin + 1));
    }
    text += "<th>largest</th></tr></thead><tbody>\n";
    for pieces in &curves.pieces {
        _ = write!(text, "<tr><td>{} rad</td><td>{}</td>", pieces.angle, pieces.triangles);
        for error in &pieces.errors {
            _ = match error {
                Some(error) => write!(text, "<td>{error:.4}</td>"),
                None => write!(text, "<td></td>"),
            };
        }
        _ = writeln!(text, "<td>{:.3}</td></tr>", pieces.most);
    }
    text += "</tbody></table></div></section>\n<section><h2>Raised objects: error by angle</h2><p class=\"note\">Into water of \
             index 1.333.</p><div class=\"scroll\"><table><thead><tr><th>incidence</th><th>Snell's law</th><th>raised</th>\
             <th>off by</th></tr></thead><tbody>\n";
    for water in &curves.water {
        _ = writeln!(
            text,
            "<tr><td>{:.0}&deg;</td><td>{:.2}&deg;</td><td>{:.2}&deg;</td><td>{:.2}&deg;</td></tr>",
            water.incidence,
            water.exact,
            water.raised,
            water.raised - water.exact,
        );
    }
    text + "</tbody></table></div></section>\n"
}

/// Draws the errors of maps against distance, both logarithmic.
fn plot(curves: &Curves) -> String {
    const WIDTH: f64 = 720.0;
    const HEIGHT: f64 = 320.0;
    let all = || curves.maps.iter().flat_map(|line| &line.errors).copied().filter(|e| *e > 0.0);
    let lowest = all().fold(f64::INFINITY, f64::min).log10().floor();
    let highest = all().fold(0.0, f64::max).log10().ceil();
    let (first, last) = (curves.distances[0].log10(), curves.distances[curves.distances.len() - 1].log10());
    let x = |distance: f64| 60.0 + (distance.log10() - first) / (last - first) * (WIDTH - 80.0);
    let y = |error: f64| 20.0 + (highest - error.log10()) / (highest - lowest) * (HEIGHT - 70.0);
    let mut svg = format!(
        "<div class=\"plot\"><svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"error of maps against distance\" font-size=\"12\">"
    );
    for decade in lowest as i32..=highest as i32 {
        let at = y(10.0_f64.powi(decade));
        _ = write!(
            svg,
            "<line x1=\"60\" x2=\"{}\" y1=\"{at}\" y2=\"{at}\" stroke=\"#e9edf2\"/><text x=\"54\" y=\"{at}\" text-anchor=\"end\">1e{decade}</text>",
            WIDTH - 20.0
        );
    }
    for distance in &curves.distances {
        let (at, foot) = (x(*distance), HEIGHT - 34.0);
        _ = write!(svg, "<text x=\"{at}\" y=\"{foot}\" text-anchor=\"middle\">{distance}</text>");
    }
    for (i, line) in curves.maps.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        let points: Vec<String> = curves
            .distances
            .iter()
            .zip(&line.errors)
            .filter(|(_, error)| **error > 0.0)
            .map(|(distance, error)| format!("{:.1},{:.1}", x(*distance), y(*error)))
            .collect();
        let (left, foot) = (60 + 160 * i, HEIGHT - 10.0);
        _ = write!(
            svg,
            "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\" points=\"{}\"/><text x=\"{left}\" y=\"{foot}\" fill=\"{colour}\">{}</text>",
            points.join(" "),
            line.name
        );
    }
    svg + "</svg></div>\n"
}
