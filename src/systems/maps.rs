//! Environment maps as reflections: what a reflector shows, looked up in a map of what surrounds its centre.
//!
//! A map knows directions and no places: it is right for what is infinitely far, and the nearer the surroundings are the
//! more it is off. A [`Proxy`] stands for them, so that a ray from the surface, and not one from the centre, tells the
//! direction that is looked up.

use glam::{DVec3, Mat3, Vec3};

use super::reflector::reflectors;
use crate::geometry::Aabb;
use crate::scene::{MapKind, Projection, Rgb, Scene, Texture};

/// Reflectors that get a map of their own at most.
const MOST_MAPS: usize = 256;

/// Widths of the faces of a cube map, in texels, at least and at most.
const FACES: [f64; 2] = [16.0, 2048.0];

crate::choice! {
    /// Stand-in for the surroundings of reflectors that show maps.
    pub enum Proxy("proxy", derive(Eq, Hash), default(None)) {
        /// None: surroundings are taken for infinitely far.
        "none" => None,
        /// Box with the axes of the scene, whose sides are as far as what the map's rays met there.
        "box" => Box,
        /// Sphere around the reflector's centre, as far as what they met.
        "sphere" => Sphere,
    }
}

/// Distances of the surroundings of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surroundings {
    /// Distances of the sides of a box, along -x, -y, -z, in scene units; infinite where nothing is.
    pub below: Vec3,
    /// Those along +x, +y, +z.
    pub above: Vec3,
    /// Radius of a sphere.
    pub radius: f32,
}

impl Surroundings {
    /// Fits the surroundings to unit directions and the distances of their hits. A shift of the origin turns the direction to
    /// a hit by an angle proportional to 1 / distance, so the harmonic mean is taken.
    #[must_use]
    pub fn of(rays: impl Iterator<Item = (Vec3, f32)>) -> Self {
        let mut sides = [(0.0, 0_u32); 6];
        let mut ball = (0.0, 0_u32);
        for (dir, distance) in rays {
            let along = dir.abs().max_element();
            let axis = (0..3).find(|&k| dir[k].abs() == along).unwrap_or(0);
            let side = &mut sides[2 * axis + usize::from(dir[axis] > 0.0)];
            *side = (side.0 + 1.0 / f64::from(distance * along), side.1 + 1);
            ball = (ball.0 + 1.0 / f64::from(distance), ball.1 + 1);
        }
        let mean = |(sum, count): (f64, u32)| if sum > 0.0 { (f64::from(count) / sum) as f32 } else { f32::INFINITY };
        let side = |k: usize| Vec3::new(mean(sides[k]), mean(sides[k + 2]), mean(sides[k + 4]));
        Self { below: side(0), above: side(1), radius: mean(ball) }
    }

    /// Returns the point, relative to the centre, at which a ray from `start` leaves the box. Returns none if the box is
    /// infinite in its direction.
    fn leaves_box(&self, start: Vec3, dir: Vec3) -> Option<Vec3> {
        let start = start.clamp(-self.below, self.above);
        let t = (0..3).fold(f32::INFINITY, |t, k| {
            let side = if dir[k] > 0.0 { self.above[k] } else { -self.below[k] };
            if dir[k] == 0.0 { t } else { t.min((side - start[k]) / dir[k]) }
        });
        t.is_finite().then(|| start + dir * t)
    }

    /// Returns the point at which a ray from `start` leaves the sphere. Returns none if it starts outside or the sphere is
    /// infinite.
    fn leaves_sphere(&self, start: Vec3, dir: Vec3) -> Option<Vec3> {
        let along = start.dot(dir);
        let inside = self.radius * self.radius - start.length_squared();
        if !(inside > 0.0 && inside.is_finite()) {
            return None;
        }
        Some(start + dir * ((along * along + inside).sqrt() - along))
    }
}

/// The map of one reflector.
#[derive(Clone, Debug)]
pub struct ReflectorMap {
    /// The object.
    pub object: u32,
    /// Point from which it was captured, in scene units.
    pub centre: Vec3,
    /// From the scene's frame to the map's.
    pub frame: Mat3,
    /// Its texels.
    pub picture: Texture,
    /// Distances of its surroundings.
    pub surroundings: Surroundings,
}

/// The maps of a scene's reflectors.
#[derive(Clone, Debug)]
pub struct Maps {
    /// Their shape.
    pub kind: MapKind,
    /// One a reflector.
    pub list: Vec<ReflectorMap>,
    /// Reflectors without one, with the reasons; what they reflect is traced.
    pub without: Vec<(u32, &'static str)>,
    of_object: Vec<Option<u32>>,
}

/// A map to capture.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// The reflector.
    pub object: u32,
    /// Point from which it is captured.
    pub centre: Vec3,
    /// Rows of the map.
    pub size: u32,
}

impl Maps {
    /// Returns the maps to capture for a scene, and the reflectors without a map, with the reasons.
    #[must_use]
    pub fn wanted(scene: &Scene, kind: MapKind) -> (Vec<Wanted>, Vec<(u32, &'static str)>) {
        Self::wanted_for(scene, kind, reflectors(scene))
    }

    /// Returns the cube maps to capture for bodies that bend light, and the bodies without a map, with the reasons.
    #[must_use]
    pub fn wanted_by_bodies(scene: &Scene) -> (Vec<Wanted>, Vec<(u32, &'static str)>) {
        let disperses = |medium: u32| scene.media[medium as usize].disperses();
        let (bodies, dispersive): (Vec<usize>, Vec<usize>) = (0..scene.objects.len())
            .filter(|&o| scene.medium_of(o).is_some())
            .partition(|&o| !scene.medium_of(o).is_some_and(disperses));
        let (wanted, mut without) = Self::wanted_for(scene, MapKind::Cube, bodies.into_iter());
        without.extend(dispersive.into_iter().map(|object| (object as u32, "disperses light")));
        (wanted, without)
    }

    fn wanted_for(
        scene: &Scene,
        kind: MapKind,
        objects: impl Iterator<Item = usize>,
    ) -> (Vec<Wanted>, Vec<(u32, &'static str)>) {
        let (mut wanted, mut without) = (Vec::new(), Vec::new());
        for object in objects {
            let bounds = scene.geometry[object].shape.bounds();
            let number = object as u32;
            if bounds.is_empty() {
                without.push((number, "has no centre"));
            } else if wanted.len() == MOST_MAPS {
                without.push((number, "is one of too many objects"));
            } else {
                let size = size(scene, kind, &bounds);
                wanted.push(Wanted { object: number, centre: bounds.centre(), size });
            }
        }
        (wanted, without)
    }

    /// Collects captured maps.
    #[must_use]
    pub fn new(scene: &Scene, kind: MapKind, list: Vec<ReflectorMap>, without: Vec<(u32, &'static str)>) -> Self {
        let mut of_object = vec![None; scene.objects.len()];
        for (i, map) in list.iter().enumerate() {
            of_object[map.object as usize] = Some(i as u32);
        }
        Self { kind, list, without, of_object }
    }

    /// Returns the map of an object.
    #[inline]
    #[must_use]
    pub fn of(&self, object: u32) -> Option<&ReflectorMap> {
        self.of_object.get(object as usize).copied().flatten().map(|i| &self.list[i as usize])
    }

    /// Returns the radiance along a unit direction from a point of a reflector.
    #[must_use]
    pub fn look_up(&self, map: &ReflectorMap, proxy: Proxy, point: Vec3, dir: Vec3) -> Rgb {
        let start = point - map.centre;
        let met = match proxy {
            Proxy::None => None,
            Proxy::Box => map.surroundings.leaves_box(start, dir),
            Proxy::Sphere => map.surroundings.leaves_sphere(start, dir),
        };
        let dir = met.and_then(Vec3::try_normalize).unwrap_or(dir);
        self.kind.look_up(&map.picture, map.frame * dir)
    }
}

/// Returns the rows of a map whose texels are as wide as the angle that a pixel shows of them. Neighbouring pixels on a ball
/// of radius `r` at distance `d` differ in direction by the angle `a` of a pixel plus twice the turn of the normal, `a d / r`.
fn size(scene: &Scene, kind: MapKind, bounds: &Aabb) -> u32 {
    let camera = &scene.camera;
    let radius = f64::from(bounds.diagonal()) * 0.5;
    let distance = f64::from(camera.eye.distance(bounds.centre()));
    let rows = f64::from(scene.settings.height);
    let (angle, turn) = match camera.projection {
        Projection::Pinhole { vfov } => {
            let angle = 2.0 * (f64::from(vfov).to_radians() * 0.5).tan() / rows;
            (angle, angle * distance / radius)
        }
        Projection::Orthographic { height } => (0.0, f64::from(height) / rows / radius),
        Projection::Map(_) => (std::f64::consts::PI / rows, std::f64::consts::PI / rows * distance / radius),
    };
    // The middle of a face has its widest texels, of 2 / size.
    let face = (2.0 / (angle + 2.0 * turn)).clamp(FACES[0], FACES[1]);
    let face = (face / 8.0).ceil() * 8.0;
    match kind {
        MapKind::Cube => face as u32,
        // A disc of as many texels as the six faces together.
        MapKind::Sphere => (face * (24.0 / std::f64::consts::PI).sqrt()).ceil() as u32,
        MapKind::LatLong => (2.0 * face) as u32,
    }
}

/// Returns unit directions spread evenly over the faces of a cube, `n` by `n` per face.
#[must_use]
pub fn directions(n: u32) -> Vec<Vec3> {
    let at = |p: u32| MapKind::Cube.direction(f64::from(p % (6 * n)) + 0.5, f64::from(p / (6 * n)) + 0.5, n);
    (0..6 * n * n).map(at).map(|d: DVec3| d.as_vec3()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_proxy_with_the_shape_of_the_room_finds_the_place_that_is_seen() {
        // A room of 4 by 6 by 10 around its middle, seen from a point beside it.
        let (half, start) = (Vec3::new(2.0, 3.0, 5.0), Vec3::new(0.5, -1.0, 0.25));
        let room = |dir: &Vec3| (0..3).map(|k| half[k] / dir[k].abs()).fold(f32::INFINITY, f32::min);
        let fitted = Surroundings::of(directions(16).into_iter().map(|dir| (dir, room(&dir))));
        // Faces of the cube of directions are no walls of the room: distances near edges are shorter.
        let boxed = Surroundings { below: half, above: half, radius: 4.0 };
        for k in 0..3 {
            assert!((fitted.above[k] - fitted.below[k]).abs() < 1e-4 && fitted.above[k] <= half[k] * 1.01);
        }
        for dir in directions(5) {
            let met = boxed.leaves_box(start, dir).unwrap();
            let on_wall = (met.abs() / half).max_element();
            assert!((on_wall - 1.0).abs() < 1e-5, "{met}");
            assert!((met - start).normalize().dot(dir) > 1.0 - 1e-5);
            let met = boxed.leaves_sphere(start, dir).unwrap();
            assert!((met.length() - 4.0).abs() < 1e-5 && (met - start).normalize().dot(dir) > 1.0 - 1e-5);
        }
    }

    #[test]
    fn a_floor_alone_is_met_below_and_nowhere_else() {
        let floor = |dir: Vec3| (dir, if dir.y < 0.0 { 1.5 / -dir.y } else { f32::INFINITY });
        let fitted = Surroundings::of(directions(16).into_iter().map(floor));
        assert!((fitted.below.y - 1.5).abs() < 1e-5 && fitted.above.y == f32::INFINITY);
        assert!(fitted.leaves_box(Vec3::ZERO, Vec3::Y).is_none());
        let met = fitted.leaves_box(Vec3::new(0.3, 0.0, 0.0), Vec3::NEG_Y).unwrap();
        assert!((met - Vec3::new(0.3, -1.5, 0.0)).length() < 1e-4, "{met}");
        assert!(Surroundings { radius: 1.0, ..fitted }.leaves_sphere(Vec3::X * 2.0, Vec3::X).is_none());
    }
}
