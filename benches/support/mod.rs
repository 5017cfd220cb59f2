//! Meshes and rays that the benchmarks share, the same in every run.
//!
//! With `VITRUM_MESHES` set to a folder of `name/name.obj`, meshes of at least [`LEAST`] triangles in it are used (or
//! those whose names `VITRUM_BENCH_MESHES` lists, comma-separated); without it a sphere with bumps.

#![allow(dead_code, reason = "each benchmark uses its own part")]

use std::path::Path;

use glam::Vec3;
use vitrum::accel::native::{Native, Scratch};
use vitrum::accel::{Coherence, Intersector};
use vitrum::geometry::{Aabb, Geometry, GeometryMask, Hit, Hit8, Ray, Ray8, Shape, TriMesh};

/// Smaller meshes say little about traversal.
const LEAST: usize = 50_000;

/// Pixels along each side of the picture whose rays are traced.
const SIDE: usize = 1024;

/// One tile of 8 x 8 pixels in so many is taken, row by row, so that a set has 65,536 camera rays.
const ONE_IN: usize = 16;

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

/// Rays of one kind, and what is asked about them.
pub struct RaySet {
    pub name: &'static str,
    pub rays: Vec<Ray8>,
    pub any_hit: bool,
    pub coherence: Coherence,
}

impl RaySet {
    /// How many rays there are.
    pub fn len(&self) -> usize {
        self.rays.iter().map(|r| r.active.count_ones() as usize).sum()
    }
}

/// All kinds of rays at one model.
pub fn ray_sets(model: &Model, native: &Native) -> Vec<RaySet> {
    let bounds = model.mesh().bounds();
    let diagonal = bounds.diagonal();
    let primary = camera_rays(&bounds);
    let seen = Seen { mesh: model.mesh(), native };
    let surface: Vec<Surface> = seen.surfaces(&primary);
    let light = bounds.centre() + Vec3::new(0.6, 1.0, 0.8) * diagonal;
    let shadow = surface.iter().map(|s| {
        let start = s.above(diagonal);
        Ray { t_max: 0.999, ..Ray::new(start, light - start) }
    });
    let mirror =
        surface.iter().map(|s| Ray::new(s.above(diagonal), s.incident - s.normal * (2.0 * s.incident.dot(s.normal))));
    let mut state = 1;
    let diffuse: Vec<Ray> = surface.iter().map(|s| Ray::new(s.above(diagonal), s.cosine(&mut state))).collect();
    let inside: Vec<Ray> = surface.iter().filter_map(|s| s.refracted(1.0 / 1.5, diagonal)).collect();
    let refracted = seen.surfaces(&inside).into_iter().filter_map(|s| s.refracted(1.5, diagonal));
    let set = |name, rays: Vec<Ray>, any_hit, coherence| RaySet { name, rays: Ray8::pack(&rays), any_hit, coherence };
    vec![
        set("shadow", shadow.collect(), true, Coherence::Coherent),
        set("mirror", mirror.collect(), false, Coherence::Incoherent),
        set("refracted", refracted.collect(), false, Coherence::Incoherent),
        set(
            "diffuse-any",
            diffuse.iter().map(|r| Ray { t_max: diagonal * 0.25, ..*r }).collect(),
            true,
            Coherence::Incoherent,
        ),
        set("diffuse", diffuse, false, Coherence::Incoherent),
        set("primary", primary, false, Coherence::Coherent),
    ]
}

/// A pinhole view of a box from its front, above and to the right: tiles of 8 x 8 pixels, eight rays to 4 x 2 of them.
fn camera_rays(bounds: &Aabb) -> Vec<Ray> {
    let (centre, diagonal) = (bounds.centre(), bounds.diagonal());
    let eye = centre + Vec3::new(0.3, 0.25, 1.0).normalize() * diagonal;
    let forward = (centre - eye).normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let up = right.cross(forward);
    let tiles = SIDE / 8;
    (0..tiles * tiles)
        .step_by(ONE_IN)
        // Row by row the taken tiles would stand in columns; shifting each row spreads them.
        .map(|i| (i + i / tiles * 5 % ONE_IN) % (tiles * tiles))
        .flat_map(|tile| {
            (0..64).map(move |k| (tile % tiles * 8 + k / 8 % 2 * 4 + k % 4, tile / tiles * 8 + k / 16 * 2 + k / 4 % 2))
        })
        .map(|(x, y)| {
            let at = |i: usize| ((i as f32 + 0.5) / SIDE as f32 - 0.5) * 0.9;
            Ray::new(eye, (forward + right * at(x) - up * at(y)).normalize())
        })
        .collect()
}

/// A point that a ray met.
struct Surface {
    point: Vec3,
    incident: Vec3,
    /// Geometric, of unit length, against the ray.
    normal: Vec3,
}

impl Surface {
    /// Where rays leave it by the side they came from.
    fn above(&self, diagonal: f32) -> Vec3 {
        self.point + self.normal * (diagonal * 1e-4)
    }

    /// The refracted ray, or none where all is reflected.
    fn refracted(&self, eta: f32, diagonal: f32) -> Option<Ray> {
        let cos_i = -self.incident.dot(self.normal);
        let squared = 1.0 - eta * eta * (1.0 - cos_i * cos_i);
        let dir = self.incident * eta + self.normal * (eta * cos_i - squared.max(0.0).sqrt());
        (squared > 0.0).then(|| Ray::new(self.point - self.normal * (diagonal * 1e-4), dir.normalize()))
    }

    /// A direction of the upper hemisphere by cosine (Malley's method; Duff et al. 2017 for the basis).
    fn cosine(&self, state: &mut u64) -> Vec3 {
        let mut unit = || {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*state >> 40) as f32 / (1 << 24) as f32
        };
        let (r, phi) = (unit().sqrt(), unit() * std::f32::consts::TAU);
        let n = self.normal;
        let sign = 1.0_f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        let (s, t) =
            (Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3::new(b, sign + n.y * n.y * a, -n.y));
        s * (r * phi.cos()) + t * (r * phi.sin()) + n * (1.0 - r * r).max(0.0).sqrt()
    }
}

struct Seen<'a> {
    mesh: &'a TriMesh,
    native: &'a Native,
}

impl Seen<'_> {
    /// What the rays meet, misses left out.
    fn surfaces(&self, rays: &[Ray]) -> Vec<Surface> {
        let packets = Ray8::pack(rays);
        let mut hits = vec![Hit8::default(); packets.len()];
        self.native.closest(&packets, &mut hits, Coherence::Incoherent, &mut Scratch::default());
        let surface = |ray: &Ray, hit: Hit| {
            let [a, b, c] = self.mesh.corners(hit.primitive as usize);
            let normal = (b - a).cross(c - a).try_normalize()?;
            let point = a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v;
            let normal = if normal.dot(ray.dir) > 0.0 { -normal } else { normal };
            Some(Surface { point, incident: ray.dir, normal })
        };
        let met = rays.iter().enumerate().map(|(i, ray)| (ray, hits[i / 8].lane(i % 8)));
        met.filter(|(_, hit)| hit.is_hit()).filter_map(|(ray, hit)| surface(ray, hit)).collect()
    }
}
