//! Finding of a check: a fault, its location, its reason and its cure.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::Error;
use crate::scene::Scene;

/// Location of a fault in a file.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct FileLocation {
    /// File, as named by the user. In JSON, bytes that are not UTF-8 are replaced.
    #[serde(serialize_with = "lossy")]
    pub file: PathBuf,
    /// Line, from 1; 0 if the fault concerns the whole file.
    pub line: u32,
}

/// Serialises a file name as text.
fn lossy<S: serde::Serializer>(file: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&file.to_string_lossy())
}

impl FileLocation {
    /// Returns the location of a whole file.
    #[must_use]
    pub fn file(file: &Path) -> Self {
        Self { file: file.to_owned(), line: 0 }
    }

    /// Returns the location where an object was read: its `[[mesh]]`, or the first of its faces in a model file.
    #[must_use]
    pub fn object(scene: &Scene, object: usize) -> Self {
        let origin = &scene.objects[object].origin;
        let line = if origin.line > 0 { origin.line } else { origin.triangle_lines.first().copied().unwrap_or(0) };
        Self { file: PathBuf::from(&origin.file), line }
    }
}

/// Fault found by a check. The three texts are parts of one sentence, without a full stop.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Finding {
    /// Location of the fault.
    #[serde(flatten)]
    pub place: FileLocation,
    /// Fault, with the names of the objects, materials or lights concerned in backquotes.
    pub wrong: String,
    /// Most likely reason; empty if `wrong` already states it.
    pub because: String,
    /// Change that the user can make.
    pub cure: String,
}

/// Finding with the identifier of its check. As text it is one line: location, fault, reason, cure.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Notice {
    /// Identifier of the check that found it ([`super::Check::id`]).
    pub id: &'static str,
    /// Finding.
    #[serde(flatten)]
    pub finding: Finding,
}

impl Notice {
    /// Returns the error for `--strict`, with the same text.
    #[must_use]
    pub fn into_error(self) -> Error {
        let (message, FileLocation { file, line }) = (self.message(), self.finding.place);
        if line > 0 { Error::at(file, line as usize, message) } else { Error::file(file, message) }
    }

    fn message(&self) -> String {
        let Finding { wrong, because, cure, .. } = &self.finding;
        let because = if because.is_empty() { String::new() } else { format!(": {because}") };
        format!("{wrong}{because}; {cure}")
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let FileLocation { file, line } = &self.finding.place;
        let line = if *line > 0 { format!(":{line}") } else { String::new() };
        write!(f, "{}{line}: {}", file.display(), self.message())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_notice_and_its_error_are_the_same_line() {
        let notice = |line, because: &str| Notice {
            id: "odd",
            finding: Finding {
                place: FileLocation { file: "a.toml".into(), line },
                wrong: "`x` is odd".into(),
                because: because.into(),
                cure: "make it even".into(),
            },
        };
        for (notice, text) in [
            (notice(7, ""), "a.toml:7: `x` is odd; make it even"),
            (notice(0, "1 is odd"), "a.toml: `x` is odd: 1 is odd; make it even"),
        ] {
            assert_eq!(notice.to_string(), text);
            let error = notice.into_error();
            assert_eq!((error.to_string().as_str(), error.exit_code()), (text, 2));
        }
    }
}
