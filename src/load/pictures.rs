//! Pictures of a scene: each is read once for each use.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::Limits;
use super::assembly::Assembly;
use super::texture::{self, Reading};
use crate::Result;
use crate::image::linear_from_srgb;
use crate::scene::{Texels, Texture, Wrap};

/// Use of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Use {
    /// Colours.
    Colour,
    /// Colours in sRGB, whatever the file says about its codes.
    Srgb,
    /// As [`Use::Srgb`], and covering where its alpha is at least this code.
    Cut(u8),
    /// Shares of the largest code, without colour.
    Codes,
    /// Coverage: its alpha channel, else a channel (`r`, `g`, `b`), else its mean.
    Mask(Option<u8>),
}

/// Pictures read so far.
#[derive(Debug, Default)]
pub(super) struct Pictures {
    /// Index into `Scene::textures`, and that of the picture's alpha channel, by path, use and continuation.
    places: HashMap<(PathBuf, Use, [Wrap; 2]), Picture>,
    bytes: u64,
}

/// Indices of a picture in `Scene::textures`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Picture {
    pub texture: u32,
    /// Coverage by its alpha channel, if that is not opaque everywhere.
    pub alpha: Option<u32>,
}

impl Assembly<'_> {
    /// Reads a picture once and returns its index. Its alpha channel is left out with a warning.
    pub(super) fn picture(&mut self, path: &Path) -> Result<u32> {
        let known = self.pictures.places.contains_key(&(path.to_owned(), Use::Colour, [Wrap::Repeat; 2]));
        let picture = self.picture_for(path, Use::Colour, [Wrap::Repeat; 2])?;
        if picture.alpha.is_some() && !known {
            self.reporter.warn(path, 0, "the picture's alpha channel is left out", String::new)?;
        }
        Ok(picture.texture)
    }

    /// Reads a picture once for a use and returns its indices.
    pub(super) fn picture_for(&mut self, path: &Path, usage: Use, wrap: [Wrap; 2]) -> Result<Picture> {
        let key = (path.to_owned(), usage, wrap);
        if let Some(&picture) = self.pictures.places.get(&key) {
            return Ok(picture);
        }
        let reading = texture::read(path, &self.picture_limits(), usage != Use::Colour)?;
        self.keep_picture(key, reading)
    }

    /// Decodes the bytes of a picture once for a use and returns its indices. Messages and later calls know it as `name`.
    pub(super) fn picture_in(&mut self, name: &Path, bytes: &[u8], usage: Use, wrap: [Wrap; 2]) -> Result<Picture> {
        let key = (name.to_owned(), usage, wrap);
        if let Some(&picture) = self.pictures.places.get(&key) {
            return Ok(picture);
        }
        let reading = texture::decode(bytes, name, &self.picture_limits(), usage != Use::Colour)?;
        self.keep_picture(key, reading)
    }

    /// Returns the limits for the next picture.
    pub(super) fn picture_limits(&self) -> Limits {
        let mut limits = self.options.limits;
        limits.texture_bytes = limits.texture_bytes.saturating_sub(self.pictures.bytes);
        limits
    }

    fn keep_picture(&mut self, key: (PathBuf, Use, [Wrap; 2]), reading: Reading) -> Result<Picture> {
        let (path, usage, wrap) = (&key.0, key.1, key.2);
        let size = (reading.texture.width, reading.texture.height);
        if reading.repaired > 0 {
            let pixels = reading.texture.pixels.len();
            let kind = "pixels that are not finite or below zero count as black in those channels";
            self.reporter.warn(path, 0, kind, || format!(" ({} of {pixels})", reading.repaired))?;
        }
        let name = reading.texture.name.clone();
        let mask = |codes| Texture { wrap, ..Texture::new(name.as_str(), size.0, size.1, coverage(codes)) };
        let picture = match usage {
            Use::Colour | Use::Srgb | Use::Cut(_) => {
                let mut colours = Texture { wrap, ..reading.texture };
                if usage != Use::Colour {
                    colours.pixels = srgb(colours.pixels);
                }
                let texture = self.add_texture(colours);
                let alpha = reading.alpha.map(|codes| match usage {
                    Use::Cut(least) => codes.iter().map(|&c| if c >= least { 255 } else { 0 }).collect(),
                    _ => codes,
                });
                Picture { texture, alpha: alpha.map(|codes| self.add_texture(mask(codes))) }
            }
            Use::Codes => Picture { texture: self.add_texture(Texture { wrap, ..reading.texture }), alpha: None },
            Use::Mask(channel) => {
                let codes = match (reading.alpha, channel) {
                    (Some(alpha), None | Some(b'm')) => alpha,
                    (_, channel) => scalar(&reading.texture.pixels, channel),
                };
                Picture { texture: self.add_texture(mask(codes)), alpha: None }
            }
        };
        self.pictures.places.insert(key, picture);
        Ok(picture)
    }

    fn add_texture(&mut self, texture: Texture) -> u32 {
        self.pictures.bytes += texture.pixels.bytes() as u64;
        self.scene.add_texture(texture)
    }
}

/// Returns the colours of pixels that are shares of the largest code.
fn srgb(shares: Texels) -> Texels {
    let colour = |x: f32| linear_from_srgb(f64::from(x)) as f32;
    match shares {
        Texels::Light(pixels) => Texels::Light(pixels.into_iter().map(|p| p.map(colour)).collect()),
        Texels::Codes { codes, light } => Texels::Codes { codes, light: Box::new(light.map(colour)) },
        Texels::Grey { codes, light } => Texels::Grey { codes, light: Box::new(light.map(colour)) },
    }
}

/// Returns the pixels of a mask: each code is a share of 255.
fn coverage(codes: Vec<u8>) -> Texels {
    Texels::Grey { codes, light: Box::new(std::array::from_fn(|code| code as f32 / 255.0)) }
}

/// Returns one channel of each pixel, or the mean of the three, as codes of shares.
fn scalar(pixels: &Texels, channel: Option<u8>) -> Vec<u8> {
    let pick = |p: crate::scene::Rgb| match channel {
        Some(b'r') => p.x,
        Some(b'g') => p.y,
        Some(b'b') => p.z,
        _ => p.element_sum() / 3.0,
    };
    pixels.iter().map(|p| (pick(p).clamp(0.0, 1.0) * 255.0).round() as u8).collect()
}
