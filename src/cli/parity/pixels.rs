//! Comparison of the contenders' pictures, pixel by pixel, with a picture that the same shading makes from the
//! arbiter's hits.
//!
//! All of them share the shading code, so only hits can differ. The `f64` renderer tells if a difference is a fault of
//! the path or due to a ray at an edge.

use std::sync::atomic::Ordering;

use rayon::prelude::*;

use crate::image::Film;
use crate::render::Observer;
use crate::render::reference::Prepared;
use crate::{Error, Result};

/// Largest difference of a channel that passes, in radiance.
pub(super) const TOLERANCE: f64 = 5e-4;

/// Error of an `f32` renderer at each surface, in ulps.
pub(super) const ULPS: f64 = 8.0;

/// Comparison of one contender's picture with the arbiter's.
#[derive(Clone, Debug, Default)]
pub(super) struct Pixels {
    /// Number of pixels beyond the tolerance.
    pub differ: u64,
    /// Number of these whose `f64` value changes as much when the camera ray moves by [`ULPS`]. Most are at edges.
    pub edge: u64,
    /// Number of these that need a larger movement, of at most [`ULPS`] for each level of the path.
    pub deep: u64,
    /// Largest difference within the tolerance.
    pub largest_within: f64,
    /// Worst of the pixels that differ without such an excuse.
    pub worst: Option<Worst>,
    /// Number of pixels beyond the tolerance from the first contender's.
    pub differs_from_first: u64,
}

/// A wrong pixel.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub(super) struct Worst {
    /// Column from the left.
    pub x: u32,
    /// Row from the top.
    pub y: u32,
    /// The contender's radiance.
    pub value: [f32; 3],
    /// Radiance from the arbiter's hits.
    pub reference: [f32; 3],
}

impl Pixels {
    /// Returns the number of pixels that differ without excuse.
    pub fn wrong(&self) -> u64 {
        self.differ - self.edge - self.deep
    }
}

/// Compares the contenders' `films` with `truth`, of the same size.
///
/// # Errors
/// `Interrupted`.
pub(super) fn compare(prepared: &Prepared, truth: &Film, films: &[Film], observer: &Observer) -> Result<Vec<Pixels>> {
    let rows = (0..truth.height).into_par_iter().map(|y| row(prepared, truth, films, y, observer));
    let rows: Vec<_> = rows.collect::<Result<_>>()?;
    let mut sum = vec![Pixels::default(); films.len()];
    for row in rows {
        for (sum, part) in sum.iter_mut().zip(row) {
            sum.differ += part.differ;
            sum.edge += part.edge;
            sum.deep += part.deep;
            sum.largest_within = sum.largest_within.max(part.largest_within);
            sum.differs_from_first += part.differs_from_first;
            keep_worst(&mut sum.worst, part.worst);
        }
    }
    Ok(sum)
}

fn row(prepared: &Prepared, truth: &Film, films: &[Film], y: u32, observer: &Observer) -> Result<Vec<Pixels>> {
    let mut row = vec![Pixels::default(); films.len()];
    for x in 0..truth.width {
        if observer.stop.load(Ordering::Relaxed) {
            return Err(Error::Interrupted);
        }
        let reference = truth.at(x, y);
        let mut moved = None;
        for (film, pixels) in films.iter().zip(&mut row) {
            let value = film.at(x, y);
            pixels.differs_from_first += u64::from(difference(value, films[0].at(x, y)) > TOLERANCE);
            let off = difference(value, reference);
            if off <= TOLERANCE {
                pixels.largest_within = pixels.largest_within.max(off);
                continue;
            }
            pixels.differ += 1;
            let (column, line) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
            match *moved.get_or_insert_with(|| ulps_until_moved(prepared, column, line)) {
                Some(ulps) if ulps <= ULPS => pixels.edge += 1,
                Some(_) => pixels.deep += 1,
                None => keep_worst(&mut pixels.worst, Some(Worst { x, y, value, reference })),
            }
        }
    }
    Ok(row)
}

/// Returns [`Prepared::ulps_until_moved`], up to [`ULPS`] for each level of the path.
fn ulps_until_moved(prepared: &Prepared, x: f64, y: f64) -> Option<f64> {
    let (origin, dir) = prepared.camera_ray(x, y);
    let levels = prepared.trace(origin, dir).rays.by_depth.len().max(1);
    prepared.ulps_until_moved(x, y, TOLERANCE, ULPS * levels as f64)
}

/// Largest difference of a channel; infinite if one is NaN.
fn difference(a: [f32; 3], b: [f32; 3]) -> f64 {
    let off = |i: usize| (f64::from(a[i]) - f64::from(b[i])).abs();
    (0..3).map(off).fold(0.0, |worst: f64, off| if off.is_nan() { f64::INFINITY } else { worst.max(off) })
}

fn keep_worst(kept: &mut Option<Worst>, new: Option<Worst>) {
    let off = |w: &Worst| difference(w.value, w.reference);
    if let Some(new) = new
        && kept.as_ref().is_none_or(|kept| off(&new) > off(kept))
    {
        *kept = Some(new);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Geometry, GeometryMask, Shape, Sphere};
    use crate::optics::FresnelModel;
    use crate::render::Options;
    use crate::scene::{Camera, Environment, Material, Object, Origin, Rgb, Scene, Settings};

    #[test]
    fn a_pixel_off_is_wrong_in_the_middle_of_a_surface_and_excused_on_an_outline() {
        let ball = Shape::Sphere(Sphere { centre: glam::Vec3::ZERO, radius: 1.0 });
        let scene = Scene {
            geometry: vec![Geometry { shape: ball, mask: GeometryMask::OPAQUE }],
            objects: vec![Object { name: String::new(), material: 0, origin: Origin::default() }],
            materials: vec![Material::black("black")],
            media: vec![crate::scene::Medium::air()],
            environment: Environment::Constant(Rgb::ONE),
            // The middle of the first column is a tangent: the outline is at 45 degrees.
            camera: Camera {
                eye: glam::Vec3::Z * 2.0_f32.sqrt(),
                projection: crate::scene::Projection::Pinhole { vfov: 90.0 },
                target: glam::Vec3::ZERO,
                ..Camera::default()
            },
            settings: Settings { width: 2, height: 1, ..Settings::default() },
            ..Scene::default()
        };
        let options = Options { threads: 1, ..Options::default() };
        let observer = Observer::default();
        let prepared = Prepared::new(&scene, FresnelModel::Exact);
        let film = crate::render::reference::render(&scene, &options, &observer).unwrap().film;
        let same = compare(&prepared, &film, std::slice::from_ref(&film), &observer).unwrap().remove(0);
        assert_eq!((same.differ, same.wrong(), same.differs_from_first), (0, 0, 0));

        let mut narrow = scene.clone();
        narrow.camera.projection = crate::scene::Projection::Pinhole { vfov: 20.0 };
        for (scene, wrong) in [(&narrow, 1), (&scene, 0)] {
            let prepared = Prepared::new(scene, FresnelModel::Exact);
            let right = crate::render::reference::render(scene, &options, &observer).unwrap().film;
            let mut off = right.clone();
            off.pixels[0] = off.pixels[0].map(|v| (v - 0.5).abs() + 0.1);
            let found = compare(&prepared, &right, &[right.clone(), off], &observer).unwrap().remove(1);
            assert_eq!((found.differ, found.wrong(), found.differs_from_first), (1, wrong, 1), "{found:?}");
            assert_eq!(found.worst.map(|w| (w.x, w.y)), (wrong == 1).then_some((0, 0)));
        }
    }

    #[test]
    fn what_is_no_number_differs_by_more_than_anything() {
        assert_eq!(difference([0.0, f32::NAN, 0.0], [0.0; 3]), f64::INFINITY);
        assert_eq!(difference([0.5, 0.0, 2.0], [0.0, 0.0, 1.0]), 1.0);
    }
}
