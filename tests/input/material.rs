//! MTL: what a material may say.

use super::*;

/// Case IO-04 of the catalogue.
#[test]
fn numbers_out_of_range_get_the_nearest_meaning_with_a_warning() {
    let base = |line: &str, part: &str| {
        let text = format!("newmtl m\nKd 0.25\n{line}\n");
        refused(mtl_strict(&text), 2, &["a.mtl:3:", part]);
        warned(mtl(&text), &["a.mtl:3:", part]).scene.materials[0].diffuse.clone()
    };
    let quarter = Colour::Constant(Rgb::splat(0.25));
    assert_eq!(mtl("newmtl m\nKd 0.25\n").unwrap().scene.materials[0].diffuse, quarter);
    for none in ["Kd", "Kd nan nan nan", "Kd -1.#IND00 0 0", "Kd x y z"] {
        assert_eq!(base(none, "left out"), quarter, "{none}");
    }
    for (line, part, rgb) in [
        ("Kd 0.5 -1 1", "below 0", [0.5, 0.0, 1.0]),
        ("Kd 1e30 0 0", "above 1", [1.0, 0.0, 0.0]),
        ("Kd 1.5 0 0", "above 1", [1.0, 0.0, 0.0]),
        ("Kd 255 51 0", "divided by 255", [1.0, 0.2, 0.0]),
        ("Kd 0,5 0,5 0,25", "decimal comma", [0.5, 0.5, 0.25]),
        ("Kd rgb 0.5 0.5 0.5", "`rgb`", [0.5; 3]),
        ("Kd 0.5 0.75", "three numbers", [0.5, 0.75, 0.5]),
    ] {
        assert_eq!(base(line, part), Colour::Constant(Rgb::from(rgb)), "{line}");
    }
    let shiny = |ns: &str| warned(mtl(&format!("newmtl m\nKs 1\n{ns}\n")), &["a.mtl:3:"]).scene.materials[0].highlight;
    assert_eq!(shiny("Ns 10000000").unwrap().exponent, 1e6);
    assert_eq!((shiny("Ns -1.96"), shiny("Ns")), (None, None));
    let glow = |ke: &str| mtl(&format!("newmtl m\nKe {ke}\n")).unwrap().scene.materials[0].emission;
    assert_eq!((glow("20000"), glow("1e9")), (Rgb::splat(20_000.0), Rgb::splat(1e6)));
}

/// The materials by themselves; warnings are errors.
fn mtl_strict(text: &str) -> vitrum::Result<Loaded> {
    let model = format!("mtllib a.mtl\n{CORNERS}usemtl m\nf 1 2 3\n");
    Folder::new().with("a.obj", model).with("a.mtl", text).strict("a.obj")
}

#[test]
fn statements_that_are_not_understood_leave_the_rest_of_the_materials_alone() {
    for (line, part) in [
        ("Kd spectral f.rfl", "spectral"),
        ("Ks xyz 1 1 1", "spectral"),
        ("illum 300", "0 to 10"),
        ("illum", "missing"),
        ("illum -1", "0 to 10"),
        ("Ps 0.5", "`Ps`"),
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
fn an_impossible_index_is_mended_where_light_is_bent_and_ignored_elsewhere() {
    for (bad, ior) in [("-1", 1.5), ("0", 1.5), ("nan", 1.5), ("inf", 1e3), ("1e-30", 1.5), ("1e30", 1e3)] {
        let loaded = warned(mtl(&format!("newmtl m\nillum 7\nNi {bad}\n")), &["a.mtl:"]);
        assert_eq!(loaded.scene.media[1].ior, ior, "{bad}");
        assert!(mtl(&format!("newmtl m\nillum 2\nNi {bad}\n")).is_ok(), "{bad}");
    }
    let loaded = warned(mtl("newmtl m\nillum 7\n"), &["a.mtl:1:", "`m`", "1.5"]);
    assert_eq!(loaded.scene.media[1].ior, 1.5);
    assert_eq!(mtl("newmtl m\nillum 7\nNi 1.33\n").unwrap().scene.media[1].ior, 1.33);
}

#[test]
fn dissolve_wins_over_transparency_and_their_quarrel_is_a_warning() {
    let opacity = |text: &str| match mtl(&format!("newmtl m\n{text}\n")).unwrap().scene.materials[0].interface {
        Interface::Alpha { opacity, .. } => opacity,
        Interface::Opaque => 1.0,
        other => panic!("{other:?}"),
    };
    assert_eq!(opacity("d 0.25"), 0.25);
    assert_eq!(opacity("Tr 0.25"), 0.75);
    assert_eq!(opacity("d 1\nTr 0"), 1.0);
    assert_eq!(opacity("Tr 0.5\nd 0.25"), 0.25);
    assert_eq!(opacity("d -halo 0.5"), 0.5);
    warned(mtl("newmtl m\nd 1\nTr 1\n"), &["a.mtl:3:", "disagree", "`d` counts"]);
    warned(mtl("newmtl m\nd 1.5\n"), &["a.mtl:2:", "d 1.5"]);
    assert_eq!((opacity("d 1.000001"), opacity("d -0.000001"), opacity("d")), (1.0, 0.0, 1.0));
}

#[test]
fn transparency_alone_is_read_as_its_writer_means_it() {
    let interface = |text: &str| warned(mtl(text), &["a.mtl:", "`Tr 1`", "opacity"]).scene.materials[0].interface;
    assert_eq!(interface("newmtl m\nTr 1.000000\n"), Interface::Opaque);
    // In a file where opaque is `Tr 1`, less is less opaque.
    let text = "newmtl other\nTr 1\nnewmtl m\nTr 0.25\n";
    let of = |text: &str| mtl(text).unwrap().scene.materials[0].interface;
    assert_eq!(of(text), Interface::Alpha { opacity: 0.25, mask: None });
    assert_eq!(of("newmtl other\nTr 0\nnewmtl m\nTr 0.25\n"), Interface::Alpha { opacity: 0.75, mask: None });
}

#[test]
fn glass_with_a_colour_is_a_base_of_the_share_d() {
    let of = |lines: &str| {
        let loaded = mtl(&format!("newmtl m\nKd 0.8 0.2 0.2\nKs 0.5\n{lines}\n")).unwrap();
        (loaded.scene.materials[0].interface, loaded.scene.materials[0].diffuse.clone())
    };
    let red = Colour::Constant(Rgb::new(0.8, 0.2, 0.2));
    for illum in [4, 6, 9] {
        let cover = Interface::Alpha { opacity: 0.25, mask: None };
        assert_eq!(of(&format!("Ni 1.45\nd 0.25\nillum {illum}")), (cover, red.clone()), "{illum}");
        for opaque in ["", "d 1", "Tr 0"] {
            let text = format!("Ni 1.45\nillum {illum}\n{opaque}");
            assert_eq!(of(&text), (Interface::Opaque, red.clone()), "{illum} {opaque}");
        }
    }
    // As Maya writes opaque and half transparent ones.
    assert_eq!(of("illum 4\nTf 1 1 1\nNi 1").0, Interface::Opaque);
    assert_eq!(of("illum 4\nTf 0.5 0.5 0.5\nNi 1").0, Interface::Alpha { opacity: 0.5, mask: None });
    // Refracting glass has the rest of its base.
    let (interface, base) = of("Ni 1.5\nd 0.25\nillum 7");
    assert_eq!(interface, Interface::Dielectric { medium: 1, rule: FresnelRule::Fresnel, tint: Rgb::splat(0.75) });
    assert_eq!(base, Colour::Constant(Rgb::new(0.8, 0.2, 0.2) * 0.25));
    assert_eq!(of("Ni 1\nillum 7"), (Interface::Opaque, red));
}

#[test]
fn the_extension_for_physical_materials_makes_metals_and_coats() {
    let of = |lines: &str| mtl(&format!("newmtl m\nKd 1 0.5 0.25\n{lines}\n")).unwrap().scene.materials[0].clone();
    let metal = of("Pm 1");
    let source = MirrorSource::Traced;
    assert_eq!(metal.interface, Interface::Mirror { reflectance: Rgb::new(1.0, 0.5, 0.25), source });
    assert_eq!(metal.diffuse, Colour::Constant(Rgb::ZERO));
    assert_eq!(of("Pm 0\nPc 1").interface, Interface::Coated { ior: 1.5 });
    assert_eq!(of("Pr 0.5\nPm 0\nPc 0").interface, Interface::Opaque);
    warned(mtl("newmtl m\nPm 1\nPr 0.2\n"), &["a.mtl:1:", "rough"]);
}

#[test]
fn each_illumination_model_becomes_its_effect() {
    let of = |illum: u32| {
        let kd = if matches!(illum, 4 | 6 | 7 | 9) { 0.0 } else { 0.2 };
        let text = format!("newmtl m\nKa 0.1\nKd {kd}\nKs 0.3\nNs 50\nNi 1.5\nTf 0.9 0.8 0.7\nillum {illum}\n");
        let loaded = mtl(&text).unwrap();
        (loaded.scene.materials[0].clone(), loaded)
    };
    let (ks, tint) = (Rgb::splat(0.3), Rgb::new(0.9, 0.8, 0.7));
    let (m, _) = of(0);
    assert_eq!((m.emission, m.ambient, m.diffuse.clone()), (Rgb::splat(0.2), Rgb::ZERO, Colour::Constant(Rgb::ZERO)));
    for illum in 1..=10 {
        let (m, loaded) = of(illum);
        assert_eq!(m.ambient, Rgb::splat(0.1), "{illum}");
        let kd = if matches!(illum, 4 | 6 | 7 | 9) { 0.0 } else { 0.2 };
        assert_eq!(m.diffuse, Colour::Constant(Rgb::splat(kd)), "{illum}");
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
