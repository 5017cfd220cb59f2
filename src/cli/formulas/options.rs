//! Validated options of `vitrum price --formulas`.

use crate::cli::args::PriceArgs;
use crate::cli::options::choices::no_hierarchy;
use crate::study::formulas::{Kind, Plan};
use crate::{Error, Result};

/// Formulas to time and judge.
#[derive(Debug)]
pub(in crate::cli) struct Formulas {
    pub plan: Plan,
    pub csv: bool,
    pub json: bool,
}

impl TryFrom<PriceArgs> for Formulas {
    type Error = Error;

    fn try_from(PriceArgs { formulas: args, bvh, json, .. }: PriceArgs) -> Result<Self> {
        if bvh.is_some() {
            return Err(no_hierarchy("formulas have"));
        }
        let asked = |kind: &Kind| args.of.is_empty() || args.of.contains(kind);
        let kinds = Kind::ALL.into_iter().filter(asked).collect();
        Ok(Self { plan: Plan { count: args.count as usize, time: !args.untimed, kinds }, csv: args.csv, json })
    }
}
