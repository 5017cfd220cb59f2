//! Reciprocals.

use std::hint::black_box;

use super::timing::{Time, time};
use super::{ErrorSums, Errors, FormulaKind, FormulaPlan, Noted};
use crate::math::{Real, ulp};
use crate::measure::sample::Rng;
use crate::simd::{Estimate, F32x8, Reciprocal, ReciprocalModel, ReciprocalVisitor};

/// Ranges, with the exponents of two between which numbers are drawn.
const RANGES: [(&str, f64, f64); 2] = [("1 to 2", 0.0, 1.0), ("2^-100 to 2^100", -100.0, 100.0)];

/// Published largest relative error of the estimate, for the CPUs of one maker.
const NOTED_ESTIMATE: f64 = 3.0e-4;

pub(super) fn measure(plan: &FormulaPlan) -> Vec<super::Formula> {
    ReciprocalModel::ALL.map(|model| model.dispatch(Measured { plan, model })).into()
}

/// Visitor that measures a formula.
struct Measured<'a> {
    plan: &'a FormulaPlan,
    model: ReciprocalModel,
}

impl ReciprocalVisitor for Measured<'_> {
    type Output = super::Formula;

    fn visit<F: Reciprocal>(self, _formula: F) -> super::Formula {
        let errors = RANGES.iter().enumerate().map(|(r, &(name, low, high))| {
            let errors = tally::<F>(self.plan, r, low, high).errors(name);
            let noted = (self.model == ReciprocalModel::Estimate).then(|| {
                let noted = Noted { value: NOTED_ESTIMATE, ours: errors.worst.absolute, why: "" };
                Noted {
                    why: if noted.agrees() { "" } else { "another CPU, or none with such an instruction" },
                    ..noted
                }
            });
            Errors { noted, ..errors }
        });
        let ranges = errors.collect();
        let time = self.plan.time.then(timed::<F>);
        super::Formula { kind: FormulaKind::Reciprocal, name: self.model.to_string(), time, ranges }
    }
}

fn tally<F: Reciprocal>(plan: &FormulaPlan, number: usize, low: f64, high: f64) -> ErrorSums {
    let mut rng = Rng::new("formulas: reciprocal", number);
    let mut tally = ErrorSums::default();
    for _ in 0..plan.count.div_ceil(8) {
        let x = F32x8::from_fn(|_| rng.between(low, high).exp2() as f32);
        let got = F::of(x);
        for k in 0..8 {
            tally.asked += 1;
            // A quotient of `f32` numbers in `f64` has a relative error of at most 2^-53.
            let want = 1.0 / f64::from(x.lane(k));
            let off = (f64::from(got.lane(k)) - want).abs();
            tally.add(off / f64::from(ulp(want as f32)), off / want, Some(off / want));
        }
    }
    tally
}

fn timed<F: Reciprocal>() -> Time {
    fn batch<R: Real>(pack: impl Fn(usize) -> R) -> Vec<R> {
        (0..64).map(pack).collect()
    }
    #[inline(never)]
    fn run<F: Reciprocal, R: Estimate>(numbers: &[R]) -> usize {
        const PASSES: usize = 64;
        for _ in 0..PASSES {
            for &x in black_box(numbers) {
                black_box(F::of(x));
            }
        }
        PASSES * numbers.len()
    }
    let number = |k: usize| 1.0 + k as f64 / 64.0;
    let (eights, ones, doubles) =
        (batch(|k| F32x8::from_fn(|i| number(k + i) as f32)), batch(|k| number(k) as f32), batch(number));
    time([&mut || run::<F, _>(&eights), &mut || run::<F, _>(&ones), &mut || run::<F, _>(&doubles)])
}
