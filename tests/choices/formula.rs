//! A formula is added in one place: its type, and its line in `choice!`. `tests/add-formula` does the same to a copy of the
//! program's own list.

use glam::DVec3;
use vitrum::choice::{Choice as _, Unreadable};
use vitrum::math::{LaneMask as _, Real, Vector3};
use vitrum::optics::{Boundary, Crossing, Refracted, RefractionFormula, Stable};
use vitrum::simd::F32x8;

/// Refraction for small angles: `tan(th_t) = eta sin(th_i)`. Never total.
#[derive(Clone, Copy, Debug, Default)]
struct Paraxial;

impl RefractionFormula for Paraxial {
    fn refract<R: Real>(
        self,
        boundary: &Boundary<R>,
        incident: Vector3<R>,
        normal: Vector3<R>,
        at: &Crossing<R>,
    ) -> Refracted<R> {
        let along = normal.fma(at.cos_i, incident) * boundary.eta - normal;
        Refracted { direction: along * (R::one() / along.length_squared().sqrt()), total: R::Mask::splat(false) }
    }
}

vitrum::choice! {
    /// Formula for the direction of refracted light.
    enum Model("refraction", default(Stable), visitor(Visitor, RefractionFormula)) {
        /// Snell's law.
        "stable" => Stable by Stable,
        /// Snell's law for small angles.
        "paraxial" | "small" => Paraxial by Paraxial,
    }
}

/// Refracts a ray that arrives at the sine 0.6 from air into glass of index 1.5, in any number type.
struct IntoGlass<R>(std::marker::PhantomData<R>);

impl<R: Real> Visitor for IntoGlass<R> {
    type Output = Refracted<R>;

    fn visit<F: RefractionFormula>(self, formula: F) -> Refracted<R> {
        let vector = |x: f64, y: f64| Vector3::new(R::splat(x), R::splat(y), R::zero());
        let boundary = Boundary::new(1.0, 1.5);
        let (incident, normal) = (vector(0.6, -0.8), vector(0.0, 1.0));
        formula.refract(&boundary, incident, normal, &boundary.cross(R::splat(0.8)))
    }
}

#[test]
fn a_formula_is_named_read_and_dispatched_by_its_one_line() {
    assert_eq!(Model::parse("small"), Ok(Model::Paraxial));
    assert_eq!(Model::parse("paraxial=2"), Err(Unreadable::Name));
    assert_eq!(
        (Model::Paraxial.to_string(), Model::Paraxial.help()),
        ("paraxial".into(), "Snell's law for small angles".into())
    );
    assert_eq!((Model::compared(), Model::default()), (vec![Model::Stable, Model::Paraxial], Model::Stable));

    // tan(th_t) = 0.6 / 1.5 = 0.4, where Snell's law has the sine 0.4.
    let single = Model::Paraxial.dispatch(IntoGlass::<f64>(std::marker::PhantomData));
    assert!((single.direction.x / -single.direction.y - 0.4).abs() < 1e-15 && !single.total);
    let exact = Model::Stable.dispatch(IntoGlass::<f64>(std::marker::PhantomData));
    assert!((exact.direction.x - 0.4).abs() < 1e-15);
    let eight = Model::Paraxial.dispatch(IntoGlass::<F32x8>(std::marker::PhantomData)).direction;
    for lane in 0..8 {
        let apart =
            eight.lane(lane).as_dvec3() - DVec3::new(single.direction.x, single.direction.y, single.direction.z);
        assert!(apart.abs().max_element() < 1e-6, "lane {lane}: {apart}");
    }
}
