//! Mirrored directions.

use super::evaluate::{Answer, Case, Formula};
use super::ranges::{Angles, Range, ULP};
use super::{ErrorSums, Errors, FormulaKind, FormulaPlan, Noted};
use crate::math::{LaneMask, Real, Vector3};
use crate::measure::sample::Rng;
use crate::optics::{Boundary, PlanarReflection, oracle, reflect};
use crate::simd::{F32x8, Vec3x8};

#[derive(Clone, Copy)]
struct Vector;

impl Answer for Vector {
    #[inline(always)]
    fn answer<R: Real>(self, case: &Case<R>) -> (Vector3<R>, R::Mask) {
        (reflect(case.incident, case.normal), R::Mask::splat(false))
    }
}

/// The slides' matrix, computed anew for each ray.
#[derive(Clone, Copy)]
struct Matrix;

impl Answer for Matrix {
    #[inline(always)]
    fn answer<R: Real>(self, case: &Case<R>) -> (Vector3<R>, R::Mask) {
        let mirror = PlanarReflection::new(Vector3::all(R::zero()), case.normal);
        (mirror.direction(case.incident), R::Mask::splat(false))
    }
}

const RANGES: [Range; 3] = [
    Range::new("all angles", 1.0, 1.5, Angles::All),
    Range::new("near normal", 1.0, 1.5, Angles::NearNormal),
    Range::new("grazing", 1.0, 1.5, Angles::Grazing),
];

pub(super) fn measure(plan: &FormulaPlan) -> Vec<super::Formula> {
    let formulas: [(&str, Box<dyn Formula>); 2] = [("vector", Box::new(Vector)), ("matrix", Box::new(Matrix))];
    let rows = formulas.iter().enumerate().map(|(f, (name, formula))| {
        let errors = RANGES.iter().enumerate().map(|(r, range)| {
            let errors = tally(plan, formula.as_ref(), range, r).errors(range.name);
            let ours = errors.worst.absolute;
            // The largest angle of a million.
            let noted = (f == 0 && r == 0).then(|| {
                let noted = Noted { value: 2.1e-7, ours, why: "" };
                Noted { why: if noted.agrees() { "" } else { "fused products here" }, ..noted }
            });
            Errors { noted, ..errors }
        });
        let time = plan.time.then(|| formula.time());
        super::Formula { kind: FormulaKind::Reflection, name: String::from(*name), time, ranges: errors.collect() }
    });
    rows.collect()
}

fn tally(plan: &FormulaPlan, formula: &dyn Formula, range: &Range, number: usize) -> ErrorSums {
    let mut rng = Rng::new("formulas: reflection", number);
    let mut tally = ErrorSums::default();
    for _ in 0..plan.count.div_ceil(8) {
        let drawn: [_; 8] = std::array::from_fn(|_| {
            let angle = range.angle(&mut rng);
            rng.unit_meeting_at(angle)
        });
        let (mut incident, mut normal) = (Vec3x8::splat(glam::Vec3::ZERO), Vec3x8::splat(glam::Vec3::ZERO));
        for (k, (i, n)) in drawn.iter().enumerate() {
            incident.set_lane(k, i.as_vec3());
            normal.set_lane(k, n.as_vec3());
        }
        let case = Case { incident, normal, cos: F32x8::ZERO, boundary: Boundary::new(range.n1, range.n2) };
        let answers = formula.eight(&case).0;
        for (k, &(i, n)) in drawn.iter().enumerate() {
            tally.asked += 1;
            let got: Vector3<f32> = answers.lane(k).into();
            let want = oracle::mirror::<f32>(incident.lane(k).into(), normal.lane(k).into());
            tally.add(want.furthest_component(got) / ULP, want.angle_to(got), None);
            let boundary = Boundary::new(range.n1, range.n2);
            let (i, n): (Vector3<f64>, Vector3<f64>) = (i.into(), n.into());
            let got = formula.double(&Case { incident: i, normal: n, cos: 0.0, boundary }).0;
            tally.worst_f64 = tally.worst_f64.max(oracle::mirror(i, n).angle_to(got));
        }
    }
    tally
}
