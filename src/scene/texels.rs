//! Pixels of a picture in the depth of its file.

use super::Rgb;

/// Linear colours of a picture, row by row. Codes of 8 bits stay codes, with the table that decodes them.
#[derive(Clone, Debug)]
pub enum Texels {
    /// Colours as they are.
    Light(Vec<Rgb>),
    /// Three codes per pixel.
    Codes {
        /// Codes of red, green and blue.
        codes: Vec<[u8; 3]>,
        /// Light of each code.
        light: Box<[f32; 256]>,
    },
    /// One code per pixel, for all channels.
    Grey {
        /// Codes.
        codes: Vec<u8>,
        /// Light of each code.
        light: Box<[f32; 256]>,
    },
}

impl Texels {
    /// Returns the colour of pixel `i`.
    #[inline(always)]
    #[must_use]
    pub fn get(&self, i: usize) -> Rgb {
        match self {
            Self::Light(pixels) => pixels[i],
            Self::Codes { codes, light } => Rgb::from(codes[i].map(|code| light[usize::from(code)])),
            Self::Grey { codes, light } => Rgb::splat(light[usize::from(codes[i])]),
        }
    }

    /// Returns the number of pixels.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Light(pixels) => pixels.len(),
            Self::Codes { codes, .. } => codes.len(),
            Self::Grey { codes, .. } => codes.len(),
        }
    }

    /// Returns true if there is no pixel.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the colours, in order.
    pub fn iter(&self) -> impl Iterator<Item = Rgb> + '_ {
        (0..self.len()).map(|i| self.get(i))
    }

    /// Returns the bytes of the list.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match self {
            Self::Light(pixels) => size_of_val(pixels.as_slice()),
            Self::Codes { codes, .. } => size_of_val(codes.as_slice()),
            Self::Grey { codes, .. } => codes.len(),
        }
    }
}

impl Default for Texels {
    fn default() -> Self {
        Self::Light(Vec::new())
    }
}

impl From<Vec<Rgb>> for Texels {
    fn from(pixels: Vec<Rgb>) -> Self {
        Self::Light(pixels)
    }
}

impl FromIterator<Rgb> for Texels {
    fn from_iter<I: IntoIterator<Item = Rgb>>(pixels: I) -> Self {
        Self::Light(pixels.into_iter().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_takes_one_byte_per_channel_and_gives_the_light_of_its_table() {
        let light: Box<[f32; 256]> = Box::new(std::array::from_fn(|i| i as f32 * 0.5));
        let codes = Texels::Codes { codes: vec![[2, 4, 6], [0, 0, 255]], light: light.clone() };
        assert_eq!((codes.bytes(), codes.get(0)), (6, Rgb::new(1.0, 2.0, 3.0)));
        assert_eq!(codes.iter().collect::<Vec<_>>()[1], Rgb::new(0.0, 0.0, 127.5));
        let grey = Texels::Grey { codes: vec![8], light };
        assert_eq!((grey.bytes(), grey.len(), grey.get(0)), (1, 1, Rgb::splat(4.0)));
    }
}
