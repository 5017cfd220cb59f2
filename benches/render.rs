//! Whole pictures: scenes of `scenes/`, small, by the native path; rays of all kinds a second.

use std::path::Path;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use vitrum::accel::{Accel, Backend, BuildOptions};
use vitrum::load::{self, LoadOptions, Loaded};
use vitrum::render::{Observer, Options, render};

/// Glass and mirrors in a room; one vessel of many triangles; water, where light goes straight through to the floor.
const SCENES: [&str; 3] = ["glass", "goblet", "pool"];

/// Columns and rows.
const SIZE: (u32, u32) = (160, 120);

fn renders(c: &mut Criterion) {
    let all = std::thread::available_parallelism().map_or(1, usize::from);
    let mut group = c.benchmark_group("render");
    for name in SCENES {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("toml");
        let Loaded { mut scene, .. } = load::scene(&path, &LoadOptions::default()).expect("the scene loads");
        (scene.settings.width, scene.settings.height) = SIZE;
        scene.settings.samples = 1;
        let accel = Accel::build(Backend::Native, &scene.geometry, BuildOptions::default()).expect("there is memory");
        for threads in if all > 1 { vec![1, all] } else { vec![1] } {
            let options = Options { threads, ..Options::default() };
            let picture = || render(&scene, &accel, &options, &Observer::default()).expect("the scene renders");
            group.throughput(Throughput::Elements(picture().rays.total()));
            group.bench_function(format!("{name}/{threads}"), |b| b.iter(picture));
        }
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(2));
    targets = renders
}
criterion_main!(benches);
