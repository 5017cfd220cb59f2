//! Journal of a study: measurements kept in a folder, so that a study can be stopped and continued.

use std::fs::{self, File, OpenOptions};
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::io::{self, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::energy::Ledger;
use super::errors::Errors;
use super::reference::{Made, Reference};
use super::variant::Variant;
use crate::error::{Error, Result, Unsupported};
use crate::image::{self, Bits, Destination, Encoding, Film, Format, ReadOptions};
use crate::render::{RayCounts, RayKind};
use crate::system::files;

/// Subfolder reserved for the study's own files.
const KEPT: &str = "study";

/// Size of a journal that is read, at most: far more than all levels of all axes take.
const LARGEST: u64 = 64 << 20;

/// Measurements of one variant.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Record {
    /// Choices.
    pub variant: Variant,
    /// Wall time of each timed render, in seconds.
    pub seconds: Vec<f64>,
    /// Time of each render relative to the default variant's in the same round.
    pub ratios: Vec<f64>,
    /// Time of each render relative to the same walk with the watertight test and true division, in the same round.
    /// Only for variants that choose among these.
    #[serde(default)]
    pub walk_ratios: Vec<f64>,
    /// Share of triangle tests that fell back to `f64`. Only for variants that choose among these.
    #[serde(default)]
    pub settled: Option<f64>,
    /// Wall time of building the hierarchy, in seconds.
    pub build_seconds: f64,
    /// Number of rays traced.
    pub rays: Rays,
    /// Errors against `f64` with the exact choices at the default's rays per pixel, if the variant has as many.
    pub own: Option<Errors>,
    /// Errors against 16 by 16 rays per pixel.
    pub fine: Option<Errors>,
    /// Difference to the default variant's picture.
    pub change: Option<Change>,
    /// Energy balance.
    pub ledger: Ledger,
    /// File of its picture in the study's folder.
    pub film: String,
}

/// Difference of two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Root of the mean squared difference over all channels.
    pub rmse: f64,
    /// Largest difference of a channel.
    pub max: f64,
}

/// Numbers of rays by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rays {
    /// All rays.
    pub total: u64,
    /// Camera rays.
    pub camera: u64,
    /// Reflected rays.
    pub reflected: u64,
    /// Refracted or passing rays.
    pub transmitted: u64,
    /// Shadow rays.
    pub shadow: u64,
    /// Deepest level reached.
    pub deepest: u64,
}

impl From<&RayCounts> for Rays {
    fn from(counts: &RayCounts) -> Self {
        Self {
            total: counts.total(),
            camera: counts.of(RayKind::Camera),
            reflected: counts.of(RayKind::Reflected),
            transmitted: counts.of(RayKind::Transmitted),
            shadow: counts.of(RayKind::Shadow),
            deepest: counts.by_depth.len().saturating_sub(1) as u64,
        }
    }
}

/// Header of a journal, its first line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// Digest of the scene, the default choices, the program and the machine.
    pub digest: String,
    /// Columns of its pictures.
    pub width: u32,
    /// Rows of its pictures.
    pub height: u32,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Line {
    Study(Header),
    Own(Made),
    Fine(Made),
    Variant(Box<Record>),
}

/// Folder of a study with its content.
#[derive(Debug)]
pub struct Journal {
    folder: PathBuf,
    /// Header, once known.
    pub header: Option<Header>,
    /// Reference for all axes except sampling.
    pub own: Option<Reference>,
    /// Reference for the sampling axis.
    pub fine: Option<Reference>,
    /// Measurements, in their order.
    pub records: Vec<Record>,
}

impl Journal {
    /// Opens the journal in `folder`, which is created if missing, and reads the study of `digest`. A truncated last
    /// line, and records whose pictures are missing, are measured again.
    ///
    /// # Errors
    /// - `Error::Io` if a file cannot be read or created.
    /// - `Error::Unsupported` if the folder contains another study, unless `fresh` discards it.
    pub fn open(folder: &Path, digest: &str, fresh: bool) -> Result<Self> {
        let kept = folder.join(KEPT);
        files::create_folder(&kept)?;
        let mut journal = Self { folder: kept, header: None, own: None, fine: None, records: Vec::new() };
        let path = journal.path();
        if fresh {
            journal.forget()?;
            return Ok(journal);
        }
        if fs::symlink_metadata(&path).is_err_and(|e| e.kind() == io::ErrorKind::NotFound) {
            return Ok(journal);
        }
        let bytes = files::read(&path, LARGEST)?;
        let text = String::from_utf8_lossy(&bytes);
        for line in text.lines() {
            match serde_json::from_str(line) {
                Ok(Line::Study(header)) if header.digest == digest => journal.header = Some(header),
                Ok(Line::Study(_)) => {
                    return Err(Unsupported::AnotherStudy { folder: folder.to_owned() }.into());
                }
                Ok(Line::Own(made)) => journal.own = journal.reference(made),
                Ok(Line::Fine(made)) => journal.fine = journal.reference(made),
                Ok(Line::Variant(record)) => journal.put(*record),
                Err(_) => {}
            }
        }
        let there = |record: &Record| journal.film(&record.film).is_some();
        let there: Vec<bool> = journal.records.iter().map(there).collect();
        let mut there = there.into_iter();
        journal.records.retain(|_| there.next().unwrap_or(false));
        Ok(journal)
    }

    fn put(&mut self, record: Record) {
        match self.records.iter_mut().find(|r| r.variant == record.variant) {
            Some(old) => *old = record,
            None => self.records.push(record),
        }
    }

    fn path(&self) -> PathBuf {
        self.folder.join("journal.jsonl")
    }

    fn forget(&self) -> Result<()> {
        let entries = fs::read_dir(&self.folder).map_err(|e| Error::io(&self.folder, "read", e))?;
        for path in entries.filter_map(|entry| entry.ok().map(|e| e.path())) {
            let ours = path.extension().is_some_and(|e| e == "pfm" || e == "jsonl");
            if ours {
                fs::remove_file(&path).map_err(|e| Error::io(&path, "remove", e))?;
            }
        }
        Ok(())
    }

    fn reference(&self, made: Made) -> Option<Reference> {
        self.film(&made.film).map(|film| Reference { film, made })
    }

    /// Returns a stored picture.
    #[must_use]
    pub fn film(&self, name: &str) -> Option<Film> {
        image::read(&self.folder.join(name), &ReadOptions::default()).ok().map(|picture| picture.film)
    }

    /// Returns the measurements of a variant.
    #[must_use]
    pub fn find(&self, variant: &Variant) -> Option<&Record> {
        self.records.iter().find(|r| r.variant == *variant)
    }

    /// Writes the header.
    ///
    /// # Errors
    /// Returns `Error::Io` if a file cannot be written.
    pub fn begin(&mut self, header: Header) -> Result<()> {
        self.append(&Line::Study(header.clone()))?;
        self.header = Some(header);
        Ok(())
    }

    /// Stores the reference of all axes except sampling.
    ///
    /// # Errors
    /// Returns `Error::Io` if a file cannot be written.
    pub fn keep_own(&mut self, reference: Reference) -> Result<()> {
        self.keep_film(&reference.made.film, &reference.film)?;
        self.append(&Line::Own(reference.made.clone()))?;
        self.own = Some(reference);
        Ok(())
    }

    /// Stores the reference of the sampling axis.
    ///
    /// # Errors
    /// Returns `Error::Io` if a file cannot be written.
    pub fn keep_fine(&mut self, reference: Reference) -> Result<()> {
        self.keep_film(&reference.made.film, &reference.film)?;
        self.append(&Line::Fine(reference.made.clone()))?;
        self.fine = Some(reference);
        Ok(())
    }

    /// Stores the measurements and the picture of a variant, replacing earlier ones.
    ///
    /// # Errors
    /// Returns `Error::Io` if a file cannot be written.
    pub fn keep(&mut self, record: Record, film: &Film) -> Result<()> {
        self.keep_film(&record.film, film)?;
        self.append(&Line::Variant(Box::new(record.clone())))?;
        self.put(record);
        Ok(())
    }

    /// Stores new figures of a variant whose picture exists.
    ///
    /// # Errors
    /// Returns `Error::Io` if a file cannot be written.
    pub fn note(&mut self, record: Record) -> Result<()> {
        self.append(&Line::Variant(Box::new(record.clone())))?;
        self.put(record);
        Ok(())
    }

    fn keep_film(&self, name: &str, film: &Film) -> Result<()> {
        let encoding = Encoding { format: Format::Pfm, bits: Bits::Eight, metadata: Vec::new() };
        Destination::new(&self.folder.join(name))?.write(&image::encode(film, &encoding)?.bytes, || true)
    }

    fn append(&self, line: &Line) -> Result<()> {
        let path = self.path();
        let system = |e| Error::io(&path, "write", e);
        let mut text = serde_json::to_string(line).map_err(|e| system(io::Error::other(e)))?;
        text.push('\n');
        let mut file = OpenOptions::new().create(true).read(true).append(true).open(&path).map_err(system)?;
        if !ends_a_line(&mut file).map_err(system)? {
            text.insert(0, '\n');
        }
        // Written at once, so that a line is complete or missing.
        file.write_all(text.as_bytes()).and_then(|()| file.sync_data()).map_err(system)
    }
}

/// Returns false if the last line of a file was cut short.
fn ends_a_line(file: &mut File) -> io::Result<bool> {
    if file.metadata()?.len() == 0 {
        return Ok(true);
    }
    file.seek(SeekFrom::End(-1))?;
    let mut last = [0];
    file.read_exact(&mut last)?;
    Ok(last == *b"\n")
}

/// Returns the file name of a variant's picture.
#[must_use]
pub fn film_name(variant: &Variant) -> String {
    let mut hasher = DefaultHasher::new();
    format!("{variant:?}").hash(&mut hasher);
    format!("{:016x}.pfm", hasher.finish())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_last_line_that_was_cut_short_is_told_from_a_whole_one() {
        for (text, whole) in [("", true), ("{}\n", true), ("{}\n{\"st", false)] {
            let mut file = tempfile::tempfile().unwrap();
            file.write_all(text.as_bytes()).unwrap();
            assert_eq!(ends_a_line(&mut file).unwrap(), whole, "{text:?}");
        }
    }
}
