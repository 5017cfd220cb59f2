//! Scene files.

use glam::Vec3;

use super::*;

/// A scene that is right but for one line in a table.
fn wrong(table: &str, line: &str) -> vitrum::Result<Loaded> {
    toml(&format!("[{table}]\n{line}\n"))
}

/// Case IO-19 of the catalogue.
#[test]
fn keys_that_nobody_knows_are_refused_with_the_nearest_one() {
    refused(wrong("camera", "fvo = 40"), 2, &["a.toml:2:1:", "[camera]", "`fvo`", "`fov`"]);
    refused(wrong("camera", "eye = [0,0,9]\ntargt = [0,0,0]"), 2, &["a.toml:3:1:", "`targt`", "`target`"]);
    refused(toml("[camra]\n"), 2, &["a.toml:1:2:", "`camra`", "`camera`"]);
    refused(toml("[[lights]]\n"), 2, &["`lights`", "`light`"]);
    refused(toml("[[material]]\nname = 'a'\ntype = 'difuse'\n"), 2, &["a.toml:3:8:", "\"difuse\"", "`diffuse`"]);
    refused(toml("[[material]]\nname = 'a'\ntype = 'diffuse'\nior = 1.5\n"), 2, &["a.toml:4:1:", "`ior`"]);
    refused(toml("[[material]]\nname = 'a'\ntype = 'thin'\nglass = 'bk8'\n"), 2, &["a.toml:4:9:", "`bk8`", "`bk7`"]);
    refused(toml("[[material]]\nname = 'a'\ntype = 'conductor'\nmetal = 'god'\n"), 2, &["a.toml:4:9:", "`gold`"]);
    let scene = "[[material]]\nname = 'gold'\ntype = 'diffuse'\n[[mesh]]\nshape = 'sphere'\nmaterial = 'glod'\n";
    refused(toml(scene), 2, &["a.toml:6:12:", "`glod`", "`gold`"]);
    refused(toml("[[mesh]]\nshape = 'spere'\n"), 2, &["a.toml:2:9:", "`sphere`"]);
}

/// Case IO-19 of the catalogue.
#[test]
fn toml_that_is_none_is_refused_with_line_and_column() {
    refused(toml("[camera]\neye = [0, 0\n"), 2, &["a.toml:"]);
    refused(toml("[camera]\nfov = 1\nfov = 2\n"), 2, &["a.toml:3:1:", "duplicate"]);
    refused(toml(&format!("a = {}{}", "[".repeat(10_000), "]".repeat(10_000))), 2, &["a.toml:1:"]);
    refused(toml(&format!("a{} = 1", ".a".repeat(10_000))), 2, &["a.toml:1:"]);
    refused(toml(&format!("a = '{}'\n", "x".repeat(1 << 20))), 2, &["a.toml:1:1:", "`a`"]);
    refused(toml("\u{feff}[camera]\nfvo = 1\n"), 2, &["a.toml:2:1:"]);
}

#[test]
fn values_of_the_wrong_type_say_what_they_must_be() {
    refused(wrong("camera", "eye = 1"), 2, &["a.toml:2:7:", "`eye`", "list of 3 numbers"]);
    refused(wrong("camera", "eye = [1, 2]"), 2, &["a.toml:2:7:", "list of 2"]);
    refused(wrong("camera", "eye = [1, 2, 'x']"), 2, &["a.toml:2:14:", "a number"]);
    refused(wrong("camera", "fov = '40'"), 2, &["a.toml:2:7:", "a string", "a number"]);
    refused(toml("camera = 1\n"), 2, &["a.toml:1:10:", "a table"]);
    refused(toml("light = 1\n"), 2, &["[[light]]"]);
    refused(toml("[light]\n"), 2, &["[[light]]"]);
    refused(
        toml("[[light]]\ntype = 'point'\nposition = [0,0,0]\nintensity = true\n"),
        2,
        &["a.toml:4:13:", "a boolean"],
    );
}

/// Case CL-01 of the catalogue.
#[test]
fn cameras_that_see_nothing_are_refused() {
    for fov in ["0", "180", "-40", "nan", "inf", "1e999", "179.99999999999"] {
        refused(wrong("camera", &format!("fov = {fov}")), 2, &["a.toml:2:7:", "`fov`"]);
    }
    refused(wrong("camera", "eye = [1, 2, 3]\ntarget = [1, 2, 3]"), 2, &["a.toml:3:10:", "same point"]);
    refused(wrong("camera", "eye = [1e8, 0, 0]\ntarget = [100000000.000000001, 0, 0]"), 2, &["same point"]);
    refused(wrong("camera", "up = [0, 0, 0]"), 2, &["a.toml:2:6:", "not 0"]);
    refused(wrong("camera", "eye = [nan, 0, 0]"), 2, &["a.toml:2:8:", "finite"]);
    refused(wrong("camera", "projection = 'orthographic'\nheight = 0"), 2, &["a.toml:3:10:", "above 0"]);
    refused(wrong("camera", "projection = 'orthographic'\nfov = 40"), 2, &["a.toml:3:1:", "`fov`"]);
    refused(wrong("camera", "medium = 'water'"), 2, &["a.toml:2:10:", "`water`"]);
}

/// Cases CL-02, IO-21 of the catalogue.
#[test]
fn picture_settings_out_of_range_are_refused() {
    for (line, part) in [
        ("width = -1", "whole number from 1"),
        ("width = 0", "whole number from 1"),
        ("height = 1e3", "whole number"),
        ("samples = 9223372036854775807", "from 1 to 256"),
        ("samples = 0x7fffffffffffffffffffffff", "from 1 to 256"),
        ("depth = 1e9", "whole number"),
        ("depth = 1000000000", "from 0 to 10000"),
        ("cutoff = 2", "from 0 to 1"),
        ("cutoff = nan", "finite"),
        ("shadows = 'soft'", "straight"),
    ] {
        let text = refused(wrong("render", line), 2, &[part]);
        assert!(text.contains("a.toml:2:"), "{text}");
    }
    refused(wrong("render", "width = 65536\nheight = 65536"), 4, &["a.toml:1:", "65536 by 65536"]);
    refused(wrong("render", "width = 4294967295\nheight = 4294967295"), 4, &["a.toml:1:"]);
}

/// Cases RF-14, AB-02 of the catalogue.
#[test]
fn materials_out_of_range_are_refused() {
    let material = |lines: &str| toml(&format!("[[material]]\nname = 'a'\n{lines}\n"));
    for ior in ["0", "-1", "nan", "inf", "1e-30", "1e30"] {
        refused(material(&format!("type = 'dielectric'\nior = {ior}")), 2, &["a.toml:4:7:", "`ior`"]);
    }
    for (lines, part) in [
        ("type = 'dielectric'", "`ior` or `glass`"),
        ("type = 'dielectric'\nior = 1.5\nglass = 'bk7'", "not both"),
        ("type = 'dielectric'\nior = 1.5\nabsorption = [-1, 0, 0]", "at least 0"),
        ("type = 'dielectric'\nior = 1.5\nabsorption = 1\ncolor = 1", "not both"),
        ("type = 'dielectric'\nior = 1.5\ncolor = 2\ndistance = 1", "at most 1"),
        ("type = 'dielectric'\nior = 1.5\ncolor = 0.5\ndistance = 0", "above 0"),
        ("type = 'dielectric'\nior = 1.5\ndistance = 1", "needs a `color`"),
        ("type = 'dielectric'\nior = 1.5\npriority = -2147483648", "from -2147483647"),
        ("type = 'diffuse'\ncolor = -0.5", "at least 0"),
        ("type = 'diffuse'\ncolor = 1.5", "at most 1"),
        ("type = 'diffuse'\ncolor = 0.5\nchecker = { even = 0, odd = 1 }", "not both"),
        ("type = 'diffuse'\nchecker = { even = 0, odd = 1, size = 0 }", "above 0"),
        ("type = 'diffuse'\nhighlight = { exponent = -1 }", "0 to 1e6"),
        ("type = 'diffuse'\nhighlight = { color = 1 }", "`exponent`"),
        ("type = 'emissive'", "`emission`"),
        ("type = 'conductor'\neta = 1", "both `eta` and `k`"),
        ("type = 'conductor'\neta = 0\nk = 1", "between 0.001"),
        ("type = 'conductor'\neta = 1\nk = 1e9", "at most 1000"),
        ("type = 'alpha'\nopacity = 1.5", "0 to 1"),
        ("type = 'diffuse'\ntexture = 'none.png'", "none.png"),
    ] {
        let text = refused(material(lines), 2, &[part]);
        assert!(text.contains("a.toml:"), "{text}");
    }
    refused(toml("[[material]]\ntype = 'diffuse'\n"), 2, &["a.toml:1:", "needs `name`"]);
    let twice = "[[material]]\nname = 'a'\ntype = 'diffuse'\n".repeat(2);
    refused(toml(&twice), 2, &["a.toml:5:8:", "`a` already"]);
    warned(material("type = 'mirror'\nreflectance = 0.8\ncolor = 0.5"), &["a.toml:1:", "`a`", "1.3"]);
    let near = material("type = 'dielectric'\nior = 1.0000001").unwrap();
    assert_eq!(near.scene.media[1].ior, 1.000_000_1);
}

#[test]
fn lights_out_of_range_are_refused() {
    let light = |lines: &str| toml(&format!("[[light]]\n{lines}\n"));
    for (lines, part) in [
        ("type = 'point'\nintensity = 1", "needs `position`"),
        ("type = 'point'\nposition = [0, 0, 0]\nintensity = -1", "at least 0"),
        ("type = 'directional'\nintensity = 1", "a `direction` or a `target`"),
        ("type = 'directional'\nintensity = 1\ndirection = [0, 0, 0]", "not 0"),
        ("type = 'directional'\nintensity = 1\ndirection = [0, 1, 0]\ntarget = [0, 0, 0]", "not both"),
        ("type = 'spot'\nposition = [1, 2, 3]\ntarget = [1, 2, 3]\nintensity = 1", "is its position"),
        ("type = 'spot'\nposition = [1, 2, 3]\ntarget = [0, 0, 0]\ninner = 40\nintensity = 1", "exceeds"),
        ("type = 'spot'\nposition = [1, 2, 3]\ntarget = [0, 0, 0]\nouter = 91\nintensity = 1", "0 to 90"),
        ("type = 'point'\nposition = [1e30, 0, 0]\nintensity = 1", "1.844e18"),
        ("type = 'sphere'\nposition = [0, 0, 0]\nintensity = 1", "needs `radius`"),
        ("type = 'sphere'\nposition = [0, 0, 0]\nintensity = 1\nradius = 0", "above 0"),
        ("type = 'rectangle'\nposition = [0, 0, 0]\nintensity = 1", "needs `edges`"),
        ("type = 'rectangle'\nposition = [0, 0, 0]\nedges = [[1, 0, 0]]\nintensity = 1", "two vectors, not 1"),
        ("type = 'rectangle'\nposition = [0, 0, 0]\nedges = [[1, 0, 0], [-2, 0, 0]]\nintensity = 1", "parallel"),
        (
            "type = 'rectangle'\nposition = [0, 0, 0]\nedges = [[1, 0, 0], [0, 1, 0]]\ndirection = [1, 1, 0]\nintensity = 1",
            "lies in its own plane",
        ),
        (
            "type = 'rectangle'\nposition = [0, 0, 0]\nedges = [[1, 0, 0], [0, 1, 0]]\nspread = 'wide'\nintensity = 1",
            "spread",
        ),
        (
            "type = 'sphere'\nposition = [0, 0, 0]\nintensity = 1\nradius = 1\nedges = [[1, 0, 0], [0, 1, 0]]",
            "no key `edges`",
        ),
    ] {
        refused(light(lines), 2, &["a.toml:", part]);
    }
}

#[test]
fn a_rectangle_shines_to_the_side_it_is_told_to() {
    let normal = |lines: &str| {
        let text = format!(
            "[[light]]\ntype = 'rectangle'\nposition = [1, 2, 3]\nedges = [[2, 0, 0], [0, 0, 4]]\nintensity = 1\n{lines}\n"
        );
        match toml(&text).unwrap().scene.lights[0].kind {
            LightKind::Rectangle { corner, edges, .. } => {
                assert_eq!(corner, Vec3::new(0.0, 2.0, 1.0));
                edges[0].cross(edges[1]).normalize()
            }
            kind => panic!("{kind:?}"),
        }
    };
    assert_eq!(normal(""), Vec3::NEG_Y);
    assert_eq!(normal("direction = [0, 1, 3]"), Vec3::Y);
    assert_eq!(normal("target = [1, 0, 3]"), Vec3::NEG_Y);
    assert_eq!(normal("target = [1, 5, 3]"), Vec3::Y);
}

#[test]
fn settings_of_lamps_are_read_and_refused_with_a_cure() {
    let render = |lines: &str| toml(&format!("[render]\n{lines}\n"));
    let lamps = render("light_samples = 25\nlight_pattern = 'grid'\nlight_seed = 9\npenumbra = 'full'").unwrap();
    let lamps = lamps.scene.settings.lamps;
    assert_eq!(lamps, LampSampling { count: 25, pattern: Pattern::Grid, seed: 9, probe: false });
    refused(render("light_pattern = 'grid'\nlight_samples = 20"), 2, &["a.toml:3:", "16 or 25"]);
    refused(render("light_pattern = 'grid'"), 2, &["a.toml:", "25 or 36"]);
    refused(render("light_samples = 0"), 2, &["a.toml:2:", "1 to 4096"]);
    refused(render("light_seed = -1"), 2, &["a.toml:2:", "0 to"]);
    refused(render("penumbra = 'half'"), 2, &["a.toml:2:", "penumbra"]);
}

#[test]
fn transforms_that_destroy_a_mesh_are_refused_by_its_name() {
    let mesh = |lines: &str| {
        toml(&format!("[[material]]\nname = 'm'\ntype = 'diffuse'\n[[mesh]]\nname = 'vase'\nmaterial = 'm'\n{lines}\n"))
    };
    for (lines, part) in [
        ("shape = 'box'\ntransform = { scale = 0 }", "singular"),
        ("shape = 'box'\ntransform = { scale = [1, 0, 1] }", "singular"),
        ("shape = 'box'\ntransform = { scale = 1e30 }", "1e30"),
        ("shape = 'box'\ntransform = { matrix = [1,0,0,0, 0,1,0,0, 1,1,0,0, 0,0,0,1] }", "singular"),
        ("shape = 'box'\ntransform = { matrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1] }", "affine"),
        ("shape = 'box'\ntransform = { translate = [1e30, 0, 0] }", "beyond"),
        ("shape = 'sphere'\ntransform = { scale = [1, 2, 1] }", "tessellation"),
        ("shape = 'sphere'\nflip = true", "tessellation"),
        ("shape = 'torus'\nminor = 2", "`minor`"),
        ("shape = 'torus'\nmajor = 1e30", "1.844e18"),
        ("shape = 'lathe'\nprofile = [[1e30, 0], [1, 1]]", "1.844e18"),
        ("shape = 'heightfield'\nsize = [1, 1]\ndepth = 1\nwaves = [{ amplitude = 2, wavelength = 1 }]", "depth"),
    ] {
        refused(mesh(lines), 2, &["a.toml:", "`vase`", part]);
    }
    for (lines, part) in [
        ("shape = 'box'\ntransform = { scale = nan }", "finite"),
        ("shape = 'box'\ntransform = { matrix = [1, 0] }", "list of 16"),
        ("shape = 'sphere'\nradius = 0", "above 0"),
        ("shape = 'sphere'\nradius = -1", "above 0"),
        ("shape = 'box'\nsize = [1, 1, 0]", "above 0"),
        ("shape = 'lathe'\nprofile = [[1, 0]]", "two points"),
        ("shape = 'lathe'", "needs `profile`"),
        ("shape = 'sphere'\nfile = 'a.obj'", "not both"),
        ("", "a `file` or a `shape`"),
        ("shape = 'grid'\ntessellation = 0", "whole number from 1"),
        ("shape = 'grid'\ntessellation = 4000000000", "whole number from 1"),
    ] {
        refused(mesh(lines), 2, &["a.toml:", part]);
    }
    refused(mesh("shape = 'sphere'\ntessellation = 16384"), 4, &["triangles"]);
    refused(toml("[[mesh]]\nshape = 'sphere'\n"), 2, &["a.toml:1:", "`material`"]);
}

/// Case IO-20 of the catalogue.
#[test]
fn a_scene_that_names_itself_as_a_model_is_refused() {
    refused(Folder::new().with("a.toml", "[[mesh]]\nfile = 'a.toml'\n").load("a.toml"), 2, &["a.toml", "no triangles"]);
}

#[test]
fn an_empty_scene_is_a_warning() {
    warned(toml(""), &["a.toml", "no [[mesh]]"]);
}

#[test]
fn the_sampler_of_every_key_loads_as_it_says() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/sampler.toml");
    let loaded = load::scene(&path, &LoadOptions::default()).unwrap();
    let scene = &loaded.scene;
    assert_eq!((scene.materials.len(), scene.lights.len()), (9 + 3, 3));
    // Nine shapes, and the house in three materials.
    assert_eq!(scene.objects.len(), 9 + 3);
    assert_eq!(scene.objects.len(), scene.geometry.len());
    let Shape::Sphere(ball) = &scene.geometry[0].shape else { panic!("the ball is exact") };
    assert_eq!((ball.centre, ball.radius), (Vec3::new(0.0, 3.0, 0.0), 1.0));
    let text = fs::read_to_string(&path).unwrap();
    let first = 1 + text.lines().position(|l| l == "[[mesh]]").unwrap();
    assert_eq!(scene.objects[0].origin.line as usize, first);
    // The scaled sphere was mirrored: its triangles still face out.
    let ball = mesh(&loaded, 1);
    for i in 0..ball.triangles.len() {
        let [a, b, c] = ball.corners(i);
        assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
    }
    let kinds: Vec<&str> = loaded.report.warnings.iter().map(|w| w.message.as_str()).collect();
    for part in ["`nothing`", "not closed", "texture coordinates"] {
        assert!(kinds.iter().any(|k| k.contains(part)), "{part}: {kinds:?}");
    }
}

#[test]
fn places_are_reckoned_in_f64_and_rounded_once() {
    let scene = "[[material]]\nname = 'm'\ntype = 'diffuse'\n[[mesh]]\nshape = 'box'\nmaterial = 'm'\n\
                 size = [2, 0.1, 2]\ncenter = [0, -0.05, 0]\n";
    // In f32 the top would lie a little below 0.
    assert_eq!(mesh(&toml(scene).unwrap(), 0).bounds().hi.y, 0.0);
}

#[test]
fn errors_are_of_the_kind_their_exit_code_says() {
    assert!(matches!(obj("v a"), Err(Error::File { .. })));
    assert!(matches!(obj(""), Err(Error::File { .. })));
    assert!(matches!(toml("[camera]\nfov = 0\n"), Err(Error::Input { line: 2, column: Some(7), .. })));
}

fn dielectric(keys: &str) -> vitrum::Result<Loaded> {
    toml(&format!("[[material]]\nname = 'a'\ntype = 'dielectric'\n{keys}\n"))
}

#[test]
fn curves_of_the_index_are_read_in_each_of_their_forms() {
    let medium = |keys: &str| dielectric(keys).unwrap_or_else(|e| panic!("{keys}: {e}")).scene.media[1].clone();
    assert_eq!(medium("glass = 'bk7'").dispersion, Dispersion::None, "a name alone asks for no dispersion");
    assert_eq!(medium("glass = 'bk7'").ior, 1.5168);
    let bk7 = medium("glass = 'bk7'\ndispersion = true");
    assert!((bk7.ior - 1.5168).abs() < 1e-6 && bk7.index_at(486.1327) > 1.522);
    let abbe = medium("ior = 1.5\nabbe = 50");
    assert_eq!(abbe.ior, 1.5);
    let spread = abbe.index_at(486.1327) - abbe.index_at(656.2725);
    assert!((spread - 0.01).abs() < 1e-12, "(n_d - 1) / V_d");
    let cauchy = medium("cauchy = [1.5, 0.004]");
    assert_eq!(cauchy.dispersion, Dispersion::Cauchy([1.5, 0.004, 0.0]));
    assert!((cauchy.ior - (1.5 + 0.004 / 0.587_561_8_f64.powi(2))).abs() < 1e-12);
    let sellmeier = medium("sellmeier = [[1.2, 0.01]]");
    assert!((sellmeier.ior - (1.0 + 1.2 / (1.0 - 0.01 / 0.587_561_8_f64.powi(2))).sqrt()).abs() < 1e-12);
    for off in ["glass = 'bk7'\ndispersion = false", "ior = 1.5\nabbe = 50\ndispersion = false", "cauchy = [1.5, 0]"] {
        assert_eq!(medium(off).dispersion, Dispersion::None, "{off}");
    }
    assert_eq!(toml("[render]\nwavelengths = 24\n").unwrap().scene.settings.wavelengths, 24);
}

#[test]
fn curves_of_the_index_that_cannot_be_are_refused() {
    for (keys, line, parts) in [
        ("ior = 1.5\ndispersion = true", 5, ["`ior` alone", "`abbe`"]),
        ("glass = 'amber'\ndispersion = true", 4, ["`amber`", "`abbe`"]),
        ("ior = 1.5\nabbe = 0", 5, ["`abbe` is 0", "5 to 1000"]),
        ("ior = 1.5\ncauchy = [1.5, 0.004]", 4, ["`cauchy`", "leave `ior` out"]),
        ("cauchy = [1.5, 0.004]\nsellmeier = [[1, 0.01]]", 5, ["`cauchy`", "not both"]),
        ("cauchy = [1.5]", 4, ["`cauchy` is [A, B]", "1"]),
        ("sellmeier = []", 4, ["one to four", "0"]),
        ("sellmeier = [[1, 0.2]]", 4, ["`sellmeier` makes the index", "nm"]),
        ("cauchy = [1.5, -0.004]", 4, ["rise", "nm"]),
        ("cauchy = [1.5, 1e9]", 4, ["between 0.001 and 1000", "385 nm"]),
    ] {
        refused(dielectric(keys), 2, &[&format!("a.toml:{line}:"), parts[0], parts[1]]);
    }
    refused(toml("[[material]]\nname = 'a'\ntype = 'thin'\nglass = 'bk7'\ndispersion = true\n"), 2, &["`dispersion`"]);
    refused(wrong("render", "wavelengths = 6"), 2, &["a.toml:2:15:", "7 to 64"]);
}
