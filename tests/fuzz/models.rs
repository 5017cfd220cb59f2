//! Small models in several formats to start from, written here.

/// PLY in each encoding, with everything that is read.
pub fn ply() -> Vec<Vec<u8>> {
    let head = |encoding: &str| {
        format!(
            "ply\nformat {encoding} 1.0\ncomment small\nelement vertex 5\nproperty float x\nproperty float y\n\
             property double z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float s\n\
             property float t\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n\
             property list uchar int vertex_indices\nproperty short flags\nelement tristrips 1\n\
             property list int int vertex_indices\nelement camera 1\nproperty list ushort float view\nend_header\n"
        )
    };
    let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.4, 0.3, 0.0], [0.0, 1.0, 1.0]];
    let mut text = head("ascii");
    for [x, y, z] in vertices {
        text += &format!("{x} {y} {z} 0 0 1 {x} {y} 255 128 0\n");
    }
    text += "4 0 1 2 3 7\n3 0 1 4 7\n5 0 1 2 -1 4\n2 0.5 1e3\n";
    let binary = |big: bool| {
        let mut file = head(if big { "binary_big_endian" } else { "binary_little_endian" }).into_bytes();
        let mut put = |mut bytes: Vec<u8>| {
            if big {
                bytes.reverse();
            }
            file.extend(bytes);
        };
        for [x, y, z] in vertices {
            for number in [x, y] {
                put(f32::to_le_bytes(number).to_vec());
            }
            put(f64::from(z).to_le_bytes().to_vec());
            for number in [0.0, 0.0, 1.0, x, y] {
                put(f32::to_le_bytes(number).to_vec());
            }
            for code in [255, 128, 0] {
                put(vec![code]);
            }
        }
        for corners in [vec![0, 1, 2, 3], vec![0, 1, 4]] {
            put(vec![corners.len() as u8]);
            corners.into_iter().for_each(|i: i32| put(i.to_le_bytes().to_vec()));
            put(7_i16.to_le_bytes().to_vec());
        }
        for i in [5_i32, 0, 1, 2, -1, 4] {
            put(i.to_le_bytes().to_vec());
        }
        put(2_u16.to_le_bytes().to_vec());
        for x in [0.5_f32, 1e3] {
            put(x.to_le_bytes().to_vec());
        }
        file
    };
    vec![text.into_bytes(), binary(false), binary(true)]
}

/// STL of both kinds.
pub fn stl() -> Vec<Vec<u8>> {
    let triangles = [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0; 3]]];
    let mut binary = vec![b'x'; 80];
    binary.extend(2_u32.to_le_bytes());
    let mut text = String::from("solid small\n");
    for triangle in triangles {
        binary.extend([0; 12]);
        text += "facet normal 0 0 1\nouter loop\n";
        for [x, y, z] in triangle {
            binary.extend([x, y, z].iter().flat_map(|c: &f32| c.to_le_bytes()));
            text += &format!("vertex {x} {y} {z}\n");
        }
        text += "endloop\nendfacet\n";
        binary.extend([0; 2]);
    }
    text += "endsolid small\n";
    vec![binary, text.into_bytes()]
}
