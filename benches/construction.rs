//! Time to build, by mesh and number of threads.

mod support;

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use vitrum::accel::native::Native;

fn construction(c: &mut Criterion) {
    let all = std::thread::available_parallelism().map_or(1, usize::from);
    for model in support::models() {
        let mut group = c.benchmark_group(&model.name);
        group.throughput(Throughput::Elements(model.mesh().triangles.len() as u64));
        for threads in if all > 1 { vec![1, all] } else { vec![1] } {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
            group.bench_function(format!("build/{threads}"), |b| {
                b.iter(|| pool.install(|| Native::build(black_box(&model.geometry))));
            });
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = construction
}
criterion_main!(benches);
