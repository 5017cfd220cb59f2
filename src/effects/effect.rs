//! List of effects. To add an effect, start here.

macro_rules! effects {
    ($($variant:ident, $name:literal, $left_out:literal;)*) => {
        /// Optical effect that a render may simulate.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Effect {
            $(#[doc = concat!("`", $name, "`; left out: ", $left_out, ".")] $variant,)*
        }

        impl Effect {
            /// All effects, in the order of tables.
            pub const ALL: &[Self] = &[$(Self::$variant,)*];

            /// Returns the name used in commands and reports.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }

            /// Returns the name of the flag that leaves the effect out.
            #[must_use]
            pub fn flag(self) -> &'static str {
                match self {
                    $(Self::$variant => concat!("no-", $name),)*
                }
            }

            /// Returns a description of the picture without the effect.
            #[must_use]
            pub fn left_out(self) -> &'static str {
                match self {
                    $(Self::$variant => $left_out,)*
                }
            }
        }
    };
}

effects! {
    Ambient, "ambient", "no surface answers the ambient colour";
    Emission, "emission", "no surface shines by itself";
    Diffuse, "diffuse", "no surface has a colour of its own under lights";
    Highlight, "highlight", "lights leave no bright spots";
    HardShadows, "hard-shadows", "lights shine through everything";
    SoftShadows, "soft-shadows", "lamps with an extent shine from their middles";
    ShadowsThroughGlass, "shadows-through-glass", "transparent surfaces cast shadows as opaque ones do";
    Mirror, "mirror", "mirrors show their base colour alone";
    Conductor, "conductor", "metals show their base colour alone";
    Refraction, "refraction", "light goes straight on through transparent surfaces";
    FresnelSplit, "fresnel-split", "clear surfaces reflect nothing but what they reflect totally";
    TotalInternalReflection, "total-internal-reflection", "light that would be reflected totally ends";
    Dispersion, "dispersion", "media have one index for all of light, that at the line d";
    Absorption, "absorption", "media take nothing of light";
    NestedMedia, "nested-media", "where media overlap, the last entered fills the space";
    Touching, "touching", "of surfaces that coincide, the one that rounding puts first is met alone";
    Environment, "environment", "rays that meet nothing see black";
    Textures, "textures", "pictures and checkers give way to their mean colours";
    InterpolatedNormals, "interpolated-normals", "meshes are faceted";
    ThinPanes, "thin-panes", "panes are not there";
    Coats, "coats", "coated surfaces show their base alone";
    Alpha, "alpha", "covers have no holes";
}

impl std::fmt::Display for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

impl Effect {
    /// Returns the effect of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|e| e.name() == name)
    }
}
