//! Validated options of `vitrum verify`.

use std::path::PathBuf;

use super::args::VerifyArgs;
use crate::accel::{Backend, BuildQuality};
use crate::cli::choice::PathArg;
use crate::cli::options::Reading;
use crate::cli::options::choices::no_hierarchy;
use crate::error::{Error, Result, Unavailable};
use crate::trial::verify::{self, Group};

/// Hard cases to try.
#[derive(Debug)]
pub(in crate::cli) struct Verify {
    /// Scene to test; `None` for the built-in cases.
    pub scene: Option<PathBuf>,
    pub reading: Reading,
    pub plan: verify::VerifyPlan,
    pub native: bool,
    /// True to test both modes of Embree, if it is compiled in.
    pub embree: bool,
    pub bvh: BuildQuality,
    /// Number of worker threads; 0 means one per processor.
    pub threads: usize,
    /// True if warnings are errors.
    pub strict: bool,
    pub json: bool,
    pub quiet: bool,
}

impl TryFrom<VerifyArgs> for Verify {
    type Error = Error;

    fn try_from(args: VerifyArgs) -> Result<Self> {
        let embree = args.backend.contains(&PathArg::Embree);
        if embree && !Backend::Embree.is_compiled_in() {
            return Err(Unavailable::NotCompiledIn.into());
        }
        let known: &[Group] = if args.scene.is_some() { &Group::OF_SCENE } else { &Group::OF_NO_SCENE };
        let mut groups: Vec<Group> = Vec::new();
        for group in args.group {
            if !known.contains(&group) {
                let names: Vec<&str> = known.iter().map(|g| g.name()).collect();
                let what = if args.scene.is_some() { "a scene" } else { "no scene" };
                return Err(Error::Usage(format!(
                    "--group {}: with {what} the groups are {}",
                    group.name(),
                    names.join(", ")
                )));
            }
            if !groups.contains(&group) {
                groups.push(group);
            }
        }
        if groups.is_empty() {
            groups = known.to_vec();
        }
        if args.bvh.is_some() && !groups.iter().any(|group| group.is_of_path()) {
            return Err(no_hierarchy("formulas have"));
        }
        Ok(Self {
            scene: args.scene,
            reading: args.model.into(),
            plan: verify::VerifyPlan { groups, full: args.full, rays: None },
            native: args.backend.contains(&PathArg::Native),
            embree,
            bvh: args.bvh.unwrap_or_default(),
            threads: args.threads.unwrap_or(0) as usize,
            strict: args.strict.strict,
            json: args.json,
            quiet: args.quiet,
        })
    }
}
