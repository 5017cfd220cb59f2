//! Light that should not be there is seen by the ledger; what a limit cuts off is not held against a picture.

use vitrum::scene::{FresnelRule, Rgb};
use vitrum::study::energy::Ledger;
use vitrum::study::{Level, Precision, reference};

use super::theory::{fresnel, sea};

/// Shares beyond which light is missed.
const TOLERANCE: f64 = 1e-4;

/// The notes print `R = R_s + R_p`, without the half: twice the light comes off the sea.
#[test]
fn a_forgotten_half_of_unpolarised_fresnel_does_not_balance() {
    for degrees in [0.0_f64, 30.0, 60.0, 75.0] {
        let theta = degrees.to_radians();
        let right = sea(1.0, 1.333, theta, FresnelRule::Fresnel);
        let reference = right.shoot(right.default().with(Level::Precision(Precision::Double))).film;
        let ledger = Ledger::of(&right.shoot(right.default()), &reference);
        assert!(ledger.balances(TOLERANCE, 1.0), "{degrees}: {ledger:?}");

        // Every ray arrives at this angle, so that a fixed share is the wrong formula.
        let doubled = FresnelRule::Fixed(Rgb::splat(2.0 * fresnel(1.0, 1.333, theta) as f32));
        let wrong = sea(1.0, 1.333, theta, doubled);
        let ledger = Ledger::of(&wrong.shoot(wrong.default()), &reference);
        assert!(!ledger.balances(TOLERANCE, 1.0), "{degrees}: {ledger:?}");
        assert!((ledger.error() - 1.0).abs() < 1e-3, "{degrees}: {}", ledger.error());
    }
}

#[test]
fn what_the_cut_off_took_is_in_the_ledger_and_balances() {
    let small = sea(1.0, 1.333, 0.5, FresnelRule::Fresnel);
    let exact = small.shoot(reference::exact(&small.default())).film;
    // Nothing is traced at all, so that all that is seen was cut.
    let ledger = Ledger::of(&small.shoot(small.default().with(Level::Depth(0))), &exact);
    assert!(ledger.light == 0.0 && ledger.lost > 0.0 && ledger.cut >= ledger.lost, "{ledger:?}");
    assert!(ledger.balances(TOLERANCE, 1.0));
    // The same loss without its entry does not.
    assert!(!Ledger { cut: 0.0, ..ledger }.balances(TOLERANCE, 1.0));
}
