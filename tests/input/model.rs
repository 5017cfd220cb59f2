//! OBJ: faces and their indices.

use super::*;

/// Case IO-01 of the catalogue.
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

/// Case IO-03 of the catalogue.
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

/// Case RV-03 of the catalogue.
#[test]
fn normals_without_a_direction_leave_the_face_flat() {
    for bad in ["0 0 0", "nan 0 1", "inf 0 0"] {
        let loaded = warned(obj(format!("{CORNERS}vn {bad}\nvn 0 0 1\nf 1//1 2//2 3//2\n")), &["a.obj:6:", "normal"]);
        assert!(mesh(&loaded, 0).normals.is_empty(), "{bad}");
    }
}

/// Case IO-02 of the catalogue.
#[test]
fn corners_that_are_not_finite_drop_their_faces_and_are_counted() {
    let not_finite = "a corner that is not finite";
    for (bad, reason) in [
        ("nan 0 0", not_finite),
        ("1e999 0 0", not_finite),
        ("-infinity 0 0", not_finite),
        ("1e30 0 0", "a corner beyond the largest coordinate"),
    ] {
        let folder = Folder::new().with("a.obj", format!("{CORNERS}v {bad}\nf 1 2 4\nf 1 2 3\nf 4 2 3 1\n"));
        let loaded = warned(folder.load("a.obj"), &["a.obj:5:", "not finite", "and 1 more"]);
        assert_eq!((triangles(&loaded), loaded.report.dropped[reason]), (1, 2), "{bad}");
        refused(folder.strict("a.obj"), 2, &["a.obj:5:", "not finite"]);
    }
}

/// Case IO-14 of the catalogue.
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

/// Cases IO-05, IO-06, IO-07 of the catalogue.
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

/// Case IO-08 of the catalogue.
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

/// Case IO-09 of the catalogue.
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
