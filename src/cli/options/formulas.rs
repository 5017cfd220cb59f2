//! `vitrum price --formulas`, checked.

use crate::cli::args::{FormulasArgs, KindArg};
use crate::study::formulas::{Kind, Plan};

/// Formulas to be timed and judged.
#[derive(Debug)]
pub(in crate::cli) struct Formulas {
    pub plan: Plan,
    pub csv: bool,
    pub json: bool,
}

impl Formulas {
    /// What was asked for.
    pub fn new(args: &FormulasArgs, json: bool) -> Self {
        let asked = |kind: &Kind| args.of.is_empty() || args.of.iter().any(|&k| kind_of(k) == *kind);
        let kinds = Kind::ALL.into_iter().filter(asked).collect();
        Self { plan: Plan { count: args.count as usize, time: !args.untimed, kinds }, csv: args.csv, json }
    }
}

fn kind_of(arg: KindArg) -> Kind {
    match arg {
        KindArg::Refraction => Kind::Refraction,
        KindArg::Fresnel => Kind::Fresnel,
        KindArg::Reflection => Kind::Reflection,
        KindArg::Reciprocal => Kind::Reciprocal,
        KindArg::Triangle => Kind::Triangle,
    }
}
