//! Against a renderer nobody here wrote: POV-Ray's pictures of the scenes in `tests/reference`, made by the script
//! `make` in that folder, are what ours must look like.
//!
//! A pixel may differ by [`TOLERANCE`] in a channel, and one in a thousand by more: where it looks along an edge or a
//! path so ill-conditioned that the value belongs to no single ray. The `f64` renderer decides which pixels those
//! are: its own value there moves by more than the tolerance when the camera ray moves by a few ulps of `f32`.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};

use vitrum::accel::{Accel, Backend, BuildOptions};
use vitrum::image::Film;
use vitrum::load;
use vitrum::optics::{Bands, FresnelModel};
use vitrum::render::reference::{self, Prepared};
use vitrum::render::{self, Observer, Options};
use vitrum::scene::Scene;

/// Most that a channel of a pixel may differ, in radiance.
const TOLERANCE: f64 = 5e-4;

/// Distance that a camera ray is moved to see if a pixel is well-conditioned, in ulps of 1: at each of two balls a ray
/// starts up to 7 of them off the surface.
const ULPS: f64 = 16.0;

/// A picture of the reference folder: linear radiance in rows from the top.
struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<[f64; 3]>,
    /// By channel: magnitudes of the weights of the pictures that this one is a sum of; 1 for a picture by itself. Where
    /// each of these may differ by [`TOLERANCE`], the sum may differ by this many tolerances.
    weight: [f64; 3],
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference")
}

fn povray(name: &str) -> Picture {
    let file = File::open(folder().join(format!("{name}.png"))).expect("the picture is committed");
    let mut reader = png::Decoder::new(BufReader::new(file)).read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a small picture")];
    let info = reader.next_frame(&mut bytes).expect("a whole PNG");
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Sixteen), "{name}");
    let level = |i: usize| f64::from(u16::from_be_bytes([bytes[2 * i], bytes[2 * i + 1]])) / 65535.0;
    let pixels = (0..bytes.len() / 6).map(|i| [level(3 * i), level(3 * i + 1), level(3 * i + 2)]).collect();
    Picture { width: info.width, height: info.height, pixels, weight: [1.0; 3] }
}

fn load_scene(name: &str) -> Scene {
    let path = folder().join(name).with_extension("toml");
    match load::scene(&path, &load::LoadOptions::default()) {
        Ok(loaded) => {
            assert!(loaded.report.warnings.is_empty(), "{name}: {:?}", loaded.report.warnings);
            loaded.scene
        }
        Err(e) => panic!("{e}"),
    }
}

/// Largest difference of a channel, in units of what it may differ by: the tolerance times its weight.
fn difference(a: [f64; 3], b: [f64; 3], weight: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).abs() / weight[i]).fold(0.0, |worst, d| if d <= worst { worst } else { d })
}

fn hold_against(renderer: &str, name: &str, film: &Film, expected: &Picture, prepared: &Prepared<'_>) {
    assert_eq!((film.width, film.height), (expected.width, expected.height), "{name}");
    let mut beyond = Vec::new();
    let (mut worst, mut sum) = (0.0_f64, 0.0);
    for y in 0..film.height {
        for x in 0..film.width {
            let theirs = expected.pixels[(y * film.width + x) as usize];
            let ours = film.at(x, y).map(f64::from);
            let d = difference(ours, theirs, expected.weight);
            sum += d;
            if d <= TOLERANCE {
                worst = worst.max(d);
            } else {
                beyond.push((x, y, ours, theirs));
            }
        }
    }
    let pixels = expected.pixels.len();
    let (mean, n) = (sum / pixels as f64, beyond.len());
    println!(
        "{name:10} {renderer:9} mean {mean:.1e}, {n} of {pixels} beyond {TOLERANCE:.0e}, the others within {worst:.1e}"
    );
    assert!(
        n * 1000 <= pixels,
        "{name}, {renderer} renderer: {n} of {pixels} pixels are beyond {TOLERANCE}: {beyond:?}"
    );
    let is_edge = |x, y| prepared.ulps_until_moved(f64::from(x) + 0.5, f64::from(y) + 0.5, TOLERANCE, ULPS).is_some();
    beyond.retain(|&(x, y, ..)| !is_edge(x, y));
    assert!(
        beyond.is_empty(),
        "{name}, {renderer} renderer: pixels (x, y, ours, theirs) differ and are no edges: {beyond:?}"
    );
}

/// Sums pictures made with the index of one wavelength each, weighted by the colours of the wavelengths.
fn in_white_light(name: &str) -> Picture {
    let bands = Bands::new(8, 0.5);
    let mut white: Option<Picture> = None;
    for (k, weight) in bands.weight.iter().enumerate() {
        let of_wave = povray(&format!("{name}/{}", k + 1));
        assert!(of_wave.pixels.iter().flatten().all(|&v| v < 1.0), "{name}/{}: the picture is clipped", k + 1);
        let nothing = || Picture { pixels: vec![[0.0; 3]; of_wave.pixels.len()], weight: [0.0; 3], ..of_wave };
        let sum = white.get_or_insert_with(nothing);
        (0..3).for_each(|c| sum.weight[c] += f64::from(weight[c].abs()));
        for (sum, one) in sum.pixels.iter_mut().zip(&of_wave.pixels) {
            (0..3).for_each(|c| sum[c] += one[c] * f64::from(weight[c]));
        }
    }
    white.expect("eight wavelengths")
}

/// Renders `name` both ways and holds both pictures against POV-Ray's.
fn agrees_with_povray(name: &str, fresnel: FresnelModel) {
    let expected = povray(name);
    assert!(expected.pixels.iter().flatten().all(|&v| v < 1.0), "{name}: the picture is clipped");
    agrees_with(&expected, name, fresnel);
}

fn agrees_with(expected: &Picture, name: &str, fresnel: FresnelModel) {
    let scene = load_scene(name);
    let options = Options { fresnel, ..Options::default() };
    let observer = Observer::default();
    let prepared = Prepared::new(&scene, fresnel);

    let film = reference::render(&scene, &options, &observer).expect("renders").film;
    hold_against("reference", name, &film, expected, &prepared);

    let accel = Accel::build(Backend::Native, &scene.geometry, BuildOptions::default()).expect("there is memory");
    let outcome = render::render(&scene, &accel, &options, &observer).expect("renders");
    assert_eq!((outcome.non_finite, outcome.clamped), (0, 0), "{name}");
    hold_against("native", name, &outcome.film, expected, &prepared);
}

macro_rules! scenes {
    ($($(#[$why:meta])* $test:ident: $name:literal, $fresnel:ident;)*) => {
        $($(#[$why])* #[test] fn $test() { agrees_with_povray($name, FresnelModel::$fresnel); })*

        #[test]
        fn every_picture_of_the_folder_is_compared_and_has_its_sources() {
            let compared = BTreeSet::from([$($name.to_owned()),*]);
            let stems = |extension: &str| -> BTreeSet<String> {
                let files = fs::read_dir(folder()).expect("the folder is there").map(|f| f.expect("readable").path());
                let ours = files.filter(|f| f.extension().is_some_and(|e| e == extension));
                ours.map(|f| f.file_stem().expect("a name").to_string_lossy().into_owned()).collect()
            };
            assert_eq!(stems("png"), compared);
            let with_spectrum = &compared | &BTreeSet::from([String::from("spectrum")]);
            for extension in ["pov", "toml"] {
                assert_eq!(stems(extension), with_spectrum, "{extension}");
            }
        }
    };
}

/// Dispersion, by eight pictures of POV-Ray's that know nothing of it.
#[test]
fn a_stone_and_a_ball_that_divide_white_light() {
    agrees_with(&in_white_light("spectrum"), "spectrum", FresnelModel::Exact);
}

scenes! {
    a_glass_ball_over_tiles: "sphere", Exact;
    a_cut_stone_of_flat_facets: "gem", Exact;
    /// POV-Ray gets Fresnel's share wrong where a ray leaves one medium into another, so the share is fixed.
    four_balls_each_inside_the_one_before: "nested", Off;
    dense_glass_enclosed_in_water: "enclosed", Exact;
    glass_and_a_bubble_with_the_eye_under_water: "submerged", Exact;
    the_window_of_snell_from_inside_the_water: "window", Exact;
    coloured_glass_by_the_law_of_fading: "coloured", Exact;
    coloured_glass_along_ways_of_any_length: "tinted", Exact;
    facing_mirrors_at_forty_reflections: "hall", Exact;
    a_point_light_and_its_shadows: "shadow", Exact;
    a_panel_of_light_and_its_soft_shadows: "soft", Exact;
    highlights_under_a_spot_and_a_directional_light: "lights", Exact;
    half_mirrors_and_varnish_in_parallel_projection: "mixed", Exact;
}
