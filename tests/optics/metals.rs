//! Metals.

use super::oracle;
use vitrum::optics::{
    AtNormal, Boundary, Exact, FresnelFormula, Schlick, conductor_at_normal, conductor_exact, conductor_schlick,
};

/// Name, index and extinction somewhere in visible light, and Schlick's largest error on such a metal.
const METALS: [(&str, f32, f32, f64); 6] = [
    ("silver", 0.052, 4.41, 0.007),
    ("gold", 0.166, 3.15, 0.017),
    ("gold, blue", 1.45, 1.88, 0.025),
    ("copper", 0.214, 3.67, 0.041),
    ("aluminium", 1.37, 7.62, 0.092),
    ("chromium", 3.135, 3.31, 0.197),
];

/// Case FR-14 of the catalogue.
#[test]
fn a_metals_reflectance_is_within_its_bound_of_the_oracle() {
    let mut worst = 0.0_f64;
    for (name, eta, k, _) in METALS {
        for step in 0..=50_000 {
            let c = step as f32 / 50_000.0;
            let got = conductor_exact(c, eta, k);
            let want = oracle::metal(c, eta, k);
            let off = (f64::from(got) - want).abs() / want;
            assert!(off <= 1.4e-6, "{name} at {c}: {got}, not {want}");
            worst = worst.max(off);
        }
    }
    println!("metals: {worst:.1e} of themselves");
}

/// Case FR-14 of the catalogue.
#[test]
fn schlicks_largest_error_on_metals_is_of_the_size_theory_says() {
    for (name, eta, k, want) in METALS {
        let (angle, off) = (0..900)
            .map(|a| f64::from(a) / 10.0)
            .map(|a| (a, a.to_radians().cos() as f32))
            .map(|(a, c)| (a, (f64::from(conductor_schlick(c, eta, k)) - oracle::metal(c, eta, k)).abs()))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .expect("not empty");
        println!("Schlick on {name}: {off:.4} at {angle} degrees");
        // Indices differ that much between wavelengths and between sources.
        assert!((0.5..2.0).contains(&(off / want)), "{name}: {off}, not {want}");
        assert!((76.0..86.0).contains(&angle), "{name}: at {angle}");
    }
}

/// Case FR-15 of the catalogue.
#[test]
fn a_metal_that_absorbs_nothing_is_the_dielectric() {
    for (n1, n2) in [(1.0, 1.5), (1.0, 1.33), (1.0, 2.42), (1.5, 1.0), (2.0, 1.0)] {
        let boundary = Boundary::<f32>::new(n1, n2);
        for step in 0..=2000 {
            let c = step as f32 / 2000.0;
            let dielectric = Exact::dielectric(&boundary, &boundary.cross(c));
            let metal = conductor_exact(c, (n2 / n1) as f32, 0.0);
            // Near the critical angle the metal has no low part of its index to keep its digits by.
            assert!(
                (metal - dielectric).abs() <= 2e-6 * dielectric + if n1 > n2 { 2e-4 } else { 0.0 },
                "{n1} -> {n2} at {c}"
            );
            let wide = Boundary::<f64>::new(n1, n2);
            let (c, eta) = (f64::from(c), n2 / n1);
            let off = conductor_exact(c, eta, 0.0) - Exact::dielectric(&wide, &wide.cross(c));
            assert!(off.abs() <= 1e-7, "{n1} -> {n2} at {c}: {off:e}");
        }
    }
    // No index at all: nothing, but for 0/0 at exactly grazing.
    for step in 1..=1000 {
        assert_eq!(conductor_exact(step as f32 / 1000.0, 1.0, 0.0), 0.0);
    }
}

#[test]
fn the_fresnel_choice_reaches_metals_too() {
    let (c, eta, k) = (0.3_f32, 0.166, 3.15);
    assert_eq!(Exact::conductor(c, eta, k), conductor_exact(c, eta, k));
    assert_eq!(Schlick::conductor(c, eta, k), conductor_schlick(c, eta, k));
    assert_eq!(AtNormal::conductor(c, eta, k), conductor_at_normal(eta, k));
    // Head on all three are one: ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2).
    let want = ((0.166_f64 - 1.0).powi(2) + 3.15_f64.powi(2)) / ((0.166_f64 + 1.0).powi(2) + 3.15_f64.powi(2));
    for r in [conductor_exact(1.0, 0.166, 3.15), conductor_schlick(1.0, 0.166, 3.15), conductor_at_normal(0.166, 3.15)]
    {
        assert!((f64::from(r as f32) - want).abs() < 1e-7 && (0.0..=1.0).contains(&r), "{r}");
    }
}

#[test]
fn reflectance_of_anything_is_between_nothing_and_all() {
    let mut rng = super::sample::Rng::new(12);
    for _ in 0..300_000 {
        let c = rng.between(-1e-7, 1.0 + 1e-6) as f32;
        let size = 10.0_f64.powf(rng.between(-6.0, 6.0));
        let (eta, k) = ((size * rng.unit()) as f32, (size * rng.unit()) as f32);
        let r = conductor_exact(c, eta, k);
        assert!((0.0..=1.0).contains(&r), "{eta} + {k} i at {c}: {r}");
        let s = conductor_schlick(c.clamp(0.0, 1.0), eta, k);
        assert!((0.0..=1.0).contains(&s), "{eta} + {k} i at {c}: {s}");
    }
    for (eta, k) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1e-20, 1e-20), (1e18, 1e18)] {
        for c in [0.0, 1e-20, 0.5, 1.0] {
            let r = conductor_exact(c, eta, k);
            assert!((0.0..=1.0).contains(&r), "{eta} + {k} i at {c}: {r}");
        }
    }
}
