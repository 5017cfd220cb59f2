//! The mirror direction, by the vector and by the matrix.

use super::oracle::{V, d, mirror, narrow};
use super::sample::{Rng, bits, narrow as to_f32, widen};
use vitrum::math::{UNIT_ROUNDOFF, Vector3};
use vitrum::optics::{PlanarReflection, reflect};

fn pair(rng: &mut Rng) -> (Vector3<f32>, Vector3<f32>) {
    let (i, n) = (rng.direction(), rng.direction());
    let n = if i.dot(n) > 0.0 { -n } else { n };
    (to_f32(i), to_f32(n))
}

/// Cases RV-01, RV-07 of the catalogue.
#[test]
fn known_mirror_directions_come_out_to_the_bit() {
    let (s, c) = (0.6_f32, 0.8_f32);
    let up = Vector3::new(0.0, 1.0, 0.0);
    assert_eq!(reflect(Vector3::new(s, -c, 0.0), up), Vector3::new(s, c, 0.0));
    // Head on, along each axis.
    for n in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
        let n = Vector3::new(n[0], n[1], n[2]);
        assert_eq!(reflect(-n, n), n);
        assert_eq!(reflect(n, -n), -n);
    }
}

/// Case RV-06 of the catalogue.
#[test]
fn the_mirror_direction_is_within_its_bounds() {
    let mut rng = Rng::new(1);
    let u = f64::from(UNIT_ROUNDOFF);
    let (mut component, mut angle, mut length, mut involution) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..200_000 {
        let (i, n) = pair(&mut rng);
        let r = reflect(i, n);
        let as_given = mirror(V::of(i), V::of(n));
        for (got, want) in [r.x, r.y, r.z].into_iter().zip(as_given.0) {
            component = component.max(narrow(d(got) - want).abs());
        }
        angle = angle.max(mirror(V::of(i).unit(), V::of(n).unit()).angle_to(r));
        length = length.max((widen(r).length() - 1.0).abs());
        let back = widen(reflect(r, n)) - widen(i);
        involution = involution.max(back.abs().max_component());
    }
    println!(
        "reflect: component {:.1} u, angle {angle:.1e} rad, length {length:.1e}, involution {involution:.1e}",
        component / u
    );
    assert!(component <= 4.0 * u, "component {component:e}");
    assert!(angle <= 3.4e-7, "angle {angle:e}");
    assert!(length <= 5.8e-7, "length {length:e}");
    assert!(involution <= 1e-6, "involution {involution:e}");
}

/// Case RV-02 of the catalogue.
#[test]
fn length_drifts_no_further_than_stated_and_not_at_all_when_renormalised() {
    let mut rng = Rng::new(2);
    let mut worst = [0.0_f64; 3];
    let mut renormalised = 0.0_f64;
    for _ in 0..2_000 {
        let (i, _) = pair(&mut rng);
        let (mut free, mut kept) = (i, i);
        for bounce in 1..=1000 {
            let n = to_f32(rng.direction());
            free = reflect(free, n);
            kept = reflect(kept, n).normalized();
            let off = (widen(free).length() - 1.0).abs();
            if let Some(k) = [10, 100, 1000].iter().position(|&b| b == bounce) {
                worst[k] = worst[k].max(off);
            }
            renormalised = renormalised.max((widen(kept).length() - 1.0).abs());
        }
    }
    println!(
        "reflect: length drift {:.1e} {:.1e} {:.1e} after 10, 100, 1000 bounces; renormalised {renormalised:.1e}",
        worst[0], worst[1], worst[2]
    );
    assert!(worst[0] <= 1.4e-6 && worst[1] <= 5e-6 && worst[2] <= 3e-5, "{worst:?}");
    assert!(renormalised <= 1.9e-7, "{renormalised:e}");
}

/// Case RV-01 of the catalogue.
#[test]
fn the_printed_formula_for_an_incident_vector_grows_it_up_to_threefold() {
    // v + 2 (n . v) n is right only for a v that points back along the ray, and then it is -reflect(-v).
    let as_printed = |v: Vector3<f64>, n: Vector3<f64>| v + n * (2.0 * n.dot(v));
    let n = Vector3::new(0.0, 0.0, 1.0);
    let at = |degrees: f64| Vector3::new(degrees.to_radians().sin(), 0.0, -degrees.to_radians().cos());
    assert!((as_printed(at(45.0), n).length() - 5.0_f64.sqrt()).abs() < 1e-12);
    assert!((as_printed(at(0.0), n).length() - 3.0).abs() < 1e-12);
    assert!((reflect(at(45.0), n).length() - 1.0).abs() < 1e-12);
}

#[test]
fn the_matrix_is_the_vector_form_and_its_own_inverse() {
    let mut rng = Rng::new(3);
    for _ in 0..10_000 {
        let (i, n) = pair(&mut rng);
        let point = rng.direction() * 5.0;
        let (i, n) = (widen(i), widen(n).normalized());
        // Any length of normal will do.
        let mirror = PlanarReflection::new(point, n * rng.between(0.01, 100.0));
        let off = mirror.direction(i) - reflect(i, n);
        assert!(off.abs().max_component() < 1e-14);
        let p = rng.direction() * 3.0;
        let image = mirror.point(p);
        // The midpoint lies in the plane, the connection along the normal, and the image of the image is the point.
        let midpoint = (p + image) * 0.5 - point;
        assert!(midpoint.dot(n).abs() < 1e-13);
        assert!((image - p).cross(n).length() < 1e-13);
        assert!((mirror.point(image) - p).length() < 1e-13);
        assert!((mirror.point(point) - point).length() < 1e-13);
    }
}

#[test]
fn the_matrix_matches_the_printed_one_entry_by_entry() {
    // Plane z = 2: x and y stay, z becomes 4 - z.
    let up = PlanarReflection::<f32>::new(Vector3::new(7.0, -3.0, 2.0), Vector3::new(0.0, 0.0, 1.0));
    assert_eq!(up.rows, [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 4.0]]);
    let v = Vector3::new(0.6_f64, 0.0, 0.8);
    let tilted = PlanarReflection::new(Vector3::new(1.0, 1.0, 1.0), v);
    let want = [[0.28, 0.0, -0.96, 1.68], [0.0, 1.0, 0.0, 0.0], [-0.96, 0.0, -0.28, 2.24]];
    for (got, want) in tilted.rows.iter().flatten().zip(want.iter().flatten()) {
        assert!((got - want).abs() < 1e-14, "{got} is not {want}");
    }
    // As printed, a V twice as long scales space sevenfold along it.
    let long = Vector3::new(0.0, 0.0, 2.0);
    assert_eq!(1.0 - 2.0 * long.z * long.z, -7.0);
    for bad in [0.0, f64::NAN, f64::INFINITY] {
        let none = PlanarReflection::new(Vector3::all(1.0), Vector3::new(bad, 0.0, 0.0));
        let p = Vector3::new(1.0, 2.0, 3.0);
        assert_eq!(none.point(p), p, "a normal of {bad} mirrors nothing");
    }
    let p = Vector3::new(0.1_f32, 0.2, 0.3);
    assert_eq!(bits(PlanarReflection::new(p, Vector3::all(0.0)).point(p)), bits(p));
}
