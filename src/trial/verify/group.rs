//! Groups of test cases, by name.

crate::choice! {
    /// Groups of cases.
    pub enum Group("group", derive(Eq, Hash)) {
        /// Rays from inside closed meshes, at corners, at edges and anywhere, hit something.
        "leaks" => Leaks,
        /// Rays that leave a surface do not hit it again, and hit another one close by.
        "self-hits" => SelfHits,
        /// Reflectance against the oracle.
        "fresnel" => Fresnel,
        /// Refracted directions against the oracle.
        "refraction" => Refraction,
        /// Mirror directions against the oracle.
        "reflection" => Reflection,
        /// Equal indices neither refract nor reflect; R + T = 1; one lane and eight agree to the bit.
        "matched" => Matched,
        /// Empty lanes, spoilt lanes and the order of rays change no bit.
        "lanes" => Lanes,
        /// Hits are those of testing every shape.
        "traversal" => Traversal,
        /// Garbage is built into sound trees, and shapes left out are counted.
        "builds" => Builds,
        /// Light after long chains of reflections and truncated weight add up to all light.
        "chains" => Chains,
        /// Hits at the given scene against the f64 arbiter.
        "parity" => Parity,
    }
}

impl Group {
    /// Groups that need no scene.
    pub const OF_NO_SCENE: [Self; 10] = [
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

    /// Returns true if the group tests a back end, and false if it tests formulas alone.
    #[must_use]
    pub fn is_of_path(self) -> bool {
        !matches!(self, Self::Fresnel | Self::Refraction | Self::Reflection | Self::Matched)
    }
}
