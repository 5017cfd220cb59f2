//! Pictures of textures: files beside the model, or bytes within it.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::PathBuf;

use super::document::{Document, Uri, resolve};
use super::extension::Fields;
use crate::Result;
use crate::load::assembly::Assembly;
use crate::load::texture;
use crate::system::files::read;

/// Pictures read so far.
#[derive(Default)]
pub(super) struct Pictures {
    /// Index into `Scene::textures` by image, and by whether its codes are no colours; `None` for a picture that cannot be
    /// read.
    known: HashMap<(usize, bool), Option<u32>>,
    /// Mean codes by image.
    means: HashMap<usize, Option<[f64; 3]>>,
}

impl Pictures {
    /// Returns the index of a texture's picture in linear colour. One that cannot be read is left out, with a warning.
    pub(super) fn colour(
        &mut self,
        document: &Document<'_>,
        texture: usize,
        assembly: &mut Assembly<'_>,
    ) -> Result<Option<u32>> {
        self.picture(document, texture, false, assembly)
    }

    /// Returns the index of a texture's picture whose codes are shares of the largest one.
    pub(super) fn codes(
        &mut self,
        document: &Document<'_>,
        texture: usize,
        assembly: &mut Assembly<'_>,
    ) -> Result<Option<u32>> {
        self.picture(document, texture, true, assembly)
    }

    fn picture(
        &mut self,
        document: &Document<'_>,
        texture: usize,
        linear: bool,
        assembly: &mut Assembly<'_>,
    ) -> Result<Option<u32>> {
        let Some(image) = image(document, texture, assembly)? else { return Ok(None) };
        if let Some(&known) = self.known.get(&(image, linear)) {
            return Ok(known);
        }
        let place = match bytes(document, image, assembly) {
            Ok((name, bytes)) => match assembly.picture_in(&name, &bytes, linear) {
                Ok(place) => Some(place),
                Err(e) => left_out(document, image, &e.to_string(), assembly)?,
            },
            Err(e) => left_out(document, image, &e, assembly)?,
        };
        self.known.insert((image, linear), place);
        Ok(place)
    }

    /// Returns the mean of a texture's codes, as shares of the largest one.
    pub(super) fn mean(
        &mut self,
        document: &Document<'_>,
        texture: usize,
        assembly: &mut Assembly<'_>,
    ) -> Result<Option<[f64; 3]>> {
        let Some(image) = image(document, texture, assembly)? else { return Ok(None) };
        if let Some(&known) = self.means.get(&image) {
            return Ok(known);
        }
        let mean = match bytes(document, image, assembly) {
            Ok((name, bytes)) => match texture::mean(&bytes, &name, &assembly.picture_limits()) {
                Ok(mean) => Some(mean),
                Err(e) => left_out(document, image, &e.to_string(), assembly)?,
            },
            Err(e) => left_out(document, image, &e, assembly)?,
        };
        self.means.insert(image, mean);
        Ok(mean)
    }
}

fn left_out<T>(document: &Document<'_>, image: usize, why: &str, assembly: &mut Assembly<'_>) -> Result<Option<T>> {
    let kind = format!("picture {image} left out: {why}");
    assembly.reporter.warn(document.path, 0, &kind, String::new)?;
    Ok(None)
}

/// Returns the image of a texture.
fn image(document: &Document<'_>, texture: usize, assembly: &mut Assembly<'_>) -> Result<Option<usize>> {
    let Some(found) = document.root.textures.get(texture) else {
        let kind = "a texture that does not exist is left out";
        assembly.reporter.warn(document.path, 0, kind, || format!(": number {texture}"))?;
        return Ok(None);
    };
    let webp = Fields::of(found.extensions.as_ref().map(|e| &e.others), "EXT_texture_webp");
    let image = webp.and_then(|webp| webp.index("source")).unwrap_or(found.source.value());
    if image >= document.root.images.len() {
        let kind = "a texture without a picture is left out; save its picture as PNG or JPEG";
        assembly.reporter.warn(document.path, 0, kind, || format!(": texture {texture}"))?;
        return Ok(None);
    }
    Ok(Some(image))
}

/// Returns the bytes of an image with its name in messages, or the reason why there are none.
fn bytes<'d>(
    document: &'d Document<'_>,
    image: usize,
    assembly: &Assembly<'_>,
) -> std::result::Result<(PathBuf, Cow<'d, [u8]>), String> {
    let found = document.root.images.get(image).ok_or_else(|| format!("there is no image {image}"))?;
    let within = || {
        let mut name = document.path.as_os_str().to_owned();
        name.push(format!("#image{image}"));
        PathBuf::from(name)
    };
    match (&found.buffer_view, &found.uri) {
        (Some(view), _) => Ok((within(), document.view(view.value())?.0.into())),
        (None, Some(uri)) => match resolve(uri, document.path, assembly)? {
            Uri::Data(bytes) => Ok((within(), bytes.into())),
            Uri::File(file) => {
                let bytes = read(&file, assembly.options.limits.file_bytes).map_err(|e| e.to_string())?;
                Ok((file, bytes.into()))
            }
        },
        (None, None) => Err(String::from("it names no file and no buffer")),
    }
}
