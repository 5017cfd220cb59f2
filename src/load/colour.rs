//! Colours in words.

use crate::image::linear_from_srgb;
use crate::scene::Rgb;

/// Returns the linear colour of `#rrggbb` or `#rgb` (sRGB), of three linear numbers with commas between, or of one for a
/// grey.
///
/// # Errors
/// Returns a message that begins with the text and has the cure.
pub fn colour(text: &str) -> Result<Rgb, String> {
    let wrong =
        || format!("`{text}` is no colour; write `#rrggbb`, three linear numbers as `0.8,0.2,0.1`, or one grey");
    if let Some(hex) = text.strip_prefix('#') {
        let digits: Vec<u32> = hex.chars().map(|c| c.to_digit(16)).collect::<Option<_>>().ok_or_else(wrong)?;
        let codes = match digits.as_slice() {
            [r, g, b] => [r * 17, g * 17, b * 17],
            [a, b, c, d, e, f] => [a * 16 + b, c * 16 + d, e * 16 + f],
            _ => return Err(wrong()),
        };
        return Ok(Rgb::from(codes.map(|code| linear_from_srgb(f64::from(code) / 255.0) as f32)));
    }
    let numbers: Vec<f32> = text.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>().ok_or_else(wrong)?;
    let colour = match numbers.as_slice() {
        [grey] => Rgb::splat(*grey),
        [r, g, b] => Rgb::new(*r, *g, *b),
        _ => return Err(wrong()),
    };
    if colour.is_finite() && colour.min_element() >= 0.0 { Ok(colour) } else { Err(wrong()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_codes_of_srgb_or_linear_numbers() {
        assert_eq!(colour("#ff0000"), Ok(Rgb::X));
        assert_eq!(colour("#0f0"), Ok(Rgb::Y));
        assert!((colour("#bcbcbc").unwrap() - 0.5029).abs().max_element() < 1e-4);
        assert_eq!(colour("0.25, 2,0"), Ok(Rgb::new(0.25, 2.0, 0.0)));
        assert_eq!(colour("0.5"), Ok(Rgb::splat(0.5)));
        for bad in ["", "#ff00", "#gggggg", "red", "1,2", "-1", "nan", "1,2,inf"] {
            assert!(colour(bad).is_err(), "{bad}");
        }
    }
}
