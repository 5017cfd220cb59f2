//! The catalogue of hard cases in `tests/README.md` is whole: every id is there once, and every test it names exists and
//! says in its doc comment which cases it covers.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Groups of the catalogue and how many cases each has.
const GROUPS: [(&str, usize); 15] = [
    ("RB", 11),
    ("RT", 18),
    ("SP", 4),
    ("BB", 12),
    ("TR", 9),
    ("SI", 10),
    ("RV", 7),
    ("RF", 14),
    ("FR", 17),
    ("AB", 12),
    ("CL", 9),
    ("LN", 12),
    ("AC", 7),
    ("IO", 21),
    ("PA", 9),
];

/// Beginning of the row of a case that has no test.
const NONE: &str = "Does not apply: ";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn ids() -> Vec<String> {
    GROUPS.iter().flat_map(|(group, n)| (1..=*n).map(move |i| format!("{group}-{i:02}"))).collect()
}

/// Rows of the page's tables: cells of each, trimmed.
fn rows() -> Vec<Vec<String>> {
    let page = std::fs::read_to_string(root().join("tests/README.md")).unwrap();
    let cells = |line: &str| line.trim_matches('|').split(" | ").map(|c| c.trim().to_owned()).collect();
    page.lines().filter(|line| line.starts_with("| ")).map(cells).collect()
}

/// The tests that a cell names: `path::name`, each in backquotes.
fn named(cell: &str) -> Vec<(&str, &str)> {
    cell.split(", ")
        .map(|t| {
            let bare = t.strip_prefix('`').and_then(|t| t.strip_suffix('`'));
            bare.and_then(|t| t.split_once("::")).unwrap_or_else(|| panic!("`{t}` is no `path::name`"))
        })
        .collect()
}

/// Doc comment and attributes above a function; panics where the file has no such function, or several.
fn above(path: &str, name: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"));
    let lines: Vec<&str> = text.lines().map(str::trim_start).collect();
    let is_it = |line: &str| {
        line.strip_prefix("fn ").and_then(|l| l.strip_prefix(name)).is_some_and(|l| l.starts_with(['(', '<']))
    };
    let places: Vec<usize> = (0..lines.len()).filter(|&i| is_it(lines[i])).collect();
    assert_eq!(places.len(), 1, "{path} has {} functions `{name}`", places.len());
    let start = (0..places[0]).rev().find(|&i| !lines[i].starts_with("///") && !lines[i].starts_with("#["));
    lines[start.map_or(0, |i| i + 1)..places[0]].iter().map(|&l| l.to_owned()).collect()
}

/// Returns true if a word stands in a text by itself.
fn says(doc: &[String], id: &str) -> bool {
    doc.iter().any(|line| line.split(|c: char| !c.is_ascii_alphanumeric() && c != '-').any(|word| word == id))
}

fn assert_is_test(path: &str, name: &str) -> Vec<String> {
    let above = above(path, name);
    let is_test = above.iter().any(|l| l == "#[test]");
    // What every accelerator is put through is called by one function, which tests call.
    let contract = path == "tests/support/contract.rs";
    let called = || std::fs::read_to_string(root().join(path)).unwrap().contains(&format!("    {name}(&build"));
    assert!(is_test || (contract && called()), "{path}::{name} is no test");
    above
}

#[test]
fn every_case_is_listed_once_with_a_test_that_names_it_or_a_reason() {
    let known: BTreeSet<String> = ids().into_iter().collect();
    let mut listed = Vec::new();
    for row in rows().iter().filter(|row| known.contains(&row[0])) {
        let [id, what, tests] = row.as_slice() else { panic!("{row:?} has not three cells") };
        listed.push(id.clone());
        assert!(!what.is_empty());
        if let Some(reason) = tests.strip_prefix(NONE) {
            assert!(reason.len() > 20, "{id} needs a reason");
            continue;
        }
        for (path, name) in named(tests) {
            let doc = assert_is_test(path, name);
            assert!(says(&doc, id), "the doc comment of {path}::{name} does not say {id}");
        }
    }
    assert_eq!(listed, ids());
    assert_eq!(listed.len(), 172);
}

#[test]
fn every_tracker_entry_has_a_test_that_names_its_source() {
    let sources: Vec<Vec<String>> =
        rows().into_iter().filter(|r| r.len() == 3 && r[2].starts_with('`') && !ids().contains(&r[0])).collect();
    assert!(sources.len() >= 8, "{}", sources.len());
    for row in sources {
        for (path, name) in named(&row[2]) {
            assert_is_test(path, name);
            let number = row[0].split([' ', ',']).rfind(|w| w.starts_with('#')).unwrap_or("pbrt");
            let text = std::fs::read_to_string(root().join(path)).unwrap();
            assert!(text.contains(number), "{path} does not name {}", row[0]);
        }
    }
}

/// Files of Rust below a folder.
fn sources(folder: &Path, all: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, all);
        } else if path.extension().is_some_and(|e| e == "rs") {
            all.push(path);
        }
    }
}

#[test]
fn every_case_that_a_doc_comment_names_is_listed_with_that_file() {
    let known: BTreeSet<String> = ids().into_iter().collect();
    let mut listed: BTreeMap<String, String> = BTreeMap::new();
    for row in rows().into_iter().filter(|row| known.contains(&row[0])) {
        listed.insert(row[0].clone(), row[2].clone());
    }
    let mut all = Vec::new();
    sources(&root().join("src"), &mut all);
    sources(&root().join("tests"), &mut all);
    for path in all {
        let short = path.strip_prefix(root()).unwrap().to_string_lossy().replace('\\', "/");
        for line in std::fs::read_to_string(&path).unwrap().lines() {
            let Some(doc) = line.trim_start().strip_prefix("/// ") else { continue };
            for word in doc.split(|c: char| !c.is_ascii_alphanumeric() && c != '-').filter(|w| known.contains(*w)) {
                assert!(listed[word].contains(&format!("`{short}::")), "{short} says {word}, the page does not");
            }
        }
    }
}
