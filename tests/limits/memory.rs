//! Every command under limits on memory, over scenes of every loader. Each run ends with its result, or with one line
//! and exit code 4. A run that has enough memory under a limit has it under every higher one.
//!
//! `VITRUM_TEST_SCALE=100 cargo test --features embree --test command limits::memory` makes a thousand runs under
//! `ulimit -v` and a thousand in a control group, instead of ten.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::Output;

use super::{names, scenes, under};
use vitrum::accel::Backend;

/// Commands, with the scene's name to be put in. `OUT` is a picture, `DIR` a folder for a report.
const COMMANDS: [&str; 9] = [
    "render SCENE -q -o OUT --threads 1 --backend native",
    "render SCENE -q -o OUT --threads 1 --backend EMBREE",
    "render SCENE -q -o OUT --threads 4 --backend native",
    "explain SCENE",
    "parity SCENE -q --rays 64 --threads 2",
    "render SCENE -q -o OUT --threads 2 --backend reference",
    "price SCENE -q -o DIR --axes fresnel --limit 1s --size 8x8 --threads 2 --backend native",
    "verify SCENE -q --group leaks --threads 2 --backend native",
    "render SCENE -q -o OUT --threads 2 --backend EMBREE-fast",
];

/// Commands that take as much memory in every run: those on one thread.
const SAME_IN_EVERY_RUN: [usize; 3] = [0, 1, 3];

/// Address space by which other commands may differ from run to run, as threads come to their work in another order.
const SCATTER: u64 = 12 << 20;

/// The name of the back end on Embree, where this build has it and the library is there.
fn embree() -> &'static str {
    match Backend::Embree.availability() {
        Ok(()) => "embree",
        Err(why) => {
            eprintln!("SKIPPED: {why}");
            "native"
        }
    }
}

/// Returns true for a result, false for a limit that is told in one line. Anything else fails.
#[track_caller]
fn sufficed(output: &Output, what: &str) -> bool {
    let said = String::from_utf8_lossy(&output.stderr);
    match output.status.code() {
        Some(0) => true,
        Some(4) => {
            let told = said.starts_with("error: ") && said.lines().count() == 1;
            assert!(told && said.contains("needed, ") && said.contains("left"), "{what}: {said}");
            false
        }
        code => panic!("{what}: exit code {code:?}, signal {:?}: {said}", output.status.signal()),
    }
}

/// Every scene by every command under limits of `least` MiB to 2 GiB. `how` runs one under a limit in bytes.
fn none_is_killed(least: f64, how: impl Fn(&Path, u64, &str) -> Output) {
    let (folder, scenes) = scenes();
    let before = names(folder.path());
    let scale: usize = std::env::var("VITRUM_TEST_SCALE").ok().map_or(1, |n| n.parse().expect("a number"));
    let runs = 10 * scale;
    let embree = embree();
    let mut seen: BTreeMap<(usize, usize), (u64, u64)> = BTreeMap::new();
    let mut refusals = 0;
    for run in 0..runs {
        // Every scene by one command after another: each pair once before one comes again.
        let (scene, command) = (run % scenes.len(), (run + run / scenes.len()) % COMMANDS.len());
        // By equal ratios, spread evenly however many runs there are (a multiple of the golden section).
        let share = (run as f64 * 0.618_033_988_749_895).fract();
        let limit = (least * (2048.0 / least).powf(share) * f64::from(1 << 20)) as u64;
        let line = COMMANDS[command].replace("SCENE", &scenes[scene]).replace("EMBREE", embree);
        let line = line.replace("native-fast", "native");
        let output = how(folder.path(), limit, &line.replace("OUT", "out.pfm").replace("DIR", "out"));
        let (most_refused, least_enough) = seen.entry((scene, command)).or_insert((0, u64::MAX));
        if sufficed(&output, &format!("{line} under {limit} bytes")) {
            *least_enough = limit.min(*least_enough);
        } else {
            refusals += 1;
            *most_refused = limit.max(*most_refused);
        }
        let scatter = if SAME_IN_EVERY_RUN.contains(&command) { 0 } else { SCATTER };
        assert!(
            *most_refused < least_enough.saturating_add(scatter),
            "{line}: {most_refused} bytes did not suffice, {least_enough} did"
        );
        let _ = fs::remove_file(folder.path().join("out.pfm"));
        // A study keeps what it measured.
        let _ = fs::remove_dir_all(folder.path().join("out"));
        assert_eq!(names(folder.path()), before, "{line} under {limit} bytes");
    }
    println!("{runs} runs, {refusals} refused");
    // Ten runs may all lie above their limits.
    assert!(runs < 100 || refusals > 0, "no limit was too low for anything");
}

/// Case IO-21 of the catalogue.
#[test]
fn no_limit_on_address_space_kills_a_command_and_more_never_fails_where_less_sufficed() {
    none_is_killed(50.0, |folder, bytes, line| under(folder, &format!("ulimit -v {}", bytes >> 10), line));
}

/// A control group for memory, where this user may make one.
struct Group {
    folder: PathBuf,
    limit: &'static str,
}

impl Group {
    fn new() -> Option<Self> {
        let groups = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
        for line in groups.lines() {
            let mut parts = line.splitn(3, ':').skip(1);
            let (controllers, path) = (parts.next()?, parts.next()?.trim_end_matches('/'));
            let (root, limit) = match controllers {
                "" => ("/sys/fs/cgroup", "memory.max"),
                "memory" => ("/sys/fs/cgroup/memory", "memory.limit_in_bytes"),
                _ => continue,
            };
            let folder = PathBuf::from(format!("{root}{path}/vitrum-test-{}", std::process::id()));
            if fs::create_dir(&folder).is_ok() {
                let group = Self { folder, limit };
                if group.folder.join(limit).exists() {
                    return Some(group);
                }
            }
        }
        eprintln!("SKIPPED: a control group for memory needs the right to make one");
        None
    }
}

impl Drop for Group {
    fn drop(&mut self) {
        let _ = fs::remove_dir(&self.folder);
    }
}

#[test]
fn no_memory_limit_of_a_control_group_kills_a_command() {
    let Some(group) = Group::new() else { return };
    // Of memory that is mapped only what is written counts.
    none_is_killed(20.0, |folder, bytes, line| {
        fs::write(group.folder.join(group.limit), bytes.to_string()).unwrap();
        under(folder, &format!("echo $$ > {}", group.folder.join("cgroup.procs").display()), line)
    });
}
