//! The report as tables of at most 100 columns.

use super::contender::Mode;
use super::report::{Build, Report, distinct};
use crate::accel::Backend;
use crate::measure::Machine;
use crate::measure::table::aligned;

/// Returns the whole report.
#[must_use]
pub fn tables(report: &Report) -> String {
    let mut text = machine(&report.machine);
    for mesh in report.meshes() {
        text += &format!("\n{mesh}: {} triangles\n", report.triangles(mesh));
        text += &builds(report, mesh);
        for threads in report.threads() {
            text += &format!("\n  Mrays/s, {}, median of the rounds\n", counted(threads));
            for backend in report.backends() {
                text += &rates(report, mesh, threads, backend);
            }
            text += &ratios(report, mesh, threads);
        }
    }
    text
}

/// Describes the machine in one line.
pub(super) fn machine(machine: &Machine) -> String {
    let embree = match &machine.embree {
        Some(e) => format!("Embree {} ({}, {} tasking)", e.version, e.isa, e.tasking),
        None => String::from("WITHOUT EMBREE: it was left out"),
    };
    format!(
        "{}, {} processors; Vitrum {} built for {}; {embree}\n",
        machine.cpu, machine.processors, machine.vitrum, machine.simd
    )
}

fn counted(threads: usize) -> String {
    if threads == 1 { String::from("1 thread") } else { format!("{threads} threads") }
}

fn builds(report: &Report, mesh: &str) -> String {
    let mut rows = vec![["build", "quality", "threads", "ms", "B/triangle"].map(String::from)];
    let of = |b: &Build| {
        let numbers = [b.threads.to_string(), format!("{:.1}", b.ms), format!("{:.1}", b.bytes_per_triangle)];
        let [threads, ms, bytes] = numbers;
        [b.backend.mode_name().to_owned(), b.quality.to_owned(), threads, ms, bytes]
    };
    rows.extend(report.builds.iter().filter(|b| b.mesh == mesh).map(of));
    aligned(&rows.iter().map(|r| r.to_vec()).collect::<Vec<_>>())
}

/// Table of rates: kinds of rays as rows, modes of one back end as columns.
fn rates(report: &Report, mesh: &str, threads: usize, backend: Backend) -> String {
    let modes = distinct(report.rows.iter().filter(|r| r.backend == backend).map(|r| r.mode));
    let mut rows = vec![
        std::iter::once(backend.mode_name())
            .chain(modes.iter().map(|mode| mode.name()))
            .map(String::from)
            .collect::<Vec<_>>(),
    ];
    for kind in report.kinds() {
        let cell = |mode: &Mode| {
            let row = report.rows_of(mesh, kind, threads).find(|r| r.backend == backend && r.mode == *mode);
            row.map_or_else(|| String::from("-"), |r| format!("{:.2}", r.mrays_per_s))
        };
        rows.push(std::iter::once(kind.to_owned()).chain(modes.iter().map(cell)).collect());
    }
    aligned(&rows)
}

/// Table of ratios: native auto against the fastest of Embree.
fn ratios(report: &Report, mesh: &str, threads: usize) -> String {
    let head = ["native / best", "embree-robust", "mode", "10..90 %", "embree-fast", "mode", "10..90 %"];
    let mut rows = vec![head.map(String::from).to_vec()];
    for kind in report.kinds() {
        let mut row = vec![kind.to_owned()];
        for against in [Backend::Embree, Backend::EmbreeFast] {
            match report.ratios_of(mesh, kind, threads).find(|r| r.against == against) {
                Some(r) => row.extend([
                    format!("{:.2}", r.ratio),
                    r.embree_mode.name().to_owned(),
                    format!("{:.2}..{:.2}", r.spread[0], r.spread[1]),
                ]),
                None => row.extend(["-", "-", "-"].map(String::from)),
            }
        }
        rows.push(row);
    }
    if report.ratios.is_empty() { String::new() } else { format!("\n{}", aligned(&rows)) }
}

#[cfg(test)]
mod tests {
    use super::super::report::example;
    use super::*;

    #[test]
    fn the_tables_have_every_figure_and_fit_a_terminal() {
        let text = tables(&example());
        for words in [
            "a<b: 69630 triangles",
            "  embree-robust   medium        1  40.0        64.2\n",
            "  native    auto  single\n  primary  20.00    8.00",
            "  embree-robust   auto    16c\n  primary        15.00  16.00",
            "Mrays/s, 1 thread,",
            "1.25   16c  1.20..1.30",
        ] {
            assert!(text.contains(words), "{words} in\n{text}");
        }
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    }

    #[test]
    fn a_report_without_embree_says_so_loudly_and_has_no_ratios() {
        let mut report = example();
        report.machine.embree = None;
        report.ratios.clear();
        let text = tables(&report);
        assert!(text.contains("WITHOUT EMBREE") && !text.contains("native / best"));
    }
}
