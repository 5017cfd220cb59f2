//! The list of changes that a test must notice still fits the code: each text stands exactly once in its file. Applying
//! them and running the tests is the work of `tests/mutants/run`, which takes an hour.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

#[derive(Default)]
struct Mutant {
    name: String,
    file: String,
    tests: String,
    old: Vec<String>,
    new: Vec<String>,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn mutants() -> Vec<Mutant> {
    let mut all: Vec<Mutant> = Vec::new();
    for line in fs::read_to_string(root().join("tests/mutants/list")).unwrap().lines() {
        if let Some(name) = line.strip_prefix("mutant: ") {
            all.push(Mutant { name: name.to_owned(), ..Mutant::default() });
            continue;
        }
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let last = all.last_mut().expect("a block begins with its sentence");
        if let Some(file) = line.strip_prefix("file: ") {
            file.clone_into(&mut last.file);
        } else if let Some(tests) = line.strip_prefix("tests: ") {
            tests.clone_into(&mut last.tests);
        } else if let Some(old) = line.strip_prefix('-') {
            last.old.push(old.to_owned());
        } else if let Some(new) = line.strip_prefix('+') {
            last.new.push(new.to_owned());
        } else {
            panic!("cannot read the line: {line}");
        }
    }
    all
}

#[test]
fn every_change_of_the_list_fits_exactly_one_place() {
    let all = mutants();
    assert!(all.len() >= 35, "{}", all.len());
    let wrong: Vec<String> = all
        .iter()
        .filter_map(|m| {
            let text = fs::read_to_string(root().join(&m.file)).unwrap_or_default();
            let count = text.matches(&m.old.join("\n")).count();
            (count != 1).then(|| format!("{}: {count} times in {}", m.name, m.file))
        })
        .collect();
    assert!(wrong.is_empty(), "the code has moved on; mend tests/mutants/list:\n{}", wrong.join("\n"));
    assert!(all.iter().all(|m| !m.old.is_empty() && !m.new.is_empty() && m.old != m.new));
    let names: BTreeSet<&str> = all.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names.len(), all.len(), "two changes have one name");
}

#[test]
fn every_test_file_that_the_list_looks_at_exists() {
    let tests = root().join("tests");
    for mutant in mutants() {
        for attempt in mutant.tests.split('|').map(str::trim) {
            let words: Vec<&str> = attempt.split(' ').collect();
            match words.as_slice() {
                ["--lib", ..] => {}
                ["--test", binary, "--", modules @ ..] if !modules.is_empty() => {
                    let declared = fs::read_to_string(tests.join(binary).with_extension("rs")).unwrap();
                    for module in modules {
                        let (first, rest) = module.split_once("::").expect("a module of the binary, then ::");
                        assert!(declared.contains(&format!("\nmod {first};\n")), "{}: no {module}", mutant.name);
                        let file = tests.join(first).join(rest).with_extension("rs");
                        assert!(rest.is_empty() || file.exists(), "{}: no {}", mutant.name, file.display());
                    }
                }
                _ => panic!("{}: `{attempt}` is neither --lib nor --test BINARY -- MODULE::", mutant.name),
            }
        }
    }
}

#[test]
fn the_page_of_tests_has_a_row_for_every_change() {
    let page = fs::read_to_string(root().join("tests/README.md")).unwrap();
    for mutant in mutants() {
        let rows = page.matches(&format!("| {} | `", mutant.name)).count();
        assert_eq!(rows, 1, "tests/README.md has {rows} rows for: {}", mutant.name);
    }
}

/// `benches/instructions --alone` makes a build that holds one pipeline by the same kind of list.
#[test]
fn the_changes_that_leave_one_pipeline_fit_exactly_one_place_each() {
    let list = fs::read_to_string(root().join("benches/alone")).unwrap();
    let (mut file, mut old) = (String::new(), Vec::new());
    let mut wrong = Vec::new();
    let mut count = 0;
    for line in list.lines().chain(["change: the end"]) {
        if line.starts_with("change: ") {
            if !old.is_empty() {
                let text = fs::read_to_string(root().join(&file)).unwrap_or_default();
                if text.matches(&old.join("\n")).count() != 1 {
                    wrong.push(format!("{file}: {}", old[0]));
                }
                count += 1;
            }
            old.clear();
        } else if let Some(name) = line.strip_prefix("file: ") {
            name.clone_into(&mut file);
        } else if let Some(text) = line.strip_prefix('-') {
            old.push(text);
        } else {
            assert!(line.is_empty() || line.starts_with(['+', '#']), "cannot read the line: {line}");
        }
    }
    assert!(count >= 10, "{count}");
    assert!(wrong.is_empty(), "the code has moved on; mend benches/alone:\n{}", wrong.join("\n"));
}
