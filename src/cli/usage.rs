//! Errors in the command line, in one line.

use std::ffi::OsString;

use clap::CommandFactory as _;

use super::command::Cli;
use crate::load::plain_numbers;

/// Largest length of a word that is shown whole, in characters.
const LONGEST_WORD: usize = 80;

/// Formats a message of the command line's parser as one line that ends in the command for help. The parser uses
/// several lines for the error, values, tips and usage. `given` is the command line with the program's name.
pub(super) fn one_line(e: &clap::Error, given: impl Iterator<Item = OsString>) -> String {
    let text = e.render().to_string();
    let mut line = String::new();
    let mut command = helped(given);
    for part in text.lines().map(str::trim).filter(|part| !part.is_empty()) {
        if let Some(usage) = part.strip_prefix("Usage: ") {
            let words = usage.split(' ').take_while(|word| word.starts_with(|c: char| c.is_ascii_lowercase()));
            command = words.collect::<Vec<_>>().join(" ");
            break;
        }
        if part.starts_with("For more information") {
            break;
        }
        let between = match line.chars().last() {
            None => "",
            Some(':') => " ",
            Some(_) if part.starts_with('[') => " ",
            Some(_) if part.starts_with('<') || part.starts_with('-') => ", ",
            Some(_) => "; ",
        };
        line = line + between + part;
    }
    let words: Vec<String> = plain_numbers(&line).split(' ').map(shortened).collect();
    format!("{}; see `{command} --help`", words.join(" "))
}

/// Returns the command whose help lists the options. The parser's message names it only in some errors.
fn helped(given: impl Iterator<Item = OsString>) -> String {
    let known = Cli::command();
    let asked =
        given.skip(1).find_map(|word| known.find_subcommand(word).map(|found| format!("vitrum {}", found.get_name())));
    asked.unwrap_or_else(|| String::from("vitrum"))
}

fn shortened(word: &str) -> String {
    let count = word.chars().count();
    if count <= LONGEST_WORD {
        return word.to_owned();
    }
    let half = LONGEST_WORD / 2;
    word.chars().take(half).chain("...".chars()).chain(word.chars().skip(count - half)).collect()
}

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::*;

    #[test]
    fn whatever_is_wrong_is_told_in_one_line_with_the_way_to_the_help() {
        let long = "9".repeat(300);
        for (given, said, help) in [
            ("render a.toml --foo", "unexpected argument '--foo'", "vitrum render --help"),
            ("render", "required arguments were not provided: <", "--help"),
            ("render a.toml --width 0", "'0' for '--width", "vitrum render --help"),
            (&format!("render a.toml --width {long}"), "1e300", "--help"),
            ("render a.toml --backend nativ", "[possible values: native", "--help"),
            ("rendre a.toml", "unrecognized subcommand 'rendre'", "vitrum --help"),
            ("render a.toml -o", "a value is required", "--help"),
        ] {
            let words = || std::iter::once("vitrum").chain(given.split(' '));
            let wrong = Cli::try_parse_from(words()).unwrap_err();
            let line = one_line(&wrong, words().map(OsString::from));
            assert!(line.starts_with("error: ") && line.lines().count() == 1 && line.len() < 400, "{line}");
            assert!(line.contains(said) && line.ends_with("`") && line.contains(help), "{given}: {line}");
        }
    }
}
