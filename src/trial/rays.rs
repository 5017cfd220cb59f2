//! Rays that back ends are compared on: six kinds, the same in every run.
//!
//! A pinhole picture in tiles of 8 x 8 pixels gives the primary rays. A packet covers 4 x 2 pixels, and two packets 4 x
//! 4. Their hits give the other kinds, in the same order and without the misses, so that all packets but the last are
//! full.

use glam::Vec3;
use rayon::prelude::*;

use crate::accel::{Coherence, Intersector};
use crate::geometry::{Aabb, Geometry, Hit, Hit8, Ray, Ray8, Shape};
use crate::measure::random::Pcg32;

/// Refractive index behind every surface, for all kinds of rays.
const INDEX: f32 = 1.5;

/// Distance of secondary rays' origins from the surface, relative to the scene's diagonal.
const PUSH: f32 = 1e-4;

/// Length of shadow rays relative to the distance of the light.
const BEFORE_LIGHT: f32 = 0.999;

/// Length of `diffuse-any` rays relative to the scene's diagonal.
const NEARBY: f32 = 0.25;

/// Number of packets that a thread takes at a time.
const CHUNK: usize = 64;

crate::choice! {
    /// Kinds of rays.
    pub enum RayKind("rays", derive(Eq, Hash)) {
        /// From the eye through the centre of each pixel.
        "primary" => Primary,
        /// From each surface to a point light, any hit up to 0.999 of the distance.
        "shadow" => Shadow,
        /// Reflected about the geometric normal.
        "mirror" => Mirror,
        /// Refracted into index 1.5, and at the next surface out of it.
        ///
        /// Inside and outside are not asked for, so that open meshes serve too. A ray that is totally reflected at the exit ends there.
        /// First come all rays that enter, then all that leave, as in a renderer's streams.
        "refracted" => Refracted,
        /// Into the hemisphere with the density of the cosine.
        "diffuse" => Diffuse,
        /// Into the hemisphere with the density of the cosine, any hit within a quarter of the scene's diagonal.
        "diffuse-any" => DiffuseAny,
    }
}

impl RayKind {
    /// Returns true if any hit suffices, false if the nearest is needed.
    #[must_use]
    pub fn any_hit(self) -> bool {
        matches!(self, Self::Shadow | Self::DiffuseAny)
    }

    /// Coherence that a renderer would declare for these rays.
    #[must_use]
    pub fn coherence(self) -> Coherence {
        match self {
            Self::Primary | Self::Shadow => Coherence::Coherent,
            _ => Coherence::Incoherent,
        }
    }
}

/// Rays of one kind.
#[derive(Clone, Debug)]
pub struct RaySet {
    /// Kind of the rays.
    pub kind: RayKind,
    /// Full packets, except for the last one.
    pub rays: Vec<Ray8>,
    /// Number of rays.
    pub count: usize,
}

impl RaySet {
    fn new(kind: RayKind, rays: &[Ray]) -> Self {
        Self { kind, rays: Ray8::pack(rays), count: rays.len() }
    }
}

/// Viewpoint and light of the rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Position of the eye.
    pub eye: Vec3,
    /// Point that it looks at; differs from `eye`.
    pub target: Vec3,
    /// Up direction.
    pub up: Vec3,
    /// Full angle of view of the square picture, in degrees, between 0 and 180.
    pub fov: f32,
    /// Position of the light that shadow rays go to.
    pub light: Vec3,
}

impl View {
    /// A view of a box from its front, above and to the right, under a light above and behind the eye's shoulder.
    #[must_use]
    pub fn of(bounds: &Aabb) -> Self {
        let (centre, diagonal) = (bounds.centre(), bounds.diagonal());
        Self {
            eye: centre + Vec3::new(0.3, 0.25, 1.0).normalize() * diagonal,
            target: centre,
            up: Vec3::Y,
            fov: 48.5,
            light: Self::light_over(bounds),
        }
    }

    /// Returns a position from which a light reaches the front, the top and the right side of a box.
    #[must_use]
    pub fn light_over(bounds: &Aabb) -> Vec3 {
        bounds.centre() + Vec3::new(0.6, 1.0, 0.8) * bounds.diagonal()
    }

    /// Returns the rays through the pixels of `picture`.
    #[must_use]
    pub fn primary(&self, picture: &Picture) -> Vec<Ray> {
        let forward = (self.target - self.eye).normalize_or(Vec3::NEG_Z);
        let right = forward.cross(self.up).try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
        let up = right.cross(forward);
        let half = (0.5 * self.fov.to_radians()).tan();
        let at = |i: u32| (2.0 * (i as f32 + 0.5) / picture.edge as f32 - 1.0) * half;
        let ray = |(x, y)| Ray::new(self.eye, (forward + right * at(x) - up * at(y)).normalize());
        picture.pixels().map(ray).collect()
    }
}

/// Pixels that rays are traced for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Number of columns and rows; a multiple of 8.
    pub edge: u32,
    /// One tile in so many is used, evenly spread; at least 1.
    pub one_in: u32,
}

impl Default for Picture {
    /// 262,144 pixels of 1024 x 1024.
    fn default() -> Self {
        Self { edge: 1024, one_in: 4 }
    }
}

impl Picture {
    /// Column and row of each pixel used: tiles row by row, and in each the eight blocks of 4 x 2 pixels, in an order
    /// in which two successive blocks make 4 x 4.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> {
        let (tiles, one_in) = (self.edge / 8, self.one_in.max(1));
        let all = (0..tiles * tiles).map(move |i| (i % tiles, i / tiles));
        // Shifted from row to row, so that the tiles do not form columns.
        let taken = all.filter(move |(x, y)| (x + 5 * y).is_multiple_of(one_in));
        taken.flat_map(|(x, y)| {
            (0..64).map(move |k| (8 * x + (k / 32) * 4 + k % 4, 8 * y + (k / 8 % 4) * 2 + k / 4 % 2))
        })
    }
}

/// Returns the box around all bounded shapes that can be hit.
#[must_use]
pub fn bounds(geometry: &[Geometry]) -> Aabb {
    geometry.iter().fold(Aabb::EMPTY, |b, g| match &g.shape {
        Shape::Mesh(mesh) => b.union(mesh.bounds()),
        Shape::Sphere(s) if s.is_usable() => b.union(s.bounds()),
        _ => b,
    })
}

/// Returns rays of all kinds at `geometry`, in the order of [`RayKind::ALL`]. `accel`, which was built over the same
/// list, finds the hits that secondary rays start from.
#[must_use]
pub fn all<I: Intersector>(accel: &I, geometry: &[Geometry], view: &View, picture: &Picture) -> Vec<RaySet> {
    let shapes = Shapes { accel, geometry };
    let bounds = bounds(geometry);
    // If there are only planes, the distance to the target replaces the diagonal.
    let diagonal = if bounds.is_empty() { view.eye.distance(view.target) } else { bounds.diagonal() };
    let push = PUSH * diagonal;

    let primary = view.primary(picture);
    let seen = shapes.met(&primary);
    let shadow: Vec<Ray> = seen.iter().filter_map(|s| s.shadow(view.light, push)).collect();
    let mirror: Vec<Ray> = seen.iter().map(|s| s.mirror(push)).collect();
    let mut random = Pcg32::new(1, 1);
    let diffuse: Vec<Ray> = seen.iter().map(|s| s.diffuse(push, &mut random)).collect();
    let nearby: Vec<Ray> = diffuse.iter().map(|r| Ray { t_max: NEARBY * diagonal, ..*r }).collect();
    let mut refracted: Vec<Ray> = seen.iter().filter_map(|s| s.refracted(1.0 / INDEX, push)).collect();
    let out: Vec<Ray> = shapes.met(&refracted).iter().filter_map(|s| s.refracted(INDEX, push)).collect();
    refracted.extend(out);

    let rays = [primary, shadow, mirror, refracted, diffuse, nearby];
    RayKind::ALL.into_iter().zip(&rays).map(|(kind, rays)| RaySet::new(kind, rays)).collect()
}

struct Shapes<'a, I> {
    accel: &'a I,
    geometry: &'a [Geometry],
}

impl<I: Intersector> Shapes<'_, I> {
    /// Returns the surfaces that the rays hit, in their order, without misses.
    fn met(&self, rays: &[Ray]) -> Vec<Surface> {
        let packets = Ray8::pack(rays);
        let mut hits = vec![Hit8::default(); packets.len()];
        let chunks = packets.par_chunks(CHUNK).zip(hits.par_chunks_mut(CHUNK));
        chunks.for_each_init(I::Scratch::default, |scratch, (rays, hits)| {
            self.accel.closest(rays, hits, Coherence::Incoherent, scratch);
        });
        let met = rays.iter().enumerate().map(|(i, ray)| (ray, hits[i / 8].lane(i % 8)));
        met.filter(|(_, hit)| hit.is_hit()).filter_map(|(ray, hit)| self.surface(ray, &hit)).collect()
    }

    /// Returns the surface of a hit; `None` if a triangle has no area and so no normal.
    fn surface(&self, ray: &Ray, hit: &Hit) -> Option<Surface> {
        let along = ray.origin + ray.dir * hit.t;
        let (point, normal) = match &self.geometry[hit.geometry as usize].shape {
            Shape::Mesh(mesh) => {
                let [a, b, c] = mesh.corners(hit.primitive as usize);
                let point = a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v;
                (point, (b - a).cross(c - a).try_normalize()?)
            }
            Shape::Sphere(s) => (along, (along - s.centre).try_normalize()?),
            Shape::Plane(p) => (along, p.normal.try_normalize()?),
        };
        let normal = if normal.dot(ray.dir) > 0.0 { -normal } else { normal };
        Some(Surface { point, incident: ray.dir, normal })
    }
}

/// Surface point that a ray hit.
struct Surface {
    point: Vec3,
    /// Direction of travel, of unit length.
    incident: Vec3,
    /// Geometric normal, of unit length, on the side of the ray.
    normal: Vec3,
}

impl Surface {
    /// Origin of rays that leave on the side of arrival.
    fn above(&self, push: f32) -> Vec3 {
        self.point + self.normal * push
    }

    /// Ray to `light`; `None` if the light is at the surface.
    fn shadow(&self, light: Vec3, push: f32) -> Option<Ray> {
        let start = self.above(push);
        let (dir, distance) = (light - start).normalize_and_length();
        (distance > 0.0).then(|| Ray { t_max: BEFORE_LIGHT * distance, ..Ray::new(start, dir) })
    }

    fn mirror(&self, push: f32) -> Ray {
        Ray::new(self.above(push), self.incident - self.normal * (2.0 * self.incident.dot(self.normal)))
    }

    /// Returns the refracted ray; `None` under total reflection. `eta` is the index on this side over that on the
    /// other.
    fn refracted(&self, eta: f32, push: f32) -> Option<Ray> {
        let cos_i = -self.incident.dot(self.normal);
        let squared = 1.0 - eta * eta * (1.0 - cos_i * cos_i);
        let dir = self.incident * eta + self.normal * (eta * cos_i - squared.max(0.0).sqrt());
        (squared > 0.0).then(|| Ray::new(self.point - self.normal * push, dir.normalize()))
    }

    /// Random direction in the upper hemisphere with the density of the cosine (Malley's method; basis of Duff et al.,
    /// "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017).
    fn diffuse(&self, push: f32, random: &mut Pcg32) -> Ray {
        let (r, phi) = (random.unit().sqrt(), random.unit() * std::f32::consts::TAU);
        let n = self.normal;
        let sign = 1.0_f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        let s = Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
        let t = Vec3::new(b, sign + n.y * n.y * a, -n.y);
        let dir = s * (r * phi.cos()) + t * (r * phi.sin()) + n * (1.0 - r * r).max(0.0).sqrt();
        Ray::new(self.above(push), dir.normalize())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::native::Native;
    use crate::geometry::{GeometryMask, Sphere, TriMesh};

    /// Squares of edge 20 about the z axis, facing +z, as one mesh.
    fn walls(depths: &[f32]) -> Vec<Geometry> {
        let corners = [(-10.0, -10.0), (10.0, -10.0), (10.0, 10.0), (-10.0, 10.0)];
        let positions = depths.iter().flat_map(|&z| corners.map(|(x, y)| Vec3::new(x, y, z))).collect();
        let triangles = (0..depths.len() as u32).flat_map(|i| [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|k| k + 4 * i)));
        let mesh = TriMesh { positions, triangles: triangles.collect(), ..TriMesh::default() };
        vec![Geometry { shape: Shape::Mesh(mesh), mask: GeometryMask::OPAQUE }]
    }

    fn front(fov: f32) -> View {
        let light = Vec3::new(0.0, 0.0, 50.0);
        View { eye: Vec3::new(0.0, 0.0, 10.0), target: Vec3::ZERO, up: Vec3::Y, fov, light }
    }

    fn sets(geometry: &[Geometry], view: &View) -> Vec<RaySet> {
        let picture = Picture { edge: 16, one_in: 1 };
        all(&Native::build(geometry), geometry, view, &picture)
    }

    fn rays(set: &RaySet) -> Vec<Ray> {
        (0..set.count).map(|i| set.rays[i / 8].lane(i % 8)).collect()
    }

    fn near(a: Vec3, b: Vec3) -> bool {
        a.distance(b) < 1e-4
    }

    #[test]
    fn eight_pixels_in_order_make_a_block_of_four_by_two_and_sixteen_one_of_four_by_four() {
        let pixels: Vec<_> = Picture { edge: 16, one_in: 1 }.pixels().collect();
        assert_eq!(pixels.len(), 256);
        assert_eq!(pixels[..8], [(0, 0), (1, 0), (2, 0), (3, 0), (0, 1), (1, 1), (2, 1), (3, 1)]);
        for (n, width, height) in [(8, 4, 2), (16, 4, 4), (64, 8, 8)] {
            for block in pixels.chunks(n) {
                let (x, y) = block[0];
                assert!(block.iter().all(|&(a, b)| (x..x + width).contains(&a) && (y..y + height).contains(&b)));
            }
        }
        let mut sorted = pixels.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), 256);
    }

    #[test]
    fn one_tile_in_four_is_a_quarter_of_the_picture_and_stands_in_every_row_and_column() {
        let pixels: Vec<_> = Picture { edge: 64, one_in: 4 }.pixels().collect();
        assert_eq!(pixels.len(), 64 * 64 / 4);
        for k in 0..64 {
            assert!(pixels.iter().any(|&(x, _)| x == k) && pixels.iter().any(|&(_, y)| y == k));
        }
        assert_eq!(Picture::default().pixels().count(), 262_144);
    }

    #[test]
    fn the_first_pixel_is_up_and_to_the_left() {
        // At 90 degrees the picture's edge, one unit away, runs from -1 to 1; the first of 16 pixels is at -15/16.
        let first = front(90.0).primary(&Picture { edge: 16, one_in: 1 })[0];
        assert!(near(first.dir, Vec3::new(-0.9375, 0.9375, -1.0).normalize()) && first.origin.z == 10.0);
    }

    #[test]
    fn shadow_rays_stop_just_short_of_the_light() {
        let sets = sets(&walls(&[0.0]), &front(60.0));
        let shadow = rays(&sets[1]);
        assert_eq!(shadow.len(), 256);
        for ray in shadow {
            let push = 1e-4 * 800.0_f32.sqrt();
            assert!((ray.origin.z - push).abs() < 1e-6);
            let distance = ray.origin.distance(Vec3::new(0.0, 0.0, 50.0));
            assert!((ray.t_max - 0.999 * distance).abs() < 1e-4 && (ray.dir.length() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_mirror_square_to_z_turns_z_alone() {
        let sets = sets(&walls(&[0.0]), &front(60.0));
        for (primary, mirror) in rays(&sets[0]).iter().zip(rays(&sets[2])) {
            assert!(near(mirror.dir, primary.dir * Vec3::new(1.0, 1.0, -1.0)) && mirror.origin.z > 0.0);
        }
    }

    #[test]
    fn refracted_rays_obey_snell_and_leave_a_slab_as_they_came() {
        let sets = sets(&walls(&[0.0, -1.0]), &front(60.0));
        let (primary, refracted) = (rays(&sets[0]), rays(&sets[3]));
        assert_eq!(refracted.len(), 512);
        for (i, ray) in primary.iter().enumerate() {
            let (inside, outside) = (&refracted[i], &refracted[256 + i]);
            // Sines shrink by the index; the second wall undoes the first.
            assert!((inside.dir.truncate() * 1.5).distance(ray.dir.truncate()) < 1e-5);
            assert!(near(outside.dir, ray.dir));
            assert!(inside.origin.z < 0.0 && inside.origin.z > -0.1 && outside.origin.z < -1.0);
        }
    }

    #[test]
    fn an_open_mesh_is_entered_all_the_same_and_nothing_leaves_it() {
        // The wall's back refracts as its front does.
        let mut behind = front(60.0);
        behind.eye.z = -10.0;
        for view in [front(60.0), behind] {
            let sets = sets(&walls(&[0.0]), &view);
            assert_eq!(rays(&sets[3]).len(), 256);
        }
    }

    #[test]
    fn beyond_the_critical_angle_nothing_leaves() {
        // From inside a ball of index 1.5, off its centre, where some rays exceed the critical angle of 41.8 degrees.
        let ball = Sphere { centre: Vec3::ZERO, radius: 1.0 };
        let surface = |sine: f32| Surface {
            point: ball.centre,
            incident: Vec3::new(sine, 0.0, -(1.0 - sine * sine).sqrt()),
            normal: Vec3::Z,
        };
        assert!(surface(0.66).refracted(1.5, 0.0).is_some());
        assert!(surface(0.67).refracted(1.5, 0.0).is_none());
    }

    #[test]
    fn diffuse_rays_leave_upwards_by_cosine_and_differ_from_ray_to_ray() {
        let sets = sets(&walls(&[0.0]), &front(60.0));
        let (diffuse, nearby) = (rays(&sets[4]), rays(&sets[5]));
        // The mean cosine of the distribution is 2/3, its standard deviation over 256 rays 0.015.
        let mean = diffuse.iter().map(|r| r.dir.z).sum::<f32>() / 256.0;
        assert!((mean - 2.0 / 3.0).abs() < 0.06, "{mean}");
        assert!(diffuse.iter().all(|r| r.dir.z >= 0.0 && (r.dir.length() - 1.0).abs() < 1e-5));
        assert!(diffuse.windows(2).all(|w| w[0].dir != w[1].dir));
        let quarter = 0.25 * 800.0_f32.sqrt();
        for (a, b) in diffuse.iter().zip(&nearby) {
            assert!(a.dir == b.dir && a.origin == b.origin && (b.t_max - quarter).abs() < 1e-4);
        }
    }

    #[test]
    fn what_sees_nothing_has_primary_rays_only() {
        let mut away = front(60.0);
        away.target.z = 20.0;
        let counts: Vec<_> = sets(&walls(&[0.0]), &away).iter().map(|s| s.count).collect();
        assert_eq!(counts, [256, 0, 0, 0, 0, 0]);
    }

    #[test]
    fn a_sphere_reflects_straight_back_along_its_axis() {
        let geometry =
            [Geometry { shape: Shape::Sphere(Sphere { centre: Vec3::ZERO, radius: 2.0 }), mask: GeometryMask::OPAQUE }];
        let sets = sets(&geometry, &front(1.0));
        for ray in rays(&sets[2]) {
            assert!(ray.dir.z > 0.98 && (ray.origin.length() - 2.0).abs() < 1e-2);
        }
    }
}
