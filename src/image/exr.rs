//! OpenEXR files: linear samples without loss, with settings as attributes.

use std::io::Cursor;

use ::exr::meta::MetaData;
use ::exr::prelude::{
    AttributeValue, Encoding, Image, Layer, LayerAttributes, ReadChannels, ReadLayers, SpecificChannels, Text, Vec2,
    WritableImage,
};

use super::encode::Clipped;
use super::film::Film;
use super::format::{Encoded, Format, cannot_hold};
use super::samples::{Samples, Stored, code_of_share};
use crate::Result;

/// Encodes a film as three binary32 channels, compressed without loss, rows in order.
pub(super) fn encode(film: &Film, metadata: &[(String, String)]) -> Result<Encoded> {
    let mut clipped = Clipped::default();
    film.pixels.as_flattened().iter().for_each(|&x| clipped.note(x));

    let mut attributes = LayerAttributes::default();
    for (name, value) in metadata {
        let text = Text::new_or_none(value).unwrap_or_else(|| Text::new_or_panic(value.escape_default().to_string()));
        attributes.other.insert(Text::new_or_panic(name), AttributeValue::Text(text));
    }
    let channels = SpecificChannels::rgb(|Vec2(x, y)| {
        let [r, g, b] = film.at(x as u32, y as u32);
        (r, g, b)
    });
    let size = (film.width as usize, film.height as usize);
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels);
    let mut bytes = Vec::new();
    Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(Cursor::new(&mut bytes))
        .map_err(|e| cannot_hold(film, Format::Exr, e))?;
    sort_attributes(&mut bytes);
    Ok(Encoded { bytes, clipped })
}

/// Sorts the attributes of a one-part file by name. `exr` keeps them in a hash map of random order, but the same
/// picture must give the same bytes.
///
/// The file begins with 8 bytes of magic number and version. Each attribute consists of its name and type, each ended
/// by a zero, the length of its value in 4 bytes, and the value. A zero ends the list (OpenEXR file layout, "Header").
fn sort_attributes(bytes: &mut [u8]) {
    let text_end = |from: usize| bytes[from..].iter().position(|&b| b == 0).map(|n| from + n + 1);
    let attribute_end = |from: usize| -> Option<usize> {
        let value = text_end(text_end(from)?)?;
        let length = bytes.get(value..value + 4)?.try_into().ok().map(u32::from_le_bytes)?;
        Some(value + 4 + length as usize).filter(|&end| end < bytes.len())
    };
    let start = 8;
    let mut end = start;
    let mut attributes = Vec::new();
    while bytes.get(end).is_some_and(|&b| b != 0) {
        let Some(next) = attribute_end(end) else {
            return;
        };
        attributes.push(bytes[end..next].to_vec());
        end = next;
    }
    attributes.sort();
    bytes[start..end].copy_from_slice(&attributes.concat());
}

/// Returns the size of the largest layer, and the peak bytes per pixel during decoding, from the header alone.
pub(super) fn size(bytes: &[u8]) -> std::result::Result<((u32, u32), u64), String> {
    let meta = MetaData::read_from_buffered(bytes, false).map_err(|e| e.to_string())?;
    let mut largest = Vec2(0, 0);
    let mut channels = 0;
    for header in &meta.headers {
        if header.deep {
            return Err(String::from("it holds deep data, which is not read"));
        }
        if header.channels.list.len() > 64 {
            return Err(format!("it has {} channels; up to 64 are read", header.channels.list.len()));
        }
        channels = channels.max(header.channels.list.len());
        if header.layer_size.area() >= largest.area() {
            largest = header.layer_size;
        }
    }
    let edge = |x: usize| u32::try_from(x).unwrap_or(u32::MAX);
    // Samples of all channels, three of them converted, and the film.
    Ok(((edge(largest.x()), edge(largest.y())), (4 * channels + 12 + 12) as u64))
}

/// Decodes the first layer's `R`, `G` and `B`, or its `Y` alone, and its `A`.
pub(super) fn decode(bytes: &[u8]) -> std::result::Result<Stored, String> {
    let image = ::exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| e.to_string())?;
    let layer = &image.layer_data;
    let Vec2(width, height) = layer.size;
    let channels = &layer.channel_data.list;
    let samples = |name: &str| -> Option<Vec<f32>> {
        let channel = channels.iter().find(|c| c.name.eq_case_insensitive(name))?;
        let samples: Vec<f32> = channel.sample_data.values_as_f32().collect();
        (samples.len() == width * height).then_some(samples)
    };
    let colours = match (samples("R"), samples("G"), samples("B")) {
        (Some(r), Some(g), Some(b)) => [r, g, b],
        _ => match samples("Y") {
            Some(y) => [y.clone(), y.clone(), y],
            None => return Err(String::from("it has neither channels R, G and B in full resolution nor a channel Y")),
        },
    };
    let [r, g, b] = colours;
    let pixels = r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect();
    let alpha = samples("A").map(|a| a.into_iter().map(code_of_share).collect());
    Ok(Stored::new((width as u32, height as u32), Samples::Light(pixels), alpha))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_picture_is_the_same_bytes_with_its_attributes_in_order() {
        let film = Film::new(3, 2);
        let metadata: Vec<_> = (0..9).map(|i| (format!("vitrum:{i}"), format!("value {i}"))).collect();
        let first = encode(&film, &metadata).unwrap().bytes;
        for _ in 0..8 {
            assert!(encode(&film, &metadata).unwrap().bytes == first);
        }
        let meta = MetaData::read_from_buffered(first.as_slice(), true).unwrap();
        assert_eq!(meta.headers[0].own_attributes.other.len(), 9);
        let name = |i: usize| format!("vitrum:{i}\0").into_bytes();
        let place = |i: usize| first.windows(9).position(|w| w == name(i)).unwrap();
        assert!((1..9).all(|i| place(i - 1) < place(i)));
        assert_eq!(decode(&first).unwrap().into_film(), film);
    }
}
