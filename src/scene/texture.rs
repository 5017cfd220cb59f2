//! Pictures for colour lookups.

use glam::DVec3;

use super::Texels;

/// Picture in linear colour; its first row is at the top (texture coordinate v = 1).
///
/// All renderers look it up in the same way. The texel in column `i` and row `j` is centred at `u = (i + 0.5) / width`,
/// `v = 1 - (j + 0.5) / height`. Between centres colours are interpolated bilinearly, along rows first. Surfaces repeat
/// the picture in both directions, or continue it as [`Wrap`] says. An equirectangular environment repeats it in u and
/// extends its first and last row ([`Beyond`]).
#[derive(Clone, Debug, Default)]
pub struct Texture {
    /// File as named in messages.
    pub name: String,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Linear colours, row by row.
    pub pixels: Texels,
    /// Continuation on surfaces, along u and along v.
    pub wrap: [Wrap; 2],
}

/// Continuation of a picture on surfaces beyond texture coordinates of 0 and 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// Repeats the picture.
    #[default]
    Repeat,
    /// Extends the outermost texels.
    Clamp,
    /// Repeats the picture, every other time mirrored.
    Mirror,
}

impl Wrap {
    /// Returns the coordinate in 0..=1 that stands for `t` under [`Self::Clamp`] and [`Self::Mirror`].
    #[must_use]
    fn folded(self, t: f64) -> f64 {
        match self {
            Self::Repeat => t,
            Self::Clamp => t.clamp(0.0, 1.0),
            Self::Mirror => 1.0 - (t.rem_euclid(2.0) - 1.0).abs(),
        }
    }
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
    /// Creates a picture that repeats.
    #[must_use]
    pub fn new(name: impl Into<String>, width: u32, height: u32, pixels: impl Into<Texels>) -> Self {
        Self { name: name.into(), width, height, pixels: pixels.into(), wrap: [Wrap::Repeat; 2] }
    }

    /// Returns the colour on a surface at (`u`, `v`), continued as `wrap` says, in `f64`.
    #[must_use]
    pub fn on_surface(&self, u: f64, v: f64) -> DVec3 {
        if self.wrap == [Wrap::Repeat; 2] {
            return self.lookup(u, v, Beyond::Repeat);
        }
        let [u, v] = [u, v].map(|t| if t.is_finite() { t } else { 0.0 });
        let [columns, rows] = [self.width, self.height].map(i64::from);
        let [x, y] = [(self.wrap[0], u, columns), (self.wrap[1], 1.0 - v, rows)].map(|(wrap, t, count)| {
            let t = if wrap == Wrap::Repeat { t - t.floor() } else { wrap.folded(t) };
            t * count as f64 - 0.5
        });
        let inside = |wrap: Wrap, i: i64, count: i64| match wrap {
            Wrap::Repeat => i.rem_euclid(count),
            Wrap::Clamp | Wrap::Mirror => i.clamp(0, count - 1),
        };
        let texel = |i: f64, j: f64| {
            let (i, j) = (inside(self.wrap[0], i as i64, columns), inside(self.wrap[1], j as i64, rows));
            self.pixels.get((j * columns + i) as usize).as_dvec3()
        };
        let (column, row) = (x.floor(), y.floor());
        let across = |j: f64| texel(column, j).lerp(texel(column + 1.0, j), x - column);
        across(row).lerp(across(row + 1.0), y - row)
    }

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
            self.pixels.get(j as usize * self.width as usize + i).as_dvec3()
        };
        let across = |j: f64| texel(column, j).lerp(texel(column + 1.0, j), x - column);
        across(row).lerp(across(row + 1.0), y - row)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Rgb;

    /// Columns 0, 1; rows top 0, bottom 10.
    fn picture() -> Texture {
        let pixels = [0.0, 1.0, 10.0, 11.0].map(Rgb::splat).to_vec();
        Texture::new("", 2, 2, pixels)
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
    fn a_clamped_picture_ends_in_its_rim_and_a_mirrored_one_turns_back() {
        let at = |wrap: [Wrap; 2], u: f64, v: f64| Texture { wrap, ..picture() }.on_surface(u, v).x;
        assert_eq!(at([Wrap::Clamp; 2], 7.5, 0.75), 1.0);
        assert_eq!(at([Wrap::Clamp; 2], -7.5, 3.0), 0.0);
        assert_eq!(at([Wrap::Clamp, Wrap::Repeat], 1.0, -0.75), 11.0);
        assert_eq!(at([Wrap::Mirror; 2], 1.25, 0.75), 1.0);
        assert_eq!(at([Wrap::Mirror; 2], -0.25, 1.25), 0.0);
        assert_eq!(at([Wrap::Mirror; 2], 2.75, -0.25), 11.0);
        assert_eq!(at([Wrap::Repeat; 2], 1.25, -0.75), 10.0);
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
