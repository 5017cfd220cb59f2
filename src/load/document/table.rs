//! Access to a TOML document key by key. Every value has its position in the file, and every key that was never read is
//! an error.
//!
//! Written by hand on `toml`'s tree instead of derived with `serde`, for two reasons. The allowed keys of a material or
//! a mesh depend on its `type`. `serde` loses the positions of values inside tagged enums, which messages need.

use std::cell::RefCell;
use std::fmt::Display;
use std::ops::Range;
use std::path::Path;

use glam::{DVec3, Vec3};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::super::brief::brief;
use crate::load::colour::colour;
use crate::load::suggest::hint;
use crate::load::transform::within_limit;
use crate::{Error, Result};

/// Range of the text, in bytes.
pub(super) type Span = Range<usize>;

/// Name and text of a scene file, for messages.
pub(super) struct Source<'d> {
    pub(super) file: &'d Path,
    text: &'d str,
    /// Start of each line, in bytes.
    starts: Vec<usize>,
}

impl<'d> Source<'d> {
    pub(super) fn new(file: &'d Path, text: &'d str) -> Self {
        let starts = std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect();
        Self { file, text, starts }
    }

    /// Returns the line of a byte, from 1.
    pub(super) fn line(&self, byte: usize) -> usize {
        self.starts.partition_point(|&s| s <= byte).max(1)
    }

    /// Creates an error for wrong input at a position.
    pub(super) fn error(&self, span: &Span, message: impl Into<String>) -> Error {
        let line = self.line(span.start);
        let before = self.text.get(self.starts[line - 1]..span.start);
        let column = before.map(|b| b.chars().count() + 1);
        Error::Input { file: self.file.to_owned(), line, column, message: brief(message.into()) }
    }
}

/// Table of the document.
pub(super) struct Table<'d> {
    pub(super) source: &'d Source<'d>,
    /// Name in messages, such as `[camera]`.
    pub(super) what: String,
    pub(super) span: Span,
    entries: &'d DeTable<'d>,
    /// Keys read so far; all others are errors.
    asked: RefCell<Vec<&'static str>>,
}

impl<'d> Table<'d> {
    pub(super) fn new(source: &'d Source<'d>, what: impl Into<String>, table: &'d DeTable<'d>, span: Span) -> Self {
        Self { source, what: what.into(), span, entries: table, asked: RefCell::default() }
    }

    /// Returns the value of a key, if present.
    pub(super) fn get(&self, key: &'static str) -> Option<Value<'d>> {
        self.asked.borrow_mut().push(key);
        let (name, value) = self.entries.iter().find(|(k, _)| k.get_ref() == key)?;
        Some(Value { source: self.source, key: name.get_ref().to_string(), value })
    }

    /// Returns the value of a key that must be present.
    pub(super) fn need(&self, key: &'static str) -> Result<Value<'d>> {
        self.get(key).ok_or_else(|| self.error(format!("{} needs `{key}`", self.what)))
    }

    /// Reads the value of a key with `read`, if present.
    pub(super) fn opt<T>(&self, key: &'static str, read: impl FnOnce(&Value<'d>) -> Result<T>) -> Result<Option<T>> {
        self.get(key).map(|v| read(&v)).transpose()
    }

    /// Reads the value of a key with `read`, or returns `default`.
    pub(super) fn or<T>(&self, key: &'static str, default: T, read: impl FnOnce(&Value<'d>) -> Result<T>) -> Result<T> {
        Ok(self.opt(key, read)?.unwrap_or(default))
    }

    /// Returns all keys with their values, of a table whose keys are names.
    pub(super) fn pairs(&self) -> Result<Vec<(String, Value<'d>)>> {
        let mut pairs: Vec<_> = self.entries.iter().collect();
        pairs.sort_by_key(|(key, _)| key.span().start);
        let value = |(key, value): (&'d Spanned<std::borrow::Cow<'d, str>>, &'d Spanned<DeValue<'d>>)| {
            let key = key.get_ref().to_string();
            (key.clone(), Value { source: self.source, key, value })
        };
        Ok(pairs.into_iter().map(value).collect())
    }

    /// Creates an error for the table as a whole.
    pub(super) fn error(&self, message: impl Into<String>) -> Error {
        self.source.error(&self.span, message)
    }

    /// Returns an error for the first key that was never read.
    pub(super) fn finish(&self) -> Result<()> {
        let asked = self.asked.borrow();
        let unknown =
            self.entries.keys().filter(|k| !asked.contains(&k.get_ref().as_ref())).min_by_key(|k| k.span().start);
        match unknown {
            None => Ok(()),
            Some(key) => {
                let name: String = key.get_ref().chars().take(80).collect();
                let hint = hint(&name, asked.iter().copied());
                Err(self.source.error(&key.span(), format!("{} has no key `{name}`{hint}", self.what)))
            }
        }
    }

    /// Returns the tables of a list of tables (`[[light]]`), each with the list's name.
    pub(super) fn list(&self, key: &'static str) -> Result<Vec<Table<'d>>> {
        let Some(value) = self.get(key) else { return Ok(Vec::new()) };
        let DeValue::Array(items) = value.value.get_ref() else {
            return Err(value.error(format!("`{key}` is a list of tables: write [[{key}]]")));
        };
        items
            .iter()
            .map(|item| match item.get_ref() {
                DeValue::Table(t) => Ok(Table::new(self.source, format!("[[{key}]]"), t, item.span())),
                other => {
                    let message =
                        format!("`{key}` is a list of tables: write [[{key}]], not {}", article(other.type_str()));
                    Err(self.source.error(&item.span(), message))
                }
            })
            .collect()
    }

    /// Returns a sub-table (`[camera]`), if present.
    pub(super) fn table(&self, key: &'static str) -> Result<Option<Table<'d>>> {
        self.opt(key, |v| v.table(format!("[{key}]")))
    }
}

/// Value of the document.
pub(super) struct Value<'d> {
    source: &'d Source<'d>,
    key: String,
    value: &'d Spanned<DeValue<'d>>,
}

impl<'d> Value<'d> {
    /// Returns the key of the value.
    pub(super) fn key(&self) -> &str {
        &self.key
    }

    pub(super) fn span(&self) -> Span {
        self.value.span()
    }

    /// Creates an error for this value.
    pub(super) fn error(&self, message: impl Into<String>) -> Error {
        self.source.error(&self.value.span(), message)
    }

    /// Creates the error "`key` is `value`; it must be `what`".
    fn must(&self, value: impl Display, what: impl Display) -> Error {
        self.error(format!("`{}` is {value}; it must be {what}", self.key))
    }

    fn wrong_type(&self, what: &str) -> Error {
        self.must(article(self.value.get_ref().type_str()), what)
    }

    /// Returns a value inside this one.
    fn inner(&self, value: &'d Spanned<DeValue<'d>>) -> Self {
        Self { source: self.source, key: self.key.clone(), value }
    }

    /// Reads a finite number.
    pub(super) fn number(&self) -> Result<f64> {
        let number = match self.value.get_ref() {
            DeValue::Integer(i) => i128::from_str_radix(i.as_str(), i.radix()).ok().map(|i| i as f64),
            DeValue::Float(f) => f.as_str().parse::<f64>().ok(),
            _ => return Err(self.wrong_type("a number")),
        };
        match number {
            // All numbers are converted to f32 eventually.
            Some(x) if x.abs() <= f64::from(f32::MAX) => Ok(x),
            Some(x) => Err(self.must(x, "a finite number")),
            None => Err(self.error(format!("`{}` is out of the range of numbers; give a smaller one", self.key))),
        }
    }

    /// Reads a number for which `fits` is true.
    pub(super) fn number_where(&self, what: &str, fits: impl FnOnce(f64) -> bool) -> Result<f64> {
        let x = self.number()?;
        if fits(x) { Ok(x) } else { Err(self.must(x, what)) }
    }

    /// Reads a number above 0 that stays above 0 as `f32`.
    pub(super) fn positive(&self) -> Result<f64> {
        self.number_where("above 0", |x| x as f32 > 0.0)
    }

    /// Reads a number of at least 0.
    pub(super) fn not_negative(&self) -> Result<f64> {
        self.number_where("at least 0", |x| x >= 0.0)
    }

    /// Reads a refractive index.
    pub(super) fn ior(&self) -> Result<f64> {
        self.number_where("between 0.001 and 1000", |x| (1e-3..=1e3).contains(&x))
    }

    /// Reads a whole number in a range.
    pub(super) fn whole(&self, range: std::ops::RangeInclusive<u32>) -> Result<u32> {
        let (lo, hi) = range.into_inner();
        let what = format!("a whole number from {lo} to {hi}");
        let DeValue::Integer(i) = self.value.get_ref() else {
            return Err(match self.value.get_ref() {
                DeValue::Float(f) => self.must(f.as_str(), what),
                _ => self.wrong_type(&what),
            });
        };
        match i128::from_str_radix(i.as_str(), i.radix()) {
            Ok(x) if x >= i128::from(lo) && x <= i128::from(hi) => Ok(x as u32),
            _ => Err(self.must(i.as_str(), what)),
        }
    }

    /// Reads a signed whole number.
    pub(super) fn signed(&self) -> Result<i32> {
        let DeValue::Integer(i) = self.value.get_ref() else { return Err(self.wrong_type("a whole number")) };
        // The lowest priority is air's.
        let range = i32::MIN + 1..=i32::MAX;
        i32::from_str_radix(i.as_str(), i.radix())
            .ok()
            .filter(|i| range.contains(i))
            .ok_or_else(|| self.must(i.as_str(), format!("from {} to {}", range.start(), range.end())))
    }

    /// Reads true or false.
    pub(super) fn boolean(&self) -> Result<bool> {
        self.value.get_ref().as_bool().ok_or_else(|| self.wrong_type("true or false"))
    }

    pub(super) fn is_boolean(&self) -> bool {
        self.value.get_ref().is_bool()
    }

    /// Reads a text.
    pub(super) fn text(&self) -> Result<&'d str> {
        self.value.get_ref().as_str().ok_or_else(|| self.wrong_type("a text in quotes"))
    }

    /// Reads one of a few words and returns its value.
    pub(super) fn choice<T: Copy>(&self, choices: &[(&'static str, T)]) -> Result<T> {
        let given = self.text()?;
        choices.iter().find(|(name, _)| *name == given).map(|&(_, value)| value).ok_or_else(|| {
            let short: String = given.chars().take(80).collect();
            self.error(format!("`{}` cannot be \"{short}\"{}", self.key, hint(&short, choices.iter().map(|c| c.0))))
        })
    }

    /// Returns the values of a list.
    pub(super) fn list(&self) -> Result<Vec<Self>> {
        let DeValue::Array(items) = self.value.get_ref() else { return Err(self.wrong_type("a list")) };
        Ok(items.iter().map(|i| self.inner(i)).collect())
    }

    /// Reads a list of exactly `N` numbers.
    pub(super) fn numbers<const N: usize>(&self) -> Result<[f64; N]> {
        let DeValue::Array(items) = self.value.get_ref() else {
            return Err(self.wrong_type(&format!("a list of {N} numbers")));
        };
        if items.len() != N {
            return Err(self.must(format!("a list of {}", items.len()), format!("a list of {N} numbers")));
        }
        let mut numbers = [0.0; N];
        for (number, item) in numbers.iter_mut().zip(items) {
            *number = self.inner(item).number()?;
        }
        Ok(numbers)
    }

    /// Reads three numbers.
    pub(super) fn triple(&self) -> Result<DVec3> {
        self.numbers().map(DVec3::from)
    }

    /// Reads a position in world coordinates.
    pub(super) fn place(&self) -> Result<DVec3> {
        let p = self.triple()?;
        if within_limit(p) { Ok(p) } else { Err(self.must(p, "within 1.844e18")) }
    }

    /// Reads a direction of any length but 0, and normalises it.
    pub(super) fn direction(&self) -> Result<DVec3> {
        let d = self.triple()?;
        d.try_normalize().ok_or_else(|| self.must(d, "a direction, not 0"))
    }

    /// Reads three numbers above 0, or one for all three.
    pub(super) fn extent(&self) -> Result<DVec3> {
        let e = self.one_or_three()?;
        if e.as_vec3().min_element() > 0.0 { Ok(e) } else { Err(self.must(e, "above 0")) }
    }

    /// Reads three numbers, or one for all three.
    pub(super) fn one_or_three(&self) -> Result<DVec3> {
        if self.value.get_ref().is_array() { self.triple() } else { self.number().map(DVec3::splat) }
    }

    /// Reads a colour or a grey with no channel below 0: numbers, or a text such as `#ff0000`.
    pub(super) fn colour(&self) -> Result<Vec3> {
        if let Some(text) = self.value.get_ref().as_str() {
            return colour(text).map_err(|e| self.error(format!("`{}`: {e}", self.key)));
        }
        let c = self.one_or_three()?.as_vec3();
        if c.min_element() >= 0.0 { Ok(c) } else { Err(self.must(c, "at least 0 in every channel")) }
    }

    /// Reads a colour that is a share of light, with no channel above 1.
    pub(super) fn share(&self) -> Result<Vec3> {
        let c = self.colour()?;
        if c.max_element() <= 1.0 { Ok(c) } else { Err(self.must(c, "at most 1 in every channel")) }
    }

    /// Returns the value as a table, named `what` in messages.
    pub(super) fn table(&self, what: impl Into<String>) -> Result<Table<'d>> {
        match self.value.get_ref() {
            DeValue::Table(t) => Ok(Table::new(self.source, what, t, self.span())),
            _ => Err(self.wrong_type("a table")),
        }
    }
}

/// Returns a TOML type's name with its article.
fn article(kind: &str) -> String {
    match kind {
        "integer" | "array" => format!("an {kind}"),
        _ => format!("a {kind}"),
    }
}
