//! One test an axis.

use glam::{Vec2, Vec3};
use vitrum::accel::Backend;
use vitrum::geometry::{GeometryMask, Shape, Sphere, TriMesh};
use vitrum::optics::{FresnelModel, Oliveira, RefractionModel};
use vitrum::render::Reflection;
use vitrum::scene::{
    Colour, Dispersion, Falloff, FresnelRule, Interface, Light, LightKind, Material, Medium, MirrorSource, Rgb,
    ShadowRule, Texture,
};
use vitrum::study::{Level, Precision, Spheres};

use super::{Small, plane, quad};

/// Unpolarised reflectance as textbooks have it, `n1` to `n2`, below the critical angle.
pub fn fresnel(n1: f64, n2: f64, theta: f64) -> f64 {
    let (ci, ct) = (theta.cos(), (1.0 - (n1 / n2 * theta.sin()).powi(2)).sqrt());
    let s = (n1 * ci - n2 * ct) / (n1 * ci + n2 * ct);
    let p = (n2 * ci - n1 * ct) / (n2 * ci + n1 * ct);
    0.5 * (s * s + p * p)
}

fn schlick(n1: f64, n2: f64, theta: f64) -> f64 {
    let r0 = ((n1 - n2) / (n1 + n2)).powi(2);
    r0 + (1.0 - r0) * (1.0 - theta.cos()).powi(5)
}

/// A black sea of index `n2` under a medium of index `n1`, in a room of radiance 1, seen at the angle `theta` to its
/// normal: what is seen is the reflectance.
pub fn sea(n1: f64, n2: f64, theta: f64, rule: FresnelRule) -> Small {
    let eye = Vec3::new(theta.sin() as f32, theta.cos() as f32, 0.0) * 4.0;
    let mut small = Small::new(eye, 1.0);
    small.scene.media[0].ior = n1;
    small.scene.media.push(Medium {
        name: "sea".into(),
        ior: n2,
        absorption: Rgb::ONE,
        priority: 0,
        dispersion: Dispersion::None,
    });
    let interface = Interface::Dielectric { medium: 1, rule, tint: Rgb::ONE };
    small.with(plane(0.0, Vec3::Y), GeometryMask::TRANSMISSIVE, Material { interface, ..Material::black("sea") })
}

#[test]
fn schlick_is_off_by_what_the_formulas_say_most_of_all_between_water_and_glass() {
    for (n1, n2, worst) in [(1.0, 1.5, 0.036), (1.0, 1.333, 0.06), (1.333, 1.5, 0.17)] {
        let mut largest = 0.0_f64;
        for degrees in (0..90).step_by(3).chain([80, 82, 83, 85, 86, 88]) {
            let theta = f64::from(degrees).to_radians();
            let small = sea(n1, n2, theta, FresnelRule::Fresnel);
            let exact = small.value(small.default());
            let approximate = small.value(small.default().with(Level::Fresnel(FresnelModel::Schlick)));
            let off = small.value(small.default().with(Level::Fresnel(FresnelModel::Off)));
            // The eye's coordinates are in f32, so that the angle is good to 1e-7 and steep curves to a little more.
            assert!((exact - fresnel(n1, n2, theta)).abs() < 2e-5, "{n1} {n2} {degrees}: {exact}");
            assert!((approximate - schlick(n1, n2, theta)).abs() < 2e-5, "{n1} {n2} {degrees}: {approximate}");
            assert!((off - fresnel(n1, n2, 0.0)).abs() < 1e-6, "{n1} {n2} {degrees}: {off}");
            largest = largest.max((approximate - exact).abs());
        }
        assert!((largest - worst).abs() < 0.06 * worst + 0.002, "{n1} to {n2}: off by {largest}, not {worst}");
    }
}

/// Two mirrors that face each other, each of emission 1 and reflectance 1/2.
fn corridor() -> Small {
    let reflectance = Rgb::splat(0.5);
    let mirror = |name| Material {
        emission: Rgb::ONE,
        interface: Interface::Mirror { reflectance, source: MirrorSource::Traced },
        ..Material::black(name)
    };
    Small::new(Vec3::new(0.3, 0.5, 0.0), 0.0).with(plane(-1.0, Vec3::Y), GeometryMask::OPAQUE, mirror("floor")).with(
        plane(1.0, Vec3::NEG_Y),
        GeometryMask::OPAQUE,
        mirror("ceiling"),
    )
}

#[test]
fn a_depth_limit_ends_the_geometric_series() {
    let small = corridor();
    for depth in [0, 1, 2, 4, 8, 16] {
        let seen = small.value(small.default().with(Level::Depth(depth)));
        let sum = 2.0 - 0.5_f64.powi(depth as i32);
        assert!((seen - sum).abs() < 1e-6, "depth {depth}: {seen}, not {sum}");
    }
}

#[test]
fn a_cut_off_ends_it_where_the_weight_falls_below() {
    let small = corridor();
    for bits in [1, 4, 6, 10] {
        // The ray of weight 2^-bits is the last one.
        let seen = small.value(small.default().with(Level::Cutoff(0.5_f32.powi(bits))));
        let sum = 2.0 - 0.5_f64.powi(bits);
        assert!((seen - sum).abs() < 1e-6, "cut-off 2^-{bits}: {seen}, not {sum}");
    }
}

#[test]
fn more_rays_a_pixel_count_an_edge_better() {
    // A bright sheet over the left three tenths of the one pixel, which is 2 units wide.
    let x = -1.0 + 2.0 * 0.3;
    let corners = [[-9.0, 9.0], [x, 9.0], [x, -9.0], [-9.0, -9.0]].map(|[x, z]| Vec3::new(x, 0.0, z));
    let sheet = Material { emission: Rgb::ONE, ..Material::black("sheet") };
    let small = Small::new(Vec3::Y * 3.0, 0.0).with(quad(corners), GeometryMask::OPAQUE, sheet);
    for (n, covered) in [(1, 0.0), (2, 0.5), (4, 0.25), (8, 0.25), (16, 0.3125)] {
        assert_eq!(small.value(small.default().with(Level::Sampling(n))), covered, "{n} x {n}");
    }
}

#[test]
fn a_sphere_of_bands_covers_the_polygon_of_its_equator() {
    let ball = Shape::Sphere(Sphere { centre: Vec3::ZERO, radius: 0.9 });
    let bright = Material { emission: Rgb::ONE, ..Material::black("ball") };
    let small = Small::new(Vec3::Y * 3.0, 0.0).with(ball, GeometryMask::OPAQUE, bright).size(96);
    let default = small.default().with(Level::Sampling(4));
    let disc = 0.25 * std::f64::consts::PI * 0.81;
    assert!((small.mean(default) - disc).abs() < 1e-3);
    for bands in [4, 8, 16] {
        let sides = 2.0 * f64::from(bands);
        let polygon = disc * (std::f64::consts::TAU / sides).sin() * sides / std::f64::consts::TAU;
        let seen = small.mean(default.with(Level::Spheres(Spheres::Bands(bands))));
        assert!((seen - polygon).abs() < 1e-3, "{bands} bands: {seen}, not {polygon}");
    }
}

#[test]
fn shadows_through_a_pane_are_dark_or_weakened_by_what_it_lets_through() {
    let white = Material { diffuse: Colour::Constant(Rgb::ONE), ..Material::black("floor") };
    let interface = Interface::ThinDielectric { ior: 1.5, rule: FresnelRule::Fresnel, tint: Rgb::splat(0.5) };
    let pane = Material { interface, ..Material::black("pane") };
    // The pane is overhead, above the eye.
    let corners = [[-9.0, 9.0], [9.0, 9.0], [9.0, -9.0], [-9.0, -9.0]].map(|[x, z]| Vec3::new(x, 5.0, z));
    let mut small = Small::new(Vec3::new(2.0, 2.0, 0.0), 0.0)
        .with(plane(0.0, Vec3::Y), GeometryMask::OPAQUE, white)
        .with(quad(corners), GeometryMask::TRANSMISSIVE, pane);
    small.scene.lights.push(Light {
        name: "sun".into(),
        kind: LightKind::Directional { direction: Vec3::NEG_Y },
        intensity: Rgb::ONE,
        falloff: Falloff::None,
        shadows: true,
    });
    let at = |rule| small.value(small.default().with(Level::Shadows(rule)));
    // R = 0.04 of one face at normal incidence, 2 R / (1 + R) of both; half of the rest is tinted away.
    let through = 0.5 * (1.0 - 0.08 / 1.04);
    assert_eq!(at(ShadowRule::Opaque), 0.0);
    assert!((at(ShadowRule::Straight) - through).abs() < 1e-6);
}

#[test]
fn f32_differs_from_f64_by_roundings_and_no_more() {
    let mut small = Small::new(Vec3::new(1.0, 2.0, 3.0), 0.0).size(24);
    small.scene.environment =
        vitrum::scene::Environment::Gradient { nadir: Rgb::ZERO, horizon: Rgb::splat(0.3), zenith: Rgb::ONE };
    small.scene.media.push(Medium {
        name: "glass".into(),
        ior: 1.5,
        absorption: Rgb::ZERO,
        priority: 0,
        dispersion: Dispersion::None,
    });
    let interface = Interface::Dielectric { medium: 1, rule: FresnelRule::Fresnel, tint: Rgb::ONE };
    // Larger than the picture, so that no pixel is at its edge.
    let ball = Shape::Sphere(Sphere { centre: Vec3::ZERO, radius: 2.0 });
    let small = small.with(ball, GeometryMask::TRANSMISSIVE, Material { interface, ..Material::black("ball") });
    let default = small.default().with(Level::Cutoff(1e-3));
    let (single, double) = (small.shoot(default), small.shoot(default.with(Level::Precision(Precision::Double))));
    let pairs = single.film.pixels.iter().flatten().zip(double.film.pixels.iter().flatten());
    let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(0.0 < worst && worst < 1e-5, "{worst}");
}

/// Water at y = 0 with a floor at y = -1, whose brightness rises along x: where the refracted ray lands is how bright the
/// pixel is.
#[test]
fn refraction_formulas_send_light_where_their_angles_say() {
    let edge = 12.0_f32;
    let pixels = (0..4096).map(|i| Rgb::splat((i as f32 + 0.5) / 4096.0)).collect();
    for degrees in [10.0_f64, 30.0, 60.0] {
        let theta = degrees.to_radians();
        let mut small = sea(1.0, 1.33, theta, FresnelRule::Fixed(Rgb::ZERO));
        small.scene.media[1].absorption = Rgb::ZERO;
        small.scene.textures.push(Texture::new("ramp", 4096, 1, Vec::clone(&pixels)));
        let corners = [[-edge, edge], [edge, edge], [edge, -edge], [-edge, -edge]];
        let floor = TriMesh {
            positions: corners.map(|[x, z]| Vec3::new(x, -1.0, z)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            uvs: [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vec2::from).to_vec(),
            uv_indices: vec![[0, 1, 2], [0, 2, 3]],
            ..TriMesh::default()
        };
        let small = small.with(
            Shape::Mesh(floor),
            GeometryMask::OPAQUE,
            Material { diffuse: Colour::Image { texture: 0, scale: Rgb::ONE }, ..Material::black("floor") },
        );
        let mut small = small;
        small.scene.lights.push(Light {
            name: "sun".into(),
            kind: LightKind::Directional { direction: Vec3::NEG_Y },
            intensity: Rgb::ONE,
            falloff: Falloff::None,
            shadows: false,
        });
        // The ray comes from +x and goes on towards -x: it lands at -tan of its angle.
        let angle = |model| {
            let seen = small.value(small.default().with(Level::Refraction(model)));
            let x = (seen * 2.0 - 1.0) * f64::from(edge);
            (-x).atan().to_degrees()
        };
        let snell = (theta.sin() / 1.33).asin().to_degrees();
        let vector = |c: f64| (theta.sin() / (theta.cos() + c)).atan().to_degrees();
        for model in [
            RefractionModel::Stable,
            RefractionModel::Trigonometric,
            RefractionModel::Heckbert,
            RefractionModel::Bec,
            RefractionModel::SlidesVector,
        ] {
            let seen = angle(model);
            assert!((seen - snell).abs() < 0.02, "{model:?} at {degrees}: {seen}, not {snell}");
        }
        assert!((angle(RefractionModel::StraightThrough) - degrees).abs() < 0.02);
        for c in [Oliveira::AS_PRINTED, Oliveira::WATER] {
            let seen = angle(RefractionModel::Oliveira(c));
            assert!((seen - vector(c.c)).abs() < 0.02, "c = {} at {degrees}: {seen}, not {}", c.c, vector(c.c));
        }
        // The book's constant halves the angle of incidence.
        assert!((angle(RefractionModel::Oliveira(Oliveira::AS_PRINTED)) - degrees / 2.0).abs() < 0.02);
    }
}

#[test]
fn reflection_is_traced_looked_up_or_left_out_by_either_renderer() {
    // A mirror under a dark ceiling in a bright room.
    let mirror = Material {
        interface: Interface::Mirror { reflectance: Rgb::splat(0.5), source: MirrorSource::Traced },
        ..Material::black("mirror")
    };
    let ceiling = Material { emission: Rgb::splat(0.25), ..Material::black("ceiling") };
    let small = Small::new(Vec3::new(0.3, 0.5, 0.0), 1.0).with(plane(0.0, Vec3::Y), GeometryMask::OPAQUE, mirror).with(
        plane(1.0, Vec3::NEG_Y),
        GeometryMask::OPAQUE,
        ceiling,
    );
    for precision in [Precision::Single, Precision::Double] {
        let default = small.default().with(Level::Precision(precision));
        let seen = |reflection| small.value(default.with(Level::Reflection(reflection)));
        assert_eq!(seen(Reflection::Traced), 0.125, "{precision:?}");
        assert_eq!(seen(Reflection::Environment), 0.5, "{precision:?}");
        assert_eq!(seen(Reflection::None), 0.0, "{precision:?}");
        let cut = small.shoot(default.with(Level::Reflection(Reflection::None))).truncated.pixels[0];
        assert_eq!(cut, [0.5; 3], "what is left out is accounted for");
    }
}

#[test]
fn every_back_end_is_asked_and_finds_the_same_picture() {
    if let Err(why) = Backend::Embree.availability() {
        eprintln!("EMBREE IS LEFT OUT: {why}");
        return;
    }
    let small = sea(1.0, 1.5, 0.7, FresnelRule::Fresnel);
    let native = small.value(small.default());
    for backend in [Backend::Embree, Backend::EmbreeFast] {
        let seen = small.value(small.default().with(Level::Backend(backend)));
        assert!((seen - native).abs() < 1e-6, "{backend:?}");
    }
}
