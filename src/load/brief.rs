//! Messages that stay readable whatever the input they quote.

/// Characters of a message; those of one that quotes nothing long are far fewer.
const MOST: usize = 600;

/// The message on one line, its middle left out where it is too long to read.
pub(super) fn brief(message: String) -> String {
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
    fn the_middle_of_a_long_message_is_left_out() {
        assert_eq!(brief(String::from("`a` is odd")), "`a` is odd");
        let long = brief(format!("no material {} is known", "é".repeat(100_000)));
        assert_eq!(long.chars().count(), MOST + 5);
        assert_eq!(brief(String::from("no `a\nb\u{1b}`")), "no `a b `");
        assert!(long.starts_with("no material é") && long.ends_with("é is known"));
    }
}
