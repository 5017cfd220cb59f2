//! Shafts: the region between a point of a surface and a lamp. Only objects inside it can shade the point.

use glam::Vec3;

use super::aabb::Aabb8;
use super::plane::Plane;
use crate::math::Real;
use crate::simd::{F32x8, Mask8, Vec3x8};

/// Rounding of directions and distances in `f32`, relative: 64 unit roundoffs.
const ROUNDING: f32 = 4e-6;

/// Sine of the largest angle above the surface at which triangles still count as part of it: 32 unit roundoffs.
const GRAZING: f32 = 2e-6;

/// Relative length that shadow rays end before their lamp, at least: a quarter of the length that `before_lamp` subtracts.
const SHORTER: f32 = 5e-7;

/// The occluders in a shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// None: no ray in the shaft hits anything.
    Empty,
    /// One opaque surface blocks every ray in the shaft.
    Covered,
    /// Some objects, or undecided because of rounding.
    Mixed,
}

/// A shaft: the part of a pyramid between its apex, on a surface, and a lamp.
///
/// All bounds are conservative: [`Content::Empty`] and [`Content::Covered`] hold for rays with `f32` rounding, not only for
/// exact ones.
#[derive(Clone, Debug)]
pub struct Shaft {
    from: Vec3,
    /// Normal of the surface: the shaft lies above it.
    floor: Vec3,
    /// Inward unit normals of the planes through the apex.
    sides: [Vec3; 4],
    /// Edges of the pyramid, from the apex to the plane across the lamp.
    corners: [Vec3; 4],
    /// Unit normal of that plane, away from the apex.
    across: Vec3,
    /// Distance along it beyond which there is nothing but the lamp.
    end: f32,
    /// Part of the corners' lengths within which a surface is in front of all of the lamp.
    stop: f32,
    /// The lamp's own body, a ball: centre, and radius with what rays end before it by.
    body: Option<(Vec3, f32)>,
    /// Rounding of coordinates, in scene units.
    slack: f32,
}

/// A lamp as a shaft ends at it; vectors from the apex.
#[derive(Clone, Copy, Debug)]
pub struct ShaftEnd {
    /// Four directions between which all of the lamp lies, to the plane across it, in order around it.
    pub corners: [Vec3; 4],
    /// Unit normal of that plane, away from the apex.
    pub across: Vec3,
    /// Distance along it beyond which there is nothing but the lamp.
    pub end: f32,
    /// Part of the corners' lengths within which a surface is in front of all of the lamp, at most 1.
    pub stop: f32,
    /// Centre and radius of a lamp that is a ball.
    pub body: Option<(Vec3, f32)>,
}

impl Shaft {
    /// From a point above a surface of unit normal `floor`. None where rounding leaves it open which side of its planes
    /// is inside.
    #[must_use]
    pub fn new(from: Vec3, floor: Vec3, lamp: &ShaftEnd) -> Option<Self> {
        let ShaftEnd { corners, across, end, stop, body } = *lamp;
        let middle = corners[0] + corners[1] + corners[2] + corners[3];
        let length = middle.length();
        let mut sides = [Vec3::ZERO; 4];
        for (k, side) in sides.iter_mut().enumerate() {
            let normal = corners[k].cross(corners[(k + 1) % 4]).normalize();
            let inside = normal.dot(middle);
            // Not for NaN either.
            if !(inside.abs() > 1e-4 * length && inside.is_finite()) {
                return None;
            }
            *side = if inside > 0.0 { normal } else { -normal };
        }
        let scale = corners.iter().fold(from.abs(), |most, &c| most.max((from + c).abs())).max_element();
        let ends_by = SHORTER * (scale + end);
        let sound = scale.is_finite() && floor.is_finite() && across.is_finite() && end > 10.0 * ends_by && stop > 0.0;
        let body = body.map(|(centre, radius)| (centre, radius + ends_by));
        let stop = stop * (1.0 - 1e-5);
        sound.then_some(Self {
            from,
            floor,
            sides,
            corners,
            across,
            end: end - ends_by,
            stop,
            body,
            slack: 0.1 * ROUNDING * scale,
        })
    }

    /// Returns the boxes, of eight, that may reach into the shaft: by axis, their lower and upper planes.
    #[must_use]
    pub fn boxes(&self, boxes: &Aabb8) -> u8 {
        let from = self.from.to_array();
        let near = [0, 1, 2].map(|axis| boxes.planes[axis].map(|plane| plane - F32x8::from(from[axis])));
        // Of each box, the corner that is farthest along a direction.
        let farthest = |along: Vec3| {
            let of = |axis: usize, along: f32| near[axis][usize::from(along > 0.0)] * F32x8::from(along);
            of(0, along.x) + of(1, along.y) + of(2, along.z)
        };
        let reach = |axis: usize| near[axis][0].abs().max_or(near[axis][1].abs());
        let slack = -((reach(0) + reach(1) + reach(2)) * F32x8::from(ROUNDING) + F32x8::from(self.slack));
        let mut out = farthest(self.floor).le(F32x8::ZERO) | (-farthest(-self.across)).ge(F32x8::from(self.end));
        for side in self.sides {
            out |= farthest(side).lt(slack);
        }
        !out.bits()
    }

    /// The content of the shaft out of eight triangles; `slots` has those that there are, `blocks` those that stop light.
    #[must_use]
    pub fn triangles(&self, corners: &[Vec3x8; 3], slots: u8, blocks: u8) -> Content {
        let from = Vec3x8::splat(self.from);
        let at = corners.map(|corner| corner - from);
        let far = at.map(size);
        let grazing = far.map(|far| far * F32x8::from(GRAZING));
        let mut out = all_below(&at, self.floor, &grazing) | all_below(&at, -self.across, &[F32x8::from(-self.end); 3]);
        let slack = far.map(|far| -(far * F32x8::from(ROUNDING) + F32x8::from(self.slack)));
        for side in self.sides {
            out |= all_below(&at, side, &slack);
        }
        if let Some((centre, radius)) = self.body {
            let within = |p: Vec3x8| (p - Vec3x8::splat(centre)).length().le(F32x8::from(radius));
            out |= within(at[0]) & within(at[1]) & within(at[2]);
        }
        let mut met = slots & !out.bits();
        if met == 0 {
            return Content::Empty;
        }
        met &= !self.beyond_their_planes(&at, far[0]);
        if met == 0 {
            Content::Empty
        } else if met & blocks & self.covering(&at) != 0 {
            Content::Covered
        } else {
            Content::Mixed
        }
    }

    /// Triangles that have all of the shaft on one side of their plane.
    fn beyond_their_planes(&self, at: &[Vec3x8; 3], far: F32x8) -> u8 {
        let normal = (at[1] - at[0]).cross(at[2] - at[0]);
        let height = normal.dot(at[0]);
        let rounding = size(normal) * F32x8::from(ROUNDING);
        let slack = rounding * far + size(normal) * F32x8::from(self.slack);
        let (mut above, mut below) = (height.lt(-slack), height.gt(slack));
        for corner in self.corners {
            let slack = slack + rounding * F32x8::from(corner.abs().element_sum());
            let over = normal.dot(Vec3x8::splat(corner)) - height;
            above &= over.gt(slack);
            below &= over.lt(-slack);
        }
        (above | below).bits()
    }

    /// Triangles that every ray to the lamp passes, before the lamp.
    fn covering(&self, at: &[Vec3x8; 3]) -> u8 {
        let [a, b, c] = *at;
        let edges = [b.cross(c), c.cross(a), a.cross(b)];
        let volume = a.dot(edges[0]);
        let turned = volume.lt(F32x8::ZERO);
        let forwards = |x: F32x8| turned.select(-x, x);
        let volume = forwards(volume);
        let mut covers = u8::MAX;
        for corner in self.corners {
            let length = F32x8::from(corner.abs().element_sum() * ROUNDING);
            let along = Vec3x8::splat(corner);
            let weights = edges.map(|edge| forwards(edge.dot(along)));
            let inside = |k: usize| weights[k].gt(size(edges[k]) * length).bits();
            let sum = weights[0] + weights[1] + weights[2];
            let off = volume.gt(sum * F32x8::from(1e-5)) & volume.lt(sum * F32x8::from(self.stop));
            covers &= inside(0) & inside(1) & inside(2) & off.bits();
        }
        covers
    }

    /// The content of the shaft out of eight spheres.
    #[must_use]
    pub fn spheres(&self, centre: Vec3x8, radius: F32x8, slots: u8, blocks: u8) -> Content {
        let at = centre - Vec3x8::splat(self.from);
        let far = size(at) + radius;
        let along = |direction: Vec3| at.dot(Vec3x8::splat(direction));
        let mut out = (along(self.floor) + radius).le(far * F32x8::from(GRAZING));
        out |= (along(self.across) - radius).ge(F32x8::from(self.end));
        let slack = -(far * F32x8::from(ROUNDING) + F32x8::from(self.slack));
        for side in self.sides {
            out |= (along(side) + radius).lt(slack);
        }
        if let Some((body, reach)) = self.body {
            out |= ((at - Vec3x8::splat(body)).length() + radius).le(F32x8::from(reach));
        }
        let met = slots & !out.bits();
        if met == 0 {
            return Content::Empty;
        }
        // A ball is convex: what meets all edges of the pyramid meets everything between them.
        let off = at.dot(at);
        let mut covers = met & blocks & off.gt(radius * radius * F32x8::from(1.0 + 1e-4)).bits();
        // And is in front of the lamp.
        let depth = self.corners[0].dot(self.across) * self.stop;
        covers &= (along(self.across) + radius).lt(F32x8::from(depth)).bits();
        for corner in self.corners {
            let reach = along(corner.normalize());
            let aside = off - reach * reach;
            covers &= reach.gt(F32x8::ZERO).bits()
                & (aside + off * F32x8::from(ROUNDING)).lt(radius * radius * F32x8::from(1.0 - 1e-4)).bits();
        }
        if covers != 0 { Content::Covered } else { Content::Mixed }
    }

    /// The content of the shaft out of one infinite plane.
    #[must_use]
    pub fn plane(&self, plane: &Plane, blocks: bool) -> Content {
        let off = plane.point - self.from;
        let height = -plane.normal.dot(off);
        let size = plane.normal.abs().element_sum();
        let rounding = ROUNDING * off.abs().element_sum() + 10.0 * self.slack;
        let side = if height < 0.0 { -1.0 } else { 1.0 };
        let parallel = (plane.normal * side - self.floor).length_squared() < 1e-12;
        // The surface's own plane: rays set out above it. A lamp may lie in a plane; rays end before it.
        let own = parallel && height.abs() <= rounding;
        let heights = self.corners.map(|corner| side * (height + plane.normal.dot(corner)));
        let lowest = heights.iter().copied().fold(f32::INFINITY, f32::min);
        let highest = heights.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let reach = self.corners.iter().map(|c| c.abs().element_sum()).fold(0.0, f32::max);
        let ends_by = SHORTER * reach * size;
        if own || (height != 0.0 && lowest >= -ends_by) {
            Content::Empty
        } else if blocks && height.abs() > rounding && -highest > 1e-4 * reach && self.is_before(height.abs(), heights)
        {
            Content::Covered
        } else {
            Content::Mixed
        }
    }

    /// Returns true if a plane `height` below the apex, with the corners at `heights` beyond it, is in front of the lamp.
    fn is_before(&self, height: f32, heights: [f32; 4]) -> bool {
        heights.iter().all(|h| height < (height - h) * self.stop)
    }

    /// Returns true if all of the lamp lies below a plane through the apex with this normal.
    #[must_use]
    pub fn is_below(&self, normal: Vec3) -> bool {
        let below = |corner: &Vec3| corner.dot(normal) < -ROUNDING * corner.abs().element_sum();
        self.corners.iter().all(below)
    }
}

/// Triangles of which no corner reaches farther along a direction than is given for it.
#[inline(always)]
fn all_below(at: &[Vec3x8; 3], along: Vec3, limits: &[F32x8; 3]) -> Mask8 {
    let along = Vec3x8::splat(along);
    at[0].dot(along).le(limits[0]) & at[1].dot(along).le(limits[1]) & at[2].dot(along).le(limits[2])
}

/// The sum of the components' magnitudes.
#[inline(always)]
fn size(v: Vec3x8) -> F32x8 {
    v.x.abs() + v.y.abs() + v.z.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From just above the floor up to a square of half width 1, 10 above.
    fn shaft() -> Shaft {
        let corner = |x: f32, z: f32| Vec3::new(x, 10.0, z);
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let lamp = ShaftEnd { corners, across: Vec3::Y, end: 10.0, stop: 1.0, body: None };
        Shaft::new(Vec3::new(0.0, 1e-6, 0.0), Vec3::Y, &lamp).unwrap()
    }

    fn triangle(corners: [[f32; 3]; 3], blocks: bool) -> Content {
        let corners = corners.map(|c| Vec3x8::splat(Vec3::from(c)));
        shaft().triangles(&corners, 1, u8::from(blocks))
    }

    fn sphere(centre: [f32; 3], radius: f32) -> Content {
        shaft().spheres(Vec3x8::splat(centre.into()), F32x8::from(radius), 1, 1)
    }

    #[test]
    fn triangles_are_outside_inside_or_cover_the_lamp() {
        let level = |y: f32, half: f32| [[-half, y, -half], [3.0 * half, y, -half], [-half, y, 3.0 * half]];
        // At half the height the shaft is half as wide.
        assert_eq!(triangle(level(5.0, 0.6), true), Content::Covered);
        assert_eq!(triangle(level(5.0, 0.6), false), Content::Mixed);
        assert_eq!(triangle(level(5.0, 0.4), true), Content::Mixed);
        assert_eq!(triangle(level(5.0, 0.6).map(|[x, y, z]| [x + 1.2, y, z]), true), Content::Empty);
        assert_eq!(triangle(level(5.0, 0.6).map(|[x, y, z]| [x + 1.0, y, z]), true), Content::Mixed);
        // The floor itself, what is below it, and what the lamp lies in or in front of.
        for y in [0.0, -3.0, 10.0, 11.0] {
            assert_eq!(triangle(level(y, 50.0), true), Content::Empty, "{y}");
        }
        assert_eq!(triangle(level(9.9, 50.0), true), Content::Covered);
        // A wall beside the shaft whose box reaches into it.
        assert_eq!(triangle([[2.0, 0.0, 0.0], [2.0, 10.0, -9.0], [0.5, 0.0, -9.0]], true), Content::Empty);
        // One thinner than any grid of probes.
        assert_eq!(triangle([[-2.0, 5.0, 0.0], [2.0, 5.0, 0.0], [2.0, 5.0, 1e-4]], true), Content::Mixed);
    }

    #[test]
    fn spheres_are_outside_inside_or_cover_the_lamp() {
        assert_eq!(sphere([3.0, 5.0, 0.0], 2.0), Content::Empty);
        assert_eq!(sphere([3.0, 5.0, 0.0], 2.7), Content::Mixed);
        assert_eq!(sphere([0.0, 5.0, 0.0], 1.0), Content::Covered);
        assert_eq!(sphere([0.0, 5.0, 0.0], 0.5), Content::Mixed);
        assert_eq!(sphere([0.0, -2.0, 0.0], 2.0), Content::Empty, "it stands on the sphere");
        assert_eq!(sphere([0.0, 12.0, 0.0], 1.5), Content::Empty, "behind the lamp");
    }

    #[test]
    fn planes_are_outside_inside_or_cover_the_lamp() {
        let plane = |y: f32, normal: Vec3| shaft().plane(&Plane { point: Vec3::Y * y, normal }, true);
        for normal in [Vec3::Y, -Vec3::Y] {
            assert_eq!(plane(0.0, normal), Content::Empty);
            assert_eq!(plane(-4.0, normal), Content::Empty);
            assert_eq!(plane(4.0, normal), Content::Covered);
            assert_eq!(plane(10.0, normal), Content::Empty, "the lamp lies in it");
        }
        assert_eq!(plane(4.0, Vec3::X), Content::Mixed);
    }

    #[test]
    fn boxes_that_reach_in_are_found() {
        let mut eight = Aabb8 { planes: [[F32x8::ZERO; 2]; 3] };
        let boxes = [
            ([-0.1, 4.0, -0.1], [0.1, 5.0, 0.1], true),
            ([2.0, 4.0, -0.1], [3.0, 5.0, 0.1], false),
            ([-9.0, -1.0, -9.0], [9.0, 0.0, 9.0], false),
            ([-9.0, 10.0, -9.0], [9.0, 11.0, 9.0], false),
            ([-9.0, 9.0, -9.0], [9.0, 11.0, 9.0], true),
            ([0.3, 2.0, -9.0], [0.4, 3.0, 9.0], true),
            ([0.31, 1.0, -9.0], [0.4, 3.0, 9.0], false),
        ];
        for (i, (lo, hi, _)) in boxes.iter().enumerate() {
            eight.set_lane(i, *lo, *hi);
        }
        let found = shaft().boxes(&eight);
        for (i, (.., within)) in boxes.iter().enumerate() {
            assert_eq!(found >> i & 1 != 0, *within, "{i}");
        }
    }
}
