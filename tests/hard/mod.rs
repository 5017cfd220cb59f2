//! The hard cases that no other test covers, in one file a group. `tests/README.md` lists all of them, by the ids that the
//! doc comments here carry, with the test of each.

mod absorption;
mod accumulation;
mod boxes;
mod build;
mod camera_and_lights;
mod fresnel;
mod lanes;
mod magnitudes;
mod parity;
mod reflection;
mod refraction;
mod self_intersection;
mod spheres;
mod traversal;
mod triangles;
