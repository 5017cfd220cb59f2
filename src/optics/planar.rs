//! Reflection in a plane as a matrix.

use crate::math::{Real, Vector3};

/// Affine map that mirrors space in a plane: three rows of four numbers, without the last row `0 0 0 1`.
///
/// As in the slides on mirrors: `1 - 2 V V^T`, and `2 (P . V) V` in the fourth column, for the plane through the point
/// `P` with the normal `V`. The slides do not say that `V` must be of unit length; with any other length the map
/// scales, too. [`PlanarReflection::new`] normalises it. (For a plane given as `V . x = d`, the column is `2 d V`.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarReflection<R> {
    /// Rows of the matrix. A point is the column `(x, y, z, 1)`, a direction `(x, y, z, 0)`.
    pub rows: [[R; 4]; 3],
}

impl<R: Real> PlanarReflection<R> {
    /// Creates the mirror through `point` across `normal`, of any length but 0. If the squared length is not a number
    /// above 0, the result is the identity.
    #[must_use]
    pub fn new(point: Vector3<R>, normal: Vector3<R>) -> Self {
        let length2 = normal.length_squared();
        let usable = length2.gt(R::zero()) & length2.lt(R::splat(f64::INFINITY));
        let v = Vector3::select(usable, normal.normalized(), Vector3::all(R::zero()));
        let two = R::splat(2.0);
        let shift = two * point.dot(v);
        let row = |i: usize, a: R| {
            let mut row = [-(two * a * v.x), -(two * a * v.y), -(two * a * v.z), shift * a];
            row[i] = row[i] + R::one();
            row
        };
        Self { rows: [row(0, v.x), row(1, v.y), row(2, v.z)] }
    }

    /// The map that changes nothing.
    #[must_use]
    pub fn identity() -> Self {
        let row = |i: usize| std::array::from_fn(|k| if k == i { R::one() } else { R::zero() });
        Self { rows: [row(0), row(1), row(2)] }
    }

    /// Returns the map that mirrors by `first` and then by this one: a mirror seen in a mirror. An even number of
    /// mirrors keeps the winding of triangles, an odd number flips it.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        let [x, y, z] = first.rows;
        let row = |r: [R; 4]| {
            let sum = |k: usize| r[2].fma(z[k], r[1].fma(y[k], r[0] * x[k]));
            [sum(0), sum(1), sum(2), sum(3) + r[3]]
        };
        Self { rows: self.rows.map(row) }
    }

    /// Returns the determinant of the linear part: -1 for an odd number of reflections, which flip winding, else 1.
    #[must_use]
    pub fn determinant(&self) -> R {
        let [x, y, z] = self.rows.map(|[a, b, c, _]| Vector3::new(a, b, c));
        x.dot(y.cross(z))
    }

    /// Returns the mirror image of a point.
    #[inline(always)]
    #[must_use]
    pub fn point(&self, p: Vector3<R>) -> Vector3<R> {
        self.map(|[x, y, z, w]| z.fma(p.z, y.fma(p.y, x.fma(p.x, w))))
    }

    /// Returns the mirror image of a direction: [`super::reflect`], as a matrix.
    #[inline(always)]
    #[must_use]
    pub fn direction(&self, d: Vector3<R>) -> Vector3<R> {
        self.map(|[x, y, z, _]| z.fma(d.z, y.fma(d.y, x * d.x)))
    }

    #[inline(always)]
    fn map(&self, row: impl Fn([R; 4]) -> R) -> Vector3<R> {
        let [x, y, z] = self.rows;
        Vector3::new(row(x), row(y), row(z))
    }
}
