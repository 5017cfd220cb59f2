//! Rays a second by kind of ray and kernel.

mod support;

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use support::RaySet;
use vitrum::accel::Intersector;
use vitrum::accel::native::{Kernel, Native, Scratch};
use vitrum::geometry::Hit8;
use vitrum::simd::Mask8;

fn trace(native: &Native, kernel: Kernel, set: &RaySet, hits: &mut [Hit8], blocked: &mut [Mask8], stack: &mut Scratch) {
    if set.any_hit {
        native.occluded_with(kernel, black_box(&set.rays), blocked, set.coherence, stack);
    } else {
        native.closest_with(kernel, black_box(&set.rays), hits, set.coherence, stack);
    }
}

fn traversal(c: &mut Criterion) {
    for model in support::models() {
        let native = Native::build(&model.geometry);
        let stats = native.build_stats();
        eprintln!(
            "{}: {} triangles, {:.1} B/triangle, {} nodes, {} leaves, depth {}",
            model.name,
            stats.triangles,
            stats.bytes as f64 / stats.triangles as f64,
            stats.nodes,
            stats.leaves,
            stats.depth
        );
        let mut group = c.benchmark_group(&model.name);
        for set in support::ray_sets(&model, &native) {
            let mut hits = vec![Hit8::default(); set.rays.len()];
            let mut blocked = vec![Mask8::NONE; set.rays.len()];
            let mut stack = Scratch::default();
            group.throughput(Throughput::Elements(set.len() as u64));
            for kernel in [Kernel::Single, Kernel::Packet] {
                group.bench_function(format!("{}/{kernel:?}", set.name), |b| {
                    b.iter(|| trace(&native, kernel, &set, &mut hits, &mut blocked, &mut stack));
                });
            }
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).warm_up_time(std::time::Duration::from_millis(200));
    targets = traversal
}
criterion_main!(benches);
