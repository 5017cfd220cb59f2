//! Whether a pixel belongs to its camera rays at all, or moves with their last digits.

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_4;
use std::sync::atomic::Ordering;

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
    /// origins by ulps of the eye's largest coordinate.
    ///
    /// # Errors
    /// `Interrupted`.
    pub fn moves(&mut self, pixels: &[(u32, u32)]) -> Result<Vec<bool>> {
        let fresh: Vec<(u32, u32)> = pixels.iter().copied().filter(|p| !self.known.contains_key(p)).collect();
        let this = &*self;
        let found: Vec<bool> = fresh.par_iter().map(|&(x, y)| this.moved(x, y)).collect::<Result<_>>()?;
        self.known.extend(fresh.into_iter().zip(found));
        Ok(pixels.iter().map(|p| self.known[p]).collect())
    }

    fn moved(&self, x: u32, y: u32) -> Result<bool> {
        if self.observer.stop.load(Ordering::Relaxed) {
            return Err(Error::Interrupted);
        }
        let n = self.scene.settings.samples.max(1);
        let within = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
        let rays: Vec<_> = (0..n * n)
            .map(|k| self.prepared.camera_ray(f64::from(x) + within(k % n), f64::from(y) + within(k / n)))
            .collect();
        let mean = |step: &dyn Fn(glam::DVec3) -> [glam::DVec3; 2]| {
            let mut sum = [0.0; 3];
            for &(origin, dir) in &rays {
                let [aside, turned] = step(dir);
                let seen = self.prepared.radiance_along(origin + aside, (dir + turned).normalize());
                for (s, v) in sum.iter_mut().zip(seen) {
                    *s += v / rays.len() as f64;
                }
            }
            sum
        };
        let here = mean(&|_| [glam::DVec3::ZERO; 2]);
        let reach = self.scene.camera.eye.as_dvec3().abs().max_element();
        let moved_at = |ulps: f64| {
            (0..16).any(|k| {
                let (sin, cos) = (f64::from(k / 2) * FRAC_PI_4).sin_cos();
                let there = mean(&|dir| {
                    let (right, up) = dir.any_orthonormal_pair();
                    let step = (right * cos + up * sin) * (ulps * f64::from(f32::EPSILON));
                    if k % 2 == 0 { [glam::DVec3::ZERO, step] } else { [step * reach, glam::DVec3::ZERO] }
                });
                there.iter().zip(here).any(|(a, b)| (a - b).abs() > self.tolerance)
            })
        };
        Ok(moved_at(ULPS) || moved_at(ULPS * levels_of(&self.prepared, &rays)))
    }
}

/// Levels of the longest path of these camera rays.
fn levels_of(prepared: &Prepared, rays: &[(glam::DVec3, glam::DVec3)]) -> f64 {
    rays.iter().map(|&(origin, dir)| prepared.trace(origin, dir).rays.by_depth.len()).max().unwrap_or(1) as f64
}
