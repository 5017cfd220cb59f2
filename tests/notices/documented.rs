//! The list of checks and its description are the same.

use std::fs;
use std::path::Path;

use vitrum::notices::CHECKS;

#[test]
fn every_check_has_its_row_in_the_table_of_warnings_and_every_row_its_check() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/README.md");
    let text = fs::read_to_string(file).expect("readable");
    let table = text.split("## Warnings").nth(1).expect("a chapter on warnings");
    let rows = table.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next());
    assert_eq!(rows.collect::<Vec<_>>(), CHECKS.iter().map(|check| check.id).collect::<Vec<_>>());
}
