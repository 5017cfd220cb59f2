//! Validated options of `vitrum price --formulas`.

use super::args::FormulasArgs;
use crate::Result;
use crate::accel::BuildQuality;
use crate::cli::options::choices::no_hierarchy;
use crate::study::formulas::{FormulaKind, FormulaPlan};

/// Formulas to time and judge.
#[derive(Debug)]
pub(in crate::cli) struct Formulas {
    pub plan: FormulaPlan,
    pub csv: bool,
    pub json: bool,
}

impl Formulas {
    /// Converts the arguments. `bvh` and `json` are those of `vitrum price`.
    ///
    /// # Errors
    /// Usage if a build quality is given.
    pub fn new(args: FormulasArgs, bvh: Option<BuildQuality>, json: bool) -> Result<Self> {
        if bvh.is_some() {
            return Err(no_hierarchy("formulas have"));
        }
        let asked = |kind: &FormulaKind| args.of.is_empty() || args.of.contains(kind);
        let kinds = FormulaKind::ALL.into_iter().filter(asked).collect();
        Ok(Self { plan: FormulaPlan { count: args.count as usize, time: !args.untimed, kinds }, csv: args.csv, json })
    }
}
