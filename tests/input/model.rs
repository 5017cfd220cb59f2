//! OBJ: faces and their indices.

use super::*;

/// Case IO-01 of the catalogue.
#[test]
fn a_face_whose_index_points_nowhere_is_left_out_with_its_line_and_the_others_are_drawn() {
    for (face, parts) in [
        ("f 1 2 7", ["a.obj:4:", "vertex 7", "3"]),
        ("f 0 1 2", ["a.obj:4:", "vertex 0", "count from 1"]),
        ("f -1 -2 -9", ["a.obj:4:", "vertex 6 places", "before the first"]),
        ("f -9223372036854775808 1 2", ["a.obj:4:", "-9223372036854775808", "out of range"]),
        ("f 99999999999999999999 1 2", ["a.obj:4:", "99999999999999999999", "out of range"]),
        ("f 4294967296 1 2", ["a.obj:4:", "4294967296", "out of range"]),
        ("f a 1 2", ["a.obj:4:", "`a`", "no index"]),
        ("f /1 1 2", ["a.obj:4:", "`/1`", "no vertex"]),
    ] {
        refused(obj(format!("{CORNERS}{face}\n")), 2, &["no triangles", parts[0], parts[1], parts[2]]);
        let folder = Folder::new().with("a.obj", format!("{CORNERS}{face}\nf 1 2 3\n"));
        let loaded = warned(folder.load("a.obj"), &parts);
        assert_eq!((triangles(&loaded), loaded.report.dropped.values().sum::<u64>()), (1, 1), "{face}");
        refused(folder.strict("a.obj"), 2, &parts);
    }
    warned(obj(format!("{CORNERS}f 1/2/3/4 2 3\n")), &["a.obj:4:", "1/2/3/4", "at most three"]);
}

#[test]
fn an_attribute_that_cannot_be_had_is_left_out_as_where_the_file_has_none() {
    let bare = |loaded: &Loaded| mesh(loaded, 0).normals.is_empty() && mesh(loaded, 0).uvs.is_empty();
    for (text, parts) in [
        ("vn 0 0 1\nf 1//6148914691236517207 2//1 3//1\n", ["a.obj:5:", "6148914691236517207"]),
        ("vn 0 0 1\nf 1//2 2//1 3//1\n", ["a.obj:5:", "normal 2; the file has 1"]),
        ("vt 0 0\nf 1/2 2/1 3/1\n", ["a.obj:5:", "texture coordinate 2"]),
        ("vt 0 0\nf 1/0 2/1 3/1\n", ["a.obj:5:", "count from 1"]),
        ("vt nan 0\nf 1/1 2/1 3/1\n", ["a.obj:5:", "without texture coordinates"]),
        ("vt -1.#IND00 1.#QNAN0\nf 1/1 2/1 3/1\n", ["a.obj:5:", "without texture coordinates"]),
        ("vn -nan(ind) 0 1\nf 1//1 2//1 3//1\n", ["a.obj:5:", "normal"]),
    ] {
        let folder = Folder::new().with("a.obj", format!("{CORNERS}{text}"));
        let loaded = warned(folder.load("a.obj"), &parts);
        assert!(triangles(&loaded) == 1 && bare(&loaded), "{text}");
        refused(folder.strict("a.obj"), 2, &parts);
    }
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
fn numbers_that_are_none_cost_their_face_and_not_the_model() {
    for (line, parts) in [
        ("v 0", ["a.obj:4:", "`v 0`", "too few"]),
        ("v a b c", ["a.obj:4:", "`a`", "no number"]),
        ("v", ["a.obj:4:", "`v`", "too few"]),
        ("v 0 0 x", ["a.obj:4:", "`x`", "no number"]),
    ] {
        let folder = Folder::new().with("a.obj", format!("{CORNERS}{line}\nf 1 2 3\nf 1 2 4\n"));
        assert_eq!(triangles(&warned(folder.load("a.obj"), &parts)), 1, "{line}");
        refused(folder.strict("a.obj"), 2, &parts);
    }
    warned(obj(format!("{CORNERS}vt\nvn 0 0\nf 1/1/1 2/1/1 3/1/1\n")), &["a.obj:4:", "`vt`", "too few", "and 1 more"]);
}

#[test]
fn numbers_in_the_spelling_of_a_country_or_a_language_are_read_and_told() {
    for (line, place) in [("v 0,5 0 -1,25", [0.5, 0.0, -1.25]), ("v 5D-1 1.0d+00 2", [0.5, 1.0, 2.0])] {
        let loaded = warned(obj(format!("v 0 0 0\nv 1 0 0\n{line}\nf 1 2 3\n")), &["a.obj:3:", line, "point"]);
        assert_eq!(mesh(&loaded, 0).positions[2].to_array(), place);
    }
    let loaded = warned(obj("v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n"), &["a.obj:1:", "z = 0", "and 2 more"]);
    assert_eq!(triangles(&loaded), 1);
    let loaded = warned(obj("V 0 0 0\nV 1 0 0\nV 0 1 0\nF 1 2 3\n"), &["a.obj:1:", "capitals", "and 3 more"]);
    assert_eq!(triangles(&loaded), 1);
    let loaded = warned(obj(format!("{CORNERS}vt 0.5 0\nf 1 /1 2 /1 3 /1\n")), &["a.obj:5:", "blank before", "/1"]);
    assert_eq!(mesh(&loaded, 0).uvs, [glam::Vec2::new(0.5, 0.0)]);
}

#[test]
fn utf16_with_a_mark_is_read() {
    let text = format!("{CORNERS}f 1 2 3\n");
    let little: Vec<u8> = [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_be_bytes).collect();
    assert_eq!((triangles(&obj(little).unwrap()), triangles(&obj(big).unwrap())), (1, 1));
}

#[test]
fn colours_of_vertices_show_unless_a_picture_or_the_scene_gives_the_colour() {
    let text = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n";
    let loaded = obj(text).unwrap();
    assert_eq!(mesh(&loaded, 0).colours, [glam::Vec3::X, glam::Vec3::Y, glam::Vec3::Z]);
    assert_eq!(loaded.scene.materials[0].diffuse, Colour::Corners { texture: None, scale: Rgb::ONE });
    let text = text.replace("f 1", "mtllib a.mtl\nusemtl m\nf 1");
    let loaded = Folder::new().with("a.obj", text).with("a.mtl", "newmtl m\nKd 0.5\n").load("a.obj").unwrap();
    assert_eq!(loaded.scene.materials[0].diffuse, Colour::Corners { texture: None, scale: Rgb::splat(0.5) });
}

#[test]
fn smoothing_groups_make_normals_where_the_file_has_none() {
    let tent = "v 0 0 0\nv 0 0 1\nv 1 1 0\nv 1 1 1\nv 2 0 0\nv 2 0 1\n";
    let of = |faces: &str| obj(format!("{tent}{faces}")).unwrap();
    let smooth = of("s 1\nf 1 2 4 3\nf 3 4 6 5\n");
    let ridge = mesh(&smooth, 0).normals.iter().filter(|n| (**n - glam::Vec3::Y).length() < 1e-6).count();
    assert_eq!(ridge, 2);
    for faces in ["f 1 2 4 3\nf 3 4 6 5\n", "s off\nf 1 2 4 3\nf 3 4 6 5\n", "s 1\ns 0\nf 1 2 4 3\nf 3 4 6 5\n"] {
        assert!(mesh(&of(faces), 0).normals.is_empty(), "{faces}");
    }
    let apart = of("s 1\nf 1 2 4 3\ns 2\nf 3 4 6 5\n");
    assert!(mesh(&apart, 0).normals.iter().all(|n| n.x.abs() > 0.7));
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
fn files_without_triangles_are_refused_and_what_they_hold_is_told() {
    for (text, part) in [
        (&b""[..], "empty"),
        (b"\0\0\0\0\0\0\0\0\0\0", "binary"),
        (b"# nothing\n", "no face"),
        (CORNERS.as_bytes(), "3 vertices"),
        (b"v 0 0 0\nf 1 1 1\n", "coincide"),
        (b"v 0 0 0\nv 1 0 0\nl 1 2\n", "a.obj:3: points and lines"),
        (b"v 0 0 0\ncstype bspline\nsurf 0 1 0 1 1\n", "free-form"),
        (b"\x1f\x8b\x08\0\0", "gunzip"),
        (b"<!DOCTYPE html><html></html>", "web page"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "git lfs pull"),
        (b"ply\nformat ascii 1.0\n", "PLY"),
    ] {
        refused(obj(text), 2, &["a.obj", "no triangles", part]);
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
fn bytes_that_are_not_utf8_matter_in_scenes_alone() {
    assert_eq!(obj(b"# caf\xe9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap().report.warnings, []);
    refused(obj(b"v 0 0 0\nv \xff 0 0\nf 1 2 1\n"), 2, &["a.obj:2:", "no number"]);
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
    let text = format!("{star}{face}\nf 1 2 3\n");
    assert_eq!(triangles(&warned(obj(text), &["a.obj:20001:", "20000 corners"])), 1);
}

#[test]
fn points_lines_and_unknown_statements_are_left_out_with_a_warning() {
    warned(obj(format!("{CORNERS}l 1 2\np 1\nf 1 2 3\n")), &["a.obj:4:", "points and lines", "and 1 more"]);
    warned(obj(format!("{CORNERS}curv2 1 2\nf 1 2 3\n")), &["a.obj:4:", "`curv2`", "free-form"]);
    warned(obj(format!("{CORNERS}wobble 1 2\nf 1 2 3\n")), &["a.obj:4:", "`wobble`"]);
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
fn a_ground_plane_and_a_stray_face_do_not_decide_the_camera() {
    let house_at = |z: i32| -> String {
        let far = z + 10;
        (0..40).map(|i| format!("v {i} 0 {z}\nv {i} 10 {z}\nv {i} 0 {far}\nf -3 -2 -1\n")).collect()
    };
    let house = house_at(0);
    let distance = |text: &str| {
        let camera = obj(text).unwrap().scene.camera;
        (camera.eye - camera.target).length()
    };
    let alone = distance(&house);
    let ground = "v -9e3 0 -9e3\nv 9e3 0 -9e3\nv 9e3 0 9e3\nv -9e3 0 9e3\nf -4 -1 -2 -3\n";
    assert_eq!(distance(&format!("{house}{ground}")), alone);
    assert_eq!(distance(&format!("{house}v 1e6 1e6 1e6\nv 1000001 1e6 1e6\nv 1e6 1000001 1e6\nf -3 -2 -1\n")), alone);
    let two_houses = format!("{house}{}", house_at(500));
    assert!(distance(&two_houses) > 2.0 * alone);
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
        assert_eq!(loaded.scene.lights.len(), 3);
        assert_eq!(loaded.report.defaults.len(), 1);
    }
}
