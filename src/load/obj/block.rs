//! Parser of one block of an OBJ file. Blocks are parsed side by side, so indices, names and line numbers are relative to
//! the block.

use std::collections::HashMap;

use glam::{DVec3, Vec2, Vec3};

use super::corner::{CURE, Corner, Face, Field, Index, NONE, parse};
use super::lines::Lines;
use super::notes::Notes;
use super::number::{Spelled, narrow, wide};
use super::text::{short, trimmed, without_comment, words};
use crate::Error;
use crate::load::Limits;
use crate::system::memory;

/// State at the start of a block, given by the blocks before: the material and the smoothing group.
pub(super) const INHERITED: u32 = u32::MAX;

/// Reason for which reading ends.
#[derive(Debug)]
pub(super) enum Fault {
    /// A line has this many bytes.
    LongLine(usize),
    /// There are more names of materials or of their files than allowed.
    Names(&'static str, usize),
    /// Memory is short.
    Memory(Error),
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self::Memory(error)
    }
}

/// Content of a block.
#[derive(Debug, Default)]
pub(super) struct Block {
    pub positions: Vec<DVec3>,
    /// Colours of the positions, as the file has them; empty if no vertex of the block has one.
    pub colours: Vec<Vec3>,
    /// Colours by `#MRGB`.
    pub painted: Vec<[u8; 3]>,
    pub uvs: Vec<Vec2>,
    pub normals: Vec<Vec3>,
    pub corners: Vec<Corner>,
    /// Corners with an index that counts backwards: it is relative to the block's start, as an `i32`.
    pub backwards: Vec<(u32, Field)>,
    pub faces: Vec<Face>,
    /// Names of materials, with their lines.
    pub uses: Vec<(Vec<u8>, u32)>,
    /// Material and smoothing group at the end.
    pub last: [u32; 2],
    /// Material files, with their lines.
    pub libraries: Vec<(Vec<u8>, u32)>,
    /// Number of lines.
    pub lines: u32,
    pub notes: Notes,
    /// Fault that ended the block, with its line.
    pub fault: Option<(u32, Fault)>,
    places: HashMap<Vec<u8>, u32>,
}

impl Block {
    /// Parses a block.
    pub(super) fn parse(text: &[u8], limits: &Limits, what: &str) -> Self {
        let mut block = Self { last: [INHERITED; 2], ..Self::default() };
        let mut lines = Lines::new(text);
        for (line, text) in lines.by_ref() {
            if let Err(fault) = block.line(line, &text, limits, what) {
                block.fault = Some((line, fault));
                break;
            }
        }
        block.lines = lines.number();
        block
    }

    fn line(&mut self, line: u32, text: &[u8], limits: &Limits, what: &str) -> Result<(), Fault> {
        if text.len() > limits.line_bytes {
            return Err(Fault::LongLine(text.len()));
        }
        let statement = trimmed(text);
        if let Some(hex) = statement.strip_prefix(b"#MRGB") {
            return self.painted(line, trimmed(hex));
        }
        let code = without_comment(statement);
        let end = code.iter().position(u8::is_ascii_whitespace).unwrap_or(code.len());
        let (keyword, rest) = code.split_at(end);
        if keyword.is_empty() {
            return Ok(());
        }
        if self.statement(line, keyword, rest, statement, limits, what)? {
            return Ok(());
        }
        let lower = keyword.to_ascii_lowercase();
        if lower != keyword && self.statement(line, &lower, rest, statement, limits, what)? {
            self.notes
                .add(line, "statements in capitals are read as small letters", || format!(": `{}`", short(keyword)));
            return Ok(());
        }
        let kind = match lower.as_slice() {
            b"l" | b"p" => "points and lines are left out",
            b"surf" | b"curv" | b"curv2" | b"cstype" | b"deg" | b"bmat" | b"step" | b"parm" | b"trim" | b"hole"
            | b"scrv" | b"sp" | b"con" | b"vp" | b"ctech" | b"stech" | b"cdc" | b"cdp" | b"bzp" | b"bsp" => {
                "free-form curves and surfaces are left out; convert them to polygons"
            }
            b"end" | b"maplib" | b"usemap" | b"shadow_obj" | b"trace_obj" | b"lod" | b"mg" | b"bevel" | b"c_interp"
            | b"d_interp" | b"call" | b"csh" => "statements without an effect on the picture are left out",
            _ => {
                let kind = format!("statement `{}` is not understood and left out", short(keyword));
                self.notes.add(line, kind, String::new);
                return Ok(());
            }
        };
        self.notes.add(line, kind, || format!(": `{}`", short(keyword)));
        Ok(())
    }

    /// Parses a statement; returns false if the keyword is not known.
    fn statement(
        &mut self,
        line: u32,
        keyword: &[u8],
        rest: &[u8],
        whole: &[u8],
        limits: &Limits,
        what: &str,
    ) -> Result<bool, Fault> {
        match keyword {
            b"v" => self.vertex(line, rest, whole, what)?,
            b"vt" => {
                let mut words = words(rest);
                let u = self.number(line, whole, words.next(), narrow, f32::NAN);
                let v = match words.next() {
                    Some(word) => self.number(line, whole, Some(word), narrow, f32::NAN),
                    None => 0.0,
                };
                memory::push(&mut self.uvs, Vec2::new(u, v), what, CURE)?;
            }
            b"vn" => {
                let mut words = words(rest);
                let mut next = || self.number(line, whole, words.next(), narrow, f32::NAN);
                let normal = Vec3::new(next(), next(), next());
                memory::push(&mut self.normals, normal, what, CURE)?;
            }
            b"f" | b"fo" => self.face(line, rest, what)?,
            b"usemtl" => self.usemtl(line, trimmed(&whole[keyword.len()..]), limits)?,
            b"mtllib" => {
                let name = trimmed(&whole[keyword.len()..]);
                if self.libraries.iter().all(|(known, _)| known != name) {
                    if self.libraries.len() >= MOST_LIBRARIES {
                        return Err(Fault::Names("material files", MOST_LIBRARIES));
                    }
                    self.libraries.push((name.to_owned(), line));
                }
            }
            b"s" => {
                let group = words(rest).next().unwrap_or(b"off");
                self.last[1] = match std::str::from_utf8(group).ok().and_then(|g| g.parse::<u32>().ok()) {
                    Some(group) => group.min(INHERITED - 1),
                    None if group.eq_ignore_ascii_case(b"on") => 1,
                    None => 0,
                };
            }
            // Groups and objects have no effect on the picture.
            b"g" | b"o" => {}
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Returns the number of a word, or `missing` with a note.
    #[inline]
    fn number<T>(
        &mut self,
        line: u32,
        whole: &[u8],
        word: Option<&[u8]>,
        read: fn(&[u8]) -> Spelled<T>,
        missing: T,
    ) -> T {
        match word.map_or(Spelled::Not, read) {
            Spelled::Plain(x) => x,
            Spelled::Odd(x) => {
                let kind =
                    "numbers with a decimal comma or an exponent of Fortran are read; write them with a point and `e`";
                self.notes.add(line, kind, || format!(": `{}`", short(whole)));
                x
            }
            Spelled::Not => {
                self.notes.add(line, "numbers that are missing or none count as not given", || match word {
                    None => format!(": `{}` has too few numbers", short(whole)),
                    Some(word) => format!(": `{}`: `{}` is no number", short(whole), short(word)),
                });
                missing
            }
        }
    }

    /// Reads `v x y z`, with a weight, a colour, or both behind.
    fn vertex(&mut self, line: u32, rest: &[u8], whole: &[u8], what: &str) -> Result<(), Fault> {
        let mut words = words(rest);
        let x = self.number(line, whole, words.next(), wide, f64::NAN);
        let y = self.number(line, whole, words.next(), wide, f64::NAN);
        let z = match words.next() {
            None if y.is_finite() => {
                self.notes.add(line, "vertices of two coordinates lie at z = 0", || format!(": `{}`", short(whole)));
                0.0
            }
            word => self.number(line, whole, word, wide, f64::NAN),
        };
        memory::push(&mut self.positions, DVec3::new(x, y, z), what, CURE)?;
        let mut more = [&[][..]; 4];
        let mut count = 0;
        for word in words {
            if count < more.len() {
                more[count] = word;
            }
            count += 1;
        }
        if count == 1 || count >= 4 {
            let weight = narrow(more[0]).number();
            if weight != Some(1.0) {
                self.notes.add(line, "the weight of a vertex is left out", || format!(": `{}`", short(whole)));
            }
        }
        if count >= 3 {
            let channels = &more[count.min(4) - 3..count.min(4)];
            let colour = Vec3::from_array(std::array::from_fn(|i| narrow(channels[i]).number().unwrap_or(1.0)));
            let before = self.positions.len() - 1;
            while self.colours.len() < before {
                memory::push(&mut self.colours, UNCOLOURED, what, CURE)?;
            }
            memory::push(&mut self.colours, if colour.is_finite() { colour } else { UNCOLOURED }, what, CURE)?;
        }
        Ok(())
    }

    /// Reads `#MRGB`: eight hexadecimal digits per vertex, of a mask and three channels.
    fn painted(&mut self, line: u32, hex: &[u8]) -> Result<(), Fault> {
        for eight in hex.chunks(8) {
            let code =
                std::str::from_utf8(eight).ok().filter(|t| t.len() == 8).and_then(|t| u32::from_str_radix(t, 16).ok());
            let Some(code) = code else {
                self.notes.add(
                    line,
                    "`#MRGB` holds eight hexadecimal digits per vertex; others are left out",
                    String::new,
                );
                break;
            };
            let [_, r, g, b] = code.to_be_bytes();
            memory::push(&mut self.painted, [r, g, b], "colours of vertices", CURE)?;
        }
        Ok(())
    }

    fn face(&mut self, line: u32, rest: &[u8], what: &str) -> Result<(), Fault> {
        let first = self.corners.len();
        for word in words(rest) {
            // Some programs put a blank before the slash.
            let joined = match self.corners.last() {
                Some(last) if word.starts_with(b"/") && self.corners.len() > first && last.vt == NONE => {
                    let kind = "corners of faces with a blank before their slash are joined";
                    self.notes.add(line, kind, || format!(": `{}`", short(word)));
                    self.corners.pop()
                }
                _ => None,
            };
            let at = self.corners.len() as u32;
            let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
            let (parsed, extra) = parse(word);
            let mut corner = Corner { v: joined.map_or(NONE, |c| c.v), vt: NONE, vn: NONE };
            for (field, index) in parsed.into_iter().enumerate() {
                let field = Field::ALL[field];
                match index {
                    Index::Missing if field == Field::Vertex && joined.is_none() => {
                        self.notes.add(line, NO_VERTEX, || format!(": corner `{}` names no vertex", short(word)));
                    }
                    Index::Missing => {}
                    Index::Forward(place) => *corner.field(field) = place,
                    Index::Backward(back) => {
                        *corner.field(field) = (counts[field as usize] as u32).wrapping_sub(back);
                        memory::push(&mut self.backwards, (at, field), what, CURE)?;
                    }
                    Index::Wrong(why) => {
                        let kind = field.unusable();
                        self.notes.add(line, kind, || format!(": `{}`: a {} {why}", short(word), field.name()));
                    }
                }
            }
            if extra {
                let kind = "a corner of a face has at most three indices; the others are left out";
                self.notes.add(line, kind, || format!(": `{}`", short(word)));
            }
            memory::push(&mut self.corners, corner, what, CURE)?;
        }
        let count = (self.corners.len() - first) as u32;
        let [material, smooth] = self.last;
        memory::push(&mut self.faces, Face { line, first: first as u32, count, material, smooth }, what, CURE)?;
        Ok(())
    }

    fn usemtl(&mut self, line: u32, name: &[u8], limits: &Limits) -> Result<(), Fault> {
        if name.is_empty() {
            self.notes.add(line, "`usemtl` without a name: the default material is used", String::new);
        }
        self.last[0] = match self.places.get(name) {
            Some(&place) => place,
            None => {
                if self.uses.len() >= limits.objects {
                    return Err(Fault::Names("materials", limits.objects));
                }
                let place = self.uses.len() as u32;
                self.places.insert(name.to_owned(), place);
                self.uses.push((name.to_owned(), line));
                place
            }
        };
        Ok(())
    }
}

/// Largest number of material files of a model.
pub(super) const MOST_LIBRARIES: usize = 1000;

/// Colour of a vertex without one: white, whatever the file's scale.
pub(super) const UNCOLOURED: Vec3 = Vec3::INFINITY;

const NO_VERTEX: &str = "faces with a corner that names no vertex are left out";
