//! Conditions of a render by mirrored cameras, and its report.

use super::options::{Options, Reflection};
use super::outcome::{MirrorLevel, PlanarReport};
use super::passes::Passes;
use crate::scene::Scene;
use crate::systems::planar::Mirrors;
use crate::{Error, Result};

/// Counts of one thread or of all.
#[derive(Clone, Debug, Default)]
pub(super) struct PlanarCounts {
    pub levels: Vec<MirrorLevel>,
    pub elsewhere: u64,
}

impl PlanarCounts {
    /// Returns the counts of a thread.
    pub fn of(passes: &Passes) -> Self {
        Self { levels: passes.counts.clone(), elsewhere: passes.elsewhere }
    }

    /// Adds the counts of another thread.
    pub fn merge(&mut self, o: &Self) {
        self.levels.resize(self.levels.len().max(o.levels.len()), MirrorLevel::default());
        self.levels.iter_mut().zip(&o.levels).for_each(|(level, other)| level.merge(other));
        self.elsewhere += o.elsewhere;
    }

    /// Returns the report on the mirrors of a scene.
    pub fn of_mirrors(self, mirrors: &Mirrors) -> PlanarReport {
        PlanarReport {
            mirrors: mirrors.list.len(),
            levels: self.levels,
            elsewhere: self.elsewhere,
            curved: mirrors.curved.iter().map(|(object, why)| (*object, why.to_string())).collect(),
        }
    }
}

/// Returns the planar mirrors in which cameras are mirrored: none unless that is asked for, and none where rays carry what
/// those of a mirrored camera would not (polarisation, budgets).
pub(super) fn mirrors(scene: &Scene, options: &Options) -> Option<Mirrors> {
    (options.reflection == Reflection::Planar && !options.carries()).then(|| Mirrors::of(scene))
}

/// Checks that a camera can be mirrored in some reflector of the scene.
///
/// # Errors
/// [`Error::Usage`], where reflectors are there and none is planar.
pub(super) fn possible(scene: &Scene, mirrors: Option<&Mirrors>) -> Result<()> {
    let Some(mirrors) = mirrors else { return Ok(()) };
    match mirrors.curved.first() {
        Some((object, why)) if mirrors.list.is_empty() => Err(Error::Usage(format!(
            "--reflection planar: `{}` {why}, and no other reflector is planar; give it flat faces without normals of \
             their own, or take --reflection traced",
            scene.objects[*object as usize].name
        ))),
        _ => Ok(()),
    }
}

/// Checks that some body can be raised as a whole.
///
/// # Errors
/// [`Error::Usage`], where bodies bend light and none has a planar surface.
pub(super) fn raisable(scene: &Scene, flats: Option<&Mirrors>) -> Result<()> {
    let Some(flats) = flats else { return Ok(()) };
    let bends = |object: u32| scene.medium_of(object as usize).is_some();
    match flats.curved.iter().find(|(object, _)| bends(*object)) {
        Some((object, why)) if !flats.list.iter().any(|flat| bends(flat.object)) => Err(Error::Usage(format!(
            "--refraction raised: `{}` {why}, and no other body has a planar surface; give it flat faces without normals \
             of their own, or take --refraction stable",
            scene.objects[*object as usize].name
        ))),
        _ => Ok(()),
    }
}
