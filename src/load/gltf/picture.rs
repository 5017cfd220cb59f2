//! Pictures of textures: files beside the model, or bytes within it.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::PathBuf;

use gltf_json::texture::{MagFilter, WrappingMode};
use gltf_json::validation::Checked;

use super::document::{Document, Uri, resolve};
use super::extension::Fields;
use crate::Result;
use crate::load::assembly::Assembly;
use crate::load::pictures::{Picture, Use};
use crate::load::texture;
use crate::scene::Wrap;
use crate::system::files::read;

/// Pictures read so far.
#[derive(Default)]
pub(super) struct Pictures {
    /// Indices by texture and use; `None` for a picture that cannot be read.
    known: HashMap<(usize, Use), Option<Picture>>,
    /// Mean codes by image.
    means: HashMap<usize, Option<[f64; 3]>>,
}

impl Pictures {
    /// Returns the indices of a texture's picture for a use. One that cannot be read is left out, with a warning.
    pub(super) fn picture(
        &mut self,
        document: &Document<'_>,
        texture: usize,
        usage: Use,
        assembly: &mut Assembly<'_>,
    ) -> Result<Option<Picture>> {
        if let Some(&known) = self.known.get(&(texture, usage)) {
            return Ok(known);
        }
        let Some(image) = image(document, texture, assembly)? else { return Ok(None) };
        let wrap = wrap(document, texture, assembly)?;
        let place = match bytes(document, image, assembly) {
            Ok((name, bytes)) => match assembly.picture_in(&name, &bytes, usage, wrap) {
                Ok(place) => Some(place),
                Err(e) => left_out(document, image, &e.to_string(), assembly)?,
            },
            Err(e) => left_out(document, image, &e, assembly)?,
        };
        self.known.insert((texture, usage), place);
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

/// Returns the continuation of a texture's picture.
fn wrap(document: &Document<'_>, texture: usize, assembly: &mut Assembly<'_>) -> Result<[Wrap; 2]> {
    let sampler = document.root.textures.get(texture).and_then(|t| document.root.samplers.get(t.sampler?.value()));
    let Some(sampler) = sampler else { return Ok([Wrap::Repeat; 2]) };
    if matches!(sampler.mag_filter, Some(Checked::Valid(MagFilter::Nearest))) {
        let kind = "pictures that ask for their nearest texel are interpolated";
        assembly.reporter.warn(document.path, 0, kind, || format!(": texture {texture}"))?;
    }
    Ok([sampler.wrap_s, sampler.wrap_t].map(|mode| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    }))
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
