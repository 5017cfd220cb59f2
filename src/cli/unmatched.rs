//! Objects that rays left without having entered their medium, with the likely cause and its cure.

use super::backend::Renderer;
use crate::load::{Hull, LoadReport};
use crate::measure::table::{counted, grouped};
use crate::notices::INSIDE_OUT_CURE;
use crate::render::Outcome;
use crate::scene::Scene;

/// Largest number of objects listed outside JSON.
const TOLD: usize = 5;

/// One object of [`Unmatched`].
#[derive(Debug, PartialEq, Eq, serde::Serialize)]
pub(super) struct Leak {
    object: String,
    exits: u64,
    cause: String,
}

/// Exits from media that were never entered.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Unmatched {
    pub exits: u64,
    /// Objects, the worst first.
    pub objects: Vec<Leak>,
}

impl Unmatched {
    pub fn of(outcome: &Outcome, scene: &Scene, report: &LoadReport, backend: Renderer) -> Self {
        let leak = |&(object, exits): &(u32, u64)| Leak {
            object: scene.objects[object as usize].name.clone(),
            exits,
            cause: cause(object as usize, report, backend),
        };
        Self { exits: outcome.unmatched_exits, objects: outcome.unmatched_objects.iter().map(leak).collect() }
    }

    /// Lines of the summary; none if every exit was matched.
    pub fn lines(&self) -> Vec<String> {
        if self.exits == 0 {
            return Vec::new();
        }
        let head = format!("{}: from a medium never entered, by object", counted(self.exits, "exit"));
        let object = |leak: &Leak| format!("{:<10} `{}` {}: {}", "", leak.object, grouped(leak.exits), leak.cause);
        let mut lines = vec![format!("{:<10} {head}", "unmatched")];
        lines.extend(self.objects.iter().take(TOLD).map(object));
        if self.objects.len() > TOLD {
            let more = counted((self.objects.len() - TOLD) as u64, "other object");
            lines.push(format!("{:<10} and {more}; --json has all", ""));
        }
        lines
    }

    /// Describes the worst object, for an error message.
    pub fn worst(&self) -> Option<String> {
        self.objects.first().map(|leak| format!("most through `{}` ({}): {}", leak.object, leak.exits, leak.cause))
    }
}

fn cause(object: usize, report: &LoadReport, backend: Renderer) -> String {
    match report.hulls.get(&object) {
        Some(Hull::InsideOut { parts, of }) if parts == of => format!("it is inside out; {INSIDE_OUT_CURE}"),
        Some(Hull::InsideOut { .. }) => String::from("parts of it are inside out; turn their faces in the model"),
        Some(Hull::Open) => String::from("it is not closed; close it, or use a thin material"),
        Some(Hull::Closed) if backend.leaks() => {
            format!("it is closed; the back end `{}` loses rays at edges, `--backend native` does not", backend.name())
        }
        _ => String::from(
            "it touches or crosses another surface there, or the camera's `medium` is not the one around it",
        ),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::accel::Backend;
    use crate::image::Film;
    use crate::render::{RayCounts, Seen, StreamCounts};
    use crate::scene::{Object, Origin};

    fn outcome(unmatched_objects: Vec<(u32, u64)>) -> Outcome {
        Outcome {
            film: Film::default(),
            truncated: Film::default(),
            rays: RayCounts::default(),
            non_finite: 0,
            clamped: 0,
            unmatched_exits: unmatched_objects.iter().map(|(_, n)| n).sum(),
            unmatched_objects,
            limits: Vec::new(),
            shortfall: None,
            streams: StreamCounts::default(),
            touching: crate::render::TouchingFound::default(),
            planar: None,
            maps: None,
            images: None,
            body_maps: None,
            seen: Seen::default(),
        }
    }

    fn scene(objects: usize) -> Scene {
        let origin = || Origin { file: String::new(), line: 0, triangle_lines: Vec::new() };
        let object = |i| Object { name: format!("part {i}"), material: 0, origin: origin() };
        Scene { objects: (0..objects).map(object).collect(), ..Scene::default() }
    }

    #[test]
    fn objects_are_told_worst_first_with_cause_and_cure() {
        let hulls = BTreeMap::from([(0, Hull::Open), (1, Hull::InsideOut { parts: 1, of: 1 }), (2, Hull::Closed)]);
        let report = LoadReport { hulls, ..LoadReport::default() };
        let told = |backend| Unmatched::of(&outcome(vec![(1, 1234), (2, 30), (0, 2)]), &scene(3), &report, backend);
        let lines = told(Renderer::Packets(Backend::Native)).lines();
        assert_eq!(lines[0], "unmatched  1 266 exits: from a medium never entered, by object");
        assert!(lines[1].contains("`part 1` 1 234: it is inside out; set `flip = true`"), "{}", lines[1]);
        assert!(lines[2].contains("`part 2` 30: it touches or crosses"), "{}", lines[2]);
        assert!(lines[3].contains("`part 0` 2: it is not closed"), "{}", lines[3]);
        assert!(
            told(Renderer::Packets(Backend::Native))
                .worst()
                .unwrap()
                .starts_with("most through `part 1` (1234): it is inside out")
        );
        for (backend, name) in [(Backend::Embree, "`embree`"), (Backend::EmbreeFast, "`embree-fast`")] {
            let lines = told(Renderer::Packets(backend)).lines();
            assert!(lines[1].contains("inside out") && lines[3].contains("not closed"), "{lines:?}");
            assert!(lines[2].contains(name) && lines[2].contains("`--backend native` does not"), "{}", lines[2]);
        }
    }

    #[test]
    fn many_objects_are_counted_and_none_is_told_where_every_exit_was_matched() {
        let report = LoadReport::default();
        let all = (0..9).map(|i| (i, 1)).collect();
        let unmatched = Unmatched::of(&outcome(all), &scene(9), &report, Renderer::Reference);
        assert_eq!(unmatched.objects.len(), 9);
        assert_eq!(unmatched.lines().len(), 7);
        assert_eq!(unmatched.lines()[6], "           and 4 other objects; --json has all");
        let none = Unmatched::of(&outcome(Vec::new()), &scene(9), &report, Renderer::Packets(Backend::Native));
        assert_eq!((none.lines(), none.worst()), (Vec::new(), None));
    }
}
