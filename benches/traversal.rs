//! Rays a second by kind of ray, back end and mode: the rays and the contenders of `vitrum bench`, timed by criterion.
//!
//! Ratios are best taken from `vitrum bench`, whose contenders take turns; this one compares a contender with itself
//! as of an earlier run.

mod support;

use std::sync::atomic::{AtomicBool, AtomicU64};
use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use vitrum::accel::{BuildQuality, embree};
use vitrum::trial::agree::{Disagreement, Judge};
use vitrum::trial::run::{Built, check};
use vitrum::trial::team::Team;
use vitrum::trial::{Picture, View, Watch, rays};

/// 65,536 camera rays.
const PICTURE: Picture = Picture { edge: 1024, one_in: 16 };

fn traversal(c: &mut Criterion) {
    let embree = embree::installed();
    if let Err(e) = &embree {
        eprintln!("EMBREE IS LEFT OUT: {e}");
    }
    let team = Team::new(1).expect("a thread can be started");
    let (done, stop) = (AtomicU64::new(0), AtomicBool::new(false));
    for model in support::models() {
        let built = Built::new(&model.geometry, &team, embree.is_ok(), BuildQuality::Default)
            .expect("what was found can be built with");
        let sets = rays::all(built.native(), &model.geometry, &View::of(&rays::bounds(&model.geometry)), &PICTURE);
        let judge = Judge::new(&model.geometry);
        let mut contenders = built.contenders();
        let mut group = c.benchmark_group(&model.name);
        for set in &sets {
            let watch = Watch { done: &done, stop: &stop };
            let findings = check(&mut contenders, set, &team, &judge, &watch).expect("nobody interrupts");
            assert!(!findings.iter().any(Disagreement::refuses), "the contenders do not find the same: {findings:?}");
            group.throughput(Throughput::Elements(set.count as u64));
            for contender in &mut contenders {
                let label = contender.label();
                group.bench_function(
                    format!("{}/{}/{}", set.kind.name(), label.backend.mode_name(), label.mode.name()),
                    |b| {
                        b.iter_custom(|n| {
                            let mut time = Duration::ZERO;
                            for _ in 0..n {
                                contender.prepare(set);
                                let start = Instant::now();
                                contender.trace(set, &team);
                                time += start.elapsed();
                            }
                            time
                        });
                    },
                );
            }
        }
        group.finish();
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(1));
    targets = traversal
}
criterion_main!(benches);
