//! Numbers as programs write them.

/// Number and its spelling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Spelled<T> {
    /// As every program reads it.
    Plain(T),
    /// With a decimal comma, or with the exponent letter of Fortran.
    Odd(T),
    /// No number.
    Not,
}

impl<T> Spelled<T> {
    /// Returns the number, if it is one.
    pub(super) fn number(self) -> Option<T> {
        match self {
            Self::Plain(x) | Self::Odd(x) => Some(x),
            Self::Not => None,
        }
    }
}

/// Parses a decimal to an `f64` that also rounds to the `f32` nearest to the decimal.
#[inline]
pub(super) fn wide(word: &[u8]) -> Spelled<f64> {
    spelled(word, |text| {
        let x: f64 = text.parse().ok()?;
        // Double rounding can differ halfway between two `f32`, which shows in the last 29 bits of a normal number.
        let halfway = x.to_bits() & 0x1fff_ffff == 0x1000_0000;
        let tiny = x != 0.0 && x.abs() < f64::from(f32::MIN_POSITIVE);
        if halfway || tiny {
            let once: f32 = text.parse().ok()?;
            if x as f32 != once {
                return Some(if f64::from(once) > x { x.next_up() } else { x.next_down() });
            }
        }
        Some(x)
    })
}

/// Parses a decimal to the nearest `f32`.
#[inline]
pub(super) fn narrow(word: &[u8]) -> Spelled<f32> {
    spelled(word, |text| text.parse().ok())
}

#[inline]
fn spelled<T: From<f32>>(word: &[u8], read: impl Fn(&str) -> Option<T>) -> Spelled<T> {
    let Ok(text) = std::str::from_utf8(word) else { return Spelled::Not };
    match read(text) {
        Some(x) => Spelled::Plain(x),
        None => odd(text, read),
    }
}

/// Reads the spellings that only some programs understand. Those of Microsoft's C library for numbers that are none
/// (`1.#QNAN0`, `-1.#IND00`, `1.#INF00`, `-nan(ind)`) are plain, as `nan` is.
#[cold]
fn odd<T: From<f32>>(text: &str, read: impl Fn(&str) -> Option<T>) -> Spelled<T> {
    let lower = text.to_ascii_lowercase();
    let unsigned = lower.trim_start_matches(['+', '-']);
    if let Some((_, kind)) = unsigned.split_once('#').filter(|(digits, _)| digits.starts_with("1.")) {
        let infinite = kind.starts_with("inf");
        let none = ["qnan", "snan", "ind", "nan"].iter().any(|n| kind.starts_with(n));
        if infinite || none {
            return Spelled::Plain(T::from(if infinite { f32::INFINITY } else { f32::NAN }));
        }
    }
    if unsigned.starts_with("nan(") && unsigned.ends_with(')') {
        return Spelled::Plain(T::from(f32::NAN));
    }
    let point = lower.replacen(',', ".", 1);
    let exponent = point.replacen('d', "e", 1);
    read(&exponent).map_or(Spelled::Not, Spelled::Odd)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Option<f64> {
        wide(text.as_bytes()).number()
    }

    #[test]
    fn coordinates_keep_the_digits_of_f64_and_still_round_to_the_f32_nearest_to_the_decimal() {
        assert_eq!(value("5411234.441013"), Some(5411234.441013));
        assert_eq!(value("x"), None);
        // Above halfway between 1 and the next `f32`, by less than `f64` resolves.
        let above = "1.000000059604644775390625000000000001";
        assert_eq!(above.parse::<f64>().unwrap() as f32, 1.0);
        assert_eq!(value(above).unwrap() as f32, 1.0_f32.next_up());
        // Below halfway, where the tie would round up.
        let below = "1.000000178813934326171874999999999999";
        assert_eq!(below.parse::<f64>().unwrap() as f32, 1.0_f32.next_up().next_up());
        assert_eq!(value(below).unwrap() as f32, 1.0_f32.next_up());
        // Between 1 and 2 times the smallest `f32`, above the middle.
        let tiny = "2.10194769649500000000000000001e-45";
        assert_eq!(value(tiny).unwrap() as f32, tiny.parse::<f32>().unwrap());
        assert_eq!(value("-0").unwrap().to_bits(), (-0.0_f64).to_bits());
        assert_eq!(value("1e39").unwrap() as f32, f32::INFINITY);
    }

    #[test]
    fn microsofts_spellings_of_no_number_are_none_and_of_infinity_infinite() {
        for text in ["1.#QNAN0", "-1.#IND00", "1.#SNAN", "-nan(ind)", "nan(snan)", "nan", "-1.#IND"] {
            assert!(value(text).is_some_and(f64::is_nan), "{text}");
        }
        assert_eq!(value("1.#INF00"), Some(f64::INFINITY));
        assert_eq!(value("1.#x"), None);
    }

    #[test]
    fn a_decimal_comma_and_an_exponent_of_fortran_are_read_and_told() {
        assert_eq!(wide(b"-1,25"), Spelled::Odd(-1.25));
        assert_eq!(narrow(b"1.5D-02"), Spelled::Odd(0.015));
        assert_eq!(wide(b"2d1"), Spelled::Odd(20.0));
        assert_eq!(wide(b"1,2,3"), Spelled::Not);
        assert_eq!(wide(b""), Spelled::Not);
        assert_eq!(wide(b"0x10"), Spelled::Not);
    }
}
