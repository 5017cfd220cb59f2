//! STL models.

use super::{corners, load_as, mesh, refused, warns};

/// A tetrahedron, its triangles counter-clockwise from outside.
const TETRAHEDRON: [[[f32; 3]; 3]; 4] = [
    [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    [[0.0, 0.0, 0.0], [-0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
];

fn binary(comment: &str, announced: u32) -> Vec<u8> {
    let mut file = vec![b' '; 80];
    file[..comment.len()].copy_from_slice(comment.as_bytes());
    file.extend(announced.to_le_bytes());
    for triangle in TETRAHEDRON {
        file.extend([0; 12]);
        file.extend(triangle.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        file.extend([0; 2]);
    }
    file
}

fn ascii() -> String {
    let facet = |t: [[f32; 3]; 3]| {
        let corners: String = t.iter().map(|[x, y, z]| format!("      vertex {x:e} {y} {z}\r\n")).collect();
        format!("  facet normal 0 0 0\r\n    OUTER LOOP\r\n{corners}    ENDLOOP\r\n  endfacet\r\n")
    };
    format!("solid made by hand\r\n{}endsolid\r\n", TETRAHEDRON.map(facet).concat())
}

#[test]
fn both_kinds_give_the_same_welded_mesh_even_if_a_binary_one_begins_with_solid() {
    for file in [binary("by hand", 4), binary("solid by hand", 4), ascii().into_bytes()] {
        let loaded = load_as("a.stl", file).unwrap();
        let mesh = mesh(&loaded, 0);
        assert_eq!(mesh.positions.len(), 4);
        assert_eq!(corners(mesh), TETRAHEDRON.map(|t| t.map(glam::Vec3::from)));
        assert!(loaded.report.warnings.is_empty());
    }
}

#[test]
fn a_wrong_count_is_told_and_the_triangles_that_are_there_are_read() {
    for announced in [0, 3, u32::MAX] {
        let loaded = load_as("a.stl", binary("by hand", announced)).unwrap();
        assert_eq!(mesh(&loaded, 0).triangles.len(), 4);
        warns(&loaded, &format!("announces {announced} triangles, and the file holds 4"));
    }
}

#[test]
fn a_word_that_is_no_number_costs_its_facet_only() {
    let text = ascii().replacen("vertex 1e0 0 0", "vertex x 0 0", 1);
    let loaded = load_as("a.stl", text).unwrap();
    assert_eq!(mesh(&loaded, 0).triangles.len(), 3);
    warns(&loaded, "a.stl:7: faces with a corner that is not finite");
}

#[test]
fn a_text_that_ends_early_is_told_and_a_byte_order_mark_is_no_part_of_it() {
    let whole = ascii();
    let without_end = whole.trim_end().strip_suffix("endsolid").unwrap();
    let loaded = load_as("a.stl", without_end).unwrap();
    assert_eq!(mesh(&loaded, 0).triangles.len(), 4);
    warns(&loaded, "ends without `endsolid`");
    let marked = load_as("a.stl", format!("\u{feff}{whole}")).unwrap();
    assert_eq!(mesh(&marked, 0).triangles.len(), 4);
    assert!(marked.report.warnings.is_empty());
}

#[test]
fn what_is_no_model_is_refused_with_the_reason() {
    refused(load_as("a.stl", "solid nothing\nendsolid\n"), "no facet");
    refused(load_as("a.stl", "version https"), "fewer than a header");
}
