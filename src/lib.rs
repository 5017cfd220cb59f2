//! Vitrum: a SIMD packet ray tracer for people who care how light bends, how right their picture is, and what that
//! rightness costs.
//!
//! A [`scene::Scene`] is plain data. An [`accel::Intersector`] is built from its shapes and knows nothing of its
//! materials; [`render::render`] knows nothing of how rays are intersected.
//!
//! ```
//! use vitrum::accel::{Unbounded, native::Native};
//! use vitrum::geometry::{Geometry, GeometryMask, Shape, Sphere};
//! use vitrum::render::{Observer, Options, render};
//! use vitrum::scene::{
//!     Dispersion, Environment, FresnelRule, Interface, Material, Medium, Object, Origin, Rgb, Scene, Settings,
//! };
//!
//! // A glass ball in a bright room: lossless, so it cannot be seen.
//! let glass = Medium {
//!     name: "glass".into(),
//!     ior: 1.5,
//!     dispersion: Dispersion::None,
//!     absorption: Rgb::ZERO,
//!     priority: 0,
//! };
//! let interface = Interface::Dielectric { medium: 1, rule: FresnelRule::Fresnel, tint: Rgb::ONE };
//! let ball = Shape::Sphere(Sphere { centre: glam::Vec3::ZERO, radius: 1.0 });
//! let scene = Scene {
//!     geometry: vec![Geometry { shape: ball, mask: GeometryMask::TRANSMISSIVE }],
//!     objects: vec![Object { name: "ball".into(), material: 0, origin: Origin::default() }],
//!     materials: vec![Material { interface, ..Material::black("glass") }],
//!     media: vec![Medium::air(), glass],
//!     environment: Environment::Constant(Rgb::ONE),
//!     settings: Settings { width: 16, height: 16, max_depth: 50, cutoff: 0.0, ..Settings::default() },
//!     ..Scene::default()
//! };
//!
//! let accel = Unbounded::new(Native::build(&scene.geometry), &scene.geometry);
//! let outcome = render(&scene, &accel, &Options::default(), &Observer::default())?;
//! assert!(outcome.film.pixels.iter().all(|p| (p[0] - 1.0).abs() < 1e-5));
//! # Ok::<(), vitrum::Error>(())
//! ```

pub mod accel;
pub mod choice;
#[cfg(feature = "cli")]
pub mod cli;
pub mod effects;
pub mod error;
pub mod geometry;
pub mod image;
pub mod load;
pub mod math;
pub mod notices;
pub mod optics;
pub mod render;
pub mod scene;
pub mod simd;
pub mod study;
pub mod system;
pub mod trial;

pub use error::{Error, Result};
