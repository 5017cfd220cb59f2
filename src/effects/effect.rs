//! The list of effects. To add an effect, begin here.

use crate::choice::Choice as _;

crate::choice! {
    /// Effect of light that a render may simulate.
    ///
    /// The documentation of an effect describes the picture without it.
    pub enum Effect("effects", derive(Eq, Hash, PartialOrd, Ord)) {
        /// No surface answers the ambient colour.
        "ambient" => Ambient,
        /// No surface shines by itself.
        "emission" => Emission,
        /// No surface has a colour of its own under lights.
        "diffuse" => Diffuse,
        /// Lights leave no bright spots.
        "highlight" => Highlight,
        /// Lights shine through everything.
        "hard-shadows" => HardShadows,
        /// Area lamps shine from their middles.
        "soft-shadows" => SoftShadows,
        /// Emissive shapes are seen, and light nothing.
        "emissive-light" => EmissiveLight,
        /// The environment is seen, and lights nothing.
        "sky-light" => SkyLight,
        /// Transparent surfaces cast shadows as opaque ones do.
        "shadows-through-glass" => ShadowsThroughGlass,
        /// Mirrors show their base colour alone.
        "mirror" => Mirror,
        /// Metals show their base colour alone.
        "conductor" => Conductor,
        /// Light goes straight on through transparent surfaces.
        "refraction" => Refraction,
        /// Clear surfaces reflect only by total reflection.
        "fresnel-split" => FresnelSplit,
        /// Light that would be reflected totally ends.
        "total-internal-reflection" => TotalInternalReflection,
        /// Media have one index for all wavelengths, that at the line d.
        "dispersion" => Dispersion,
        /// Media absorb no light.
        "absorption" => Absorption,
        /// The medium entered last fills the space where media overlap.
        "nested-media" => NestedMedia,
        /// Rays cross only one of several coinciding surfaces, chosen by rounding.
        "touching" => Touching,
        /// Rays that hit nothing see black.
        "environment" => Environment,
        /// Pictures and checkers are replaced by their mean colours.
        "textures" => Textures,
        /// Meshes are faceted.
        "interpolated-normals" => InterpolatedNormals,
        /// Panes are invisible.
        "thin-panes" => ThinPanes,
        /// Coated surfaces show their base alone.
        "coats" => Coats,
        /// Covers have no holes.
        "alpha" => Alpha,
    }
}

impl Effect {
    /// Returns the description of the picture without the effect, as the end of a sentence.
    #[must_use]
    pub fn left_out(self) -> String {
        let help = self.help();
        help.chars().take(1).flat_map(char::to_lowercase).chain(help.chars().skip(1)).collect()
    }

    /// Returns the effect of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|e| e.name() == name)
    }
}
