//! Which objects a ray can meet, and which lights can reach any of them, as far as geometry proves it.
//!
//! Rays start at the eye and on the surfaces they meet. A surface that lets nothing through and is not crossed or
//! touched by anything keeps them on their side: a plane, a sphere, a closed convex mesh seen from outside. (Where
//! surfaces meet in a crease, rounding can put the start of a ray beyond one of them; so a mesh that is seen from inside,
//! or is not convex, or has anything within a margin of it, proves nothing.)
//!
//! What a closed surface hides is hidden in `f32` as well: everything else keeps a margin from it that is a thousand
//! times what rounding moves a point by, in a scene that holds no plane and so ends somewhere. The render leaves that
//! out of its stages.
//!
//! On a plane, rays start as far away as one likes, where rounding outgrows any margin. Yet of what one plane hides, in a
//! scene that holds no other, rays to lights alone can come near, because all else lies within a ball around the origin
//! of √3 times the largest coordinate `s`. A ray that starts on the plane within `10 s` of the origin is as well placed
//! as the others, but for a factor of ten of the thousand. One that starts farther off was reflected there. It came from
//! the ball, or from the plane nearer to the origin, so that it went outwards, and reflection by an angle that is as
//! small as that sends it outwards again (by a cosine of at least 0.5, where it came from the ball): it only gets farther
//! from the ball. A ray to a light may come back from there. So the stages of surfaces and media leave out what a plane
//! hides, and those of shadow rays do not.

use glam::Vec3;

use super::shell::{Shell, Side};
use crate::geometry::{Aabb, Shape};
use crate::scene::{Interface, LightKind, Projection, Scene};

/// Objects of a scene beyond which nothing is looked for: as many shells are tried.
const MOST_OBJECTS: usize = 512;

/// What can be reached.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reach {
    /// By object: the object behind which, or within which, it is hidden; none where a ray may meet it.
    pub hidden: Vec<Option<usize>>,
    /// By object: whether no ray meets it in `f32` either, whatever rounding does.
    pub sealed: Vec<bool>,
    /// By object: whether no ray but those to lights does.
    pub unmet: Vec<bool>,
    /// By light: why it can light nothing that is seen; none where it may.
    pub useless: Vec<Option<String>>,
    /// By light: whether its rays are all stopped in `f32`, too.
    pub dark: Vec<bool>,
}

impl Reach {
    /// Everything may be met.
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

    /// What can be proven of a scene.
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

    /// Whether a ray may meet an object.
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
                // From a closed surface that is seen from outside, a light within it is below the horizon by the margin
                // at least, and from anywhere else the surface is in between.
                *dark |= !shell.is_plane() && seen == Side::Outside;
            }
        }
    }
}

/// A box around a light; none around one that is infinitely far.
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

/// Whether a light from infinitely far in this direction of travel has the shell between it and all that is seen.
fn comes_from_beyond(shell: &Shell, direction: Vec3, seen: Side) -> bool {
    match shell {
        Shell::Plane(plane) => {
            let along = direction.as_dvec3().dot(plane.normal.as_dvec3().normalize());
            // Towards the front it comes from behind.
            if seen == Side::Outside { along > 1e-3 } else { along < -1e-3 }
        }
        // From infinity it meets a closed shell from outside.
        _ => seen == Side::Inside,
    }
}

/// Whether camera rays all start outside a closed shell.
pub(super) fn is_seen_from_outside(scene: &Scene, shell: &Shell) -> bool {
    let Some(scale) = scale(scene, &boxes(scene)) else { return false };
    starts(scene).iter().all(|&p| shell.side_of_point(p, scale) == Side::Outside)
}

/// By object: a box around it.
fn boxes(scene: &Scene) -> Vec<Option<Aabb>> {
    scene.geometry.iter().map(|geometry| bounds_of(&geometry.shape)).collect()
}

/// None for a plane, which is on both sides of everything.
fn bounds_of(shape: &Shape) -> Option<Aabb> {
    match shape {
        Shape::Mesh(mesh) => Some(Aabb::of(&mesh.positions)),
        Shape::Sphere(sphere) => Some(sphere.bounds()),
        Shape::Plane(_) => None,
    }
}

/// Whether a wall is worth looking at: a mesh, which hides only what is within it, where anything is in the box around
/// it. To see whether it is closed and convex takes far longer.
fn may_hold_anything(scene: &Scene, wall: usize, boxes: &[Option<Aabb>]) -> bool {
    let (Shape::Mesh(_), Some(around)) = (&scene.geometry[wall].shape, &boxes[wall]) else { return true };
    let within = |inner: &Aabb| inner.lo.cmpge(around.lo).all() && inner.hi.cmple(around.hi).all();
    let holds_object = boxes.iter().enumerate().any(|(o, b)| o != wall && b.as_ref().is_some_and(within));
    holds_object || scene.lights.iter().filter_map(|light| extent_of(&light.kind)).any(|lamp| within(&lamp))
}

/// The largest coordinate of anything bounded; none where some are not finite.
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

/// Whether nothing gets through an object.
fn is_opaque(scene: &Scene, object: usize) -> bool {
    let interface = &scene.materials[scene.objects[object].material as usize].interface;
    matches!(
        interface,
        Interface::Opaque | Interface::Mirror { .. } | Interface::Conductor { .. } | Interface::Coated { .. }
    )
}

/// Places such that camera rays start within their convex hull.
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
