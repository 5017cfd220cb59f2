//! What a render gives back beside the picture.

use crate::image::Film;

/// A finished picture and what it took.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The picture, in linear radiance.
    pub film: Film,
    /// Weight that each pixel's cut rays carried (depth limit and weight cut-off), per channel: what the picture is
    /// short of by at most, in a scene of radiance 1.
    pub truncated: Film,
    /// Rays traced, by kind and depth.
    pub rays: RayCounts,
    /// Contributions that were NaN or infinite; left out of the picture.
    pub non_finite: u64,
    /// Contributions too large for the accumulator (beyond 2^62); clamped to it.
    pub clamped: u64,
    /// Rays that left a medium they had never entered: open or inside-out surfaces.
    pub unmatched_exits: u64,
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
