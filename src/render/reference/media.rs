//! Which medium a ray is in, and what a dielectric surface means to it.

use glam::DVec3;

use super::surface;
use crate::accel::reference::{Ray64, Reference};
use crate::geometry::{GeometryMask, Shape};
use crate::scene::{Interface, Scene};

/// The media a ray has entered and not left, by rising priority, among equals in the order of entry. Medium 0, which
/// surrounds everything, is not on it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MediumStack(Vec<u32>);

/// A dielectric surface as a ray meets it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Meeting {
    /// It lies inside a medium of higher priority: the ray goes on with this stack.
    NotThere(MediumStack),
    /// It parts medium `from` and medium `to`; what is refracted has the stack `beyond`.
    Boundary { from: u32, to: u32, beyond: MediumStack, unmatched: bool },
}

impl MediumStack {
    /// The stack of a ray that starts in `medium`.
    pub fn inside(medium: u32) -> Self {
        if medium == 0 { Self::default() } else { Self(vec![medium]) }
    }

    /// The media, highest priority last.
    pub fn media(&self) -> &[u32] {
        &self.0
    }

    /// The medium that fills the space around the ray.
    pub fn top(&self, scene: &Scene) -> u32 {
        self.0.last().copied().filter(|&m| priority(scene, m) >= priority(scene, 0)).unwrap_or(0)
    }

    fn with(&self, scene: &Scene, medium: u32) -> Self {
        let place = self.0.partition_point(|&m| priority(scene, m) <= priority(scene, medium));
        let mut entered = self.clone();
        entered.0.insert(place, medium);
        entered
    }

    /// Without the latest entry of `medium`, where there is one.
    fn without(&self, medium: u32) -> Option<Self> {
        let place = self.0.iter().rposition(|&m| m == medium)?;
        let mut left = self.clone();
        left.0.remove(place);
        Some(left)
    }

    /// What the boundary of `medium` is to a ray with this stack that arrives at its front or back.
    pub fn meet(&self, scene: &Scene, medium: u32, front: bool) -> Meeting {
        let current = self.top(scene);
        if front {
            let beyond = self.with(scene, medium);
            return if priority(scene, medium) < priority(scene, current) {
                Meeting::NotThere(beyond)
            } else {
                Meeting::Boundary { from: current, to: medium, beyond, unmatched: false }
            };
        }
        match self.without(medium) {
            None => Meeting::Boundary { from: medium, to: current, beyond: self.clone(), unmatched: true },
            Some(beyond) if medium != current => Meeting::NotThere(beyond),
            Some(beyond) => Meeting::Boundary { from: medium, to: beyond.top(scene), beyond, unmatched: false },
        }
    }
}

fn priority(scene: &Scene, medium: u32) -> i32 {
    scene.media[medium as usize].priority
}

/// The stack of a ray that starts at the camera's eye: what the camera says, or else the media whose boundaries a ray
/// from there to infinity leaves without having entered them, and the half spaces of planes that hold the eye.
pub(super) fn around_the_eye(scene: &Scene, accel: &Reference) -> MediumStack {
    if let Some(medium) = scene.camera.medium {
        return MediumStack::inside(medium);
    }
    let eye = scene.camera.eye.as_dvec3();
    let medium_of = |geometry: usize| match scene.materials[scene.objects[geometry].material as usize].interface {
        Interface::Dielectric { medium, .. } => Some(medium),
        _ => None,
    };
    // Upwards, but askew: straight up would follow the walls of upright boxes, and meet their diagonals.
    let mut ray = Ray64::new(eye, DVec3::new(0.137, 1.0, 0.259).normalize());
    ray.admits = GeometryMask::TRANSMISSIVE;
    let mut around = Vec::new();
    let mut entered: Vec<u32> = Vec::new();
    for crossing in surface::crossings(scene, accel, &ray).into_iter().take(256) {
        let geometry = crossing.geometry as usize;
        let Some(medium) = medium_of(geometry) else { continue };
        if matches!(scene.geometry[geometry].shape, Shape::Plane(_)) {
            continue;
        }
        if crossing.front {
            entered.push(medium);
        } else if let Some(i) = entered.iter().rposition(|&m| m == medium) {
            entered.remove(i);
        } else {
            around.push(medium);
        }
    }
    for (geometry, shape) in scene.geometry.iter().enumerate() {
        if let (Shape::Plane(plane), Some(medium)) = (&shape.shape, medium_of(geometry)) {
            let height = plane.normal.as_dvec3().dot(eye - plane.point.as_dvec3());
            if shape.mask.meets(GeometryMask::TRANSMISSIVE) && height < 0.0 {
                around.push(medium);
            }
        }
    }
    // What is left last was entered first.
    around.iter().rev().fold(MediumStack::default(), |stack, &medium| stack.with(scene, medium))
}
