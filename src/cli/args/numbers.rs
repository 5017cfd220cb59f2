//! Parsers of numbers with ranges.

use std::time::Duration;

fn parsed<T: std::str::FromStr>(text: &str) -> Result<T, String> {
    text.trim().parse().map_err(|_| String::from("not a number"))
}

/// Parses a number, or a fraction of two.
fn number(text: &str) -> Result<f64, String> {
    match text.split_once('/') {
        Some((above, below)) => Ok(parsed::<f64>(above)? / parsed::<f64>(below)?),
        None => parsed(text),
    }
}

/// Parses a [`number`], rounded once.
fn number32(text: &str) -> Result<f32, String> {
    if text.contains('/') { Ok(number(text)? as f32) } else { parsed(text) }
}

/// Parses a difference of a channel.
pub(in crate::cli) fn bound(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(String::from("not a number above 0; write 1/512 or 0.002"))
    }
}

pub(in crate::cli) fn cutoff(text: &str) -> Result<f32, String> {
    let x = number32(text)?;
    if (0.0..=1.0).contains(&x) { Ok(x) } else { Err(String::from("not in 0 to 1")) }
}

pub(in crate::cli) fn above_minus_one(text: &str) -> Result<f64, String> {
    let x = number(text)?;
    if x > -1.0 && x.is_finite() { Ok(x) } else { Err(String::from("not a finite number above -1")) }
}

pub(in crate::cli) fn above_zero(text: &str) -> Result<f32, String> {
    let x = number32(text)?;
    if x > 0.0 && x.is_finite() { Ok(x) } else { Err(String::from("not a finite number above 0")) }
}

pub(in crate::cli) fn exposure(text: &str) -> Result<f32, String> {
    let x = number32(text)?;
    if (-64.0..=64.0).contains(&x) { Ok(x) } else { Err(String::from("not in -64 to 64")) }
}

pub(in crate::cli) fn share(text: &str) -> Result<f64, String> {
    let x = number(text)?;
    if (0.0..=1.0).contains(&x) { Ok(x) } else { Err(String::from("not in 0 to 1")) }
}

pub(in crate::cli) fn not_negative(text: &str) -> Result<f64, String> {
    let x = number(text)?;
    if x >= 0.0 && x.is_finite() { Ok(x) } else { Err(String::from("not a finite number of at least 0")) }
}

/// Parses seconds, or a number with `s`, `m` or `h`.
pub(in crate::cli) fn duration(text: &str) -> Result<Duration, String> {
    let (number, unit) = match text.find(|c: char| c.is_ascii_alphabetic()) {
        Some(at) => text.split_at(at),
        None => (text, "s"),
    };
    let factor = match unit {
        "ms" => 1e-3,
        "s" => 1.0,
        "m" | "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(String::from("not a time; write 90s, 5m or 1h")),
    };
    match number.trim().parse::<f64>() {
        Ok(n) if n > 0.0 && n * factor <= 1e6 => Ok(Duration::from_secs_f64(n * factor)),
        _ => Err(String::from("not a time above 0; write 90s, 5m or 1h")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fraction_is_a_number_wherever_one_may_stand() {
        let fraction = Ok(1.0 / 512.0);
        assert_eq!(
            (bound("1/512"), not_negative("1/512"), share("1/512"), above_minus_one("1/512")),
            (fraction.clone(), fraction.clone(), fraction.clone(), fraction)
        );
        assert_eq!(
            (cutoff("1/512"), above_zero("1/512"), exposure("-3/2")),
            (Ok(1.0 / 512.0), Ok(1.0 / 512.0), Ok(-1.5))
        );
        for text in ["1/0", "0/0", "1/", "/2", "1/2/3", "a/b"] {
            assert!(bound(text).is_err() && cutoff(text).is_err() && not_negative(text).is_err(), "{text}");
        }
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        for text in ["nan", "inf", "-0.1", "1.5", "", "a"] {
            assert!(cutoff(text).is_err(), "{text}");
            assert!(share(text).is_err(), "{text}");
        }
        assert!(exposure("nan").is_err() && exposure("65").is_err());
        assert!(not_negative("inf").is_err() && not_negative("-1e-9").is_err());
        assert_eq!((cutoff("0"), exposure("-2"), not_negative("5e-4")), (Ok(0.0), Ok(-2.0), Ok(5e-4)));
    }

    #[test]
    fn times_are_read_or_refused() {
        assert_eq!(duration("90s"), Ok(Duration::from_secs(90)));
        assert_eq!(duration("1.5m"), Ok(Duration::from_secs(90)));
        assert_eq!((duration("2"), duration("1h")), (Ok(Duration::from_secs(2)), Ok(Duration::from_secs(3600))));
        for text in ["", "0s", "-1s", "5 parsecs", "nan", "1e99h"] {
            assert!(duration(text).is_err(), "{text}");
        }
    }
}
