//! Nanoseconds of each optics formula: eight lanes, one lane, and `f64`. Each iteration is the same batch
//! of rays, of every angle into and out of glass; the elements per second that criterion prints count rays. Then, once,
//! how far off the formulas are, as `vitrum price --formulas` has it.

use std::hint::black_box;

use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime};
use vitrum::math::{Real, Vector3};
use vitrum::optics::{
    AtNormal, Bec, Boundary, Exact, FresnelFormula, Heckbert, Oliveira, Polarised, RefractionFormula, Schlick,
    SlidesVector, Stable, StraightThrough, Trigonometric, below_surface, conductor_exact, conductor_schlick,
    consistent_normal, polarised, polarised_as_printed, reflect, transmittance,
};
use vitrum::simd::F32x8;

/// Rays in a batch: few enough for the nearest cache, and a multiple of eight.
const RAYS: usize = 64;

/// One ray, or eight, at a boundary.
#[derive(Clone, Copy)]
struct Ray<R> {
    incident: Vector3<R>,
    normal: Vector3<R>,
    shading: Vector3<R>,
    boundary: Boundary<R>,
}

/// Rays spread evenly over all cosines, into glass and out of it by turns.
fn rays() -> Vec<Ray<f64>> {
    (0..RAYS)
        .map(|k| {
            let cosine = (k as f64 + 0.5) / RAYS as f64;
            let sine = (1.0 - cosine * cosine).sqrt();
            let turn = 2.399_963 * k as f64;
            let normal = Vector3::new(0.36, 0.48, 0.8);
            let across = normal.cross(Vector3::new(turn.cos(), turn.sin(), 0.3)).normalized();
            let (n1, n2) = if k % 2 == 0 { (1.0, 1.5) } else { (1.5, 1.0) };
            Ray {
                incident: across * sine - normal * cosine,
                normal,
                shading: (normal + across * 0.1).normalized(),
                boundary: Boundary::new(n1, n2),
            }
        })
        .collect()
}

/// The same rays in other lanes: `WIDTH` of them at a time.
fn packed<R: Real, const WIDTH: usize>(pack: impl Fn([f64; WIDTH]) -> R) -> Vec<Ray<R>> {
    rays()
        .as_chunks::<WIDTH>()
        .0
        .iter()
        .map(|chunk| {
            let number = |f: &dyn Fn(&Ray<f64>) -> f64| pack(chunk.each_ref().map(f));
            let vector = |f: &dyn Fn(&Ray<f64>) -> Vector3<f64>| {
                Vector3::new(number(&|r| f(r).x), number(&|r| f(r).y), number(&|r| f(r).z))
            };
            Ray {
                incident: vector(&|r| r.incident),
                normal: vector(&|r| r.normal),
                shading: vector(&|r| r.shading),
                boundary: Boundary {
                    eta: number(&|r| r.boundary.eta),
                    kc: number(&|r| r.boundary.kc),
                    // What the boundary's own constructor keeps of it in f32.
                    kc_low: number(&|r| r.boundary.kc - f64::from(r.boundary.kc as f32)),
                    r0: number(&|r| r.boundary.r0),
                },
            }
        })
        .collect()
}

/// A formula that can be timed in every number type.
trait Timed: Copy {
    fn run<R: Real>(self, ray: &Ray<R>) -> Vector3<R>;
}

/// A refracted direction from nothing but the ray: cosine, square root and all.
#[derive(Clone, Copy)]
struct Refract<F>(F);

impl<F: RefractionFormula> Timed for Refract<F> {
    #[inline(always)]
    fn run<R: Real>(self, ray: &Ray<R>) -> Vector3<R> {
        let at = ray.boundary.cross(-ray.incident.dot(ray.normal));
        let t = self.0.refract(&ray.boundary, ray.incident, ray.normal, &at);
        Vector3::select(t.total, ray.incident, t.direction)
    }
}

/// Refraction and reflectance together, as a shading stage needs them.
#[derive(Clone, Copy)]
struct RefractAndReflect<F, G>(F, G);

impl<F: RefractionFormula, G: FresnelFormula> Timed for RefractAndReflect<F, G> {
    #[inline(always)]
    fn run<R: Real>(self, ray: &Ray<R>) -> Vector3<R> {
        let at = ray.boundary.cross(-ray.incident.dot(ray.normal));
        let t = self.0.refract(&ray.boundary, ray.incident, ray.normal, &at);
        Vector3::select(t.total, ray.incident, t.direction * G::dielectric(&ray.boundary, &at))
    }
}

#[derive(Clone, Copy)]
struct Fresnel<F>(F);

impl<F: FresnelFormula> Timed for Fresnel<F> {
    #[inline(always)]
    fn run<R: Real>(self, ray: &Ray<R>) -> Vector3<R> {
        let at = ray.boundary.cross(-ray.incident.dot(ray.normal));
        Vector3::all(F::dielectric(&ray.boundary, &at))
    }
}

/// The rest, by name.
#[derive(Clone, Copy)]
enum Other {
    Reflect,
    Polarised,
    AsPrinted,
    ConductorExact,
    ConductorSchlick,
    Transmittance,
    ConsistentNormal,
    BelowSurface,
}

#[derive(Clone, Copy)]
struct Kind<const KIND: u8>;

impl<const KIND: u8> Timed for Kind<KIND> {
    #[inline(always)]
    fn run<R: Real>(self, ray: &Ray<R>) -> Vector3<R> {
        let cos = -ray.incident.dot(ray.normal);
        let pair = |r: Polarised<R>| Vector3::new(r.s, r.p, cos);
        if KIND == Other::Reflect as u8 {
            reflect(ray.incident, ray.normal)
        } else if KIND == Other::Polarised as u8 {
            pair(polarised(&ray.boundary, &ray.boundary.cross(cos)))
        } else if KIND == Other::AsPrinted as u8 {
            pair(polarised_as_printed(&ray.boundary, &ray.boundary.cross(cos)))
        } else if KIND == Other::ConductorExact as u8 {
            Vector3::all(conductor_exact(cos, ray.boundary.eta, R::splat(3.15)))
        } else if KIND == Other::ConductorSchlick as u8 {
            Vector3::all(conductor_schlick(cos, ray.boundary.eta, R::splat(3.15)))
        } else if KIND == Other::Transmittance as u8 {
            transmittance(ray.normal, cos)
        } else if KIND == Other::ConsistentNormal as u8 {
            consistent_normal(ray.incident, ray.normal, ray.shading)
        } else {
            below_surface(ray.incident, ray.normal)
        }
    }
}

fn time<R: Real>(group: &mut BenchmarkGroup<'_, WallTime>, width: &str, rays: &[Ray<R>], formula: impl Timed) {
    group.bench_function(width, |b| {
        b.iter(|| {
            for ray in black_box(rays) {
                black_box(formula.run(ray));
            }
        });
    });
}

fn formula(c: &mut Criterion, name: &str, formula: impl Timed) {
    let mut group = c.benchmark_group(name);
    group.throughput(Throughput::Elements(RAYS as u64));
    time(&mut group, "f32x8", &packed(|lanes: [f64; 8]| F32x8::new(lanes.map(|x| x as f32))), formula);
    time(&mut group, "f32", &packed(|[x]: [f64; 1]| x as f32), formula);
    time(&mut group, "f64", &rays(), formula);
    group.finish();
}

fn refraction(c: &mut Criterion) {
    formula(c, "refract/straight-through", Refract(StraightThrough));
    formula(c, "refract/oliveira", Refract(Oliveira::WATER));
    formula(c, "refract/bec", Refract(Bec));
    formula(c, "refract/heckbert", Refract(Heckbert));
    formula(c, "refract/slides", Refract(SlidesVector));
    formula(c, "refract/trigonometric", Refract(Trigonometric));
    formula(c, "refract/stable", Refract(Stable));
    formula(c, "refract+fresnel/heckbert+schlick", RefractAndReflect(Heckbert, Schlick));
    formula(c, "refract+fresnel/heckbert+exact", RefractAndReflect(Heckbert, Exact));
    formula(c, "refract+fresnel/stable+schlick", RefractAndReflect(Stable, Schlick));
    formula(c, "refract+fresnel/stable+exact", RefractAndReflect(Stable, Exact));
}

fn fresnel(c: &mut Criterion) {
    formula(c, "fresnel/off", Fresnel(AtNormal));
    formula(c, "fresnel/schlick", Fresnel(Schlick));
    formula(c, "fresnel/exact", Fresnel(Exact));
    formula(c, "fresnel/polarised", Kind::<{ Other::Polarised as u8 }>);
    formula(c, "fresnel/as-printed", Kind::<{ Other::AsPrinted as u8 }>);
    formula(c, "fresnel/conductor-exact", Kind::<{ Other::ConductorExact as u8 }>);
    formula(c, "fresnel/conductor-schlick", Kind::<{ Other::ConductorSchlick as u8 }>);
}

fn directions(c: &mut Criterion) {
    formula(c, "reflect", Kind::<{ Other::Reflect as u8 }>);
    formula(c, "consistent-normal", Kind::<{ Other::ConsistentNormal as u8 }>);
    formula(c, "below-surface", Kind::<{ Other::BelowSurface as u8 }>);
    formula(c, "transmittance", Kind::<{ Other::Transmittance as u8 }>);
}

/// Errors of the formulas, printed beside their times.
fn errors(_: &mut Criterion) {
    use vitrum::study::formulas::{FormulaKind, FormulaPlan, measure, text};
    let kinds = vec![FormulaKind::Refraction, FormulaKind::Fresnel, FormulaKind::Reflection, FormulaKind::Reciprocal];
    let plan = FormulaPlan { count: 20_000, time: false, kinds };
    println!("{}", text(&measure(&plan, || true).expect("nobody interrupts a benchmark")));
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(30)
        .warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_millis(700));
    targets = refraction, fresnel, directions, errors
}
criterion_main!(benches);
