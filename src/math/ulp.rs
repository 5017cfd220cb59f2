//! Neighbours and spacing of `f32` numbers.

/// The distance from `|x|` to the next larger `f32`; the smallest denormal at zero, NaN for NaN and infinities.
#[must_use]
pub fn ulp(x: f32) -> f32 {
    let x = x.abs();
    next_up(x) - x
}

/// The next `f32` above `x`; `x` itself at +inf and NaN.
#[must_use]
#[inline(always)]
pub fn next_up(x: f32) -> f32 {
    x.next_up()
}

/// The next `f32` below `x`; `x` itself at -inf and NaN.
#[must_use]
#[inline(always)]
pub fn next_down(x: f32) -> f32 {
    x.next_down()
}
