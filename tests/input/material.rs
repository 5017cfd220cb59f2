//! MTL: what a material may say.

use super::*;

/// Case IO-04 of the catalogue.
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

/// Case RF-14 of the catalogue.
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

/// Case AB-10 of the catalogue.
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
