//! Pre-pass over an MTL file. Checks every statement and rewrites it for `tobj`; data that `tobj` does not return
//! (lines, `Tf`) are kept beside it.

use std::collections::HashMap;
use std::fmt::Write;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::lines::Lines;
use super::scan::short;
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
    /// Name of the material.
    pub name: String,
    /// Values read by `tobj`.
    pub values: tobj::Material,
    /// Transmission filter, `Tf`.
    pub filter: Option<Vec3>,
    /// Line of its `map_Kd`.
    pub picture_line: u32,
    /// Invalid refractive index, with its line; it matters only where light is refracted.
    pub wrong_index: Option<(f32, u32)>,
}

/// Materials of all MTL files of a model.
#[derive(Debug, Default)]
pub(super) struct Library {
    entries: Vec<Entry>,
    places: HashMap<String, usize>,
}

impl Library {
    /// Returns the material of that name; of several, the last.
    pub(super) fn find(&self, name: &str) -> Option<&Entry> {
        self.places.get(name).map(|&i| &self.entries[i])
    }

    /// Adds the materials of a file.
    pub(super) fn read(&mut self, file: &Path, assembly: &mut Assembly<'_>) -> Result<()> {
        let limits = assembly.options.limits;
        let bytes = read(file, limits.file_bytes)?;
        let text = super::text(file, &bytes, assembly)?;
        let mut drafts: Vec<Draft> = Vec::new();
        // Statements before the first `newmtl`, or after one without a name, belong to no material.
        let mut named = false;
        for (line, statement) in Lines::new(&text) {
            if statement.len() > limits.line_bytes {
                let place = Error::at(file, line as usize, format!("the line has {} bytes", statement.len()));
                return Err(Error::Limit(format!("{place}; at most {} are read", limits.line_bytes)));
            }
            let statement = statement.trim();
            let keyword = statement.split_ascii_whitespace().next().unwrap_or("#");
            if keyword.starts_with('#') {
                continue;
            }
            let rest = statement[keyword.len()..].trim();
            if keyword == "newmtl" {
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
                Some(draft) if named => draft.statement(&At { file, line, statement }, keyword, rest, assembly)?,
                _ => assembly.reporter.warn(
                    file,
                    line as usize,
                    "statements outside a material are left out",
                    String::new,
                )?,
            }
        }
        self.take(file, drafts, assembly)
    }

    /// Passes the checked text to `tobj`.
    fn take(&mut self, file: &Path, drafts: Vec<Draft>, assembly: &mut Assembly<'_>) -> Result<()> {
        let mut text = String::new();
        for (i, draft) in drafts.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "newmtl {i}\n{}", draft.text);
            if let Some(d) = draft.opacity(file, assembly)? {
                let _ = writeln!(text, "d {d}");
            }
        }
        let (materials, _) = tobj::load_mtl_buf(&mut Cursor::new(text))
            .map_err(|e| Error::file(file, format!("cannot be read: {e}")))?;
        if materials.len() != drafts.len() {
            return Err(Error::file(file, "cannot be read: materials were lost"));
        }
        for (draft, values) in drafts.into_iter().zip(materials) {
            if self.places.insert(draft.name.clone(), self.entries.len()).is_some() {
                let kind = format!("material `{}` is defined again; the last one counts", short(&draft.name));
                assembly.reporter.warn(file, draft.line as usize, &kind, String::new)?;
            }
            let filter = values.unknown_param.get("Tf").map(|t| {
                let mut numbers = t.split(' ').map(|n| n.parse().unwrap_or(1.0));
                Vec3::from_array(std::array::from_fn(|_| numbers.next().unwrap_or(1.0)))
            });
            self.entries.push(Entry {
                file: file.to_owned(),
                line: draft.line,
                name: draft.name,
                values,
                filter,
                picture_line: draft.picture_line,
                wrong_index: draft.wrong_index,
            });
        }
        Ok(())
    }
}

/// Statement with its location.
struct At<'f> {
    file: &'f Path,
    line: u32,
    statement: &'f str,
}

impl At<'_> {
    fn error(&self, what: &str) -> Error {
        Error::at(self.file, self.line as usize, format!("`{}`: {what}", short(self.statement)))
    }

    fn warn(&self, assembly: &mut Assembly<'_>, kind: &str) -> Result<()> {
        assembly.reporter.warn(self.file, self.line as usize, kind, || format!(": `{}`", short(self.statement)))
    }

    /// Parses a finite number of at least 0.
    fn number(&self, word: &str) -> Result<f32> {
        let number: f32 = word.parse().map_err(|_| match word {
            "" => self.error("a number is missing; add it"),
            w if w.contains(',') => self.error("this is no number; write decimals with a point"),
            _ => self.error("this is no number"),
        })?;
        if number.is_finite() && number >= 0.0 {
            Ok(number)
        } else {
            Err(self.error("the number must be finite and at least 0"))
        }
    }

    /// Parses three numbers, or one for all three.
    fn colour(&self, words: &[&str]) -> Result<[f32; 3]> {
        match words {
            [one] => Ok([self.number(one)?; 3]),
            [r, g, b, ..] => Ok([self.number(r)?, self.number(g)?, self.number(b)?]),
            _ => Err(self.error("a colour has three numbers, or one for a grey")),
        }
    }
}

/// Material whose statements are being read.
#[derive(Debug, Default)]
struct Draft {
    name: String,
    line: u32,
    /// Checked statements for `tobj`.
    text: String,
    /// Values of `d` and `Tr`, with their lines.
    dissolve: Option<(f32, u32)>,
    transparency: Option<(f32, u32)>,
    picture_line: u32,
    wrong_index: Option<(f32, u32)>,
}

impl Draft {
    fn statement(&mut self, at: &At<'_>, keyword: &str, rest: &str, assembly: &mut Assembly<'_>) -> Result<()> {
        // A comment may follow numbers, but names may contain `#`.
        let numbers = rest.split('#').next().unwrap_or("");
        let words: Vec<&str> = numbers.split_ascii_whitespace().collect();
        let first = words.first().copied().unwrap_or("");
        match keyword {
            "Ka" | "Kd" | "Ks" | "Ke" | "Tf" => {
                if matches!(first, "spectral" | "xyz") {
                    return at.warn(assembly, "spectral and CIE colours are left out");
                }
                let mut colour = at.colour(&words)?;
                if keyword != "Ke" && colour.iter().any(|&c| c > 1.0) {
                    if colour.iter().any(|&c| c > 1e4) {
                        return Err(at.error("a share of light is at most 1"));
                    }
                    at.warn(assembly, "shares of light above 1 count as 1")?;
                    colour = colour.map(|c| c.min(1.0));
                }
                self.line_for_tobj(format_args!("{keyword} {} {} {}", colour[0], colour[1], colour[2]));
            }
            "Ni" => match first.parse::<f32>() {
                Ok(n) if (1e-3..=1e3).contains(&n) => {
                    self.line_for_tobj(format_args!("Ni {n}"));
                    self.wrong_index = None;
                }
                Ok(n) => self.wrong_index = Some((n, at.line)),
                Err(_) => return Err(at.error("this is no refractive index")),
            },
            "Ns" => {
                let exponent = at.number(first)?;
                if exponent > 1e6 {
                    return Err(at.error("a highlight's exponent is at most 1e6"));
                }
                self.line_for_tobj(format_args!("Ns {exponent}"));
            }
            "d" | "Tr" => {
                let halo = first == "-halo";
                if halo {
                    at.warn(assembly, "`-halo` is left out; the dissolve is the same at every angle")?;
                }
                let share = at.number(if halo { words.get(1).copied().unwrap_or("") } else { first })?;
                if share > 1.0 {
                    return Err(at.error("a share is at most 1"));
                }
                *(if keyword == "d" { &mut self.dissolve } else { &mut self.transparency }) = Some((share, at.line));
            }
            "illum" => match first.parse::<u32>() {
                Ok(model @ 0..=10) => self.line_for_tobj(format_args!("illum {model}")),
                _ => at.warn(assembly, "there are illumination models 0 to 10; this one is left out")?,
            },
            "map_Kd" => {
                let (file, options) = texture_file(rest);
                if file.is_empty() {
                    return at.warn(assembly, "a picture without a file is left out");
                }
                if options {
                    at.warn(assembly, "texture options are left out")?;
                }
                self.picture_line = at.line;
                self.line_for_tobj(format_args!("map_Kd {file}"));
            }
            _ => {
                let kind = format!("`{}` is not used and left out", short(keyword));
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

    /// Returns the opacity: `d`, else 1 minus `Tr`.
    fn opacity(&self, file: &Path, assembly: &mut Assembly<'_>) -> Result<Option<f32>> {
        if let (Some((d, _)), Some((tr, line))) = (self.dissolve, self.transparency)
            && (d - (1.0 - tr)).abs() > SAME_OPACITY
        {
            let kind = format!("`Tr {tr}` and `d {d}` of material `{}` disagree; `d` counts", short(&self.name));
            assembly.reporter.warn(file, line as usize, &kind, String::new)?;
        }
        Ok(self.dissolve.map(|d| d.0).or(self.transparency.map(|t| 1.0 - t.0)))
    }
}

/// Returns the file of a texture statement, and true if options precede it.
fn texture_file(rest: &str) -> (&str, bool) {
    let mut rest = rest.trim();
    let mut options = false;
    while let Some(word) = rest.split_ascii_whitespace().next().filter(|w| w.starts_with('-')) {
        // Smallest and largest number of words that an option takes.
        let (least, most) = match word {
            "-blendu" | "-blendv" | "-boost" | "-texres" | "-clamp" | "-bm" | "-imfchan" | "-type" | "-cc" => (1, 1),
            "-mm" => (2, 2),
            "-o" | "-s" | "-t" => (1, 3),
            _ => break,
        };
        options = true;
        rest = rest[word.len()..].trim_start();
        for taken in 0..most {
            let Some(argument) = rest.split_ascii_whitespace().next() else { break };
            if taken >= least && argument.parse::<f32>().is_err() {
                break;
            }
            rest = rest[argument.len()..].trim_start();
        }
    }
    (rest, options)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texture_options_are_told_from_the_file() {
        assert_eq!(texture_file("t.png"), ("t.png", false));
        assert_eq!(texture_file("-s 1 1 1 t.png"), ("t.png", true));
        assert_eq!(texture_file("-s 2 my picture.png"), ("my picture.png", true));
        assert_eq!(texture_file("-bm 0.5 -clamp on -o 0 0 a\\b.jpg"), ("a\\b.jpg", true));
        assert_eq!(texture_file("-mm 0 1"), ("", true));
        assert_eq!(texture_file("-odd.png"), ("-odd.png", false));
    }
}
