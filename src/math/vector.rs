//! Three-vectors over any [`Real`].

use std::ops::{Add, Mul, Neg, Sub};

use super::real::Real;

/// A vector of three components. `simd::Vec3x8` has eight lanes in each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Vector3<R> {
    /// First component.
    pub x: R,
    /// Second component.
    pub y: R,
    /// Third component.
    pub z: R,
}

impl<R> Vector3<R> {
    /// A vector from its components.
    #[inline(always)]
    pub const fn new(x: R, y: R, z: R) -> Self {
        Self { x, y, z }
    }
}

impl<R: Real> Vector3<R> {
    /// The same number in all three components.
    #[inline(always)]
    pub fn all(value: R) -> Self {
        Self::new(value, value, value)
    }

    /// Scalar product, as a chain of fused products in the order x, y, z.
    #[inline(always)]
    pub fn dot(self, o: Self) -> R {
        self.z.fma(o.z, self.y.fma(o.y, self.x * o.x))
    }

    /// Vector product, each component by Kahan's difference of products: within 1.5 ulp where products are fused
    /// (Jeannerod, Louvet & Muller 2013).
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self::new(
            difference_of_products(self.y, o.z, self.z, o.y),
            difference_of_products(self.z, o.x, self.x, o.z),
            difference_of_products(self.x, o.y, self.y, o.x),
        )
    }

    /// Squared length.
    #[inline(always)]
    pub fn length_squared(self) -> R {
        self.dot(self)
    }

    /// Length.
    #[inline(always)]
    pub fn length(self) -> R {
        self.length_squared().sqrt()
    }

    /// The vector divided by its length. NaN or infinite if the length is zero or overflows; test
    /// [`Vector3::length_squared`] first if that can happen.
    #[inline(always)]
    pub fn normalized(self) -> Self {
        self * (R::one() / self.length())
    }

    /// Componentwise product.
    #[inline(always)]
    pub fn times(self, o: Self) -> Self {
        Self::new(self.x * o.x, self.y * o.y, self.z * o.z)
    }

    /// `self * s + o`, fused per component.
    #[inline(always)]
    pub fn fma(self, s: R, o: Self) -> Self {
        Self::new(self.x.fma(s, o.x), self.y.fma(s, o.y), self.z.fma(s, o.z))
    }

    /// Componentwise magnitude.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self::new(self.x.abs(), self.y.abs(), self.z.abs())
    }

    /// The largest component.
    #[inline(always)]
    pub fn max_component(self) -> R {
        self.x.max(self.y).max(self.z)
    }

    /// `yes` where `mask` is true, else `no`, in all three components.
    #[inline(always)]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self::new(R::select(mask, yes.x, no.x), R::select(mask, yes.y, no.y), R::select(mask, yes.z, no.z))
    }
}

/// `a b - c d`, corrected by the rounding error of `c d`.
#[inline(always)]
fn difference_of_products<R: Real>(a: R, b: R, c: R, d: R) -> R {
    let cd = c * d;
    let error = (-c).fma(d, cd);
    a.fma(b, -cd) + error
}

impl<R: Real> Add for Vector3<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl<R: Real> Sub for Vector3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}

impl<R: Real> Mul<R> for Vector3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: R) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}

impl<R: Real> Neg for Vector3<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl From<glam::Vec3> for Vector3<f32> {
    fn from(v: glam::Vec3) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

impl From<glam::DVec3> for Vector3<f64> {
    fn from(v: glam::DVec3) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

impl From<Vector3<f32>> for glam::Vec3 {
    fn from(v: Vector3<f32>) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

impl From<Vector3<f64>> for glam::DVec3 {
    fn from(v: Vector3<f64>) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}
