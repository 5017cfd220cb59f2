//! Overhead of the ray streams of [`Embree`] on top of Embree.
//!
//! One small renderer traces in two ways that share all shading. It has a point light with shadows, Lambert's cosine,
//! and mirror rays that are only counted. One way writes packets directly into Embree's structs and reads them there;
//! the other sends streams of our own packets through [`Intersector`]. Making packets and reading hits is inside the
//! clock on both sides. The two take turns, and the figures are ratios within a round.

mod support;

use std::time::Instant;

use bytemuck::Zeroable;
use glam::Vec3;
use vitrum::accel::embree::Library;
use vitrum::accel::embree::device::Device;
use vitrum::accel::embree::scene::{Scene, SceneBuilder};
use vitrum::accel::embree::sys::{
    INVALID_GEOMETRY, QUERY_COHERENT, QUERY_INCOHERENT, QueryArguments, RtcRay8, RtcRay16, RtcRayHit8, RtcRayHit16,
    Valid,
};
use vitrum::accel::embree::{Embree, Frequency, Isa, Options, Quality, Scratch};
use vitrum::accel::{Coherence, Intersector};
use vitrum::geometry::{Hit8, Ray, Ray8, TriMesh};
use vitrum::measure::Percentiles;
use vitrum::simd::Mask8;
use vitrum::trial::{Picture, View, rays};

/// Pixels of a tile.
const TILE: usize = 64;

/// Phases timed separately, in this order, before the whole.
const PHASES: [&str; 4] = ["primary", "shading", "shadow", "mirror"];

/// Both hierarchies are built so many times, by turns first and second: where memory lies makes a difference of its own.
const BUILDS: usize = 6;

/// Rounds with each build.
const ROUNDS: usize = 20;

/// A way to trace `n` rays made by a function.
trait Tracer {
    /// Tells which rays meet something, at which `t`, and which triangle it is.
    fn closest(&mut self, n: usize, coherence: Coherence, ray: impl Fn(usize) -> Ray, met: impl FnMut(usize, f32, u32));

    /// Tells which rays meet nothing.
    fn free(&mut self, n: usize, coherence: Coherence, ray: impl Fn(usize) -> Ray, free: impl FnMut(usize));
}

/// Calls of Embree on structs that are written and read in place.
struct Plain {
    scene: Scene,
    /// True if coherent calls take sixteen rays.
    wide: bool,
    eight: RtcRayHit8,
    sixteen: RtcRayHit16,
}

impl Plain {
    fn build(library: &'static Library, mesh: &TriMesh) -> vitrum::Result<Self> {
        let device = Device::open(library, 0, Frequency::Widest, Isa::Best)?;
        let mut scene = SceneBuilder::new(&device, true, Quality::Medium)?;
        scene.triangles(0, u32::MAX, &mesh.positions, &mesh.triangles)?;
        let (mut eight, mut sixteen) = (RtcRayHit8::zeroed(), RtcRayHit16::zeroed());
        eight.ray.mask = [u32::MAX; 8];
        sixteen.ray.mask = [u32::MAX; 16];
        Ok(Self { scene: scene.commit()?, wide: device.native16(), eight, sixteen })
    }
}

/// The loops over packets of `$n` rays.
macro_rules! calls {
    ($n:literal, $ray:ident, $ray_hit:ident, $fill:ident, $closest:ident by $intersect:ident, $free:ident by $occluded:ident) => {
        /// Puts rays into the first lanes.
        #[inline(always)]
        fn $fill(to: &mut $ray, first: usize, count: usize, ray: &impl Fn(usize) -> Ray) -> Valid<$n> {
            for lane in 0..count.min($n) {
                let ray = ray(first + lane);
                [to.org_x[lane], to.org_y[lane], to.org_z[lane]] = ray.origin.to_array();
                [to.dir_x[lane], to.dir_y[lane], to.dir_z[lane]] = ray.dir.to_array();
                [to.tnear[lane], to.tfar[lane]] = [ray.t_min, ray.t_max];
            }
            Valid(std::array::from_fn(|lane| -i32::from(lane < count)))
        }

        #[inline(always)]
        fn $closest(
            scene: &Scene,
            query: &QueryArguments,
            room: &mut $ray_hit,
            n: usize,
            ray: impl Fn(usize) -> Ray,
            mut met: impl FnMut(usize, f32, u32),
        ) {
            for first in (0..n).step_by($n) {
                let count = (n - first).min($n);
                let valid = $fill(&mut room.ray, first, count, &ray);
                room.hit.geom_id = [INVALID_GEOMETRY; $n];
                scene.$intersect(&valid, room, query);
                for lane in 0..count {
                    if room.hit.geom_id[lane] != INVALID_GEOMETRY {
                        met(first + lane, room.ray.tfar[lane], room.hit.prim_id[lane]);
                    }
                }
            }
        }

        #[inline(always)]
        fn $free(
            scene: &Scene,
            query: &QueryArguments,
            room: &mut $ray,
            n: usize,
            ray: impl Fn(usize) -> Ray,
            mut free: impl FnMut(usize),
        ) {
            for first in (0..n).step_by($n) {
                let count = (n - first).min($n);
                let valid = $fill(room, first, count, &ray);
                scene.$occluded(&valid, room, query);
                for lane in 0..count {
                    if room.tfar[lane] >= 0.0 {
                        free(first + lane);
                    }
                }
            }
        }
    };
}

calls!(8, RtcRay8, RtcRayHit8, fill8, closest8 by intersect8, free8 by occluded8);
calls!(16, RtcRay16, RtcRayHit16, fill16, closest16 by intersect16, free16 by occluded16);

fn query(coherence: Coherence) -> QueryArguments {
    QueryArguments::new(if coherence == Coherence::Coherent { QUERY_COHERENT } else { QUERY_INCOHERENT })
}

impl Tracer for Plain {
    #[inline(always)]
    fn closest(
        &mut self,
        n: usize,
        coherence: Coherence,
        ray: impl Fn(usize) -> Ray,
        met: impl FnMut(usize, f32, u32),
    ) {
        if self.wide && coherence == Coherence::Coherent {
            closest16(&self.scene, &query(coherence), &mut self.sixteen, n, ray, met);
        } else {
            closest8(&self.scene, &query(coherence), &mut self.eight, n, ray, met);
        }
    }

    #[inline(always)]
    fn free(&mut self, n: usize, coherence: Coherence, ray: impl Fn(usize) -> Ray, free: impl FnMut(usize)) {
        if self.wide && coherence == Coherence::Coherent {
            free16(&self.scene, &query(coherence), &mut self.sixteen.ray, n, ray, free);
        } else {
            free8(&self.scene, &query(coherence), &mut self.eight.ray, n, ray, free);
        }
    }
}

/// The back end as renders use it, a tile's rays a stream.
struct Streams {
    embree: Embree,
    rays: Vec<Ray8>,
    hits: Vec<Hit8>,
    blocked: Vec<Mask8>,
    scratch: Scratch,
}

impl Streams {
    fn new(embree: Embree) -> Self {
        let packets = TILE / 8;
        Self {
            embree,
            rays: vec![Ray8::default(); packets],
            hits: vec![Hit8::default(); packets],
            blocked: vec![Mask8::NONE; packets],
            scratch: Scratch::default(),
        }
    }

    /// Packs the rays; how many packets they fill.
    #[inline(always)]
    fn fill(&mut self, n: usize, ray: impl Fn(usize) -> Ray) -> usize {
        let packets = n.div_ceil(8);
        for (k, packet) in self.rays[..packets].iter_mut().enumerate() {
            let count = (n - 8 * k).min(8);
            packet.active = Mask8::first(count).bits();
            for lane in 0..count {
                let ray = ray(8 * k + lane);
                packet.origin.set_lane(lane, ray.origin);
                packet.dir.set_lane(lane, ray.dir);
                packet.t_min.set_lane(lane, ray.t_min);
                packet.t_max.set_lane(lane, ray.t_max);
            }
        }
        packets
    }
}

impl Tracer for Streams {
    #[inline(always)]
    fn closest(
        &mut self,
        n: usize,
        coherence: Coherence,
        ray: impl Fn(usize) -> Ray,
        mut met: impl FnMut(usize, f32, u32),
    ) {
        let packets = self.fill(n, ray);
        let hits = &mut self.hits[..packets];
        self.embree.closest(&self.rays[..packets], hits, coherence, &mut self.scratch);
        for (k, hits) in hits.iter().enumerate() {
            for lane in 0..(n - 8 * k).min(8) {
                if hits.geometry[lane] != INVALID_GEOMETRY {
                    met(8 * k + lane, hits.t.lane(lane), hits.primitive[lane]);
                }
            }
        }
    }

    #[inline(always)]
    fn free(&mut self, n: usize, coherence: Coherence, ray: impl Fn(usize) -> Ray, mut free: impl FnMut(usize)) {
        let packets = self.fill(n, ray);
        let blocked = &mut self.blocked[..packets];
        self.embree.occluded(&self.rays[..packets], blocked, coherence, &mut self.scratch);
        for (k, blocked) in blocked.iter().enumerate() {
            let blocked = blocked.bits();
            for lane in 0..(n - 8 * k).min(8) {
                if blocked >> lane & 1 == 0 {
                    free(8 * k + lane);
                }
            }
        }
    }
}

/// Scene to render.
struct Scenery<'a> {
    mesh: &'a TriMesh,
    /// Through the pixels, tile by tile.
    primary: Vec<Ray>,
    light: Vec3,
    /// Offset of secondary rays from the surface.
    push: f32,
}

/// A place that is seen.
struct Surface {
    pixel: usize,
    /// Origin of secondary rays.
    start: Vec3,
    incident: Vec3,
    /// Geometric, of unit length, against the ray.
    normal: Vec3,
}

impl Scenery<'_> {
    #[inline(always)]
    fn surface(&self, pixel: usize, t: f32, triangle: u32) -> Surface {
        let ray = &self.primary[pixel];
        let [a, b, c] = self.mesh.corners(triangle as usize);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let normal = if normal.dot(ray.dir) > 0.0 { -normal } else { normal };
        Surface { pixel, start: ray.origin + ray.dir * t + normal * self.push, incident: ray.dir, normal }
    }

    #[inline(always)]
    fn shadow(&self, seen: &Surface) -> Ray {
        let (dir, distance) = (self.light - seen.start).normalize_and_length();
        Ray { t_max: 0.999 * distance, ..Ray::new(seen.start, dir) }
    }
}

impl Surface {
    #[inline(always)]
    fn mirror(&self) -> Ray {
        Ray::new(self.start, self.incident - self.normal * (2.0 * self.incident.dot(self.normal)))
    }
}

/// Result of a rendering.
#[derive(Default)]
struct Outcome {
    /// By pixel.
    light: Vec<f32>,
    /// Surfaces seen, those that the light reaches, and mirror rays that meet something.
    counts: [usize; 3],
    /// By phase.
    seconds: [f64; 4],
}

#[inline(never)]
fn render(scenery: &Scenery, tracer: &mut impl Tracer) -> Outcome {
    let mut outcome = Outcome { light: vec![0.0; scenery.primary.len()], ..Outcome::default() };
    let Outcome { light, counts: [seen_count, lit, mirrored], seconds } = &mut outcome;
    let mut met: Vec<(usize, f32, u32)> = Vec::with_capacity(TILE);
    let mut seen: Vec<Surface> = Vec::with_capacity(TILE);
    let mut last = Instant::now();
    let mut lap = |phase: usize| {
        let now = Instant::now();
        seconds[phase] += (now - last).as_secs_f64();
        last = now;
    };
    for (k, tile) in scenery.primary.chunks(TILE).enumerate() {
        met.clear();
        tracer.closest(tile.len(), Coherence::Coherent, |i| tile[i], |i, t, triangle| met.push((i, t, triangle)));
        lap(0);
        seen.clear();
        seen.extend(met.iter().map(|&(i, t, triangle)| scenery.surface(TILE * k + i, t, triangle)));
        *seen_count += seen.len();
        lap(1);
        let shine = |i: usize| {
            let Surface { pixel, start, normal, .. } = seen[i];
            light[pixel] = normal.dot((scenery.light - start).normalize()).max(0.0);
            *lit += 1;
        };
        tracer.free(seen.len(), Coherence::Coherent, |i| scenery.shadow(&seen[i]), shine);
        lap(2);
        tracer.closest(seen.len(), Coherence::Incoherent, |i| seen[i].mirror(), |_, _, _| *mirrored += 1);
        lap(3);
    }
    outcome
}

/// Fails where the two have not found the same, but for what Embree sees otherwise in packets of another size: the last
/// ones of a tile.
fn check(name: &str, plain: &Outcome, streams: &Outcome) {
    let slack = plain.light.len() / 10_000;
    for ((a, b), what) in plain.counts.iter().zip(streams.counts).zip(["seen", "lit", "met by mirror rays"]) {
        assert!(a.abs_diff(b) <= slack, "{name}: {a} surfaces {what} plainly, {b} by streams");
    }
    let differ = plain.light.iter().zip(&streams.light).filter(|(a, b)| (*a - *b).abs() > 1e-3).count();
    assert!(differ <= slack, "{name}: {differ} pixels differ");
    assert!(plain.counts.iter().all(|&n| n > 0), "{name}: too little to compare, {:?}", plain.counts);
}

/// Seconds of each phase, then of the whole, round by round.
type Seconds = [Vec<f64>; PHASES.len() + 1];

fn note(seconds: &mut Seconds, outcome: &Outcome) {
    let whole = outcome.seconds.iter().sum();
    for (list, s) in seconds.iter_mut().zip(outcome.seconds.into_iter().chain([whole])) {
        list.push(s);
    }
}

fn compare(library: &'static Library, model: &support::Model, once: bool) -> vitrum::Result<()> {
    let bounds = rays::bounds(&model.geometry);
    let view = View::of(&bounds);
    let primary = view.primary(&Picture { edge: 1024, one_in: 16 });
    let scenery = Scenery { mesh: model.mesh(), primary, light: view.light, push: 1e-4 * bounds.diagonal() };
    let (mut plain_seconds, mut stream_seconds) = (Seconds::default(), Seconds::default());
    let mut counts = [0; 3];
    for build in 0..if once { 1 } else { BUILDS } {
        let streams = || Embree::build(&model.geometry, &Options::default()).map(Streams::new);
        let plain = || Plain::build(library, scenery.mesh);
        let (mut plain, mut streams) = if build % 2 == 0 {
            let plain = plain()?;
            (plain, streams()?)
        } else {
            let streams = streams()?;
            (plain()?, streams)
        };
        let first = render(&scenery, &mut plain);
        check(&model.name, &first, &render(&scenery, &mut streams));
        counts = first.counts;
        for _ in 0..if once { 1 } else { ROUNDS } {
            note(&mut plain_seconds, &render(&scenery, &mut plain));
            note(&mut stream_seconds, &render(&scenery, &mut streams));
        }
    }
    let (pixels, [seen, lit, mirrored]) = (scenery.primary.len(), counts);
    let rounds = plain_seconds[0].len();
    eprintln!("{}: {pixels} pixels, {seen} see it, {lit} lit, {mirrored} mirror rays meet something", model.name);
    eprintln!("  time by streams over plain time, median of {rounds} rounds (10th to 90th percentile)");
    let names = PHASES.into_iter().chain(["whole"]);
    for (i, (name, rays)) in names.zip([pixels, seen, seen, seen, pixels + 2 * seen]).enumerate() {
        let Percentiles { median, spread: [low, high] } = Percentiles::of_ratio(&plain_seconds[i], &stream_seconds[i]);
        let rate = |seconds: &Seconds| Percentiles::of_millions(rays, &seconds[i]).median;
        let (plain, streams) = (rate(&plain_seconds), rate(&stream_seconds));
        eprintln!("  {name:8} {median:.3} ({low:.3} to {high:.3}), {plain:.2} and {streams:.2} million a second");
    }
    Ok(())
}

fn main() -> vitrum::Result<()> {
    let once = std::env::args().any(|a| a == "--test");
    match Library::open(None) {
        Ok(library) => support::models().iter().try_for_each(|model| compare(library, model, once)),
        Err(e) => {
            eprintln!("EMBREE IS LEFT OUT, AND NOTHING IS MEASURED: {e}");
            Ok(())
        }
    }
}
