//! Optional state of rays: the budget of a proven cut-off, and the polarisation of the path. Queues hold it only in
//! renders that need it.

use glam::Vec3;

use super::queue::Rgb8;
use crate::math::{Real, Vector3};
use crate::optics::{Diattenuation, Mueller, PlaneOfIncidence, any_across, made_across};
use crate::simd::{F32x8, Vec3x8};

/// Extras of eight rays, as one array so that one loop moves a lane: three budgets, three coordinates of the frame's
/// axis, and three diattenuations of three numbers.
#[derive(Clone, Copy, Debug)]
pub struct Extra8([F32x8; 15]);

const AXIS: usize = 3;
const RGB: usize = 6;

impl Extra8 {
    /// Returns the extras of rays in `dir` that start at the camera or at depolarising surfaces.
    #[must_use]
    pub fn fresh(dir: Vec3x8) -> Self {
        let mut all = [F32x8::ZERO; 15];
        all[..AXIS].fill(F32x8::splat(super::budget::WHOLE));
        let axis = any_across(dir);
        (all[AXIS], all[AXIS + 1], all[AXIS + 2]) = (axis.x, axis.y, axis.z);
        Self(all)
    }

    /// Returns the budgets, as defined in [`super::budget`].
    #[inline(always)]
    #[must_use]
    pub fn budget(&self) -> Rgb8 {
        Vector3::new(self.0[0], self.0[1], self.0[2])
    }

    /// Sets the budgets.
    #[inline(always)]
    pub fn set_budget(&mut self, budget: Rgb8) {
        (self.0[0], self.0[1], self.0[2]) = (budget.x, budget.y, budget.z);
    }

    fn axis(&self) -> Vec3x8 {
        Vector3::new(self.0[AXIS], self.0[AXIS + 1], self.0[AXIS + 2])
    }

    fn set_axis(&mut self, axis: Vec3x8) {
        (self.0[AXIS], self.0[AXIS + 1], self.0[AXIS + 2]) = (axis.x, axis.y, axis.z);
    }

    fn channel(&self, c: usize) -> Diattenuation<F32x8> {
        let at = RGB + 3 * c;
        Diattenuation { q: self.0[at], u: self.0[at + 1], v: self.0[at + 2] }
    }

    fn set_channel(&mut self, c: usize, to: Diattenuation<F32x8>) {
        let at = RGB + 3 * c;
        (self.0[at], self.0[at + 1], self.0[at + 2]) = (to.q, to.u, to.v);
    }

    /// Returns the extras in the frames of the planes of incidence at surfaces with these normals.
    #[must_use]
    pub fn facing(&self, dir: Vec3x8, normal: Vec3x8) -> Self {
        let plane = PlaneOfIncidence::of_incidence(dir, self.axis(), normal);
        let mut turned = *self;
        turned.set_axis(plane.s);
        (0..3).for_each(|c| turned.set_channel(c, self.channel(c).in_plane(&plane)));
        turned
    }

    /// Returns the factors by which surfaces multiply the weights.
    #[must_use]
    pub fn gain(&self, surface: &[Mueller<F32x8>; 3]) -> Rgb8 {
        let [r, g, b] = std::array::from_fn(|c| self.channel(c).gain(&surface[c]));
        Vector3::new(r, g, b)
    }

    /// Returns the extras after surfaces, in the surfaces' frames.
    #[must_use]
    pub fn then(&self, surface: &[Mueller<F32x8>; 3]) -> Self {
        let mut on = *self;
        (0..3).for_each(|c| on.set_channel(c, self.channel(c).then(&surface[c])));
        on
    }

    /// Returns the extras of the rays that leave in `dir`.
    #[must_use]
    pub fn along(&self, dir: Vec3x8) -> Self {
        let mut on = *self;
        on.set_axis(made_across(self.axis(), dir));
        on
    }

    /// Copies lane `from` of `other` to lane `to`.
    #[inline(always)]
    pub fn put(&mut self, to: usize, other: &Self, from: usize) {
        for (mine, theirs) in self.0.iter_mut().zip(&other.0) {
            mine.set_lane(to, theirs.lane(from));
        }
    }
}

impl Default for Extra8 {
    fn default() -> Self {
        Self::fresh(Vec3x8::splat(Vec3::Z))
    }
}
