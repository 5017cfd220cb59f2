//! Objects that rays can hit, and lights that can reach any of them, as far as geometry proves it.
//!
//! Rays start at the eye and on the surfaces they hit. An opaque surface that nothing crosses or touches keeps them on
//! one side. This holds for a plane, a sphere, and a closed convex mesh seen from outside. Where surfaces meet in a
//! crease, rounding can put a ray origin beyond one of them. So a mesh proves nothing if it is seen from inside, is not
//! convex, or has anything within a margin.
//!
//! The proof for a closed surface also holds in `f32`. All other geometry keeps a margin from the surface, a thousand
//! times the rounding error of a point, in a scene without planes, which is bounded. The render leaves objects that
//! such a surface hides out of its stages.
//!
//! On a plane, rays can start arbitrarily far away, where rounding exceeds any margin. Consider the objects that one
//! plane hides, in a scene with no other plane. Only shadow rays can come near them, for the following reason. All
//! other geometry lies within a ball around the origin of radius √3 times the largest coordinate `s`.
//! - A ray that starts on the plane within `10 s` of the origin has the margin of other rays, except for a factor of
//!   ten of the thousand.
//! - A ray that starts farther away was reflected there. It came from the ball, or from a point of the plane nearer to
//!   the origin, so it went outwards. Reflection at so small an angle sends it outwards again (with a cosine of at
//!   least 0.5 if it came from the ball). So it only gets farther from the ball.
//! - A shadow ray may come back from there.
//!
//! So the stages for surfaces and media leave out the objects that a plane hides, and the stages for shadow rays do
//! not.

use glam::Vec3;

use super::shell::{Shell, Side};
use crate::geometry::{Aabb, Shape};
use crate::scene::{Interface, LightKind, Projection, Scene};

/// Number of objects above which nothing is proven; each object is tried as a shell.
const MOST_OBJECTS: usize = 512;

/// Objects and lights that rays can reach.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reach {
    /// By object: the object that hides it; `None` if a ray may hit it.
    pub hidden: Vec<Option<usize>>,
    /// By object: true if no ray hits it in `f32` either, for any rounding.
    pub sealed: Vec<bool>,
    /// By object: true if no ray other than shadow rays hits it.
    pub unmet: Vec<bool>,
    /// By light: the reason why it lights nothing that is seen; `None` if it may.
    pub useless: Vec<Option<String>>,
    /// By light: true if all of its rays are blocked in `f32`, too.
    pub dark: Vec<bool>,
}

impl Reach {
    /// Returns the result that proves nothing: every object may be hit.
    #[must_use]
    pub fn everything(scene: &Scene) -> Self {
        let (objects, lights) = (scene.objects.len(), scene.lights.len());
        Self {
            hidden: vec![None; objects],
            sealed: vec![false; objects],
            unmet: vec![false; objects],
            useless: vec![None; lights],
            dark: vec![false; lights],
        }
    }

    /// Computes what can be proven of a scene.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let mut reach = Self::everything(scene);
        for (light, useless) in scene.lights.iter().zip(&mut reach.useless) {
            if light.intensity == Vec3::ZERO {
                *useless = Some(format!("`{}` has no intensity", light.name));
            }
        }
        if scene.objects.len() > MOST_OBJECTS {
            return reach;
        }
        let boxes = boxes(scene);
        let Some(scale) = scale(scene, &boxes) else { return reach };
        let views = starts(scene);
        let planes: Vec<usize> =
            (0..scene.objects.len()).filter(|&o| matches!(scene.geometry[o].shape, Shape::Plane(_))).collect();
        for wall in 0..scene.objects.len() {
            // Rays that start on another plane come from anywhere.
            let alone = planes.iter().all(|&p| p == wall);
            let walls_off = alone
                && reach.hidden[wall].is_none()
                && is_opaque(scene, wall)
                && may_hold_anything(scene, wall, &boxes);
            let shell = walls_off.then(|| Shell::of(&scene.geometry[wall].shape)).flatten();
            if let Some(shell) = shell {
                reach.look_behind(scene, wall, &shell, &views, &boxes, scale);
            }
        }
        reach
    }

    /// Returns true if a ray may hit an object.
    #[must_use]
    pub fn meets(&self, object: usize) -> bool {
        self.hidden[object].is_none()
    }

    fn look_behind(
        &mut self,
        scene: &Scene,
        wall: usize,
        shell: &Shell,
        views: &[Vec3],
        boxes: &[Option<Aabb>],
        scale: f64,
    ) {
        let mut sides = views.iter().map(|&p| shell.side_of_point(p, scale));
        let Some(seen) = sides.next().filter(|&s| s != Side::Across) else { return };
        if seen == Side::Inside && matches!(shell, Shell::Mesh(_)) {
            return;
        }
        if sides.any(|s| s != seen) {
            return;
        }
        let mut behind = Vec::new();
        for (object, bounds) in boxes.iter().enumerate() {
            if object == wall {
                continue;
            }
            match bounds.as_ref().map_or(Side::Across, |bounds| shell.side_of_box(bounds, scale)) {
                Side::Across => return,
                side if side != seen => behind.push(object),
                _ => {}
            }
        }
        for object in behind {
            self.hidden[object].get_or_insert(wall);
            self.sealed[object] |= !shell.is_plane();
            self.unmet[object] = true;
        }
        for (light, (useless, dark)) in scene.lights.iter().zip(self.useless.iter_mut().zip(&mut self.dark)) {
            let place = extent_of(&light.kind);
            let beyond = match light.kind {
                LightKind::Directional { direction } => comes_from_beyond(shell, direction, seen),
                _ => place.is_some_and(|place| {
                    let side = shell.side_of_box(&place, scale);
                    side != Side::Across && side != seen
                }),
            };
            if beyond && light.shadows {
                let what = if shell.is_plane() { "is behind" } else { "is parted from the view by" };
                useless.get_or_insert_with(|| format!("`{}` {what} `{}`", light.name, scene.objects[wall].name));
                // A light inside a closed surface that is seen from outside is below the surface's horizon by at least
                // the margin. From all other points the surface blocks it.
                *dark |= !shell.is_plane() && seen == Side::Outside;
            }
        }
    }
}

/// Returns a box around a light, or `None` for a directional one.
fn extent_of(kind: &LightKind) -> Option<Aabb> {
    let (lo, hi) = match *kind {
        LightKind::Point { position } | LightKind::Spot { position, .. } => (position, position),
        LightKind::Sphere { position, radius } => (position - radius, position + radius),
        LightKind::Rectangle { corner, edges: [u, v], .. } => {
            let corners = [corner + u, corner + v, corner + u + v];
            corners.into_iter().fold((corner, corner), |(lo, hi), p| (lo.min(p), hi.max(p)))
        }
        LightKind::Directional { .. } => return None,
    };
    Some(Aabb { lo, hi })
}

/// Returns true if the shell blocks all light in this direction of travel from everything that is seen.
fn comes_from_beyond(shell: &Shell, direction: Vec3, seen: Side) -> bool {
    match shell {
        Shell::Plane(plane) => {
            let along = direction.as_dvec3().dot(plane.normal.as_dvec3().normalize());
            // Light that travels towards the front comes from behind.
            if seen == Side::Outside { along > 1e-3 } else { along < -1e-3 }
        }
        // Light from infinity hits a closed shell from outside.
        _ => seen == Side::Inside,
    }
}

/// Returns true if all camera rays start outside a closed shell.
pub(super) fn is_seen_from_outside(scene: &Scene, shell: &Shell) -> bool {
    let Some(scale) = scale(scene, &boxes(scene)) else { return false };
    starts(scene).iter().all(|&p| shell.side_of_point(p, scale) == Side::Outside)
}

/// Returns a box around each object.
fn boxes(scene: &Scene) -> Vec<Option<Aabb>> {
    scene.geometry.iter().map(|geometry| bounds_of(&geometry.shape)).collect()
}

/// Returns a box around a shape, or `None` for a plane, which is on both sides of everything.
pub(super) fn bounds_of(shape: &Shape) -> Option<Aabb> {
    match shape {
        Shape::Mesh(mesh) => Some(Aabb::of(&mesh.positions)),
        Shape::Sphere(sphere) => Some(sphere.bounds()),
        Shape::Plane(_) => None,
    }
}

/// Returns true if a wall may hide anything. A mesh hides only what is inside it, so its bounding box must contain
/// something. This avoids the slower test for a closed and convex mesh.
fn may_hold_anything(scene: &Scene, wall: usize, boxes: &[Option<Aabb>]) -> bool {
    let (Shape::Mesh(_), Some(around)) = (&scene.geometry[wall].shape, &boxes[wall]) else { return true };
    let within = |inner: &Aabb| inner.lo.cmpge(around.lo).all() && inner.hi.cmple(around.hi).all();
    let holds_object = boxes.iter().enumerate().any(|(o, b)| o != wall && b.as_ref().is_some_and(within));
    holds_object || scene.lights.iter().filter_map(|light| extent_of(&light.kind)).any(|lamp| within(&lamp))
}

/// Returns the largest coordinate of any bounded shape, or `None` if some are not finite.
fn scale(scene: &Scene, boxes: &[Option<Aabb>]) -> Option<f64> {
    let mut most = starts(scene).iter().fold(Vec3::ZERO, |most, p| most.max(p.abs()));
    for (geometry, bounds) in scene.geometry.iter().zip(boxes) {
        let bounds = match &geometry.shape {
            Shape::Plane(plane) => Aabb { lo: plane.point, hi: plane.point },
            Shape::Mesh(_) | Shape::Sphere(_) => (*bounds)?,
        };
        if !bounds.is_empty() {
            most = most.max(bounds.lo.abs()).max(bounds.hi.abs());
        } else if !matches!(&geometry.shape, Shape::Mesh(mesh) if mesh.positions.is_empty()) {
            return None;
        }
    }
    most.is_finite().then(|| f64::from(most.max_element()))
}

/// Returns true if an object transmits no light.
fn is_opaque(scene: &Scene, object: usize) -> bool {
    let interface = &scene.materials[scene.objects[object].material as usize].interface;
    matches!(
        interface,
        Interface::Opaque | Interface::Mirror { .. } | Interface::Conductor { .. } | Interface::Coated { .. }
    )
}

/// Returns points whose convex hull contains all origins of camera rays.
fn starts(scene: &Scene) -> Vec<Vec3> {
    let camera = &scene.camera;
    match camera.projection {
        Projection::Pinhole { .. } | Projection::Map(_) => vec![camera.eye],
        Projection::Orthographic { height } => {
            let forward = (camera.target - camera.eye).normalize();
            let right = forward.cross(camera.up).normalize();
            let up = right.cross(forward);
            let aspect = scene.settings.width as f32 / scene.settings.height as f32;
            let (x, y) = (right * (0.5 * height * aspect), up * (0.5 * height));
            vec![camera.eye, camera.eye + x + y, camera.eye + x - y, camera.eye - x + y, camera.eye - x - y]
        }
    }
}
