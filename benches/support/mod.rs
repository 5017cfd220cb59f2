//! Meshes that the benchmarks share, the same in every run.
//!
//! With `VITRUM_MESHES` set to a folder of `name/name.obj`, meshes of at least [`LEAST`] triangles in it are used (or
//! those whose names `VITRUM_BENCH_MESHES` lists, comma-separated); without it a sphere with bumps.

#![allow(dead_code, reason = "each benchmark uses its own part")]

use std::path::Path;

use glam::Vec3;
use vitrum::geometry::{Geometry, GeometryMask, Shape, TriMesh};

/// Smaller meshes say little about traversal.
const LEAST: usize = 50_000;

/// A mesh, by name.
pub struct Model {
    pub name: String,
    pub geometry: Vec<Geometry>,
}

impl Model {
    fn new(name: &str, mesh: TriMesh) -> Self {
        let geometry = vec![Geometry { shape: Shape::Mesh(mesh), mask: GeometryMask::OPAQUE }];
        Self { name: name.to_owned(), geometry }
    }

    pub fn mesh(&self) -> &TriMesh {
        match &self.geometry[0].shape {
            Shape::Mesh(mesh) => mesh,
            _ => unreachable!("a model is one mesh"),
        }
    }
}

/// The meshes to measure with.
pub fn models() -> Vec<Model> {
    let Some(folder) = std::env::var_os("VITRUM_MESHES") else {
        return vec![Model::new("bumpy_sphere_80k", bumpy_sphere(200))];
    };
    let only = std::env::var("VITRUM_BENCH_MESHES").ok();
    let wanted = |name: &str| only.as_ref().is_none_or(|list| list.split(',').any(|n| n == name));
    let entries = std::fs::read_dir(&folder).expect("VITRUM_MESHES names a folder");
    let mut names: Vec<String> = entries.filter_map(|e| e.ok()?.file_name().into_string().ok()).collect();
    names.sort();
    names.retain(|name| wanted(name));
    let read = |name: &String| {
        let text = std::fs::read_to_string(Path::new(&folder).join(name).join(format!("{name}.obj"))).ok()?;
        Some(Model::new(name, obj(&text)))
    };
    names.iter().filter_map(read).filter(|m| only.is_some() || m.mesh().triangles.len() >= LEAST).collect()
}

/// A sphere of `n` stacks and `2 n` slices with waves on it.
fn bumpy_sphere(n: u32) -> TriMesh {
    let point = |stack: u32, slice: u32| {
        let theta = std::f32::consts::PI * stack as f32 / n as f32;
        let phi = std::f32::consts::PI * slice as f32 / n as f32;
        let r = 1.0 + 0.05 * (12.0 * phi).sin() * (10.0 * theta).sin();
        r * Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin())
    };
    let positions = (0..=n).flat_map(|stack| (0..2 * n).map(move |slice| point(stack, slice))).collect();
    let at = |stack: u32, slice: u32| stack * 2 * n + slice % (2 * n);
    let quads = (0..n).flat_map(|stack| (0..2 * n).map(move |slice| (stack, slice)));
    let triangles = quads
        .flat_map(|(i, k)| [[at(i, k), at(i, k + 1), at(i + 1, k)], [at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)]])
        .collect();
    TriMesh { positions, triangles, ..Default::default() }
}

/// `v` and `f` lines of a well-formed OBJ file; polygons as fans.
fn obj(text: &str) -> TriMesh {
    let mut mesh = TriMesh::default();
    for line in text.lines() {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let mut next = || words.next().and_then(|w| w.parse().ok()).expect("a coordinate");
                mesh.positions.push(Vec3::new(next(), next(), next()));
            }
            Some("f") => {
                let index = |w: &str| w.split('/').next()?.parse::<u32>().ok().map(|i| i - 1);
                let corners: Vec<u32> = words.map(|w| index(w).expect("an index")).collect();
                mesh.triangles.extend((2..corners.len()).map(|i| [corners[0], corners[i - 1], corners[i]]));
            }
            _ => {}
        }
    }
    mesh
}
