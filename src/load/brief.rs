//! Shortening of messages that quote long input.

/// Largest number of characters of a message; messages without long quotes are far shorter.
const MOST: usize = 600;

/// Largest number of digits of a number shown in full.
const MOST_DIGITS: usize = 40;

/// Returns the text with numbers of more than 40 digits, such as a written-out `1e300`, in scientific notation.
pub(crate) fn plain_numbers(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        out.push_str(&rest[..start]);
        rest = &rest[start..];
        let end = rest.find(|c: char| !c.is_ascii_digit() && c != '.' && c != '_').unwrap_or(rest.len());
        let (digits, behind) = rest.split_at(end);
        match digits.replace('_', "").parse::<f64>() {
            Ok(x) if digits.len() > MOST_DIGITS && x.is_finite() => out.push_str(&format!("{x:e}")),
            _ if digits.len() > MOST_DIGITS => out.push_str(&format!("{}...", &digits[..MOST_DIGITS / 2])),
            _ => out.push_str(digits),
        }
        rest = behind;
    }
    out + rest
}

/// Returns the message on one line, with short numbers, and without its middle if it is too long.
pub(super) fn brief(message: String) -> String {
    let message = plain_numbers(&message);
    let message = if message.contains(char::is_control) { message.replace(char::is_control, " ") } else { message };
    let count = message.chars().count();
    if count <= MOST {
        return message;
    }
    let byte = |n: usize| message.char_indices().nth(n).map_or(message.len(), |(at, _)| at);
    format!("{} ... {}", &message[..byte(MOST / 2)], &message[byte(count - MOST / 2)..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_fill_lines_are_written_with_an_exponent() {
        assert_eq!(plain_numbers("`fov` is 12.5; 3 of 4"), "`fov` is 12.5; 3 of 4");
        assert_eq!(plain_numbers(&format!("is {}; it", 1e300)), "is 1e300; it");
        assert_eq!(plain_numbers(&format!("[-{}, {}]", f64::MAX, 1e-300)), "[-1.7976931348623157e308, 1e-300]");
        assert_eq!(plain_numbers(&format!("é{}é", "7".repeat(400))), format!("é{}...é", "7".repeat(20)));
    }

    #[test]
    fn the_middle_of_a_long_message_is_left_out() {
        assert_eq!(brief(String::from("`a` is odd")), "`a` is odd");
        let long = brief(format!("no material {} is known", "é".repeat(100_000)));
        assert_eq!(long.chars().count(), MOST + 5);
        assert_eq!(brief(String::from("no `a\nb\u{1b}`")), "no `a b `");
        assert!(long.starts_with("no material é") && long.ends_with("é is known"));
    }
}
