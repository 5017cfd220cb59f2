//! What is tried, by name.

/// A group of cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
    /// Rays from inside closed meshes at their corners, at their edges and anywhere meet something.
    Leaks,
    /// Rays that leave a surface do not meet it again, and meet another one close by.
    SelfHits,
    /// Reflectance against the oracle.
    Fresnel,
    /// Refracted directions against the oracle.
    Refraction,
    /// Mirror directions against the oracle.
    Reflection,
    /// Equal indices bend and reflect nothing; R + T = 1; one lane and eight agree to the bit.
    Matched,
    /// Neither empty nor spoilt lanes, nor the order of rays, change a bit.
    Lanes,
    /// Hits are those of testing everything.
    Traversal,
    /// Garbage is built into sound trees, and what is left out is counted.
    Builds,
    /// What arrives after long chains of reflections, and what was cut, make up all the light.
    Chains,
    /// Hits at the user's scene against the arbiter.
    Parity,
}

impl Group {
    /// All groups that need no scene.
    pub const ALL: [Self; 10] = [
        Self::Leaks,
        Self::SelfHits,
        Self::Fresnel,
        Self::Refraction,
        Self::Reflection,
        Self::Matched,
        Self::Lanes,
        Self::Traversal,
        Self::Builds,
        Self::Chains,
    ];

    /// The groups that are fired at a scene.
    pub const OF_SCENE: [Self; 3] = [Self::Leaks, Self::SelfHits, Self::Parity];

    /// The name on the command line and in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Leaks => "leaks",
            Self::SelfHits => "self-hits",
            Self::Fresnel => "fresnel",
            Self::Refraction => "refraction",
            Self::Reflection => "reflection",
            Self::Matched => "matched",
            Self::Lanes => "lanes",
            Self::Traversal => "traversal",
            Self::Builds => "builds",
            Self::Chains => "chains",
            Self::Parity => "parity",
        }
    }

    /// Whether it concerns a path through the scene, and not formulas alone.
    #[must_use]
    pub fn is_of_path(self) -> bool {
        !matches!(self, Self::Fresnel | Self::Refraction | Self::Reflection | Self::Matched)
    }
}
