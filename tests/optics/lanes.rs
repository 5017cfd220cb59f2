//! One lane and eight give the same bits, for every public function of optics, over awkward inputs.

use super::sample::Rng;
use vitrum::math::{LaneMask, Real, Vector3};
use vitrum::optics::{
    AtNormal, Bec, Boundary, Exact, FresnelFormula, Heckbert, Oliveira, PlanarReflection, RefractionFormula, Schlick,
    SlidesVector, Stable, StraightThrough, Trigonometric, below_surface, conductor_at_normal, conductor_exact,
    conductor_schlick, consistent_normal, polarised, polarised_as_printed, reflect, thin_reflectance, transmittance,
};
use vitrum::simd::{F32x8, Mask8};

/// Input of one lane: four vectors, five numbers and a boundary.
#[derive(Clone, Copy, Debug)]
struct Input {
    vectors: [Vector3<f32>; 4],
    numbers: [f32; 5],
    boundary: Boundary<f32>,
}

/// All that the optics say of one input, or of eight: numbers, and masks as numbers.
fn everything<R: Real>(vectors: [Vector3<R>; 4], numbers: [R; 5], boundary: &Boundary<R>) -> Vec<R> {
    let [i, n, g, s] = vectors;
    let [cos, eta, k, distance, share] = numbers;
    let mut out = Vec::new();
    let mask = |m: R::Mask| R::select(m, R::one(), R::zero());
    for at in [boundary.cross(-i.dot(n)), boundary.cross(cos)] {
        out.extend([at.cos_i, at.b, at.cos_t, mask(at.total)]);
        out.push(Exact::dielectric(boundary, &at));
        out.push(Schlick::dielectric(boundary, &at));
        out.push(AtNormal::dielectric(boundary, &at));
        for r in [polarised(boundary, &at), polarised_as_printed(boundary, &at)] {
            out.extend([r.s, r.p, r.unpolarised()]);
        }
        let t = boundary.refract(i, n, &at);
        let mut refracted = vec![
            Stable.refract(boundary, i, n, &at),
            StraightThrough.refract(boundary, i, n, &at),
            Heckbert.refract(boundary, i, n, &at),
            Bec.refract(boundary, i, n, &at),
            SlidesVector.refract(boundary, i, n, &at),
            Trigonometric.refract(boundary, i, n, &at),
        ];
        for oliveira in [Oliveira::AS_PRINTED, Oliveira::WATER, Oliveira::GLASS, Oliveira::first_order(1.5, 1.0)] {
            refracted.push(oliveira.refract(boundary, i, n, &at));
        }
        for r in refracted {
            out.extend([r.direction.x, r.direction.y, r.direction.z, mask(r.total)]);
        }
        let lowered = below_surface(t, g);
        out.extend([t.x, t.y, t.z, lowered.x, lowered.y, lowered.z]);
    }
    out.extend([conductor_exact(cos, eta, k), conductor_schlick(cos, eta, k), conductor_at_normal(eta, k)]);
    for rgb in [Exact::conductor_rgb(cos, g, s), Schlick::conductor_rgb(cos, g, s), AtNormal::conductor_rgb(cos, g, s)]
    {
        out.extend([rgb.x, rgb.y, rgb.z]);
    }
    out.push(thin_reflectance(share));
    let plane = PlanarReflection::new(g, n);
    for v in [
        reflect(i, n),
        consistent_normal(i, g, s),
        below_surface(s, g),
        transmittance(n.abs(), distance),
        plane.point(s),
        plane.direction(i),
    ] {
        out.extend([v.x, v.y, v.z]);
    }
    out
}

fn gather(inputs: &[Input; 8]) -> ([Vector3<F32x8>; 4], [F32x8; 5], Boundary<F32x8>) {
    let number = |f: &dyn Fn(&Input) -> f32| F32x8::from_fn(|lane| f(&inputs[lane]));
    let vectors = std::array::from_fn(|v| {
        Vector3::new(number(&|i| i.vectors[v].x), number(&|i| i.vectors[v].y), number(&|i| i.vectors[v].z))
    });
    let numbers = std::array::from_fn(|k| number(&|i| i.numbers[k]));
    let boundary = Boundary {
        eta: number(&|i| i.boundary.eta),
        kc: number(&|i| i.boundary.kc),
        kc_low: number(&|i| i.boundary.kc_low),
        r0: number(&|i| i.boundary.r0),
    };
    (vectors, numbers, boundary)
}

fn check(inputs: &[Input; 8]) {
    let (vectors, numbers, boundary) = gather(inputs);
    let eight = everything(vectors, numbers, &boundary);
    for (lane, input) in inputs.iter().enumerate() {
        let one = everything(input.vectors, input.numbers, &input.boundary);
        assert_eq!(one.len(), eight.len());
        for (k, (&want, got)) in one.iter().zip(&eight).enumerate() {
            let got = got.lane(lane);
            let same = got.to_bits() == want.to_bits() || (got.is_nan() && want.is_nan());
            assert!(same, "answer {k} of {input:?}: {got:e} in lane {lane}, {want:e} alone");
        }
    }
}

const INDICES: [(f64, f64); 10] = [
    (1.0, 1.5),
    (1.5, 1.0),
    (1.33, 1.5),
    (2.42, 1.0),
    (1.5, 1.5),
    (1.0, 1.0 + f32::EPSILON as f64),
    (1.0 + f32::EPSILON as f64, 1.0),
    (1.0, 1e3),
    (1e3, 1.0),
    (1.0, 1.0),
];

/// A ray as the renderer has it, every kind of angle and boundary among its eight lanes.
fn sound(rng: &mut Rng, k: usize) -> Input {
    let (n1, n2) = INDICES[k % INDICES.len()];
    let angle = match k % 5 {
        0 => rng.unit().acos(),
        1 => rng.between(0.0, 1e-3),
        2 => std::f64::consts::FRAC_PI_2 - 10.0_f64.powf(rng.between(-12.0, -2.0)),
        3 if n1 > n2 => (super::sample::critical_angle(n1, n2) + rng.between(-1e-7, 1e-7)).min(1.57),
        _ => 0.0,
    };
    let (i, n) = rng.meeting_at(angle);
    let (_, s) = rng.meeting_at(0.5);
    let numbers = [angle.cos(), rng.between(0.05, 4.0), rng.between(0.0, 9.0), rng.between(0.0, 100.0), rng.unit()];
    Input { vectors: [i, n, n, s], numbers: numbers.map(|x| x as f32), boundary: Boundary::new(n1, n2) }
}

/// Numbers with nothing to recommend them.
fn awkward(rng: &mut Rng) -> f32 {
    const SPECIAL: [f32; 14] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f32::MIN_POSITIVE,
        1e-45,
        -1e-45,
        f32::MAX,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
        1.0 + f32::EPSILON,
        1.0 - f32::EPSILON,
        1e-20,
    ];
    match rng.bits() % 3 {
        0 => SPECIAL[(rng.bits() % 14) as usize],
        1 => f32::from_bits(rng.bits() as u32),
        _ => rng.between(-1.0, 1.0) as f32,
    }
}

/// Case LN-09 of the catalogue.
#[test]
fn sound_inputs_give_each_lane_the_bits_of_the_scalar() {
    let mut rng = Rng::new(31);
    for packet in 0..20_000 {
        check(&std::array::from_fn(|lane| sound(&mut rng, packet * 8 + lane * 3)));
    }
}

/// Case LN-09 of the catalogue.
#[test]
fn awkward_inputs_give_each_lane_the_bits_of_the_scalar_and_spoil_no_neighbour() {
    let mut rng = Rng::new(32);
    for packet in 0..20_000 {
        check(&std::array::from_fn(|lane| {
            let mut input = sound(&mut rng, packet * 8 + lane);
            if (packet + lane) % 2 == 0 {
                let mut vector = || Vector3::new(awkward(&mut rng), awkward(&mut rng), awkward(&mut rng));
                input.vectors = [vector(), vector(), vector(), vector()];
                input.numbers = std::array::from_fn(|_| awkward(&mut rng));
            }
            input
        }));
    }
}

/// Case RF-08 of the catalogue.
#[test]
fn a_packet_knows_total_reflection_lane_by_lane() {
    let boundary = Boundary::<F32x8>::new(1.5, 1.0);
    // The critical cosine is 0.745.
    let cosines = [1.0, 0.8, 0.75, 0.74, 0.7, 0.3, 0.0, 0.746];
    let total: Mask8 = boundary.cross(F32x8::new(cosines)).total;
    assert_eq!(total.bits(), 0b0111_1000);
    assert!(total.any() && !total.all());
}
