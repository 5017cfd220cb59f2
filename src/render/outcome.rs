//! What a render gives back beside the picture.

use std::time::Duration;

use super::limit::Limit;
use super::shortfall::Shortfall;
use crate::image::Film;

/// A finished picture and what it took.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The picture, in linear radiance.
    pub film: Film,
    /// Weight that each pixel's cut rays carried (depth limit and weight cut-off), per channel: what the picture is
    /// short of by at most, in a scene of radiance 1.
    pub truncated: Film,
    /// The limit that ended most of each pixel's truncated weight, in the order of the film's pixels.
    pub limits: Vec<Option<Limit>>,
    /// Visible light that the picture lacks for it, where the caller looked for that.
    pub shortfall: Option<Shortfall>,
    /// Rays traced, by kind and depth.
    pub rays: RayCounts,
    /// Contributions that were NaN or infinite; left out of the picture.
    pub non_finite: u64,
    /// Contributions too large for the accumulator (beyond 2^62); clamped to it.
    pub clamped: u64,
    /// Rays that left a medium they had never entered: open or inside-out surfaces, or hits that a back end lost.
    pub unmatched_exits: u64,
    /// Objects that they left it through, each with its exits, the worst first.
    pub unmatched_objects: Vec<(u32, u64)>,
    /// Streams that each stage worked on; none by the `f64` renderer, which has no stages.
    pub streams: StreamCounts,
    /// Objects that rays met, and light that reached them.
    pub seen: Seen,
    /// Touching surfaces.
    pub touching: TouchingFound,
    /// Mirrors that the camera was mirrored in, where that was asked for.
    pub planar: Option<PlanarReport>,
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

/// What the mirrors of one level came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MirrorLevel {
    /// Mirrored cameras, counted in each tile.
    pub passes: u64,
    /// Their rays.
    pub rays: u64,
    /// The sum of the rays' weights, each by its largest channel. Over the camera's rays this is what a picture that ended at the level
    /// before would lack of light of radiance 1, on average.
    pub weight: f64,
    /// The largest of the weights: what it would lack at most.
    pub heaviest: f32,
}

impl MirrorLevel {
    /// Counts one ray.
    pub(super) fn add(&mut self, weight: glam::Vec3) {
        let weight = weight.abs().max_element();
        self.rays += 1;
        self.weight += f64::from(weight);
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

/// Touching surfaces that were found before the first ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TouchingFound {
    /// Pairs of objects that touch.
    pub pairs: usize,
    /// Wall time of the search.
    pub time: Duration,
}

/// Objects that the rays of a picture met, and light that reached them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Seen {
    /// By object: met by a ray of any depth that is no shadow ray. Empty where nothing was traced.
    pub objects: Vec<bool>,
    /// Camera rays that met nothing.
    pub missed: u64,
    /// True if any surface sent light of a lamp to the picture.
    pub lit: bool,
}

impl Seen {
    /// Adds what other rays of the same picture met.
    pub fn merge(&mut self, o: &Self) {
        self.objects.resize(self.objects.len().max(o.objects.len()), false);
        self.objects.iter_mut().zip(&o.objects).for_each(|(met, &other)| *met |= other);
        self.missed += o.missed;
        self.lit |= o.lit;
    }
}

/// The stages of a render, for counting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Absorption.
    Medium,
    /// The environment.
    Miss,
    /// From hits to surfaces.
    Gather,
    /// Mirrors, traced or of the environment.
    Mirror,
    /// Metals.
    Conductor,
    /// Boundaries that refract.
    Dielectric,
    /// Thin panes.
    Thin,
    /// Clear coats.
    Coated,
    /// Covers with holes.
    Alpha,
    /// Emission, ambient and albedo.
    Base,
    /// Lights.
    Light,
    /// Lamps with an extent.
    Lamp,
    /// Shadow rays.
    Shadow,
    /// Shadow rays straight through transmissive surfaces.
    Pass,
}

impl Stage {
    /// How many there are.
    pub const COUNT: usize = Self::Pass as usize + 1;
}

/// Streams by stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StreamCounts([u64; Stage::COUNT]);

impl StreamCounts {
    /// Streams that a stage worked on.
    #[must_use]
    pub fn of(&self, stage: Stage) -> u64 {
        self.0[stage as usize]
    }

    /// Counts one more.
    pub(super) fn count(&mut self, stage: Stage) {
        self.0[stage as usize] += 1;
    }

    /// Adds another count to this one.
    pub(super) fn merge(&mut self, o: &Self) {
        self.0.iter_mut().zip(o.0).for_each(|(a, b)| *a += b);
    }
}

/// What a ray was sent for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RayKind {
    /// From the camera.
    Camera,
    /// Mirrored off a surface.
    Reflected,
    /// Bent into or passed through a surface.
    Transmitted,
    /// Towards a light.
    Shadow,
}

impl RayKind {
    /// All kinds, in the order of [`RayCounts::by_depth`].
    pub const ALL: [Self; 4] = [Self::Camera, Self::Reflected, Self::Transmitted, Self::Shadow];

    /// The name in reports.
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

/// Rays by kind and depth.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// `by_depth[d][k]`: rays of kind `RayKind::ALL[k]` at depth `d`. Camera rays have depth 0; a shadow ray has the
    /// depth of the ray whose hit sent it.
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

    /// Rays of one kind at all depths.
    #[must_use]
    pub fn of(&self, kind: RayKind) -> u64 {
        self.by_depth.iter().map(|row| row[kind as usize]).sum()
    }

    /// All rays.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.by_depth.iter().flatten().sum()
    }
}
