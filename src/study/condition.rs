//! Condition of pixels: a pixel is ill-conditioned if its `f64` value changes with the last digits of its rays.

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_4;
use std::sync::atomic::Ordering;
use std::time::Instant;

use glam::DVec3;
use rayon::prelude::*;

use crate::render::reference::{Prepared, Tally};
use crate::render::{FilmRay, Observer};
use crate::scene::Scene;
use crate::{Error, Result};

/// Error of an `f32` renderer at each surface, in ulps.
pub const ULPS: f64 = 8.0;

/// Condition tests of single pixels in the exact `f64` picture; results are cached.
#[derive(Debug)]
pub struct Condition<'a> {
    prepared: Prepared<'a>,
    scene: &'a Scene,
    tolerance: f64,
    observer: &'a Observer,
    known: HashMap<(u32, u32), bool>,
}

impl<'a> Condition<'a> {
    /// Creates the tests for a scene with the reference's settings. A pixel counts as moved if a channel changes by
    /// more than `tolerance`, in units of radiance.
    #[must_use]
    pub fn new(scene: &'a Scene, prepared: Prepared<'a>, tolerance: f64, observer: &'a Observer) -> Self {
        Self { prepared, scene, tolerance, observer, known: HashMap::new() }
    }

    /// Returns for each pixel true if its `f64` value changes by more than the tolerance when its rays move by [`ULPS`]
    /// ulps of `f32`, or by as many for each level of their paths. The rays of a pixel move together, each to eight
    /// sides. Directions of camera rays and of shadow rays move by ulps of 1, and origins by ulps of the eye's largest
    /// coordinate. Area lamps and wavelengths are sampled as in the picture. The result is `None` if `until` passes
    /// first.
    ///
    /// # Errors
    /// Returns `Error::Interrupted` if the observer requests a stop.
    pub fn moves(&mut self, pixels: &[(u32, u32)], until: Option<Instant>) -> Result<Vec<Option<bool>>> {
        let fresh: Vec<(u32, u32)> = pixels.iter().copied().filter(|p| !self.known.contains_key(p)).collect();
        let this = &*self;
        let ask = |&(x, y): &(u32, u32)| this.moved(x, y, until);
        let found: Vec<Option<bool>> = fresh.par_iter().map(ask).collect::<Result<_>>()?;
        self.known.extend(fresh.into_iter().zip(found).filter_map(|(p, found)| Some((p, found?))));
        Ok(pixels.iter().map(|p| self.known.get(p).copied()).collect())
    }

    /// Returns the smallest movement of its rays, in ulps, at which a pixel changes: the first of 1, 2, 4, ... up to
    /// [`ULPS`] per level of their paths. Returns `None` if none does.
    #[must_use]
    pub fn moves_at(&self, x: u32, y: u32) -> Option<f64> {
        let pixel = Pixel::of(self, x, y);
        let most = ULPS * pixel.levels();
        let steps = std::iter::successors(Some(1.0), |ulps| Some(ulps * 2.0)).take_while(|&ulps| ulps < most);
        steps.chain([most]).find(|&ulps| pixel.moves(ulps, &|| true) == Some(true))
    }

    /// Returns a pixel in `f64`, from the light samples and wavelengths of the picture.
    #[must_use]
    pub fn exact(&self, x: u32, y: u32) -> Tally {
        self.prepared.tally_of(x, y)
    }

    fn moved(&self, x: u32, y: u32, until: Option<Instant>) -> Result<Option<bool>> {
        let stopped = || self.observer.stop.load(Ordering::Relaxed);
        let goes_on = || !stopped() && until.is_none_or(|until| Instant::now() < until);
        let found = goes_on().then(|| Pixel::of(self, x, y)).and_then(|pixel| {
            let moves = pixel.moves(ULPS, &goes_on)?;
            if moves { Some(true) } else { pixel.moves(ULPS * pixel.levels(), &goes_on) }
        });
        if stopped() { Err(Error::Interrupted) } else { Ok(found) }
    }
}

/// Camera rays of one pixel.
struct Pixel<'a> {
    condition: &'a Condition<'a>,
    /// Column and row.
    place: [u32; 2],
    /// Origin and unit direction of each ray, in the order of their sample indices.
    rays: Vec<(DVec3, DVec3)>,
    here: [f64; 3],
}

/// Movement of the rays.
#[derive(Clone, Copy, Default)]
struct Step {
    /// Vector added to the origin of a camera ray.
    aside: DVec3,
    /// Vector added to the unit direction of a camera ray.
    turned: DVec3,
    /// Vector added to the unit direction of every shadow ray.
    shadows_turned: DVec3,
}

impl<'a> Pixel<'a> {
    fn of(condition: &'a Condition<'a>, x: u32, y: u32) -> Self {
        let n = condition.scene.settings.samples.max(1);
        let within = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
        let ray = |k| condition.prepared.camera_ray(f64::from(x) + within(k % n), f64::from(y) + within(k / n));
        let mut pixel = Self { condition, place: [x, y], rays: (0..n * n).map(ray).collect(), here: [0.0; 3] };
        pixel.here = pixel.mean(|_| Step::default());
        pixel
    }

    /// Returns the film ray of a sample.
    fn film(&self, sample: usize) -> FilmRay {
        FilmRay { pixel: self.place, sample: sample as u32 }
    }

    /// Returns the pixel's value with each ray moved by the step for its direction.
    fn mean(&self, step: impl Fn(DVec3) -> Step) -> [f64; 3] {
        let mut sum = DVec3::ZERO;
        for (sample, &(origin, dir)) in self.rays.iter().enumerate() {
            let Step { aside, turned, shadows_turned } = step(dir);
            let (origin, dir) = (origin + aside, (dir + turned).normalize());
            let seen = self.condition.prepared.trace_turned(self.film(sample), origin, dir, shadows_turned);
            sum += seen.radiance / self.rays.len() as f64;
        }
        sum.to_array()
    }

    /// Returns true if the pixel changes at `ulps`, or `None` if `goes_on` returned false first.
    fn moves(&self, ulps: f64, goes_on: &dyn Fn() -> bool) -> Option<bool> {
        let reach = self.condition.scene.camera.eye.as_dvec3().abs().max_element();
        let scene = self.condition.scene;
        let lit = scene.lights.iter().any(|light| light.shadows) || scene.shining().any();
        let moves = |k: u32| {
            let (sin, cos) = (f64::from(k % 8) * FRAC_PI_4).sin_cos();
            let corner = DVec3::from([0, 1, 2].map(|axis| if k >> axis & 1 == 0 { 1.0 } else { -1.0 }));
            let there = self.mean(|dir| {
                let (right, up) = dir.any_orthonormal_pair();
                let step = (right * cos + up * sin) * (ulps * f64::from(f32::EPSILON));
                match k / 8 {
                    0 => Step { turned: step, ..Step::default() },
                    1 => Step { aside: step * reach, ..Step::default() },
                    // Corners of a cube, because a shadow ray may go in any direction.
                    _ => Step { shadows_turned: corner * (ulps * f64::from(f32::EPSILON)), ..Step::default() },
                }
            });
            there.iter().zip(self.here).any(|(a, b)| (a - b).abs() > self.condition.tolerance)
        };
        for k in 0..if lit { 24 } else { 16 } {
            if !goes_on() {
                return None;
            }
            if moves(k) {
                return Some(true);
            }
        }
        Some(false)
    }

    /// Returns the number of levels of the longest path.
    fn levels(&self) -> f64 {
        let prepared = &self.condition.prepared;
        let of = |(sample, &(origin, dir))| prepared.trace_for(self.film(sample), origin, dir).rays.by_depth.len();
        self.rays.iter().enumerate().map(of).max().unwrap_or(1) as f64
    }
}
