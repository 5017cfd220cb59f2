//! Promise: the optics are as accurate as they say, in both directions through a boundary, one lane as eight.
//!
//! Every bound holds against a double-double oracle (about 32 digits) that evaluates the textbook equations on the same
//! `f32` inputs. `cargo test --test suite optics:: -- --nocapture` prints what was measured.

mod absorption;
mod approximations;
mod dispersion;
mod errata;
mod fresnel;
mod fresnel_accuracy;
mod lanes;
mod metals;
mod metals_by_spectrum;
mod mueller;
mod normals;
mod oracle;
mod reflection;
mod refraction;
mod sample;
