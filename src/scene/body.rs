//! Bodies of transparent media, and the one that fills space where several overlap.

use glam::DVec3;

use super::Scene;
use super::material::Interface;
use crate::geometry::{Shape, TriMesh};

/// Relative difference below which two volumes count as equal.
const EQUAL_VOLUMES: f64 = 1e-5;

/// Transparent bodies of a scene, ranked.
///
/// The body of the highest rank fills the space in which bodies overlap. Rank is decided by the highest priority, then the
/// smaller closed volume, then the higher index, then the stronger absorption. So a bubble is air and a stone in water
/// is stone, in whatever order the surfaces are hit. Objects of one medium form one body unless an object of another
/// medium comes between them in rank.
///
/// The volume of a mesh is that enclosed by its faces. An open mesh counts with its bounding box, and a plane as
/// infinite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bodies {
    /// By object; `u32::MAX` if it bounds no medium.
    of_object: Vec<u32>,
    /// Body 0 is the medium that surrounds everything.
    bodies: Vec<Body>,
}

/// Body of one medium.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Body {
    medium: u32,
    rank: u32,
}

/// Transparent object that has no rank yet.
struct Solid {
    object: usize,
    medium: u32,
    volume: f64,
}

impl Bodies {
    /// Ranks the bodies of a scene.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let medium_of = |o: usize| scene.medium_of(o);
        let mut solids: Vec<Solid> = (0..scene.objects.len())
            .filter_map(|object| Some(Solid { object, medium: medium_of(object)?, volume: 0.0 }))
            .collect();
        let priority = |m: u32| scene.media[m as usize].priority;
        for i in 0..solids.len() {
            let Solid { object, medium, .. } = solids[i];
            // Volumes only decide between different media of one priority.
            let contested = solids.iter().any(|s| priority(s.medium) == priority(medium) && s.medium != medium);
            if contested {
                solids[i].volume = volume(&scene.geometry[object].shape);
            }
        }
        let by_volume = |a: f64, b: f64| if equal_volumes(a, b) { std::cmp::Ordering::Equal } else { a.total_cmp(&b) };
        let strength = |m: u32| {
            let medium = &scene.media[m as usize];
            (medium.ior, f64::from(medium.absorption.element_sum()))
        };
        solids.sort_by(|a, b| {
            let (a_strength, b_strength) = (strength(a.medium), strength(b.medium));
            priority(a.medium)
                .cmp(&priority(b.medium))
                .then(by_volume(b.volume, a.volume))
                .then(a_strength.0.total_cmp(&b_strength.0))
                .then(a_strength.1.total_cmp(&b_strength.1))
                .then(a.medium.cmp(&b.medium))
        });
        let mut bodies =
            Self { of_object: vec![u32::MAX; scene.objects.len()], bodies: vec![Body { medium: 0, rank: 0 }] };
        for solid in &solids {
            let last = bodies.bodies.last().filter(|_| bodies.bodies.len() > 1);
            if last.is_none_or(|last| last.medium != solid.medium) {
                let rank = bodies.bodies.len() as u32;
                bodies.bodies.push(Body { medium: solid.medium, rank });
            }
            bodies.of_object[solid.object] = bodies.bodies.len() as u32 - 1;
        }
        // A medium that only the camera names surrounds its contents, so it yields to all bodies of its priority.
        for medium in 1..scene.media.len() as u32 {
            if bodies.bodies.iter().all(|body| body.medium != medium) {
                let below = bodies.bodies[1..].iter().filter(|b| priority(b.medium) < priority(medium));
                let rank = below.map(|b| b.rank).max().unwrap_or(0);
                bodies.bodies.push(Body { medium, rank });
            }
        }
        bodies
    }

    /// Returns a body for each medium, with the same index, ranked by priority.
    #[cfg(test)]
    pub(crate) fn one_each(media: &[super::Medium]) -> Self {
        let rank = |m: &super::Medium| media.iter().filter(|other| other.priority < m.priority).count() as u32;
        let bodies = media.iter().zip(0..).map(|(m, medium)| Body { medium, rank: rank(m) }).collect();
        Self { of_object: Vec::new(), bodies }
    }

    /// Returns the number of bodies, including the surrounding one.
    #[must_use]
    pub fn count(&self) -> usize {
        self.bodies.len()
    }

    /// Returns the body of an object, or `None` if it bounds no medium.
    #[inline]
    #[must_use]
    pub fn of_object(&self, object: u32) -> Option<u32> {
        self.of_object.get(object as usize).copied().filter(|&body| body != u32::MAX)
    }

    /// Returns the medium of a body, as an index into [`Scene::media`].
    #[inline]
    #[must_use]
    pub fn medium(&self, body: u32) -> u32 {
        self.bodies[body as usize].medium
    }

    /// Returns the rank of a body. The body of higher rank fills the space where two overlap.
    #[inline]
    #[must_use]
    pub fn rank(&self, body: u32) -> u32 {
        self.bodies[body as usize].rank
    }

    /// Returns the body of a medium; of several, the one of the highest rank.
    #[must_use]
    pub fn of_medium(&self, medium: u32) -> u32 {
        let of = |&b: &u32| self.bodies[b as usize].medium == medium;
        (0..self.bodies.len() as u32).filter(of).max_by_key(|&b| self.rank(b)).unwrap_or(0)
    }
}

/// Returns true if two volumes agree within [`EQUAL_VOLUMES`]; infinite ones are equal.
fn equal_volumes(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= EQUAL_VOLUMES * a.max(b) && a.is_finite() && b.is_finite()
}

/// Returns the volume that a shape encloses, in cubic scene units.
fn volume(shape: &Shape) -> f64 {
    match shape {
        Shape::Plane(_) => f64::INFINITY,
        Shape::Sphere(sphere) => 4.0 / 3.0 * std::f64::consts::PI * f64::from(sphere.radius).powi(3),
        Shape::Mesh(mesh) => volume_of_mesh(mesh),
    }
}

/// Returns the volume of a mesh by the divergence theorem about the middle of its box, or that of the box if the faces
/// do not close. A surface is closed if its area vectors sum to zero.
fn volume_of_mesh(mesh: &TriMesh) -> f64 {
    let bounds = mesh.bounds();
    if bounds.is_empty() {
        return 0.0;
    }
    let (lo, hi) = (bounds.lo.as_dvec3(), bounds.hi.as_dvec3());
    let middle = (lo + hi) * 0.5;
    let (mut areas, mut area, mut sixfold) = (DVec3::ZERO, 0.0, 0.0);
    for i in (0..mesh.triangles.len()).filter(|&i| mesh.is_usable(i)) {
        let [a, b, c] = mesh.corners(i).map(|p| p.as_dvec3() - middle);
        let spanned = (b - a).cross(c - a);
        areas += spanned;
        area += spanned.length();
        sixfold += a.dot(b.cross(c));
    }
    if areas.length() <= 1e-5 * area { (sixfold / 6.0).abs() } else { (hi - lo).element_product() }
}

impl Scene {
    /// Returns the medium inside an object, or `None` if its surface bounds no medium.
    #[must_use]
    pub fn medium_of(&self, object: usize) -> Option<u32> {
        match self.materials[self.objects[object].material as usize].interface {
            Interface::Dielectric { medium, .. } => Some(medium),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Geometry, GeometryMask, Sphere};
    use crate::scene::{FresnelRule, Material, Medium, Object, Origin, Rgb};

    /// Concentric balls: radius, index and priority of each. Materials of equal index are shared.
    fn balls(of: &[(f32, f64, i32)]) -> Scene {
        let mut scene = Scene { media: vec![Medium::air()], ..Scene::default() };
        for &(radius, ior, priority) in of {
            let known = scene.media.iter().position(|m| m.ior == ior && m.priority == priority);
            let medium = known.unwrap_or_else(|| {
                scene.media.push(Medium { ior, priority, ..Medium::air() });
                scene.media.len() - 1
            }) as u32;
            let interface = Interface::Dielectric { medium, rule: FresnelRule::Fresnel, tint: Rgb::ONE };
            scene.materials.push(Material { interface, ..Material::black("glass") });
            let material = scene.materials.len() as u32 - 1;
            scene.objects.push(Object { name: String::from("ball"), material, origin: Origin::default() });
            let sphere = Sphere { centre: glam::Vec3::ZERO, radius };
            scene.geometry.push(Geometry { shape: Shape::Sphere(sphere), mask: GeometryMask::TRANSMISSIVE });
        }
        scene
    }

    fn ranks(of: &[(f32, f64, i32)]) -> Vec<u32> {
        let bodies = Bodies::of(&balls(of));
        (0..of.len() as u32).map(|o| bodies.rank(bodies.of_object(o).expect("it holds a medium"))).collect()
    }

    #[test]
    fn priority_decides_first_then_the_smaller_volume_then_the_higher_index() {
        assert_eq!(ranks(&[(1.0, 1.33, 5), (2.0, 1.5, 10)]), [1, 2]);
        assert_eq!(ranks(&[(1.0, 1.33, 0), (2.0, 1.5, 0)]), [2, 1]);
        assert_eq!(ranks(&[(1.0, 1.33, 0), (1.0, 1.0, 0)]), [2, 1]);
    }

    #[test]
    fn objects_of_one_medium_are_one_body_unless_another_comes_between() {
        assert_eq!(ranks(&[(1.0, 1.5, 0), (7.0, 1.5, 0), (3.0, 1.5, 0)]), [1, 1, 1]);
        assert_eq!(ranks(&[(1.0, 1.5, 0), (7.0, 1.5, 0), (3.0, 1.33, 0)]), [3, 1, 2]);
        let bodies = Bodies::of(&balls(&[(1.0, 1.5, 0), (7.0, 1.5, 0), (3.0, 1.33, 0)]));
        assert_eq!((bodies.count(), bodies.medium(bodies.of_medium(1)), bodies.rank(bodies.of_medium(1))), (4, 1, 3));
    }
}
