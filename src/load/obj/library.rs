//! Reader of MTL files. Checks every statement and rewrites it for `tobj`; data that `tobj` does not return are kept
//! beside it.

use std::collections::HashMap;
use std::fmt::Write;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::lines::Lines;
use super::map::{Map, map};
use super::names::{cleaned, folded};
use super::statement::At;
use super::text::{short, shown, trimmed, unmarked, without_comment, words};
use crate::load::assembly::Assembly;
use crate::system::files::read;
use crate::{Error, Result};

/// Largest difference at which a material's dissolve and transparency still agree.
const SAME_OPACITY: f32 = 1e-3;

/// One material of a file; every number is finite and in range.
#[derive(Debug)]
pub(super) struct Entry {
    /// File, as named by the user.
    pub file: PathBuf,
    /// Line of its `newmtl`.
    pub line: u32,
    /// Name as shown.
    pub name: String,
    /// Values read by `tobj`.
    pub values: tobj::Material,
    /// Transmission filter, `Tf`.
    pub filter: Option<Vec3>,
    /// Picture of the diffuse colour, `map_Kd`.
    pub picture: Option<Map>,
    /// Picture of the opacity, `map_d`.
    pub mask: Option<Map>,
    /// Values of the extension for physically based materials.
    pub metallic: f32,
    pub roughness: f32,
    pub coat: f32,
}

/// Materials of all MTL files of a model.
#[derive(Debug, Default)]
pub(super) struct Library {
    entries: Vec<Entry>,
    /// Entries by name as written, by cleaned name, and by name in any case; the last of each counts.
    exact: HashMap<Vec<u8>, usize>,
    cleaned: HashMap<Vec<u8>, usize>,
    folded: HashMap<String, usize>,
}

impl Library {
    /// Returns the material of that name: as written, else cleaned, else in any case.
    pub(super) fn find(&self, name: &[u8]) -> Option<(usize, &Entry)> {
        let place = self.exact.get(name).or_else(|| self.cleaned.get(&cleaned(name)));
        let place = *place.or_else(|| self.folded.get(&folded(name)))?;
        Some((place, &self.entries[place]))
    }

    /// Adds the materials of a file.
    pub(super) fn read(&mut self, file: &Path, assembly: &mut Assembly<'_>) -> Result<()> {
        let limits = assembly.options.limits;
        let bytes = read(file, limits.file_bytes)?;
        let text = unmarked(&bytes);
        let mut drafts: Vec<Draft> = Vec::new();
        // Statements before the first `newmtl`, or after one without a name, belong to no material.
        let mut named = false;
        for (line, statement) in Lines::new(&text) {
            if statement.len() > limits.line_bytes {
                let place = Error::at(file, line as usize, format!("the line has {} bytes", statement.len()));
                return Err(Error::Limit(format!("{place}; at most {} are read", limits.line_bytes)));
            }
            let statement = trimmed(&statement);
            let keyword = words(statement).next().unwrap_or(b"#");
            if keyword.starts_with(b"#") {
                continue;
            }
            let rest = trimmed(&statement[keyword.len()..]);
            let at = At { file, line, statement };
            let keyword = keyword.to_ascii_lowercase();
            if keyword == b"newmtl" {
                named = !rest.is_empty();
                if !named {
                    assembly.reporter.warn(file, line as usize, "`newmtl` without a name is left out", String::new)?;
                } else if drafts.len() >= limits.objects {
                    return Err(Error::Limit(format!("{}: more than {} materials", file.display(), limits.objects)));
                } else {
                    drafts.push(Draft { name: rest.to_owned(), line, ..Draft::default() });
                }
                continue;
            }
            match drafts.last_mut() {
                Some(draft) if named => draft.statement(&at, &keyword, rest, assembly)?,
                _ => at.warn(assembly, "statements outside a material are left out")?,
            }
        }
        self.take(file, drafts, assembly)
    }

    /// Passes the checked text to `tobj`.
    fn take(&mut self, file: &Path, drafts: Vec<Draft>, assembly: &mut Assembly<'_>) -> Result<()> {
        let mut text = String::new();
        let inverted = transparency_is_opacity(&drafts);
        for (i, draft) in drafts.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "newmtl {i}\n{}", draft.text);
            if let Some(d) = draft.opacity(file, inverted, assembly)? {
                let _ = writeln!(text, "d {d}");
            }
        }
        let (materials, _) = tobj::load_mtl_buf(&mut Cursor::new(text))
            .map_err(|e| Error::file(file, format!("cannot be read: {e}")))?;
        if materials.len() != drafts.len() {
            return Err(Error::file(file, "cannot be read: materials were lost"));
        }
        for (draft, values) in drafts.into_iter().zip(materials) {
            let place = self.entries.len();
            if self.exact.insert(draft.name.clone(), place).is_some() {
                let kind = format!("material `{}` is defined again; the last one counts", short(&draft.name));
                assembly.reporter.warn(file, draft.line as usize, &kind, String::new)?;
            }
            self.cleaned.insert(cleaned(&draft.name), place);
            self.folded.insert(folded(&draft.name), place);
            self.entries.push(Entry {
                file: file.to_owned(),
                line: draft.line,
                name: shown(&cleaned(&draft.name)),
                values,
                filter: draft.filter.map(Vec3::from),
                picture: draft.picture,
                mask: draft.mask,
                metallic: draft.metallic,
                roughness: draft.roughness,
                coat: draft.coat,
            });
        }
        Ok(())
    }
}

/// Returns true if the writer of a file means opacity by `Tr`: a material has `Tr 1` and no `d`, as several exporters
/// write opaque ones, and none has `Tr 0` and no `d`.
fn transparency_is_opacity(drafts: &[Draft]) -> bool {
    let alone =
        |share: f32| drafts.iter().any(|d| d.dissolve.is_none() && d.transparency.is_some_and(|t| t.0 == share));
    alone(1.0) && !alone(0.0)
}

/// Material whose statements are being read.
#[derive(Debug, Default)]
struct Draft {
    name: Vec<u8>,
    line: u32,
    /// Checked statements for `tobj`.
    text: String,
    /// Values of `d` and `Tr`, with their lines.
    dissolve: Option<(f32, u32)>,
    transparency: Option<(f32, u32)>,
    filter: Option<[f32; 3]>,
    picture: Option<Map>,
    mask: Option<Map>,
    metallic: f32,
    roughness: f32,
    coat: f32,
}

impl Draft {
    fn statement(&mut self, at: &At<'_>, keyword: &[u8], rest: &[u8], assembly: &mut Assembly<'_>) -> Result<()> {
        let numbers = without_comment(rest);
        let mut words = words(numbers);
        let first = words.next();
        match keyword {
            b"ka" | b"kd" | b"ks" | b"ke" | b"tf" => {
                if first.is_some_and(|w| w.eq_ignore_ascii_case(b"spectral") || w.eq_ignore_ascii_case(b"xyz")) {
                    return at.warn(assembly, "spectral and CIE colours are left out; give red, green and blue");
                }
                let Some(colour) = at.colour(numbers, keyword == b"ke", assembly)? else { return Ok(()) };
                let name = match keyword {
                    b"ka" => "Ka",
                    b"kd" => "Kd",
                    b"ks" => "Ks",
                    b"ke" => "Ke",
                    _ => {
                        self.filter = Some(colour);
                        return Ok(());
                    }
                };
                self.line_for_tobj(format_args!("{name} {} {} {}", colour[0], colour[1], colour[2]));
            }
            b"ni" => {
                // Programs write 0 for an index that they do not know.
                if let Some(n) = at.number(first, assembly)? {
                    self.line_for_tobj(format_args!("Ni {n}"));
                }
            }
            b"ns" => {
                if let Some(exponent) = at.within(first, [0.0, 1e6], assembly)? {
                    self.line_for_tobj(format_args!("Ns {exponent}"));
                }
            }
            b"d" | b"tr" => {
                let halo = first.is_some_and(|w| w.eq_ignore_ascii_case(b"-halo"));
                if halo {
                    at.warn(assembly, "`-halo` is left out; the dissolve is the same at every angle")?;
                }
                let word = if halo { words.next() } else { first };
                if let Some(share) = at.within(word, [0.0, 1.0], assembly)? {
                    *(if keyword == b"d" { &mut self.dissolve } else { &mut self.transparency }) =
                        Some((share, at.line));
                }
            }
            b"illum" => match at.number(first, assembly)? {
                Some(model) if (0.0..=10.0).contains(&model) && model.fract() == 0.0 => {
                    self.line_for_tobj(format_args!("illum {model}"));
                }
                Some(_) => at.warn(assembly, "there are illumination models 0 to 10; this one is left out")?,
                None => {}
            },
            b"pm" => self.metallic = at.within(first, [0.0, 1.0], assembly)?.unwrap_or(0.0),
            b"pr" => self.roughness = at.within(first, [0.0, 1.0], assembly)?.unwrap_or(0.0),
            b"pc" => self.coat = at.within(first, [0.0, 1.0], assembly)?.unwrap_or(0.0),
            b"map_kd" | b"map_d" | b"map_tr" => {
                let map = map(at.line, rest);
                if map.file.is_empty() {
                    return at.warn(assembly, "a picture without a file is left out");
                }
                for option in &map.unused {
                    at.warn(assembly, &format!("the texture option `{option}` is left out"))?;
                }
                match keyword {
                    b"map_kd" => self.picture = Some(map),
                    b"map_d" => self.mask = Some(map),
                    _ => at.warn(assembly, "`map_Tr` is not used and left out; write `map_d`")?,
                }
            }
            _ => {
                let kind = format!("`{}` is not used and left out", short(&at.statement[..keyword.len()]));
                at.warn(assembly, &kind)?;
            }
        }
        Ok(())
    }

    fn line_for_tobj(&mut self, line: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.text.write_fmt(line);
        self.text.push('\n');
    }

    /// Returns the opacity: `d`, else 1 minus `Tr`, or `Tr` itself if `inverted`.
    fn opacity(&self, file: &Path, inverted: bool, assembly: &mut Assembly<'_>) -> Result<Option<f32>> {
        let name = short(&self.name);
        match (self.dissolve, self.transparency) {
            (Some((d, _)), Some((tr, line))) if (d - (1.0 - tr)).abs() > SAME_OPACITY => {
                let kind = format!("`Tr {tr}` and `d {d}` of material `{name}` disagree; `d` counts");
                assembly.reporter.warn(file, line as usize, &kind, String::new)?;
                Ok(Some(d))
            }
            (Some((d, _)), _) => Ok(Some(d)),
            (None, Some((tr, line))) if inverted => {
                let kind = format!(
                    "`Tr {tr}` of material `{name}`, without `d`, counts as opacity, as in files whose opaque materials \
                     have `Tr 1`; write `d {tr}`, or `d {}` if it is transparency",
                    1.0 - tr
                );
                assembly.reporter.warn(file, line as usize, &kind, String::new)?;
                Ok(Some(tr))
            }
            (None, Some((tr, _))) => Ok(Some(1.0 - tr)),
            (None, None) => Ok(None),
        }
    }
}
