//! Which objects a ray can meet, and which lights can reach any of them, as far as geometry proves it.
//!
//! Rays start at the eye and on the surfaces they meet. A surface that lets nothing through and is not crossed or
//! touched by anything keeps them on their side: a plane, a sphere, a closed convex mesh seen from outside. (Where
//! surfaces meet in a crease, rounding can put the start of a ray beyond one of them; so a mesh that is seen from inside,
//! or is not convex, or has anything within a margin of it, proves nothing.)
//!
//! What a closed surface hides is hidden in `f32` as well: everything else keeps a margin from it that is a thousand
//! times what rounding moves a point by, in a scene that holds no plane and so ends somewhere. The render leaves that
//! out of its stages. On a plane, rays start as far away as one likes, where rounding outgrows any margin; what it hides
//! is told and no more.

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
    /// By light: why it can light nothing that is seen; none where it may.
    pub useless: Vec<Option<String>>,
}

impl Reach {
    /// Everything may be met.
    #[must_use]
    pub fn everything(scene: &Scene) -> Self {
        let (objects, lights) = (scene.objects.len(), scene.lights.len());
        Self { hidden: vec![None; objects], sealed: vec![false; objects], useless: vec![None; lights] }
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
        let Some(scale) = scale(scene) else { return reach };
        let views = starts(scene);
        let planes: Vec<usize> =
            (0..scene.objects.len()).filter(|&o| matches!(scene.geometry[o].shape, Shape::Plane(_))).collect();
        for wall in 0..scene.objects.len() {
            // Rays that start on another plane come from anywhere.
            let alone = planes.iter().all(|&p| p == wall);
            let walls_off = alone && reach.hidden[wall].is_none() && is_opaque(scene, wall);
            let shell = walls_off.then(|| Shell::of(&scene.geometry[wall].shape)).flatten();
            if let Some(shell) = shell {
                reach.look_behind(scene, wall, &shell, &views, scale);
            }
        }
        reach
    }

    /// Whether a ray may meet an object.
    #[must_use]
    pub fn meets(&self, object: usize) -> bool {
        self.hidden[object].is_none()
    }

    fn look_behind(&mut self, scene: &Scene, wall: usize, shell: &Shell, views: &[Vec3], scale: f64) {
        let mut sides = views.iter().map(|&p| shell.side_of_point(p, scale));
        let Some(seen) = sides.next().filter(|&s| s != Side::Across) else { return };
        if seen == Side::Inside && matches!(shell, Shell::Mesh(_)) {
            return;
        }
        if sides.any(|s| s != seen) {
            return;
        }
        let mut behind = Vec::new();
        for (object, geometry) in scene.geometry.iter().enumerate() {
            if object == wall {
                continue;
            }
            match side_of_shape(shell, &geometry.shape, scale) {
                Side::Across => return,
                side if side != seen => behind.push(object),
                _ => {}
            }
        }
        for object in behind {
            self.hidden[object].get_or_insert(wall);
            self.sealed[object] |= !shell.is_plane();
        }
        for (light, useless) in scene.lights.iter().zip(&mut self.useless) {
            let beyond = match light.kind {
                LightKind::Point { position } | LightKind::Spot { position, .. } => {
                    let side = shell.side_of_point(position, scale);
                    side != Side::Across && side != seen
                }
                LightKind::Directional { direction } => comes_from_beyond(shell, direction, seen),
                // Part of it may reach past the shell.
                LightKind::Sphere { .. } | LightKind::Rectangle { .. } => false,
            };
            if beyond && light.shadows && useless.is_none() {
                let what = if shell.is_plane() { "is behind" } else { "is parted from the view by" };
                *useless = Some(format!("`{}` {what} `{}`", light.name, scene.objects[wall].name));
            }
        }
    }
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

fn side_of_shape(shell: &Shell, shape: &Shape, scale: f64) -> Side {
    match shape {
        Shape::Mesh(mesh) => shell.side_of_box(&Aabb::of(&mesh.positions), scale),
        Shape::Sphere(sphere) => shell.side_of_box(&sphere.bounds(), scale),
        Shape::Plane(_) => Side::Across,
    }
}

/// The largest coordinate of anything bounded; none where some are not finite.
fn scale(scene: &Scene) -> Option<f64> {
    let mut most = starts(scene).iter().fold(Vec3::ZERO, |most, p| most.max(p.abs()));
    for geometry in &scene.geometry {
        let bounds = match &geometry.shape {
            Shape::Mesh(mesh) => Aabb::of(&mesh.positions),
            Shape::Sphere(sphere) => sphere.bounds(),
            Shape::Plane(plane) => Aabb { lo: plane.point, hi: plane.point },
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
        Projection::Pinhole { .. } => vec![camera.eye],
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
