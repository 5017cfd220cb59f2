//! Limits that end rays early.

/// Limit that ended a ray, whose weight then counts as truncated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Limit {
    /// The weight cut-off (`Settings::cutoff`).
    Cutoff,
    /// The depth limit (`Settings::max_depth`).
    Depth,
    /// Limit on consecutive passed surfaces: surfaces that bound no medium change.
    Passes,
    /// Option of the render: a proven cut-off, reflection or total reflection left out, or a refraction formula that
    /// gave no direction.
    Asked,
}

impl Limit {
    /// All limits, in the order of their discriminants.
    pub const ALL: [Self; 4] = [Self::Cutoff, Self::Depth, Self::Passes, Self::Asked];

    /// Returns the limit that took the largest channel among `weights`, which are ordered by limit. Returns `None` if
    /// all are 0, and the first of equal ones.
    #[must_use]
    pub fn heaviest(weights: [[f64; 3]; Self::ALL.len()]) -> Option<Self> {
        let mut found = (None, 0.0);
        for (limit, weight) in Self::ALL.into_iter().zip(weights) {
            let most = weight.into_iter().fold(0.0, |most: f64, w| most.max(w.abs()));
            if most > found.1 {
                found = (Some(limit), most);
            }
        }
        found.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_heaviest_channel_of_either_sign_names_the_limit() {
        let none = [[0.0; 3]; 4];
        assert_eq!(Limit::heaviest(none), None);
        let mut weights = none;
        weights[Limit::Cutoff as usize] = [0.2, 0.1, 0.0];
        weights[Limit::Depth as usize] = [0.0, 0.0, -0.3];
        assert_eq!(Limit::heaviest(weights), Some(Limit::Depth));
        weights[Limit::Passes as usize] = [0.3, 0.0, 0.0];
        assert_eq!(Limit::heaviest(weights), Some(Limit::Depth));
    }
}
