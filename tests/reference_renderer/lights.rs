//! Lights, highlights and shadows.

use std::f64::consts::PI;

use glam::Vec3;
use vitrum::scene::{
    Falloff, FresnelRule, Highlight, HighlightModel, Interface, LightKind, Material, Rgb, Scene, ShadowRule,
};

use super::build::*;

/// A floor at y = 0 of albedo 0.5, lit by intensity 3.
fn floor(kind: LightKind, falloff: Falloff) -> Scene {
    let mut scene = empty();
    put(&mut scene, plane(Vec3::ZERO, Vec3::Y), lambert(0.5));
    scene.lights.push(light(kind, falloff));
    scene
}

/// Three units to the side and four up: distance 5, cosine 0.8.
fn point() -> LightKind {
    LightKind::Point { position: Vec3::new(3.0, 4.0, 0.0) }
}

/// Returns the radiance of the floor at the origin, seen at an angle so that the viewer blocks no light.
fn seen(scene: &Scene) -> f64 {
    radiance(scene, [0.0, 1.0, 2.0], [0.0, -1.0, -2.0])
}

#[test]
fn a_point_light_gives_a_lambert_surface_its_physical_and_its_classic_value() {
    close(seen(&floor(point(), Falloff::InverseSquare)), 0.5 / PI * 3.0 * 0.8 / 25.0, 1e-14);
    close(seen(&floor(point(), Falloff::None)), 0.5 * 3.0 * 0.8, 1e-14);
}

#[test]
fn a_directional_light_does_not_weaken_with_distance() {
    let kind = LightKind::Directional { direction: Vec3::new(-0.6, -0.8, 0.0) };
    close(seen(&floor(kind, Falloff::InverseSquare)), 0.5 / PI * 3.0 * 0.8, 1e-7);
    close(seen(&floor(kind, Falloff::None)), 0.5 * 3.0 * 0.8, 1e-7);
}

#[test]
fn a_spot_light_fades_smoothly_from_its_inner_to_its_outer_cone() {
    let spot = |cos_inner, cos_outer| LightKind::Spot {
        position: Vec3::new(0.0, 4.0, 0.0),
        direction: Vec3::new(0.0, -0.8, 0.6),
        cos_inner,
        cos_outer,
    };
    let full = 0.5 * 3.0;
    let seen = |cos_inner, cos_outer| seen(&floor(spot(cos_inner, cos_outer), Falloff::None));
    // The origin lies off the axis by a cosine of 0.8.
    close(seen(0.75, 0.5), full, 1e-7);
    close(seen(0.9, 0.85), 0.0, 0.0);
    let s = (0.8 - 0.7) / (0.95 - 0.7);
    close(seen(0.95, 0.7), full * s * s * (3.0 - 2.0 * s), 1e-6);
}

/// Case CL-08 of the catalogue.
#[test]
fn a_light_behind_either_normal_gives_nothing() {
    let mut scene = floor(LightKind::Point { position: Vec3::new(0.0, -4.0, 0.0) }, Falloff::None);
    scene.lights[0].shadows = false;
    assert_eq!(seen(&scene), 0.0);
    // From below the floor the same light is in front.
    close(radiance(&scene, [0.0, -1.0, 2.0], [0.0, 1.0, -2.0]), 0.5 * 3.0, 1e-14);
}

#[test]
fn highlights_are_phongs_and_blinns_lobes() {
    for (model, cos) in [
        // Light along (3, 4)/5; viewer along (0, 1, 2)/sqrt 5. Phong: mirror image (-3, 4)/5.
        (HighlightModel::Phong, 0.8 / 5.0_f64.sqrt()),
        (HighlightModel::BlinnPhong, {
            let viewer = glam::DVec3::new(0.0, 1.0, 2.0).normalize();
            (viewer + glam::DVec3::new(0.6, 0.8, 0.0)).normalize().y
        }),
    ] {
        let mut scene = floor(point(), Falloff::InverseSquare);
        scene.materials[0] = Material {
            highlight: Some(Highlight { colour: Rgb::splat(0.5), exponent: 3.0, model }),
            ..bare(Interface::Opaque)
        };
        close(seen(&scene), 0.5 * 3.0 / 25.0 * cos.powi(3), 1e-14);
    }
}

#[test]
fn ambient_is_the_materials_factor_times_the_scenes_colour() {
    let mut scene = floor(point(), Falloff::None);
    scene.lights.clear();
    assert_eq!(seen(&scene), 0.0);
    scene.ambient = Rgb::splat(0.5);
    scene.materials[0].ambient = Rgb::splat(0.25);
    scene.materials[0].emission = Rgb::splat(2.0);
    close(seen(&scene), 2.125, 0.0);
}

const UNSHADED: f64 = 0.5 * 3.0 * 0.8;

/// Returns the share of the light that reaches the floor through `shapes` between y = 1 and y = 2.
fn share(shapes: &[(vitrum::geometry::Shape, Material)], shadows: ShadowRule, air: f32) -> f64 {
    let mut scene = floor(point(), Falloff::None);
    scene.settings.shadows = shadows;
    scene.settings.max_depth = 0;
    medium(&mut scene, 1.5, air, 0);
    for (shape, material) in shapes {
        put(&mut scene, shape.clone(), material.clone());
    }
    seen(&scene) / UNSHADED
}

/// A block over y = 1..2 in the light's way and not in the viewer's.
fn in_the_way() -> vitrum::geometry::Shape {
    block(Vec3::new(0.6, 1.0, -1.0), Vec3::new(4.0, 2.0, 1.0))
}

#[test]
fn opaque_things_cast_shadows_and_lights_may_cast_none() {
    assert_eq!(share(&[(in_the_way(), lambert(0.5))], ShadowRule::Straight, 0.0), 0.0);
    let beyond = block(Vec3::new(2.9, 4.1, -1.0), Vec3::new(9.0, 5.0, 1.0));
    close(share(&[(beyond, lambert(0.5))], ShadowRule::Straight, 0.0), 1.0, 1e-15);
    let mut scene = floor(point(), Falloff::None);
    put(&mut scene, in_the_way(), lambert(0.5));
    scene.lights[0].shadows = false;
    close(seen(&scene), UNSHADED, 1e-15);
}

/// Case CL-06 of the catalogue.
#[test]
fn glass_casts_the_shadow_that_the_rule_says() {
    let glass = [(in_the_way(), dielectric(1))];
    assert_eq!(share(&glass, ShadowRule::Opaque, 0.0), 0.0);
    let passes = (1.0 - fresnel(1.0, 1.5, 0.8_f64.acos())).powi(2);
    close(share(&glass, ShadowRule::Straight, 0.0), passes, 1e-14);
    // Inside, the way is 1 / 0.8 long.
    close(share(&glass, ShadowRule::Straight, 0.5), passes * (-0.5 / 0.8_f64).exp(), 1e-14);
}

#[test]
fn panes_and_holes_weaken_light_by_what_they_let_through() {
    let pane = |interface| [(plane(Vec3::Y * 1.5, Vec3::Y), bare(interface))];
    let r = fresnel(1.0, 1.5, 0.8_f64.acos());
    let passes = 1.0 - 2.0 * r / (1.0 + r);
    // The viewer, at y = 1, is below the pane.
    let thin = Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fresnel, tint: Rgb::splat(0.5) };
    close(share(&pane(thin), ShadowRule::Straight, 0.0), 0.5 * passes, 1e-14);
    let fixed = Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fixed(Rgb::splat(0.25)), tint: Rgb::ONE };
    close(share(&pane(fixed), ShadowRule::Straight, 0.0), 0.75, 1e-14);
    close(share(&pane(Interface::Alpha { opacity: 0.25, mask: None }), ShadowRule::Straight, 0.0), 0.75, 1e-14);
    close(share(&pane(Interface::Alpha { opacity: 0.25, mask: None }), ShadowRule::Opaque, 0.0), 0.0, 0.0);
    close(share(&pane(Interface::Alpha { opacity: 1.0, mask: None }), ShadowRule::Straight, 0.0), 0.0, 0.0);
}

#[test]
fn a_shadow_through_overlapping_media_knows_which_surfaces_are_there() {
    let mut scene = floor(point(), Falloff::None);
    scene.settings.max_depth = 0;
    let glass = medium(&mut scene, 1.5, 0.0, 2);
    let water = medium(&mut scene, 1.33, 0.2, 1);
    put(&mut scene, block(Vec3::new(0.5, 2.0, -1.0), Vec3::new(4.0, 3.0, 1.0)), dielectric(glass));
    put(&mut scene, block(Vec3::new(0.5, 1.0, -1.0), Vec3::new(4.0, 2.5, 1.0)), dielectric(water));
    let angle = 0.8_f64.acos();
    let crossed =
        (1.0 - fresnel(1.0, 1.5, angle)) * (1.0 - fresnel(1.33, 1.5, angle)) * (1.0 - fresnel(1.0, 1.33, angle));
    // Water fills 1..2, where it is not inside the glass.
    close(seen(&scene) / UNSHADED, crossed * (-0.2 / 0.8_f64).exp(), 1e-8);
}

#[test]
fn a_shadow_ray_through_the_diagonal_of_a_pane_crosses_it_once() {
    let mut scene = floor(LightKind::Point { position: Vec3::new(0.0, 4.0, 0.0) }, Falloff::None);
    scene.settings.max_depth = 0;
    let medium = medium(&mut scene, 1.5, 0.5, 0);
    let tinted = Interface::Dielectric { medium, rule: FresnelRule::Fresnel, tint: Rgb::splat(0.5) };
    // The light stands above the middle, where both faces' diagonals cross the way.
    put(&mut scene, block(Vec3::new(-1.0, 2.0, -1.0), Vec3::new(1.0, 3.0, 1.0)), bare(tinted));
    close(seen(&scene), 1.5 * (0.96 * 0.5_f64).powi(2) * (-0.5_f64).exp(), 1e-14);
}

#[test]
fn a_light_under_water_shines_through_what_lies_between_and_no_farther() {
    let mut scene = floor(point(), Falloff::None);
    let water = medium(&mut scene, 1.33, 0.1, 0);
    // The floor, the viewer and the light are all in it.
    put(&mut scene, block(Vec3::splat(-30.0), Vec3::splat(30.0)), dielectric(water));
    let absorbed = (-0.1 * (5.0 + 5.0_f64.sqrt())).exp();
    close(seen(&scene), UNSHADED * absorbed, 1e-7);
}

/// Case CL-04 of the catalogue.
#[test]
fn a_light_that_stands_on_the_surface_is_left_out_and_counted() {
    let scene = floor(LightKind::Point { position: Vec3::ZERO }, Falloff::InverseSquare);
    let seen = trace(&scene, [0.0, 2.0, 0.0], [0.0, -1.0, 0.0]);
    assert_eq!((seen.radiance.x, seen.non_finite), (0.0, 1));
}

#[test]
fn light_passes_256_surfaces_and_no_more() {
    for (panes, want) in [(256, 1.5), (257, 0.0)] {
        let mut scene = floor(LightKind::Point { position: Vec3::new(0.0, 4.0, 0.0) }, Falloff::None);
        scene.settings.max_depth = 0;
        for i in 0..panes {
            let hole = bare(Interface::Alpha { opacity: 0.0, mask: None });
            put(&mut scene, plane(Vec3::Y * (3.0 + i as f32 / 512.0), Vec3::Y), hole);
        }
        close(seen(&scene), want, 0.0);
    }
}
