//! Warnings of a command: those of the loader and the notices about the scene and its picture, one line each.

use super::output;
use crate::Result;
use crate::load::LoadReport;
use crate::notices::{self, Notice};
use crate::render::{Observer, Options};
use crate::scene::Scene;

/// Warnings as JSON has them, for every command that reports any.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub(super) struct Warnings {
    /// All of them, as text.
    warnings: Vec<String>,
    /// The notices among them, in parts.
    notices: Vec<Notice>,
}

impl Warnings {
    /// Warnings of the loader, then notices.
    pub fn new(report: &LoadReport, notices: Vec<Notice>) -> Self {
        let loaded = report.warnings.iter().map(ToString::to_string);
        Self { warnings: loaded.chain(notices.iter().map(ToString::to_string)).collect(), notices }
    }

    /// Warnings of a command that makes no picture of the scene by itself. `scene` has the settings of its own picture.
    ///
    /// # Errors
    /// As [`notices::survey`].
    pub fn survey(
        file: &std::path::Path,
        scene: &mut Scene,
        report: &LoadReport,
        options: &Options,
        observer: &Observer,
    ) -> Result<Self> {
        let notices = super::interrupt::heeded(|| notices::survey(file, scene, report, options, observer))?;
        Ok(Self::new(report, notices))
    }

    /// As text, a line each.
    pub fn lines(&self) -> impl Iterator<Item = String> {
        self.warnings.iter().map(|warning| format!("warning: {warning}"))
    }

    /// Writes them to standard error.
    pub fn log(&self) {
        self.lines().for_each(|line| output::log(&output::one_line(&line)));
    }
}

/// Under `--strict`: the first notice is an error.
///
/// # Errors
/// The notice.
pub(super) fn refuse(notices: &[Notice]) -> Result<()> {
    notices.first().map_or(Ok(()), |notice| Err(notice.clone().into_error()))
}
