//! Files that name other files.

use super::*;

/// Cases IO-10, IO-11 of the catalogue.
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

/// A picture of one pixel of that red, as a PFM.
fn pfm(red: f32) -> Vec<u8> {
    let mut bytes = b"PF\n1 1\n-1\n".to_vec();
    bytes.extend([red, 0.0, 0.0].iter().flat_map(|f| f.to_le_bytes()));
    bytes
}

const NAMED: &str = "newmtl m\nKd 0 1 0\n";

fn is_green(loaded: &Loaded) -> bool {
    loaded.scene.materials[0].diffuse == Colour::Constant(Rgb::Y)
}

#[test]
fn a_material_file_is_found_however_its_name_is_spelled() {
    for (statement, file) in [
        ("m.mtl", "m.mtl"),
        ("\"m.mtl\"", "m.mtl"),
        ("m.mtl # materials", "m.mtl"),
        ("my\\ box.mtl", "my box.mtl"),
        ("my box.mtl", "my box.mtl"),
        ("M.MTL", "m.mtl"),
        (".\\m.mtl", "m.mtl"),
        ("file://m.mtl", "m.mtl"),
        ("my%20box.mtl", "my box.mtl"),
        ("nowhere.mtl m.mtl", "m.mtl"),
        ("C:\\Users\\me\\m.mtl", "m.mtl"),
        ("/home/me/M.mtl", "m.mtl"),
        ("../other/m.mtl", "m.mtl"),
    ] {
        let model = format!("mtllib {statement}\n{CORNERS}usemtl m\nf 1 2 3\n");
        let loaded = Folder::new().with("a.obj", model).with(file, NAMED).load("a.obj").unwrap();
        assert!(is_green(&loaded), "{statement}");
    }
    let model = format!("mtllib r.mtl g.mtl\n{CORNERS}usemtl m\nf 1 2 3\nusemtl n\nf 3 2 1\n");
    let folder = Folder::new().with("a.obj", model).with("r.mtl", NAMED).with("g.mtl", "newmtl n\nKd 1 0 0\n");
    assert_eq!(folder.load("a.obj").unwrap().scene.materials.len(), 2);
    let model = format!("mtllib gone.mtl\n{CORNERS}usemtl m\nf 1 2 3\n");
    let own = Folder::new().with("a.obj", model).with("a.mtl", NAMED);
    assert!(is_green(&warned(own.load("a.obj"), &["a.obj:1:", "gone.mtl"])));
}

#[test]
fn a_material_is_found_however_its_name_is_spelled_and_by_its_bytes_first() {
    for name in ["m", "m # front", "\"m\"", "M"] {
        let model = format!("mtllib m.mtl\n{CORNERS}usemtl {name}\nf 1 2 3\n");
        assert!(is_green(&Folder::new().with("a.obj", model).with("m.mtl", NAMED).load("a.obj").unwrap()), "{name}");
    }
    let mut model = format!("mtllib m.mtl\n{CORNERS}").into_bytes();
    model.extend_from_slice(b"usemtl Gr\xfcn\nf 1 2 3\nusemtl Gr\xf6n\nf 3 2 1\n");
    let library = b"newmtl Gr\xfcn\nKd 0 1 0\nnewmtl Gr\xf6n\nKd 1 0 0\n";
    let loaded = Folder::new().with("a.obj", model).with("m.mtl", library).load("a.obj").unwrap();
    let colours: Vec<_> = loaded.scene.materials.iter().map(|m| m.diffuse.clone()).collect();
    assert_eq!(colours, [Colour::Constant(Rgb::Y), Colour::Constant(Rgb::X)]);
}

#[test]
fn a_picture_is_found_however_its_name_is_spelled_and_left_out_where_it_cannot_be_read() {
    let load = |statement: &[u8], file: &str, bytes: &[u8]| {
        let library = [b"newmtl m\nKd 1\nmap_Kd ", statement, b"\n"].concat();
        let model = format!("mtllib a.mtl\n{CORNERS}vt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
        Folder::new().with("a.obj", model).with("a.mtl", library).with(file, bytes).load("a.obj")
    };
    for (statement, file) in [
        (&b"t.pfm"[..], "t.pfm"),
        (b"\"my t.pfm\"", "my t.pfm"),
        (b"t.pfm # diffuse", "t.pfm"),
        (b"T.PFM", "t.pfm"),
        (b"C:\\maps\\t.pfm", "t.pfm"),
        (b"-colorspace sRGB t.pfm", "t.pfm"),
        (b"gr\xfcn.pfm", "gr\u{fc}n.pfm"),
        (b"\x93\xfa.pfm", "\u{65e5}.pfm"),
    ] {
        let loaded = load(statement, file, &pfm(0.25)).unwrap();
        assert_eq!(loaded.scene.textures[0].pixels.get(0), Rgb::new(0.25, 0.0, 0.0), "{file}");
    }
    for (bytes, part) in [(&b"\x89PNG\r\n\x1a\n"[..], "PNG"), (b"", "empty"), (b"DDS |\0\0\0", "DDS")] {
        let loaded = warned(load(b"t.png", "t.png", bytes), &["a.mtl:3:", "left out", part]);
        assert_eq!(loaded.scene.materials[0].diffuse, Colour::Constant(Rgb::ONE), "{part}");
    }
}

#[test]
fn files_in_a_folder_that_is_allowed_are_read() {
    let outside = Folder::new().with("m.mtl", NAMED);
    let name = outside.path("m.mtl").display().to_string();
    let folder = Folder::new().with("a.obj", format!("mtllib {name}\n{CORNERS}usemtl m\nf 1 2 3\n"));
    warned(folder.load("a.obj"), &["a.obj:1:", "outside", "--allow-outside", "[files] roots"]);
    let allow_outside = vec![outside.path("m.mtl").parent().unwrap().to_owned()];
    let options = LoadOptions { allow_outside, ..LoadOptions::default() };
    assert!(is_green(&load::scene(&folder.path("a.obj"), &options).unwrap()));
}

#[test]
fn texture_options_holes_and_masks_reach_the_scene() {
    let model = format!("mtllib a.mtl\n{CORNERS}vt 0.5 0.25\nusemtl m\nf 1/1 2/1 3/1\n");
    let load = |lines: &str| {
        let mut rgba = Vec::new();
        let mut encoder = png::Encoder::new(&mut rgba, 2, 1);
        encoder.set_color(png::ColorType::Rgba);
        encoder.write_header().unwrap().write_image_data(&[255, 0, 0, 255, 0, 0, 0, 51]).unwrap();
        let folder = Folder::new().with("a.obj", &model).with("a.mtl", format!("newmtl m\nKd 1\n{lines}\n"));
        folder.with("t.pfm", pfm(0.2)).with("hole.png", rgba).load("a.obj").unwrap()
    };
    let uv = |loaded: &Loaded| mesh(loaded, 0).uvs[0].to_array();
    assert_eq!(uv(&load("map_Kd -s 2 4 1 -o 0.5 0 0 t.pfm")), [1.5, 1.0]);
    let clamped = load("map_Kd -clamp on t.pfm");
    assert_eq!(clamped.scene.textures[0].wrap, [vitrum::scene::Wrap::Clamp; 2]);
    let masked = load("map_Kd t.pfm\nmap_d hole.png\nd 0.5");
    let Interface::Alpha { opacity: 0.5, mask: Some(mask) } = masked.scene.materials[0].interface else { panic!() };
    let mask = &masked.scene.textures[mask as usize].pixels;
    assert_eq!((mask.get(0).x, mask.get(1).x, mask.bytes()), (1.0, 0.2, 2));
    let cut = load("map_Kd hole.png");
    assert!(matches!(cut.scene.materials[0].interface, Interface::Alpha { opacity: 1.0, mask: Some(_) }));
    assert_eq!(cut.report.warnings, []);
    assert_eq!(cut.scene.textures[0].pixels.bytes(), 6);
}
