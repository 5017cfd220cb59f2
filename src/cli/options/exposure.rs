//! Exposure of a picture.

/// Factor on all colours, `2^ev`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::cli) struct Exposure {
    pub ev: f32,
}

impl Exposure {
    /// Returns the factor.
    pub fn factor(self) -> f32 {
        self.ev.exp2()
    }
}
