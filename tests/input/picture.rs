//! Pictures.

use super::*;

/// The picture as read.
fn picture(name: &str, bytes: impl AsRef<[u8]>) -> vitrum::Result<vitrum::scene::Texture> {
    let folder = Folder::new().with(name, bytes);
    load::picture(&folder.path(name), &LoadOptions::default())
}

fn png(width: u32, height: u32, gray: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header().unwrap().write_image_data(gray).unwrap();
    bytes
}

#[track_caller]
fn picture_refused(result: vitrum::Result<vitrum::scene::Texture>, code: u8, part: &str) {
    let error = result.expect_err("it was accepted");
    let text = error.to_string();
    assert!(error.exit_code() == code && text.contains(part) && !text.contains('\n'), "{code}, {part}: {text}");
}

#[test]
fn pictures_are_linear_whatever_their_format_and_name() {
    // 188 is the eight-bit value nearest to half the light.
    for name in ["a.png", "a.jpg", "a"] {
        let picture = picture(name, png(2, 1, &[0, 188])).unwrap();
        assert_eq!((picture.width, picture.height, picture.pixels.get(0)), (2, 1, Rgb::ZERO));
        assert!((picture.pixels.get(1) - 0.5029).abs().max_element() < 1e-4);
    }
    let mut pfm = b"Pf\n1 2\n-1\n".to_vec();
    pfm.extend([0.25f32, 3.0].iter().flat_map(|f| f.to_le_bytes()));
    // A PFM's rows go from the bottom up.
    assert_eq!(picture("a.pfm", &pfm).unwrap().pixels.iter().collect::<Vec<_>>(), [Rgb::splat(3.0), Rgb::splat(0.25)]);
    let hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x81";
    assert_eq!(picture("a.hdr", hdr).unwrap().pixels.iter().collect::<Vec<_>>(), [Rgb::ONE]);
}

#[test]
fn an_exr_picture_comes_back_as_written() {
    let folder = Folder::new();
    let at = |x: usize, y: usize| (x as f32, y as f32 * 10.0, 0.5f32);
    exr::prelude::write_rgb_file(folder.path("a.exr"), 3, 2, at).unwrap();
    let picture = load::picture(&folder.path("a.exr"), &LoadOptions::default()).unwrap();
    assert_eq!((picture.width, picture.height), (3, 2));
    assert_eq!(picture.pixels.get(5), Rgb::new(2.0, 10.0, 0.5));
}

/// Case IO-12 of the catalogue.
#[test]
fn pictures_that_are_too_large_are_refused_before_they_are_decoded() {
    let mut huge = png(1, 1, &[0]);
    huge[16..24].copy_from_slice(&[0, 1, 0x86, 0xa0, 0, 1, 0x86, 0xa0]);
    let crc = crc32(&huge[12..29]);
    huge[29..33].copy_from_slice(&crc.to_be_bytes());
    picture_refused(picture("a.png", &huge), 4, "a.png");
    picture_refused(picture("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 20000 +X 20000\n"), 4, "a.hdr");
    picture_refused(picture("a.pfm", "PF\n100000 100000\n-1\n"), 4, "100000");
    let edge = picture("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4294967295 +X 4294967295\n").unwrap_err();
    assert!(matches!(edge.exit_code(), 2 | 4), "{edge}");
}

/// The checksum of PNG chunks (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &b| {
        (0..8).fold(crc ^ u32::from(b), |c, _| if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 })
    })
}

/// Case IO-13 of the catalogue.
#[test]
fn pictures_that_are_broken_or_empty_are_refused() {
    let whole = png(64, 64, &[9; 64 * 64]);
    picture_refused(picture("a.png", &whole[..whole.len() / 2]), 2, "not a readable PNG");
    picture_refused(picture("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 0\n"), 2, "0 by 0");
    picture_refused(picture("a.pfm", "PF\n0 0\n-1\n"), 2, "0 by 0");
    picture_refused(picture("a.pfm", "PF\n2 2\n-1\nxxxx"), 2, "ends early");
    picture_refused(picture("a.pfm", "PF\n2 2\n0\n"), 2, "scale");
    picture_refused(picture("a.pfm", "PF\n-2 2\n1\n"), 2, "width");
    picture_refused(picture("a.png", "<svg xmlns='http://www.w3.org/2000/svg'/>"), 2, "no picture of a kind");
    picture_refused(picture("a.png", ""), 2, "no picture of a kind");
    picture_refused(picture("a.exr", [0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0, 0]), 2, "a.exr");
}

#[test]
fn pixels_that_are_not_finite_or_negative_are_black_and_counted() {
    let mut pfm = b"PF\n2 2\n-1\n".to_vec();
    let pixels = [f32::NAN, 1.0, 1.0, f32::INFINITY, 1.0, 1.0, -1.0, 2.0, 3.0, 1.0, 1.0, 1.0];
    pfm.extend(pixels.iter().flat_map(|f| f.to_le_bytes()));
    let scene = "[environment]\ntype = \"image\"\nfile = \"sky.pfm\"\n";
    let loaded =
        warned(Folder::new().with("sky.pfm", pfm).with("a.toml", scene).load("a.toml"), &["sky.pfm", "3 of 4"]);
    let rows: Vec<Rgb> = loaded.scene.textures[0].pixels.iter().collect();
    assert_eq!(rows[..], [Rgb::new(0.0, 2.0, 3.0), Rgb::ONE, Rgb::new(0.0, 1.0, 1.0), Rgb::new(0.0, 1.0, 1.0)]);
}
