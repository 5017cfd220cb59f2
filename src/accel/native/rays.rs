//! Rays made ready for traversal: what every step would otherwise work out again.

use super::bits::transpose;
use super::bvh8::{Bvh8, Child, Planes};
use crate::geometry::Ray8;
use crate::geometry::slab::{SlabRay, T_LIMIT, is_traceable};
use crate::geometry::triangle::{Axis, ShearedRay};
use crate::math::Real;
use crate::simd::{F32x8, Mask8, Vec3x8};

/// The axes as [`Axis::turn`] turns them, by the longest one.
pub(super) const TURNED: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

/// What box tests ask of eight rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way8 {
    /// Starts and inverse directions.
    pub slab: SlabRay<F32x8>,
    /// Directions.
    pub dir: Vec3x8,
    /// Lower ends of the intervals.
    pub t_min: F32x8,
    /// Upper ends; -inf in lanes without a ray that can meet anything.
    pub t_max: F32x8,
    /// Lanes with a ray that can meet anything.
    pub lanes: u8,
    /// Kinds of geometry looked for.
    pub admits: u8,
    /// Sign bits of the inverse directions, an axis each.
    backwards: [u8; 3],
}

impl Way8 {
    /// Makes a packet ready. Lanes that can meet nothing are left out from here on.
    #[inline(always)]
    pub fn new(rays: &Ray8) -> Self {
        let t_max = Real::min(rays.t_max, F32x8::from(T_LIMIT));
        let sound = is_traceable(rays.origin, rays.dir, rays.t_min, t_max) & rays.t_max.eq(rays.t_max);
        let lanes = sound.bits() & rays.active;
        let slab = SlabRay::new(rays.origin, rays.dir);
        Self {
            slab,
            dir: rays.dir,
            t_min: rays.t_min,
            t_max: Mask8::from_bits(lanes).select(t_max, F32x8::from(f32::NEG_INFINITY)),
            lanes,
            admits: rays.admits.0,
            backwards: [slab.inverse.x.sign_bits(), slab.inverse.y.sign_bits(), slab.inverse.z.sign_bits()],
        }
    }

    /// The lanes among `lanes` that run into the same octant as the lowest of them.
    #[inline(always)]
    pub fn same_octant(&self, lanes: u8) -> u8 {
        let first = lanes.trailing_zeros() & 7;
        self.backwards.iter().fold(lanes, |kept, &b| kept & if b >> first & 1 != 0 { b } else { !b })
    }

    /// The lanes among `lanes` whose direction is as close to that of the lowest of them as `agreement`, the square
    /// of the cosine between them; and those of these that also start where it does.
    #[inline(always)]
    pub fn same_way(&self, lanes: u8, agreement: f64) -> (u8, u8) {
        let first = lanes.trailing_zeros() as usize & 7;
        let (dir, start) = (Vec3x8::splat(self.dir.lane(first)), Vec3x8::splat(self.slab.origin.lane(first)));
        let along = self.dir.dot(dir);
        let all = self.dir.length_squared() * dir.length_squared();
        let o = self.slab.origin;
        let together = o.x.eq(start.x) & o.y.eq(start.y) & o.z.eq(start.z);
        let close = (F32x8::splat(agreement) * all).le(along * along.abs()).bits() & lanes;
        (close, close & together.bits())
    }

    /// For each axis, 1 where the ray of `lane` runs backwards along it: the index of its near planes.
    #[inline(always)]
    pub fn octant(&self, lane: usize) -> [usize; 3] {
        self.backwards.map(|b| usize::from(b >> lane & 1))
    }

    /// The octants of all rays: a bit an axis, x lowest, set where they run backwards.
    #[inline(always)]
    pub fn octants(&self) -> [u8; 8] {
        let [x, y, z] = self.backwards.map(u64::from);
        transpose(x | y << 8 | z << 16).to_le_bytes()
    }

    /// The rays one by one: start, lower end, inverse direction, upper end.
    #[inline(always)]
    pub fn rows(&self) -> [F32x8; 8] {
        let (o, d) = (self.slab.origin, self.slab.inverse);
        F32x8::transpose([o.x, o.y, o.z, self.t_min, d.x, d.y, d.z, self.t_max])
    }

    /// The lanes among `lanes` whose intervals begin at zero or later.
    #[inline(always)]
    pub fn ahead(&self, lanes: u8) -> u8 {
        F32x8::ZERO.le(self.t_min).bits() & lanes
    }

    /// Those of `lanes` that meet any box in the root of a tree.
    #[inline(always)]
    pub fn reach<L>(&self, tree: &Bvh8<L>, lanes: u8) -> u8 {
        if tree.root.is_leaf() {
            return if tree.root == Child::NONE { 0 } else { lanes };
        }
        let planes = &tree.nodes[tree.root.index()].planes;
        let mut reached = 0;
        for c in 0..8 {
            let corner = |side: usize| {
                let at = |axis: usize| F32x8::from(planes[axis][side].lane(c));
                Vec3x8::new(at(0), at(1), at(2))
            };
            let (enter, leave) = self.slab.clip(corner(0), corner(1), self.t_min, self.t_max);
            reached |= enter.le(leave).bits();
            if reached & lanes == lanes {
                break;
            }
        }
        reached & lanes
    }

    /// Of the boxes in `boxes`, those that a ray of `lanes` meets before `t_max`. All of them run into `octant`.
    #[inline(always)]
    pub fn sift(&self, lanes: u8, t_max: F32x8, octant: [usize; 3], planes: &Planes, boxes: u8) -> u8 {
        let mut kept = 0;
        each(boxes, |c| {
            let near = |axis: usize| F32x8::from(planes[axis][octant[axis] & 1].lane(c));
            let far = |axis: usize| F32x8::from(planes[axis][(octant[axis] & 1) ^ 1].lane(c));
            let (near, far) = (Vec3x8::new(near(0), near(1), near(2)), Vec3x8::new(far(0), far(1), far(2)));
            let (enter, leave) = self.slab.clip_sorted(near, far, self.t_min, t_max);
            kept |= u8::from(enter.le(leave).bits() & lanes != 0) << c;
        });
        kept
    }
}

/// Eight rays, made ready for whatever a tree holds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eight {
    /// For boxes.
    pub way: Way8,
    /// Turned and sheared for the triangle test.
    pub sheared: ShearedRay<F32x8>,
    /// Longest axes of the directions.
    pub axis: Axis<Mask8>,
    /// Lanes whose longest axis is x, and y.
    axis_bits: (u8, u8),
}

impl Eight {
    /// From what box tests ask.
    #[inline(always)]
    pub fn new(way: &Way8) -> Self {
        let (sheared, axis) = ShearedRay::new(way.slab.origin, way.dir);
        Self { way: *way, sheared, axis, axis_bits: (axis.is_x.bits(), axis.is_y.bits()) }
    }

    /// The longest axis of all of `lanes`, where they agree.
    #[inline(always)]
    pub fn common_axis(&self, lanes: u8) -> Option<usize> {
        let (x, y) = (self.axis_bits.0 & lanes, self.axis_bits.1 & lanes);
        match (x == lanes, y == lanes, x | y == 0) {
            (true, _, _) => Some(0),
            (_, true, _) => Some(1),
            (_, _, true) => Some(2),
            _ => None,
        }
    }
}

impl Default for Eight {
    /// No rays.
    fn default() -> Self {
        Self::new(&Way8::new(&Ray8::default()))
    }
}

/// Calls `f` with each lane.
#[inline(always)]
pub(super) fn each(mut lanes: u8, mut f: impl FnMut(usize)) {
    while lanes != 0 {
        f(lanes.trailing_zeros() as usize & 7);
        lanes &= lanes - 1;
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::Ray;

    /// LN-04: a ray that can meet nothing costs no traversal: it is left out at the door, and its neighbours are not.
    #[test]
    fn rays_that_can_meet_nothing_are_left_out_before_traversal() {
        let good = Ray::new(Vec3::ONE, Vec3::new(0.1, -0.2, 0.9));
        let bad = [
            Ray { dir: Vec3::new(f32::NAN, 0.0, 1.0), ..good },
            Ray { dir: Vec3::new(0.0, f32::INFINITY, 1.0), ..good },
            Ray { dir: Vec3::new(0.0, -0.0, 0.0), ..good },
            Ray { origin: Vec3::new(0.0, 0.0, f32::NAN), ..good },
            Ray { origin: Vec3::new(0.0, f32::NEG_INFINITY, 0.0), ..good },
            Ray { t_min: f32::NAN, ..good },
            Ray { t_max: f32::NAN, ..good },
            Ray { t_min: 2.0, t_max: 2.0, ..good },
        ];
        for lane in 0..8 {
            for bad in bad {
                let mut rays = [good; 8];
                rays[lane] = bad;
                assert_eq!(Way8::new(&Ray8::pack(&rays)[0]).lanes, !(1 << lane), "{bad:?}");
            }
        }
        assert_eq!(Way8::new(&Ray8::pack(&bad)[0]).lanes, 0);
    }
}
