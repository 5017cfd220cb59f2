//! Faults around the program: a disk that is full or vanishes, a reader that leaves, Ctrl-C at any moment, a file that
//! changes while it is read, no memory. Each gives one line that names it and the exit code of its kind, and leaves no
//! incomplete file. (`tests/cli.rs` has the plain cases of IO-16 and IO-17.)

#![cfg(target_os = "linux")]

use std::fmt::Write as _;
use std::fs;
use std::io::Read as _;
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use tempfile::TempDir;
use vitrum::load::{self, LoadOptions};

use crate::support::program::{names, program};

/// A ball of glass under a sky; `size` is the picture's.
fn scene(width: u32, height: u32) -> String {
    format!(
        "[camera]\neye = [0, 1, 5]\ntarget = [0, 0.5, 0]\n[render]\nwidth = {width}\nheight = {height}\n\
         [environment]\ntype = \"constant\"\ncolor = 0.5\n[[material]]\nname = \"glass\"\ntype = \"dielectric\"\nior = 1.5\n\
         [[mesh]]\nshape = \"sphere\"\nradius = 1\nmaterial = \"glass\"\n"
    )
}

/// A folder with `scene.toml` in it.
fn place(width: u32, height: u32) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), scene(width, height)).unwrap();
    folder
}

fn vitrum(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(program());
    command.args(line.split_whitespace()).current_dir(folder);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// The program ended with `code` and one line that says `what`.
#[track_caller]
fn refused(output: &Output, code: i32, what: &str) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "signal {:?}: {said}", output.status.signal());
    assert!(said.starts_with("error: ") && said.contains(what) && said.lines().count() == 1, "{said}");
}

/// Waits until the program listens for Ctrl-C, or has ended.
fn listening(child: &mut Child) {
    const SIGINT: u64 = 1 << 1;
    loop {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let caught = status.lines().find_map(|l| l.strip_prefix("SigCgt:")).unwrap_or("0").trim();
        if u64::from_str_radix(caught, 16).unwrap_or(0) & SIGINT != 0 || child.try_wait().unwrap().is_some() {
            return;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn signal(child: &Child, name: &str) {
    // Where it has just ended there is nobody to tell.
    let _ = Command::new("kill").args([name, &child.id().to_string()]).stderr(Stdio::null()).status();
}

/// A small file system of its own, where this user may mount one.
struct Disk(TempDir);

impl Disk {
    fn new(options: &str) -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", options, "tmpfs"])
            .arg(folder.path())
            .stderr(Stdio::null())
            .status();
        if mounted.is_ok_and(|s| s.success()) {
            return Some(Self(folder));
        }
        eprintln!(
            "SKIPPED: a disk of its own needs the right to mount one; /dev/full stands in for it in tests/cli.rs"
        );
        None
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.0.path()).status();
    }
}

/// Case IO-16 of the catalogue.
#[test]
fn a_disk_that_fills_up_leaves_what_was_there() {
    let folder = place(200, 100);
    let Some(disk) = Disk::new("size=64k") else { return };
    fs::write(disk.0.path().join("old.pfm"), "old").unwrap();
    for name in ["old.pfm", "new.pfm"] {
        let line = format!("render scene.toml -q -o {}", disk.0.path().join(name).display());
        refused(&vitrum(folder.path(), &line).output().unwrap(), 3, name);
    }
    assert!(vitrum(folder.path(), "render scene.toml -q -o a.pfm").status().unwrap().success());
    let line = format!("compare a.pfm a.pfm -q --diff {}", disk.0.path().join("diff.pfm").display());
    refused(&vitrum(folder.path(), &line).output().unwrap(), 3, "diff.pfm");
    assert_eq!(names(disk.0.path()), ["old.pfm"]);
    assert_eq!(fs::read(disk.0.path().join("old.pfm")).unwrap(), b"old");
}

/// Case IO-16 of the catalogue.
#[test]
fn a_disk_for_reading_alone_is_refused_before_the_work() {
    let folder = place(60_000, 2_000);
    let Some(disk) = Disk::new("ro") else { return };
    // It would take minutes to find out at the end.
    let line = format!("render scene.toml -q --samples 64 -o {}", disk.0.path().join("a.png").display());
    refused(&vitrum(folder.path(), &line).output().unwrap(), 3, "a.png");
}

/// Case IO-16 of the catalogue.
#[test]
fn an_output_folder_that_vanishes_during_the_render_is_told_at_its_end() {
    let folder = place(500, 400);
    let away = folder.path().join("away");
    fs::create_dir(&away).unwrap();
    let mut child = vitrum(folder.path(), "render scene.toml -q --samples 4 -o away/a.png").spawn().unwrap();
    // By then the folder has been looked at, and the picture is far from done.
    listening(&mut child);
    fs::remove_dir_all(&away).unwrap();
    refused(&child.wait_with_output().unwrap(), 3, "away/a.png");
    assert_eq!(names(folder.path()), ["scene.toml"]);
}

/// Case IO-17 of the catalogue.
#[test]
fn a_picture_into_a_pipe_whose_reader_leaves_was_not_delivered() {
    let folder = place(400, 300);
    let mut child = vitrum(folder.path(), "render scene.toml -q -o /dev/stdout").spawn().unwrap();
    let mut start = [0; 4];
    let mut pipe = child.stdout.take().unwrap();
    let read = pipe.read_exact(&mut start);
    drop(pipe);
    let output = child.wait_with_output().unwrap();
    if read.is_ok() && output.status.success() {
        // All of it fitted into the pipe before the reader left.
        return;
    }
    refused(&output, 3, "/dev/stdout");
    // With nobody there from the start.
    let mut child = vitrum(folder.path(), "render scene.toml -q -o /dev/stdout").spawn().unwrap();
    drop(child.stdout.take());
    refused(&child.wait_with_output().unwrap(), 3, "/dev/stdout");
}

/// A model that takes a while to read: a bumpy sheet of `n` by `n` quads.
fn sheet(n: u32) -> String {
    let mut text = String::new();
    for y in 0..=n {
        for x in 0..=n {
            writeln!(text, "v {x} {} {y}", (x * 7 + y * 13) % 5).unwrap();
        }
    }
    for y in 0..n {
        for x in 1..=n {
            let a = y * (n + 1) + x;
            writeln!(text, "f {} {} {} {}", a, a + 1, a + n + 2, a + n + 1).unwrap();
        }
    }
    text
}

/// Sends Ctrl-C to a command that would run for hours, at several moments of its life.
#[track_caller]
fn interrupted(folder: &Path, line: &str, delays: &[u64]) {
    let before = names(folder);
    for &delay in delays {
        let mut child = vitrum(folder, line).spawn().unwrap();
        listening(&mut child);
        std::thread::sleep(Duration::from_millis(delay));
        signal(&child, "-INT");
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(130), "{line}, after {delay} ms: {said}");
        let last = said.lines().last().unwrap_or_default();
        assert_eq!(last, "error: interrupted", "{line}, after {delay} ms: {said}");
        assert_eq!(names(folder), before, "{line}, after {delay} ms");
    }
}

#[test]
fn ctrl_c_ends_a_render_while_it_loads_builds_and_traces() {
    let folder = place(64, 64);
    fs::write(folder.path().join("sheet.obj"), sheet(300)).unwrap();
    for (backend, delays) in [("native", &[0, 40, 120, 300, 700][..]), ("reference", &[60, 500])] {
        let line = format!("render sheet.obj --width 8000 --height 8000 --samples 64 -o a.png --backend {backend}");
        interrupted(folder.path(), &line, delays);
    }
}

#[test]
fn ctrl_c_ends_every_long_command() {
    let folder = place(2000, 2000);
    for (line, delays) in [
        ("bench scene.toml --rounds 10000 --html page.html", [0, 300]),
        ("parity scene.toml --rays 16777216", [0, 300]),
        ("verify --full", [0, 300]),
        ("verify scene.toml --full", [0, 20]),
    ] {
        interrupted(folder.path(), line, &delays);
    }
}

#[test]
fn ctrl_c_while_a_file_is_written_leaves_all_of_it_or_nothing() {
    let folder = place(3000, 3000);
    let path = folder.path();
    assert!(vitrum(path, "render scene.toml -q -o a.pfm").status().unwrap().success());
    let whole = fs::metadata(path.join("a.pfm")).unwrap().len();
    for line in ["render scene.toml -q -o b.pfm", "compare a.pfm a.pfm -q --diff b.pfm"] {
        let mut child = vitrum(path, line).spawn().unwrap();
        listening(&mut child);
        // The temporary file is there from the first byte to the last.
        while !names(path).iter().any(|n| n.ends_with(".part")) && child.try_wait().unwrap().is_none() {
            std::thread::yield_now();
        }
        signal(&child, "-INT");
        let output = child.wait_with_output().unwrap();
        let there = fs::metadata(path.join("b.pfm")).map(|m| m.len()).ok();
        match output.status.code() {
            Some(130) => assert_eq!(there, None, "{line}"),
            Some(0) => assert_eq!(there, Some(whole), "{line}"),
            other => panic!("{line}: {other:?}: {}", String::from_utf8_lossy(&output.stderr)),
        }
        let _ = fs::remove_file(path.join("b.pfm"));
        assert_eq!(names(path), ["a.pfm", "scene.toml"], "{line}");
    }
}

#[test]
fn a_picture_that_changes_while_it_is_read_is_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.pfm");
    let picture = |edge: usize| {
        let mut bytes = format!("PF\n{edge} {edge}\n-1.0\n").into_bytes();
        bytes.extend((0..edge * edge * 3).flat_map(|i| (i as f32).to_le_bytes()));
        bytes
    };
    let (small, large) = (picture(3), picture(200));
    fs::write(&path, &large).unwrap();
    let done = AtomicBool::new(false);
    let (mut read, mut broken) = (0, 0);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let other = folder.path().join("b.pfm");
            for turn in 0_u32.. {
                if done.load(Ordering::Relaxed) {
                    return;
                }
                match turn % 4 {
                    // Written over in place: readers see it cut short, or half of it.
                    0 => fs::write(&path, &small).unwrap(),
                    1 => fs::write(&path, &large).unwrap(),
                    2 => fs::write(&path, &large[..large.len() / 2]).unwrap(),
                    // Replaced as a whole.
                    _ => {
                        fs::write(&other, &large).unwrap();
                        fs::rename(&other, &path).unwrap();
                    }
                }
            }
        });
        // Until both have been seen, and for a while.
        for turn in 0..200_000 {
            match load::picture(&path, &LoadOptions::default()) {
                Ok(texture) => {
                    read += 1;
                    assert!(matches!((texture.width, texture.pixels.len()), (3, 9) | (200, 40_000)));
                }
                Err(error) => {
                    broken += 1;
                    let text = error.to_string();
                    assert!(matches!(error.exit_code(), 2 | 3) && text.contains("a.pfm"), "{text}");
                }
            }
            if turn > 300 && read > 0 && broken > 0 {
                break;
            }
        }
        done.store(true, Ordering::Relaxed);
    });
    assert!(read > 0 && broken > 0, "{read} read, {broken} refused");
}

/// Case IO-21 of the catalogue.
#[test]
fn a_picture_for_which_there_is_no_memory_is_refused_and_nothing_is_written() {
    let folder = place(64, 64);
    for backend in ["native", "reference"] {
        for (gibibytes, edge) in [(1, 11_000), (2, 11_500), (1, 5_000)] {
            let line =
                format!("render scene.toml -q -o a.png --threads 2 --width {edge} --height {edge} --backend {backend}");
            let output = Command::new("sh")
                .args(["-c", &format!("ulimit -v {}; exec \"$@\"", gibibytes << 20), "sh"])
                .arg(program())
                .args(line.split_whitespace())
                .current_dir(folder.path())
                .output()
                .unwrap();
            refused(&output, 4, &format!("{edge} by {edge}"));
            assert_eq!(names(folder.path()), ["scene.toml"]);
        }
    }
}

#[test]
fn a_study_names_what_is_in_the_way_of_its_folder_and_goes_on_from_a_damaged_journal() {
    let folder = place(64, 48);
    std::os::unix::fs::symlink("nowhere", folder.path().join("link")).unwrap();
    let study = |to: &str| {
        let line = format!("price scene.toml -q -o {to} --axes fresnel --limit 1s --size 8x8");
        vitrum(folder.path(), &line).output().unwrap()
    };
    refused(&study("link"), 3, "link is a link to a folder that does not exist");
    assert!(study("out").status.success());
    let journal = folder.path().join("out/study/journal.jsonl");
    let whole = fs::read(&journal).unwrap();
    for damaged in [&whole[..whole.len() - 20], b"\xff\xfe no journal", b""] {
        fs::write(&journal, damaged).unwrap();
        let output = study("out");
        assert!(output.status.success(), "{output:?}");
        // What is appended stands on a line of its own.
        let text = fs::read(&journal).unwrap();
        let added = String::from_utf8_lossy(&text[damaged.len()..]).trim_start().to_owned();
        assert!(added.starts_with('{') && (damaged.is_empty() || text[damaged.len()] == b'\n'), "{added}");
    }
}
