//! Nanoseconds of each ray/triangle test: a ray at eight triangles, one at one, and that in `f64`. Then, once, the
//! error of each test and the number of rays it loses, from the same code as `vitrum price --formulas --of triangle`.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use vitrum::geometry::triangle_test::{Lanes, TriangleModel, TriangleTest, TriangleVisitor};
use vitrum::math::Vector3;
use vitrum::simd::{F32x8, Vec3x8};
use vitrum::study::formulas::{FormulaKind, FormulaPlan, measure, text};

/// Pairs in a batch: few enough for the nearest cache, and a multiple of eight.
const PAIRS: usize = 64;

/// Rays, and triangles that every other one of them meets.
fn pairs() -> Vec<(Vec3, Vec3, [Vec3; 3])> {
    let mut state = 7_u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    let mut point = || Vec3::new(next(), next(), next());
    (0..PAIRS)
        .map(|_| {
            let corners = [point(), point(), point()];
            let origin = point() * 3.0;
            let aside = if point().x > 0.0 { Vec3::ZERO } else { point() * 2.0 };
            (origin, (corners[0] + corners[1] + corners[2]) / 3.0 + aside - origin, corners)
        })
        .collect()
}

/// A ray made ready for a test, and the corners of a triangle.
type Pair<T, R> = (<T as TriangleTest>::Ray<R>, [Vector3<R>; 3]);

fn time<T: TriangleTest, R: Lanes>(c: &mut Criterion, name: &str, width: &str, pairs: &[Pair<T, R>]) {
    let mut group = c.benchmark_group(format!("triangle/{name}"));
    group.throughput(Throughput::Elements((pairs.len() * R::COUNT) as u64));
    group.bench_function(width, |b| {
        b.iter(|| {
            for (ray, corners) in black_box(pairs) {
                let met = T::meet(ray, corners);
                black_box((met.hit, met.t, met.u, met.v));
            }
        });
    });
    group.finish();
}

fn test<T: TriangleTest>(c: &mut Criterion, name: &str) {
    let pairs = pairs();
    let eights: Vec<_> = pairs
        .as_chunks::<8>()
        .0
        .iter()
        .map(|eight| {
            let mut corners = [Vec3x8::splat(Vec3::ZERO); 3];
            for (lane, (_, _, three)) in eight.iter().enumerate() {
                for (corner, &point) in corners.iter_mut().zip(three) {
                    corner.set_lane(lane, point);
                }
            }
            (T::prepare::<F32x8>(Vec3x8::splat(eight[0].0), Vec3x8::splat(eight[0].1)), corners)
        })
        .collect();
    time::<T, F32x8>(c, name, "f32x8", &eights);
    let ones: Vec<_> =
        pairs.iter().map(|&(o, d, c)| (T::prepare::<f32>(o.into(), d.into()), c.map(Vector3::from))).collect();
    time::<T, f32>(c, name, "f32", &ones);
    let wide = |p: Vec3| Vector3::from(p.as_dvec3());
    let doubles: Vec<_> = pairs.iter().map(|&(o, d, c)| (T::prepare::<f64>(wide(o), wide(d)), c.map(wide))).collect();
    time::<T, f64>(c, name, "f64", &doubles);
}

fn triangles(c: &mut Criterion) {
    struct Of<'a>(&'a mut Criterion, &'static str);
    impl TriangleVisitor for Of<'_> {
        type Output = ();
        fn visit<T: TriangleTest>(self, _test: T) {
            test::<T>(self.0, self.1);
        }
    }
    for model in TriangleModel::ALL {
        model.dispatch(Of(c, model.name()));
    }
    let plan = FormulaPlan { count: 2000, time: false, kinds: vec![FormulaKind::Triangle] };
    println!("{}", text(&measure(&plan, || true).expect("nobody interrupts a benchmark")));
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(30)
        .warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_millis(700));
    targets = triangles
}
criterion_main!(benches);
