//! Results of a render: the picture, and counts of rays, streams and losses.

use std::sync::Arc;
use std::time::Duration;

use super::limit::Limit;
use super::shortfall::Shortfall;
use crate::image::Film;
use crate::systems::images::PointCounts;
use crate::systems::maps::Maps;

/// Finished picture and the counts of its render.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Picture in linear radiance.
    pub film: Film,
    /// Weight of each pixel's ended rays, per channel, by whatever limit. In a scene of radiance 1 the pixel lacks at
    /// most this much.
    pub truncated: Film,
    /// Limit that ended most of each pixel's truncated weight, in the order of the film's pixels.
    pub limits: Vec<Option<Limit>>,
    /// Visible light that the picture lacks because of limits, if the caller measured it.
    pub shortfall: Option<Shortfall>,
    /// Number of rays traced, by kind and depth.
    pub rays: RayCounts,
    /// Number of contributions left out because they were NaN or infinite.
    pub non_finite: u64,
    /// Number of contributions clamped because they exceeded 2^62.
    pub clamped: u64,
    /// Number of rays that left a medium they had never entered: through open or inside-out surfaces, or after a hit
    /// that the back end missed.
    pub unmatched_exits: u64,
    /// Objects through which they left, each with its number of exits, the worst first.
    pub unmatched_objects: Vec<(u32, u64)>,
    /// Number of streams per stage. All 0 from the `f64` renderer, which has no stages.
    pub streams: StreamCounts,
    /// Objects that rays hit, and light that reached them.
    pub seen: Seen,
    /// Touching surfaces found in the scene.
    pub touching: TouchingFound,
    /// Mirrors that the camera was mirrored in, where that was asked for.
    pub planar: Option<PlanarReport>,
    /// Maps that reflectors show, where that was asked for.
    pub maps: Option<MapsReport>,
    /// Virtual scenes that reflectors show, where that was asked for.
    pub images: Option<ImagesReport>,
    /// Maps that refracted light is looked up in, where that was asked for.
    pub body_maps: Option<MapsReport>,
}

/// Curved reflectors by virtual scenes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ImagesReport {
    /// Reflectors with a virtual scene.
    pub reflectors: usize,
    /// Triangles of all virtual scenes.
    pub triangles: u64,
    /// Points of the scene that were to be moved.
    pub points: PointCounts,
    /// Triangles left out because a corner lies in a reflector, or has no reflection point or several.
    pub left_out: u64,
    /// Reflections that were traced: of other reflectors, and of these where something else shows them or pieces are left out.
    pub traced: u64,
    /// Reflectors without a virtual scene, with the reasons.
    pub without: Vec<(u32, &'static str)>,
}

/// Environment maps as reflections.
#[derive(Clone, Debug)]
pub struct MapsReport {
    /// The maps, for other cameras ([`super::Options::maps`]).
    pub maps: Arc<Maps>,
    /// Wall time of taking them; 0 where they were there before.
    pub time: Duration,
    /// Reflections that were traced for want of a map, or because they were inside a body.
    pub traced: u64,
}

/// Planar mirrors by matrix: levels of mirrors in mirrors, and what a matrix did not serve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanarReport {
    /// Planes that reflect.
    pub mirrors: usize,
    /// By level, from mirrors that the camera sees on.
    pub levels: Vec<MirrorLevel>,
    /// Reflections in planar mirrors that were seen in or through something else, and so traced.
    pub elsewhere: u64,
    /// Reflectors that a matrix does not serve, with the reasons; what they reflect is traced.
    pub curved: Vec<(u32, String)>,
}

/// Weights of rays are summed in units of one over this.
const WEIGHT_UNIT: f64 = 4_294_967_296.0;

/// Counts of the mirrors of one level.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MirrorLevel {
    /// Mirrored cameras, counted in each tile.
    pub passes: u64,
    /// Their rays.
    pub rays: u64,
    /// Sum of the largest channels of the rays' weights, in units of 2^-32. Whole numbers have the same sum in any order.
    weight: u128,
    /// Largest of these weights.
    pub heaviest: f32,
}

impl MirrorLevel {
    /// Returns the sum of the largest channels of the rays' weights. Divided by the number of camera rays, it is the mean light
    /// that a picture without this level would lack if everything had a radiance of 1.
    #[must_use]
    pub fn weight(&self) -> f64 {
        self.weight as f64 / WEIGHT_UNIT
    }

    /// Counts one ray.
    pub(super) fn add(&mut self, weight: glam::Vec3) {
        let weight = weight.abs().max_element();
        self.rays += 1;
        self.weight += (f64::from(weight) * WEIGHT_UNIT) as u128;
        self.heaviest = self.heaviest.max(weight);
    }

    /// Adds another part of the same level.
    pub(super) fn merge(&mut self, o: &Self) {
        self.passes += o.passes;
        self.rays += o.rays;
        self.weight += o.weight;
        self.heaviest = self.heaviest.max(o.heaviest);
    }
}

/// Touching surfaces found before the first ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TouchingFound {
    /// Number of pairs of objects that touch.
    pub pairs: usize,
    /// Wall time of the search.
    pub time: Duration,
}

/// Objects that the rays of a picture hit, and light that reached them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Seen {
    /// By object: true if a ray of any depth, other than a shadow ray, hit it. Empty where nothing was traced.
    pub objects: Vec<bool>,
    /// Number of camera rays that hit nothing.
    pub missed: u64,
    /// True if any surface sent light of a lamp to the picture.
    pub lit: bool,
}

impl Seen {
    /// Adds the observations of other rays of the same picture.
    pub fn merge(&mut self, o: &Self) {
        self.objects.resize(self.objects.len().max(o.objects.len()), false);
        self.objects.iter_mut().zip(&o.objects).for_each(|(met, &other)| *met |= other);
        self.missed += o.missed;
        self.lit |= o.lit;
    }
}

/// Stage of a render, for counting streams.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Absorption.
    Medium,
    /// The environment.
    Miss,
    /// Conversion of hits to surface points.
    Gather,
    /// Mirrors, whether traced or of the environment.
    Mirror,
    /// Metals.
    Conductor,
    /// Refracting boundaries.
    Dielectric,
    /// Thin panes.
    Thin,
    /// Clear coats.
    Coated,
    /// Covers with holes.
    Alpha,
    /// Emission, ambient light and albedo.
    Base,
    /// Lights without extent.
    Light,
    /// Area lamps.
    Lamp,
    /// Shadow rays.
    Shadow,
    /// Shadow rays through transmissive surfaces.
    Pass,
}

impl Stage {
    /// Number of stages.
    pub const COUNT: usize = Self::Pass as usize + 1;
}

/// Number of streams by stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StreamCounts([u64; Stage::COUNT]);

impl StreamCounts {
    /// Returns the number of streams that ran through a stage.
    #[must_use]
    pub fn of(&self, stage: Stage) -> u64 {
        self.0[stage as usize]
    }

    /// Counts one stream.
    pub(super) fn count(&mut self, stage: Stage) {
        self.0[stage as usize] += 1;
    }

    /// Adds another count to this one.
    pub(super) fn merge(&mut self, o: &Self) {
        self.0.iter_mut().zip(o.0).for_each(|(a, b)| *a += b);
    }
}

/// Purpose of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RayKind {
    /// Ray from the camera.
    Camera,
    /// Ray reflected by a surface.
    Reflected,
    /// Ray refracted into, or passed through, a surface.
    Transmitted,
    /// Ray towards a light.
    Shadow,
}

impl RayKind {
    /// All kinds, in the order of [`RayCounts::by_depth`].
    pub const ALL: [Self; 4] = [Self::Camera, Self::Reflected, Self::Transmitted, Self::Shadow];

    /// Returns the name used in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Reflected => "reflected",
            Self::Transmitted => "transmitted",
            Self::Shadow => "shadow",
        }
    }
}

/// Number of rays by kind and depth.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// `by_depth[d][k]` counts the rays of kind `RayKind::ALL[k]` at depth `d`. Camera rays have depth 0. A shadow ray
    /// has the depth of the ray whose hit sent it.
    pub by_depth: Vec<[u64; 4]>,
}

impl RayCounts {
    /// Counts `n` more rays.
    pub fn add(&mut self, kind: RayKind, depth: usize, n: u64) {
        if self.by_depth.len() <= depth {
            self.by_depth.resize(depth + 1, [0; 4]);
        }
        self.by_depth[depth][kind as usize] += n;
    }

    /// Adds another count to this one.
    pub fn merge(&mut self, o: &Self) {
        for (depth, row) in o.by_depth.iter().enumerate() {
            for (k, &n) in row.iter().enumerate() {
                self.add(RayKind::ALL[k], depth, n);
            }
        }
    }

    /// Returns the number of rays of one kind at all depths.
    #[must_use]
    pub fn of(&self, kind: RayKind) -> u64 {
        self.by_depth.iter().map(|row| row[kind as usize]).sum()
    }

    /// Returns the number of all rays.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.by_depth.iter().flatten().sum()
    }
}
