//! Which medium a ray is in, and what a dielectric surface means to it.

use glam::DVec3;

use super::surface;
use crate::accel::reference::{Ray64, Reference};
use crate::geometry::{GeometryMask, Shape};
use crate::scene::{Bodies, Medium, Scene};

/// The bodies a ray has entered and not left, by rising rank, among equals in the order of entry. Body 0, which surrounds
/// everything, is not on it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MediumStack(Vec<u32>);

/// A dielectric surface as a ray meets it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Meeting {
    /// It lies inside a medium of higher rank, or parts equal media: the ray goes on with this stack.
    NotThere(MediumStack),
    /// It parts medium `from` and medium `to`; what is refracted has the stack `beyond`.
    Boundary { from: u32, to: u32, beyond: MediumStack, unmatched: bool },
}

/// The media of a scene and the bodies they fill.
#[derive(Clone, Copy, Debug)]
pub(super) struct Filled<'a> {
    pub media: &'a [Medium],
    pub bodies: &'a Bodies,
}

impl Filled<'_> {
    fn priority(&self, medium: u32) -> i32 {
        self.media[medium as usize].priority
    }
}

impl MediumStack {
    /// The media, the one that fills the space last.
    pub fn media(&self, filled: Filled) -> Vec<u32> {
        self.0.iter().map(|&body| filled.bodies.medium(body)).collect()
    }

    /// The medium that fills the space around the ray.
    pub fn top(&self, filled: Filled) -> u32 {
        let top = self.0.last().map(|&body| filled.bodies.medium(body));
        top.filter(|&m| filled.priority(m) >= filled.priority(0)).unwrap_or(0)
    }

    /// With one more body.
    pub fn with(&self, filled: Filled, body: u32) -> Self {
        let rank = filled.bodies.rank(body);
        let place = self.0.partition_point(|&b| filled.bodies.rank(b) <= rank);
        let mut entered = self.clone();
        entered.0.insert(place, body);
        entered
    }

    /// Without the latest entry of a body, or else of another body of its medium; none where there is none.
    fn without(&self, filled: Filled, body: u32) -> Option<(Self, usize)> {
        let medium = filled.bodies.medium(body);
        let own = self.0.iter().rposition(|&b| b == body);
        let place = own.or_else(|| self.0.iter().rposition(|&b| filled.bodies.medium(b) == medium))?;
        let mut left = self.clone();
        left.0.remove(place);
        Some((left, place))
    }

    /// The meeting of a ray with this stack and the boundary of `body`, whose front or back it arrives at.
    pub fn meet(&self, filled: Filled, body: u32, front: bool) -> Meeting {
        let (current, medium) = (self.top(filled), filled.bodies.medium(body));
        if front {
            let beyond = self.with(filled, body);
            let inside = self.0.last().is_some_and(|&top| filled.bodies.rank(body) < filled.bodies.rank(top));
            return if inside || filled.priority(medium) < filled.priority(0) {
                Meeting::NotThere(beyond)
            } else {
                Meeting::Boundary { from: current, to: medium, beyond, unmatched: false }
            };
        }
        match self.without(filled, body) {
            None => Meeting::Boundary { from: medium, to: current, beyond: self.clone(), unmatched: true },
            Some((beyond, place)) if medium != current || place + 1 != self.0.len() => Meeting::NotThere(beyond),
            Some((beyond, _)) => Meeting::Boundary { from: medium, to: beyond.top(filled), beyond, unmatched: false },
        }
    }

    /// The meeting of a ray with this stack and surfaces that coincide: bodies, each with true if it arrives at the front.
    pub fn meet_all(&self, filled: Filled, surfaces: &[(u32, bool)]) -> Meeting {
        if let &[(body, front)] = surfaces {
            return self.meet(filled, body, front);
        }
        let mut beyond = self.clone();
        let mut never_entered = None;
        for &(body, _) in surfaces.iter().filter(|(_, front)| !front) {
            match beyond.without(filled, body) {
                Some((left, _)) => beyond = left,
                None => never_entered = Some(body),
            }
        }
        for &(body, _) in surfaces.iter().filter(|(_, front)| *front) {
            beyond = beyond.with(filled, body);
        }
        let leaves_only = surfaces.iter().all(|(_, front)| !front);
        let from = never_entered.filter(|_| leaves_only).map_or(self.top(filled), |body| filled.bodies.medium(body));
        let to = beyond.top(filled);
        if filled.media[from as usize].is_like(&filled.media[to as usize]) {
            return Meeting::NotThere(beyond);
        }
        Meeting::Boundary { from, to, beyond, unmatched: never_entered.is_some() }
    }
}

/// The stack of a ray that starts at the camera's eye: what the camera says, or else the bodies whose boundaries a ray
/// from there to infinity leaves without having entered them, and the half spaces of planes that hold the eye.
pub(super) fn around_the_eye(scene: &Scene, accel: &Reference, filled: Filled) -> MediumStack {
    match scene.camera.medium {
        Some(0) => return MediumStack::default(),
        Some(medium) => return MediumStack(vec![filled.bodies.of_medium(medium)]),
        None => {}
    }
    let eye = scene.camera.eye.as_dvec3();
    // Upwards, but askew: straight up would follow the walls of upright boxes, and meet their diagonals.
    let mut ray = Ray64::new(eye, DVec3::new(0.137, 1.0, 0.259).normalize());
    ray.admits = GeometryMask::TRANSMISSIVE;
    let mut around = Vec::new();
    let mut entered: Vec<u32> = Vec::new();
    for crossing in surface::crossings(scene, accel, &ray).into_iter().take(256) {
        let Some(body) = filled.bodies.of_object(crossing.geometry) else { continue };
        if matches!(scene.geometry[crossing.geometry as usize].shape, Shape::Plane(_)) {
            continue;
        }
        if crossing.front {
            entered.push(body);
        } else if let Some(i) = entered.iter().rposition(|&b| b == body) {
            entered.remove(i);
        } else {
            around.push(body);
        }
    }
    for (geometry, shape) in scene.geometry.iter().enumerate() {
        if let (Shape::Plane(plane), Some(body)) = (&shape.shape, filled.bodies.of_object(geometry as u32)) {
            let height = plane.normal.as_dvec3().dot(eye - plane.point.as_dvec3());
            if shape.mask.meets(GeometryMask::TRANSMISSIVE) && height < 0.0 {
                around.push(body);
            }
        }
    }
    // What is left last was entered first.
    around.iter().rev().fold(MediumStack::default(), |stack, &body| stack.with(filled, body))
}
