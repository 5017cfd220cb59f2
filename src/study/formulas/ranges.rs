//! Ranges of media and angles of incidence.

use std::f64::consts::FRAC_PI_2;

use crate::measure::sample::Rng;

/// One ulp of 1 in `f32`.
pub(super) const ULP: f64 = f32::EPSILON as f64;

/// Distribution of angles of incidence.
#[derive(Clone, Copy, Debug)]
pub(super) enum Angles {
    /// Cosines uniform over 0..1.
    All,
    /// Cosines from 1 down to 1 - 5e-7: within 1e-3 rad of the normal.
    NearNormal,
    /// The normal itself.
    Normal,
    /// Cosines uniform over 0..1e-3.
    Grazing,
    /// 1e-6 rad from grazing.
    AllButGrazing,
    /// Cosines uniform from the normal to 1e-3 rad below the critical angle.
    BelowCritical,
    /// Between two distances in radians below the critical angle.
    Just(f64, f64),
    /// A single angle in degrees.
    At(f64),
}

/// A pair of media and angles of incidence.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    pub name: &'static str,
    /// Index on the ray's side.
    pub n1: f64,
    /// Index on the other side.
    pub n2: f64,
    pub angles: Angles,
}

impl Range {
    pub const fn new(name: &'static str, n1: f64, n2: f64, angles: Angles) -> Self {
        Self { name, n1, n2, angles }
    }

    /// Critical angle in radians; a right angle if there is none.
    pub fn critical(&self) -> f64 {
        (self.n2 / self.n1).min(1.0).asin()
    }

    /// Draws an angle of incidence.
    pub fn angle(&self, rng: &mut Rng) -> f64 {
        match self.angles {
            Angles::All => rng.unit().acos(),
            Angles::NearNormal => rng.between(0.0, 1e-3),
            Angles::Normal => 0.0,
            Angles::Grazing => rng.between(0.0, 1e-3).acos(),
            Angles::AllButGrazing => FRAC_PI_2 - 1e-6,
            Angles::BelowCritical => rng.between((self.critical() - 1e-3).cos(), 1.0).acos(),
            Angles::Just(least, most) => self.critical() - rng.between(least, most),
            Angles::At(degrees) => degrees.to_radians(),
        }
    }
}
