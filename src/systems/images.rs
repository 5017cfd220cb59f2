//! Curved reflectors after Ofek and Rappoport: a second scene behind each of them, in which every point is where the eye
//! sees it in the reflector.
//!
//! The scene is cut into small triangles, whose corners are moved to their virtual points. These come from Alhazen's problem
//! on a ball ([`super::alhazen`]) and from an explosion map on a mesh ([`super::explosion`]). A ray from
//! the eye that meets one of them shows the place of the scene that it was cut from. What is seen is exact at corners; in
//! between, the image of a straight edge is straight and not curved.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::alhazen::{MirrorBall, MirrorPoint};
use super::explosion::{Explosion, Points, Side};
use super::reflector::reflectors;
use super::tessellate::{Corner, Piece, tessellate};
use crate::geometry::{Geometry, GeometryMask, Shape, TriMesh};
use crate::scene::{Projection, Scene};

/// Largest angle that an edge of a reflected triangle spans as seen from the reflector's centre, in radians. For a ball
/// that spans 0.4 radians at the eye, places are then shown 3e-5 radians off in its middle and 2e-4 near its outline, by the
/// median.
pub const ANGLE: f64 = 0.1;

/// Virtual scene of one side of a reflector.
#[derive(Clone, Debug)]
pub struct Image {
    /// The reflector.
    pub object: u32,
    /// True if it is for rays that arrive from outside.
    pub front: bool,
    /// Moved triangles, a mesh an object.
    pub geometry: Vec<Geometry>,
    /// By mesh: its object, and the piece that each triangle was.
    sources: Vec<(u32, Vec<Piece>)>,
    /// Counts of the points that were to be moved.
    pub points: PointCounts,
    /// Pieces left out because a corner lies in the reflector, or has no reflection point or several.
    pub left_out: u64,
}

/// Counts of the points of a reflected scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PointCounts {
    /// All.
    pub all: u64,
    /// Those with a reflection point that the eye sees.
    pub seen: u64,
    /// Those inside the reflector.
    pub inside: u64,
    /// Those without a reflection point.
    pub none: u64,
    /// Those with several.
    pub several: u64,
}

impl PointCounts {
    fn count(&mut self, moved: Moved) {
        self.all += 1;
        match moved {
            Moved::To(_, seen) => self.seen += u64::from(seen),
            Moved::Inside => self.inside += 1,
            Moved::Nowhere => self.none += 1,
            Moved::Several => self.several += 1,
        }
    }

    /// Adds other counts.
    pub fn add(&mut self, o: &Self) {
        self.all += o.all;
        self.seen += o.seen;
        self.inside += o.inside;
        self.none += o.none;
        self.several += o.several;
    }
}

/// Surface that reflects.
#[derive(Clone, Debug)]
pub enum Surface {
    /// Ball, by Alhazen's problem.
    Ball(MirrorBall),
    /// Triangles, by an explosion map, and the side that is looked at.
    Triangles(Arc<Explosion>, Side),
}

/// Virtual position of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moved {
    /// The position, and true if the eye sees it in the reflector.
    To(DVec3, bool),
    /// None: the point is inside the reflector.
    Inside,
    /// None: no point of the reflector shows it.
    Nowhere,
    /// Several points of the reflector show it.
    Several,
}

impl Surface {
    /// Returns the virtual position of a point for an eye: its mirror image in the plane that touches the reflector in the
    /// reflection point.
    #[must_use]
    pub fn moved(&self, eye: DVec3, other: DVec3) -> Moved {
        let mirrored = |found: MirrorPoint| Moved::To(found.image(other), found.seen);
        match self {
            Self::Ball(ball) => ball.mirror_point(eye, other).map_or(Moved::Inside, mirrored),
            Self::Triangles(map, _) if map.encloses(other) => Moved::Inside,
            Self::Triangles(map, side) => match map.points(*side, eye, other) {
                Points::None => Moved::Nowhere,
                Points::One(found) => mirrored(found),
                Points::Several => Moved::Several,
            },
        }
    }

    /// Returns a ball in its place.
    fn ball(&self) -> MirrorBall {
        match self {
            Self::Ball(ball) => *ball,
            Self::Triangles(map, _) => map.ball(),
        }
    }
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
    /// One for each side of a reflector that the eye may see.
    pub list: Vec<Image>,
    /// Reflectors without one, with the reasons; what they reflect is traced.
    pub without: Vec<(u32, &'static str)>,
    /// By object: the scenes of its front and its back.
    of_object: Vec<[Option<u32>; 2]>,
}

impl Images {
    /// Makes the virtual scenes of a scene for its own camera.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let mut images = Self { of_object: vec![[None; 2]; scene.objects.len()], ..Self::default() };
        let eye = scene.camera.eye.as_dvec3();
        for object in reflectors(scene) {
            match surfaces(scene, object, eye) {
                Err(why) => images.without.push((object as u32, why)),
                Ok(surfaces) => {
                    for (front, surface) in surfaces {
                        images.of_object[object][usize::from(!front)] = Some(images.list.len() as u32);
                        images.list.push(Image::of(scene, object, front, &surface, eye, ANGLE));
                    }
                }
            }
        }
        images
    }

    /// Returns the number of reflectors that can have a virtual scene, and the first that cannot, with the reason.
    #[must_use]
    pub fn possible(scene: &Scene) -> (usize, Option<(u32, &'static str)>) {
        let eye = scene.camera.eye.as_dvec3();
        reflectors(scene).fold((0, None), |(count, first), object| match surfaces(scene, object, eye) {
            Ok(_) => (count + 1, first),
            Err(why) => (count, first.or(Some((object as u32, why)))),
        })
    }

    /// Returns the place in the list of the virtual scene of one side of an object.
    #[inline]
    #[must_use]
    pub fn at(&self, object: u32, front: bool) -> Option<usize> {
        self.of_object.get(object as usize).and_then(|sides| sides[usize::from(!front)]).map(|i| i as usize)
    }
}

/// Returns the sides of an object that an eye may see, each with true for its front, or the reason why it has no virtual scene.
fn surfaces(scene: &Scene, object: usize, eye: DVec3) -> Result<Vec<(bool, Surface)>, &'static str> {
    if !matches!(scene.camera.projection, Projection::Pinhole { .. }) {
        return Err("is not seen from one point");
    }
    match &scene.geometry[object].shape {
        Shape::Plane(_) => Err("is a plane"),
        Shape::Sphere(sphere) => {
            let ball = MirrorBall { centre: sphere.centre.as_dvec3(), radius: f64::from(sphere.radius) };
            if (eye - ball.centre).length() <= ball.radius {
                return Err("is seen from inside, where a point has several images");
            }
            Ok(vec![(true, Surface::Ball(ball))])
        }
        Shape::Mesh(mesh) => {
            let map = Arc::new(Explosion::of(mesh)?);
            if map.encloses(eye) {
                return Err("is seen from inside, where a point has several images");
            }
            let [convex, concave] = map.faces(eye);
            let (outwards, closed) = (map.outwards, map.closed);
            let sides = [(convex, outwards, Side::Convex), (concave && !closed, !outwards, Side::Concave)];
            let seen = sides.into_iter().filter(|(seen, ..)| *seen);
            Ok(seen.map(|(_, front, side)| (front, Surface::Triangles(Arc::clone(&map), side))).collect())
        }
    }
}

impl Image {
    /// Makes the virtual scene of a side of `object` for an eye. Edges of reflected triangles span at most `angle` radians as
    /// seen from its middle.
    #[must_use]
    pub fn of(scene: &Scene, object: usize, front: bool, surface: &Surface, eye: DVec3, angle: f64) -> Self {
        let points = PointCounts::default();
        let mut image =
            Self { object: object as u32, front, geometry: Vec::new(), sources: Vec::new(), points, left_out: 0 };
        let ball = surface.ball();
        let mut found: HashMap<[u64; 3], Moved> = HashMap::new();
        for (other, geometry) in scene.geometry.iter().enumerate().filter(|&(other, _)| other != object) {
            let (mut mesh, mut sources) = (TriMesh::default(), Vec::new());
            found.clear();
            for piece in tessellate(&geometry.shape, ball.centre, ball.radius, angle) {
                let moved = piece.corners.map(|Corner { place, .. }| {
                    *found.entry(place.to_array().map(f64::to_bits)).or_insert_with(|| {
                        let moved = surface.moved(eye, place);
                        image.points.count(moved);
                        moved
                    })
                });
                let [Moved::To(a, a_seen), Moved::To(b, b_seen), Moved::To(c, c_seen)] = moved else {
                    // Nothing is missing where no point of the reflector shows any corner.
                    image.left_out += u64::from(moved.iter().any(|moved| *moved != Moved::Nowhere));
                    continue;
                };
                if !(a_seen || b_seen || c_seen) {
                    continue;
                }
                let first = mesh.positions.len() as u32;
                mesh.positions.extend([a, b, c].map(|place| place.as_vec3()));
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

    /// Returns the place in `scene` that a hit of the virtual scene shows.
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

    /// Returns the number of triangles of the virtual scene.
    #[must_use]
    pub fn triangles(&self) -> usize {
        self.sources.iter().map(|(_, pieces)| pieces.len()).sum()
    }
}
