//! Medium stacks of the `f64` renderer, and the effect of dielectric surfaces on them.

use glam::DVec3;

use super::surface;
use crate::accel::reference::{Ray64, Reference};
use crate::geometry::{GeometryMask, Shape};
use crate::scene::{Bodies, MOST_PASSES, Medium, Scene};

/// Bodies that a ray has entered and not left, by rising rank; equal ranks are in the order of entry. Body 0, which
/// surrounds everything, is never on the stack.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MediumStack(Vec<u32>);

impl MediumStack {
    /// Removes a body, however often it was entered.
    pub fn remove(&mut self, body: u32) {
        self.0.retain(|&other| other != body);
    }
}

/// Effect of a dielectric surface on a ray.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Transition {
    /// The surface lies inside a medium of higher rank, or separates equal media. The ray passes with this stack.
    Passed(MediumStack),
    /// The surface separates the media `from` and `to`. A refracted ray has the stack `beyond`.
    Boundary { from: u32, to: u32, beyond: MediumStack, unmatched: bool },
}

/// Media of a scene and the bodies that they fill.
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
    /// Returns the media on the stack. The last one fills the space around the ray.
    pub fn media(&self, filled: Filled) -> Vec<u32> {
        self.0.iter().map(|&body| filled.bodies.medium(body)).collect()
    }

    /// Returns the medium that fills the space around the ray.
    pub fn top(&self, filled: Filled) -> u32 {
        let top = self.0.last().map(|&body| filled.bodies.medium(body));
        top.filter(|&m| filled.priority(m) >= filled.priority(0)).unwrap_or(0)
    }

    /// Returns the stack with `body` added.
    pub fn with(&self, filled: Filled, body: u32) -> Self {
        let rank = filled.bodies.rank(body);
        let place = self.0.partition_point(|&b| filled.bodies.rank(b) <= rank);
        let mut entered = self.clone();
        entered.0.insert(place, body);
        entered
    }

    /// Returns the stack without the latest entry of `body`, or else of another body of its medium, with the removed
    /// position. Returns `None` if there is none.
    fn without(&self, filled: Filled, body: u32) -> Option<(Self, usize)> {
        let medium = filled.bodies.medium(body);
        let own = self.0.iter().rposition(|&b| b == body);
        let place = own.or_else(|| self.0.iter().rposition(|&b| filled.bodies.medium(b) == medium))?;
        let mut left = self.clone();
        left.0.remove(place);
        Some((left, place))
    }

    /// Returns the effect of the boundary of `body` on a ray with this stack. `front` says at which side the ray
    /// arrives.
    pub fn cross(&self, filled: Filled, body: u32, front: bool) -> Transition {
        let (current, medium) = (self.top(filled), filled.bodies.medium(body));
        if front {
            let beyond = self.with(filled, body);
            let inside = self.0.last().is_some_and(|&top| filled.bodies.rank(body) < filled.bodies.rank(top));
            return if inside || filled.priority(medium) < filled.priority(0) {
                Transition::Passed(beyond)
            } else {
                Transition::Boundary { from: current, to: medium, beyond, unmatched: false }
            };
        }
        match self.without(filled, body) {
            None => Transition::Boundary { from: medium, to: current, beyond: self.clone(), unmatched: true },
            Some((beyond, place)) if medium != current || place + 1 != self.0.len() => Transition::Passed(beyond),
            Some((beyond, _)) => {
                Transition::Boundary { from: medium, to: beyond.top(filled), beyond, unmatched: false }
            }
        }
    }

    /// Returns the effect of coinciding surfaces, given as bodies with true if the ray arrives at the front.
    pub fn cross_all(&self, filled: Filled, surfaces: &[(u32, bool)]) -> Transition {
        if let &[(body, front)] = surfaces {
            return self.cross(filled, body, front);
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
            return Transition::Passed(beyond);
        }
        Transition::Boundary { from, to, beyond, unmatched: never_entered.is_some() }
    }
}

/// Returns the stack of a ray that starts at the eye. The camera's medium takes precedence. Otherwise these are the
/// bodies whose boundaries a ray to infinity leaves without having entered them, and the half spaces of planes that
/// contain the eye.
pub(super) fn around_the_eye(scene: &Scene, accel: &Reference, filled: Filled) -> MediumStack {
    match scene.camera.medium {
        Some(0) => return MediumStack::default(),
        Some(medium) => return MediumStack(vec![filled.bodies.of_medium(medium)]),
        None => {}
    }
    let eye = scene.camera.eye.as_dvec3();
    // Upwards, but tilted: straight up would run along the walls of upright boxes and hit their diagonals.
    let mut ray = Ray64::new(eye, DVec3::new(0.137, 1.0, 0.259).normalize());
    ray.admits = GeometryMask::TRANSMISSIVE;
    let mut around = Vec::new();
    let mut entered: Vec<u32> = Vec::new();
    for crossing in surface::crossings(scene, accel, &ray).into_iter().take(MOST_PASSES as usize) {
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
    // The body left last was entered first.
    around.iter().rev().fold(MediumStack::default(), |stack, &body| stack.with(filled, body))
}
