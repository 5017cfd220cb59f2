//! PLY models.

use glam::Vec3;
use vitrum::scene::{Colour, Rgb};

use super::{Folder, corners, load_as, mesh, refused, warnings, warns};

/// A square of one quad in the plane z = 2 with a colour at each corner, in an encoding.
fn square(encoding: &str) -> Vec<u8> {
    let mut file = format!(
        "ply\nformat {encoding} 1.0\ncomment made by hand\nelement vertex 4\nproperty double x\nproperty float y\n\
         property short z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n\
         element face 1\nproperty uchar flags\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    for (x, y, colour) in [(0.0, 0.0, 255), (1.0, 0.0, 0), (1.0, 1.0, 0), (0.0, 1.0, 128)] {
        match encoding {
            "ascii" => file.extend(format!("{x} {y} 2 {colour} 0 255 9\n").bytes()),
            "binary_little_endian" => {
                file.extend(f64::to_le_bytes(x));
                file.extend(f32::to_le_bytes(y));
                file.extend([2, 0, colour, 0, 255, 9]);
            }
            _ => {
                file.extend(f64::to_be_bytes(x));
                file.extend(f32::to_be_bytes(y));
                file.extend([0, 2, colour, 0, 255, 9]);
            }
        }
    }
    match encoding {
        "ascii" => file.extend(b"7 4 0 1 2 3\n"),
        "binary_little_endian" => file.extend([7, 4, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0]),
        _ => file.extend([7, 4, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3]),
    }
    file
}

#[test]
fn the_three_encodings_give_the_same_mesh_with_linear_colours() {
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let loaded = load_as("a.ply", square(encoding)).unwrap();
        let mesh = mesh(&loaded, 0);
        let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 2.0));
        assert_eq!(corners(mesh), [[a, b, c], [a, c, d]], "{encoding}");
        // The sRGB code 128 is 0.21586 of white.
        let red = [1.0, 0.0, 0.0, 0.215_86];
        for (colour, red) in mesh.colours.iter().zip(red) {
            assert!((*colour - Vec3::new(red, 0.0, 1.0)).abs().max_element() < 1e-5, "{encoding}: {colour}");
        }
        let material = &loaded.scene.materials[loaded.scene.objects[0].material as usize];
        assert_eq!(material.diffuse, Colour::Corners { texture: None, scale: Rgb::ONE });
        assert!(warnings(&loaded).is_empty(), "{:?}", warnings(&loaded));
    }
}

#[test]
fn strips_turn_every_second_triangle_and_minus_one_begins_a_new_one() {
    let text = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
                element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
                0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n9 0 1 2 3 -1 2 3 4 5\n";
    let loaded = load_as("a.ply", text).unwrap();
    assert_eq!(mesh(&loaded, 0).triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]]);
    // All face +z.
    for [a, b, c] in corners(mesh(&loaded, 0)) {
        assert!((b - a).cross(c - a).z > 0.0);
    }
}

#[test]
fn normals_and_texture_coordinates_of_vertices_are_read() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n\
                element face 1\nproperty list uchar uint vertex_index\nend_header\n\
                0 0 0 0 0 2 0 0\n1 0 0 0 3 0 1 0\n0 1 0 0 0 1 0 1\n3 0 1 2\n";
    let loaded = load_as("a.ply", text).unwrap();
    let mesh = mesh(&loaded, 0);
    assert_eq!(mesh.corner_normals(0), Some([Vec3::Z, Vec3::Y, Vec3::Z]));
    assert_eq!(mesh.corner_uvs(0).unwrap()[2], glam::Vec2::Y);
}

#[test]
fn a_dented_polygon_is_cut_within_its_outline() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                element face 1\nproperty list uchar int vertex_indices\nend_header\n\
                0 0 0\n2 -1 0\n0.5 0 0\n2 1 0\n4 1 2 3 0\n";
    let loaded = load_as("a.ply", text).unwrap();
    let area: f32 = corners(mesh(&loaded, 0)).iter().map(|[a, b, c]| (b - a).cross(c - a).length() * 0.5).sum();
    // Two triangles of base 0.5 and height 1.
    assert!((area - 0.5).abs() < 1e-6, "{area}");
}

#[test]
fn faces_that_cannot_be_drawn_are_left_out_with_their_line_and_the_others_are_kept() {
    let head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                element face 4\nproperty list uchar int vertex_indices\nend_header\n\
                0 0 0\n1 0 0\n0 1 0\nabc 1 1\n";
    let loaded = load_as("a.ply", format!("{head}3 0 1 2\n3 0 1 9\n3 0 1 3\n2 0 1\n")).unwrap();
    assert_eq!(mesh(&loaded, 0).triangles, [[0, 1, 2]]);
    warns(&loaded, "a.ply:15: faces that name a vertex that does not exist");
    warns(&loaded, "a.ply:16: faces with a corner that is not finite");
    warns(&loaded, "a.ply:17: faces of fewer than three corners");
    warns(&loaded, "a.ply:13: words that are no numbers");
    assert_eq!(loaded.report.dropped.values().sum::<u64>(), 3);
    refused(load_as("a.ply", format!("{head}3 0 1 9\n")), "none of its faces");
}

#[test]
fn a_file_that_ends_early_shows_the_faces_that_it_has() {
    let whole = square("binary_little_endian");
    let text = String::from_utf8_lossy(&whole).into_owned();
    assert!(text.contains("element face 1\n"));
    let at = whole.windows(14).position(|w| w == b"element face 1").unwrap() + 13;
    let mut more = whole.clone();
    more.splice(at..=at, *b"4000000000");
    let loaded = load_as("a.ply", more).unwrap();
    assert_eq!(mesh(&loaded, 0).triangles.len(), 2);
    warns(&loaded, "1 of 4000000000 `face`");
}

#[test]
fn what_is_no_model_is_refused_with_the_reason() {
    refused(load_as("a.ply", "solid"), "is no PLY file");
    let points = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
                  end_header\n0 0 0\n";
    refused(load_as("a.ply", points), "1 points and no face");
}

#[test]
fn a_material_of_the_scene_replaces_the_colours_of_a_model() {
    let scene = "[[material]]\nname = \"red\"\ntype = \"diffuse\"\ncolor = [1, 0, 0]\n\
                 [[mesh]]\nfile = \"a.ply\"\nmaterial = \"red\"\n";
    let loaded = Folder::new().with("a.ply", square("ascii")).with("a.toml", scene).load("a.toml").unwrap();
    assert!(mesh(&loaded, 0).colours.is_empty());
    assert_eq!(loaded.scene.materials[0].diffuse, Colour::Constant(Rgb::X));
}
