//! Groups of test cases, by name.

/// Group of test cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
    /// Rays from inside closed meshes, aimed at corners, at edges and anywhere, hit something.
    Leaks,
    /// Rays that leave a surface do not hit it again, and hit another surface close by.
    SelfHits,
    /// Reflectance against the oracle.
    Fresnel,
    /// Refracted directions against the oracle.
    Refraction,
    /// Mirror directions against the oracle.
    Reflection,
    /// Equal indices neither bend nor reflect; R + T = 1; one lane and eight agree to the bit.
    Matched,
    /// Empty lanes, poisoned lanes and the order of rays change no bit.
    Lanes,
    /// Hits equal those of testing every triangle.
    Traversal,
    /// Garbage gives valid hierarchies, and everything left out is counted.
    Builds,
    /// Light that arrives after long chains of reflections, plus truncated weight, is all the light.
    Chains,
    /// Hits in the user's scene agree with the arbiter.
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

    /// Groups that run on a scene.
    pub const OF_SCENE: [Self; 3] = [Self::Leaks, Self::SelfHits, Self::Parity];

    /// Returns the name on the command line and in reports.
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

    /// Returns true if the group tests a back end, and false if it tests formulas alone.
    #[must_use]
    pub fn is_of_path(self) -> bool {
        !matches!(self, Self::Fresnel | Self::Refraction | Self::Reflection | Self::Matched)
    }
}
