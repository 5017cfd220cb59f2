//! Refraction by a vector sum.

use super::formula::{Refracted, RefractionFormula};
use crate::choice::Constant;
use crate::math::{Real, Vector3};
use crate::optics::boundary::{Boundary, Crossing};

/// Oliveira's approximation, as in the textbook section (equation 6.28): `t = i - c n`, normalised, with a constant `c`
/// for a medium entered from air; `tan(th_t) = sin(th_i) / (cos(th_i) + c)`.
///
/// The book's "somewhere around 1.0" for water ([`Oliveira::AS_PRINTED`]) gives exactly half the angle of incidence: an
/// error of 7.1 degrees at 30 and 10.6 at 60. [`Oliveira::first_order`] is exact at small angles (error 0.6 degrees at
/// 30, 5.6 at 60). [`Oliveira::WATER`] and [`Oliveira::GLASS`] minimise the largest error up to 60 degrees, which is
/// 1.4.
///
/// The formula depends on the indices only by which one is larger. `c` is for the way into the denser medium. The book
/// does not treat the way out: here it uses `-c / (1 + c)`, which inverts the formula at small angles. A direction that
/// would turn back to the incident side counts as total reflection. Equal indices leave `incident` unchanged to the
/// bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oliveira {
    /// Constant for entering, above -1: around 0.3 to 1.5, growing with the index ratio.
    pub c: f64,
}

impl Oliveira {
    /// The book's constant for water: the refracted angle is half the angle of incidence.
    pub const AS_PRINTED: Self = Self { c: 1.0 };
    /// Constant of the smallest maximum error up to 60 degrees for index 1.33: 1.43 degrees.
    pub const WATER: Self = Self { c: 0.46 };
    /// Constant of the smallest maximum error up to 60 degrees for index 1.5: 1.38 degrees.
    pub const GLASS: Self = Self { c: 0.6645 };

    /// Returns `n2 / n1 - 1`, which is exact to first order in the angle, on the way from index `n1` into the denser
    /// `n2`.
    #[must_use]
    pub fn first_order(n1: f64, n2: f64) -> Self {
        Self { c: n2 / n1 - 1.0 }
    }
}

impl Default for Oliveira {
    fn default() -> Self {
        Self::GLASS
    }
}

impl Constant for Oliveira {
    const RANGE: &'static str = "a finite number above -1";
    const NOTED: &'static [Self] = &[Self::AS_PRINTED, Self::WATER, Self::GLASS];

    fn number(self) -> f64 {
        self.c
    }

    fn of(c: f64) -> Option<Self> {
        (c > -1.0 && c.is_finite()).then_some(Self { c })
    }
}

impl RefractionFormula for Oliveira {
    fn with_constant(constant: Option<f64>) -> Self {
        constant.map_or_else(Self::default, |c| Self { c })
    }

    #[inline(always)]
    fn refract<R: Real>(
        self,
        boundary: &Boundary<R>,
        incident: Vector3<R>,
        normal: Vector3<R>,
        at: &Crossing<R>,
    ) -> Refracted<R> {
        let zero = R::zero();
        let leaving = boundary.kc.gt(zero);
        // `c` = -1 has no inverse (it stands for an index of 0), so light goes on unchanged.
        let back = if self.c == -1.0 { 0.0 } else { -self.c / (1.0 + self.c) };
        let c = R::select(leaving, R::splat(back), R::splat(self.c));
        let sum = (-normal).fma(c, incident);
        let length2 = sum.length_squared();
        // `c` = -1 at normal incidence gives a zero vector.
        let as_it_was = boundary.kc.eq(zero) | length2.le(zero);
        let length = R::select(as_it_was, R::one(), length2.sqrt());
        let direction = Vector3::select(as_it_was, incident, sum * (R::one() / length));
        Refracted { direction, total: (at.cos_i + c).le(zero) & !as_it_was }
    }
}
