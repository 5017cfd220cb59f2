//! Pictures of a scene: each is read once for each use.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::report::Reporter;
use super::{Limits, texture};
use crate::Result;
use crate::scene::{Scene, Texels, Texture, Wrap};

/// Use of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Use {
    /// Colours.
    Colour,
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

impl Pictures {
    /// Reads a picture once for a use, into the scene, and returns its indices.
    pub(super) fn read(
        &mut self,
        path: &Path,
        usage: Use,
        wrap: [Wrap; 2],
        limits: Limits,
        (scene, reporter): (&mut Scene, &mut Reporter),
    ) -> Result<Picture> {
        let key = (path.to_owned(), usage, wrap);
        if let Some(&picture) = self.places.get(&key) {
            return Ok(picture);
        }
        let left = limits.texture_bytes.saturating_sub(self.bytes);
        let reading = texture::read(path, &Limits { texture_bytes: left, ..limits }, usage != Use::Colour)?;
        let (width, height) = (reading.texture.width, reading.texture.height);
        if reading.repaired > 0 {
            let pixels = reading.texture.pixels.len();
            let kind = "pixels that are not finite or below zero count as black in those channels";
            reporter.warn(path, 0, kind, || format!(" ({} of {pixels})", reading.repaired))?;
        }
        let name = reading.texture.name.clone();
        let mask = |codes| Texture { wrap, ..Texture::new(name.as_str(), width, height, coverage(codes)) };
        let mut add = |texture: Texture| {
            self.bytes += texture.pixels.bytes() as u64;
            scene.add_texture(texture)
        };
        let picture = match usage {
            Use::Colour => {
                let texture = add(Texture { wrap, ..reading.texture });
                Picture { texture, alpha: reading.alpha.map(|codes| add(mask(codes))) }
            }
            Use::Mask(channel) => {
                let codes = match (reading.alpha, channel) {
                    (Some(alpha), None | Some(b'm')) => alpha,
                    (_, channel) => scalar(&reading.texture.pixels, channel),
                };
                Picture { texture: add(mask(codes)), alpha: None }
            }
        };
        self.places.insert(key, picture);
        Ok(picture)
    }

    /// Returns true if the colours of a picture, repeated, were read before.
    pub(super) fn has(&self, path: &Path) -> bool {
        self.places.contains_key(&(path.to_owned(), Use::Colour, [Wrap::Repeat; 2]))
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
