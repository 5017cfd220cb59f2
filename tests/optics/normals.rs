//! Shading normals that never send light through the surface.

use super::sample::{Rng, bits, narrow, widen};
use vitrum::math::Vector3;
use vitrum::optics::{Boundary, below_surface, consistent_normal, reflect};

const LEAST: f64 = 1.0 / 1024.0;
/// Rounding of the sum of three products of unit vectors.
const ROUNDING: f64 = 3e-7;

fn length_off(v: Vector3<f32>) -> f64 {
    (widen(v).length() - 1.0).abs()
}

/// A direction of travel that comes down on the surface at a sine of `sine`, the geometric normal, and a shading normal
/// somewhere on the geometric one's side.
fn surface(rng: &mut Rng, sine: f64) -> (Vector3<f32>, Vector3<f32>, Vector3<f32>) {
    let (i, g) = rng.meeting_at(sine.acos());
    let s = rng.direction();
    let s = if s.dot(widen(g)) < 0.0 { -s } else { s };
    (i, g, narrow(s))
}

/// Cases RV-04, RV-05 of the catalogue.
#[test]
fn the_mirror_direction_about_a_consistent_normal_rises() {
    let mut rng = Rng::new(21);
    let (mut untouched, mut bent) = (0, 0);
    for k in 0..300_000 {
        let sine = if k % 2 == 0 { rng.unit() } else { 10.0_f64.powf(rng.between(-12.0, 0.0)) };
        let (i, g, s) = surface(&mut rng, sine);
        let n = consistent_normal(i, g, s);
        let comes_down = -widen(i).dot(widen(g));
        let least = LEAST.min(comes_down);
        let rise = widen(reflect(i, n)).dot(widen(g));
        if bits(n) == bits(s) {
            assert!(rise >= least - ROUNDING, "{i:?} {g:?} {s:?}: {rise:e}");
            untouched += 1;
        } else {
            assert!(rise >= 0.5 * least - ROUNDING, "{i:?} {g:?} {s:?}: {rise:e} of {least:e}");
            let asked = widen(reflect(i, s)).dot(widen(g));
            assert!(asked < least + ROUNDING, "it did not need it");
            assert!(widen(i).dot(widen(n)) <= ROUNDING, "it faces the ray");
            assert!(length_off(n) <= 4e-7, "{}", length_off(n));
            bent += 1;
        }
    }
    assert!(untouched > 10_000 && bent > 10_000, "both must occur: {untouched}, {bent}");
}

#[test]
fn a_bent_normal_is_bent_no_further_than_needed() {
    let mut rng = Rng::new(22);
    let mut seen = 0;
    while seen < 20_000 {
        // Well away from grazing, where the geometric normal takes over.
        let sine = rng.between(0.05, 1.0);
        let (i, g, s) = surface(&mut rng, sine);
        let n = consistent_normal(i, g, s);
        if bits(n) != bits(s) {
            let rise = widen(reflect(i, n)).dot(widen(g));
            assert!((rise - LEAST).abs() <= 1e-5, "{i:?} {g:?} {s:?}: {rise:e}");
            seen += 1;
        }
    }
}

#[test]
fn a_normal_that_needs_no_bending_comes_back_to_the_bit() {
    let mut rng = Rng::new(23);
    for _ in 0..10_000 {
        let sine = rng.between(0.1, 1.0);
        let (i, g) = rng.meeting_at(sine.acos());
        assert_eq!(bits(consistent_normal(i, g, g)), bits(g));
    }
}

/// Case RV-03 of the catalogue.
#[test]
fn degenerate_inputs_give_a_finite_normal_of_unit_length() {
    let g = Vector3::new(0.0_f32, 0.0, 1.0);
    let nan = Vector3::all(f32::NAN);
    let shadings = [
        g,
        -g,
        Vector3::new(1.0, 0.0, 0.0),
        Vector3::new(-1.0, 0.0, 0.0),
        Vector3::new(0.1, 0.0, 0.995),
        Vector3::new(-0.1, 0.0, 0.995),
        Vector3::new(std::f32::consts::FRAC_1_SQRT_2, 0.0, -std::f32::consts::FRAC_1_SQRT_2),
        Vector3::all(0.0),
        Vector3::all(1e-30),
        Vector3::all(1e30),
        nan,
    ];
    let incidents = [0.0_f32, -0.0, 1e-45, 1e-20, 1e-8, 1e-6, 1e-4, 0.001, 0.5, 1.0]
        .map(|down| Vector3::new((1.0 - down * down).sqrt(), 0.0, -down));
    for i in incidents {
        for s in shadings {
            let n = consistent_normal(i, g, s);
            let untouched = bits(n) == bits(s);
            assert!(n.x.is_finite() && n.y.is_finite() && n.z.is_finite(), "{i:?} {s:?}: {n:?}");
            assert!(untouched || length_off(n) <= 4e-7, "{i:?} {s:?}: {n:?}");
            if length_off(n) < 1e-3 {
                let rise = f64::from(reflect(i, n).z);
                assert!(rise >= 0.5 * LEAST.min(f64::from(-i.z)) - ROUNDING, "{i:?} {s:?}: {rise:e}");
            }
        }
    }
}

#[test]
fn a_refracted_direction_sinks_below_the_surface() {
    let mut rng = Rng::new(24);
    let (mut untouched, mut bent) = (0, 0);
    for k in 0..200_000 {
        let g = narrow(rng.direction());
        let t = if k % 2 == 0 {
            narrow(rng.direction())
        } else {
            let across = widen(g).cross(rng.direction()).normalized();
            narrow((across + widen(g) * rng.between(-2.0 * LEAST, 2.0 * LEAST)).normalized())
        };
        let lowered = below_surface(t, g);
        let sinks = -widen(lowered).dot(widen(g));
        // Of what points nearly straight up rounding spoils the bearing.
        let up = widen(t).dot(widen(g)) > 0.9;
        assert!(sinks >= if up { 0.5 * LEAST } else { LEAST - ROUNDING }, "{t:?} {g:?}: {sinks:e}");
        if bits(lowered) == bits(t) {
            untouched += 1;
        } else {
            assert!(-widen(t).dot(widen(g)) <= LEAST + ROUNDING, "it did not need it");
            assert!(length_off(lowered) <= 4e-7);
            bent += 1;
        }
    }
    assert!(untouched > 10_000 && bent > 10_000, "both must occur: {untouched}, {bent}");
}

#[test]
fn degenerate_refracted_directions_end_below_the_surface_too() {
    let g = Vector3::new(0.0_f32, 0.0, 1.0);
    for t in [g, -g, Vector3::all(0.0), Vector3::all(f32::NAN), Vector3::new(f32::INFINITY, 0.0, 0.0)] {
        let lowered = below_surface(t, g);
        assert!(lowered.z < 0.0 && length_off(lowered) <= 4e-7, "{t:?}: {lowered:?}");
    }
    // What total reflection leaves is finite, whatever is made of it.
    let boundary = Boundary::<f32>::new(1.5, 1.0);
    for c in [0.0, 1e-20, 0.5] {
        let i = Vector3::new((1.0_f32 - c * c).sqrt(), 0.0, -c);
        let at = boundary.cross(c);
        assert!(at.total);
        let t = boundary.refract(i, g, &at);
        assert!(t.x.is_finite() && t.y.is_finite() && t.z.is_finite());
    }
}
