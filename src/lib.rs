//! A SIMD packet ray tracer: exact reflection and refraction, eight rays at a time, with an `f64` renderer as arbiter.
//!
//! # Trace rays against a mesh
//!
//! [`accel`] knows shapes and nothing else. [`accel::Accel`] is built by one of the back ends. A hit is a distance, a triangle and its barycentric weights.
//!
//! ```
//! use vitrum::accel::{Accel, Backend, BuildOptions, Intersector as _};
//! use vitrum::geometry::{Geometry, Ray, TriMesh};
//! use vitrum::glam::Vec3;
//!
//! let triangle = TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
//! let accel = Accel::build(Backend::Native, &[Geometry::new(triangle)], BuildOptions::default())?;
//! let rays = [0.25, 2.0].map(|x| Ray::new(Vec3::new(x, 0.5, 3.0), Vec3::NEG_Z));
//! let hits = accel.hits(&rays);
//! assert_eq!((hits[0].t, hits[0].u, hits[0].v), (3.0, 0.25, 0.5));
//! assert!(!hits[1].is_hit());
//! # Ok::<(), vitrum::Error>(())
//! ```
//!
//! [`Intersector::closest`](accel::Intersector::closest) and [`Intersector::occluded`](accel::Intersector::occluded) take
//! packets of eight rays and allocate nothing; they are the fast way.
//!
//! # Render a scene to an array
//!
//! A [`scene::Scene`] is plain data: lists that refer to each other by index. Its `add_` methods return the indices, and
//! [`Scene::validate`](scene::Scene::validate) finds what does not fit. [`load::scene`] reads a scene file or a model
//! instead. [`render::render`] returns the picture in linear radiance and what it lost on the way.
//!
//! ```
//! use vitrum::accel::{Accel, Backend, BuildOptions};
//! use vitrum::geometry::Sphere;
//! use vitrum::glam::Vec3;
//! use vitrum::render::{Observer, Options, render};
//! use vitrum::scene::{Environment, Medium, Rgb, Scene, Settings};
//!
//! // A glass ball in a bright room: lossless, so it cannot be seen.
//! let mut scene = Scene {
//!     environment: Environment::Constant(Rgb::ONE),
//!     settings: Settings { width: 16, height: 16, cutoff: 0.0, ..Settings::default() },
//!     ..Scene::default()
//! };
//! let glass = scene.add_dielectric(Medium::new("glass", 1.5));
//! scene.add_object("ball", Sphere { centre: Vec3::ZERO, radius: 1.0 }, glass);
//! scene.validate()?;
//!
//! let accel = Accel::build(Backend::Native, &scene.geometry, BuildOptions::default())?;
//! let outcome = render(&scene, &accel, &Options::default(), &Observer::default())?;
//! let pixels: &[[f32; 3]] = &outcome.film.pixels;
//! assert!(pixels.iter().flatten().all(|x| (x - 1.0).abs() < 1e-5));
//! # Ok::<(), vitrum::Error>(())
//! ```
//!
//! [`image::save`] writes a film to a file. [`render::first_hits`] gives depth, normal, object and texture coordinates of
//! each pixel, and [`render::Lens`] the camera's rays. [`render::reference`] renders the same scene in `f64`.
//!
//! # Modules
//!
//! From the bottom up; a module uses those above it in this list.
//!
//! | module | contents |
//! |---|---|
//! | [`math`], [`simd`] | elementary functions, vectors of any number type; eight lanes of `f32` |
//! | [`geometry`] | rays, hits, triangles, spheres, planes, and their intersection tests |
//! | [`optics`] | reflection, refraction, Fresnel equations, absorption, dispersion: functions of numbers |
//! | [`accel`] | the 8-wide hierarchy, Embree (feature `embree`), the `f64` arbiter |
//! | [`scene`] | the scene: materials, media, lights, camera, settings |
//! | [`effects`] | the effects that a scene needs, with reasons |
//! | [`image`] | films, and PNG, OpenEXR, HDR and PFM files |
//! | [`load`] | scene files (TOML), OBJ with MTL, built-in shapes |
//! | [`render`] | the renderers in eight lanes and in `f64` |
//! | [`notices`] | warnings about a scene and its picture |
//! | [`trial`], [`study`] | comparison of back ends; cost of accuracy |
//! | [`error`], [`system`], [`choice`](mod@choice) | the error type; limits of the machine; settings with named levels |
//!
//! # Building
//!
//! A library needs neither the program nor its crates: `vitrum = { version = "0.1", default-features = false }`. The feature
//! `embree` adds the back end on Embree 4.
//!
//! Eight lanes want AVX2 and FMA. Cargo reads no configuration of a dependency, so the project that is built has to ask for
//! them: `rustflags = ["-C", "target-cpu=native"]` under `[build]` in its own `.cargo/config.toml`. Without them everything
//! works, more slowly and a little less exactly. [`simd::level::BUILT`] names what was built, and [`simd::level::check`] tells
//! a program whether its machine has it.

#![warn(missing_docs)]

pub mod accel;
pub mod choice;
#[cfg(feature = "cli")]
#[doc(hidden)] // For src/main.rs alone.
pub mod cli;
pub mod effects;
pub mod error;
pub mod geometry;
pub mod image;
pub mod load;
pub mod math;
pub mod measure;
pub mod notices;
pub mod optics;
pub mod render;
pub mod scene;
pub mod simd;
pub mod study;
pub mod system;
pub mod systems;
pub mod trial;

pub use error::{Error, Result};
/// Vectors of the interface. A dependent crate that uses them needs no `glam` of its own, nor the same version.
pub use glam;
