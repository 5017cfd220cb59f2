//! `vitrum doctor`.

use clap::Args;

use super::output;
use super::verdict::Verdict;
use crate::accel::Backend;
use crate::accel::embree::{self, Installed};
use crate::measure::machine;
use crate::simd::level;
use crate::{Error, Result};

/// Say what this machine and this build can do, and what is missing.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  vitrum doctor
  vitrum doctor --json

Exits 4 when this binary cannot run here.")]
pub(super) struct DoctorArgs {
    /// Print the findings as JSON
    #[arg(long)]
    pub json: bool,
}

/// Advice on the back end. README.md has the measurements.
const CHOICE: &str = "--backend native takes less CPU time on most scenes (Embree takes 1.1 to 1.9 times as much); \
                      a build without the feature `embree` has it as its default";

/// The same for builds without Embree.
const CHOICE_WITHOUT: &str = "native takes less CPU time on most scenes (Embree takes 1.1 to 1.9 times as much); \
                      a build with `--features embree` has --backend embree, too, as its default";

/// Capabilities of this machine and this build, in the form of the JSON output.
#[derive(serde::Serialize)]
struct Findings {
    vitrum: &'static str,
    cpu: String,
    /// Processors that this process may use.
    processors: usize,
    simd: Simd,
    /// Available back ends.
    backends: Vec<&'static str>,
    /// Back end that traces rays without `--backend`.
    default_backend: &'static str,
    /// Advice on the back end to choose.
    choice: &'static str,
    /// `None` if it was not found or not compiled in.
    embree: Option<Installed>,
    /// Possible improvements, with their cures.
    missing: Vec<String>,
}

#[derive(serde::Serialize)]
struct Simd {
    built: &'static str,
    available: &'static str,
    /// True if the operating system saves 256-bit registers.
    saves_ymm: bool,
    /// True if the operating system saves 512-bit registers.
    saves_zmm: bool,
    /// CPU features that this binary needs and the machine lacks; then it cannot run.
    lacking: Vec<&'static str>,
}

/// Examines the machine and prints the findings.
///
/// # Errors
/// A limit if this binary cannot run here. (Usually the program ends before it gets here.)
pub(super) fn run(json: bool) -> Result<Verdict> {
    let findings = Findings::here();
    if json {
        output::print_json(&findings)?;
    } else {
        output::print(&findings.text())?;
    }
    if findings.simd.lacking.is_empty() {
        return Ok(Verdict::Done);
    }
    Err(Error::Limit(format!("this binary needs {}, which this machine lacks", findings.simd.lacking.join(", "))))
}

impl Findings {
    fn here() -> Self {
        let [saves_ymm, saves_zmm] = level::saved();
        let simd = Simd {
            built: level::BUILT,
            available: level::available(),
            saves_ymm,
            saves_zmm,
            lacking: level::needed().into_iter().filter(|(_, there)| !there).map(|(name, _)| name).collect(),
        };
        let embree = embree::installed();
        let mut missing = Vec::new();
        if simd.built != simd.available {
            missing.push(format!("built for {}, while this CPU has {}: {}", simd.built, simd.available, level::CURE));
        }
        if let Err(e) = &embree {
            missing.push(e.to_string());
        }
        let embree = embree.ok();
        let mut backends = vec!["native", "reference"];
        backends.extend(embree.is_some().then_some("embree"));
        Self {
            vitrum: env!("CARGO_PKG_VERSION"),
            cpu: machine::cpu(),
            processors: std::thread::available_parallelism().map_or(1, usize::from),
            simd,
            backends,
            default_backend: Backend::DEFAULT.name(),
            choice: if embree::COMPILED_IN { CHOICE } else { CHOICE_WITHOUT },
            embree,
            missing,
        }
    }

    fn text(&self) -> String {
        let saved = match (self.simd.saves_ymm, self.simd.saves_zmm) {
            (_, true) => "256-bit and 512-bit registers",
            (true, false) => "256-bit registers",
            (false, false) => "128-bit registers",
        };
        let embree = match &self.embree {
            Some(e) => format!("{}, {}, {} tasking, {} ({})", e.version, e.isa, e.tasking, e.file, e.found_by),
            None => String::from("not there"),
        };
        let mut text = String::new();
        for (name, value) in [
            ("vitrum", self.vitrum),
            ("cpu", &self.cpu),
            ("processors", &self.processors.to_string()),
            ("simd built", self.simd.built),
            ("simd available", self.simd.available),
            ("system saves", saved),
            ("back ends", &self.backends.join(", ")),
            ("default", self.default_backend),
            ("choice", self.choice),
            ("embree", &embree),
        ] {
            text += &format!("{name:<16}{value}\n");
        }
        if self.missing.is_empty() {
            return text + "missing         nothing\n";
        }
        for missing in &self.missing {
            text += &format!("missing         {missing}\n");
        }
        text
    }
}
