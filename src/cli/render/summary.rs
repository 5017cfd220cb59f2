//! Summary of a render, written as text or as JSON.

use std::collections::BTreeMap;

use super::budget::Spent;
use super::options::Render;
use super::systems::Systems;
use crate::cli::backend::{Renderer, Traced};
use crate::cli::table::rays;
use crate::cli::unmatched::{Leak, Unmatched};
use crate::cli::warnings::Warnings;
use crate::image::{Bits, Clipped, Film, Format};
use crate::load::LoadReport;
use crate::measure::table::{bytes, counted, grouped};
use crate::render::{RayCounts, RayKind, Shortfall};
use crate::scene::Scene;
use crate::simd::level;

/// Inputs of a summary.
pub(super) struct Facts<'a> {
    pub job: &'a Render,
    pub scene: &'a Scene,
    pub report: &'a LoadReport,
    pub warnings: &'a Warnings,
    pub traced: &'a Traced,
    pub clipped: Clipped,
    pub budget: Option<&'a Spent>,
    pub seconds: Seconds,
}

/// The summary, in the form of the JSON output.
#[derive(serde::Serialize)]
pub(super) struct Summary<'a> {
    version: &'static str,
    scene: String,
    output: String,
    format: String,
    picture: Picture,
    backend: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    library: Option<String>,
    /// Triangle test and reciprocal, if they were chosen.
    #[serde(skip_serializing_if = "Option::is_none")]
    walk: Option<Walked>,
    simd: &'static str,
    threads: usize,
    tile: u32,
    size: Size,
    /// World coordinates of the scene's origin.
    origin: [f64; 3],
    /// Length of a scene unit in the world.
    unit: f64,
    /// `None` if the back end does not report its tree.
    tree: Option<Tree>,
    touching: Touching,
    /// Reflection systems, if one was chosen.
    #[serde(skip_serializing_if = "Option::is_none")]
    systems: Option<Systems>,
    seconds: Seconds,
    rays: Rays,
    losses: Losses,
    #[serde(skip)]
    unmatched: Vec<String>,
    truncated: Truncated,
    /// Visible light that the picture lacks, if in more than a thousandth of the pixels.
    shortfall: Option<Shortfall>,
    #[serde(flatten)]
    warnings: &'a Warnings,
    defaults: Vec<String>,
    /// Settings chosen for a budget, and the result of the check.
    #[serde(skip_serializing_if = "Option::is_none")]
    budget: Option<&'a Spent>,
}

/// Settings that decided the pixels.
#[derive(serde::Serialize)]
struct Picture {
    width: u32,
    height: u32,
    samples: u32,
    depth: u32,
    /// Weight below which rays end; 0 with a proven bound.
    cutoff: f32,
    /// Proven bound on the change of a channel by rays that end.
    #[serde(skip_serializing_if = "Option::is_none")]
    cutoff_error: Option<f32>,
    wavelengths: u32,
    fresnel: &'static str,
    refraction: String,
    reflection: &'static str,
    shadows: &'static str,
    lights_from: &'static str,
    exposure: f32,
}

#[derive(serde::Serialize)]
struct Size {
    triangles: u64,
    spheres: u64,
    planes: u64,
    objects: usize,
    materials: usize,
    media: usize,
    lights: usize,
    textures: usize,
}

/// Triangle test and reciprocal of the single-ray walk.
#[derive(serde::Serialize)]
struct Walked {
    triangles: &'static str,
    reciprocal: &'static str,
    /// Number of triangle tests; each lane counts.
    tested: u64,
    /// Number of these that fell back to `f64`.
    settled: u64,
}

#[derive(serde::Serialize)]
struct Tree {
    nodes: usize,
    leaves: usize,
    depth: usize,
    bytes: usize,
}

/// Touching surfaces found before the first ray.
#[derive(serde::Serialize)]
struct Touching {
    /// Number of pairs of objects.
    pairs: usize,
    /// Wall time of the search, part of that of the render.
    seconds: f64,
}

/// Wall time of each step, in seconds.
#[derive(Clone, Copy, serde::Serialize)]
pub(super) struct Seconds {
    pub load: f64,
    pub build: f64,
    pub render: f64,
    pub write: f64,
}

#[derive(serde::Serialize)]
struct Rays {
    total: u64,
    camera: u64,
    reflected: u64,
    transmitted: u64,
    shadow: u64,
    /// One row per depth: camera, reflected, transmitted, shadow.
    by_depth: Vec<[u64; 4]>,
    mrays_per_s: f64,
    #[serde(skip)]
    counts: RayCounts,
}

/// Input and light that did not reach the picture unchanged.
#[derive(serde::Serialize)]
struct Losses {
    /// Faces that the loader dropped, by reason.
    faces: BTreeMap<&'static str, u64>,
    /// Primitives that the back end dropped; `None` if it does not report them.
    primitives: Option<usize>,
    non_finite: u64,
    clamped: u64,
    unmatched_exits: u64,
    /// Objects of these exits, the worst first.
    unmatched_objects: Vec<Leak>,
    /// Samples that the file format could not hold.
    clipped: Clipped,
}

/// Weight of the rays that ended at the depth limit or the cut-off, by pixel: the largest of its channels.
#[derive(Debug, PartialEq, serde::Serialize)]
struct Truncated {
    mean: f64,
    max: f32,
    pixels: u64,
}

impl Truncated {
    fn of(weights: &Film) -> Self {
        let (mut sum, mut max, mut pixels) = (0.0, 0.0_f32, 0);
        for &[r, g, b] in &weights.pixels {
            // The weight of a wavelength may be negative in a channel.
            let weight = r.abs().max(g.abs()).max(b.abs());
            sum += f64::from(weight);
            max = max.max(weight);
            pixels += u64::from(weight > 0.0);
        }
        Self { mean: sum / weights.pixels.len().max(1) as f64, max, pixels }
    }
}

fn walked(backend: Renderer, traced: &Traced) -> Option<Walked> {
    let (Renderer::Walk(triangles, reciprocal), Some(lanes)) = (backend, traced.lanes) else { return None };
    let (triangles, reciprocal) = (triangles.name(), reciprocal.name());
    Some(Walked { triangles, reciprocal, tested: lanes.tested, settled: lanes.settled })
}

impl<'a> Summary<'a> {
    pub fn of(facts: &Facts<'a>) -> Self {
        let Facts { job, scene, report, warnings, traced, clipped, budget, seconds } = facts;
        let (settings, outcome, shapes) = (&scene.settings, &traced.outcome, scene.shape_counts());
        let counts = &outcome.rays;
        let unmatched = Unmatched::of(outcome, scene, report, job.backend);
        Self {
            unmatched: unmatched.lines(),
            version: env!("CARGO_PKG_VERSION"),
            scene: job.scene.display().to_string(),
            output: job.output.name().display().to_string(),
            format: match (job.format, job.bits) {
                (Format::Png, Bits::Eight) => String::from("PNG, 8 bits"),
                (Format::Png, Bits::Sixteen) => String::from("PNG, 16 bits"),
                (format, _) => format.name().to_owned(),
            },
            picture: Picture {
                width: settings.width,
                height: settings.height,
                samples: settings.samples,
                depth: settings.max_depth,
                cutoff: if job.options.cutoff_error.is_some() { 0.0 } else { settings.cutoff },
                cutoff_error: job.options.cutoff_error,
                wavelengths: settings.wavelengths,
                fresnel: job.options.fresnel.name(),
                refraction: job.options.refraction.to_string(),
                reflection: job.options.reflection.name(),
                shadows: settings.shadows.name(),
                lights_from: settings.lights_from.name(),
                exposure: job.exposure.ev,
            },
            backend: job.backend.name(),
            library: facts.traced.library.clone(),
            walk: walked(job.backend, traced),
            simd: level::BUILT,
            threads: job.options.thread_count(),
            tile: job.options.tile,
            size: Size {
                triangles: shapes.triangles,
                spheres: shapes.spheres,
                planes: shapes.planes,
                objects: scene.objects.len(),
                materials: scene.materials.len(),
                media: scene.media.len(),
                lights: scene.lights.len(),
                textures: scene.textures.len(),
            },
            origin: scene.origin.to_array(),
            unit: scene.unit(),
            tree: traced.build.map(|b| Tree { nodes: b.nodes, leaves: b.leaves, depth: b.depth, bytes: b.bytes }),
            seconds: *seconds,
            rays: Rays {
                total: counts.total(),
                camera: counts.of(RayKind::Camera),
                reflected: counts.of(RayKind::Reflected),
                transmitted: counts.of(RayKind::Transmitted),
                shadow: counts.of(RayKind::Shadow),
                by_depth: counts.by_depth.clone(),
                mrays_per_s: counts.total() as f64 / seconds.render.max(1e-9) / 1e6,
                counts: counts.clone(),
            },
            losses: Losses {
                faces: report.dropped.clone(),
                primitives: traced.build.map(|b| b.dropped),
                non_finite: outcome.non_finite,
                clamped: outcome.clamped,
                unmatched_exits: unmatched.exits,
                unmatched_objects: unmatched.objects,
                clipped: *clipped,
            },
            truncated: Truncated::of(&outcome.truncated),
            touching: Touching { pairs: outcome.touching.pairs, seconds: outcome.touching.time.as_secs_f64() },
            systems: Systems::of(outcome, scene),
            shortfall: outcome.shortfall,
            warnings,
            defaults: report.defaults.clone(),
            budget: *budget,
        }
    }

    /// Text of several lines, without a final line end.
    pub fn text(&self) -> String {
        let mut lines = Vec::new();
        let mut line = |name: &str, value: String| lines.push(format!("{name:<10} {value}"));
        let p = &self.picture;

        line("picture", format!("{} ({} x {}, {})", self.output, p.width, p.height, self.format));
        let exposure = if p.exposure == 0.0 { String::new() } else { format!(", exposure {:+} EV", p.exposure) };
        let cutoff = match p.cutoff_error {
            None => format!("cut-off {}", p.cutoff),
            Some(error) => format!("cut-off within {error} a channel"),
        };
        let reflection = match p.reflection {
            "traced" => String::new(),
            seen => format!(", reflection {seen}"),
        };
        line(
            "settings",
            format!(
                "{0} x {0} samples, depth {1}, {cutoff}, Fresnel {2}{reflection}, shadows {3}{exposure}",
                p.samples, p.depth, p.fresnel, p.shadows
            ),
        );
        let s = &self.size;
        let sizes = [
            counted(s.triangles, "triangle"),
            counted(s.spheres, "sphere"),
            counted(s.planes, "plane"),
            counted(s.materials as u64, "material"),
            counted(s.lights as u64, "light"),
        ];
        line("scene", format!("{}: {}", self.scene, sizes.join(", ")));
        if self.origin != [0.0; 3] {
            let [x, y, z] = self.origin;
            line("origin", format!("({x}, {y}, {z}), taken off all coordinates before they are rounded to 32 bits"));
        }
        if self.unit != 1.0 {
            line("unit", format!("{:e} of the model's, for what 32 bits can reckon with", self.unit));
        }
        if let Some(t) = &self.tree {
            let (nodes, leaves) = (counted(t.nodes as u64, "node"), grouped(t.leaves as u64));
            line("tree", format!("{nodes}, {leaves} leaves, depth {}, {}", t.depth, bytes(t.bytes as u64)));
        }
        if self.touching.pairs > 0 {
            let pairs = counted(self.touching.pairs as u64, "pair");
            line("touching", format!("{pairs} of objects, found in {:.4} s", self.touching.seconds));
        }
        for (name, value) in self.systems.iter().flat_map(Systems::lines) {
            line(name, value);
        }
        let library = self.library.as_ref().map_or(String::new(), |version| format!(" ({version})"));
        let threads = counted(self.threads as u64, "thread");
        line("back end", format!("{}{library}, {}, {threads}", self.backend, self.simd));
        if let Some(w) = &self.walk {
            let (tested, share) = (grouped(w.tested), w.settled as f64 / w.tested.max(1) as f64 * 100.0);
            let settled = format!("{} ({share:.3} %) settled in f64", grouped(w.settled));
            line("triangles", format!("{}, reciprocal {}: {tested} tests, {settled}", w.triangles, w.reciprocal));
        }
        let t = &self.seconds;
        line(
            "time",
            format!("load {:.3} s, build {:.3} s, render {:.3} s, write {:.3} s", t.load, t.build, t.render, t.write),
        );
        line("rays", format!("{} at {:.2} Mrays/s", grouped(self.rays.total), self.rays.mrays_per_s));
        lines.push(rays(&self.rays.counts, "           "));
        self.lost(&mut lines);
        lines.extend(self.unmatched.iter().cloned());
        lines.extend(self.defaults.iter().map(|d| format!("{:<10} {d}", "default")));
        lines.extend(self.warnings.lines());
        if cfg!(target_arch = "x86_64") && !crate::math::FUSED {
            lines.push(format!("warning: built for {}: slower and less exact; {}", level::BUILT, level::CURE));
        }
        lines.join("\n")
    }

    /// Adds lines on truncated, dropped and clamped amounts. The first is always printed.
    fn lost(&self, lines: &mut Vec<String>) {
        let mut line = |name: &str, value: String| lines.push(format!("{name:<10} {value}"));
        let t = &self.truncated;
        line(
            "truncated",
            match t.pixels {
                0 => String::from("no weight"),
                n => format!("weight {:.3e} in the mean, at most {:.3e}, in {}", t.mean, t.max, counted(n, "pixel")),
            },
        );
        let l = &self.losses;
        for (reason, count) in &l.faces {
            line("dropped", format!("{}: {reason}", counted(*count, "face")));
        }
        let primitives = l.primitives.unwrap_or(0) as u64;
        let clipped = &l.clipped;
        for (name, count, noun, what) in [
            ("dropped", primitives, "primitive", "not finite, too large or without area"),
            ("dropped", l.non_finite, "contribution", "not finite"),
            ("clamped", l.clamped, "contribution", "too large to be summed"),
            ("clipped", clipped.above, "sample", "brighter than the file can hold"),
            ("clipped", clipped.below, "sample", "below zero"),
            ("clipped", clipped.non_finite, "sample", "not finite"),
        ] {
            if count > 0 {
                line(name, format!("{}: {what}", counted(count, noun)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn truncated_weight_is_that_of_the_largest_channel() {
        let mut film = Film::new(2, 2);
        film.pixels[0] = [0.1, 0.5, 0.2];
        film.pixels[3] = [0.25, 0.0, 0.0];
        assert_eq!(Truncated::of(&film), Truncated { mean: 0.1875, max: 0.5, pixels: 2 });
        assert_eq!(Truncated::of(&Film::default()), Truncated { mean: 0.0, max: 0.0, pixels: 0 });
    }
}
