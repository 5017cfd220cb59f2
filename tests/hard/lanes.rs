//! Eight lanes: who is active, what the others hold, and which way each goes changes nothing for the rest.

use glam::Vec3;
use vitrum::accel::{Coherence, Intersector};
use vitrum::geometry::{GeometryMask, Hit, Hit8, Ray, Ray8};
use vitrum::render::{Options, RayKind};
use vitrum::scene::Rgb;
use vitrum::simd::Mask8;

use crate::support::aim::count;
use crate::support::kernels::{Held, KERNELS, sound};
use crate::support::{Rng, contract, scenes, shapes};

/// LN-01, LN-02, LN-03, LN-05: all 255 sets of active lanes, rays of one octant or of all eight. The other lanes are
/// poisoned with NaN, infinities, zero or denormals. Active lanes have the bits of the ray alone, and no byte of the
/// other lanes' results changes.
#[test]
fn any_set_of_lanes_in_any_octants_beside_any_poison_gives_the_bits_of_each_ray_alone() {
    let mut rng = Rng::new(91);
    let geometry = [
        shapes::masked(shapes::soup(200, 0.5, &mut rng), GeometryMask::OPAQUE),
        shapes::ball(Vec3::new(0.3, 0.2, -0.1), 0.4, GeometryMask::OPAQUE),
        shapes::masked(shapes::cuboid(Vec3::splat(-1.5), Vec3::splat(1.5)), GeometryMask::OPAQUE),
    ];
    let native = sound(&geometry);
    let into = |octant: usize, rng: &mut Rng| {
        let dir = rng.direction().abs() + 0.05;
        let sign = |k: usize| if octant >> k & 1 == 0 { 1.0 } else { -1.0 };
        Ray::new(rng.point() * 0.8, dir * Vec3::new(sign(0), sign(1), sign(2)))
    };
    // Octants 0 to 7 for all lanes alike; then each lane its own.
    let crowds: Vec<Vec<Ray>> =
        (0..9).map(|o| (0..8).map(|lane| into(if o < 8 { o } else { lane }, &mut rng)).collect()).collect();
    let poisons = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, 1e-45];
    let mark = Hit { t: -7.5, u: f32::NAN, v: 3.0, instance: 9, geometry: 77, primitive: 78 };
    for kernel in KERNELS {
        let held = Held(native.clone(), kernel);
        let mut scratch = Default::default();
        for rays in &crowds {
            let alone: Vec<Hit> = rays.iter().map(|r| contract::closest(&held, std::slice::from_ref(r))[0]).collect();
            assert!(alone.iter().all(Hit::is_hit), "from within a box everything hits");
            for active in 1..=u8::MAX {
                for poison in poisons {
                    let mut packet = Ray8::pack(rays)[0];
                    packet.active = active;
                    let mut hits = [Hit8::default()];
                    for i in 0..8 {
                        hits[0].set_lane(i, &mark);
                        if active >> i & 1 == 0 {
                            packet.origin.set_lane(i, Vec3::splat(poison));
                            packet.dir.set_lane(i, Vec3::splat(poison));
                            packet.t_min.set_lane(i, poison);
                            packet.t_max.set_lane(i, poison);
                        }
                    }
                    let mut blocked = [Mask8::ALL];
                    held.closest(&[packet], &mut hits, Coherence::Coherent, &mut scratch);
                    held.occluded(&[packet], &mut blocked, Coherence::Coherent, &mut scratch);
                    assert_eq!(blocked[0].bits(), active, "{kernel:?} {poison}");
                    for (i, alone) in alone.iter().enumerate() {
                        let want = if active >> i & 1 == 0 { &mark } else { alone };
                        let got = hits[0].lane(i);
                        assert_eq!(contract::bits(&got), contract::bits(want), "{kernel:?} {active:08b} {i} {poison}");
                    }
                }
            }
        }
    }
}

/// LN-12: rays are neither lost nor doubled. With nothing cut, each ray that enters glass of the room's index leaves
/// it, and in a hall where every ray is divided in two, each hit sends two.
#[test]
fn no_ray_is_lost_or_doubled_between_the_queues() {
    let mut scene = scenes::empty(1.0);
    (scene.settings.width, scene.settings.height) = (64, 64 * count(1).isqrt() as u32);
    let crown = scenes::glass(&mut scene, 1.5, 0, Rgb::ZERO);
    for k in 0..7 {
        let at = Vec3::new(0.35 * k as f32 - 1.0, 0.3 * (k % 3) as f32 - 0.3, -0.4 * (k % 2) as f32);
        scenes::sphere(&mut scene, at, 0.15, crown);
    }
    (scene.settings.max_depth, scene.settings.cutoff) = (10, 0.0);
    let outcome = scenes::native(&scene, &Options::default());
    // A ball has no total reflection for what entered it: every meeting sends one ray each way.
    for depth in 1..=10 {
        let row = outcome.rays.by_depth[depth];
        assert_eq!(row[RayKind::Reflected as usize], row[RayKind::Transmitted as usize], "depth {depth}");
        assert!(row[RayKind::Reflected as usize] > 0);
        let before: u64 = outcome.rays.by_depth[depth - 1].iter().sum();
        assert!(row.iter().sum::<u64>() <= 2 * before);
    }
    let whole = |(a, b): (&[f32; 3], &[f32; 3])| (a[0] + b[0] - 1.0).abs() < 1e-5;
    assert!(outcome.film.pixels.iter().zip(&outcome.truncated.pixels).all(whole));
}

/// LN-11, RB-08: the processor's estimates of reciprocals and roots are good to 12 bits and differ between makers. They
/// are used only in the types by which an experiment requests them; every other quotient is a division.
#[test]
fn no_estimate_of_a_reciprocal_or_root_is_used() {
    fn sources(folder: &std::path::Path, all: &mut Vec<std::path::PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                sources(&path, all);
            } else if path.extension().is_some_and(|e| e == "rs") {
                all.push(path);
            }
        }
    }
    let mut all = Vec::new();
    sources(&std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut all);
    assert!(all.len() > 100);
    for path in all.into_iter().filter(|path| !path.ends_with("simd/reciprocal.rs")) {
        let text = std::fs::read_to_string(&path).unwrap();
        for word in [".recip()", "recip_sqrt", "_mm256_rcp", "_mm256_rsqrt", "_mm_rcp", "_mm_rsqrt"] {
            let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
            let used = code.enumerate().find(|(_, line)| line.contains(word));
            assert!(used.is_none(), "{}: {used:?}", path.display());
        }
    }
}
