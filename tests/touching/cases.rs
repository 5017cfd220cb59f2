//! Scenes of touching surfaces that people make, with answers by hand or from the same scene with overlaps.

use super::{all_agree, all_are, apart, pictures, scene};

/// Two slabs seen at the angle whose sine is 0.53 along straight lines; the share of a lamp behind them.
fn slabs(lower_ior: &str, lower_absorption: &str) -> String {
    format!(
        r#"
camera = {{ eye = [-11.4715, 18.383, 0], target = [0, 2, 0], up = [0, 0, 1], projection = "orthographic", height = 1.0 }}
render = {{ width = 16, height = 12, depth = 3, cutoff = 0 }}
environment = {{ type = "constant", color = 0 }}
material = [
    {{ name = "a", type = "dielectric", ior = 1.5, absorption = 0.1 }},
    {{ name = "b", type = "dielectric", ior = {lower_ior}, absorption = {lower_absorption} }},
    {{ name = "wall", type = "emissive", emission = 1 }},
]
mesh = [
    {{ shape = "plane", point = [0, -5, 0], normal = [0, 1, 0], material = "wall" }},
    {{ shape = "box", size = [20, 2, 20], center = [0, 1, 0], material = "a" }},
    {{ shape = "box", size = [20, 2, 20], center = [0, -1, 0], material = "b" }},
]
"#
    )
}

/// Fresnel transmittance of a boundary at the sine of the angle of incidence.
fn passes(n1: f64, n2: f64, sin: f64) -> (f64, f64) {
    let sin_t = n1 / n2 * sin;
    let (c, d) = ((1.0 - sin * sin).sqrt(), (1.0 - sin_t * sin_t).sqrt());
    let s = (n1 * c - n2 * d) / (n1 * c + n2 * d);
    let p = (n1 * d - n2 * c) / (n1 * d + n2 * c);
    (1.0 - 0.5 * (s * s + p * p), sin_t)
}

/// The share of light that passes two slabs of thickness 2, at the angle of the camera of [`slabs`].
fn through_slabs(n: f64, absorption: f64) -> f64 {
    let sin = 11.4715 / 11.4715_f64.hypot(16.383);
    let (first, sin_a) = passes(1.0, 1.5, sin);
    let (second, sin_b) = if n == 1.5 { (1.0, sin_a) } else { passes(1.5, n, sin_a) };
    let (third, _) = passes(n, 1.0, sin_b);
    let length = |sin: f64| 2.0 / (1.0 - sin * sin).sqrt();
    first * second * third * (-0.1 * length(sin_a) - absorption * length(sin_b)).exp()
}

#[test]
fn the_face_that_two_blocks_of_one_glass_share_is_not_there() {
    // By hand: 0.594 with no inner reflection between outer faces, which depth 3 leaves out.
    let by_hand = through_slabs(1.5, 0.1);
    assert!((by_hand - 0.594).abs() < 2e-3, "{by_hand}");
    all_are(&all_agree(&slabs("1.5", "0.1"), 0), by_hand as f32, 1e-4);
}

#[test]
fn glass_against_water_is_one_boundary() {
    let by_hand = through_slabs(1.33, 0.3);
    assert!((by_hand - 0.386).abs() < 2e-3, "{by_hand}");
    all_are(&all_agree(&slabs("1.33", "0.3"), 0), by_hand as f32, 1e-4);
}

/// A box of glass on a table: `lift` above it, or sunk into it.
fn box_on_table(lift: f64, floor_first: bool) -> String {
    let glass = format!(r#"{{ shape = "box", size = [1, 1, 1], center = [0, {}, 0], material = "g" }}"#, 0.5 + lift);
    let floor = r#"{ shape = "plane", material = "f" }"#;
    let (a, b) = if floor_first { (floor, glass.as_str()) } else { (glass.as_str(), floor) };
    format!(
        r#"
camera = {{ eye = [2, 1.6, 3], target = [0, 0.4, 0], fov = 34 }}
render = {{ width = 120, height = 90, depth = 16 }}
environment = {{ type = "constant", color = 0.7 }}
light = [{{ type = "point", position = [1, 4, 2], intensity = 20 }}]
material = [
    {{ name = "g", type = "dielectric", ior = 1.5, absorption = [0.3, 0.1, 0.1] }},
    {{ name = "f", type = "diffuse", checker = {{ even = 0.8, odd = [0.2, 0.3, 0.4], size = 0.25, offset = [0, 0.11, 0] }} }},
]
mesh = [{a}, {b}]
"#
    )
}

#[test]
fn a_box_of_glass_on_a_table_looks_as_if_its_bottom_were_sunk_into_it() {
    let on = all_agree(&box_on_table(0.0, false), 20);
    let sunk = all_agree(&box_on_table(-1e-4, false), 20);
    let differing = apart(&on, &sunk, 5e-3);
    assert!(differing <= 40, "{differing} of 10,800 pixels differ");
    let other_order = all_agree(&box_on_table(0.0, true), 20);
    let differing = apart(&on, &other_order, 1e-5);
    assert!(differing <= 20, "{differing} pixels depend on the order of objects");
}

/// Concentric balls seen through their middles.
fn balls(meshes: &str) -> String {
    format!(
        r#"
camera = {{ eye = [0, 0, 5], target = [0, 0, 0], projection = "orthographic", height = 0.02 }}
render = {{ width = 40, height = 1, depth = 3, cutoff = 0 }}
environment = {{ type = "constant", color = 1 }}
material = [
    {{ name = "glass", type = "dielectric", ior = 1.5 }},
    {{ name = "air", type = "dielectric", ior = 1 }},
    {{ name = "water", type = "dielectric", ior = 1.33, absorption = [0.1, 1, 2] }},
]
mesh = [{meshes}]
"#
    )
}

#[test]
fn water_that_shares_its_surface_with_the_hollow_of_its_glass_fills_it_in_any_order() {
    let ball =
        |radius: f64, material: &str| format!(r#"{{ shape = "sphere", radius = {radius}, material = "{material}" }}"#);
    let nested = all_agree(&balls(&[ball(1.0, "glass"), ball(0.9, "water")].join(", ")), 0);
    for order in [["glass", "air", "water"], ["water", "air", "glass"], ["air", "glass", "water"]] {
        let radius = |m: &str| if m == "glass" { 1.0 } else { 0.9 };
        let meshes: Vec<String> = order.iter().map(|m| ball(radius(m), m)).collect();
        let film = all_agree(&balls(&meshes.join(", ")), 0);
        assert_eq!(apart(&film, &nested, 1e-6), 0, "{order:?}");
    }
}

#[test]
fn of_equal_priorities_the_smaller_body_wins_from_both_sides() {
    // A bubble half out of water, seen from above and from below.
    let bubble = |eye: &str, target: &str, priority: &str| {
        format!(
            r#"
camera = {{ eye = {eye}, target = {target}, up = [0, 0, -1], projection = "orthographic", height = 1e-4 }}
render = {{ width = 1, height = 1, depth = 8, cutoff = 1e-3 }}
environment = {{ type = "constant", color = 1 }}
material = [
    {{ name = "w", type = "dielectric", ior = 1.33, absorption = 0.2 }},
    {{ name = "air", type = "dielectric", ior = 1{priority} }},
]
mesh = [
    {{ shape = "sphere", radius = 0.5, material = "air" }},
    {{ shape = "box", size = [20, 10, 20], center = [0, -5, 0], material = "w" }},
]
"#
        )
    };
    for (eye, target) in [("[0.2, 5, 0]", "[0.2, 0, 0]"), ("[0.2, -50, 0]", "[0.2, 0, 0]")] {
        let equal = all_agree(&bubble(eye, target, ""), 0);
        let stated = all_agree(&bubble(eye, target, ", priority = 1"), 0);
        assert_eq!(apart(&equal, &stated, 1e-6), 0, "{eye}");
    }
}

#[test]
fn of_coplanar_opaque_surfaces_the_later_one_is_seen_like_a_decal() {
    let decal = |first: &str, second: &str| {
        format!(
            r#"
camera = {{ eye = [0.3, 2, 3], target = [0, 0, 0], fov = 34 }}
render = {{ width = 80, height = 60 }}
environment = {{ type = "constant", color = 0.7 }}
light = [{{ type = "point", position = [1, 4, 2], intensity = 20 }}]
material = [{{ name = "r", type = "diffuse", color = [0.8, 0.1, 0.1] }}, {{ name = "f", type = "diffuse", color = 0.3 }}]
mesh = [{first}, {second}]
"#
        )
    };
    let disc = r#"{ shape = "disc", radius = 1, material = "r", center = [0, 0.3, 0] }"#;
    let grid = r#"{ shape = "grid", size = [4, 4], material = "f", transform = { translate = [0, 0.3, 0] } }"#;
    let red = |film: &vitrum::image::Film| film.pixels.iter().filter(|p| p[0] > 2.0 * p[1]).count();
    let on_top = all_agree(&decal(grid, disc), 8);
    let lifted = disc.replace("0.3, 0]", "0.3001, 0]");
    let above = all_agree(&decal(grid, &lifted), 8);
    let differing = apart(&on_top, &above, 5e-3);
    assert!(differing <= 12 && red(&on_top) > 400, "{differing} pixels differ, {} are red", red(&on_top));
    assert_eq!(red(&all_agree(&decal(disc, grid), 8)), 0, "the grid is listed later");
}

#[test]
fn gold_that_is_flush_with_the_top_of_its_glass_is_seen_as_if_it_stood_out() {
    let inlay = |top: f64| {
        format!(
            r#"
camera = {{ eye = [0.5, 2, 3], target = [0, 0, 0], fov = 34 }}
render = {{ width = 80, height = 60 }}
environment = {{ type = "constant", color = 0.7 }}
light = [{{ type = "point", position = [1, 4, 2], intensity = 20 }}]
material = [{{ name = "g", type = "dielectric", ior = 1.5 }}, {{ name = "m", type = "conductor", metal = "gold" }}]
mesh = [
    {{ shape = "box", size = [2, 0.5, 2], material = "g" }},
    {{ shape = "box", size = [0.8, 0.3, 0.8], center = [0, {}, 0], material = "m" }},
]
"#,
            top - 0.15
        )
    };
    let flush = all_agree(&inlay(0.25), 12);
    let proud = all_agree(&inlay(0.2501), 12);
    let differing = apart(&flush, &proud, 5e-3);
    assert!(differing <= 30, "{differing} of 4,800 pixels differ");
}

/// A ball of glass that rests on a plane, seen from within over a few thousandths of its radius.
#[test]
fn no_ray_starts_behind_the_plane_on_which_a_ball_rests() {
    let text = r#"
camera = { eye = [0, 0.5, 0.3], target = [0, 0, 0], fov = 0.4, medium = "g" }
render = { width = 80, height = 60 }
environment = { type = "constant", color = 0.7 }
light = [{ type = "point", position = [1, 4, 2], intensity = 20 }]
material = [{ name = "g", type = "dielectric", ior = 1.5 }, { name = "f", type = "diffuse", color = 0.3 }]
mesh = [{ shape = "sphere", radius = 1, center = [0, 1, 0], material = "g" }, { shape = "plane", material = "f" }]
"#;
    let found = pictures(&scene(text));
    let double = found.iter().find(|(name, _)| *name == "f64").expect("it is there");
    for (name, outcome) in &found {
        let differing = apart(&outcome.film, &double.1.film, 5e-4);
        assert!(differing <= 2, "{name}: {differing} of 4,800 pixels differ");
    }
}
