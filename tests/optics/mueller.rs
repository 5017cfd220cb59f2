//! Polarisation along a path: answers known by hand, and whole paths against the electric field carried through them.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::ops::{Add, Div, Mul, Sub};

use super::sample::{Rng, narrow};
use vitrum::math::{Real, Vector3};
use vitrum::optics::{
    Boundary, Diattenuation, Exact, FresnelFormula, Mueller, PlaneOfIncidence, any_across, conductor_exact,
    made_across, polarised, reflect, thin_reflectance,
};

fn face<R: Real>(n1: f64, n2: f64, cos_i: f64) -> Mueller<R> {
    let boundary = Boundary::new(n1, n2);
    Mueller::reflected(&boundary, &boundary.cross(R::splat(cos_i)))
}

/// The plane at `turn` radians from the frame's axis.
fn turned(turn: f64) -> PlaneOfIncidence<f64> {
    let (sin2, cos2) = (2.0 * turn).sin_cos();
    PlaneOfIncidence { s: Vector3::new(1.0, 0.0, 0.0), cos2, sin2 }
}

/// Returns the intensity of unpolarised light after two reflections at Brewster's angle, with the second plane turned
/// from the first.
fn two_brewster_mirrors(turn: f64) -> f64 {
    let mirror = face::<f64>(1.0, 1.5, (1.5_f64).atan().cos());
    let start = Diattenuation::none();
    let first = start.gain(&mirror);
    first * start.then(&mirror).in_plane(&turned(turn)).gain(&mirror)
}

#[test]
fn two_mirrors_at_brewsters_angle_with_crossed_planes_reflect_nothing_and_with_aligned_ones_half_of_r_s_squared() {
    let r_s = ((1.5_f64.powi(2) - 1.0) / (1.5_f64.powi(2) + 1.0)).powi(2);
    assert!(two_brewster_mirrors(FRAC_PI_2).abs() < 1e-16, "{}", two_brewster_mirrors(FRAC_PI_2));
    assert!((two_brewster_mirrors(0.0) - 0.5 * r_s * r_s).abs() < 1e-15);
    // Without polarisation both would be a quarter of it.
    let unpolarised = (0.5 * r_s).powi(2);
    assert!((two_brewster_mirrors(FRAC_PI_4) - unpolarised).abs() < 1e-15);
}

#[test]
fn between_crossed_and_aligned_malus_law_holds() {
    for i in 0..=90 {
        let turn = f64::from(i).to_radians();
        let want = two_brewster_mirrors(0.0) * turn.cos().powi(2);
        assert!((two_brewster_mirrors(turn) - want).abs() < 1e-15, "at {i} degrees");
    }
}

#[test]
fn fresnels_rhomb_turns_linear_polarisation_into_circular() {
    // Crown glass of 1.51: two total reflections at 54.6 degrees put p behind s by 90 (Born & Wolf, section 1.5.4).
    let angle = f64::to_radians(54.6167);
    let inner = face::<f64>(1.51, 1.0, angle.cos());
    assert_eq!((inner.a, inner.b), (1.0, 0.0));
    let diagonal = Diattenuation { q: 0.0, u: 1.0, v: 0.0 };
    let circular = diagonal.then(&inner).then(&inner);
    assert!(circular.q.abs() < 1e-12 && circular.u.abs() < 1e-3, "{circular:?}");
    assert!((circular.v.abs() - 1.0).abs() < 1e-6, "{circular:?}");
    // Each reflection shifts by 45 degrees.
    let half_shift = (angle.cos() * (angle.sin().powi(2) - 1.51_f64.powi(-2)).sqrt() / angle.sin().powi(2)).atan();
    assert!((inner.d.atan2(inner.c) - 2.0 * half_shift).abs() < 1e-12);
    assert!((2.0 * half_shift - FRAC_PI_4).abs() < 1e-4);
    // Behind it, an analyser passes the same at every angle.
    for i in 0..8 {
        let at = circular.in_plane(&turned(f64::from(i) * PI / 8.0));
        let mirror = face::<f64>(1.0, 1.5, 1.5_f64.atan().cos());
        assert!((at.gain(&mirror) / mirror.a - 1.0).abs() < 1e-3);
    }
}

#[test]
fn one_bounce_of_unpolarised_light_is_the_unpolarised_formula_to_the_bit() {
    let mut rng = Rng::new(1);
    for _ in 0..20_000 {
        let (n1, n2, c) = (rng.between(1.0, 2.5), rng.between(1.0, 2.5), rng.unit() as f32);
        let boundary = Boundary::<f32>::new(n1, n2);
        let at = boundary.cross(c);
        let mueller = Mueller::reflected(&boundary, &at);
        assert_eq!(Diattenuation::none().gain(&mueller).to_bits(), Exact::dielectric(&boundary, &at).to_bits());
        let parts = polarised(&boundary, &at);
        assert!((mueller.a + mueller.b - parts.s).abs() < 3e-7 && (mueller.a - mueller.b - parts.p).abs() < 3e-7);
        let (eta, k) = (rng.between(0.05, 3.0) as f32, rng.between(0.0, 6.0) as f32);
        assert_eq!(Mueller::metal(c, eta, k).a.to_bits(), conductor_exact(c, eta, k).to_bits());
    }
}

#[test]
fn nothing_is_lost_at_a_boundary_in_either_polarisation_and_no_polarisation_exceeds_the_light() {
    let mut rng = Rng::new(2);
    for _ in 0..20_000 {
        let (n1, n2, c) = (rng.between(1.0, 2.5), rng.between(1.0, 2.5), rng.unit());
        let boundary = Boundary::<f64>::new(n1, n2);
        let at = boundary.cross(c);
        let (back, on) = (Mueller::reflected(&boundary, &at), Mueller::refracted(&boundary, &at));
        assert!((back.a + on.a - 1.0).abs() < 1e-12 && (back.b + on.b).abs() < 1e-12, "{n1} -> {n2} at {c}");
        let (pane_back, pane_on) = back.pane(at.total);
        assert!((pane_back.a + pane_on.a - 1.0).abs() < 1e-12 && (pane_back.b + pane_on.b).abs() < 1e-12);
        let metal = Mueller::metal(c, rng.between(0.05, 3.0), rng.between(0.0, 6.0));
        for m in [back, on, pane_back, pane_on, metal] {
            // A surface that adds no depolarisation: a^2 = b^2 + c^2 + d^2; a pane adds some.
            let rest = m.a * m.a - m.b * m.b - m.c * m.c - m.d * m.d;
            assert!(rest > -1e-12, "{m:?}");
            if m != pane_back && m != pane_on {
                assert!(rest.abs() < 1e-12, "{m:?}");
            }
        }
    }
}

#[test]
fn equal_indices_head_on_and_grazing_are_plain_answers() {
    let same = Boundary::<f32>::new(1.5, 1.5);
    for c in [0.0, 1e-20, 0.5, 1.0] {
        let at = same.cross(c);
        assert_eq!(Mueller::reflected(&same, &at), Mueller::none());
        assert_eq!(Mueller::refracted(&same, &at), Mueller::straight(1.0));
    }
    for (n1, n2) in [(1.0, 1.5), (1.5, 1.0)] {
        let boundary = Boundary::<f32>::new(n1, n2);
        let head_on = Mueller::reflected(&boundary, &boundary.cross(1.0));
        assert!((head_on.a - 0.04).abs() < 1e-7 && head_on.b.abs() < 1e-8 && (head_on.c + 0.04).abs() < 1e-7);
        let grazing = Mueller::reflected(&boundary, &boundary.cross(0.0));
        assert_eq!((grazing.a, grazing.b, grazing.d), (1.0, 0.0, 0.0));
        assert_eq!(grazing.c, 1.0);
        let (back, on) = grazing.pane(false);
        assert_eq!((back.a, on.a, on.c), (1.0, 0.0, 0.0));
    }
}

#[test]
fn a_pane_is_the_sum_of_its_inner_reflections() {
    for c in [1.0, 0.7, 0.3, 0.05] {
        let boundary = Boundary::<f64>::new(1.0, 1.5);
        let at = boundary.cross(c);
        let (face, into) = (Mueller::reflected(&boundary, &at), Mueller::refracted(&boundary, &at));
        let (back, on) = face.pane(false);
        let product = |x: &Mueller<f64>, y: &Mueller<f64>| Mueller {
            a: x.a * y.a + x.b * y.b,
            b: x.a * y.b + x.b * y.a,
            c: x.c * y.c - x.d * y.d,
            d: x.c * y.d + x.d * y.c,
        };
        let plus =
            |x: &Mueller<f64>, y: &Mueller<f64>| Mueller { a: x.a + y.a, b: x.b + y.b, c: x.c + y.c, d: x.d + y.d };
        let mut term = product(&into, &into);
        let (mut want_back, mut want_on) = (face, Mueller::none());
        for _ in 0..400 {
            want_on = plus(&want_on, &term);
            term = product(&term, &face);
            want_back = plus(&want_back, &term);
            term = product(&term, &face);
        }
        for (got, want) in [(back, want_back), (on, want_on)] {
            let off = [got.a - want.a, got.b - want.b, got.c - want.c, got.d - want.d];
            assert!(off.iter().all(|x| x.abs() < 1e-9), "{got:?} is not {want:?}");
        }
        // The unpolarised formula takes the mean of both faces before it sums, which is a little off.
        assert!((back.a - thin_reflectance(face.a)).abs() < 0.03);
        assert!(back.a <= thin_reflectance(face.a) + 1e-12);
    }
}

#[derive(Clone, Copy, Debug)]
struct Complex(f64, f64);

impl Complex {
    fn root(self) -> Self {
        // The root whose wave decays.
        let r = self.0.hypot(self.1);
        let (re, im) = (((r + self.0) / 2.0).max(0.0).sqrt(), ((r - self.0) / 2.0).max(0.0).sqrt());
        if self.1 < 0.0 { Self(-re, im) } else { Self(re, im) }
    }
    fn squared(self) -> f64 {
        self.0 * self.0 + self.1 * self.1
    }
}
impl Add for Complex {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self(self.0 + o.0, self.1 + o.1)
    }
}
impl Sub for Complex {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self(self.0 - o.0, self.1 - o.1)
    }
}
impl Mul for Complex {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self(self.0 * o.0 - self.1 * o.1, self.0 * o.1 + self.1 * o.0)
    }
}
impl Div for Complex {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let m = o.squared();
        Self((self.0 * o.0 + self.1 * o.1) / m, (self.1 * o.0 - self.0 * o.1) / m)
    }
}

/// The electric field, in space.
type Field = [Complex; 3];

fn along(field: &Field, axis: Vector3<f64>) -> Complex {
    let real = |x: f64| Complex(x, 0.0);
    field[0] * real(axis.x) + field[1] * real(axis.y) + field[2] * real(axis.z)
}

fn spread(s: Vector3<f64>, e_s: Complex, p: Vector3<f64>, e_p: Complex) -> Field {
    let one = |s: f64, p: f64| e_s * Complex(s, 0.0) + e_p * Complex(p, 0.0);
    [one(s.x, p.x), one(s.y, p.y), one(s.z, p.z)]
}

/// A surface on a path: the ray before and behind it, across its plane, and the field's factors (textbook signs, `p`
/// being `travel x s` on both sides).
struct Passage {
    before: Vector3<f64>,
    behind: Vector3<f64>,
    s: Vector3<f64>,
    factors: [Complex; 2],
}

/// Fresnel's amplitudes as textbooks print them, for light from index `n1` onto `n2`.
fn reflection_amplitudes(n1: f64, n2: Complex, cos_i: f64) -> [Complex; 2] {
    let real = |x: f64| Complex(x, 0.0);
    let n2_cos_t = (n2 * n2 - real(n1 * n1 * (1.0 - cos_i * cos_i))).root();
    let n2_2 = n2 * n2;
    let s = (real(n1 * cos_i) - n2_cos_t) / (real(n1 * cos_i) + n2_cos_t);
    // Both sides times n2: n2 cos_t is at hand, cos_t is not.
    let p = (n2_2 * real(cos_i) - real(n1) * n2_cos_t) / (n2_2 * real(cos_i) + real(n1) * n2_cos_t);
    [s, p]
}

fn transmission_amplitudes(n1: f64, n2: f64, cos_i: f64, cos_t: f64) -> [Complex; 2] {
    let flux = (n2 * cos_t / (n1 * cos_i)).sqrt();
    let s = 2.0 * n1 * cos_i / (n1 * cos_i + n2 * cos_t) * flux;
    let p = 2.0 * n1 * cos_i / (n2 * cos_i + n1 * cos_t) * flux;
    [Complex(s, 0.0), Complex(p, 0.0)]
}

/// Returns the intensity that unpolarised light has at the end of the path: the mean over two perpendicular fields,
/// sent in the direction of light.
fn by_the_field(path: &[Passage]) -> f64 {
    let last = path.last().unwrap().behind;
    let x = any_across(last);
    let y = last.cross(x);
    let mut seen = 0.0;
    for start in [x, y] {
        let mut field: Field = [Complex(start.x, 0.0), Complex(start.y, 0.0), Complex(start.z, 0.0)];
        for passage in path.iter().rev() {
            let (p_in, p_out) = ((-passage.behind).cross(passage.s), (-passage.before).cross(passage.s));
            let e_s = along(&field, passage.s) * passage.factors[0];
            let e_p = along(&field, p_in) * passage.factors[1];
            field = spread(passage.s, e_s, p_out, e_p);
        }
        seen += 0.5 * field.iter().map(|e| e.squared()).sum::<f64>();
    }
    seen
}

/// A random path of `n` surfaces: the gain by carried diattenuation in `f64` and in `f32`, and by the field.
fn random_path(rng: &mut Rng, n: usize) -> (f64, f32, f64) {
    let mut dir = rng.direction();
    let (mut axis, mut narrow_axis) = (any_across(dir), any_across(narrow(dir)));
    let (mut carried, mut narrow_carried) = (Diattenuation::<f64>::none(), Diattenuation::<f32>::none());
    let (mut gain, mut narrow_gain) = (1.0_f64, 1.0_f32);
    let mut path = Vec::new();
    for _ in 0..n {
        let normal = loop {
            let normal = rng.direction();
            if normal.dot(dir) < -0.02 {
                break normal;
            }
        };
        let cos_i = -normal.dot(dir);
        let (n1, n2) = (rng.between(1.0, 2.0), rng.between(1.0, 2.0));
        let boundary = Boundary::<f64>::new(n1, n2);
        let at = boundary.cross(cos_i);
        let narrow_boundary = Boundary::<f32>::new(n1, n2);
        let narrow_at = narrow_boundary.cross(cos_i as f32);
        let mirrored = reflect(dir, normal);
        let choice = rng.unit();
        let (behind, surface, narrow_surface, factors) = if choice < 0.3 && !at.total {
            let behind = boundary.refract(dir, normal, &at).normalized();
            (
                behind,
                Mueller::refracted(&boundary, &at),
                Mueller::refracted(&narrow_boundary, &narrow_at),
                // Light comes the other way: out of the far medium.
                transmission_amplitudes(n2, n1, at.cos_t, at.cos_i),
            )
        } else if choice < 0.7 {
            let amplitudes = reflection_amplitudes(n1, Complex(n2, 0.0), at.cos_i);
            let narrow_surface = Mueller::reflected(&narrow_boundary, &narrow_at);
            (mirrored, Mueller::reflected(&boundary, &at), narrow_surface, amplitudes)
        } else {
            let (eta, k) = (rng.between(0.1, 3.0), rng.between(0.1, 5.0));
            let amplitudes = reflection_amplitudes(1.0, Complex(eta, k), at.cos_i);
            let narrow_surface = Mueller::metal(cos_i as f32, eta as f32, k as f32);
            (mirrored, Mueller::metal(cos_i, eta, k), narrow_surface, amplitudes)
        };
        let plane = PlaneOfIncidence::of_incidence(dir, axis, normal);
        let in_plane = carried.in_plane(&plane);
        gain *= in_plane.gain(&surface);
        carried = in_plane.then(&surface);
        let narrow_plane = PlaneOfIncidence::of_incidence(narrow(dir), narrow_axis, narrow(normal));
        let in_plane = narrow_carried.in_plane(&narrow_plane);
        narrow_gain *= in_plane.gain(&narrow_surface);
        narrow_carried = in_plane.then(&narrow_surface);
        path.push(Passage { before: dir, behind, s: dir.cross(normal).normalized(), factors });
        dir = behind;
        axis = made_across(plane.s, dir);
        narrow_axis = made_across(narrow_plane.s, narrow(dir));
    }
    (gain, narrow_gain, by_the_field(&path))
}

#[test]
fn whole_paths_agree_with_the_electric_field_carried_along_them() {
    let mut rng = Rng::new(3);
    let (mut worst, mut worst_narrow, mut apart) = (0.0_f64, 0.0_f64, 0.0_f64);
    for i in 0..20_000 {
        let (got, narrow, want) = random_path(&mut rng, 1 + i % 6);
        worst = worst.max((got - want).abs());
        worst_narrow = worst_narrow.max((f64::from(narrow) - want).abs());
        apart = apart.max(want);
    }
    println!("off the field by at most {worst:.1e} in f64, {worst_narrow:.1e} in f32; largest {apart:.2}");
    assert!(worst < 1e-11, "{worst}");
    assert!(worst_narrow < 5e-5, "{worst_narrow}");
    assert!(apart > 0.9);
}

#[test]
fn head_on_any_frame_serves_and_frames_stay_across() {
    let mut rng = Rng::new(4);
    for _ in 0..1000 {
        let dir = rng.direction();
        let axis = any_across(dir);
        assert!(axis.dot(dir).abs() < 1e-15 && (axis.length() - 1.0).abs() < 1e-15);
        let plane = PlaneOfIncidence::of_incidence(dir, axis, -dir);
        assert!((plane.cos2.hypot(plane.sin2) - 1.0).abs() < 1e-14);
        assert!(plane.s.dot(dir).abs() < 1e-14 && (plane.s.length() - 1.0).abs() < 1e-14);
        let normal = rng.direction();
        let plane = PlaneOfIncidence::of_incidence(narrow(dir), any_across(narrow(dir)), narrow(normal));
        assert!(plane.s.dot(narrow(dir)).abs() < 5e-7);
        assert!((plane.cos2.hypot(plane.sin2) - 1.0).abs() < 1e-6);
    }
}
