//! The tree as a drawing, from the camera at the left to the sources of light at the right.

use std::fmt::Write as _;

use glam::DVec3;

use super::align::Row;
use super::findings::Findings;
use super::text::{self, Totals, digits};
use crate::render::RayKind;

/// Size of a box, and of the space between boxes, in pixels.
const WIDTH: f64 = 250.0;
const HEIGHT: f64 = 76.0;
const GAP: [f64; 2] = [56.0, 14.0];
/// Left and upper edge of the first box.
const MARGIN: [f64; 2] = [24.0, 96.0];

/// A box for a ray, or for rays folded away.
struct Card {
    row: usize,
    parent: Option<usize>,
    level: usize,
    /// Position in boxes from the top.
    place: f64,
    folded: bool,
}

/// Returns the drawing.
pub(super) fn draw(findings: &Findings) -> String {
    let totals: Totals = [findings.narrow.tree.totals(), findings.wide.tree.totals()];
    let cards = cards(findings, &totals);
    let columns = cards.iter().map(|c| c.level).max().unwrap_or(0) + 1;
    let rows = cards.iter().fold(1.0_f64, |most, c| most.max(c.place + 1.0));
    let width = (2.0 * MARGIN[0] + columns as f64 * (WIDTH + GAP[0])).max(720.0);
    let height = MARGIN[1] + rows * (HEIGHT + GAP[1]) + MARGIN[0];
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"system-ui, sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    let job = findings.job;
    line(
        &mut svg,
        MARGIN[0],
        30.0,
        16.0,
        "#1a1a1a",
        &format!("Pixel ({}, {}) of {}", job.x, job.y, job.scene.display()),
    );
    let colour = |c: [f64; 3]| c.map(digits).join("  ");
    let values = format!(
        "f32 ({})  {}      f64  {}",
        job.backend.name(),
        colour(findings.narrow.radiance),
        colour(findings.wide.radiance)
    );
    line(&mut svg, MARGIN[0], 50.0, 12.0, "#444444", &values);
    let ill = findings.conditions.iter().filter(|c| c.is_ill()).count();
    let verdict = if ill == 0 {
        String::from("well-conditioned")
    } else {
        format!("ill-conditioned ({ill} of its {} rays)", findings.conditions.len())
    };
    line(&mut svg, MARGIN[0], 68.0, 12.0, if ill == 0 { "#2e7d32" } else { "#b3261e" }, &verdict);
    for card in &cards {
        if let Some(parent) = card.parent {
            edge(&mut svg, &cards[parent], card, event_kind(findings, &findings.rows[card.row]));
        }
    }
    for card in &cards {
        boxed(&mut svg, findings, card, &totals);
    }
    svg + "</svg>\n"
}

/// Places the boxes: leaves below each other, each other box in the middle of those that it sent.
fn cards(findings: &Findings, totals: &Totals) -> Vec<Card> {
    let mut cards: Vec<Card> = Vec::new();
    let mut card_of = vec![None; findings.rows.len()];
    for (i, row) in findings.rows.iter().enumerate() {
        let parent = row.parent.and_then(|p| card_of[p]);
        if row.parent.is_some() && parent.is_none_or(|p: usize| cards[p].folded) {
            continue;
        }
        let folded = row.level > 0 && text::folds(row, totals, findings.job.least);
        card_of[i] = Some(cards.len());
        cards.push(Card { row: i, parent, level: row.level, place: 0.0, folded });
    }
    let mut sent: Vec<Vec<usize>> = vec![Vec::new(); cards.len()];
    for (i, card) in cards.iter().enumerate() {
        if let Some(parent) = card.parent {
            sent[parent].push(i);
        }
    }
    let mut next = 0.0;
    for (card, sent) in cards.iter_mut().zip(&sent) {
        if sent.is_empty() {
            card.place = next;
            next += 1.0;
        }
    }
    // A box comes before those that it sent.
    for i in (0..cards.len()).rev() {
        if let (Some(&first), Some(&last)) = (sent[i].first(), sent[i].last()) {
            cards[i].place = 0.5 * (cards[first].place + cards[last].place);
        }
    }
    cards
}

fn corner(card: &Card) -> (f64, f64) {
    (MARGIN[0] + card.level as f64 * (WIDTH + GAP[0]), MARGIN[1] + card.place * (HEIGHT + GAP[1]))
}

fn event_kind(findings: &Findings, row: &Row) -> RayKind {
    text::event(findings, row).kind
}

fn hue(kind: RayKind) -> &'static str {
    match kind {
        RayKind::Reflected => "#1f6feb",
        RayKind::Transmitted => "#d2691e",
        RayKind::Camera | RayKind::Shadow => "#555555",
    }
}

fn edge(svg: &mut String, from: &Card, to: &Card, kind: RayKind) {
    let ((x0, y0), (x1, y1)) = (corner(from), corner(to));
    let (x0, y0, y1) = (x0 + WIDTH, y0 + HEIGHT / 2.0, y1 + HEIGHT / 2.0);
    let middle = 0.5 * (x0 + x1);
    // Writing to a string cannot fail.
    let _ = writeln!(
        svg,
        "<path d=\"M{x0:.1} {y0:.1} C{middle:.1} {y0:.1} {middle:.1} {y1:.1} {x1:.1} {y1:.1}\" fill=\"none\" \
         stroke=\"{}\" stroke-width=\"1.6\"/>",
        hue(kind)
    );
}

fn boxed(svg: &mut String, findings: &Findings, card: &Card, totals: &Totals) {
    let row = &findings.rows[card.row];
    let event = text::event(findings, row);
    let (x, y) = corner(card);
    let only = if row.narrow.is_none() || row.wide.is_none() { " stroke-dasharray=\"5 3\"" } else { "" };
    let fill = if card.folded { "#f2f2f2" } else { "#fbfbf8" };
    let _ = writeln!(
        svg,
        "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" rx=\"6\" fill=\"{fill}\" \
         stroke=\"{}\" stroke-width=\"1.2\"{only}/>",
        hue(event.kind)
    );
    let side = match (row.narrow, row.wide) {
        (Some(_), None) => ", f32 only",
        (None, Some(_)) => ", f64 only",
        _ => "",
    };
    let heaviest = event.weight.max_element();
    let mut lines = vec![format!("{} {}{side}, weight {heaviest:.4}", event.depth, event.kind.name())];
    if card.folded {
        lines.push(format!("{}, less than {}", text::following(findings, row), findings.job.least));
    } else {
        lines.push(text::met(findings.scene, event));
        lines.extend(event.split.filter(|s| s.indices.is_some() || s.reflected != DVec3::ZERO).map(|s| {
            let parts = [("R", s.reflected), ("T", s.transmitted), ("A", s.absorbed)];
            let shown = parts.iter().filter(|(_, v)| *v != DVec3::ZERO);
            shown.map(|(name, v)| format!("{name} {:.4}", v.max_element())).collect::<Vec<_>>().join("   ")
        }));
        let blocked = event.shares.iter().filter(|s| s.blocker.is_some()).count();
        let lit = event.shares.iter().filter(|s| s.source.is_shadowed() && s.radiance != DVec3::ZERO).count();
        let mut notes = Vec::new();
        if lit > 0 {
            notes.push(format!("{lit} lit"));
        }
        if blocked > 0 {
            notes.push(format!("{blocked} blocked"));
        }
        if !event.cut.is_empty() {
            notes.push(String::from("cut off"));
        }
        let of = |node: Option<u32>, totals: &[(DVec3, DVec3)]| node.map(|n| totals[n as usize].0);
        let (a, b) = (of(row.narrow, &totals[0]), of(row.wide, &totals[1]));
        let brings = b.or(a).unwrap_or(DVec3::ZERO);
        notes.insert(0, format!("brings {}", brings.to_array().map(|c| format!("{c:.4}")).join(" ")));
        lines.push(notes.join(", "));
    }
    for (i, words) in lines.iter().enumerate() {
        let size = if i == 0 { 12.0 } else { 11.0 };
        let ink = if i == 0 { hue(event.kind) } else { "#222222" };
        line(svg, x + 10.0, y + 17.0 + 17.0 * i as f64, size, ink, &shortened(words, 42));
    }
}

fn shortened(words: &str, most: usize) -> String {
    if words.chars().count() <= most {
        return words.to_owned();
    }
    words.chars().take(most - 1).chain(['…']).collect()
}

fn line(svg: &mut String, x: f64, y: f64, size: f64, ink: &str, words: &str) {
    let words = words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" fill=\"{ink}\">{words}</text>");
}
