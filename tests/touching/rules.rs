//! Rules for kinds of surface that meet in one place, each with its answer by hand.

use super::{all_agree, all_are};

/// Returns a scene of a wall seen head-on, with the given materials and meshes at z = 0. The light is uniform and
/// perpendicular from far away, so that a matt wall of albedo a has radiance a.
fn wall(materials: &str, meshes: &str) -> String {
    format!(
        r#"
camera = {{ eye = [0.13, 0.21, 3], target = [0.13, 0.21, 0], projection = "orthographic", height = 0.5 }}
render = {{ width = 8, height = 6, depth = 8, cutoff = 0 }}
environment = {{ type = "constant", color = 0 }}
light = [{{ type = "directional", direction = [0, 0, -1], intensity = 1, falloff = "none" }}]
material = [{materials}]
mesh = [{meshes}]
"#
    )
}

const FLOOR: &str = r#"{ name = "floor", type = "diffuse", color = 0.5 }"#;
const PLANE: &str = r#"{ shape = "plane", normal = [0, 0, 1], material = "floor" }"#;

/// A square at z = 0 that faces the eye.
fn sheet(material: &str) -> String {
    format!(
        r#"{{ shape = "grid", size = [4, 4], tessellation = 3, material = "{material}", transform = {{ rotate = [90, 0, 0] }} }}"#
    )
}

/// A block from z = 0 to z = 1.
fn block(material: &str) -> String {
    format!(r#"{{ shape = "box", size = [4, 4, 1], center = [0, 0, 0.5], material = "{material}" }}"#)
}

fn both_orders(materials: &str, a: &str, b: &str, value: f32) {
    for meshes in [format!("{a}, {b}"), format!("{b}, {a}")] {
        all_are(&all_agree(&wall(materials, &meshes), 0), value, 1e-5);
    }
}

#[test]
fn a_cover_with_holes_lies_on_what_it_covers() {
    // The cover of albedo 0.8 hides a quarter; through the rest light goes in and out again.
    let cover = r#"{ name = "cover", type = "alpha", opacity = 0.25, color = 0.8 }"#;
    let by_hand = 0.25 * 0.8 + 0.75 * 0.5 * 0.75;
    both_orders(&format!("{FLOOR}, {cover}"), PLANE, &sheet("cover"), by_hand);
}

#[test]
fn a_pane_lies_on_what_it_covers() {
    // Two faces of index 1.5 let 12/13 through, each way; the lamp is seen in no mirror image.
    let pane = r#"{ name = "pane", type = "thin", ior = 1.5 }"#;
    let by_hand = 0.5 * (12.0_f32 / 13.0).powi(2);
    // Light that the floor sends back to the pane is reflected and comes again: each round is worth a thirteenth of
    // what arrives, but a matt surface answers lamps alone.
    both_orders(&format!("{FLOOR}, {pane}"), PLANE, &sheet("pane"), by_hand);
}

#[test]
fn a_matt_table_under_a_block_of_glass_is_lit_and_seen_through_the_top_alone() {
    // Optical contact: no boundary between the glass and the table. The top lets 0.96 through, each way.
    let glass = r#"{ name = "glass", type = "dielectric", ior = 1.5 }"#;
    both_orders(&format!("{FLOOR}, {glass}"), PLANE, &block("glass"), 0.5 * 0.96 * 0.96);
}

#[test]
fn a_mirror_behind_a_block_of_glass_sends_back_what_the_top_lets_through() {
    // A lamp that fills the room in front: every ray ends in it.
    let materials = r#"
        { name = "mirror", type = "mirror", reflectance = 0.8 },
        { name = "glass", type = "dielectric", ior = 1.5 },
        { name = "lamp", type = "emissive", emission = 1 }"#;
    let lamp = r#"{ shape = "plane", point = [0, 0, 9], normal = [0, 0, -1], material = "lamp" }"#;
    let mirror = r#"{ shape = "plane", normal = [0, 0, 1], material = "mirror" }"#;
    // By hand: R + T² m / (1 - R m), with the three round trips that depth 8 keeps.
    let (r, t, m) = (0.04_f64, 0.96_f64, 0.8_f64);
    let by_hand: f64 = r + t * t * m * (0..3).map(|k| (r * m).powi(k)).sum::<f64>();
    for meshes in [format!("{mirror}, {}, {lamp}", block("glass")), format!("{lamp}, {}, {mirror}", block("glass"))] {
        all_are(&all_agree(&wall(materials, &meshes), 0), by_hand as f32, 2e-5);
    }
}

#[test]
fn of_coplanar_surfaces_the_one_that_faces_the_ray_wins_whatever_the_order() {
    let materials = format!(r#"{FLOOR}, {{ name = "dark", type = "diffuse", color = 0.1 }}"#);
    let away = sheet("dark").replace("[90, 0, 0]", "[-90, 0, 0]");
    both_orders(&materials, &sheet("floor"), &away, 0.5);
}

#[test]
fn a_lamp_at_the_contact_lights_through_the_glass_above_it() {
    // A glowing sheet between two blocks of glass that touch it from both sides: opaque, so it is seen through one.
    let materials = r#"
        { name = "glass", type = "dielectric", ior = 1.5 },
        { name = "lamp", type = "emissive", emission = 1 }"#;
    let below = r#"{ shape = "box", size = [4, 4, 1], center = [0, 0, -0.5], material = "glass" }"#;
    let meshes = format!("{}, {below}, {}", block("glass"), sheet("lamp"));
    all_are(&all_agree(&wall(materials, &meshes), 0), 0.96, 2e-5);
}

#[test]
fn three_blocks_that_meet_are_crossed_as_pairs() {
    let materials = r#"
        { name = "a", type = "dielectric", ior = 1.5 },
        { name = "b", type = "dielectric", ior = 1.5 },
        { name = "c", type = "dielectric", ior = 1.33 },
        { name = "lamp", type = "emissive", emission = 1 }"#;
    let at =
        |z: f64, m: &str| format!(r#"{{ shape = "box", size = [4, 4, 1], center = [0, 0, {z}], material = "{m}" }}"#);
    let lamp = r#"{ shape = "plane", point = [0, 0, -9], normal = [0, 0, 1], material = "lamp" }"#;
    let meshes = [at(-0.5, "a"), at(0.5, "b"), at(-1.5, "c"), lamp.to_string()].join(", ");
    // At depth 3 no light that is reflected twice arrives: three boundaries, air to glass to water to air.
    let text = wall(materials, &meshes).replace("depth = 8", "depth = 3");
    let r = |a: f32, b: f32| ((a - b) / (a + b)).powi(2);
    let by_hand = (1.0 - r(1.0, 1.5)) * (1.0 - r(1.5, 1.33)) * (1.0 - r(1.33, 1.0));
    all_are(&all_agree(&text, 0), by_hand, 2e-5);
}

#[test]
fn a_scene_without_touching_surfaces_says_so_and_one_with_them_names_a_pair() {
    use vitrum::effects::{Effect, EffectPlan, Options};
    let glass = r#"{ name = "glass", type = "dielectric", ior = 1.5 }"#;
    let of = |meshes: String| {
        let scene = super::scene(&wall(&format!("{FLOOR}, {glass}"), &meshes));
        let plan = EffectPlan::resolve(&scene, &Options::default());
        let decision = plan.of(Effect::Touching).clone();
        (decision.on, decision.because)
    };
    let (on, because) = of(format!("{PLANE}, {}", block("glass")));
    assert!(on && because.contains("plane") && because.contains("share a surface"), "{because}");
    let (on, because) = of(format!("{PLANE}, {}", block("glass").replace("0.5]", "0.6]")));
    assert!(!on && because == "no surfaces touch", "{because}");
}

/// The kinds of warning about a scene.
fn warned(scene: &vitrum::scene::Scene) -> Vec<&'static str> {
    let (report, options) = (vitrum::load::LoadReport::default(), vitrum::render::Options::default());
    let file = std::path::Path::new("scene.toml");
    let facts = vitrum::notices::Facts { file, scene, report: &report, options: &options };
    vitrum::notices::of_scene(&facts).iter().map(|notice| notice.id).collect()
}

#[test]
fn a_decal_of_another_material_and_walls_that_nearly_coincide_are_warned_of() {
    let dark = format!(r#"{FLOOR}, {{ name = "dark", type = "diffuse", color = 0.1 }}"#);
    let of = |materials: &str, meshes: String| warned(&super::scene(&wall(materials, &meshes)));
    assert_eq!(of(&dark, format!("{PLANE}, {}", sheet("dark"))), ["coplanar-materials"]);
    let away = sheet("dark").replace("[90, 0, 0]", "[-90, 0, 0]");
    assert!(of(&dark, format!("{PLANE}, {away}")).is_empty());
    let liquids = r#"{ name = "g", type = "dielectric", ior = 1.5 }, { name = "w", type = "dielectric", ior = 1.33 }"#;
    let cup = |radius: f64, faces: u32| {
        format!(
            r#"{{ shape = "lathe", profile = [[0, 0], [0.6, 0], [0.6, 1], [0.5, 1], [0.5, 0.1], [0, 0.1]], tessellation = 64, material = "g" }},
            {{ shape = "lathe", profile = [[0, 0.1], [{radius}, 0.1], [{radius}, 0.7], [0, 0.7]], tessellation = {faces}, material = "w" }}"#
        )
    };
    assert_eq!(of(liquids, cup(0.5, 48)), ["near-coincidence"]);
    assert_eq!(of(liquids, cup(0.5, 64)), <[&str; 0]>::default());
    assert_eq!(of(liquids, cup(0.54, 48)), <[&str; 0]>::default());
    assert_eq!(of(liquids, cup(0.48, 48)), <[&str; 0]>::default());
    // Plates that are thin against their width run side by side; they do not cross, whether they touch or not.
    for gap in [0.0, 0.01, 0.5] {
        for turn in ["[0, 0, 0]", "[0, 0, 20]", "[10, 20, 30]"] {
            let plate = |y: f64, material: &str| {
                format!(
                    r#"{{ shape = "box", size = [20, 1, 20], center = [0, {y}, 0], transform = {{ rotate = {turn} }}, material = "{material}" }}"#
                )
            };
            let stack = format!("{}, {}", plate(0.5, "g"), plate(-0.5 - gap, "w"));
            assert_eq!(of(liquids, stack), <[&str; 0]>::default(), "{gap} {turn}");
        }
    }
}
