//! The back ends: their names, and their availability on this machine.

use std::str::FromStr;

use super::embree::{self, Mode, reach};
use crate::choice::Choice as _;
use crate::error::Unavailable;
use crate::geometry::Geometry;

crate::choice! {
    /// Back end: a hierarchy and its kernels, which find the hits of rays in f32.
    pub enum Backend("backend", derive(Eq, Hash, PartialOrd, Ord)) {
        /// Eight-wide hierarchy of this program.
        "native" => Native,
        /// Embree 4 in its robust mode, where built in.
        "embree" => Embree,
        /// Embree 4 in its fast mode, which may miss hits at edges.
        "embree-fast" => EmbreeFast,
    }
}

impl Backend {
    /// Back end if none is chosen: Embree if it is compiled in, else native.
    pub const DEFAULT: Self = if embree::COMPILED_IN { Self::Embree } else { Self::Native };

    /// The name in reports that compare both modes of Embree.
    #[must_use]
    pub const fn mode_name(self) -> &'static str {
        match self {
            Self::Embree => "embree-robust",
            Self::Native | Self::EmbreeFast => self.name(),
        }
    }

    /// Embree's mode; none for the native back end.
    #[must_use]
    pub const fn mode(self) -> Option<Mode> {
        match self {
            Self::Native => None,
            Self::Embree => Some(Mode::Robust),
            Self::EmbreeFast => Some(Mode::Fast),
        }
    }

    /// Returns true if hits keep the bits of testing every primitive, in whatever packet a ray is traced, and follow the
    /// tie rule of [`Intersector`](super::Intersector). No ray is lost at the edges of a closed mesh then.
    #[must_use]
    pub const fn is_exact(self) -> bool {
        matches!(self, Self::Native)
    }

    /// Returns true if this program was built with the back end.
    #[must_use]
    pub const fn is_compiled_in(self) -> bool {
        embree::COMPILED_IN || matches!(self, Self::Native)
    }

    /// Checks that this program and this machine have the back end. Loads its library.
    ///
    /// # Errors
    /// The reason why the back end is not available.
    pub fn availability(self) -> Result<(), Unavailable> {
        match self {
            Self::Native => Ok(()),
            Self::Embree | Self::EmbreeFast => embree::installed().map(drop),
        }
    }

    /// Checks that the back end finds all shapes of `geometry`.
    ///
    /// # Errors
    /// [`Unavailable::OutOfReach`] with the first shape that it would lose.
    pub fn check_reach(self, geometry: &[Geometry]) -> Result<(), Unavailable> {
        match self {
            Self::Native => Ok(()),
            Self::Embree | Self::EmbreeFast => reach::check(geometry),
        }
    }
}

impl Default for Backend {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl FromStr for Backend {
    type Err = String;

    /// Parses a [`name`](Backend::name).
    fn from_str(text: &str) -> Result<Self, String> {
        let names = || Self::ALL.map(Self::name).join(", ");
        Self::parse(text).map_err(|_| format!("no back end is called `{text}`; take one of {}", names()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_parsed_back_and_a_wrong_one_is_told_the_right_ones() {
        for backend in Backend::ALL {
            assert_eq!(backend.name().parse(), Ok(backend));
        }
        let error = "embre".parse::<Backend>().unwrap_err();
        assert!(error.contains("`embre`") && error.contains("native, embree, embree-fast"), "{error}");
    }

    #[test]
    fn native_is_there_in_every_build_and_the_default_is_compiled_in() {
        assert_eq!(Backend::Native.availability(), Ok(()));
        assert_ne!(Backend::default().availability(), Err(Unavailable::NotCompiledIn));
        let absent = Backend::Embree.availability() == Err(Unavailable::NotCompiledIn);
        assert_eq!(absent, Backend::DEFAULT == Backend::Native);
    }
}
