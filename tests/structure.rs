//! The house keeps its shape: rooms import only from the rooms below them.

mod build_flags;
mod catalogue;
mod mutants;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Allowed imports between rooms, as in `src/README.md`. A room may always import from itself, and from `error`, `choice`
/// and `system`.
const ARROWS: &[(&str, &[&str])] = &[
    ("system", &[]),
    ("math", &[]),
    ("simd", &["math"]),
    ("geometry", &["simd", "math"]),
    ("optics", &["simd", "math"]),
    ("accel", &["geometry", "simd", "math"]),
    ("measure", &["accel", "simd", "math"]),
    ("scene", &["geometry", "math"]),
    ("effects", &["scene", "optics", "geometry"]),
    ("image", &[]),
    ("load", &["scene", "geometry", "image", "optics", "math"]),
    ("systems", &["scene", "optics", "geometry", "simd", "math"]),
    ("render", &["systems", "effects", "scene", "optics", "accel", "geometry", "simd", "math", "image"]),
    ("notices", &["load", "render", "effects", "scene", "accel", "geometry"]),
    ("trial", &["render", "effects", "scene", "optics", "accel", "geometry", "simd", "math", "image", "measure"]),
    (
        "study",
        &["measure", "load", "render", "systems", "scene", "optics", "accel", "geometry", "simd", "math", "image"],
    ),
    (
        "cli",
        &[
            "study", "trial", "measure", "notices", "load", "render", "systems", "effects", "accel", "image", "scene",
            "optics", "simd", "math",
        ],
    ),
];

fn rust_files(dir: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(dir).expect("src can be read") {
        let path = entry.expect("src can be listed").path();
        if path.is_dir() {
            rust_files(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

/// Rooms named after `crate::` in the code (not the comments) of one file, unit tests left out.
fn imports(text: &str) -> BTreeSet<String> {
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    code.lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .flat_map(|line| line.split("crate::").skip(1))
        .flat_map(|rest| {
            // `crate::{a::B, c::D}` names a room at its start and after each comma.
            let list = rest.strip_prefix('{').map_or(vec![rest], |inner| inner.split(", ").collect());
            list.into_iter().map(leading_name).collect::<Vec<_>>()
        })
        .filter(|name| name.starts_with(char::is_lowercase))
        .collect()
}

fn leading_name(text: &str) -> String {
    text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

#[test]
fn rooms_import_only_from_rooms_below() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    let mut wrong = Vec::new();
    for file in &files {
        let inside = file.strip_prefix(&src).expect("file lies in src");
        let room = inside.components().next().expect("file has a name").as_os_str().to_string_lossy().into_owned();
        if room.ends_with(".rs") {
            continue;
        }
        let Some((_, below)) = ARROWS.iter().find(|(name, _)| *name == room) else {
            wrong.push(format!("{}: room {room} is not in the list of arrows", inside.display()));
            continue;
        };
        for name in imports(&std::fs::read_to_string(file).expect("source can be read")) {
            if name != room
                && name != "error"
                && name != "choice"
                && name != "system"
                && !below.contains(&name.as_str())
            {
                wrong.push(format!("{} imports {name}", inside.display()));
            }
        }
    }
    assert!(files.len() > 30, "found {} files only", files.len());
    assert!(wrong.is_empty(), "arrows that go up or sideways:\n{}", wrong.join("\n"));
}

#[test]
fn the_list_of_arrows_has_no_cycle() {
    // A room is listed after every room that it may import.
    for (i, (room, below)) in ARROWS.iter().enumerate() {
        for name in *below {
            assert!(ARROWS[..i].iter().any(|(earlier, _)| earlier == name), "{room} may import {name}, listed later");
        }
    }
}

/// Cargo builds only the binaries that `Cargo.toml` names, so a file that no module list names would never run.
#[test]
fn every_test_file_belongs_to_a_binary() {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let read = |file: &Path| std::fs::read_to_string(file).unwrap_or_default();
    let manifest = read(&tests.with_file_name("Cargo.toml"));
    let mut declared = String::new();
    let mut files = Vec::new();
    for entry in std::fs::read_dir(&tests).expect("tests can be read") {
        let path = entry.expect("tests can be listed").path();
        let root = format!("path = \"tests/{}\"", path.file_name().expect("a name").to_string_lossy());
        if manifest.contains(&root) {
            declared += &read(&path);
        } else if path.extension().is_some_and(|e| e == "rs") || path.join("mod.rs").exists() {
            files.push(path);
        }
    }
    assert!(files.len() > 30, "found {} only", files.len());
    for path in files {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        assert!(
            declared.lines().any(|l| l == format!("mod {name};")),
            "no binary has tests/{name}: see tests/README.md"
        );
        let Ok(folder) = std::fs::read_dir(&path) else { continue };
        let list = read(&path.join("mod.rs"));
        for inner in folder.map(|entry| entry.expect("tests can be listed").path()) {
            let inner = inner.file_stem().expect("a name").to_string_lossy().into_owned();
            let there = list.lines().any(|l| l.trim_start_matches("pub ") == format!("mod {inner};"));
            assert!(inner == "mod" || there, "tests/{name}/mod.rs does not declare {inner}");
        }
    }
}

/// The most lines of a file of `src`.
const MOST_LINES: usize = 500;

#[test]
fn every_file_is_short_enough_to_be_read_at_once() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    let lines = |file: &PathBuf| std::fs::read_to_string(file).expect("source can be read").lines().count();
    let long: Vec<String> = files
        .iter()
        .map(|file| (file, lines(file)))
        .filter(|(_, lines)| *lines > MOST_LINES)
        .map(|(file, lines)| format!("{}: {lines} lines", file.display()))
        .collect();
    assert!(long.is_empty(), "more than {MOST_LINES} lines, so divide:\n{}", long.join("\n"));
}

/// Folders of `src` in which no file or folder may import, through others, itself.
const WITHOUT_CYCLES: &[&str] =
    &["accel/embree", "accel/native", "cli", "geometry", "image", "math", "measure", "optics", "simd", "system"];

/// The modules, as names from the crate's root, of all paths in some code that begin with `crate`, `self`, `super` or a
/// module that the file declares. `here` is the file's own module.
fn paths(code: &str, here: &[String]) -> Vec<Vec<String>> {
    let declared = code.lines().filter_map(|line| line.trim_end().strip_suffix(';')?.rsplit_once("mod "));
    let mut starts = vec!["crate", "self", "super"];
    starts.extend(declared.map(|(_, name)| name));
    let mut all = Vec::new();
    for start in starts {
        for (at, _) in code.match_indices(&format!("{start}::")) {
            let before = code[..at].chars().next_back();
            if !before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
                let base = if start == "crate" { Vec::new() } else { here.to_vec() };
                let rest = if matches!(start, "crate" | "self") { &code[at + start.len() + 2..] } else { &code[at..] };
                path_tree(rest, base, &mut all);
            }
        }
    }
    all
}

/// The code without the paths of `pub(in path)`, which import nothing.
fn without_visibility(code: &str) -> String {
    let mut parts = code.split("pub(in ");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |all, part| all + "pub" + part.split_once(')').map_or("", |(_, rest)| rest))
}

/// Adds the paths of a tree like `a::{b, c::d}`, which go on from `base`. Returns the code behind it.
fn path_tree<'a>(code: &'a str, mut base: Vec<String>, all: &mut Vec<Vec<String>>) -> &'a str {
    let name = leading_name(code);
    let mut rest = &code[name.len()..];
    match name.as_str() {
        "super" => drop(base.pop()),
        "" | "self" => {}
        _ => base.push(name),
    }
    if let Some(inner) = rest.strip_prefix("::") {
        return path_tree(inner, base, all);
    }
    if rest.starts_with('{') {
        while let Some(inner) = rest.strip_prefix(['{', ',']) {
            rest = path_tree(inner.trim_start(), base.clone(), all).trim_start();
        }
        return rest.strip_prefix('}').unwrap_or(rest);
    }
    all.push(base);
    rest
}

/// The file of the deepest module that a path names.
fn file_of(src: &Path, path: &[String]) -> Option<PathBuf> {
    let module = (1..=path.len()).rev().find_map(|n| {
        let stem: PathBuf = path[..n].iter().collect();
        [stem.with_extension("rs"), stem.join("mod.rs")].into_iter().find(|file| src.join(file).is_file())
    });
    module.filter(|file| file.components().count() > 1)
}

/// A cycle among names joined by arrows, as the names on it.
fn cycle(arrows: &BTreeMap<String, BTreeSet<String>>) -> Option<Vec<String>> {
    fn visit<'a>(
        name: &'a str,
        arrows: &'a BTreeMap<String, BTreeSet<String>>,
        path: &mut Vec<&'a str>,
        done: &mut BTreeSet<&'a str>,
    ) -> Option<Vec<String>> {
        if let Some(first) = path.iter().position(|&p| p == name) {
            return Some(path[first..].iter().map(|&p| p.to_owned()).collect());
        }
        if !done.insert(name) {
            return None;
        }
        path.push(name);
        let found = arrows.get(name)?.iter().find_map(|next| visit(next, arrows, path, done));
        path.pop();
        found
    }
    // A name without arrows ends the search of its branch, not the path to it.
    let whole: BTreeMap<String, BTreeSet<String>> = arrows
        .values()
        .flatten()
        .map(|name| (name.clone(), BTreeSet::new()))
        .chain(arrows.iter().map(|(name, to)| (name.clone(), to.clone())))
        .collect();
    let mut done = BTreeSet::new();
    whole.keys().find_map(|name| visit(name, &whole, &mut Vec::new(), &mut done))
}

/// The import cycles below `src/room`, folder by folder: a folder counts as one with all that is in it.
fn cycles(src: &Path, room: &str) -> Vec<String> {
    let mut files = Vec::new();
    rust_files(&src.join(room), &mut files);
    let mut by_folder: BTreeMap<PathBuf, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
    for file in &files {
        let from = file.strip_prefix(src).expect("file lies in src");
        let mut here: Vec<String> = from.with_extension("").iter().map(|c| c.to_string_lossy().into_owned()).collect();
        here.pop_if(|name| name == "mod");
        let text = std::fs::read_to_string(file).expect("source can be read");
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default().lines();
        let code: Vec<&str> = code.filter(|line| !line.trim_start().starts_with("//")).collect();
        for to in paths(&without_visibility(&code.join("\n")), &here).iter().filter_map(|path| file_of(src, path)) {
            let (mut folder, mut ends) = (PathBuf::new(), (from.iter(), to.iter()));
            loop {
                match (ends.0.next(), ends.1.next()) {
                    (Some(a), Some(b)) if a == b => folder.push(a),
                    (Some(a), Some(b)) if folder.starts_with(room) => {
                        let arrows = by_folder.entry(folder).or_default();
                        arrows.entry(a.to_string_lossy().into()).or_default().insert(b.to_string_lossy().into());
                        break;
                    }
                    _ => break,
                }
            }
        }
    }
    by_folder
        .iter()
        .filter_map(|(folder, arrows)| Some(format!("{}: {}", folder.display(), cycle(arrows)?.join(" → "))))
        .collect()
}

#[test]
fn no_file_or_folder_of_a_room_imports_itself_through_others() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let found: Vec<String> = WITHOUT_CYCLES.iter().flat_map(|room| cycles(&src, room)).collect();
    assert!(found.is_empty(), "import cycles:\n{}", found.join("\n"));
}

#[test]
fn imports_are_found_however_they_are_written() {
    let here = ["a".to_owned(), "b".to_owned()];
    let code =
        "mod own;\nuse super::{c::D, e::{self, F}};\nuse crate::g::H;\nfn f(x: super::super::i::J) { own::k(self::l) }";
    let found: BTreeSet<String> = paths(code, &here).iter().map(|path| path.join("::")).collect();
    assert_eq!(without_visibility("pub(in crate::a) fn f(x: crate::b::X)"), "pub fn f(x: crate::b::X)");
    let want = ["a::b::l", "a::b::own::k", "a::c::D", "a::e", "a::e::F", "g::H", "i::J"];
    assert_eq!(found, want.map(str::to_owned).into());
    let arrows = |list: &[(&str, &str)]| {
        let mut arrows: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for &(a, b) in list {
            arrows.entry(a.into()).or_default().insert(b.into());
        }
        arrows
    };
    assert_eq!(cycle(&arrows(&[("a", "b"), ("a", "c"), ("b", "d"), ("c", "d")])), None);
    let around = cycle(&arrows(&[("a", "b"), ("b", "d"), ("b", "c"), ("c", "b")]));
    assert_eq!(around, Some(vec!["b".to_owned(), "c".to_owned()]));
}

/// Words that open a doc comment which names its subject by a question.
const QUESTIONS: [&str; 5] = ["What", "Whether", "How", "Where", "Which"];

/// The most words of a sentence.
const MOST_WORDS: usize = 35;

/// The faults in the prose of one file's doc comments, each with its line.
fn faults_of_prose(text: &str) -> Vec<(usize, String)> {
    let mut faults = Vec::new();
    let mut block: Vec<&str> = Vec::new();
    let mut fenced = false;
    for (i, line) in text.lines().chain([""]).enumerate() {
        let line = line.trim_start();
        let doc = line.strip_prefix("///").or_else(|| line.strip_prefix("//!")).map(str::trim);
        // A paragraph ends with a list item, a table row, a heading or code, too.
        let structured = |s: &str| s.is_empty() || s.starts_with(['#', '|', '-', '*', '`']) && !s.starts_with("`");
        fenced ^= doc.is_some_and(|s| s.starts_with("```"));
        let item =
            doc.is_some_and(|s| structured(s) || s.split_once(". ").is_some_and(|(n, _)| n.parse::<u8>().is_ok()));
        if doc.is_none() || item || fenced {
            let paragraph = std::mem::take(&mut block).join(" ");
            let long = sentences(&paragraph).into_iter().filter(|s| s.split_whitespace().count() > MOST_WORDS);
            faults.extend(long.map(|s| (i, format!("{} words: {s}", s.split_whitespace().count()))));
        }
        match doc {
            Some(_) if fenced => {}
            Some(s) => {
                let first = block.is_empty()
                    && i.checked_sub(1).and_then(|k| text.lines().nth(k)).is_none_or(|before| {
                        let before = before.trim_start();
                        !before.starts_with("///") && !before.starts_with("//!")
                    });
                if first && QUESTIONS.contains(&leading_name(s).as_str()) {
                    faults.push((i + 1, format!("opens with {}", leading_name(s))));
                }
                if !s.starts_with(['|', '#']) {
                    block.push(s.trim_start_matches("- "));
                }
            }
            None => {}
        }
    }
    faults
}

/// The sentences of a paragraph: each ends with a stop, a question mark or an exclamation mark before a space.
fn sentences(paragraph: &str) -> Vec<&str> {
    let mut all = Vec::new();
    let mut start = 0;
    for (at, _) in paragraph.match_indices(' ') {
        let closed = paragraph[..at].trim_end_matches([')', '"', '`', '*']);
        if closed.ends_with(['.', '?', '!']) {
            all.push(&paragraph[start..at]);
            start = at + 1;
        }
    }
    all.push(&paragraph[start..]);
    all
}

#[test]
fn documentation_names_its_subject_in_short_sentences() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    let mut wrong = Vec::new();
    for file in &files {
        for (line, fault) in faults_of_prose(&std::fs::read_to_string(file).expect("source can be read")) {
            wrong.push(format!("{}:{line}: {fault}", file.display()));
        }
    }
    assert!(wrong.is_empty(), "{} faults:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn faults_of_prose_are_found() {
    let long = ["word"; MOST_WORDS].join(" ");
    let of = |text: &str| faults_of_prose(text).into_iter().map(|(line, _)| line).collect::<Vec<_>>();
    assert_eq!(of("/// Whether it does.\nfn f() {}\n\n/// Returns it.\n/// Where it is, it is.\nfn g() {}"), [1]);
    assert_eq!(of(&format!("//! One {long}\n//! two.")), [2]);
    assert_eq!(of(&format!("/// {long}.\n/// {long}.\nlet x;\n/// - {long}\n/// - {long}\n")), [0; 0]);
    assert_eq!(of(&format!("/// ```\n/// Which {long} {long}\n/// ```\nfn f() {{}}")), [0; 0]);
    assert_eq!(
        sentences("It ends (here). It does! `So.` 1.5 stays"),
        ["It ends (here).", "It does!", "`So.`", "1.5 stays"]
    );
}

/// Everything else names [`Backend`](vitrum::accel::Backend)s, which exist in every build.
#[test]
fn one_line_outside_the_room_of_embree_depends_on_its_feature() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    let lines: Vec<String> = files
        .iter()
        .filter(|file| !file.starts_with(src.join("accel/embree")))
        .flat_map(|file| {
            let text = std::fs::read_to_string(file).expect("source can be read");
            let name = file.strip_prefix(&src).expect("file lies in src").display().to_string();
            let found = text.matches("feature = \"embree\"").count();
            std::iter::repeat_n(name, found).collect::<Vec<_>>()
        })
        .collect();
    assert_eq!(lines, ["accel/mod.rs"]);
}
