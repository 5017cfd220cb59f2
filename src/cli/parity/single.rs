//! `vitrum parity --ray`: one ray through every path, with all contacts that the arbiter finds.

use std::fmt::Write as _;

use super::options::Parity;
use crate::Result;
use crate::accel::reference::{Contact, Examined, Reference, Verdict};
use crate::accel::{Backend, Coherence};
use crate::measure::table::counted;
use crate::scene::Scene;
use crate::simd::level;
use crate::trial::parity::{ask, cause_name, fault_name};
use crate::trial::shown::{self, Ray};
use crate::trial::verify::{Candidate as _, UnderTest};

/// Largest number of contacts listed.
const LISTED: usize = 12;

/// Answers of every path to one ray, in the form of the JSON output. Infinite numbers are null.
#[derive(serde::Serialize)]
pub(super) struct Single {
    version: &'static str,
    simd: &'static str,
    scene: String,
    origin: [f32; 3],
    dir: [f32; 3],
    t_min: f32,
    t_max: f32,
    /// Nearest hit in `f64`.
    truth: Option<Met>,
    answers: Vec<Answer>,
    /// Contacts that `f32` may find along the ray, nearest first.
    contacts: Vec<Near>,
    left_out: Option<String>,
    /// Number of wrong answers of the native path.
    native_wrong: u64,
    passed: bool,
    #[serde(skip)]
    ray: Ray,
}

#[derive(serde::Serialize)]
struct Answer {
    contender: &'static str,
    way: &'static str,
    hit: Option<Met>,
    blocked: bool,
    /// `agrees`, or `undecidable` or `wrong` with the cause or the fault.
    closest: String,
    occluded: String,
}

#[derive(serde::Serialize)]
struct Met {
    t: f64,
    object: String,
    geometry: u32,
    primitive: u32,
}

/// A primitive that the ray passes through, or so closely that `f32` cannot tell.
#[derive(serde::Serialize)]
struct Near {
    #[serde(flatten)]
    met: Met,
    inside: bool,
    /// Distance from the edge that would change the decision, in scene units.
    edge: f64,
    /// Largest error of `f32` in that distance.
    edge_bound: f64,
}

impl Single {
    /// Sends `ray` through every path over `scene`.
    pub fn of(job: &Parity, scene: &Scene, reference: &Reference, ray: &Ray) -> Result<Self> {
        let examined = reference.examine(ray);
        let mut answers = Vec::new();
        let mut ask = |backend| answer(UnderTest { backend, bvh: job.bvh }, scene, &examined, ray, &mut answers);
        let native_wrong = ask(Backend::Native)?;
        let embree = [Backend::Embree, Backend::EmbreeFast].into_iter().try_for_each(|b| ask(b).map(drop));
        let left_out = embree.err().map(|e| e.to_string());
        let truth = examined.truth();
        let met = |t, geometry, primitive| Met::new(scene, t, geometry, primitive);
        let near = |c: &Contact| Near {
            met: met(c.t, c.id.1, c.id.2),
            inside: c.inside,
            edge: c.edge.distance,
            edge_bound: c.edge.bound,
        };
        Ok(Self {
            version: env!("CARGO_PKG_VERSION"),
            simd: level::BUILT,
            scene: job.scene.display().to_string(),
            origin: ray.origin.to_array(),
            dir: ray.dir.to_array(),
            t_min: ray.t_min,
            t_max: ray.t_max,
            truth: truth.is_hit().then(|| met(truth.t, truth.geometry, truth.primitive)),
            answers,
            contacts: examined.contacts().iter().map(near).collect(),
            left_out,
            native_wrong,
            passed: native_wrong == 0,
            ray: *ray,
        })
    }

    /// Returns true if the native path is not wrong.
    pub fn passed(&self) -> bool {
        self.passed
    }

    /// Text of several lines, without a final line end.
    pub fn text(&self) -> String {
        let hit = |met: &Option<Met>| met.as_ref().map_or(String::from("nothing"), Met::text);
        // Writing to a string cannot fail, here and below.
        let mut s = format!("ray            {}\n", shown::ray(&self.ray));
        let _ = writeln!(s, "f64            {}", hit(&self.truth));
        for a in &self.answers {
            let blocked = if a.blocked { "blocked" } else { "not blocked" };
            let name = format!("{} {}", a.contender, a.way);
            let _ = writeln!(s, "{name:<14} {} ({}); {blocked} ({})", hit(&a.hit), a.closest, a.occluded);
        }
        if let Some(why) = &self.left_out {
            let _ = writeln!(s, "left out       embree: {why}");
        }
        for (k, near) in self.contacts.iter().take(LISTED).enumerate() {
            let head = if k == 0 { "f32 may find" } else { "" };
            let side = if near.inside { "inside" } else { "outside" };
            let (edge, bound) = (near.edge, near.edge_bound);
            let _ =
                writeln!(s, "{head:<14} {}, {side} by {edge:.1e}, f32 is off by up to {bound:.1e}", near.met.text());
        }
        if self.contacts.len() > LISTED {
            let _ = writeln!(s, "{:<14} and {} more; --json has all", "", self.contacts.len() - LISTED);
        }
        let verdict = if self.passed {
            String::from("native is nowhere wrong")
        } else {
            format!("native is WRONG in {}", counted(self.native_wrong, "case"))
        };
        let _ = write!(s, "\nverdict        {verdict}");
        s
    }
}

impl Met {
    fn new(scene: &Scene, t: f64, geometry: u32, primitive: u32) -> Self {
        let object = scene.objects.get(geometry as usize).map_or(String::new(), |object| object.name.clone());
        Self { t, object, geometry, primitive }
    }

    fn text(&self) -> String {
        format!("triangle {} of `{}` at t = {}", self.primitive, self.object, self.t)
    }
}

/// Adds the answers of every kernel of one back end. Returns the number of wrong ones.
fn answer(path: UnderTest, scene: &Scene, examined: &Examined, ray: &Ray, answers: &mut Vec<Answer>) -> Result<u64> {
    let mut wrong = 0;
    let mut verdict = |v: Verdict| match v {
        Verdict::Agrees => String::from("agrees"),
        Verdict::Undecidable(cause, _) => format!("undecidable: {}", cause_name(cause)),
        Verdict::Wrong(fault) => {
            wrong += 1;
            format!("wrong: {}", fault_name(fault).replace('_', " "))
        }
    };
    for kernel in path.build(&scene.geometry)? {
        let answered = ask(&kernel.accel, std::slice::from_ref(ray), Coherence::Incoherent);
        let (hit, blocked) = (answered.hits[0], answered.blocked[0]);
        answers.push(Answer {
            contender: path.name(),
            way: kernel.name,
            hit: hit.is_hit().then(|| Met::new(scene, f64::from(hit.t), hit.geometry, hit.primitive)),
            blocked,
            closest: verdict(examined.judge(&hit)),
            occluded: verdict(examined.judge_occluded(blocked)),
        });
    }
    Ok(wrong)
}
