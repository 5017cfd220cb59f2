//! Pictures for colour lookups.

use glam::DVec3;

use super::Rgb;

/// Picture in linear colour; its first row is at the top (texture coordinate v = 1).
///
/// All renderers look it up in the same way. The texel in column `i` and row `j` is centred at `u = (i + 0.5) / width`,
/// `v = 1 - (j + 0.5) / height`. Between centres colours are interpolated bilinearly, along rows first. Surfaces repeat
/// the picture in both directions. An equirectangular environment repeats it in u and extends its first and last row
/// ([`Beyond`]).
#[derive(Clone, Debug, Default)]
pub struct Texture {
    /// File as named in messages.
    pub name: String,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Linear colours, row by row.
    pub pixels: Vec<Rgb>,
}

/// Continuation of a picture above its top row and below its bottom row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// Repeats the picture.
    Repeat,
    /// Extends the outermost row.
    Hold,
}

impl Texture {
    /// Returns the colour at texture coordinates (`u`, `v`), of any size, in `f64`. A coordinate that is not finite
    /// counts as 0.
    #[must_use]
    pub fn lookup(&self, u: f64, v: f64, beyond: Beyond) -> DVec3 {
        let [u, v] = [u, v].map(|t| if t.is_finite() { t } else { 0.0 });
        // The integer part is removed first, so that large coordinates keep their digits.
        let x = (u - u.floor()) * f64::from(self.width) - 0.5;
        let v = if beyond == Beyond::Repeat { v - v.floor() } else { v.clamp(0.0, 1.0) };
        let y = (1.0 - v) * f64::from(self.height) - 0.5;
        let (column, row) = (x.floor(), y.floor());
        let texel = |i: f64, j: f64| {
            let i = (i as i64).rem_euclid(i64::from(self.width)) as usize;
            let rows = i64::from(self.height);
            let j = match beyond {
                Beyond::Repeat => (j as i64).rem_euclid(rows),
                Beyond::Hold => (j as i64).clamp(0, rows - 1),
            };
            self.pixels[j as usize * self.width as usize + i].as_dvec3()
        };
        let across = |j: f64| texel(column, j).lerp(texel(column + 1.0, j), x - column);
        across(row).lerp(across(row + 1.0), y - row)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns 0, 1; rows top 0, bottom 10.
    fn picture() -> Texture {
        let pixels = [0.0, 1.0, 10.0, 11.0].map(Rgb::splat).to_vec();
        Texture { name: String::new(), width: 2, height: 2, pixels }
    }

    fn at(u: f64, v: f64, beyond: Beyond) -> f64 {
        picture().lookup(u, v, beyond).x
    }

    #[test]
    fn texel_centres_give_texels_and_v_1_is_the_top() {
        assert_eq!(at(0.25, 0.75, Beyond::Repeat), 0.0);
        assert_eq!(at(0.75, 0.75, Beyond::Repeat), 1.0);
        assert_eq!(at(0.25, 0.25, Beyond::Repeat), 10.0);
        assert_eq!(at(0.75, 0.25, Beyond::Repeat), 11.0);
    }

    #[test]
    fn between_centres_colours_blend_and_the_rim_repeats_or_holds() {
        assert_eq!(at(0.5, 0.5, Beyond::Repeat), 5.5);
        assert_eq!(at(0.0, 0.75, Beyond::Repeat), 0.5);
        assert_eq!(at(-3.0, 4.75, Beyond::Repeat), 0.5);
        assert_eq!(at(0.25, 1.0, Beyond::Repeat), 5.0);
        assert_eq!(at(0.25, 1.0, Beyond::Hold), 0.0);
        assert_eq!(at(0.25, 0.0, Beyond::Hold), 10.0);
        assert_eq!(at(f64::NAN, 0.75, Beyond::Repeat), at(0.0, 0.75, Beyond::Repeat));
    }
}
