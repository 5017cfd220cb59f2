//! Whether a pixel belongs to its camera rays at all, or moves with their last digits.

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_4;
use std::sync::atomic::Ordering;
use std::time::Instant;

use glam::DVec3;
use rayon::prelude::*;

use crate::render::Observer;
use crate::render::reference::Prepared;
use crate::scene::Scene;
use crate::{Error, Result};

/// The few ulps of `f32` that a renderer in it may be off by at each surface.
pub const ULPS: f64 = 8.0;

/// The exact picture in `f64`, asked about single pixels; answers are kept.
#[derive(Debug)]
pub struct Condition<'a> {
    prepared: Prepared<'a>,
    scene: &'a Scene,
    tolerance: f64,
    observer: &'a Observer,
    known: HashMap<(u32, u32), bool>,
}

impl<'a> Condition<'a> {
    /// Of a scene whose settings are the reference's; a pixel moves when a channel does by more than `tolerance`, in
    /// units of radiance.
    #[must_use]
    pub fn new(scene: &'a Scene, prepared: Prepared<'a>, tolerance: f64, observer: &'a Observer) -> Self {
        Self { prepared, scene, tolerance, observer, known: HashMap::new() }
    }

    /// For each pixel, whether its `f64` value moves by more than the tolerance when its camera rays move together by
    /// [`ULPS`] ulps of `f32`, or by as many for each level of their paths: to eight sides, directions by ulps of 1 or
    /// origins by ulps of the eye's largest coordinate. None where `until` came before the answer.
    ///
    /// # Errors
    /// `Interrupted`.
    pub fn moves(&mut self, pixels: &[(u32, u32)], until: Option<Instant>) -> Result<Vec<Option<bool>>> {
        let fresh: Vec<(u32, u32)> = pixels.iter().copied().filter(|p| !self.known.contains_key(p)).collect();
        let this = &*self;
        let ask = |&(x, y): &(u32, u32)| this.moved(x, y, until);
        let found: Vec<Option<bool>> = fresh.par_iter().map(ask).collect::<Result<_>>()?;
        self.known.extend(fresh.into_iter().zip(found).filter_map(|(p, found)| Some((p, found?))));
        Ok(pixels.iter().map(|p| self.known.get(p).copied()).collect())
    }

    /// By how few ulps its camera rays have to move for a pixel to move: the first of 1, 2, 4, ... up to [`ULPS`] for
    /// each level of their paths; none where it does not.
    #[must_use]
    pub fn moves_at(&self, x: u32, y: u32) -> Option<f64> {
        let pixel = Pixel::of(self, x, y);
        let most = ULPS * pixel.levels();
        let steps = std::iter::successors(Some(1.0), |ulps| Some(ulps * 2.0)).take_while(|&ulps| ulps < most);
        steps.chain([most]).find(|&ulps| pixel.moves(ulps, &|| true) == Some(true))
    }

    /// The `f64` value of a pixel.
    #[must_use]
    pub fn value(&self, x: u32, y: u32) -> [f64; 3] {
        Pixel::of(self, x, y).here
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

/// One pixel's camera rays.
struct Pixel<'a> {
    condition: &'a Condition<'a>,
    /// Start and unit direction of each.
    rays: Vec<(DVec3, DVec3)>,
    here: [f64; 3],
}

impl<'a> Pixel<'a> {
    fn of(condition: &'a Condition<'a>, x: u32, y: u32) -> Self {
        let n = condition.scene.settings.samples.max(1);
        let within = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
        let ray = |k| condition.prepared.camera_ray(f64::from(x) + within(k % n), f64::from(y) + within(k / n));
        let mut pixel = Self { condition, rays: (0..n * n).map(ray).collect(), here: [0.0; 3] };
        pixel.here = pixel.mean(|_| [DVec3::ZERO; 2]);
        pixel
    }

    /// Its value with the origin and the direction of each ray moved by what `step` says for the direction.
    fn mean(&self, step: impl Fn(DVec3) -> [DVec3; 2]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for &(origin, dir) in &self.rays {
            let [aside, turned] = step(dir);
            let seen = self.condition.prepared.radiance_along(origin + aside, (dir + turned).normalize());
            for (s, v) in sum.iter_mut().zip(seen) {
                *s += v / self.rays.len() as f64;
            }
        }
        sum
    }

    /// None where it was told not to go on.
    fn moves(&self, ulps: f64, goes_on: &dyn Fn() -> bool) -> Option<bool> {
        let reach = self.condition.scene.camera.eye.as_dvec3().abs().max_element();
        let moves = |k: u32| {
            let (sin, cos) = (f64::from(k / 2) * FRAC_PI_4).sin_cos();
            let there = self.mean(|dir| {
                let (right, up) = dir.any_orthonormal_pair();
                let step = (right * cos + up * sin) * (ulps * f64::from(f32::EPSILON));
                if k.is_multiple_of(2) { [DVec3::ZERO, step] } else { [step * reach, DVec3::ZERO] }
            });
            there.iter().zip(self.here).any(|(a, b)| (a - b).abs() > self.condition.tolerance)
        };
        for k in 0..16 {
            if !goes_on() {
                return None;
            }
            if moves(k) {
                return Some(true);
            }
        }
        Some(false)
    }

    /// Levels of the longest path.
    fn levels(&self) -> f64 {
        let prepared = &self.condition.prepared;
        let of = |&(origin, dir): &(DVec3, DVec3)| prepared.trace(origin, dir).rays.by_depth.len();
        self.rays.iter().map(of).max().unwrap_or(1) as f64
    }
}
