//! Odd and hostile input: every file gets a scene with counted warnings, or one line that names file, line and value.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use vitrum::Error;
use vitrum::geometry::{GeometryMask, Shape, TriMesh};
use vitrum::load::{self, LoadOptions, Loaded};
use vitrum::scene::{Colour, FresnelRule, Interface, MirrorSource, Rgb};

/// A folder with files to load.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn with(self, name: &str, content: impl AsRef<[u8]>) -> Self {
        fs::write(self.path(name), content).unwrap();
        self
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn load(&self, name: &str) -> vitrum::Result<Loaded> {
        load::scene(&self.path(name), &LoadOptions::default())
    }

    fn strict(&self, name: &str) -> vitrum::Result<Loaded> {
        load::scene(&self.path(name), &LoadOptions { strict: true, ..LoadOptions::default() })
    }
}

fn obj(text: impl AsRef<[u8]>) -> vitrum::Result<Loaded> {
    Folder::new().with("a.obj", text).load("a.obj")
}

/// One triangle of a material.
fn mtl(text: &str) -> vitrum::Result<Loaded> {
    let model = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    Folder::new().with("a.obj", model).with("a.mtl", text).load("a.obj")
}

fn toml(text: &str) -> vitrum::Result<Loaded> {
    Folder::new().with("a.toml", text).load("a.toml")
}

fn mesh(loaded: &Loaded, i: usize) -> &TriMesh {
    match &loaded.scene.geometry[i].shape {
        Shape::Mesh(mesh) => mesh,
        other => panic!("{other:?} is no mesh"),
    }
}

fn triangles(loaded: &Loaded) -> usize {
    (0..loaded.scene.geometry.len()).map(|i| mesh(loaded, i).triangles.len()).sum()
}

/// The error's one line, after checking its exit code, its place and that it holds every part.
#[track_caller]
fn refused(result: vitrum::Result<Loaded>, code: u8, parts: &[&str]) -> String {
    let error = result.expect_err("it was accepted");
    let text = error.to_string();
    assert_eq!(error.exit_code(), code, "{text}");
    assert!(!text.contains('\n'), "more than one line: {text}");
    for part in parts {
        assert!(text.contains(part), "`{part}` is not in: {text}");
    }
    text
}

/// The scene, after checking that a warning holds every part.
#[track_caller]
fn warned(result: vitrum::Result<Loaded>, parts: &[&str]) -> Loaded {
    let loaded = result.unwrap();
    let all: Vec<String> = loaded.report.warnings.iter().map(ToString::to_string).collect();
    assert!(all.iter().any(|w| parts.iter().all(|p| w.contains(p))), "{parts:?} is in none of {all:#?}");
    loaded
}

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

// OBJ: faces and their indices.

#[test]
fn indices_that_point_nowhere_are_refused_with_their_line() {
    for (face, parts) in [
        ("f 1 2 7", ["a.obj:4:", "vertex 7", "3"]),
        ("f 0 1 2", ["a.obj:4:", "vertex 0", "count from 1"]),
        ("f -1 -2 -9", ["a.obj:4:", "-9", "only 3"]),
        ("f -9223372036854775808 1 2", ["a.obj:4:", "-9223372036854775808", "only 3"]),
        ("f 9223372036854775807 1 2", ["a.obj:4:", "9223372036854775807", "out of range"]),
        ("f 99999999999999999999 1 2", ["a.obj:4:", "99999999999999999999", "out of range"]),
        ("f 4294967296 1 2", ["a.obj:4:", "4294967296", "out of range"]),
        ("f a 1 2", ["a.obj:4:", "`a`", "no index"]),
        ("f 1/2/3/4 1 2", ["a.obj:4:", "1/2/3/4", "more than three"]),
        ("f /1 1 2", ["a.obj:4:", "`/1`", "no vertex"]),
    ] {
        refused(obj(format!("{CORNERS}{face}\n")), 2, &parts);
    }
    refused(
        obj(format!("{CORNERS}vn 0 0 1\nf 1//6148914691236517207 2//1 3//1\n")),
        2,
        &["a.obj:5:", "6148914691236517207"],
    );
    refused(obj(format!("{CORNERS}vn 0 0 1\nf 1//2 2//1 3//1\n")), 2, &["a.obj:5:", "normal 2", "has 1"]);
    refused(obj(format!("{CORNERS}vt 0 0\nf 1/2 2/1 3/1\n")), 2, &["a.obj:5:", "texture coordinate 2"]);
}

#[test]
fn a_face_may_point_forward_in_the_file() {
    assert_eq!(triangles(&obj(format!("f 1 2 3\n{CORNERS}")).unwrap()), 1);
}

#[test]
fn normals_that_the_file_does_not_have_are_a_warning() {
    let loaded = warned(obj(format!("{CORNERS}f 1//9 2//9 3//9\n")), &["a.obj:4:", "normals", "has none"]);
    assert!(mesh(&loaded, 0).normals.is_empty());
}

#[test]
fn mixed_normals_leave_every_corner_with_one() {
    let text = format!("{CORNERS}v 0 0 1\nvn 0 0 2\nf 1//1 2 3\nf 1//1 2//1 3//1\nf 1 4 2\n");
    let loaded = warned(obj(text), &["a.obj:6:", "normal at every corner"]);
    let mesh = mesh(&loaded, 0);
    assert_eq!(mesh.normal_indices.len(), 3);
    let normals = |i| mesh.corner_normals(i).unwrap();
    assert_eq!(normals(1), [glam::Vec3::Z; 3]);
    assert_eq!(normals(0), [glam::Vec3::Z; 3]);
    assert_eq!(normals(2), [glam::Vec3::Y; 3]);
}

#[test]
fn normals_without_a_direction_leave_the_face_flat() {
    for bad in ["0 0 0", "nan 0 1", "inf 0 0"] {
        let loaded = warned(obj(format!("{CORNERS}vn {bad}\nvn 0 0 1\nf 1//1 2//2 3//2\n")), &["a.obj:6:", "normal"]);
        assert!(mesh(&loaded, 0).normals.is_empty(), "{bad}");
    }
}

#[test]
fn corners_that_are_not_finite_drop_their_faces_and_are_counted() {
    for bad in ["nan 0 0", "1e999 0 0", "-infinity 0 0", "1e30 0 0"] {
        let folder = Folder::new().with("a.obj", format!("{CORNERS}v {bad}\nf 1 2 4\nf 1 2 3\nf 4 2 3 1\n"));
        let loaded = warned(folder.load("a.obj"), &["a.obj:5:", "not finite", "and 1 more"]);
        assert_eq!((triangles(&loaded), loaded.report.dropped["a corner that is not finite"]), (1, 2), "{bad}");
        refused(folder.strict("a.obj"), 2, &["a.obj:5:", "not finite"]);
    }
}

#[test]
fn numbers_that_are_none_are_refused_with_their_line() {
    refused(obj("v 0 0\nf 1 1 1\n"), 2, &["a.obj:1:", "`v 0 0`", "too few"]);
    refused(obj("v a b c\n"), 2, &["a.obj:1:", "`a`", "no number"]);
    refused(obj("v 0 0 0\nv 0,5 0 0\n"), 2, &["a.obj:2:", "`0,5`", "point"]);
    refused(obj("vn 0 0\n"), 2, &["a.obj:1:", "too few"]);
    refused(obj("vt\n"), 2, &["a.obj:1:", "too few"]);
}

#[test]
fn colours_at_some_vertices_and_weights_are_tolerated() {
    let loaded = obj("v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 0.5 0.5 0.5\nf 1 2 3\n").unwrap();
    assert_eq!(loaded.report.warnings, []);
    let loaded = warned(obj("v 0 0 0 1\nv 1 0 0 0\nv 0 1 0\nf 1 2 3\n"), &["a.obj:2:", "weight"]);
    assert_eq!(mesh(&loaded, 0).positions[1].x, 1.0);
}

#[test]
fn faces_without_area_by_count_or_by_corner_are_dropped_and_counted() {
    let loaded =
        warned(obj(format!("{CORNERS}f\nf 1\nf 1 2\nf 1 2 3\n")), &["a.obj:4:", "fewer than three", "and 2 more"]);
    assert_eq!((triangles(&loaded), loaded.report.dropped["fewer than three corners"]), (1, 3));
    let text = format!("{CORNERS}v 1 0 0\nf 1 1 1\nf 1 2 4\nf 1 2 2 3\nf 1 2 3 1\n");
    let loaded = warned(obj(text), &["a.obj:5:", "coincide", "and 1 more"]);
    assert_eq!((triangles(&loaded), loaded.report.dropped["corners that coincide"]), (2, 2));
}

#[test]
fn files_without_triangles_are_refused() {
    for text in [&b""[..], b"\0\0\0\0", b"# nothing\n", CORNERS.as_bytes(), b"v 0 0 0\nf 1 1 1\n"] {
        refused(obj(text), 2, &["a.obj", "no triangles"]);
    }
}

#[test]
fn line_endings_marks_and_continuations_are_accepted_and_counted_right() {
    let plain = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for text in [
        plain.replace('\n', "\r"),
        plain.replace('\n', "\r\n"),
        format!("\u{feff}{plain}"),
        plain.trim_end().to_owned(),
    ] {
        assert_eq!(obj(&text).unwrap().scene.objects[0].origin.triangle_lines, [4], "{text:?}");
    }
    let loaded = obj("v 0 0 0\nv 1 \\\n0 \\\r\n0\nv 0 1 0\nf 1 2 3 # a face\n").unwrap();
    assert_eq!(loaded.scene.objects[0].origin.triangle_lines, [6]);
    refused(obj(plain.replace("3\n", "9\n").replace('\n', "\r")), 2, &["a.obj:4:"]);
}

#[test]
fn bytes_that_are_not_utf8_are_named_by_line_and_offset() {
    let loaded = warned(obj(b"# caf\xe9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), &["a.obj:1:", "0xe9", "offset 5"]);
    assert_eq!(triangles(&loaded), 1);
    refused(obj(b"v 0 0 0\nv \xff 0 0\n"), 2, &["a.obj:2:", "no number"]);
    let scene = Folder::new().with("a.toml", b"[camera]\neye = \"\xff\"\n");
    refused(scene.load("a.toml"), 2, &["a.toml:2:", "0xff", "offset 16"]);
}

#[test]
fn polygons_become_triangles_that_keep_their_line() {
    // Concave at its second corner: a fan from the first would overlap itself.
    let loaded = obj("v 0 0 0\nv 2 -1 0\nv 0.5 0 0\nv 2 1 0\nf 4 1 2 3\n").unwrap();
    let mesh = mesh(&loaded, 0);
    assert_eq!(loaded.scene.objects[0].origin.triangle_lines, [5, 5]);
    for i in 0..2 {
        let [a, b, c] = mesh.corners(i);
        assert!((b - a).cross(c - a).z > 0.0);
    }
}

#[test]
fn a_polygon_of_many_corners_is_cut_in_good_time_or_refused() {
    let circle: String = (0..200_000)
        .map(|i| {
            let (s, c) = (f64::from(i) * std::f64::consts::TAU / 200_000.0).sin_cos();
            format!("v {c} {s} 0\n")
        })
        .collect();
    let face: String = std::iter::once("f".to_owned()).chain((1..=200_000).map(|i| format!(" {i}"))).collect();
    assert_eq!(triangles(&obj(format!("{circle}{face}\n")).unwrap()), 199_998);
    let star: String = (0..20_000)
        .map(|i| {
            let (s, c) = (f64::from(i) * std::f64::consts::TAU / 20_000.0).sin_cos();
            let r = if i % 2 == 0 { 1.0 } else { 0.5 };
            format!("v {} {} 0\n", r * c, r * s)
        })
        .collect();
    let face: String = std::iter::once("f".to_owned()).chain((1..=20_000).map(|i| format!(" {i}"))).collect();
    refused(obj(format!("{star}{face}\n")), 2, &["a.obj:20001:", "20000 corners"]);
}

#[test]
fn points_lines_and_unknown_statements_are_left_out_with_a_warning() {
    warned(obj(format!("{CORNERS}l 1 2\np 1\nf 1 2 3\n")), &["a.obj:4:", "points and lines", "and 1 more"]);
    warned(obj(format!("{CORNERS}curv2 1 2\nf 1 2 3\n")), &["a.obj:4:", "`curv2`"]);
}

#[test]
fn more_than_the_limits_allow_ends_with_exit_code_four() {
    let folder =
        Folder::new().with("a.obj", format!("{CORNERS}f 1 2 3\nf 1 2 3\n")).with("b.obj", "o x\n".repeat(100_000));
    let with = |name: &str, set: fn(&mut load::Limits)| {
        let mut options = LoadOptions::default();
        set(&mut options.limits);
        load::scene(&folder.path(name), &options)
    };
    refused(with("a.obj", |l| l.file_bytes = 10), 4, &["a.obj", "10"]);
    refused(with("a.obj", |l| l.line_bytes = 4), 4, &["a.obj:1", "4"]);
    refused(with("a.obj", |l| l.vertices = 2), 4, &["a.obj", "2 vertices"]);
    refused(with("a.obj", |l| l.triangles = 1), 4, &["1"]);
    refused(folder.load("b.obj"), 2, &["no triangles"]);
}

// MTL: what a material may say.

#[test]
fn colours_of_one_number_are_grey_and_of_two_or_none_are_refused() {
    let loaded = mtl("newmtl m\nKd 0.25\n").unwrap();
    assert_eq!(loaded.scene.materials[0].diffuse, Colour::Constant(Rgb::splat(0.25)));
    for bad in ["Kd", "Kd 0.5 0.5"] {
        refused(mtl(&format!("newmtl m\n{bad}\n")), 2, &["a.mtl:2:", bad, "three numbers"]);
    }
    refused(mtl("newmtl m\nKd nan -1 1e30\n"), 2, &["a.mtl:2:", "nan -1 1e30"]);
    refused(mtl("newmtl m\nKd 0.5 -1 1\n"), 2, &["a.mtl:2:", "at least 0"]);
    refused(mtl("newmtl m\nKd 1e30 0 0\n"), 2, &["a.mtl:2:", "at most 1"]);
    let loaded = warned(mtl("newmtl m\nKd 1.5 0 0\n"), &["a.mtl:2:", "above 1"]);
    assert_eq!(loaded.scene.materials[0].diffuse, Colour::Constant(Rgb::X));
}

#[test]
fn statements_that_are_not_understood_leave_the_rest_of_the_materials_alone() {
    for (line, part) in [
        ("Kd spectral f.rfl", "spectral"),
        ("Ks xyz 1 1 1", "spectral"),
        ("illum 300", "0 to 10"),
        ("illum", "0 to 10"),
        ("Pr 0.5", "`Pr`"),
        ("map_Ks t.png", "`map_Ks`"),
    ] {
        let loaded = warned(mtl(&format!("newmtl m\n{line}\nKe 1 2 3\n")), &["a.mtl:2:", part]);
        assert_eq!(loaded.scene.materials[0].emission, Rgb::new(1.0, 2.0, 3.0), "{line}");
    }
    let loaded = warned(mtl("newmtl\nKd 1 0 0\nnewmtl m\nKd 0 1 0\n"), &["a.mtl:1:", "without a name"]);
    assert_eq!(loaded.scene.materials[0].diffuse, Colour::Constant(Rgb::Y));
    warned(mtl("Kd 1 1 1\nnewmtl m\n"), &["a.mtl:1:", "outside a material"]);
    warned(mtl("newmtl m\nnewmtl m\nKd 1\n"), &["a.mtl:2:", "`m`", "again"]);
}

#[test]
fn an_impossible_index_is_refused_where_light_is_bent_and_ignored_elsewhere() {
    for bad in ["-1", "0", "nan", "inf", "1e-30", "1e30"] {
        refused(mtl(&format!("newmtl m\nillum 7\nNi {bad}\n")), 2, &["a.mtl:3:", "between 0.001 and 1000"]);
        assert!(mtl(&format!("newmtl m\nillum 2\nNi {bad}\n")).is_ok(), "{bad}");
    }
    let loaded = warned(mtl("newmtl m\nillum 7\n"), &["a.mtl:1:", "`m`", "1.5"]);
    assert_eq!(loaded.scene.media[1].ior, 1.5);
    assert_eq!(mtl("newmtl m\nillum 7\nNi 1.33\n").unwrap().scene.media[1].ior, 1.33);
}

#[test]
fn dissolve_wins_over_transparency_and_their_quarrel_is_a_warning() {
    let opacity = |text: &str| match mtl(&format!("newmtl m\n{text}\n")).unwrap().scene.materials[0].interface {
        Interface::Alpha { opacity } => opacity,
        Interface::Opaque => 1.0,
        other => panic!("{other:?}"),
    };
    assert_eq!(opacity("d 0.25"), 0.25);
    assert_eq!(opacity("Tr 0.25"), 0.75);
    assert_eq!(opacity("d 1\nTr 0"), 1.0);
    assert_eq!(opacity("Tr 0.5\nd 0.25"), 0.25);
    assert_eq!(opacity("d -halo 0.5"), 0.5);
    warned(mtl("newmtl m\nd 1\nTr 1\n"), &["a.mtl:3:", "disagree", "`d` counts"]);
    refused(mtl("newmtl m\nd 1.5\n"), 2, &["a.mtl:2:", "d 1.5"]);
}

#[test]
fn each_illumination_model_becomes_its_effect() {
    let of = |illum: u32| {
        let text = format!("newmtl m\nKa 0.1\nKd 0.2\nKs 0.3\nNs 50\nNi 1.5\nTf 0.9 0.8 0.7\nillum {illum}\n");
        let loaded = mtl(&text).unwrap();
        (loaded.scene.materials[0].clone(), loaded)
    };
    let (ks, tint) = (Rgb::splat(0.3), Rgb::new(0.9, 0.8, 0.7));
    let (m, _) = of(0);
    assert_eq!((m.emission, m.ambient, m.diffuse.clone()), (Rgb::splat(0.2), Rgb::ZERO, Colour::Constant(Rgb::ZERO)));
    for illum in 1..=10 {
        let (m, loaded) = of(illum);
        assert_eq!(m.ambient, Rgb::splat(0.1), "{illum}");
        assert_eq!(m.diffuse, Colour::Constant(Rgb::splat(0.2)), "{illum}");
        assert_eq!(m.highlight.is_some(), illum >= 2, "{illum}");
        let expected = match illum {
            3 => Interface::Mirror { reflectance: ks, source: MirrorSource::Traced },
            4 => Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fresnel, tint },
            5 => Interface::Coated { ior: 1.5 },
            6 => Interface::Dielectric { medium: 1, rule: FresnelRule::Fixed(ks), tint },
            7 => Interface::Dielectric { medium: 1, rule: FresnelRule::Fresnel, tint },
            8 => Interface::Mirror { reflectance: ks, source: MirrorSource::Environment },
            9 => Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fixed(Rgb::ZERO), tint },
            _ => Interface::Opaque,
        };
        assert_eq!(m.interface, expected, "{illum}");
        let mask = if matches!(illum, 4 | 6 | 7 | 9) { GeometryMask::TRANSMISSIVE } else { GeometryMask::OPAQUE };
        assert_eq!(loaded.scene.geometry[0].mask, mask, "{illum}");
    }
    warned(mtl("newmtl m\nillum 10\n"), &["a.mtl:1:", "illum 10"]);
}

#[test]
fn an_open_dielectric_is_a_warning_with_an_example() {
    warned(mtl("newmtl m\nillum 7\nNi 1.5\n"), &["a.obj:6:", "not closed", "3 open edges"]);
}

#[test]
fn names_that_no_file_has_are_a_warning_and_the_default_material() {
    let loaded = warned(obj(format!("{CORNERS}usemtl nope\nf 1 2 3\n")), &["a.obj:4:", "`nope`", "default"]);
    assert_eq!(loaded.scene.materials[0].name, "default");
    warned(obj(format!("mtllib none.mtl\n{CORNERS}usemtl nope\nf 1 2 3\n")), &["a.obj:1:", "none.mtl"]);
    warned(obj(format!("{CORNERS}usemtl\nf 1 2 3\n")), &["a.obj:4:", "without a name"]);
}

#[test]
fn one_shape_a_material_holds_only_its_own_corners() {
    let model = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\n\
                 usemtl a\nf 1 2 3\nusemtl b\nf 4 5 6\nusemtl a\nf 3 2 1\n";
    let folder = Folder::new().with("a.obj", model).with("a.mtl", "newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\n");
    let loaded = folder.load("a.obj").unwrap();
    assert_eq!(loaded.scene.objects.len(), 2);
    assert_eq!(loaded.scene.objects[0].origin.triangle_lines, [9, 13]);
    assert_eq!((mesh(&loaded, 0).positions.len(), mesh(&loaded, 1).positions.len()), (3, 3));
    let name = |i: usize| &loaded.scene.materials[loaded.scene.objects[i].material as usize].name;
    assert_eq!((name(0).as_str(), name(1).as_str()), ("a", "b"));
}

// Files that name other files.

#[cfg(unix)]
#[test]
fn files_outside_the_scene_and_things_that_are_no_files_are_never_read() {
    let outside = Folder::new().with("secret.mtl", "newmtl m\nKe 9 9 9\n");
    let folder = Folder::new().with("a.obj", "");
    std::os::unix::fs::symlink(outside.path("secret.mtl"), folder.path("link.mtl")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", folder.path("zero.mtl")).unwrap();
    fs::create_dir(folder.path("folder.mtl")).unwrap();
    let made = std::process::Command::new("mkfifo").arg(folder.path("pipe.mtl")).status().unwrap();
    assert!(made.success());
    let absolute = outside.path("secret.mtl").display().to_string();
    for (name, part) in [
        ("../../../../../../../../etc/hostname", "outside"),
        ("..\\..\\..\\..\\..\\..\\..\\..\\etc\\hostname", "outside"),
        (absolute.as_str(), "outside"),
        ("link.mtl", "outside"),
        ("zero.mtl", "outside"),
        ("/dev/zero", "outside"),
        ("folder.mtl", "not a regular file"),
        ("pipe.mtl", "not a regular file"),
        ("missing.mtl", "cannot read"),
    ] {
        fs::write(folder.path("a.obj"), format!("mtllib {name}\n{CORNERS}usemtl m\nf 1 2 3\n")).unwrap();
        let loaded = warned(folder.load("a.obj"), &["a.obj:1:", part]);
        assert_eq!(loaded.scene.materials[0].emission, Rgb::ZERO, "{name}");
        refused(folder.strict("a.obj"), 2, &["a.obj:1:", part]);

        fs::write(folder.path("b.obj"), format!("mtllib b.mtl\n{CORNERS}usemtl m\nf 1 2 3\n")).unwrap();
        fs::write(folder.path("b.mtl"), format!("newmtl m\nmap_Kd -s 1 1 1 {name}\n")).unwrap();
        warned(folder.load("b.obj"), &["b.mtl:2:", part]);

        let scene = format!("[[mesh]]\nfile = '{name}'\n");
        fs::write(folder.path("s.toml"), scene).unwrap();
        refused(folder.load("s.toml"), 2, &["s.toml:2:8:", part]);
    }
    refused(folder.load("folder.mtl"), 2, &["neither"]);
}

#[test]
fn a_file_that_is_not_there_ends_with_exit_code_three() {
    refused(load::scene(Path::new("no/such.obj"), &LoadOptions::default()), 3, &["no/such.obj", "read"]);
    refused(load::scene(Path::new("no/such.toml"), &LoadOptions::default()), 3, &["no/such.toml"]);
    refused(load::scene(Path::new("such.png"), &LoadOptions::default()), 2, &["such.png", ".toml", ".obj"]);
}

#[test]
fn backslashes_in_file_names_are_slashes() {
    let folder = Folder::new().with("a.obj", format!("mtllib sub\\m.mtl\n{CORNERS}usemtl m\nf 1 2 3\n"));
    fs::create_dir(folder.path("sub")).unwrap();
    fs::write(folder.path("sub/m.mtl"), "newmtl m\nKe 1 0 0\n").unwrap();
    assert_eq!(folder.load("a.obj").unwrap().scene.materials[0].emission, Rgb::X);
}

// Pictures.

/// The picture as read.
fn picture(name: &str, bytes: impl AsRef<[u8]>) -> vitrum::Result<vitrum::scene::Texture> {
    let folder = Folder::new().with(name, bytes);
    load::picture(&folder.path(name), &LoadOptions::default())
}

fn png(width: u32, height: u32, gray: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header().unwrap().write_image_data(gray).unwrap();
    bytes
}

#[track_caller]
fn picture_refused(result: vitrum::Result<vitrum::scene::Texture>, code: u8, part: &str) {
    let error = result.expect_err("it was accepted");
    let text = error.to_string();
    assert!(error.exit_code() == code && text.contains(part) && !text.contains('\n'), "{code}, {part}: {text}");
}

#[test]
fn pictures_are_linear_whatever_their_format_and_name() {
    // 188 is the eight-bit value nearest to half the light.
    for name in ["a.png", "a.jpg", "a"] {
        let picture = picture(name, png(2, 1, &[0, 188])).unwrap();
        assert_eq!((picture.width, picture.height, picture.pixels[0]), (2, 1, Rgb::ZERO));
        assert!((picture.pixels[1] - 0.5029).abs().max_element() < 1e-4);
    }
    let mut pfm = b"Pf\n1 2\n-1\n".to_vec();
    pfm.extend([0.25f32, 3.0].iter().flat_map(|f| f.to_le_bytes()));
    // A PFM's rows go from the bottom up.
    assert_eq!(picture("a.pfm", &pfm).unwrap().pixels, [Rgb::splat(3.0), Rgb::splat(0.25)]);
    let hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x81";
    assert_eq!(picture("a.hdr", hdr).unwrap().pixels, [Rgb::ONE]);
}

#[test]
fn an_exr_picture_comes_back_as_written() {
    let folder = Folder::new();
    let at = |x: usize, y: usize| (x as f32, y as f32 * 10.0, 0.5f32);
    exr::prelude::write_rgb_file(folder.path("a.exr"), 3, 2, at).unwrap();
    let picture = load::picture(&folder.path("a.exr"), &LoadOptions::default()).unwrap();
    assert_eq!((picture.width, picture.height), (3, 2));
    assert_eq!(picture.pixels[5], Rgb::new(2.0, 10.0, 0.5));
}

#[test]
fn pictures_that_are_too_large_are_refused_before_they_are_decoded() {
    let mut huge = png(1, 1, &[0]);
    huge[16..24].copy_from_slice(&[0, 1, 0x86, 0xa0, 0, 1, 0x86, 0xa0]);
    let crc = crc32(&huge[12..29]);
    huge[29..33].copy_from_slice(&crc.to_be_bytes());
    picture_refused(picture("a.png", &huge), 4, "a.png");
    picture_refused(picture("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 20000 +X 20000\n"), 4, "a.hdr");
    picture_refused(picture("a.pfm", "PF\n100000 100000\n-1\n"), 4, "100000");
    let edge = picture("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4294967295 +X 4294967295\n").unwrap_err();
    assert!(matches!(edge.exit_code(), 2 | 4), "{edge}");
}

/// The checksum of PNG chunks (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &b| {
        (0..8).fold(crc ^ u32::from(b), |c, _| if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 })
    })
}

#[test]
fn pictures_that_are_broken_or_empty_are_refused() {
    let whole = png(64, 64, &[9; 64 * 64]);
    picture_refused(picture("a.png", &whole[..whole.len() / 2]), 2, "not a readable PNG");
    picture_refused(picture("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 0\n"), 2, "0 by 0");
    picture_refused(picture("a.pfm", "PF\n0 0\n-1\n"), 2, "0 by 0");
    picture_refused(picture("a.pfm", "PF\n2 2\n-1\nxxxx"), 2, "ends early");
    picture_refused(picture("a.pfm", "PF\n2 2\n0\n"), 2, "scale");
    picture_refused(picture("a.pfm", "PF\n-2 2\n1\n"), 2, "width");
    picture_refused(picture("a.png", "<svg xmlns='http://www.w3.org/2000/svg'/>"), 2, "no picture of a kind");
    picture_refused(picture("a.png", ""), 2, "no picture of a kind");
    picture_refused(picture("a.exr", [0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0, 0]), 2, "a.exr");
}

#[test]
fn pixels_that_are_not_finite_or_negative_are_black_and_counted() {
    let mut pfm = b"PF\n2 2\n-1\n".to_vec();
    let pixels = [f32::NAN, 1.0, 1.0, f32::INFINITY, 1.0, 1.0, -1.0, 2.0, 3.0, 1.0, 1.0, 1.0];
    pfm.extend(pixels.iter().flat_map(|f| f.to_le_bytes()));
    let scene = "[environment]\ntype = \"image\"\nfile = \"sky.pfm\"\n";
    let loaded =
        warned(Folder::new().with("sky.pfm", pfm).with("a.toml", scene).load("a.toml"), &["sky.pfm", "3 of 4"]);
    let rows = &loaded.scene.textures[0].pixels;
    assert_eq!(rows[..], [Rgb::new(0.0, 2.0, 3.0), Rgb::ONE, Rgb::new(0.0, 1.0, 1.0), Rgb::new(0.0, 1.0, 1.0)]);
}

// Scene files.

/// A scene that is right but for one line in a table.
fn wrong(table: &str, line: &str) -> vitrum::Result<Loaded> {
    toml(&format!("[{table}]\n{line}\n"))
}

#[test]
fn keys_that_nobody_knows_are_refused_with_the_nearest_one() {
    refused(wrong("camera", "fvo = 40"), 2, &["a.toml:2:1:", "[camera]", "`fvo`", "`fov`"]);
    refused(wrong("camera", "eye = [0,0,9]\ntargt = [0,0,0]"), 2, &["a.toml:3:1:", "`targt`", "`target`"]);
    refused(toml("[camra]\n"), 2, &["a.toml:1:2:", "`camra`", "`camera`"]);
    refused(toml("[[lights]]\n"), 2, &["`lights`", "`light`"]);
    refused(toml("[[material]]\nname = 'a'\ntype = 'difuse'\n"), 2, &["a.toml:3:8:", "\"difuse\"", "`diffuse`"]);
    refused(toml("[[material]]\nname = 'a'\ntype = 'diffuse'\nior = 1.5\n"), 2, &["a.toml:4:1:", "`ior`"]);
    refused(toml("[[material]]\nname = 'a'\ntype = 'thin'\nglass = 'bk8'\n"), 2, &["a.toml:4:9:", "`bk8`", "`bk7`"]);
    refused(toml("[[material]]\nname = 'a'\ntype = 'conductor'\nmetal = 'god'\n"), 2, &["a.toml:4:9:", "`gold`"]);
    let scene = "[[material]]\nname = 'gold'\ntype = 'diffuse'\n[[mesh]]\nshape = 'sphere'\nmaterial = 'glod'\n";
    refused(toml(scene), 2, &["a.toml:6:12:", "`glod`", "`gold`"]);
    refused(toml("[[mesh]]\nshape = 'spere'\n"), 2, &["a.toml:2:9:", "`sphere`"]);
}

#[test]
fn toml_that_is_none_is_refused_with_line_and_column() {
    refused(toml("[camera]\neye = [0, 0\n"), 2, &["a.toml:"]);
    refused(toml("[camera]\nfov = 1\nfov = 2\n"), 2, &["a.toml:3:1:", "duplicate"]);
    refused(toml(&format!("a = {}{}", "[".repeat(10_000), "]".repeat(10_000))), 2, &["a.toml:1:"]);
    refused(toml(&format!("a{} = 1", ".a".repeat(10_000))), 2, &["a.toml:1:"]);
    refused(toml(&format!("a = '{}'\n", "x".repeat(1 << 20))), 2, &["a.toml:1:1:", "`a`"]);
    refused(toml("\u{feff}[camera]\nfvo = 1\n"), 2, &["a.toml:2:1:"]);
}

#[test]
fn values_of_the_wrong_type_say_what_they_must_be() {
    refused(wrong("camera", "eye = 1"), 2, &["a.toml:2:7:", "`eye`", "list of 3 numbers"]);
    refused(wrong("camera", "eye = [1, 2]"), 2, &["a.toml:2:7:", "list of 2"]);
    refused(wrong("camera", "eye = [1, 2, 'x']"), 2, &["a.toml:2:14:", "a number"]);
    refused(wrong("camera", "fov = '40'"), 2, &["a.toml:2:7:", "a string", "a number"]);
    refused(toml("camera = 1\n"), 2, &["a.toml:1:10:", "a table"]);
    refused(toml("light = 1\n"), 2, &["[[light]]"]);
    refused(toml("[light]\n"), 2, &["[[light]]"]);
    refused(
        toml("[[light]]\ntype = 'point'\nposition = [0,0,0]\nintensity = true\n"),
        2,
        &["a.toml:4:13:", "a boolean"],
    );
}

#[test]
fn cameras_that_see_nothing_are_refused() {
    for fov in ["0", "180", "-40", "nan", "inf", "1e999", "179.99999999999"] {
        refused(wrong("camera", &format!("fov = {fov}")), 2, &["a.toml:2:7:", "`fov`"]);
    }
    refused(wrong("camera", "eye = [1, 2, 3]\ntarget = [1, 2, 3]"), 2, &["a.toml:3:10:", "same point"]);
    refused(wrong("camera", "eye = [1e8, 0, 0]\ntarget = [100000000.1, 0, 0]"), 2, &["same point"]);
    refused(wrong("camera", "eye = [0, 5, 0]"), 2, &["a.toml:1:", "parallel"]);
    refused(wrong("camera", "up = [0, -1, -5]\neye = [0, 1, 5]"), 2, &["a.toml:2:6:", "parallel"]);
    refused(wrong("camera", "up = [0, 0, 0]"), 2, &["a.toml:2:6:", "not 0"]);
    refused(wrong("camera", "eye = [nan, 0, 0]"), 2, &["a.toml:2:8:", "finite"]);
    refused(wrong("camera", "projection = 'orthographic'\nheight = 0"), 2, &["a.toml:3:10:", "above 0"]);
    refused(wrong("camera", "projection = 'orthographic'\nfov = 40"), 2, &["a.toml:3:1:", "`fov`"]);
    refused(wrong("camera", "medium = 'water'"), 2, &["a.toml:2:10:", "`water`"]);
}

#[test]
fn picture_settings_out_of_range_are_refused() {
    for (line, part) in [
        ("width = -1", "whole number from 1"),
        ("width = 0", "whole number from 1"),
        ("height = 1e3", "whole number"),
        ("samples = 9223372036854775807", "from 1 to 256"),
        ("samples = 0x7fffffffffffffffffffffff", "from 1 to 256"),
        ("depth = 1e9", "whole number"),
        ("depth = 1000000000", "from 0 to 10000"),
        ("cutoff = 2", "from 0 to 1"),
        ("cutoff = nan", "finite"),
        ("shadows = 'soft'", "straight"),
    ] {
        let text = refused(wrong("render", line), 2, &[part]);
        assert!(text.contains("a.toml:2:"), "{text}");
    }
    refused(wrong("render", "width = 65536\nheight = 65536"), 4, &["a.toml:1:", "65536 by 65536"]);
    refused(wrong("render", "width = 4294967295\nheight = 4294967295"), 4, &["a.toml:1:"]);
}

#[test]
fn materials_out_of_range_are_refused() {
    let material = |lines: &str| toml(&format!("[[material]]\nname = 'a'\n{lines}\n"));
    for ior in ["0", "-1", "nan", "inf", "1e-30", "1e30"] {
        refused(material(&format!("type = 'dielectric'\nior = {ior}")), 2, &["a.toml:4:7:", "`ior`"]);
    }
    for (lines, part) in [
        ("type = 'dielectric'", "`ior` or `glass`"),
        ("type = 'dielectric'\nior = 1.5\nglass = 'bk7'", "not both"),
        ("type = 'dielectric'\nior = 1.5\nabsorption = [-1, 0, 0]", "at least 0"),
        ("type = 'dielectric'\nior = 1.5\nabsorption = 1\ncolor = 1", "not both"),
        ("type = 'dielectric'\nior = 1.5\ncolor = 2\ndistance = 1", "at most 1"),
        ("type = 'dielectric'\nior = 1.5\ncolor = 0.5\ndistance = 0", "above 0"),
        ("type = 'dielectric'\nior = 1.5\ndistance = 1", "no `color`"),
        ("type = 'dielectric'\nior = 1.5\npriority = -2147483648", "from -2147483647"),
        ("type = 'diffuse'\ncolor = -0.5", "at least 0"),
        ("type = 'diffuse'\ncolor = 1.5", "at most 1"),
        ("type = 'diffuse'\ncolor = 0.5\nchecker = { even = 0, odd = 1 }", "not both"),
        ("type = 'diffuse'\nchecker = { even = 0, odd = 1, size = 0 }", "above 0"),
        ("type = 'diffuse'\nhighlight = { exponent = -1 }", "0 to 1e6"),
        ("type = 'diffuse'\nhighlight = { color = 1 }", "`exponent`"),
        ("type = 'emissive'", "`emission`"),
        ("type = 'conductor'\neta = 1", "both `eta` and `k`"),
        ("type = 'conductor'\neta = 0\nk = 1", "between 0.001"),
        ("type = 'conductor'\neta = 1\nk = 1e9", "at most 1000"),
        ("type = 'alpha'\nopacity = 1.5", "0 to 1"),
        ("type = 'diffuse'\ntexture = 'none.png'", "none.png"),
    ] {
        let text = refused(material(lines), 2, &[part]);
        assert!(text.contains("a.toml:"), "{text}");
    }
    refused(toml("[[material]]\ntype = 'diffuse'\n"), 2, &["a.toml:1:", "needs `name`"]);
    let twice = "[[material]]\nname = 'a'\ntype = 'diffuse'\n".repeat(2);
    refused(toml(&twice), 2, &["a.toml:5:8:", "`a` already"]);
    warned(material("type = 'mirror'\nreflectance = 0.8\ncolor = 0.5"), &["a.toml:1:", "`a`", "1.3"]);
    let near = material("type = 'dielectric'\nior = 1.0000001").unwrap();
    assert_eq!(near.scene.media[1].ior, 1.000_000_1);
}

#[test]
fn lights_out_of_range_are_refused() {
    let light = |lines: &str| toml(&format!("[[light]]\n{lines}\n"));
    for (lines, part) in [
        ("type = 'point'\nintensity = 1", "needs `position`"),
        ("type = 'point'\nposition = [0, 0, 0]\nintensity = -1", "at least 0"),
        ("type = 'directional'\nintensity = 1", "a direction or a target"),
        ("type = 'directional'\nintensity = 1\ndirection = [0, 0, 0]", "not 0"),
        ("type = 'directional'\nintensity = 1\ndirection = [0, 1, 0]\ntarget = [0, 0, 0]", "not both"),
        ("type = 'spot'\nposition = [1, 2, 3]\ntarget = [1, 2, 3]\nintensity = 1", "is its position"),
        ("type = 'spot'\nposition = [1, 2, 3]\ntarget = [0, 0, 0]\ninner = 40\nintensity = 1", "exceeds"),
        ("type = 'spot'\nposition = [1, 2, 3]\ntarget = [0, 0, 0]\nouter = 91\nintensity = 1", "0 to 90"),
        ("type = 'point'\nposition = [1e30, 0, 0]\nintensity = 1", "1.844e18"),
    ] {
        refused(light(lines), 2, &["a.toml:", part]);
    }
}

#[test]
fn transforms_that_destroy_a_mesh_are_refused_by_its_name() {
    let mesh = |lines: &str| {
        toml(&format!("[[material]]\nname = 'm'\ntype = 'diffuse'\n[[mesh]]\nname = 'vase'\nmaterial = 'm'\n{lines}\n"))
    };
    for (lines, part) in [
        ("shape = 'box'\ntransform = { scale = 0 }", "singular"),
        ("shape = 'box'\ntransform = { scale = [1, 0, 1] }", "singular"),
        ("shape = 'box'\ntransform = { scale = 1e30 }", "1e30"),
        ("shape = 'box'\ntransform = { matrix = [1,0,0,0, 0,1,0,0, 1,1,0,0, 0,0,0,1] }", "singular"),
        ("shape = 'box'\ntransform = { matrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1] }", "affine"),
        ("shape = 'box'\ntransform = { translate = [1e30, 0, 0] }", "beyond"),
        ("shape = 'sphere'\ntransform = { scale = [1, 2, 1] }", "tessellation"),
        ("shape = 'sphere'\nflip = true", "tessellation"),
        ("shape = 'torus'\nminor = 2", "`minor`"),
        ("shape = 'torus'\nmajor = 1e30", "1.844e18"),
        ("shape = 'lathe'\nprofile = [[1e30, 0], [1, 1]]", "1.844e18"),
        ("shape = 'heightfield'\nsize = [1, 1]\ndepth = 1\nwaves = [{ amplitude = 2, wavelength = 1 }]", "depth"),
    ] {
        refused(mesh(lines), 2, &["a.toml:", "`vase`", part]);
    }
    for (lines, part) in [
        ("shape = 'box'\ntransform = { scale = nan }", "finite"),
        ("shape = 'box'\ntransform = { matrix = [1, 0] }", "list of 16"),
        ("shape = 'sphere'\nradius = 0", "above 0"),
        ("shape = 'sphere'\nradius = -1", "above 0"),
        ("shape = 'box'\nsize = [1, 1, 0]", "above 0"),
        ("shape = 'lathe'\nprofile = [[1, 0]]", "two points"),
        ("shape = 'lathe'", "needs `profile`"),
        ("shape = 'sphere'\nfile = 'a.obj'", "not both"),
        ("", "a `file` or a `shape`"),
        ("shape = 'grid'\ntessellation = 0", "whole number from 1"),
        ("shape = 'grid'\ntessellation = 4000000000", "whole number from 1"),
    ] {
        refused(mesh(lines), 2, &["a.toml:", part]);
    }
    refused(mesh("shape = 'sphere'\ntessellation = 16384"), 4, &["triangles"]);
    refused(toml("[[mesh]]\nshape = 'sphere'\n"), 2, &["a.toml:1:", "`material`"]);
}

#[test]
fn a_scene_that_names_itself_as_a_model_is_refused() {
    refused(Folder::new().with("a.toml", "[[mesh]]\nfile = 'a.toml'\n").load("a.toml"), 2, &["a.toml", "no triangles"]);
}

#[test]
fn an_empty_scene_is_a_warning() {
    warned(toml(""), &["a.toml", "no [[mesh]]"]);
}

#[test]
fn the_sampler_of_every_key_loads_as_it_says() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/sampler.toml");
    let loaded = load::scene(&path, &LoadOptions::default()).unwrap();
    let scene = &loaded.scene;
    assert_eq!((scene.materials.len(), scene.lights.len()), (9 + 3, 3));
    // Nine shapes, and the house in three materials.
    assert_eq!(scene.objects.len(), 9 + 3);
    assert_eq!(scene.objects.len(), scene.geometry.len());
    let Shape::Sphere(ball) = &scene.geometry[0].shape else { panic!("the ball is exact") };
    assert_eq!((ball.centre, ball.radius), (glam::Vec3::new(0.0, 3.0, 0.0), 1.0));
    let text = fs::read_to_string(&path).unwrap();
    let first = 1 + text.lines().position(|l| l == "[[mesh]]").unwrap();
    assert_eq!(scene.objects[0].origin.line as usize, first);
    // The scaled sphere was mirrored: its triangles still face out.
    let ball = mesh(&loaded, 1);
    for i in 0..ball.triangles.len() {
        let [a, b, c] = ball.corners(i);
        assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
    }
    let kinds: Vec<&str> = loaded.report.warnings.iter().map(|w| w.message.as_str()).collect();
    for part in ["`nothing`", "not closed", "texture options", "texture coordinates"] {
        assert!(kinds.iter().any(|k| k.contains(part)), "{part}: {kinds:?}");
    }
}

#[test]
fn places_are_reckoned_in_f64_and_rounded_once() {
    let scene = "[[material]]\nname = 'm'\ntype = 'diffuse'\n[[mesh]]\nshape = 'box'\nmaterial = 'm'\n\
                 size = [2, 0.1, 2]\ncenter = [0, -0.05, 0]\n";
    // In f32 the top would lie a little below 0.
    assert_eq!(mesh(&toml(scene).unwrap(), 0).bounds().hi.y, 0.0);
}

#[test]
fn a_model_by_itself_gets_a_camera_that_sees_all_of_it() {
    for scale in [1e-3, 1.0, 1e6] {
        let text = format!("v {scale} 0 0\nv 0 {scale} 0\nv 0 0 {scale}\nf 1 2 3\n");
        let loaded = obj(text).unwrap();
        let camera = &loaded.scene.camera;
        let view = (camera.target - camera.eye).as_dvec3().normalize();
        for p in &mesh(&loaded, 0).positions {
            let angle = (p.as_dvec3() - camera.eye.as_dvec3()).normalize().dot(view).acos().to_degrees();
            assert!(angle < 20.0, "{scale}: {p} at {angle}");
        }
        assert_eq!(loaded.scene.lights.len(), 2);
        assert_eq!(loaded.report.defaults.len(), 1);
    }
}

#[test]
fn errors_are_of_the_kind_their_exit_code_says() {
    assert!(matches!(obj("v a"), Err(Error::Input { line: 1, .. })));
    assert!(matches!(obj(""), Err(Error::File { .. })));
    assert!(matches!(toml("[camera]\nfov = 0\n"), Err(Error::Input { line: 2, column: Some(7), .. })));
}
