//! Light that ends at a limit: panes of glass in a row, whose transmittance is known by hand, and the project's own scenes.

use super::support::{Folder, ids, notices_of};
use vitrum::accel::{Accel, Backend, BuildOptions};
use vitrum::load::{self, LoadOptions};
use vitrum::render::{self, Limit, Observer, Options, Outcome, Pixels, Reflection, Shortfall};
use vitrum::scene::{Scene, Settings};

/// So many panes of index 1.5 before a wall of radiance `emission`, looked through along their normal.
fn text(panes: usize, render: &str, emission: f32) -> String {
    let mut text = format!(
        "[camera]\neye = [0.3, 0.2, 50]\ntarget = [0.3, 0.2, 0]\nprojection = \"orthographic\"\nheight = 1\n\
         [render]\nwidth = 2\nheight = 2\n{render}\n[environment]\ntype = \"constant\"\ncolor = 0\n\
         [[material]]\nname = \"glass\"\ntype = \"dielectric\"\nior = 1.5\n\
         [[material]]\nname = \"wall\"\ntype = \"emissive\"\nemission = {emission}\n\
         [[mesh]]\nshape = \"plane\"\npoint = [0, 0, -40]\nnormal = [0, 0, 1]\nmaterial = \"wall\"\n"
    );
    for pane in 0..panes {
        text += &format!(
            "[[mesh]]\nshape = \"box\"\nsize = [20, 20, 0.5]\ncenter = [0, 0, -{pane}]\nmaterial = \"glass\"\n"
        );
    }
    text
}

fn scene(panes: usize, render: &str, emission: f32) -> Scene {
    let folder = Folder::with(&[("panes.toml", &text(panes, render, emission))]);
    load::scene(&folder.path("panes.toml"), &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}")).scene
}

/// Each of the 2 N faces reflects 0.04.
fn transmittance(panes: usize) -> f64 {
    0.96 / (1.0 + (2 * panes - 1) as f64 * 0.04)
}

fn options() -> Options {
    Options { threads: 1, ..Options::default() }
}

fn picture(scene: &Scene, options: &Options, exposure: f32) -> Outcome {
    let accel = Accel::build(Backend::Native, &scene.geometry, BuildOptions::default()).expect("there is memory");
    let observer = Observer::default();
    let mut outcome = render::render(scene, &accel, options, &observer).expect("nobody interrupts a test");
    let pixels = Pixels::new(&accel, options, &observer);
    let again = |scene: &Scene, which: &[[u32; 2]]| pixels.render(scene, which);
    outcome.shortfall = Shortfall::of(scene, options, &outcome, exposure, &again).expect("nobody interrupts a test");
    outcome
}

#[test]
fn panes_in_a_row_let_through_what_they_should_but_for_what_is_truncated() {
    for panes in 1..=10 {
        let scene = scene(panes, "depth = 200\ncutoff = 1e-4", 1.0);
        let ours = picture(&scene, &options(), 1.0);
        let exact = render::reference::render(&scene, &options(), &Observer::default()).unwrap();
        for outcome in [&ours, &exact] {
            let (seen, lost) = (f64::from(outcome.film.pixels[0][0]), f64::from(outcome.truncated.pixels[0][0]));
            let right = transmittance(panes);
            assert!(seen < right + 1e-5 && right < seen + lost + 1e-5, "{panes} panes: {seen} and {lost}, not {right}");
            assert!(panes > 5 || right - seen < 1.0 / 255.0, "{panes} panes: {seen}, not {right}");
        }
        for (ours, exact) in [(&ours.film, &exact.film), (&ours.truncated, &exact.truncated)] {
            assert!((ours.pixels[0][0] - exact.pixels[0][0]).abs() < 2e-6, "{panes} panes: {ours:?} {exact:?}");
        }
        assert_eq!(ours.limits, exact.limits);
    }
}

#[test]
fn the_limit_that_ended_most_of_the_light_is_named_by_both_renderers() {
    for (render, limit) in [("depth = 6", Limit::Depth), ("depth = 64", Limit::Cutoff), ("depth = 21", Limit::Depth)] {
        let scene = scene(10, render, 1.0);
        let ours = picture(&scene, &options(), 1.0);
        let exact = render::reference::render(&scene, &options(), &Observer::default()).unwrap();
        assert_eq!(ours.limits, [Some(limit); 4], "{render}");
        assert_eq!(ours.limits, exact.limits, "{render}");
    }
    let clear = picture(&scene(0, "", 1.0), &options(), 1.0);
    assert_eq!((clear.limits, clear.shortfall), (vec![None; 4], None));
}

#[test]
fn ten_panes_are_reported_at_the_default_limits_and_at_others() {
    for (render, reason) in [("", "weight below"), ("depth = 16", "after 16 reflections")] {
        let folder = Folder::with(&[("panes.toml", &text(10, render, 1.0))]);
        let notices = notices_of(&folder.path("panes.toml"));
        assert_eq!(ids(&notices), ["truncated-light"], "{render}");
        let text = notices[0].to_string();
        assert!(text.contains("panes.toml: about 4 of 4 pixels lack") && text.contains(reason), "{text}");
        assert!(text.contains("--depth ") && text.contains("times as many rays"), "{text}");
    }
}

#[test]
fn the_limits_that_are_named_mend_the_picture_at_the_cost_that_is_named() {
    for (panes, render) in [(2, "depth = 3"), (4, "depth = 12"), (5, "cutoff = 0.03"), (3, "depth = 5\ncutoff = 0.01")]
    {
        let narrow = scene(panes, render, 1.0);
        let before = picture(&narrow, &options(), 1.0);
        let shortfall = before.shortfall.expect("light is missing");
        assert_eq!((shortfall.pixels, shortfall.of), (4, 4));
        let lacks = transmittance(panes) - f64::from(before.film.pixels[0][0]);
        assert!(
            shortfall.lacks >= lacks - 1.0 / 255.0 && shortfall.lacks < lacks + 1.0 / 255.0,
            "{shortfall:?}, not {lacks}"
        );
        let cure = shortfall.cure.expect("there are limits that mend it");
        let settings = Settings { max_depth: cure.depth, cutoff: cure.cutoff, ..narrow.settings.clone() };
        let after = picture(&Scene { settings, ..narrow }, &options(), 1.0);
        assert_eq!(after.shortfall, None, "{cure:?}");
        assert!((transmittance(panes) - f64::from(after.film.pixels[0][0])).abs() < 1.0 / 255.0, "{cure:?}");
        assert_eq!(cure.cost, after.rays.total() as f64 / before.rays.total() as f64);
    }
}

/// Ten panes take more rays than are spent on the search for limits that mend the picture.
#[test]
fn light_that_is_out_of_reach_is_missed() {
    let scene = scene(10, "depth = 64\ncutoff = 0.001", 1.0);
    let shortfall = picture(&scene, &options(), 1.0).shortfall.expect("light is missing");
    assert!(shortfall.lacks > 1.0 / 255.0 && shortfall.cure.is_none(), "{shortfall:?}");
}

#[test]
fn a_picture_that_stays_black_under_all_limits_is_no_dark_scene() {
    let text = text(150, "depth = 6", 1.0).replace("ior = 1.5", "ior = 1.01").replace("[0, 0, -40]", "[0, 0, -400]");
    let folder = Folder::with(&[("panes.toml", &text)]);
    let scene =
        load::scene(&folder.path("panes.toml"), &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}")).scene;
    let outcome = picture(&scene, &options(), 1.0);
    // A face reflects 2.5e-5, so that next to all of the wall is to be seen.
    assert!(outcome.film.pixels.iter().all(|pixel| pixel[0] < 0.01));
    let shortfall = outcome.shortfall.expect("all light is missing");
    assert!(shortfall.pixels == 4 && shortfall.lacks > 0.5 && shortfall.cure.is_none(), "{shortfall:?}");
}

#[test]
fn light_too_weak_to_be_seen_is_not_missed() {
    let lacking = |emission, exposure| picture(&scene(10, "depth = 16", emission), &options(), exposure).shortfall;
    assert!(lacking(1.0, 1.0).is_some());
    assert_eq!(lacking(0.005, 1.0), None);
    assert_eq!(lacking(1.0, 0.005), None);
    assert!(lacking(0.005, 200.0).is_some());
}

#[test]
fn light_that_is_left_out_on_request_is_not_missed() {
    let scene = scene(2, "depth = 64\ncutoff = 0", 1.0);
    let plain = Options { reflection: Reflection::None, ..options() };
    let outcome = picture(&scene, &plain, 1.0);
    assert!(outcome.truncated.pixels[0][0] > 0.1);
    assert_eq!((&outcome.limits[..], outcome.shortfall), (&[Some(Limit::Asked); 4][..], None));
}

#[test]
fn tiles_and_threads_decide_nothing() {
    let mut scene = scene(3, "depth = 9", 1.0);
    (scene.settings.width, scene.settings.height, scene.settings.samples) = (21, 13, 2);
    let one = picture(&scene, &options(), 1.0);
    for (threads, tile) in [(2, 32), (3, 5), (1, 1)] {
        let other = picture(&scene, &Options { threads, tile, ..options() }, 1.0);
        assert_eq!((&one.limits, one.shortfall), (&other.limits, other.shortfall));
        assert_eq!((&one.film, &one.truncated), (&other.film, &other.truncated));
    }
}
