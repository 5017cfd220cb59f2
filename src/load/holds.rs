//! Kinds of files, told by their first bytes.

/// Returns the content of a file that is no model in the format of its name, with the cure.
pub(super) fn content(bytes: &[u8]) -> Option<&'static str> {
    let start = bytes.trim_ascii_start();
    let begins = |text: &[u8]| start.len() >= text.len() && start[..text.len()].eq_ignore_ascii_case(text);
    let exactly: [(&[u8], &str); 22] = [
        (b"\x1f\x8b", "gzip data; unpack it with `gunzip`"),
        (b"PK\x03\x04", "a ZIP archive; unpack it"),
        (b"BZh", "bzip2 data; unpack it with `bunzip2`"),
        (b"\x28\xb5\x2f\xfd", "Zstandard data; unpack it with `unzstd`"),
        (b"\xfd7zXZ\0", "xz data; unpack it with `unxz`"),
        (b"7z\xbc\xaf\x27\x1c", "a 7z archive; unpack it"),
        (b"Rar!", "a RAR archive; unpack it"),
        (b"glTF", "a binary glTF model; name it .glb"),
        (b"Kaydara FBX Binary", "an FBX model; convert it to OBJ or glTF"),
        (b"BLENDER", "a Blender file; export it as OBJ or glTF"),
        (b"PXR-USDC", "a USD scene; convert it to OBJ or glTF"),
        (b"\x89PNG", "a PNG picture, no model"),
        (b"\xff\xd8\xff", "a JPEG picture, no model"),
        (b"GIF8", "a GIF picture, no model"),
        (b"DDS ", "a DDS picture, no model"),
        (b"%PDF", "a PDF document, no model"),
        (b"MZ", "a Windows program, no model"),
        (b"\x7fELF", "a program or object file, no model"),
        (b"\x64\x86", "an object file of a compiler, no model"),
        (b"\x4c\x01", "an object file of a compiler, no model"),
        (b"Extended Model", "a MilkShape model; convert it to OBJ or glTF"),
        (b"MM\0\0", "a 3DS model; convert it to OBJ or glTF"),
    ];
    if let Some((_, what)) = exactly.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return Some(what);
    }
    let texts: [(&[u8], &str); 16] = [
        (b"version https://git-lfs", "a pointer of Git LFS, not the file itself; fetch it with `git lfs pull`"),
        (b"version https://hawser", "a pointer of Git LFS, not the file itself; fetch it with `git lfs pull`"),
        (b"/annex/objects/", "a pointer of git-annex, not the file itself; fetch it with `git annex get`"),
        (b"<!doctype html", "a web page; download the file itself"),
        (b"<html", "a web page; download the file itself"),
        (b"<?xml", "an XML document, such as Collada or X3D; convert it to OBJ or glTF"),
        (b"<collada", "a Collada model; convert it to OBJ or glTF"),
        (b"<", "markup, such as a web page or XML; download the model itself, or convert it to OBJ or glTF"),
        (b"ply\n", "a PLY model; name it .ply"),
        (b"ply\r", "a PLY model; name it .ply"),
        (b"solid ", "an STL model; name it .stl"),
        (b"#usda", "a USD scene; convert it to OBJ or glTF"),
        (b"#vrml", "a VRML scene; convert it to OBJ or glTF"),
        (b"; FBX", "an FBX model; convert it to OBJ or glTF"),
        (b"{", "JSON, such as a glTF model; name it .gltf if it is one"),
        (b"off\n", "an OFF model; convert it to OBJ or PLY"),
    ];
    if let Some((_, what)) = texts.iter().find(|(text, _)| begins(text)) {
        return Some(what);
    }
    let binary_stl = bytes.get(80..84).is_some_and(|count| {
        let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]);
        count > 0 && bytes.len() as u64 == 84 + 50 * u64::from(count)
    });
    if binary_stl {
        return Some("a binary STL model; name it .stl");
    }
    if start.starts_with(b"newmtl ") || bytes.windows(8).take(4096).any(|w| w == b"\nnewmtl ") {
        return Some("materials (MTL), no model; render the .obj that names them");
    }
    match bytes {
        [] => Some("nothing: it is empty"),
        _ if bytes.iter().all(u8::is_ascii_whitespace) => Some("nothing but blanks"),
        _ if bytes.iter().take(512).filter(|&&b| b == 0).count() > 8 => Some("binary data of an unknown kind"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_model_is_told_by_its_first_bytes() {
        for (bytes, part) in [
            (&b"\x1f\x8b\x08\0"[..], "gzip"),
            (b"<!DOCTYPE html><html>", "web page"),
            (b"\n <HTML>", "web page"),
            (b"version https://git-lfs.github.com/spec/v1\noid", "Git LFS"),
            (b"ply\nformat ascii 1.0\n", "PLY"),
            (b"solid cube\nfacet", "STL"),
            (b"glTF\x02\0\0\0", ".glb"),
            (b"{\"asset\":{}}", ".gltf"),
            (b"# made by\nnewmtl red\nKd 1 0 0\n", "MTL"),
            (b"", "empty"),
            (b"\0\0\0\0\0\0\0\0\0\0\0\0", "binary"),
        ] {
            assert!(content(bytes).is_some_and(|what| what.contains(part)), "{part}");
        }
        assert_eq!(content(b"v 0 0 0\nl 1 2\n"), None);
        let mut stl = vec![0; 84 + 50];
        stl[80] = 1;
        assert!(content(&stl).is_some_and(|what| what.contains("binary STL")));
    }
}
