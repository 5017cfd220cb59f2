//! Light that a picture lacks because rays ended at a limit.
//!
//! The truncated weight of a pixel, times the [`Ceiling`] of the scene, bounds the light it may lack. The bound is far too
//! high if the ended rays would have seen no lamp. So if more than a few pixels exceed it, a sample of them is rendered
//! again under wider limits, until the weight that still ends is invisible by the bound. The sample lacked the light that
//! it gains.

use glam::DVec3;
use rayon::prelude::*;

use super::{Ceiling, Limit, Options, Outcome, PixelMean};
use crate::Result;
use crate::effects;
use crate::scene::{Scene, Settings};

/// Light that is visible, as a share of display white; in pixels brighter than white, of the pixel's own light.
pub const VISIBLE: f64 = 1.0 / 255.0;

/// Share of the pixels that may lack visible light.
pub const ALLOWED: f64 = 1.0 / 1000.0;

/// Share of a pixel's weight whose end leaves the pixel unknown.
const MOST: f64 = 0.5;

/// Pixels that are rendered again, at most.
const SAMPLE: usize = 512;

/// Pixels of the sample that are rendered again in any case, where the others take too many rays.
const FEWEST: usize = 32;

/// Pixels of the sample that are rendered at a time.
const PART: usize = 16;

/// Pixels that tell the cost of other limits, at most.
const PRICED: usize = 256;

/// Steps by which limits are widened: the depth doubles, the cut-off falls to a quarter.
const STEPS: u32 = 5;

/// The largest depth limit that is tried.
const DEEPEST: u32 = 4096;

/// The cut-off that is tried first where the scene has none.
const LIGHTEST: f32 = 1e-6;

/// Share of the picture's rays that all the renders of the sample may take.
const RAYS: u64 = 8;

/// Rays that they may take in any case.
const FEW_RAYS: u64 = 1 << 23;

/// Rays that they may take at most.
const MOST_RAYS: u64 = 1 << 25;

/// Visible light that a picture lacks.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Shortfall {
    /// Pixels that lack visible light, as the sample has it.
    pub pixels: u64,
    /// Pixels of the picture.
    pub of: u64,
    /// Column and row of the worst pixel that was found.
    pub worst: [u32; 2],
    /// The light it lacks or may lack, as a share of display white or of its own light where that is brighter.
    pub lacks: f64,
    /// The limit that ended most of the light that is missing.
    pub limit: Limit,
    /// Limits that cure it, if any within reach do.
    pub cure: Option<Cure>,
    /// Otherwise the widest limits that were tried.
    pub tried: Option<Cure>,
}

/// Other limits, and their cost.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Cure {
    /// The depth limit.
    pub depth: u32,
    /// The weight cut-off.
    pub cutoff: f32,
    /// Rays that they take over those of the picture's own limits, by a sample of all pixels.
    pub cost: f64,
}

/// Pixels rendered again, with their cost.
#[derive(Clone, Debug, Default)]
pub struct Again {
    /// The pixels, in the order they were asked for.
    pub pixels: Vec<PixelMean>,
    /// Number of rays traced.
    pub rays: u64,
}

/// Renders some pixels, by column and row, of the picture of a scene.
pub type Renderer<'a> = dyn Fn(&Scene, &[[u32; 2]]) -> Result<Again> + 'a;

impl Shortfall {
    /// The shortfall of a picture of `scene` that will be multiplied by `exposure`; none where no more than a thousandth of
    /// its pixels lack visible light. `again` renders pixels with the picture's own options, of the scene with other settings.
    ///
    /// # Errors
    /// Those of `again`.
    pub fn of(
        scene: &Scene,
        options: &Options,
        outcome: &Outcome,
        exposure: f32,
        again: &Renderer,
    ) -> Result<Option<Self>> {
        // Most pictures have less weight than that in all but a few pixels, and end here.
        let pixels = outcome.film.pixels.len();
        let allowed = (pixels as f64 * ALLOWED) as usize;
        let short = |i: &usize| matches!(outcome.limits[*i], Some(Limit::Cutoff | Limit::Depth | Limit::Passes));
        if (0..pixels).filter(short).nth(allowed).is_none() {
            return Ok(None);
        }
        let scene = effects::without(scene, options.effects.without);
        let brightest = outcome.film.pixels.iter().fold(DVec3::ZERO, |most, &p| most.max(widened(p).abs()));
        let light = Light { ceiling: Ceiling::estimate(&scene, brightest).at(0), exposure: f64::from(exposure) };
        let mut candidates: Vec<(f64, usize)> = (0..pixels)
            .filter(short)
            .map(|i| (light.at_most(outcome.truncated.pixels[i], outcome.film.pixels[i]), i))
            .filter(|(lacks, _)| *lacks > VISIBLE)
            .collect();
        if candidates.len() <= allowed {
            return Ok(None);
        }
        candidates.par_sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let budget = (outcome.rays.total() / RAYS).clamp(FEW_RAYS, MOST_RAYS);
        let copy = Scene::clone(&scene);
        let own = copy.settings.clone();
        Search { scene: copy, own, outcome, light, candidates, allowed, again, left: budget, spent: 0 }.run()
    }
}

/// Conversion of weight to visible light.
#[derive(Clone, Copy)]
struct Light {
    /// Upper bound on the radiance of a ray of weight 1.
    ceiling: DVec3,
    exposure: f64,
}

impl Light {
    /// The light that a pixel of some radiance may lack for truncated weight.
    fn at_most(&self, truncated: [f32; 3], radiance: [f32; 3]) -> f64 {
        self.seen(widened(truncated).abs() * self.ceiling, widened(radiance))
    }

    /// A difference in radiance as it is seen in a pixel of some radiance: the worst channel.
    fn seen(&self, difference: DVec3, radiance: DVec3) -> f64 {
        let whole = (radiance.abs() * self.exposure).max(DVec3::ONE);
        (difference.abs() * self.exposure / whole).max_element()
    }
}

/// Search for missing light, and for limits that cure it.
struct Search<'a> {
    /// A copy whose settings change.
    scene: Scene,
    /// The settings of the picture.
    own: Settings,
    outcome: &'a Outcome,
    light: Light,
    /// Pixels that may lack visible light, with how much of it, the worst first.
    candidates: Vec<(f64, usize)>,
    /// Pixels that may.
    allowed: usize,
    again: &'a Renderer<'a>,
    /// Rays that may still be traced.
    left: u64,
    /// Rays that the last render took.
    spent: u64,
}

/// Limits as steps from the picture's own.
type Steps = [u32; 2];

impl Search<'_> {
    fn run(&mut self) -> Result<Option<Shortfall>> {
        // Evenly by rank, so that the first of them are spread evenly, too; and the worst one.
        let ranks = self.candidates.len();
        let mut count = ranks.min(SAMPLE);
        let stride = even_stride(count);
        let rank = |k: usize| (2 * (k * stride % count) + 1) * ranks / (2 * count);
        let places: Vec<usize> = (0..count).map(rank).chain([0]).collect();
        let mut sample: Vec<usize> = places.iter().map(|&rank| self.candidates[rank].1).collect();
        let mut lacks: Vec<f64> = places.iter().map(|&rank| self.candidates[rank].0).collect();

        // The truth, as far as it can be had.
        let mut truth: Option<(Steps, Vec<PixelMean>)> = None;
        // Rendered again as well, since the picture may be another renderer's.
        let mut narrow = self.render_some(self.own.clone(), &sample, self.left / 4)?;
        let mut seen = self.render_some(self.settings([1; 2]), &sample[..narrow.len()], self.left / 2)?;
        if seen.len() < sample.len() && seen.len() >= FEWEST {
            // Part of the sample tells more than the bound.
            count = seen.len();
            sample.truncate(count);
        }
        let affordable = seen.len() == sample.len();
        narrow.truncate(sample.len());
        for step in 1..=STEPS {
            if !affordable {
                break;
            }
            if step > 1 {
                // Wider limits take more rays than the last ones.
                if self.spent >= self.left {
                    break;
                }
                let Some(wider) = self.render(self.settings([step; 2]), &sample)? else { break };
                seen = wider;
            }
            lacks = narrow.iter().zip(&seen).map(|(narrow, wide)| self.lacks(narrow, wide)).collect();
            let unknown: Vec<f64> = seen.iter().map(|wide| self.light.at_most(wide.truncated, wide.radiance)).collect();
            truth = Some(([step; 2], seen.clone()));
            if self.short(&unknown, count) == 0 {
                break;
            }
        }
        let pixels = self.short(&lacks, count);
        if pixels == 0 {
            return Ok(None);
        }
        let worst = (0..sample.len()).max_by(|&a, &b| lacks[a].total_cmp(&lacks[b])).unwrap_or(0);
        let mut by_limit = [[0.0; 3]; Limit::ALL.len()];
        for (&i, lacks) in sample.iter().zip(&lacks) {
            if let Some(limit) = self.outcome.limits[i] {
                by_limit[limit as usize][0] += lacks;
            }
        }
        let cure = match &truth {
            Some((widest, seen)) => self.mend(*widest, [&narrow, seen], &sample, count)?,
            None => None,
        };
        if cure == Some([0; 2]) {
            // What wider limits add is invisible.
            return Ok(None);
        }
        let tried = match (cure, &truth) {
            (None, Some((widest, _))) => Some(self.priced(*widest)?),
            _ => None,
        };
        let cure = cure.map(|steps| self.priced(steps)).transpose()?;
        let width = self.outcome.film.width as usize;
        Ok(Some(Shortfall {
            pixels: pixels as u64,
            of: self.outcome.film.pixels.len() as u64,
            worst: [(sample[worst] % width) as u32, (sample[worst] / width) as u32],
            lacks: lacks[worst],
            limit: Limit::heaviest(by_limit).unwrap_or(Limit::Cutoff),
            cure,
            tried,
        }))
    }

    /// The fewest steps that leave no more than the allowed pixels short of the truth, first in depth, then in the cut-off.
    fn mend(
        &mut self,
        widest: Steps,
        [narrow, truth]: [&[PixelMean]; 2],
        sample: &[usize],
        count: usize,
    ) -> Result<Option<Steps>> {
        let mut best = widest;
        let unknown: Vec<f64> = narrow.iter().zip(truth).map(|(narrow, wide)| self.rest(narrow, wide)).collect();
        if self.short(&unknown, count) > 0 {
            return Ok(None);
        }
        for axis in 0..2 {
            for step in 0..widest[axis] {
                let mut steps = best;
                steps[axis] = step;
                let Some(seen) = self.render(self.settings(steps), sample)? else { break };
                let gains = |(seen, wide): (&PixelMean, &PixelMean)| self.gained(seen, wide);
                let lacks: Vec<f64> = seen.iter().zip(truth).map(gains).collect();
                if self.short(&lacks, count) == 0 {
                    best = steps;
                    break;
                }
            }
        }
        Ok(Some(best))
    }

    /// Returns the light that a pixel lacks: its gain under wider limits, plus the light it may still lack there.
    fn lacks(&self, narrow: &PixelMean, wide: &PixelMean) -> f64 {
        self.gained(narrow, wide) + self.rest(narrow, wide)
    }

    /// Returns the light that a pixel gains under wider limits.
    fn gained(&self, narrow: &PixelMean, wide: &PixelMean) -> f64 {
        let gained = widened(wide.radiance) - widened(narrow.radiance);
        self.light.seen(gained, widened(wide.radiance))
    }

    /// Returns the light that a pixel may still lack under wider limits.
    ///
    /// The weight that still ends there is taken to see as much light as the weight that these limits freed, at most the
    /// bound. If they freed no weight, it is trapped by total reflection and sees none. If most of the pixel's weight ends,
    /// too little has been observed for this estimate, and the bound is returned.
    fn rest(&self, narrow: &PixelMean, wide: &PixelMean) -> f64 {
        let weight = |p: &PixelMean| widened(p.truncated).abs().element_sum() / 3.0;
        let (ended, freed) = (weight(wide), weight(narrow) - weight(wide));
        if ended > MOST {
            return self.light.at_most(wide.truncated, wide.radiance);
        }
        if freed <= 0.0 {
            return 0.0;
        }
        let alike = (ended / freed).min(1.0);
        (self.gained(narrow, wide) * alike).min(self.light.at_most(wide.truncated, wide.radiance))
    }

    /// Pixels of the picture that lack visible light, by what the first `count` of the sample lack; 0 where they are no more
    /// than allowed. One of a sample of many is no evidence.
    fn short(&self, lacks: &[f64], count: usize) -> usize {
        let ranks = self.candidates.len();
        let found = lacks[..count].iter().filter(|lacks| **lacks > VISIBLE).count();
        let short = found * ranks / count;
        if short <= self.allowed || (found == 1 && count < ranks) { 0 } else { short }
    }

    fn settings(&self, [deeper, lighter]: Steps) -> Settings {
        let own = &self.own;
        let cutoff = if own.cutoff > 0.0 { own.cutoff } else { 4.0 * LIGHTEST };
        Settings {
            max_depth: if deeper == 0 {
                own.max_depth
            } else {
                (own.max_depth.clamp(8, DEEPEST) << deeper).clamp(own.max_depth, DEEPEST.max(own.max_depth))
            },
            cutoff: if lighter == 0 { own.cutoff } else { two_digits(cutoff / 4_f32.powi(lighter as i32)) },
            ..own.clone()
        }
    }

    /// Renders some pixels under other settings. Returns none if that takes more rays than are left.
    fn render(&mut self, settings: Settings, which: &[usize]) -> Result<Option<Vec<PixelMean>>> {
        if self.left == 0 {
            return Ok(None);
        }
        let pixels = self.render_some(settings, which, self.left)?;
        Ok((pixels.len() == which.len()).then_some(pixels))
    }

    /// The first of some pixels under other settings: those that take no more than `most` rays, to the nearest part.
    fn render_some(&mut self, settings: Settings, which: &[usize], most: u64) -> Result<Vec<PixelMean>> {
        let width = self.outcome.film.width as usize;
        let places: Vec<[u32; 2]> = which.iter().map(|i| [(i % width) as u32, (i / width) as u32]).collect();
        let mut pixels = Vec::with_capacity(places.len());
        self.scene.settings = settings;
        self.spent = 0;
        for part in places.chunks(PART) {
            let seen = (self.again)(&self.scene, part)?;
            pixels.extend(seen.pixels);
            self.spent += seen.rays;
            if self.spent >= most {
                break;
            }
        }
        self.left = self.left.saturating_sub(self.spent);
        Ok(pixels)
    }

    /// The limits of some steps with their cost.
    fn priced(&mut self, steps: Steps) -> Result<Cure> {
        let film = &self.outcome.film;
        // Multiples of the golden ratio: any number of them lie evenly.
        let place =
            |k: usize| (((k as f64 + 0.5) * 0.618_033_988_749_894_9).fract() * film.pixels.len() as f64) as usize;
        let places: Vec<[u32; 2]> = (0..film.pixels.len().min(PRICED))
            .map(place)
            .map(|i| [(i % film.width as usize) as u32, (i / film.width as usize) as u32])
            .collect();
        let settings = self.settings(steps);
        let (mut own, mut other) = (0, 0);
        for part in places.chunks(PART) {
            self.scene.settings = self.own.clone();
            own += (self.again)(&self.scene, part)?.rays;
            self.scene.settings = settings.clone();
            other += (self.again)(&self.scene, part)?.rays;
            if other > FEW_RAYS {
                break;
            }
        }
        Ok(Cure { depth: settings.max_depth, cutoff: settings.cutoff, cost: other as f64 / own.max(1) as f64 })
    }
}

fn widened(rgb: [f32; 3]) -> DVec3 {
    DVec3::from_array(rgb.map(f64::from))
}

/// Returns a step through a list of `count` places that visits each once and keeps the visited ones evenly spread.
fn even_stride(count: usize) -> usize {
    let divides_both = |a: usize, b: usize| (2..=a.min(b)).any(|d| a.is_multiple_of(d) && b.is_multiple_of(d));
    let golden = ((count as f64 * 0.618_033_988_749_894_9) as usize).max(1);
    (golden..).find(|&stride| !divides_both(stride, count)).unwrap_or(1)
}

/// Returns a positive number cut to two decimal digits.
fn two_digits(x: f32) -> f32 {
    let unit = 10_f64.powi(f64::from(x).log10().floor() as i32 - 1);
    ((f64::from(x) / unit).floor() * unit) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stride_visits_every_place_once_and_evenly() {
        for count in (1..40).chain([512]) {
            let stride = even_stride(count);
            let mut places: Vec<usize> = (0..count).map(|k| k * stride % count).collect();
            let lower = places[..count / 2].iter().filter(|&&place| 2 * place < count).count();
            assert!(lower.abs_diff(count / 4) <= 3 + count / 128, "{lower} of the first half of {count} by {stride}");
            places.sort_unstable();
            assert!(places.into_iter().eq(0..count), "{count}");
        }
    }

    #[test]
    fn numbers_are_cut_to_two_digits() {
        for (x, cut) in [(1.0 / 4096.0, 0.00024), (0.001, 0.001), (0.99, 0.99), (1.0 / 1024.0, 0.00097)] {
            let got = two_digits(x);
            assert!((got / cut - 1.0).abs() < 1e-6 || (got / cut - 1.0).abs() < 0.1 && got <= cut, "{x}: {got}");
        }
    }

    #[test]
    fn light_is_judged_against_white_and_in_brighter_pixels_against_their_own() {
        let light = Light { ceiling: DVec3::splat(2.0), exposure: 0.5 };
        assert_eq!(light.at_most([0.25, -0.5, 0.0], [0.0; 3]), 0.5);
        assert_eq!(light.at_most([0.25, -0.5, 0.0], [0.0, 4.0, 0.0]), 0.25);
    }
}
