//! First surfaces behind the pixels: depth, normal, object and texture coordinates for guides, masks and other shading.

use glam::{Vec2, Vec3};

use super::camera::Lens;
use crate::Result;
use crate::accel::{Coherence, Intersector};
use crate::geometry::{Hit, Hit8, Ray, Ray8, Shape, Spot};
use crate::scene::Scene;
use crate::system::memory;

/// First surface that a camera ray hits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstHit {
    /// Index in [`Scene::objects`]; `None` if the ray hits nothing.
    pub object: Option<u32>,
    /// Triangle within the mesh; 0 on other shapes.
    pub primitive: u32,
    /// Distance along the ray, in scene units; infinite if it hits nothing.
    pub depth: f32,
    /// Position on the surface, in scene units; zero if the ray hits nothing.
    pub point: Vec3,
    /// Unit normal of the shape, on its outer side; zero if the ray hits nothing.
    pub normal: Vec3,
    /// Unit normal for shading, on the outer side: interpolated where the mesh has normals, else `normal`.
    pub shading_normal: Vec3,
    /// Texture coordinates; zero where the mesh has none, and on spheres and planes.
    pub uv: Vec2,
}

impl Default for FirstHit {
    fn default() -> Self {
        Self::MISS
    }
}

impl FirstHit {
    /// Result of a ray that hits nothing.
    pub const MISS: Self = Self {
        object: None,
        primitive: 0,
        depth: f32::INFINITY,
        point: Vec3::ZERO,
        normal: Vec3::ZERO,
        shading_normal: Vec3::ZERO,
        uv: Vec2::ZERO,
    };

    /// Returns the surface of `scene` that `ray` hits at `hit`.
    #[must_use]
    pub fn new(scene: &Scene, ray: &Ray, hit: &Hit) -> Self {
        if !hit.is_hit() {
            return Self::MISS;
        }
        let shape = &scene.geometry[hit.geometry as usize].shape;
        let spot = Spot::at(shape, ray, hit);
        let normal = Vec3::from(spot.outward);
        let blend = |[a, b, c]: [Vec3; 3]| a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v;
        let (mut shading_normal, mut uv) = (normal, Vec2::ZERO);
        if let Shape::Mesh(mesh) = shape {
            let triangle = hit.primitive as usize;
            let smooth = mesh.corner_normals(triangle).and_then(|corners| blend(corners).try_normalize());
            shading_normal = smooth.unwrap_or(normal);
            uv = mesh.corner_uvs(triangle).map_or(uv, |corners| blend(corners.map(|uv| uv.extend(0.0))).truncate());
        }
        Self {
            object: Some(hit.geometry),
            primitive: hit.primitive,
            depth: hit.t,
            point: spot.point.into(),
            normal,
            shading_normal,
            uv,
        }
    }
}

/// Traces one ray through the centre of each pixel of `scene.settings` and returns the surfaces hit, row by row from the
/// upper left.
///
/// `accel` was built from `scene.geometry`. Works on the calling thread.
///
/// # Errors
/// [`Error::Limit`](crate::Error::Limit) if the list does not fit in memory.
pub fn first_hits<I: Intersector>(scene: &Scene, accel: &I) -> Result<Vec<FirstHit>> {
    let (width, height) = (scene.settings.width, scene.settings.height);
    let lens = Lens::new(&scene.camera, width, height);
    let mut all = Vec::new();
    memory::reserve(&mut all, width as usize * height as usize, "first hits", "take a smaller picture")?;
    let mut scratch = I::Scratch::default();
    let (mut row, mut hits) = (Vec::new(), Vec::new());
    for y in 0..height {
        row.clear();
        row.extend((0..width).map(|x| lens.ray(x as f32 + 0.5, y as f32 + 0.5)));
        let packets = Ray8::pack(&row);
        hits.clear();
        hits.resize(packets.len(), Hit8::default());
        accel.closest(&packets, &mut hits, Coherence::Coherent, &mut scratch);
        all.extend(row.iter().enumerate().map(|(i, ray)| FirstHit::new(scene, ray, &hits[i / 8].lane(i % 8))));
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::native::Native;
    use crate::geometry::{Sphere, TriMesh};
    use crate::scene::{Camera, Material, Projection, Settings};

    /// By hand: parallel rays along -z, one unit apart, at a sphere of radius 1 around 0 and a triangle behind it.
    #[test]
    fn depth_normal_and_object_are_those_of_the_first_surface() {
        let mut scene = Scene {
            camera: Camera {
                eye: Vec3::Z * 5.0,
                projection: Projection::Orthographic { height: 3.0 },
                ..Camera::default()
            },
            settings: Settings { width: 3, height: 3, ..Settings::default() },
            ..Scene::default()
        };
        let grey = scene.add_material(Material::default());
        let corners = [[-9.0, -9.0], [9.0, -9.0], [0.0, 9.0]].map(|[x, y]: [f32; 2]| Vec3::new(x, y, -2.0));
        let mut wall = TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]);
        wall.normals = vec![Vec3::new(0.6, 0.0, 0.8)];
        wall.normal_indices = vec![[0; 3]];
        wall.uvs = vec![Vec2::ZERO, Vec2::X, Vec2::new(0.5, 1.0)];
        wall.uv_indices = vec![[0, 1, 2]];
        let wall = scene.add_object("wall", wall, grey);
        let ball = scene.add_object("ball", Sphere { centre: Vec3::ZERO, radius: 0.5 }, grey);
        let hits = first_hits(&scene, &Native::build(&scene.geometry)).unwrap();
        assert_eq!((hits[4].object, hits[4].depth, hits[4].normal), (Some(ball), 4.5, Vec3::Z));
        // Right of the middle, at (1, 0, -2).
        let beside = hits[5];
        assert_eq!((beside.object, beside.depth, beside.normal), (Some(wall), 7.0, Vec3::Z));
        assert!((beside.point - Vec3::new(1.0, 0.0, -2.0)).length() < 1e-6, "{beside:?}");
        assert!((beside.shading_normal - Vec3::new(0.6, 0.0, 0.8)).length() < 1e-6);
        // Affine: (-9, -9) is (0, 0), (9, -9) is (1, 0), (0, 9) is (0.5, 1).
        assert!((beside.uv - Vec2::new(0.5 + 1.0 / 18.0, 0.5)).length() < 1e-6, "{beside:?}");
    }

    #[test]
    fn a_ray_that_meets_nothing_is_a_miss() {
        let scene = Scene { settings: Settings { width: 2, height: 1, ..Settings::default() }, ..Scene::default() };
        assert_eq!(first_hits(&scene, &Native::build(&[])).unwrap(), [FirstHit::MISS; 2]);
    }
}
