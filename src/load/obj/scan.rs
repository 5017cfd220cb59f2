//! Pre-pass over an OBJ file: checks every statement, parses every number, and makes every index absolute. Keeps the
//! line of each face.

use std::path::Path;

use glam::{DVec3, Vec2, Vec3};

use super::lines::Lines;
use crate::geometry::COORDINATE_LIMIT;
use crate::load::Limits;
use crate::load::extent::{Extent, within};
use crate::load::report::Reporter;
use crate::system::memory;
use crate::{Error, Result};

/// Cure for a model that exceeds the available memory.
pub(super) const CURE: &str = "take a smaller model";

/// Index of a missing attribute.
pub(super) const NONE: u32 = u32::MAX;

/// Corner of a face: indices of its position, texture coordinate and normal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Corner {
    pub v: u32,
    pub vt: u32,
    pub vn: u32,
}

/// Face of the file.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Face {
    pub line: u32,
    /// Corners, as a range of [`Scan::corners`].
    pub first: usize,
    pub count: usize,
    /// Index into [`Scan::uses`].
    pub material: u32,
}

/// Content of an OBJ file.
#[derive(Debug, Default)]
pub(super) struct Scan {
    /// Positions, of any value.
    pub positions: Vec<DVec3>,
    /// True if positions have all digits of the file; else they are rounded to `f32`, which suffices for rendering.
    pub precise: bool,
    /// Largest magnitude of a coordinate that can be rendered.
    pub widest: f64,
    /// Texture coordinates, finite.
    pub uvs: Vec<Vec2>,
    /// Normals; zero or not finite if the file gives no direction.
    pub normals: Vec<Vec3>,
    pub corners: Vec<Corner>,
    pub faces: Vec<Face>,
    /// Names of the materials used by faces, with the line of their first use; the first entry stands for no name.
    pub uses: Vec<(String, u32)>,
    /// Material files, with their lines.
    pub libraries: Vec<(String, u32)>,
}

/// Parses the statements of an OBJ file. Coordinates beyond [`COORDINATE_LIMIT`] count as wrong. If most exceed it,
/// `widest` replaces that limit.
pub(super) fn scan(file: &Path, text: &str, widest: f64, limits: &Limits, reporter: &mut Reporter) -> Result<Scan> {
    let mut scan = Scan { uses: vec![(String::new(), 0)], ..Scan::default() };
    let mut places = std::collections::HashMap::from([(String::new(), 0u32)]);
    let mut material = 0;
    let limit = limits.vertices.min(u64::from(NONE - 1)) as usize;
    let what = format!("the vertices and faces of {}", file.display());
    for (line, text) in Lines::new(text) {
        let at = Place { file, line };
        if text.len() > limits.line_bytes {
            let place = at.error(format!("the line has {} bytes", text.len()));
            return Err(Error::Limit(format!("{place}; at most {} are read", limits.line_bytes)));
        }
        // A comment may follow a statement, but a name may contain `#`.
        let (code, statement) = (text.split('#').next().unwrap_or(""), text.trim());
        let mut words = code.split_ascii_whitespace();
        let Some(keyword) = words.next() else { continue };
        match keyword {
            "v" => {
                let position = at.numbers(code, &mut words, wide)?;
                if let (Some(w), None) = (words.next(), words.next())
                    && w.parse() != Ok(1.0f32)
                {
                    reporter.warn(file, line as usize, "the weight of a vertex is left out", || {
                        format!(": `{}`", short(code))
                    })?;
                }
                memory::push(&mut scan.positions, DVec3::from(position), &what, CURE)?;
            }
            "vt" => {
                let first = words.next().unwrap_or("");
                let u = at.number(code, first, narrow)?;
                let v = words.next().map_or(Ok(0.0), |w| at.number(code, w, narrow))?;
                let uv = Vec2::new(u, v);
                if !uv.is_finite() {
                    reporter.warn(
                        file,
                        line as usize,
                        "a texture coordinate that is not finite counts as 0",
                        || format!(": `{}`", short(code)),
                    )?;
                }
                let uv = if uv.is_finite() { uv } else { Vec2::ZERO };
                memory::push(&mut scan.uvs, uv, &what, CURE)?;
            }
            "vn" => {
                let normal = Vec3::from(at.numbers(code, &mut words, narrow)?);
                memory::push(&mut scan.normals, normal, &what, CURE)?;
            }
            "f" | "fo" => {
                let first = scan.corners.len();
                for word in words {
                    let corner = at.corner(word, &scan)?;
                    memory::push(&mut scan.corners, corner, &what, CURE)?;
                }
                if scan.faces.len() as u64 >= limits.triangles {
                    return Err(Error::Limit(format!("{}: more than {} faces", file.display(), limits.triangles)));
                }
                let count = scan.corners.len() - first;
                memory::push(&mut scan.faces, Face { line, first, count, material }, &what, CURE)?;
            }
            "usemtl" => {
                let name = statement[keyword.len()..].trim();
                if name.is_empty() {
                    reporter.warn(
                        file,
                        line as usize,
                        "`usemtl` without a name: the default material is used",
                        String::new,
                    )?;
                }
                material = match places.get(name) {
                    Some(&place) => place,
                    None => {
                        let place = scan.uses.len() as u32;
                        if scan.uses.len() > limits.objects {
                            return Err(Error::Limit(format!(
                                "{}: more than {} materials",
                                file.display(),
                                limits.objects
                            )));
                        }
                        places.insert(name.to_owned(), place);
                        scan.uses.push((name.to_owned(), line));
                        place
                    }
                };
            }
            "mtllib" => {
                let name = statement[keyword.len()..].trim();
                if scan.libraries.iter().all(|(known, _)| known != name) {
                    if scan.libraries.len() >= 1000 {
                        return Err(Error::Limit(format!("{}: more than 1000 material files", file.display())));
                    }
                    scan.libraries.push((name.to_owned(), line));
                }
            }
            // Groups and objects have no effect on the picture; smoothing is requested in the scene.
            "g" | "o" | "s" => {}
            _ => {
                let kind = match keyword {
                    "l" | "p" => String::from("points and lines are left out"),
                    _ => format!("statement `{}` is not understood and left out", short(keyword)),
                };
                reporter.warn(file, line as usize, &kind, String::new)?;
            }
        }
        if scan.positions.len().max(scan.uvs.len()).max(scan.normals.len()) > limit {
            return Err(Error::Limit(format!("{}: more than {limit} vertices", file.display())));
        }
    }
    check_indices(file, &mut scan, reporter)?;
    let drawn = scan.faces.iter().flat_map(|f| &scan.corners[f.first..f.first + f.count]);
    let places = drawn.map(|c| scan.positions[c.v as usize]);
    let usual = f64::from(COORDINATE_LIMIT);
    let beyond = places.clone().filter(|&p| within(p, widest) && !within(p, usual)).count();
    scan.widest = if 2 * beyond > scan.corners.len() { widest } else { usual };
    let places = places.filter(|&p| within(p, scan.widest));
    scan.precise = !Extent::around(places).suits_f32();
    if !scan.precise {
        scan.positions.iter_mut().for_each(|p| *p = p.as_vec3().as_dvec3());
    }
    Ok(scan)
}

fn narrow(word: &str) -> Option<f32> {
    word.parse().ok()
}

/// Parses a decimal to an `f64` that also rounds to the `f32` nearest to the decimal.
fn wide(word: &str) -> Option<f64> {
    let x: f64 = word.parse().ok()?;
    // Double rounding can differ halfway between two `f32`, which shows in the last 29 bits of a normal number.
    let halfway = x.to_bits() & 0x1fff_ffff == 0x1000_0000;
    let tiny = x != 0.0 && x.abs() < f64::from(f32::MIN_POSITIVE);
    if halfway || tiny {
        let once: f32 = word.parse().ok()?;
        if x as f32 != once {
            return Some(if f64::from(once) > x { x.next_up() } else { x.next_down() });
        }
    }
    Some(x)
}

/// Checks indices at the end, since positive ones may point forward.
fn check_indices(file: &Path, scan: &mut Scan, reporter: &mut Reporter) -> Result<()> {
    let counts = [scan.positions.len(), scan.uvs.len(), scan.normals.len()];
    for face in &scan.faces {
        for corner in &mut scan.corners[face.first..face.first + face.count] {
            let given = [corner.v, corner.vt, corner.vn];
            for (kind, (&index, &count)) in given.iter().zip(&counts).enumerate() {
                if index == NONE || (index as usize) < count {
                    continue;
                }
                let what = ["vertex", "texture coordinate", "normal"][kind];
                // A file without normals may still refer to them.
                if kind > 0 && count == 0 {
                    let text = format!("faces point at {what}s, and the file has none: those are left out");
                    reporter.warn(file, face.line as usize, &text, String::new)?;
                    *[&mut corner.vt, &mut corner.vn][kind - 1] = NONE;
                    continue;
                }
                let message = format!("the face points at {what} {}; the file has {count}", u64::from(index) + 1);
                return Err(Error::at(file, face.line as usize, message));
            }
        }
    }
    Ok(())
}

/// Line of the file, for messages.
struct Place<'f> {
    file: &'f Path,
    line: u32,
}

impl Place<'_> {
    fn error(&self, message: String) -> Error {
        Error::at(self.file, self.line as usize, message)
    }

    fn number<T>(&self, statement: &str, word: &str, read: fn(&str) -> Option<T>) -> Result<T> {
        read(word).ok_or_else(|| {
            let statement = short(statement.trim());
            self.error(match word {
                "" => format!("`{statement}` has too few numbers"),
                w if w.contains(',') => {
                    format!("`{statement}`: `{}` is no number; write decimals with a point", short(w))
                }
                w => format!("`{statement}`: `{}` is no number", short(w)),
            })
        })
    }

    fn numbers<'w, T>(
        &self,
        statement: &str,
        words: &mut impl Iterator<Item = &'w str>,
        read: fn(&str) -> Option<T>,
    ) -> Result<[T; 3]> {
        let mut next = || self.number(statement, words.next().unwrap_or(""), read);
        Ok([next()?, next()?, next()?])
    }

    /// Parses `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, word: &str, scan: &Scan) -> Result<Corner> {
        let mut parts = word.split('/');
        let mut next = |count: usize, what: &str, needed: bool| match parts.next() {
            None | Some("") if !needed => Ok(NONE),
            None | Some("") => Err(self.error(format!("corner `{}` of the face names no {what}", short(word)))),
            Some(part) => self.index(part, count, what),
        };
        let corner = Corner {
            v: next(scan.positions.len(), "vertex", true)?,
            vt: next(scan.uvs.len(), "texture coordinate", false)?,
            vn: next(scan.normals.len(), "normal", false)?,
        };
        match parts.next() {
            None => Ok(corner),
            Some(_) => Err(self.error(format!("corner `{}` of the face has more than three indices", short(word)))),
        }
    }

    /// Parses an index: from 1, or from -1 backwards from the latest of `count`.
    fn index(&self, part: &str, count: usize, what: &str) -> Result<u32> {
        let index: i64 = part.parse().map_err(|e: std::num::ParseIntError| {
            let why = match e.kind() {
                std::num::IntErrorKind::PosOverflow | std::num::IntErrorKind::NegOverflow => "is out of range",
                _ => "is no index",
            };
            self.error(format!("`{}`, a {what} of the face, {why}", short(part)))
        })?;
        let place = match index {
            0 => return Err(self.error(format!("a face points at {what} 0; they count from 1"))),
            1.. => index - 1,
            _ => (count as i64).checked_add(index).filter(|&i| i >= 0).ok_or_else(|| {
                self.error(format!("the face points {index} {what} back; only {count} come before it"))
            })?,
        };
        u32::try_from(place)
            .ok()
            .filter(|&i| i != NONE)
            .ok_or_else(|| self.error(format!("the face points at {what} {index}, which is out of range")))
    }
}

/// Returns enough of a text for a message.
pub(super) fn short(text: &str) -> String {
    let mut out: String = text.chars().take(60).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if out.len() < text.len() {
        out.push_str("...");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_keep_the_digits_of_f64_and_still_round_to_the_f32_nearest_to_the_decimal() {
        assert_eq!(wide("5411234.441013"), Some(5411234.441013));
        assert_eq!(wide("x"), None);
        // Above halfway between 1 and the next `f32`, by less than `f64` resolves.
        let above = "1.000000059604644775390625000000000001";
        assert_eq!(above.parse::<f64>().unwrap() as f32, 1.0);
        assert_eq!(wide(above).unwrap() as f32, 1.0_f32.next_up());
        // Below halfway, where the tie would round up.
        let below = "1.000000178813934326171874999999999999";
        assert_eq!(below.parse::<f64>().unwrap() as f32, 1.0_f32.next_up().next_up());
        assert_eq!(wide(below).unwrap() as f32, 1.0_f32.next_up());
        // Between 1 and 2 times the smallest `f32`, above the middle.
        let tiny = "2.10194769649500000000000000001e-45";
        assert_eq!(wide(tiny).unwrap() as f32, tiny.parse::<f32>().unwrap());
        assert_eq!(wide("-0").unwrap().to_bits(), (-0.0_f64).to_bits());
        assert_eq!(wide("1e39").unwrap() as f32, f32::INFINITY);
    }
}
