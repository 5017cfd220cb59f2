//! Warnings of one block, to be passed on in order.

use std::borrow::Cow;
use std::collections::HashMap;

/// Number of kinds kept per block; further ones are counted with the last.
const MOST_KINDS: usize = 256;

/// Warning of one kind.
#[derive(Debug)]
pub(super) struct Note {
    /// Line of the first occurrence.
    pub line: u32,
    pub kind: Cow<'static, str>,
    /// Text for the first occurrence.
    pub detail: String,
    pub count: u64,
}

/// Warnings in the order of their first occurrences.
#[derive(Debug, Default)]
pub(super) struct Notes {
    pub list: Vec<Note>,
    places: HashMap<Cow<'static, str>, usize>,
}

impl Notes {
    /// Adds a warning. `detail` is asked for the first of its kind.
    pub(super) fn add(&mut self, line: u32, kind: impl Into<Cow<'static, str>>, detail: impl FnOnce() -> String) {
        let kind = kind.into();
        if let Some(&place) = self.places.get(&kind) {
            self.list[place].count += 1;
        } else if self.list.len() >= MOST_KINDS {
            self.list[MOST_KINDS - 1].count += 1;
        } else {
            self.places.insert(kind.clone(), self.list.len());
            self.list.push(Note { line, kind, detail: detail(), count: 1 });
        }
    }
}
