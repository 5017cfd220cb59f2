//! Reflectances.

use super::evaluate::{Answer, Case, Formula};
use super::ranges::{Angles, Range, ULP};
use super::{ErrorSums, Errors, FormulaKind, FormulaPlan, Noted};
use crate::math::{FUSED, LaneMask, Real, Vector3, ulp};
use crate::measure::sample::Rng;
use crate::optics::{Boundary, FresnelFormula, FresnelModel, FresnelVisitor, oracle, polarised, polarised_as_printed};
use crate::simd::{F32x8, Vec3x8};

#[derive(Clone, Copy)]
struct Reflectance<F>(F);

impl<F: FresnelFormula> Answer for Reflectance<F> {
    #[inline(always)]
    fn answer<R: Real>(self, case: &Case<R>) -> (Vector3<R>, R::Mask) {
        (Vector3::all(F::dielectric(&case.boundary, &case.boundary.cross(case.cos))), R::Mask::splat(false))
    }
}

/// Reflectances for both polarisations, in the stable form or as printed.
#[derive(Clone, Copy)]
struct Both<const PRINTED: bool>;

impl<const PRINTED: bool> Answer for Both<PRINTED> {
    #[inline(always)]
    fn answer<R: Real>(self, case: &Case<R>) -> (Vector3<R>, R::Mask) {
        let at = case.boundary.cross(case.cos);
        let r = if PRINTED { polarised_as_printed(&case.boundary, &at) } else { polarised(&case.boundary, &at) };
        (Vector3::new(r.s, r.p, r.unpolarised()), R::Mask::splat(false))
    }
}

const RANGES: [Range; 17] = [
    Range::new("air to glass, all angles", 1.0, 1.5, Angles::All),
    Range::new("air to water, all angles", 1.0, 1.33, Angles::All),
    Range::new("air to diamond, all angles", 1.0, 2.42, Angles::All),
    Range::new("air to glass, near normal", 1.0, 1.5, Angles::NearNormal),
    Range::new("air to glass, grazing", 1.0, 1.5, Angles::Grazing),
    Range::new("glass to air, to 1e-3 of critical", 1.5, 1.0, Angles::BelowCritical),
    Range::new("glass to air, 1e-5 below critical", 1.5, 1.0, Angles::Just(1.2e-7, 1.2e-5)),
    Range::new("diamond to air, to 1e-3 of critical", 2.42, 1.0, Angles::BelowCritical),
    Range::new("1 to 1.0003", 1.0, 1.0003, Angles::All),
    Range::new("1.000277 to 1.000293", 1.000_277, 1.000_293, Angles::All),
    Range::new("1 to 1 + an ulp", 1.0, 1.0 + ULP, Angles::All),
    Range::new("1 + an ulp to 1", 1.0 + ULP, 1.0, Angles::BelowCritical),
    Range::new("1 to 1.1, all angles", 1.0, 1.1, Angles::All),
    Range::new("1 to 1.8, all angles", 1.0, 1.8, Angles::All),
    Range::new("water to air, to 1e-3 of critical", 1.33, 1.0, Angles::BelowCritical),
    Range::new("water to glass, all angles", 1.33, 1.5, Angles::All),
    Range::new("glass to water, to 1e-3 of critical", 1.5, 1.33, Angles::BelowCritical),
];

/// Formula of this study, with the meaning of its answers.
struct Candidate {
    name: String,
    formula: Box<dyn Formula>,
    /// True if the answers are compared with the oracle for each polarisation.
    polarised: bool,
    /// Column of the published figures.
    column: Option<Column>,
}

/// Column of the published figures.
#[derive(Clone, Copy, PartialEq)]
enum Column {
    Exact,
    Printed,
    Schlick,
}

/// Visitor that evaluates a formula in every number type.
struct Boxed;

impl FresnelVisitor for Boxed {
    type Output = Box<dyn Formula>;

    fn visit<F: FresnelFormula>(self, formula: F) -> Box<dyn Formula> {
        Box::new(Reflectance(formula))
    }
}

/// Returns all formulas of the renderer, and the exact one as printed in the notes.
fn candidates() -> Vec<Candidate> {
    let of = |model: FresnelModel| {
        let (formula, polarised) = match model {
            FresnelModel::Polarised => (Box::new(Both::<false>) as Box<dyn Formula>, true),
            unpolarised => (unpolarised.dispatch(Boxed), false),
        };
        let column = match model {
            FresnelModel::Exact => Some(Column::Exact),
            FresnelModel::Schlick => Some(Column::Schlick),
            _ => None,
        };
        Candidate { name: model.to_string(), formula, polarised, column }
    };
    let formula = Box::new(Both::<true>);
    let printed =
        Candidate { name: String::from("as printed"), formula, polarised: false, column: Some(Column::Printed) };
    FresnelModel::ALL.into_iter().map(of).chain([printed]).collect()
}

/// Published largest relative errors: the stable form with fused products, and the notes' form.
const NOTED: [[Option<f64>; 2]; 12] = [
    [Some(6.8e-7), Some(4.8e-7)],
    [Some(6.7e-7), Some(6.3e-7)],
    [Some(7.0e-7), Some(3.5e-7)],
    [Some(4.1e-7), Some(4.0e-7)],
    [Some(6.9e-7), Some(2.9e-7)],
    [Some(6.5e-7), Some(4.5e-6)],
    [Some(4.4e-7), Some(2.7e-4)],
    [Some(5.5e-7), None],
    [Some(7.6e-7), Some(7.2e-4)],
    [Some(7.1e-7), Some(1.5e-2)],
    [Some(7.0e-7), Some(1.4)],
    [Some(6.4e-7), None],
];

/// Published largest errors of Schlick's formula, by range.
const NOTED_SCHLICK: [(usize, f64); 10] = [
    (0, 0.0357),
    (1, 0.0599),
    (2, 0.0757),
    (5, 0.0357),
    (7, 0.0757),
    (8, 0.855),
    (12, 0.211),
    (13, 0.0345),
    (14, 0.0599),
    (15, 0.174),
];

/// Returns the figure published for a formula and a range, with ours.
fn noted(column: Column, range: usize, errors: &Errors) -> Option<Noted> {
    let relative = errors.worst.relative.unwrap_or(0.0);
    let (value, ours) = match column {
        Column::Exact => (NOTED.get(range)?[0]?, relative),
        Column::Printed => (NOTED.get(range)?[1]?, relative),
        Column::Schlick => (NOTED_SCHLICK.iter().find(|(r, _)| *r == range)?.1, errors.worst.absolute),
    };
    let noted = Noted { value, ours, why: "" };
    let why = match (column, range) {
        _ if noted.agrees() => "",
        (Column::Exact, _) if !FUSED => "products are not fused in this build",
        (Column::Exact | Column::Printed, 3) => "cosines nearer to 1 than those noted",
        _ if ours < value => "other roundings, and fused products",
        _ => "other roundings of the same cancellation",
    };
    Some(Noted { why, ..noted })
}

pub(super) fn measure(plan: &FormulaPlan) -> Vec<super::Formula> {
    let candidates = candidates();
    let ranges: Vec<Vec<ErrorSums>> =
        RANGES.iter().enumerate().map(|(i, range)| tally(plan, &candidates, range, i)).collect();
    let rows = candidates.into_iter().enumerate().map(|(f, Candidate { name, formula, column, .. })| {
        let errors = |(r, tallies): (usize, &Vec<ErrorSums>)| {
            let errors = tallies[f].errors(RANGES[r].name);
            Errors { noted: column.and_then(|column| noted(column, r, &errors)), ..errors }
        };
        let time = plan.time.then(|| formula.time());
        super::Formula {
            kind: FormulaKind::Fresnel,
            name,
            time,
            ranges: ranges.iter().enumerate().map(errors).collect(),
        }
    });
    rows.collect()
}

fn tally(plan: &FormulaPlan, candidates: &[Candidate], range: &Range, number: usize) -> Vec<ErrorSums> {
    let mut rng = Rng::new("formulas: fresnel", number);
    let mut tallies = vec![ErrorSums::default(); candidates.len()];
    let boundary8 = Boundary::<F32x8>::new(range.n1, range.n2);
    let boundary = Boundary::<f64>::new(range.n1, range.n2);
    let zero8 = Vec3x8::splat(glam::Vec3::ZERO);
    let zero = Vector3::all(0.0);
    for _ in 0..plan.count.div_ceil(8) {
        let cosines: [f64; 8] = std::array::from_fn(|_| range.angle(&mut rng).cos());
        let cos = F32x8::from_fn(|k| cosines[k] as f32);
        let case = Case { incident: zero8, normal: zero8, cos, boundary: boundary8 };
        let answers: Vec<_> = candidates.iter().map(|c| c.formula.eight(&case).0).collect();
        for (k, &c) in cosines.iter().enumerate() {
            let (s, p) = oracle::reflectances(cos.lane(k), range.n1, range.n2);
            let (s64, p64) = oracle::reflectances(c, range.n1, range.n2);
            let case64 = Case { incident: zero, normal: zero, cos: c, boundary };
            for ((tally, answer), candidate) in tallies.iter_mut().zip(&answers).zip(candidates) {
                tally.asked += 1;
                let got = answer.lane(k);
                let mut one = |got: f32, want: f64, whole: f64| {
                    let off = (f64::from(got) - want).abs();
                    let relative = (whole > 0.0).then(|| off / whole);
                    tally.add(off / f64::from(ulp(want as f32)), off, relative);
                };
                // The reflectance in the plane of incidence has a zero, so its error is relative to the other
                // reflectance.
                if candidate.polarised {
                    let off_p = (f64::from(got.y) - p).abs();
                    one(got.x, s, s);
                    tally.worst.relative = tally.worst.relative.map(|worst| worst.max(off_p / s));
                } else {
                    one(got.z, 0.5 * (s + p), 0.5 * (s + p));
                }
                let got = candidate.formula.double(&case64).0;
                let off = if candidate.polarised {
                    (got.x - s64).abs().max((got.y - p64).abs())
                } else {
                    (got.z - 0.5 * (s64 + p64)).abs()
                };
                tally.worst_f64 = tally.worst_f64.max(off);
            }
        }
    }
    tallies
}
