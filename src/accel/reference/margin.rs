//! Error bounds: the distance of an `f64` decision from the opposite one, and the error that `f32` may make in it.
//!
//! An `f32` kernel, whatever its formula, starts by moving the shape to the ray's origin, which rounds each coordinate.
//! A few operations on numbers no larger follow. So its answer is right for some shape whose points lie within a few
//! roundings of `reach` of the given ones, plus the roundings of the last products. `reach` is the largest coordinate
//! relative to the origin. [`ROUNDINGS`] is the number of these roundings. The native Woop kernel needs about 5
//! (difference, shear factor, product, difference, product), Embree's two kernels 6 to 12.

use arrayvec::ArrayVec;
use glam::DVec3;

use super::primitive::{Form, Primitive, Probe, moment};
use crate::math::{UNIT_ROUNDOFF, ulp};

/// Number of `f32` roundings that a point may suffer, each relative to `reach`.
const ROUNDINGS: f64 = 16.0;

/// Distance that a point may move in `f32`, relative to `reach`.
pub(super) const SLIP: f64 = ROUNDINGS * UNIT_ROUNDOFF as f64;

/// Further movement in scene units if products underflow: 16 roundings of 2^-150, the spacing there.
pub(super) const TINY: f64 = ROUNDINGS * 7.006_492_321_624_085e-46;

/// Distance of a decision from the opposite one, and the error that `f32` may make in it, in the same unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// Distance of the `f64` value from the opposite decision, at least 0.
    pub distance: f64,
    /// Largest error of `f32`, at least 0; infinite if `f32` decides nothing.
    pub bound: f64,
}

impl Margin {
    /// Returns true if every valid `f32` evaluation must decide alike.
    #[must_use]
    pub fn is_decided(&self) -> bool {
        self.distance > self.bound
    }

    /// Returns the distance in units of the bound.
    fn ratio(&self) -> f64 {
        if self.bound > 0.0 { self.distance / self.bound } else { f64::INFINITY }
    }

    fn least(a: Self, b: Self) -> Self {
        if b.ratio() < a.ratio() { b } else { a }
    }

    fn most(a: Self, b: Self) -> Self {
        if b.ratio() > a.ratio() { b } else { a }
    }

    const NONE: Self = Self { distance: 0.0, bound: f64::INFINITY };
    const SURE: Self = Self { distance: f64::INFINITY, bound: 0.0 };
}

/// Intersection of one primitive with the whole line of one ray.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Instance, geometry and primitive.
    pub id: (u32, u32, u32),
    /// True if the line passes through the primitive in `f64`.
    pub inside: bool,
    /// Distance to the nearest edge or silhouette that would flip `inside`, in scene units.
    pub edge: Margin,
    /// Ray parameter, also if the line passes outside the primitive.
    pub t: f64,
    /// Tolerance of `t` for `f32`: 16 ulp of `reach`, divided by |cos| of incidence and the direction's length.
    pub tolerance: f64,
    /// Largest error of `t` in `f32`. It exceeds `tolerance` on slivers, where rounded edges give bad weights.
    pub bound: f64,
    /// Index in the list of primitives.
    pub(super) place: usize,
    /// Smallest and largest `t` of a kernel that computes `t` as a mean of those of the triangle's corners.
    pub(super) span: [f64; 2],
}

impl Contact {
    /// Returns the contacts of `primitive`, which has index `place` in the list, with the ray of `probe`: two with a
    /// sphere, one with a triangle, at most one with a plane.
    pub(super) fn with(primitive: &Primitive, place: usize, probe: &Probe) -> ArrayVec<Self, 2> {
        let contacts: ArrayVec<Self, 2> = match &primitive.form {
            Form::Triangle(corners) => std::iter::once(triangle(primitive.id(), probe, corners)).collect(),
            Form::Sphere { centre, radius } => sphere(primitive.id(), probe, *centre, *radius),
            Form::Plane { point, normal } => plane(primitive.id(), probe, *point, *normal).into_iter().collect(),
        };
        contacts.into_iter().map(|c| Self { place, ..c }).collect()
    }
}

/// 16 ulp of `reach`, over |cos| of incidence and the direction's length.
fn tolerance(reach: f64, cos: f64, dir: DVec3) -> f64 {
    16.0 * f64::from(ulp(reach as f32)) / (cos.abs() * dir.length()) + TINY
}

fn triangle(id: (u32, u32, u32), probe: &Probe, corners: &[DVec3; 3]) -> Contact {
    let ray = &probe.ray;
    let seen = probe.triangle(corners);
    let reach = corners.iter().fold(0.0_f64, |m, p| m.max((*p - ray.origin).abs().max_element()));
    let slip = SLIP * reach + TINY;
    let margins: [Margin; 3] = std::array::from_fn(|i| {
        let (p, q) = (seen.flat[(i + 1) % 3], seen.flat[(i + 2) % 3]);
        let length = (p - q).length();
        let products = 4.0 * f64::from(UNIT_ROUNDOFF) * ((p.x * q.y).abs() + (p.y * q.x).abs());
        let error = slip * (p.length() + q.length() + slip) + products;
        if length > 0.0 {
            Margin { distance: seen.edges[i].abs() / length, bound: error / length }
        } else {
            Margin::NONE
        }
    });
    let inside = seen.is_inside();
    let edge = if inside {
        margins.into_iter().fold(Margin::SURE, Margin::least)
    } else {
        // One edge proves the ray to be outside, by its sign.
        let best = |sign: f64| {
            let of_sign = (0..3).filter(|&i| seen.edges[i] * sign > 0.0);
            of_sign.fold(Margin::NONE, |best, i| Margin::most(best, margins[i]))
        };
        Margin::least(best(1.0), best(-1.0))
    };

    let slip_t = slip / ray.dir.abs().max_element() + TINY;
    let (first, last) = seen.depth.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(f, l), &t| (f.min(t), l.max(t)));
    let Some((t, ..)) = seen.meeting() else {
        // Edge-on: unless the corners prove the line to be elsewhere, `f32` may find anything.
        let t = seen.depth.iter().sum::<f64>() / 3.0;
        let span = [first - slip_t, last + slip_t];
        return Contact { id, inside: false, edge, t, tolerance: f64::INFINITY, bound: f64::INFINITY, place: 0, span };
    };
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
    let tolerance = tolerance(reach, normal.dot(ray.dir) / ray.dir.length(), ray.dir);
    let lengths = [1, 2, 0].map(|i| (seen.flat[i] - seen.flat[(i + 1) % 3]).length());
    let errors = [0, 1, 2].map(|i| if lengths[i] > 0.0 { margins[i].bound * lengths[i] } else { 0.0 });
    // The error of the sum is the sum of the errors.
    let whole_left = seen.whole().abs() - errors.iter().sum::<f64>();
    let weights_off = if whole_left > 0.0 {
        (0..3).map(|i| errors[i] * (seen.depth[i] - t).abs()).sum::<f64>() / whole_left
    } else {
        f64::INFINITY
    };
    let bound = tolerance.max(weights_off + slip_t);
    let within = t.clamp(first, last);
    let span = [(within - bound).max(first) - slip_t, (within + bound).min(last) + slip_t];
    Contact { id, inside, edge, t, tolerance, bound, place: 0, span }
}

fn sphere(id: (u32, u32, u32), probe: &Probe, centre: DVec3, radius: f64) -> ArrayVec<Contact, 2> {
    let ray = &probe.ray;
    let from_centre = ray.origin - centre;
    let length = ray.dir.length();
    let middle = -from_centre.dot(ray.dir) / (length * length);
    let nearest = moment(ray, from_centre) / length;
    let reach = from_centre.abs().max_element() + radius;
    let edge = Margin { distance: (radius - nearest).abs(), bound: SLIP * reach + TINY };
    let half_chord = ((radius - nearest) * (radius + nearest)).max(0.0).sqrt();
    let tolerance = tolerance(reach, half_chord / radius, ray.dir);
    [-1.0, 1.0]
        .into_iter()
        .map(|side| {
            let t = middle + side * half_chord / length;
            let span = [t - tolerance, t + tolerance];
            Contact { id, inside: nearest <= radius, edge, t, tolerance, bound: tolerance, place: 0, span }
        })
        .collect()
}

fn plane(id: (u32, u32, u32), probe: &Probe, point: DVec3, normal: DVec3) -> Option<Contact> {
    let ray = &probe.ray;
    let cos = normal.dot(ray.dir) / ray.dir.length();
    if cos == 0.0 {
        return None;
    }
    let t = normal.dot(point - ray.origin) / normal.dot(ray.dir);
    let reach = (point - ray.origin).abs().max_element().max(t.abs() * ray.dir.length());
    let edge = Margin { distance: cos.abs(), bound: SLIP };
    let tolerance = tolerance(reach, cos, ray.dir);
    let span = [t - tolerance, t + tolerance];
    Some(Contact { id, inside: true, edge, t, tolerance, bound: tolerance, place: 0, span })
}
