//! Suggestions for mistyped names.

/// Returns the name among `known` that is nearest to `given`, if any is near.
pub(super) fn nearest<'a>(given: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // The cost is the product of the lengths; longer names are not typing errors.
    if given.len() > 64 {
        return None;
    }
    let given = given.to_lowercase();
    known
        .into_iter()
        .filter(|name| name.len() <= 128)
        .map(|name| (strsim::normalized_damerau_levenshtein(&given, &name.to_lowercase()), name))
        // One wrong letter in three still counts.
        .filter(|&(likeness, _)| likeness > 0.6)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

/// Returns `; did you mean ...?` for the nearest name, else a list of all names.
pub(crate) fn hint<'a>(given: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> String {
    if let Some(name) = nearest(given, known.clone()) {
        return format!("; did you mean `{name}`?");
    }
    // Longer names are left out as noise.
    let all: Vec<&str> = known.into_iter().filter(|name| name.len() <= 64).take(40).collect();
    if all.is_empty() { String::new() } else { format!("; known are {}", all.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_finds_its_word_and_noise_finds_none() {
        let keys = ["intensity", "position", "falloff"];
        assert_eq!(nearest("intensty", keys), Some("intensity"));
        assert_eq!(nearest("Positon", keys), Some("position"));
        assert_eq!(nearest("fvo", ["eye", "fov"]), Some("fov"));
        assert_eq!(nearest("qqqq", keys), None);
        assert_eq!(nearest(&"a".repeat(100_000), keys), None);
    }
}
