//! The report as comma-separated values, one line per variant (RFC 4180).

use super::axis::Axis;
use super::errors::Errors;
use super::report::Report;

/// Returns the table of all rows, after a line of names.
#[must_use]
pub fn table(report: &Report) -> String {
    let mut text = Axis::ALL.map(Axis::name).join(",");
    text += ",name,seconds,ratio,ratio_low,ratio_high,confidence,runs,same_time,walk,walk_low,walk_high,settled,build_seconds";
    for set in ["own", "fine"] {
        for column in ["rmse", "max", "psnr", "ssim", "visible", "ill", "rmse_well", "max_well", "asked", "max_is_sure"]
        {
            text += &format!(",{set}_{column}");
        }
    }
    text += ",change_rmse,change_max,light,reference_light,gained,lost,cut,unmatched_exits,non_finite,clamped";
    text += ",rays,camera,reflected,transmitted,shadow,deepest,front,front_fine,threads,cpu,command\r\n";
    for row in &report.rows {
        let mut cells: Vec<String> = Axis::ALL.map(|axis| row.levels.level(axis).to_string()).to_vec();
        let (t, q) = (&row.seconds, &row.ratio);
        cells.push(row.name.clone());
        cells.extend([t.median, q.median, q.interval[0], q.interval[1], q.confidence].map(number));
        cells.extend([q.runs.to_string(), row.same_time.to_string()]);
        cells.extend(row.walk.map_or_else(Default::default, |w| [w.median, w.interval[0], w.interval[1]].map(number)));
        cells.extend([row.settled.map_or_else(String::new, number), number(row.build_seconds)]);
        cells.extend(errors(row.own.as_ref()));
        cells.extend(errors(row.fine.as_ref()));
        cells.extend(row.change.map_or_else(|| [String::new(), String::new()], |c| [c.rmse, c.max].map(number)));
        let l = &row.ledger;
        cells.extend([l.light, l.reference, l.gained, l.lost, l.cut].map(number));
        cells.extend([l.unmatched_exits, l.non_finite, l.clamped].map(|n| n.to_string()));
        let r = &row.rays;
        cells.extend([r.total, r.camera, r.reflected, r.transmitted, r.shadow, r.deepest].map(|n| n.to_string()));
        cells.extend([row.front.to_string(), row.front_fine.to_string(), report.threads.to_string()]);
        cells.extend([report.machine.cpu.clone(), row.command.clone()]);
        text += &cells.iter().map(|cell| quoted(cell)).collect::<Vec<_>>().join(",");
        text += "\r\n";
    }
    text
}

fn number(x: f64) -> String {
    x.to_string()
}

fn errors(errors: Option<&Errors>) -> [String; 10] {
    let Some(e) = errors else { return std::array::from_fn(|_| String::new()) };
    let apart = |of: fn(&super::errors::Apart) -> f64| e.apart.as_ref().map_or_else(String::new, |a| number(of(a)));
    [
        number(e.rmse),
        number(e.max),
        e.psnr.map_or_else(String::new, number),
        number(e.ssim),
        number(e.visible),
        e.apart.map_or_else(String::new, |_| number(e.ill())),
        apart(|a| a.rmse),
        apart(|a| a.max),
        e.apart.map_or_else(String::new, |a| a.asked.to_string()),
        e.apart.map_or_else(String::new, |a| a.sure.to_string()),
    ]
}

fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_with_commas_or_quotes_are_quoted() {
        assert_eq!(quoted("a b"), "a b");
        assert_eq!(quoted("a,\"b\""), "\"a,\"\"b\"\"\"");
    }
}
