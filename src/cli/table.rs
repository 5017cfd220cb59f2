//! Tables of figures.

use crate::measure::table::grouped;
use crate::render::{RayCounts, RayKind};

/// Number of depths with a line of their own; deeper ones share the last line.
const DEPTHS: usize = 8;

/// Returns rays by depth and kind, each line after `indent`.
pub(super) fn rays(counts: &RayCounts, indent: &str) -> String {
    let mut rows = vec![[String::from("depth"), String::new(), String::new(), String::new(), String::new()]];
    for (k, kind) in RayKind::ALL.iter().enumerate() {
        rows[0][k + 1] = kind.name().to_owned();
    }
    let cells = |name: String, row: &[u64; 4]| {
        let cell = |n: u64| if n == 0 { String::from("-") } else { grouped(n) };
        [name, cell(row[0]), cell(row[1]), cell(row[2]), cell(row[3])]
    };
    // A last line for a single depth would save nothing.
    let single = if counts.by_depth.len() <= DEPTHS + 1 { DEPTHS + 1 } else { DEPTHS };
    for (depth, row) in counts.by_depth.iter().enumerate().take(single) {
        rows.push(cells(depth.to_string(), row));
    }
    if let Some(deeper) = counts.by_depth.get(single..).filter(|rest| !rest.is_empty()) {
        let sum = deeper.iter().fold([0; 4], |sum, row| std::array::from_fn(|k| sum[k] + row[k]));
        rows.push(cells(format!("{single}-{}", counts.by_depth.len() - 1), &sum));
    }
    let width = |column: usize| rows.iter().map(|row| row[column].len()).max().unwrap_or(0);
    let widths: [usize; 5] = std::array::from_fn(width);
    let line = |row: &[String; 5]| {
        let cells: Vec<String> = row.iter().zip(widths).map(|(cell, width)| format!("{cell:>width$}")).collect();
        format!("{indent}{}", cells.join("  "))
    };
    rows.iter().map(line).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_rays_is_aligned_and_keeps_every_ray() {
        let mut counts = RayCounts::default();
        counts.add(RayKind::Camera, 0, 1000);
        counts.add(RayKind::Shadow, 0, 5);
        for depth in 1..12 {
            counts.add(RayKind::Reflected, depth, 10);
        }
        let text = rays(&counts, "  ");
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len(), 1 + 8 + 1);
        assert_eq!(lines[0], "  depth  camera  reflected  transmitted  shadow");
        assert_eq!(lines[1], "      0   1 000          -            -       5");
        assert_eq!(lines[9], "   8-11       -         40            -       -");
    }
}
