//! The hierarchy with and without geometry masks.

use std::io::Write;

use glam::Vec3;

use super::hierarchy::{Embree, Scratch};
use super::library::Library;
use super::options::{Options, Width};
use crate::accel::{Coherence, Intersector as _};
use crate::geometry::{Geometry, GeometryMask, Hit, Hit8, Ray, Ray8, Shape, Sphere, TriMesh};
use crate::simd::Mask8;

/// Returns the library. Without it, prints that `test` was skipped, or fails if VITRUM_REQUIRE_EMBREE is set.
pub fn library(test: &str) -> Option<&'static Library> {
    let library = Library::open(None);
    if let Err(e) = &library {
        assert!(std::env::var_os("VITRUM_REQUIRE_EMBREE").is_none(), "{test}: {e}");
        writeln!(std::io::stderr(), "SKIPPED {test}: {e}").ok();
    }
    library.ok()
}

#[test]
fn a_scene_for_each_mask_does_what_masks_do() {
    let Some(library) = library("separate scenes") else { return };
    let shapes: Vec<Geometry> = (0..40_u8)
        .map(|i| {
            let place = Vec3::new(0.0, 0.0, -f32::from(i) * 3.0);
            let corners = [Vec3::new(-9.0, -9.0, 0.0), Vec3::new(9.0, -9.0, 0.0), Vec3::new(0.0, 9.0, 0.0)];
            let positions = corners.map(|c| c + place).to_vec();
            let wall = TriMesh { positions, triangles: vec![[0, 1, 2]], ..TriMesh::default() };
            let ball = Sphere { centre: place, radius: 1.0 };
            let shape = if i % 3 == 0 { Shape::Sphere(ball) } else { Shape::Mesh(wall) };
            Geometry { shape, mask: GeometryMask(i % 4) }
        })
        .collect();
    let rays: Vec<Ray8> = (0..100_u8)
        .map(|k| {
            let start = Vec3::new(0.1, 0.2, 3.0 - 2.0 * f32::from(k));
            let mut packet = Ray8::pack(&[Ray::new(start, Vec3::NEG_Z); 8]).remove(0);
            packet.admits = GeometryMask(k % 4);
            packet
        })
        .collect();
    for width in [Width::One, Width::Eight, Width::Sixteen] {
        let options = Options { width, ..Options::default() };
        let run = |masks| {
            let accel = Embree::build_with(&shapes, &options, library, masks).unwrap();
            let mut hits = vec![Hit8::default(); rays.len()];
            let mut blocked = vec![Mask8::NONE; rays.len()];
            accel.closest(&rays, &mut hits, Coherence::Coherent, &mut Scratch::default());
            accel.occluded(&rays, &mut blocked, Coherence::Coherent, &mut Scratch::default());
            let hits: Vec<Hit> = hits.iter().map(|h| h.lane(3)).collect();
            (accel.parts.len(), hits, blocked)
        };
        let (one, with, with_blocked) = run(true);
        let (several, without, without_blocked) = run(false);
        assert_eq!((one, several), (1, 4));
        assert!(with == without && with_blocked == without_blocked);
        assert!(with.iter().filter(|h| h.is_hit()).count() > 40 && with.iter().any(|h| !h.is_hit()));
    }
}
