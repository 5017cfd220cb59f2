//! Measurements on small pictures.

use std::time::{Duration, Instant};

use super::candidate::Candidate;
use crate::image::Film;
use crate::render::Observer;
use crate::render::reference::Prepared;
use crate::scene::Scene;
use crate::study::condition::Condition;
use crate::study::engine::Engine;
use crate::study::errors::off;
use crate::study::size::fit;
use crate::study::variant::Variant;
use crate::{Error, Result};

/// Numbers of pixels: of the picture that costs are estimated from, and the smallest and largest of the small picture.
const PIXELS: [f64; 3] = [300.0, 600.0, 2400.0];

/// Largest time of its reference in `f64`, in seconds.
const REFERENCE: f64 = 0.5;

/// Pixels of the first picture that costs are estimated from, and the smallest small picture, where single pixels take
/// long. With many panes of glass in a row, a pixel takes thousands of rays.
const FEW: f64 = 8.0;

/// Total seconds for condition tests; pixels not tested by then count as well-conditioned.
const ASKING: f64 = 5.0;

/// Number of renders of which the median time is taken.
const RUNS: usize = 3;

/// Largest number of pixels tested for their condition. If more are off, the picture is wrong in any case.
const ASKED: usize = 24;

/// Scene and reference of a small picture.
pub(super) struct Quick<'a> {
    small: Scene,
    judge: Scene,
    reference: Film,
    exact: Variant,
    /// Rays of the whole picture per ray of the small one.
    scale: f64,
    double_seconds: f64,
    threads: usize,
    observer: &'a Observer,
}

/// Small picture, ready to measure variants.
pub(super) struct Judged<'q> {
    quick: &'q Quick<'q>,
    engine: Engine<'q>,
    condition: Condition<'q>,
    tolerance: f64,
    base_seconds: Option<f64>,
    /// Seconds left for condition tests.
    asking: f64,
    /// A pixel's time in the whole picture relative to the small one, where the work comes in shorter streams.
    economy: f64,
}

/// Smallest ratio of rays of the picture that determines [`Judged::economy`].
const LARGER: f64 = 16.0;

/// Share of the allowed time that it may take.
const OF_THE_TIME: f64 = 0.1;

impl<'a> Quick<'a> {
    /// Creates a picture of the scene so small that `exact` renders in a second or two.
    pub fn of(scene: &Scene, exact: &Variant, threads: usize, observer: &'a Observer) -> Result<Self> {
        // One ray per pixel: the mean of several rays is off by no more than the worst of them.
        let exact = Variant { samples: 1, ..*exact };
        let sized = |pixels: f64| {
            let mut small = scene.try_clone()?;
            [small.settings.width, small.settings.height] = fit(&scene.settings, pixels);
            Ok::<_, Error>(small)
        };
        let mut cost = f64::INFINITY;
        for probed in [FEW, PIXELS[0]] {
            if probed > FEW && probed * cost > 4.0 * REFERENCE {
                break;
            }
            let probe = sized(probed)?;
            cost = Engine::new(&probe, threads).shoot(&exact, observer)?.seconds / pixels(&probe);
        }
        let wanted = (REFERENCE / cost.max(1e-12)).clamp(PIXELS[1], PIXELS[2]);
        let slow = wanted * cost > 8.0 * REFERENCE;
        let small = sized(if slow { (0.5 * REFERENCE / cost).max(FEW) } else { wanted })?;
        let shot = Engine::new(&small, threads).shoot(&exact, observer)?;
        let samples = f64::from(scene.settings.samples);
        let judge = Scene { settings: exact.settings(&small.settings), ..small.try_clone()? };
        Ok(Self {
            scale: pixels(scene) * samples * samples / pixels(&small),
            reference: shot.outcome.film,
            double_seconds: shot.seconds,
            small,
            judge,
            exact,
            threads,
            observer,
        })
    }

    /// Prepares for measuring. Pixels whose own value changes by more than `tolerance` count as ill-conditioned.
    pub fn judged<'q>(&'q self, tolerance: f64) -> Judged<'q> {
        let prepared = Prepared::new(&self.judge, self.exact.fresnel);
        Judged {
            engine: Engine::new(&self.small, self.threads),
            condition: Condition::new(&self.judge, prepared, tolerance, self.observer),
            quick: self,
            tolerance,
            base_seconds: None,
            asking: ASKING,
            economy: 1.0,
        }
    }
}

impl Quick<'_> {
    /// Returns the largest channel of the reference.
    pub fn brightest(&self) -> f64 {
        let channels = self.reference.pixels.iter().flatten().filter(|v| v.is_finite());
        channels.fold(0.0, |most, v| f64::max(most, f64::from(v.abs())))
    }
}

impl Judged<'_> {
    /// Returns columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.quick.small.settings.width, self.quick.small.settings.height]
    }

    /// Returns the time of `f64` relative to the variant measured first.
    pub fn double_ratio(&self) -> f64 {
        self.base_seconds.map_or(10.0, |base| self.quick.double_seconds / base)
    }

    /// Corrects predictions by a larger picture of `scene` with all its rays per pixel. Returns the factor for times
    /// measured so far. `seconds` is the allowed time of the whole picture.
    pub fn learn_from_larger(&mut self, scene: &Scene, of: &Candidate, seconds: f64) -> Result<f64> {
        let [whole, small] = [scene, &self.quick.small].map(pixels);
        let samples = scene.settings.samples;
        let least = small * LARGER / f64::from(samples * samples);
        let in_time = OF_THE_TIME * seconds * whole / of.seconds;
        let mut larger = scene.try_clone()?;
        [larger.settings.width, larger.settings.height] = fit(&scene.settings, in_time.max(least).min(whole));
        let engine = &mut Engine::new(&larger, self.quick.threads);
        let variant = Variant { samples, ..of.variant };
        engine.shoot(&variant, self.quick.observer)?;
        let took = engine.shoot(&variant, self.quick.observer)?.seconds;
        let economy = took / pixels(&larger) / (of.seconds / whole);
        self.economy *= economy;
        Ok(economy)
    }

    /// Renders a variant's small picture several times and measures its time and error.
    pub fn measure(&mut self, variant: &Variant) -> Result<Candidate> {
        let small = Variant { samples: 1, ..*variant };
        // The first render builds and warms up.
        let shot = self.engine.shoot(&small, self.quick.observer)?;
        let mut runs = [0.0; RUNS];
        for seconds in &mut runs {
            *seconds = self.engine.shoot(&small, self.quick.observer)?.seconds;
        }
        runs.sort_by(f64::total_cmp);
        let [median, slowest] = [runs[RUNS / 2], runs[RUNS - 1]];
        self.base_seconds.get_or_insert(median);
        let (max, rmse) = self.judge(&shot.outcome.film)?;
        let [seconds, slowest] = [median, slowest].map(|seconds| seconds * self.quick.scale * self.economy);
        Ok(Candidate { variant: *variant, seconds, slowest, max, rmse })
    }

    /// Returns the largest difference and the root mean square, excluding ill-conditioned pixels.
    fn judge(&mut self, film: &Film) -> Result<(f64, f64)> {
        let pairs = || film.pixels.iter().zip(&self.quick.reference.pixels);
        let mut beyond: Vec<(f64, usize)> =
            pairs().map(|(&a, &b)| off(a, b)).zip(0..).filter(|(off, _)| *off > self.tolerance).collect();
        beyond.sort_by(|a, b| b.0.total_cmp(&a.0));
        let width = film.width as usize;
        let places: Vec<(u32, u32)> =
            beyond.iter().take(ASKED).map(|&(_, i)| ((i % width) as u32, (i / width) as u32)).collect();
        let start = Instant::now();
        let until = start + Duration::from_secs_f64(self.asking.max(0.0));
        let moves = self.condition.moves(&places, Some(until))?;
        self.asking -= start.elapsed().as_secs_f64();
        let ill: Vec<usize> =
            beyond.iter().zip(&moves).filter(|(_, moves)| **moves == Some(true)).map(|((_, i), _)| *i).collect();
        let well = pairs().enumerate().filter(|(i, _)| !ill.contains(i));
        let (mut max, mut squares, mut n) = (0.0_f64, 0.0, 0_u32);
        for (_, (a, b)) in well {
            max = max.max(off(*a, *b));
            squares += (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>();
            n += 3;
        }
        Ok((max, (squares / f64::from(n.max(1))).sqrt()))
    }
}

fn pixels(scene: &Scene) -> f64 {
    f64::from(scene.settings.width) * f64::from(scene.settings.height)
}
