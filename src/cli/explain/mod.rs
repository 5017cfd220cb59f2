//! `vitrum explain`.

pub(super) mod args;
pub(super) mod options;

use std::sync::Arc;
use std::time::Instant;

use self::options::Explain;
use super::verdict::Verdict;
use super::warnings::Warnings;
use super::{backend, interrupt, output, progress};
use crate::Result;
use crate::accel::{Accel, Backend, BuildOptions};
use crate::effects::{self, Effect, EffectPlan};
use crate::image::Film;
use crate::measure::Percentiles;
use crate::measure::table::grouped;
use crate::render::{self, Observer, Options, Outcome};
use crate::scene::Scene;
use crate::study::systems::{Bearing, bearings};

/// Largest number of touching pairs that the text lists.
const MOST_PAIRS: usize = 12;

/// Widest line of the tables.
const COLUMNS: usize = 80;

/// Loads the scene, resolves its effects, measures them if requested, and reports.
pub(super) fn run(job: &Explain) -> Result<Verdict> {
    let observer = Arc::new(Observer::default());
    interrupt::listen(&observer)?;
    backend::start_threads(job.options.threads)?;
    let (mut scene, warnings) = Warnings::survey((&job.scene, &job.reading), job.strict, &job.options, &observer)?;
    job.picture.fit(&mut scene.settings)?;
    let plan = EffectPlan::resolve(&scene, &job.options.effects);
    let measured = match job.rounds {
        None => None,
        Some(rounds) => Some(Measured::of(&scene, &plan, job, rounds, &observer)?),
    };
    let shaded = effects::without(&scene, job.options.effects.without);
    let explained = Explained::new(&shaded, &plan, measured.as_ref(), job.scene.display().to_string(), &warnings);
    if !job.quiet {
        warnings.log();
    }
    if job.json {
        output::print_json(&explained)?;
    } else {
        output::print(&explained.text())?;
    }
    Ok(Verdict::Done)
}

/// Changes of the picture when single effects are switched off.
struct Measured {
    /// Changes by effect that is on.
    effects: Vec<(Effect, Worth)>,
    /// Rays of the whole picture.
    rays: u64,
}

/// Change of the picture when one effect is switched off.
#[derive(Clone, Copy, Debug, serde::Serialize)]
struct Worth {
    /// Time of the whole picture relative to that without the effect: median, 10th and 90th percentile over the rounds.
    time: [f64; 3],
    /// Root of the mean squared change of the picture's channels, in linear light.
    rmse: f64,
    /// Number of pixels that change.
    pixels: u64,
    /// Number of rays of all kinds that the effect adds.
    rays: i64,
}

impl Measured {
    fn of(scene: &Scene, plan: &EffectPlan, job: &Explain, rounds: usize, observer: &Observer) -> Result<Self> {
        let accel = Accel::build(Backend::Native, &scene.geometry, BuildOptions::default())?;
        let whole = job.options.effects;
        let on: Vec<Effect> = plan.on().iter().collect();
        let choices: Vec<Options> = std::iter::once(whole)
            .chain(on.iter().map(|&e| effects::Options { without: whole.without.with(e), ..whole }))
            .map(|effects| Options { effects, ..job.options.clone() })
            .collect();
        let pixels = u64::from(scene.settings.width) * u64::from(scene.settings.height);
        // One more round than is timed, as a warm-up.
        let work = pixels * (rounds as u64 + 1) * choices.len() as u64;
        let mut seconds = vec![Vec::new(); choices.len()];
        let mut outcomes: Vec<Outcome> = Vec::new();
        progress::follow(observer, work, !job.quiet, || {
            interrupt::heeded(|| {
                for round in 0..=rounds {
                    for (options, seconds) in choices.iter().zip(&mut seconds) {
                        let start = Instant::now();
                        let outcome = render::render(scene, &accel, options, observer)?;
                        if round == 0 {
                            outcomes.push(outcome);
                        } else {
                            seconds.push(start.elapsed().as_secs_f64().max(1e-9));
                        }
                    }
                }
                Ok::<(), crate::Error>(())
            })
        })?;
        let all = &outcomes[0];
        let worth = |k: usize| {
            let Percentiles { median, spread } = Percentiles::of_ratio(&seconds[k], &seconds[0]);
            let (rmse, pixels) = change(&all.film, &outcomes[k].film);
            let rays = all.rays.total() as i64 - outcomes[k].rays.total() as i64;
            Worth { time: [median, spread[0], spread[1]], rmse, pixels, rays }
        };
        let effects = on.iter().enumerate().map(|(i, &effect)| (effect, worth(i + 1))).collect();
        Ok(Self { effects, rays: all.rays.total() })
    }
}

/// Root of the mean squared difference, and the number of pixels that differ.
fn change(a: &Film, b: &Film) -> (f64, u64) {
    let (mut sum, mut touched) = (0.0, 0);
    for (a, b) in a.pixels.iter().zip(&b.pixels) {
        touched += u64::from(a != b);
        sum += a.iter().zip(b).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum::<f64>();
    }
    ((sum / (3.0 * a.pixels.len().max(1) as f64)).sqrt(), touched)
}

/// Results in the form of the JSON output.
#[derive(serde::Serialize)]
struct Explained<'a> {
    scene: String,
    #[serde(flatten)]
    warnings: &'a Warnings,
    effects: Vec<Row>,
    /// Largest number of media that contain a ray at the same time.
    stack: String,
    /// Objects that no ray can hit, and the objects that hide them.
    hidden: Vec<[String; 2]>,
    /// Lights that reach nothing visible, with the reasons.
    useless_lights: Vec<String>,
    /// Objects that touch.
    touching: Vec<Touching>,
    /// Objects that are shaded together.
    shared: Vec<Shared>,
    rays: Budget,
    /// Systems that trace no reflected or refracted rays, and what the scene has for them. None is used unless asked for.
    systems: Vec<Bearing>,
}

#[derive(serde::Serialize)]
struct Row {
    effect: &'static str,
    on: bool,
    because: String,
    left_out: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    worth: Option<Worth>,
}

#[derive(serde::Serialize)]
struct Touching {
    /// Two objects, or the same one twice for duplicate faces.
    objects: [String; 2],
    /// Number of pairs of coincident faces.
    faces: u32,
    /// Points at which a sphere touches.
    points: u32,
}

#[derive(serde::Serialize)]
struct Shared {
    surface: &'static str,
    /// True if they have a colour of their own.
    base: bool,
    objects: Vec<String>,
}

#[derive(serde::Serialize)]
struct Budget {
    /// Levels of secondary rays.
    depth: u32,
    depth_because: String,
    /// Upper bound over all kinds of rays.
    most_per_pixel: f64,
    /// Mean over the picture, if it was rendered.
    #[serde(skip_serializing_if = "Option::is_none")]
    mean_per_pixel: Option<f64>,
}

impl<'a> Explained<'a> {
    fn new(
        scene: &Scene,
        plan: &EffectPlan,
        measured: Option<&Measured>,
        name: String,
        warnings: &'a Warnings,
    ) -> Self {
        let worth = |effect| measured.and_then(|m| m.effects.iter().find(|(e, _)| *e == effect)).map(|(_, w)| *w);
        let row = |d: &effects::Decision| Row {
            effect: d.effect.name(),
            on: d.on,
            because: d.because.clone(),
            left_out: d.effect.left_out(),
            worth: worth(d.effect),
        };
        let pixels = f64::from(scene.settings.width) * f64::from(scene.settings.height);
        let object = |o: usize| scene.objects[o].name.clone();
        let hidden = plan.reach.hidden.iter().enumerate();
        Self {
            scene: name,
            warnings,
            effects: plan.decisions.iter().map(row).collect(),
            stack: plan.stack.clone(),
            hidden: hidden.filter_map(|(o, wall)| Some([object(o), object((*wall)?)])).collect(),
            touching: plan
                .touching
                .iter()
                .map(|pair| Touching {
                    objects: pair.objects.map(|o| object(o as usize)),
                    faces: pair.faces,
                    points: pair.points,
                })
                .collect(),
            useless_lights: plan.reach.useless.iter().flatten().cloned().collect(),
            shared: render::shared_shading(scene, &plan.reach)
                .into_iter()
                .map(|s| Shared {
                    surface: s.surface,
                    base: s.base,
                    objects: s.objects.into_iter().map(object).collect(),
                })
                .collect(),
            rays: Budget {
                depth: plan.rays.depth,
                depth_because: plan.rays.because.clone(),
                most_per_pixel: plan.rays.per_pixel,
                mean_per_pixel: measured.map(|m| m.rays as f64 / pixels),
            },
            systems: bearings(scene),
        }
    }

    fn text(&self) -> String {
        let mut lines = Vec::new();
        let widest = self.effects.iter().map(|r| r.effect.len()).max().unwrap_or(0);
        lines.push(format!("{:<widest$}  {:<3}  because", "effect", ""));
        for row in &self.effects {
            let head = format!("{:<widest$}  {:<3}  ", row.effect, if row.on { "on" } else { "off" });
            wrap(&head, &row.because, &mut lines);
        }
        let hidden = self.hidden.iter().map(|[what, wall]| format!("no ray gets past `{wall}` to `{what}`"));
        for fact in
            hidden.chain(self.useless_lights.iter().map(|why| format!("a light that lights nothing seen: {why}")))
        {
            wrap("proven: ", &fact, &mut lines);
        }
        for pair in self.touching.iter().take(MOST_PAIRS) {
            wrap("touching: ", &pair.text(), &mut lines);
        }
        if self.touching.len() > MOST_PAIRS {
            lines.push(format!("touching: {} pairs more (all with --json)", self.touching.len() - MOST_PAIRS));
        }
        for shared in &self.shared {
            wrap("shaded together: ", &shared.text(), &mut lines);
        }
        wrap("medium stack: ", &self.stack, &mut lines);
        let rays = &self.rays;
        let most =
            format!("at most {} a pixel: {} deep ({})", count(rays.most_per_pixel), rays.depth, rays.depth_because);
        wrap("rays: ", &most, &mut lines);
        if let Some(mean) = rays.mean_per_pixel {
            wrap("rays: ", &format!("{mean:.2} a pixel in the mean, as counted"), &mut lines);
        }
        for Bearing { option, possible, because } in &self.systems {
            let possible = if *possible { "possible" } else { "impossible" };
            wrap("not used unless asked for: ", &format!("{option} ({possible}: {because})"), &mut lines);
        }
        if self.effects.iter().any(|r| r.worth.is_some()) {
            lines.push(String::new());
            lines.push(format!(
                "{:<widest$}  {:>6}  {:>13}  {:>9}  {:>9}",
                "left out", "time", "10-90 %", "rmse", "pixels"
            ));
            for (row, w) in self.effects.iter().filter_map(|r| Some((r, r.worth?))) {
                let spread = format!("{:.3}-{:.3}", w.time[1], w.time[2]);
                let (time, rmse) = (w.time[0], w.rmse);
                let pixels = grouped(w.pixels);
                lines.push(format!("{:<widest$}  {time:>6.3}  {spread:>13}  {rmse:>9.2e}  {pixels:>9}", row.effect));
            }
        }
        lines.join("\n") + "\n"
    }
}

impl Touching {
    fn text(&self) -> String {
        let [a, b] = &self.objects;
        match (a == b, self.faces) {
            (true, n) => format!("`{a}` has {n} pairs of duplicate faces"),
            (false, 0) => format!("`{a}` and `{b}` at a point"),
            (false, _) => format!("`{a}` and `{b}` share a surface"),
        }
    }
}

impl Shared {
    /// Text with the first few by name.
    fn text(&self) -> String {
        const NAMED: usize = 4;
        let kind = match (self.surface, self.base) {
            ("opaque", false) => String::from("black"),
            ("opaque", true) | (_, false) => self.surface.to_owned(),
            (_, true) => format!("{}, with colours of their own", self.surface),
        };
        let names: Vec<String> = self.objects.iter().take(NAMED).map(|name| format!("`{name}`")).collect();
        let more = match self.objects.len() - names.len() {
            0 => String::new(),
            n => format!(" and {n} more"),
        };
        format!("{}{more} ({kind})", names.join(", "))
    }
}

/// Formats a number of rays, large ones with three digits.
fn count(n: f64) -> String {
    if n < 1e9 { grouped(n as u64) } else { format!("{n:.2e}") }
}

/// Adds `text` after `head`, in lines that fit, indented under its beginning.
fn wrap(head: &str, text: &str, lines: &mut Vec<String>) {
    let indent = head.chars().count();
    let mut line = head.to_owned();
    let mut empty = true;
    for word in text.split(' ') {
        if !empty && line.chars().count() + 1 + word.chars().count() > COLUMNS {
            lines.push(std::mem::replace(&mut line, " ".repeat(indent)));
            empty = true;
        }
        if !empty {
            line.push(' ');
        }
        line.push_str(word);
        empty = false;
    }
    lines.push(line);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_reasons_are_wrapped_under_their_beginning() {
        let mut lines = Vec::new();
        wrap("head: ", &"word ".repeat(30), &mut lines);
        assert!(lines.iter().all(|l| l.len() <= COLUMNS) && lines.len() > 1);
        assert!(lines[1].starts_with("      word"));
    }

    #[test]
    fn a_change_is_counted_in_pixels_and_its_rmse_by_hand() {
        let (a, mut b) = (Film::new(2, 2), Film::new(2, 2));
        b.pixels[3] = [0.0, 2.0, 0.0];
        let (rmse, pixels) = change(&a, &b);
        assert_eq!(pixels, 1);
        assert!((rmse - (4.0_f64 / 12.0).sqrt()).abs() < 1e-12);
    }
}
