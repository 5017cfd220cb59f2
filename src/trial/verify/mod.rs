//! Hard cases run on this machine. Back ends must lose no ray, hit no surface twice, and give the same bits in any
//! packet. The optics must keep their documented bounds.
//!
//! Every group is a number of batches with a random stream each, so that the result does not depend on the number of
//! threads.

mod builds;
mod candidate;
mod chains;
mod extent;
mod fresnel;
mod group;
mod lanes;
mod leaks;
mod matched;
mod meshes;
mod plan;
mod reflection;
mod refraction;
mod scene;
mod self_hits;
mod tally;
mod traversal;
mod trouble;

pub use candidate::{Candidate, NamedAccel, UnderTest};
pub use fresnel::INDEX_PAIRS;
pub use group::Group;
pub use plan::{GroupResult, VerifyPlan};
use plan::{in_batches, timed};
pub use scene::fire as fire_at_scene;
pub use tally::{CaseCounts, Worst};
pub use trouble::{TriangleLocation, Trouble, TroubleKind, Troubles, find as find_trouble};

use crate::Result;
use crate::render::Observer;

/// Runs the selected groups that test formulas alone.
///
/// # Errors
/// Returns [`Error::Interrupted`](crate::Error::Interrupted) soon after `observer.stop` is set.
pub fn fire_at_optics(plan: &VerifyPlan, observer: &Observer) -> Result<Vec<GroupResult>> {
    let mut findings = Vec::new();
    for &group in plan.groups.iter().filter(|g| !g.is_of_path()) {
        let finding = |batches, batch: &(dyn Fn(usize) -> Result<CaseCounts> + Sync)| {
            timed(group, None, || in_batches(batches, observer, batch))
        };
        findings.push(match group {
            Group::Fresnel => finding(fresnel::batches(plan), &|i| Ok(fresnel::batch(plan, i)))?,
            Group::Refraction => finding(refraction::batches(plan), &|i| Ok(refraction::batch(plan, i)))?,
            Group::Reflection => finding(reflection::BATCHES, &|i| Ok(reflection::batch(plan, i)))?,
            Group::Matched => finding(matched::BATCHES, &|i| Ok(matched::batch(plan, i)))?,
            _ => continue,
        });
    }
    Ok(findings)
}

/// Runs the selected groups that test a back end.
///
/// # Errors
/// Fails as [`fire_at_optics`] does, or if the back end cannot be built.
pub fn fire_at_path<C: Candidate>(candidate: &C, plan: &VerifyPlan, observer: &Observer) -> Result<Vec<GroupResult>> {
    let mut findings = Vec::new();
    for &group in plan.groups.iter().filter(|g| g.is_of_path()) {
        let finding = |batches, batch: &(dyn Fn(usize) -> Result<CaseCounts> + Sync)| {
            timed(group, Some(candidate.name()), || in_batches(batches, observer, batch))
        };
        findings.push(match group {
            Group::Leaks => {
                let pairs = meshes::pairs(&leaks::MESHES);
                finding(pairs.len(), &|i| leaks::batch(candidate, plan, &pairs, i))?
            }
            Group::SelfHits => {
                let pairs = meshes::pairs(&self_hits::MESHES);
                finding(pairs.len(), &|i| self_hits::batch(candidate, plan, &pairs, i))?
            }
            Group::Lanes => finding(lanes::BATCHES, &|i| lanes::batch(candidate, plan, i))?,
            Group::Traversal => finding(traversal::BATCHES, &|i| traversal::batch(candidate, plan, i))?,
            Group::Builds => finding(builds::BATCHES, &|i| builds::batch(candidate, plan, i))?,
            Group::Chains => finding(chains::BATCHES, &|i| chains::batch(candidate, plan, i))?,
            _ => continue,
        });
    }
    Ok(findings)
}
