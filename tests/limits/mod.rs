//! Limits of the system: memory, stacks, sizes of files. Under any limit the program ends with its result, or with one
//! line that names the excess and the exit code of a limit. It never ends by a signal, and never leaves an incomplete
//! file.

#![cfg(target_os = "linux")]

mod memory;

use std::fmt::Write as _;
use std::fs;
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;
use vitrum::accel::Backend;
use vitrum::error::Unavailable;
use vitrum::image::{Bits, Encoding, Film, Format, encode};

use crate::support::program::{names, program};

const PICTURES: [(&str, Format); 4] =
    [("p0.png", Format::Png), ("p1.exr", Format::Exr), ("p2.hdr", Format::Hdr), ("p3.pfm", Format::Pfm)];

const HEAD: &str = "[camera]\neye = [0, 1, 5]\ntarget = [0, 0.5, 0]\n[render]\nwidth = 40\nheight = 30\n\
                    [environment]\ntype = \"constant\"\ncolor = 0.5\n";

/// The program on a line of arguments, after shell commands that set its limits.
fn under(folder: &Path, limits: &str, line: &str) -> Output {
    Command::new("sh")
        .args(["-c", &format!("ulimit -c 0; {limits}; exec \"$@\""), "sh"])
        .arg(program())
        .args(line.split_whitespace())
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .unwrap()
}

#[track_caller]
fn refused(output: &Output, code: i32, words: &[&str]) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "signal {:?}: {said}", output.status.signal());
    assert!(said.starts_with("error: ") && said.lines().count() == 1, "{said}");
    assert!(words.iter().all(|word| said.contains(word)), "{said}");
}

/// A model of `2 n n` triangles with texture coordinates and normals.
fn model(n: u32) -> String {
    let mut text = String::from("mtllib a.mtl\n");
    for y in 0..=n {
        for x in 0..=n {
            writeln!(text, "v {x} {} {y}\nvt {} {}", (x * 7 + y * 13) % 5, x % 2, y % 2).unwrap();
        }
    }
    text += "vn 0 1 0\nusemtl seen\n";
    for y in 0..n {
        for x in 1..=n {
            let a = y * (n + 1) + x;
            let corners = [a, a + 1, a + n + 2, a + n + 1].map(|i| format!("{i}/{i}/1"));
            writeln!(text, "f {}", corners.join(" ")).unwrap();
        }
    }
    text
}

/// A folder with a scene of every loader, and the names of those scenes.
fn scenes() -> (TempDir, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    let of = |material: &str, mesh: &str| {
        format!("{HEAD}[[material]]\nname = \"m\"\n{material}\n[[mesh]]\n{mesh}\nmaterial = \"m\"\n")
    };
    let glass = "type = \"dielectric\"\nior = 1.5";
    write("ball.toml", of(glass, "shape = \"sphere\"").as_bytes());
    write("fine.toml", of(glass, "shape = \"sphere\"\ntessellation = 150").as_bytes());
    write(
        "waves.toml",
        of("type = \"diffuse\"", "shape = \"heightfield\"\nsize = [4, 4]\ntessellation = 300").as_bytes(),
    );
    write("smooth.toml", of(glass, "file = \"a.obj\"\nsmooth = 40").as_bytes());
    write("a.mtl", b"newmtl seen\nKd 1 1 1\nmap_Kd p0.png\n");
    write("a.obj", model(150).as_bytes());
    let mut scenes: Vec<String> =
        ["ball.toml", "fine.toml", "waves.toml", "smooth.toml", "a.obj"].map(String::from).into();
    for (i, (name, format)) in PICTURES.into_iter().enumerate() {
        // The one that is not packed is quick to make, and may be large.
        let edge = if format == Format::Pfm { 1200 } else { 500 };
        let film = Film::new(edge, edge);
        let encoding = Encoding { format, bits: Bits::Eight, metadata: Vec::new() };
        write(name, &encode(&film, &encoding).unwrap().bytes);
        let scene = format!("picture{i}.toml");
        write(&scene, of(&format!("type = \"diffuse\"\ntexture = \"{name}\""), "shape = \"sphere\"").as_bytes());
        scenes.push(scene);
    }
    (folder, scenes)
}

#[test]
fn a_limit_names_what_was_too_large_what_it_needs_what_is_left_and_what_helps() {
    let (folder, _) = scenes();
    let at = |limits: &str, line: &str| {
        under(folder.path(), limits, &format!("render {line} -q -o out.png --backend native"))
    };
    let limited = "ulimit -v 150000";
    for (line, words) in [
        (
            "ball.toml --width 1 --height 1 --threads 400",
            &["stacks of 400 threads", "MiB of memory needed", "left", "ulimit -v", "--threads"][..],
        ),
        (
            "ball.toml --threads 2 --width 3000 --height 3000",
            &["a picture of 3000 by 3000 pixels", "MiB", "left", "ulimit -v", "fewer pixels"],
        ),
        ("fine.toml --threads 2 --width 3000 --height 3000", &["a picture of 3000 by 3000 pixels"]),
    ] {
        refused(&at(limited, line), 4, words);
    }
    refused(
        &at("ulimit -v 50000", "picture3.toml"),
        4,
        &["p3.pfm", "MiB of memory needed", "ulimit -v", "take a smaller"],
    );
    fs::write(folder.path().join("large.obj"), model(400)).unwrap();
    refused(&at("ulimit -v 60000", "large.obj"), 4, &["large.obj", "MiB of memory needed", "left", "take a smaller"]);
    refused(
        &at("ulimit -d 100000", "ball.toml --width 3000 --height 3000"),
        4,
        &["a picture of 3000 by 3000", "ulimit -d"],
    );
    assert!(at("ulimit -v 60000", "ball.toml --width 1 --height 1 --threads 2").status.success());
}

#[test]
fn pictures_that_announce_more_than_they_hold_are_refused_whatever_memory_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    let mut png = Vec::new();
    // Just as many pixels as textures may have.
    let mut encoder = ::png::Encoder::new(&mut png, 16384, 10922);
    encoder.set_color(::png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    writer.write_chunk(::png::chunk::IDAT, &[0x78, 0x01]).unwrap();
    drop(writer);
    write("a.png", &png);
    write("a.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 10922 +X 16384\n");
    write("a.pfm", b"PF 16384 10922 -1 ");
    for name in ["a.png", "a.hdr", "a.pfm"] {
        let material = format!("[[material]]\nname = \"m\"\ntype = \"diffuse\"\ntexture = \"{name}\"\n");
        let scene = format!("{HEAD}{material}[[mesh]]\nshape = \"sphere\"\nmaterial = \"m\"\n");
        write("a.toml", scene.as_bytes());
        for limits in ["ulimit -v 60000", "ulimit -v 1000000", ":"] {
            let output = under(folder.path(), limits, "render a.toml -q -o out.png --backend native");
            // A PFM may have fewer bytes than it needs only by its header, which is read first: memory is asked for before.
            let code = if name == "a.pfm" && limits != ":" { 4 } else { 2 };
            refused(&output, code, &[name, "pixels"][..if code == 4 { 2 } else { 1 }]);
        }
    }
    assert_eq!(names(folder.path()), ["a.hdr", "a.pfm", "a.png", "a.toml"]);
}

#[test]
fn a_stack_of_64_kib_is_enough() {
    let (folder, _) = scenes();
    for line in [
        "render fine.toml -q -o out.png --backend native",
        "render a.obj -q -o out.exr --backend native",
        "explain ball.toml",
        "--help",
    ] {
        let output = under(folder.path(), "ulimit -s 64", line);
        assert!(output.status.success(), "{line}: {output:?}");
    }
}

#[test]
fn a_limit_on_the_sizes_of_files_is_an_error_and_leaves_nothing() {
    let (folder, _) = scenes();
    let before = names(folder.path());
    for line in ["render ball.toml -q -o out.pfm --width 300 --height 300", "compare p3.pfm p3.pfm -q --diff out.pfm"] {
        refused(&under(folder.path(), "ulimit -f 64", line), 3, &["out.pfm", "ulimit -f"]);
        assert_eq!(names(folder.path()), before, "{line}");
    }
}

#[test]
fn what_a_killed_process_left_is_removed_by_the_next_one_that_writes_there() {
    let (folder, _) = scenes();
    let before = names(folder.path());
    let mut left = Vec::new();
    let is_left = |names: &[String]| names.iter().any(|name| name.ends_with(".part"));
    for _ in 0..20 {
        let mut child = Command::new(program())
            .args(["compare", "p3.pfm", "p3.pfm", "-q", "--diff", "out.pfm"])
            .current_dir(folder.path())
            .spawn()
            .unwrap();
        while child.try_wait().unwrap().is_none() && !is_left(&names(folder.path())) {}
        child.kill().unwrap();
        child.wait().unwrap();
        left = names(folder.path());
        if is_left(&left) {
            break;
        }
        // It was done before the signal came.
        let _ = fs::remove_file(folder.path().join("out.pfm"));
    }
    assert!(left.iter().any(|name| name.starts_with(".vitrum-out.pfm-")), "{left:?}");
    // Another output's leftovers are its own affair.
    assert!(under(folder.path(), ":", "render ball.toml -q -o other.pfm").status.success());
    assert_eq!(names(folder.path()).len(), left.len() + 1);
    assert!(under(folder.path(), ":", "render ball.toml -q -o out.pfm").status.success());
    let mut after = before;
    after.extend(["other.pfm".to_owned(), "out.pfm".to_owned()]);
    after.sort();
    assert_eq!(names(folder.path()), after);
}

#[test]
fn an_output_that_is_a_link_to_nothing_makes_what_it_names() {
    let (folder, _) = scenes();
    let path = |name: &str| folder.path().join(name);
    fs::create_dir(path("deep")).unwrap();
    std::os::unix::fs::symlink("deep/real.png", path("link.png")).unwrap();
    assert!(under(folder.path(), ":", "render ball.toml -q -o link.png").status.success());
    assert!(fs::symlink_metadata(path("link.png")).unwrap().is_symlink() && path("deep/real.png").is_file());
    std::os::unix::fs::symlink("missing/real.png", path("nowhere.png")).unwrap();
    refused(&under(folder.path(), ":", "render ball.toml -q -o nowhere.png"), 3, &["nowhere.png", "missing/real.png"]);
    assert_eq!(names(&path("deep")), ["real.png"]);
}

#[test]
fn a_model_that_grows_while_it_is_read_is_read_or_refused_and_ends() {
    let (folder, _) = scenes();
    let path = folder.path().join("growing.obj");
    fs::write(&path, model(60)).unwrap();
    let writer = Command::new("sh")
        .args(["-c", "while :; do echo 'v 1 2 3' >> growing.obj; done"])
        .current_dir(folder.path())
        .spawn();
    let mut writer = writer.unwrap();
    for _ in 0..6 {
        let output = under(folder.path(), ":", "render growing.obj -q -o out.png --width 16 --height 12");
        if !output.status.success() {
            let code = output.status.code().unwrap_or(-1);
            assert!(matches!(code, 2 | 3), "{output:?}");
            refused(&output, code, &["growing.obj"]);
        }
    }
    writer.kill().unwrap();
    writer.wait().unwrap();
}

#[test]
fn neither_a_folder_for_temporary_files_nor_a_home_is_needed() {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    fs::write(
        folder.path().join("ball.toml"),
        format!(
            "{HEAD}[[material]]\nname = \"m\"\ntype = \"diffuse\"\n[[mesh]]\nshape = \"sphere\"\nmaterial = \"m\"\n"
        ),
    )
    .unwrap();
    let mut plain = Command::new(program());
    plain.args(["render", "ball.toml", "-q", "-o", "a.png", "--backend", "native"]).current_dir(folder.path());
    plain.env("TMPDIR", "/nonexistent").env("HOME", "/nonexistent").env_remove("XDG_CACHE_HOME");
    assert!(plain.status().unwrap().success());
    // The same with a /tmp and a home that cannot be written.
    let home = folder.path().join("home");
    fs::create_dir(&home).unwrap();
    let script = "mount -t tmpfs -o ro none /tmp && mount -t tmpfs -o ro none \"$HOME\" && exec \"$@\"";
    let output = Command::new("unshare")
        .args(["-m", "sh", "-c", script, "sh"])
        .arg(program())
        .args(["render", "ball.toml", "-q", "-o", "b.png", "--backend", "native"])
        .current_dir(folder.path())
        .env("HOME", &home)
        .output();
    match output {
        Ok(output) if output.status.success() => assert!(folder.path().join("b.png").is_file()),
        Ok(output) if !String::from_utf8_lossy(&output.stderr).starts_with("error:") => {
            eprintln!("SKIPPED: mounting needs the right to: {}", String::from_utf8_lossy(&output.stderr));
        }
        Ok(output) => panic!("{output:?}"),
        Err(e) => eprintln!("SKIPPED: no unshare: {e}"),
    }
}

#[test]
fn models_are_refused_for_what_is_wrong_with_them() {
    let folder = tempfile::tempdir().unwrap();
    let obj = |text: &str| {
        fs::write(folder.path().join("a.obj"), text).unwrap();
        under(folder.path(), ":", "render a.obj -q -o out.png")
    };
    let far = "v 1e300 0 0\nv 0 1e300 0\nv 0 0 1e300\nf 1 2 3\n";
    refused(&obj(far), 2, &["a corner beyond the largest coordinate", "(1)"]);
    refused(&obj("v nan 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n"), 2, &["a corner that is not finite"]);
    refused(&obj("v 0 0 0\n"), 2, &["there is no face"]);
    let far = "radius = -1e300\nmaterial = \"m\"\n";
    let toml = format!("{HEAD}[[material]]\nname = \"m\"\ntype = \"diffuse\"\n[[mesh]]\nshape = \"sphere\"\n{far}");
    fs::write(folder.path().join("a.toml"), toml).unwrap();
    let output = under(folder.path(), ":", "render a.toml -q -o out.png");
    refused(&output, 2, &["a.toml", "radius", "-1e300"]);
    assert!(output.stderr.len() < 200, "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn usage_is_told_in_one_line_and_fractions_are_numbers_everywhere() {
    let (folder, _) = scenes();
    refused(&under(folder.path(), ":", "render ball.toml --frensel exact"), 2, &["--frensel", "vitrum render --help"]);
    refused(&under(folder.path(), ":", "render"), 2, &["<SCENE>", "--help"]);
    assert!(
        under(folder.path(), ":", "compare p3.pfm p3.pfm -q --tolerance 1/512 --allow-share 1/100").status.success()
    );
    assert!(under(folder.path(), ":", "render ball.toml -q -o out.png --cutoff 1/512").status.success());
}

#[test]
fn a_scene_that_embree_would_lose_is_rendered_by_native_with_a_warning_or_refused() {
    if let Err(why) = Backend::Embree.availability() {
        assert!(why == Unavailable::NotCompiledIn || std::env::var_os("VITRUM_REQUIRE_EMBREE").is_none(), "{why}");
        eprintln!("SKIPPED: {why}");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let scene = |shape: &str| {
        format!(
            "[camera]\neye = [0, 0, 4e14]\ntarget = [0, 0, 0]\n[render]\nwidth = 40\nheight = 30\n[[material]]\nname = \"m\"\n\
             type = \"emissive\"\nemission = [1, 1, 1]\n[[mesh]]\nname = \"far ball\"\nshape = \"sphere\"\nmaterial = \"m\"\n{shape}"
        )
    };
    for shape in ["radius = 1e14", "radius = 1e14\ntessellation = 12"] {
        fs::write(folder.path().join("far.toml"), scene(shape)).unwrap();
        let native = under(folder.path(), ":", "render far.toml -q -o native.pfm --backend native");
        assert!(native.status.success(), "{native:?}");
        let plain = under(folder.path(), ":", "render far.toml -o plain.pfm");
        let said = String::from_utf8_lossy(&plain.stderr);
        assert!(plain.status.success() && said.contains("warning: far.toml:") && said.contains("`far ball`"), "{said}");
        let picture = |name: &str| fs::read(folder.path().join(name)).unwrap();
        assert!(picture("native.pfm") == picture("plain.pfm") && picture("plain.pfm").contains(&0x3f));
        for backend in ["embree", "embree-fast"] {
            let output = under(folder.path(), ":", &format!("render far.toml -q -o out.pfm --backend {backend}"));
            refused(&output, 4, &["far.toml:", "`far ball`", "--backend native"]);
        }
    }
}
