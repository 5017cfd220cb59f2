//! Statements of an MTL file: numbers out of range get the nearest meaning, with a warning.

use std::path::Path;

use super::number::{Spelled, narrow};
use super::text::{short, words};
use crate::Result;
use crate::load::assembly::Assembly;

/// Largest emission; light beyond it is not told apart.
const MOST_EMISSION: f32 = 1e6;

/// Statement with its location.
pub(super) struct At<'f> {
    pub file: &'f Path,
    pub line: u32,
    pub statement: &'f [u8],
}

impl At<'_> {
    pub(super) fn warn(&self, assembly: &mut Assembly<'_>, kind: &str) -> Result<()> {
        assembly.reporter.warn(self.file, self.line as usize, kind, || format!(": `{}`", short(self.statement)))
    }

    /// Parses a number; `None` and a warning if there is none.
    pub(super) fn number(&self, word: Option<&[u8]>, assembly: &mut Assembly<'_>) -> Result<Option<f32>> {
        let given = match word.map_or(Spelled::Not, narrow) {
            Spelled::Plain(x) => Some(x),
            Spelled::Odd(x) => {
                self.warn(assembly, "numbers with a decimal comma are read; write them with a point")?;
                Some(x)
            }
            Spelled::Not => None,
        };
        let given = given.filter(|x| !x.is_nan());
        if given.is_none() {
            self.warn(assembly, "statements whose number is missing or none are left out")?;
        }
        Ok(given)
    }

    /// Parses a number and moves it into a range.
    pub(super) fn within(
        &self,
        word: Option<&[u8]>,
        [low, high]: [f32; 2],
        assembly: &mut Assembly<'_>,
    ) -> Result<Option<f32>> {
        let Some(x) = self.number(word, assembly)? else { return Ok(None) };
        let kept = x.clamp(low, high);
        if kept != x {
            self.warn(assembly, &format!("a number outside {low} to {high:e} counts as the nearer of these"))?;
        }
        Ok(Some(kept))
    }

    /// Parses three numbers, or one for all three. Shares of light are at most 1, unless `emission`.
    pub(super) fn colour(
        &self,
        numbers: &[u8],
        emission: bool,
        assembly: &mut Assembly<'_>,
    ) -> Result<Option<[f32; 3]>> {
        let mut words: Vec<&[u8]> = words(numbers).take(8).collect();
        if words.first().is_some_and(|w| w.eq_ignore_ascii_case(b"rgb")) {
            self.warn(assembly, "the word `rgb` before a colour is left out")?;
            words.remove(0);
        }
        let Some(first) = self.number(words.first().copied(), assembly)? else { return Ok(None) };
        let mut colour = [first; 3];
        if words.len() == 2 {
            self.warn(assembly, "a colour has three numbers, or one for a grey; the third counts as the first")?;
        }
        for (channel, word) in colour.iter_mut().zip(&words).skip(1) {
            let Some(x) = self.number(Some(word), assembly)? else { return Ok(None) };
            *channel = x;
        }
        if colour.iter().any(|&c| c < 0.0) {
            self.warn(assembly, "light below 0 counts as 0")?;
            colour = colour.map(|c| c.max(0.0));
        }
        let most = colour.iter().fold(0.0_f32, |m, &c| m.max(c));
        if emission {
            if most > MOST_EMISSION {
                self.warn(assembly, "light above 1e6 counts as 1e6")?;
                colour = colour.map(|c| c.min(MOST_EMISSION));
            }
        } else if most > 1.0 {
            let codes = most > 2.0 && most <= 255.0 && colour.iter().all(|c| c.fract() == 0.0);
            self.warn(
                assembly,
                if codes {
                    "a colour of whole numbers up to 255 is divided by 255; shares of light are 0 to 1"
                } else {
                    "shares of light above 1 count as 1"
                },
            )?;
            colour = colour.map(|c| if codes { c / 255.0 } else { c.min(1.0) });
        }
        Ok(Some(colour))
    }
}
