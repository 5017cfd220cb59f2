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
