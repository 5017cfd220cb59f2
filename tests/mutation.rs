//! Thousands of files and command lines with faults, the same in every run. No panic may occur, an error is one line,
//! accepted input is a valid scene, and none of it takes much memory or time.
//!
//! `VITRUM_FUZZ=1e7 cargo test --release --test mutation` runs ten million files (shared out among the kinds) and ten
//! thousand command lines; `VITRUM_FUZZ_SEED` makes them others.

#![allow(unsafe_code, reason = "an allocator that counts is an unsafe trait")]

#[path = "fuzz/command.rs"]
mod command;
#[path = "fuzz/entry.rs"]
mod entry;
#[path = "support/gltf.rs"]
mod gltf;
#[path = "fuzz/models.rs"]
mod models;
#[path = "fuzz/mutate.rs"]
mod mutate;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use command::Ending;
use entry::Kind;
use mutate::{Random, WORDS, mutated};

/// The system's allocator, with the bytes that each thread holds.
struct Counting;

thread_local! {
    static HELD: Cell<isize> = const { Cell::new(0) };
    static MOST: Cell<isize> = const { Cell::new(0) };
}

/// The largest single block that any thread asked for.
static LARGEST: AtomicUsize = AtomicUsize::new(0);

fn count(bytes: isize) {
    HELD.set(HELD.get() + bytes);
    MOST.set(MOST.get().max(HELD.get()));
}

// SAFETY: every call goes to the system's allocator as it came; counting touches no memory but two cells and a number.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        LARGEST.fetch_max(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        LARGEST.fetch_max(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        count(new_size as isize - layout.size() as isize);
        LARGEST.fetch_max(new_size, Ordering::Relaxed);
        // SAFETY: the caller's promise.
        unsafe { System.realloc(block, layout, new_size) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Bytes that one file of at most 64 KiB may make the loader hold, under the limits of `entry::load`.
const MOST_HELD: isize = 64 << 20;

/// Time limit for a file of at most 64 KiB, on any machine and in any build; beyond it some loop does not end.
const ENDLESS: Duration = Duration::from_secs(60);

/// Returns the number of files of a kind: `plain` in a plain run, `share` of the long run.
fn executions(plain: usize, share: f64) -> usize {
    let wanted = std::env::var("VITRUM_FUZZ").ok().map(|n| n.parse::<f64>().expect("VITRUM_FUZZ is a number"));
    wanted.map_or(plain, |n| (n * share) as usize)
}

fn random() -> Random {
    let seed = std::env::var("VITRUM_FUZZ_SEED").ok().map(|n| n.parse().expect("VITRUM_FUZZ_SEED is a number"));
    Random::new(seed.unwrap_or(1))
}

/// Loads the seeds cut off at every byte, and `count` mutants of them.
fn attack(kind: Kind, seeds: &[Vec<u8>], count: usize) {
    let mut random = random();
    let (mut accepted, mut held, mut slowest) = (0_usize, 0, Duration::ZERO);
    // The first call makes the folder, which is no part of any file's memory.
    entry::load(kind, &seeds[0]);
    let cuts = seeds.iter().flat_map(|seed| {
        let step = seed.len().div_ceil(2000).max(1);
        (0..=seed.len()).step_by(step).map(|n| seed[..n].to_vec())
    });
    let mutants = (0..count).map(|_| {
        let (seed, donor) = (random.below(seeds.len()), random.below(seeds.len()));
        mutated(&seeds[seed], &seeds[donor], &mut random)
    });
    let mut tried = 0_usize;
    for bytes in cuts.chain(mutants) {
        tried += 1;
        let before = HELD.get();
        MOST.set(before);
        let start = Instant::now();
        let loaded = catch_unwind(AssertUnwindSafe(|| entry::load(kind, &bytes)));
        let (mut took, most) = (start.elapsed(), MOST.get() - before);
        if loaded.is_ok() && took > ENDLESS {
            // Or the machine was asleep: then it ends in good time when asked again.
            let again = Instant::now();
            entry::load(kind, &bytes);
            took = again.elapsed();
        }
        if loaded.is_err() || took > ENDLESS || most > MOST_HELD {
            let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("found-{kind:?}"));
            fs::write(&kept, &bytes).unwrap();
            panic!("{}: took {took:?}, held {most} bytes, or see above; it reads\n{}", kept.display(), shown(&bytes));
        }
        accepted += usize::from(loaded.unwrap());
        held = held.max(most);
        slowest = slowest.max(took);
    }
    println!(
        "{kind:?}: {tried} files, {accepted} accepted; at most {held} bytes held, slowest {slowest:?}; largest block of any \
         thread {}",
        LARGEST.load(Ordering::Relaxed)
    );
    // A harness whose every input is refused at the door tests nothing.
    assert!(accepted * 200 > tried, "only {accepted} of {tried} were accepted");
}

fn shown(bytes: &[u8]) -> String {
    String::from_utf8_lossy(&bytes[..bytes.len().min(4000)]).into_owned()
}

fn seeds(kind: Kind) -> Vec<Vec<u8>> {
    entry::seeds(kind).into_values().collect()
}

#[test]
fn broken_scene_files_are_survived() {
    attack(Kind::Scene, &seeds(Kind::Scene), executions(3000, 0.1));
}

#[test]
fn broken_models_are_survived() {
    attack(Kind::Model, &seeds(Kind::Model), executions(6000, 0.3));
}

#[test]
fn broken_gltf_models_are_survived() {
    let seeds = [gltf::rich().text().into_bytes(), gltf::rich().binary()];
    for seed in &seeds {
        attack(Kind::Gltf, std::slice::from_ref(seed), executions(4000, 0.1));
    }
}

#[test]
fn broken_ply_models_are_survived() {
    attack(Kind::Ply, &models::ply(), executions(4000, 0.1));
}

#[test]
fn broken_stl_models_are_survived() {
    attack(Kind::Stl, &models::stl(), executions(4000, 0.1));
}

#[test]
fn broken_materials_are_survived() {
    attack(Kind::Material, &seeds(Kind::Material), executions(6000, 0.3));
}

#[test]
fn broken_pictures_are_survived() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let image = image::Rgb32FImage::from_fn(9, 7, |x, y| image::Rgb([x as f32 / 9.0, y as f32 / 7.0, 0.5]));
    image.save(at("a.hdr")).unwrap();
    let bytes = image::DynamicImage::from(image).into_rgb8();
    bytes.save(at("a.png")).unwrap();
    bytes.save(at("a.jpg")).unwrap();
    exr::prelude::write_rgb_file(at("a.exr"), 9, 7, |x, y| (x as f32, y as f32, 0.5f32)).unwrap();
    let mut pfm = b"PF\n3 2\n-1.0\n".to_vec();
    pfm.extend((0..18).flat_map(|i| (i as f32).to_le_bytes()));
    fs::write(at("a.pfm"), pfm).unwrap();
    let files = ["a.png", "a.jpg", "a.hdr", "a.exr", "a.pfm"].map(|name| fs::read(at(name)).unwrap());
    for file in &files {
        attack(Kind::Picture, std::slice::from_ref(file), executions(2000, 0.3 / 5.0));
    }
}

#[test]
fn what_was_found_once_is_survived_still() {
    let mut count = 0;
    for file in fs::read_dir(entry::data().join("found")).unwrap() {
        let path = file.unwrap().path();
        let kind = match path.extension().and_then(|e| e.to_str()) {
            Some("toml") => Kind::Scene,
            Some("obj") => Kind::Model,
            Some("mtl") => Kind::Material,
            Some("gltf") => Kind::Gltf,
            Some("ply") => Kind::Ply,
            Some("stl") => Kind::Stl,
            _ => Kind::Picture,
        };
        entry::load(kind, &fs::read(&path).unwrap());
        count += 1;
    }
    assert!(count > 0);
}

/// Command lines that work, to begin with.
const LINES: [&str; 16] = [
    "render sampler.toml",
    "render sampler.toml -o a.png --bits 16 --width 8 --height 8 --threads 1",
    "render house.obj -o a.exr --width 16 --height 9 --samples 2 --depth 3 --cutoff 0.5",
    "render sampler.toml -o a.pfm --exposure -2 --fresnel schlick --shadows opaque --tile 8",
    "render sampler.toml --backend reference --width 4 --height 4 --samples 1 -q",
    "render house.obj --json --quiet --output a.hdr",
    "render house.obj --fresnel off --shadows straight -o /dev/null",
    "compare checks.pfm checks.pfm",
    "compare checks.pfm checks.pfm --tolerance 0.1 --allow-share 0.5 --json",
    "compare checks.pfm checks.pfm --diff d.png --diff-scale 2 --linear",
    "parity sampler.toml --rays 10 --width 4 --height 4 --threads 1",
    "verify house.obj --group leaks --threads 1 --json",
    "bench house.obj --threads 1 --rounds 1 --builds 1 --size 8 --rays primary --one-in 4",
    "doctor --json",
    "--help",
    "--version",
];

/// Options that a render takes, each with values that are fine and values at or beyond its ends. Sizes are small or
/// absurd: what lies between would only take long.
const OPTIONS: [(&str, &[&str]); 17] = [
    ("--width", &["1", "5", "16", "65536", "65537", "0", "1e3"]),
    ("--height", &["1", "3", "16", "0", "-1", "4294967297"]),
    ("--samples", &["1", "2", "0", "1025", "nan"]),
    ("--depth", &["0", "1", "8", "4096", "4097", "-1"]),
    ("--cutoff", &["0", "1", "0.01", "1e-45", "nan", "2"]),
    ("--exposure", &["0", "-64", "64", "3.5", "inf", "65"]),
    ("--bits", &["8", "16", "12"]),
    ("--fresnel", &["exact", "schlick", "off", "none"]),
    ("--shadows", &["opaque", "straight", "soft"]),
    ("--backend", &["native", "reference", "embree-slow"]),
    ("--threads", &["1", "2", "1024", "1025", "0"]),
    ("--tile", &["1", "7", "1024", "0"]),
    (
        "-o",
        &["a.png", "b.exr", "c.pfm", "d.hdr", "/dev/null", "/dev/full", "missing/a.png", "a.gif", "sampler.toml", "."],
    ),
    ("--strict", &[]),
    ("--json", &[]),
    ("-q", &[]),
    ("--help", &[]),
];

/// A render with any options.
fn made_up_line(random: &mut Random) -> Vec<String> {
    let scene = *random.one_of(&["sampler.toml", "house.obj", "house.mtl", "missing.toml"]);
    let mut line = vec![String::from("render"), scene.to_owned()];
    let mut options: Vec<usize> = (0..OPTIONS.len() - 1).collect();
    for _ in 0..random.below(6) {
        let (name, values) = OPTIONS[options.swap_remove(random.below(options.len()))];
        line.push(name.to_owned());
        if !values.is_empty() {
            // The fine ones come first, and more often.
            let at = random.below(values.len()).min(random.below(values.len()));
            line.push(values[at].to_owned());
        }
    }
    line
}

/// A few words out, in, twice, swapped, or broken.
fn break_line(line: &mut Vec<String>, random: &mut Random) {
    for _ in 0..=random.below(2) {
        let at = random.below(line.len());
        match random.below(7) {
            0 if line.len() > 1 => drop(line.remove(at)),
            1 => line.insert(at, line[random.below(line.len())].clone()),
            2 => {
                let other = random.below(line.len());
                line.swap(at, other);
            }
            3 => (*random.one_of(&WORDS)).clone_into(&mut line[at]),
            4 => {
                let (name, values) = *random.one_of(&OPTIONS);
                line.push(name.to_owned());
                line.extend(values.first().map(|v| (*v).to_owned()));
            }
            5 => {
                let bytes = mutated(line[at].as_bytes(), b"--", random);
                line[at] = String::from_utf8_lossy(&bytes[..bytes.len().min(200)]).into_owned();
            }
            _ => {
                let donor: Vec<&str> = random.one_of(&LINES).split(' ').collect();
                let from = random.below(donor.len());
                line.splice(at..at, donor[from..].iter().take(2).map(|&w| w.to_owned()));
            }
        }
    }
}

#[cfg(unix)]
#[test]
fn broken_command_lines_are_survived() {
    let program: PathBuf = assert_cmd::cargo::cargo_bin("vitrum");
    let count = executions(80, 1e-3);
    let mut random = random();
    let mut ended = [0_usize; 6];
    for line in LINES {
        let words: Vec<String> = line.split(' ').map(str::to_owned).collect();
        assert_eq!(command::run(&program, &words, 60), Ending::Code(0), "{line}");
    }
    for _ in 0..count {
        let mut line = if random.below(2) == 0 {
            made_up_line(&mut random)
        } else {
            random.one_of(&LINES).split(' ').map(str::to_owned).collect()
        };
        if random.below(4) != 0 {
            break_line(&mut line, &mut random);
        }
        match command::run(&program, &line, 5) {
            Ending::Code(code) => ended[code as usize] += 1,
            Ending::CutOff => ended[5] += 1,
        }
    }
    println!("command lines: {count}; with exit code 0, 1, 2, 3, 4, and cut off: {ended:?}");
    assert!(ended[0] * 20 > count && ended[5] * 10 < count, "{ended:?}");
}
