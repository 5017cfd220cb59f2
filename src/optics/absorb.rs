//! Beer-Lambert absorption.

use crate::math::{Real, Vector3};

/// Transmittance over `distance` in a medium that absorbs `absorption` per unit: `exp(-absorption distance)`. It is 1
/// without absorption, also over an infinite distance, where the product would be NaN.
#[inline(always)]
pub fn transmittance<R: Real>(absorption: Vector3<R>, distance: R) -> Vector3<R> {
    let channel = |a: R| R::select(a.eq(R::zero()), R::one(), (-(a * distance)).exp());
    Vector3::new(channel(absorption.x), channel(absorption.y), channel(absorption.z))
}

/// Returns the absorption coefficient that leaves `colour` of white light after `distance`: `-ln(colour) / distance`,
/// as glTF defines attenuation colour and distance. Channels are in 0..=1 and `distance` is above zero. A channel below
/// 2^-24 counts as 2^-24, which is black in any picture and keeps the coefficient finite.
#[must_use]
pub fn absorption_from_colour(colour: glam::Vec3, distance: f32) -> glam::Vec3 {
    let floor = f64::from(crate::math::UNIT_ROUNDOFF);
    let channel = |c: f32| {
        let sigma = -f64::from(c).max(floor).ln() / f64::from(distance);
        // A colour of exactly 1 gives -0; a tiny distance gives more than an f32 can hold.
        sigma.clamp(0.0, f64::from(f32::MAX)) as f32
    };
    glam::Vec3::new(channel(colour.x), channel(colour.y), channel(colour.z))
}
