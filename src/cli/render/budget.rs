//! `vitrum render --max-error` and `--time-budget`: reports the choice of settings, its reasons, and the result of the
//! check.

use super::options::Render;
use super::picture::picture;
use crate::accel::Backend;
use crate::cli::backend::{Renderer, Traced};
use crate::cli::repeat::options;
use crate::cli::{interrupt, output};
use crate::render::{self, Observer};
use crate::scene::Scene;
use crate::study::budget::check::{self, Check};
use crate::study::budget::{self, Candidate, Choice, Wish};
use crate::study::errors::VISIBLE;
use crate::study::spheres::with_spheres;
use crate::study::{Axis, Level, Precision, Variant};
use crate::{Error, Result};

/// Largest number of pixels listed one by one.
const LISTED: usize = 8;

/// Result of a render under a budget.
#[derive(serde::Serialize)]
pub(super) struct Spent {
    /// True if the last picture kept the budget.
    pub kept: bool,
    /// Options that repeat the picture.
    pub options: String,
    pub choice: Choice,
    pub steps: Vec<Step>,
}

/// One rendered picture of the ladder.
#[derive(serde::Serialize)]
pub(super) struct Step {
    pub options: String,
    pub predicted_seconds: f64,
    pub seconds: f64,
    pub check: Check,
}

/// Chooses settings, renders and checks. If the check fails, the next more exact settings are used. On return `job` and
/// `scene` are those of the last picture.
pub(super) fn render(job: &mut Render, scene: &mut Scene, wish: Wish, observer: &Observer) -> Result<(Traced, Spent)> {
    let say = |quiet: bool, line: &str| {
        if !quiet {
            output::log(line);
        }
    };
    let given = Variant {
        fresnel: job.options.fresnel,
        refraction: job.options.refraction,
        reflection: job.options.reflection,
        spheres: job.spheres,
        bvh: job.bvh,
        ..Variant::of(&scene.settings, of_study(job.backend)?)
    };
    let given = job.options.cutoff_error.map_or(given, |error| given.with(Level::Proven(error)));
    let given = match job.backend {
        Renderer::Walk(triangles, reciprocal) => Variant { triangles: Some(triangles), reciprocal, ..given },
        _ => given,
    };
    let threads = job.options.threads;
    let choice = interrupt::heeded(|| budget::choose(scene, &given, &job.fixed, wish, threads, observer))?;
    for line in reasons(&choice, wish) {
        say(job.quiet, &line);
    }
    let whole = scene.try_clone()?;
    let mut steps = Vec::new();
    let last = choice.ladder.len() - 1;
    for (i, candidate) in choice.ladder.iter().enumerate() {
        apply(candidate, job, scene, &whole);
        say(job.quiet, &format!("{:<10} {}", if i == 0 { "choice" } else { "step up" }, options(&candidate.variant)));
        let traced = picture(job, scene, observer)?;
        let bound = if let Wish::MaxError(e) = wish { e } else { VISIBLE };
        // Under a time budget the most exact picture is final, so ill-conditioned pixels need not be told apart.
        let examined = matches!(wish, Wish::MaxError(_));
        let film = &traced.outcome.film;
        let check = interrupt::heeded(|| check::check(&whole, film, &given, bound, examined, observer))?;
        let seconds = traced.render_time.as_secs_f64();
        let kept = match wish {
            Wish::MaxError(_) => check.shows_it_kept(),
            Wish::Time(t) => seconds <= t.as_secs_f64(),
        };
        for line in told(&check, wish, seconds, candidate) {
            say(job.quiet, &line);
        }
        // If the reference cannot show that the bound is kept, a more exact picture does not help.
        let unproven = matches!(wish, Wish::MaxError(_)) && check.wrong.is_empty() && !check.can_show();
        let options = options(&candidate.variant);
        steps.push(Step { options: options.clone(), predicted_seconds: candidate.seconds, seconds, check });
        if kept || unproven || i == last {
            if !kept {
                output::log(&not_kept(&steps[i].check, wish));
            }
            return Ok((traced, Spent { kept, options, choice, steps }));
        }
    }
    Err(Error::Usage(String::from("nothing to choose from")))
}

/// Returns the back end that the study of a budget starts from.
fn of_study(renderer: Renderer) -> Result<Backend> {
    match renderer {
        Renderer::Walk(..) => Ok(Backend::Native),
        Renderer::Packets(backend) => Ok(backend.availability().map(|()| backend)?),
        Renderer::Reference => Err(Error::Usage(String::from("--backend reference is exact already"))),
    }
}

/// Sets `job` and `scene` to the choices of a candidate.
fn apply(candidate: &Candidate, job: &mut Render, scene: &mut Scene, whole: &Scene) {
    let variant = &candidate.variant;
    *scene = with_spheres(whole, variant.spheres);
    scene.settings = variant.settings(&whole.settings);
    let (tile, effects) = (job.options.tile, job.options.effects);
    job.options = render::Options { tile, effects, ..variant.options(job.options.threads) };
    job.spheres = variant.spheres;
    job.backend = match (variant.precision, variant.walk()) {
        (Precision::Double, _) => Renderer::Reference,
        (Precision::Single, Some((triangles, reciprocal))) => Renderer::Walk(triangles, reciprocal),
        (Precision::Single, None) => Renderer::Packets(variant.backend),
    };
}

/// Warning about a budget that was not kept.
fn not_kept(check: &Check, wish: Wish) -> String {
    match wish {
        Wish::MaxError(bound) if check.wrong.is_empty() => format!(
            "warning: --max-error {bound:.1e} is unproven: at {} of {} pixels the reference itself ({}) may be off by more; \
             take a larger bound, or a greater --depth",
            check.undecided, check.asked, check.reference
        ),
        _ => String::from("warning: the budget was not kept; this is the closest that was found"),
    }
}

/// Reasons for the first choice of the ladder.
fn reasons(choice: &Choice, wish: Wish) -> Vec<String> {
    let [width, height] = choice.size;
    let mut lines = vec![format!(
        "{:<10} {width} x {height} pixels in {:.1} s: {} of {} combinations made",
        "study", choice.study_seconds, choice.tried, choice.thought_of
    )];
    let first = &choice.ladder[0];
    let predicted = format!("{:.3} s, off by at most {:.1e}, RMSE {:.1e}", first.seconds, first.max, first.rmse);
    lines.push(match (wish, choice.kept) {
        (Wish::MaxError(e), true) => format!("{:<10} {predicted}: the least time within half of {e:.1e}", "predicted"),
        (Wish::MaxError(e), false) => {
            format!("{:<10} {predicted}: nothing keeps half of {e:.1e} there, this comes closest", "predicted")
        }
        (Wish::Time(t), true) => {
            let (slowest, t) = (first.slowest, t.as_secs_f64());
            format!("{:<10} {predicted}: the least error whose slowest run ({slowest:.3} s) fits {t:.3} s", "predicted")
        }
        (Wish::Time(t), false) => {
            let t = t.as_secs_f64();
            format!("{:<10} {predicted}: nothing fits {t:.3} s with room to spare, this is the fastest", "predicted")
        }
    });
    for axis in Axis::ALL {
        let taken = first.variant.level(axis).to_string();
        let levels: Vec<_> = choice.alone.iter().filter(|a| a.axis == axis.name()).collect();
        if levels.is_empty() {
            continue;
        }
        let of = |a: &&budget::Alone| format!("{} off by {:.1e} at {:.2} of the time", a.level, a.max, a.ratio);
        let alone: Vec<String> = levels.iter().map(of).collect();
        lines.push(format!("{:<10} {} {taken}; by themselves: {}", "because", axis.name(), alone.join(", ")));
    }
    lines
}

/// Part of the line on pixels that the reference leaves undecided.
fn undecided(check: &Check, wish: Wish) -> String {
    match (wish, check.undecided) {
        (Wish::Time(_), _) | (_, 0) => String::new(),
        (_, n) => format!(", {n} undecided (the reference itself cuts more there)"),
    }
}

/// Lines on the result of the check.
fn told(check: &Check, wish: Wish, seconds: f64, candidate: &Candidate) -> Vec<String> {
    let verdict = match wish {
        Wish::MaxError(_) if check.shows_it_kept() => "kept",
        Wish::MaxError(_) if check.wrong.is_empty() => "UNPROVEN",
        Wish::MaxError(_) => "NOT kept",
        Wish::Time(t) if seconds <= t.as_secs_f64() => "in time",
        Wish::Time(_) => "NOT in time",
    };
    let mut lines = vec![format!(
        "{:<10} {verdict}: {seconds:.3} s ({:.3} predicted); {} pixels against {}: off by at most {:.1e}, {} beyond {:.1e}{}",
        "check",
        candidate.seconds,
        check.asked,
        check.reference,
        check.worst,
        if check.examined { check.wrong.len() } else { check.beyond },
        check.bound,
        undecided(check, wish)
    )];
    if !check.ill.is_empty() {
        let shown: Vec<String> = check
            .ill
            .iter()
            .take(LISTED)
            .map(|p| {
                format!("({}, {}) off by {:.1e}, moves at {} ulps", p.x, p.y, p.off, p.moves_at_ulps.unwrap_or(0.0))
            })
            .collect();
        let more = check.ill.len().saturating_sub(LISTED);
        let more = if more > 0 { format!("; and {more} more") } else { String::new() };
        lines.push(format!(
            "{:<10} {} at edges or ill-conditioned: {}{more}",
            "apart",
            check.ill.len(),
            shown.join("; ")
        ));
    }
    for p in check.wrong.iter().take(LISTED) {
        lines.push(format!("{:<10} ({}, {}) off by {:.1e}, not ill-conditioned", "wrong", p.x, p.y, p.off));
    }
    lines
}
