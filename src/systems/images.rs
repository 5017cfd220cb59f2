//! Curved reflectors after Ofek and Rappoport: a second scene behind each mirror ball, in which every point is where the eye
//! sees it in the ball.
//!
//! The scene is cut into small triangles, whose corners are moved to their virtual points ([`super::alhazen`]). A ray from
//! the eye that meets one of them shows the place of the scene that it was cut from. What is seen is exact at corners; in
//! between, the image of a straight edge is straight and not curved.

use glam::{DVec2, DVec3, Vec3};

use super::alhazen::MirrorBall;
use super::reflector::reflectors;
use super::tessellate::{Corner, Piece, tessellate};
use crate::geometry::{Geometry, GeometryMask, Shape, TriMesh};
use crate::scene::{Projection, Scene};

/// Largest angle that an edge of a reflected triangle spans as seen from the reflector's centre, in radians.
pub const ANGLE: f64 = 0.04;

/// Virtual scene of one reflector.
#[derive(Clone, Debug)]
pub struct Image {
    /// The reflector.
    pub object: u32,
    /// Moved triangles, a mesh an object.
    pub geometry: Vec<Geometry>,
    /// By mesh: its object, and the piece that each triangle was.
    sources: Vec<(u32, Vec<Piece>)>,
    /// Points that the eye sees in the reflector, of all that were moved.
    pub seen: [u64; 2],
    /// Pieces left out because a corner lies in the reflector.
    pub inside: u64,
}

/// Place in the scene that a virtual hit shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// The object.
    pub object: u32,
    /// Triangle of a mesh; 0 on other shapes.
    pub primitive: u32,
    /// Barycentric coordinates; 0 on other shapes.
    pub uv: DVec2,
    /// The place, in scene units.
    pub place: DVec3,
}

/// Virtual scenes of all reflectors that can have one.
#[derive(Clone, Debug, Default)]
pub struct Images {
    /// One a reflector.
    pub list: Vec<Image>,
    /// Reflectors without one, with the reasons; what they reflect is traced.
    pub without: Vec<(u32, &'static str)>,
    of_object: Vec<Option<u32>>,
}

impl Images {
    /// The virtual scenes of a scene for its own camera.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let mut images = Self { of_object: vec![None; scene.objects.len()], ..Self::default() };
        let eye = scene.camera.eye.as_dvec3();
        for object in reflectors(scene) {
            match ball(scene, object, eye) {
                Err(why) => images.without.push((object as u32, why)),
                Ok(ball) => {
                    images.of_object[object] = Some(images.list.len() as u32);
                    images.list.push(Image::of(scene, object, &ball, eye, ANGLE));
                }
            }
        }
        images
    }

    /// Returns the number of reflectors that can have a virtual scene, and the first that cannot, with the reason.
    #[must_use]
    pub fn possible(scene: &Scene) -> (usize, Option<(u32, &'static str)>) {
        let eye = scene.camera.eye.as_dvec3();
        reflectors(scene).fold((0, None), |(count, first), object| match ball(scene, object, eye) {
            Ok(_) => (count + 1, first),
            Err(why) => (count, first.or(Some((object as u32, why)))),
        })
    }

    /// The place of an object's virtual scene in the list.
    #[inline]
    #[must_use]
    pub fn at(&self, object: u32) -> Option<usize> {
        self.of_object.get(object as usize).copied().flatten().map(|i| i as usize)
    }
}

/// The ball that an object is, or the reason why it has no virtual scene.
fn ball(scene: &Scene, object: usize, eye: DVec3) -> Result<MirrorBall, &'static str> {
    let Shape::Sphere(sphere) = &scene.geometry[object].shape else { return Err("is no exact sphere") };
    let ball = MirrorBall { centre: sphere.centre.as_dvec3(), radius: f64::from(sphere.radius) };
    if !matches!(scene.camera.projection, Projection::Pinhole { .. }) {
        return Err("is not seen from one point");
    }
    if (eye - ball.centre).length() <= ball.radius {
        return Err("is seen from inside, where a point has several images");
    }
    Ok(ball)
}

impl Image {
    /// The virtual scene of `object`, which is `ball`, for an eye; edges of reflected triangles span at most `angle` radians as
    /// seen from the ball's centre.
    #[must_use]
    pub fn of(scene: &Scene, object: usize, ball: &MirrorBall, eye: DVec3, angle: f64) -> Self {
        let mut image =
            Self { object: object as u32, geometry: Vec::new(), sources: Vec::new(), seen: [0, 0], inside: 0 };
        for (other, geometry) in scene.geometry.iter().enumerate().filter(|&(other, _)| other != object) {
            let (mut mesh, mut sources) = (TriMesh::default(), Vec::new());
            for piece in tessellate(&geometry.shape, ball.centre, ball.radius, angle) {
                let moved = piece.corners.map(|corner| ball.virtual_point(eye, corner.place));
                let [Some(a), Some(b), Some(c)] = moved else {
                    image.inside += 1;
                    continue;
                };
                let seen = [a, b, c].iter().filter(|(_, mirror)| mirror.seen).count() as u64;
                image.seen = [image.seen[0] + seen, image.seen[1] + 3];
                if seen == 0 {
                    continue;
                }
                let first = mesh.positions.len() as u32;
                mesh.positions.extend([a, b, c].map(|(place, _)| place.as_vec3()));
                // A mirror image is wound the other way; rays meet either side.
                mesh.triangles.push([first, first + 1, first + 2]);
                sources.push(piece);
            }
            if !sources.is_empty() {
                image.geometry.push(Geometry { shape: Shape::Mesh(mesh), mask: GeometryMask::ALL });
                image.sources.push((other as u32, sources));
            }
        }
        image
    }

    /// The place in `scene` that a hit of the virtual scene shows.
    #[must_use]
    pub fn shown(&self, scene: &Scene, geometry: u32, triangle: u32, uv: DVec2) -> Shown {
        let (object, pieces) = &self.sources[geometry as usize];
        let Piece { corners, primitive } = pieces[triangle as usize];
        let weights = [1.0 - uv.x - uv.y, uv.x, uv.y];
        let mixed = |of: fn(&Corner) -> DVec3| (0..3).map(|k| of(&corners[k]) * weights[k]).sum::<DVec3>();
        let place = mixed(|corner| corner.place);
        let uv = mixed(|corner| corner.uv.extend(0.0)).truncate();
        let place = match &scene.geometry[*object as usize].shape {
            Shape::Sphere(sphere) => {
                let centre = sphere.centre.as_dvec3();
                centre + (place - centre).normalize() * f64::from(sphere.radius)
            }
            Shape::Mesh(_) | Shape::Plane(_) => place,
        };
        Shown { object: *object, primitive, uv, place }
    }

    /// Triangles of the virtual scene.
    #[must_use]
    pub fn triangles(&self) -> usize {
        self.sources.iter().map(|(_, pieces)| pieces.len()).sum()
    }
}

impl Shown {
    /// The place, as `f32`.
    #[must_use]
    pub fn place32(&self) -> Vec3 {
        self.place.as_vec3()
    }
}
