//! Tests of the library, one module a subject.

mod support;

mod accel;
mod agreement;
mod arbiter;
mod choices;
mod cracks;
mod dispersion;
mod effects;
#[cfg(feature = "embree")]
mod embree;
#[cfg(feature = "embree")]
mod embree_library;
mod formats;
mod formulas;
mod hard;
mod hard_scenes;
mod input;
mod library;
mod notices;
mod optics;
mod povray;
mod reference_renderer;
mod refraction_models;
mod render;
mod scenes;
mod shine;
mod slivers;
mod soft_shadows;
mod study;
mod systems;
mod touching;
mod triangle_tests;
