//! The crate's error type. A message is one line that names the place, the value and the cure.

use std::path::PathBuf;

/// Failure of an operation. [`Error::exit_code`] is the program's exit code.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Wrong input at a place in a file.
    #[error("{}:{line}{}: {message}", file.display(), column.map(|c| format!(":{c}")).unwrap_or_default())]
    Input {
        /// The file, as the user named it.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column, from 1, if known.
        column: Option<usize>,
        /// Description of the fault, with the value and the cure.
        message: String,
    },
    /// Wrong input without a single place.
    #[error("{}: {message}", file.display())]
    File {
        /// The file, as the user named it.
        file: PathBuf,
        /// Description of the fault, with the value and the cure.
        message: String,
    },
    /// Scene or flag that requests something impossible.
    #[error("{0}")]
    Usage(String),
    /// Failure of the operating system.
    #[error("{}: cannot {action}: {source}", file.display())]
    Io {
        /// The file, as the user named it.
        file: PathBuf,
        /// Attempted action: `read`, `write`, ...
        action: &'static str,
        /// The system's error.
        source: std::io::Error,
    },
    /// Limit of the program, or a part that this build lacks.
    #[error("{0}")]
    Limit(String),
    /// Back end that cannot trace.
    #[error(transparent)]
    Unavailable(#[from] Unavailable),
    /// Work that needs more memory than there is.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// Request that a scene or renderer does not support.
    #[error("{0}")]
    Unsupported(#[from] Unsupported),
    /// Interruption by the user (Ctrl-C).
    #[error("interrupted")]
    Interrupted,
}

/// Reason why a request cannot be met. Its text names no flags; the command line has its own words for each.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unsupported {
    /// Cut-off with a proven bound in a scene whose medium disperses light.
    #[error(
        "a proven cut-off is not possible in scenes whose media disperse light, as `{medium}` does: {}",
        NEGATIVE_CHANNELS
    )]
    ProofWithDispersion {
        /// Name of the medium.
        medium: String,
    },
    /// Polarisation in a scene whose medium disperses light.
    #[error("polarisation is not possible in scenes whose media disperse light, as `{medium}` does: {}", ONE_WHITE_RAY)]
    PolarisationWithDispersion {
        /// Name of the medium.
        medium: String,
    },
    /// Cut-off with a proven bound in a scene with a light that touches a surface.
    #[error(
        "a proven cut-off is not possible: no bound exists on the cut light: `{light}` has inverse-square falloff and \
         touches object `{object}`{place} to within rounding; move one of them, or give the light falloff = \"none\""
    )]
    LightTouchesSurface {
        /// Name of the light.
        light: String,
        /// Name of the object.
        object: String,
        /// File and line of the object in brackets, with a space before them; empty if unknown.
        place: String,
    },
    /// Cut-off with a proven bound in a scene whose light has no bound.
    #[error("a proven cut-off is not possible: the light of this scene adds up beyond all bounds")]
    UnboundedLight,
    /// Cut-off with a proven bound in a scene whose lamps are sampled.
    #[error(
        "a proven cut-off is not possible: no bound exists on the cut light of emissive shapes and sampled lamps, whose \
         samples may be brighter than any bound; write lights_from = \"lamps\" and lamps = \"each\" in [render]"
    )]
    SampledLight,
    /// Record of a pixel whose rays carry polarisation or a budget.
    #[error("the rays of a pixel cannot be recorded in eight lanes with polarisation or under a proven cut-off")]
    RecordOfCarried,
    /// Bound on the error of a picture below the rounding of its values.
    #[error(
        "the bound {bound:e} cannot be kept: pictures hold f32 values, which rounds the brightest of this scene \
         ({brightest:.3}) by up to {rounding:.1e}; take a bound of at least {:.0e}", 2.0 * .rounding
    )]
    BoundBelowRounding {
        /// Bound requested for each channel.
        bound: f64,
        /// Largest value of the picture.
        brightest: f64,
        /// Largest rounding of that value.
        rounding: f64,
    },
    /// Folder that contains another study.
    #[error(
        "{}: holds a study of another scene, other options, another program or another machine; choose another folder",
        .folder.display()
    )]
    AnotherStudy {
        /// The folder.
        folder: PathBuf,
    },
}

/// Reason why a proven cut-off excludes dispersion.
pub const NEGATIVE_CHANNELS: &str =
    "single wavelengths have negative channels, and together weigh more than the white ray they split from";

/// Reason why polarisation excludes dispersion.
pub const ONE_WHITE_RAY: &str =
    "reflected light stays one white ray, although each of its wavelengths is polarised differently";

/// Work that exceeds a limit of this machine.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what}: {needs} needed, {limit}")]
pub struct TooLarge {
    /// Name of the work.
    pub what: String,
    /// Amount that it needs, with its unit.
    pub needs: String,
    /// Amount that is left, the limit that causes this, and the cure.
    pub limit: String,
}

/// Reason why a back end cannot trace the rays of a scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unavailable {
    /// The program was built without the cargo feature `embree`.
    #[error(
        "Embree: this program was built without it; build with the feature `embree` of the crate vitrum (for the program: \
         `cargo build --release --features embree`), or take the native back end"
    )]
    NotCompiledIn,
    /// The library is not on this machine.
    #[error("Embree: no {library} {place}; {cure}")]
    NotFound {
        /// Name of the library's file.
        library: &'static str,
        /// The place that was searched, with its preposition.
        place: String,
        /// Cure.
        cure: String,
    },
    /// The library is too old or too new.
    #[error("Embree: {library} is version {}.{}.{}, not {needed}; {cure}", found[0], found[1], found[2])]
    Version {
        /// The library's file.
        library: String,
        /// Major, minor and patch of the library.
        found: [u32; 3],
        /// Major version that is needed.
        needed: u32,
        /// Cure.
        cure: &'static str,
    },
    /// The library lacks a function, or was built with options that rule it out. Names the file, the reason and the cure.
    #[error("Embree: {0}")]
    Unfit(String),
    /// There is not enough memory for the library.
    #[error(transparent)]
    Memory(#[from] TooLarge),
    /// A call of the library failed.
    #[error("Embree: {0}")]
    Failed(String),
    /// The back end loses hits on a shape of this size.
    #[error("Embree: shape {} {why}; scale the scene or take the native back end", shape + 1)]
    OutOfReach {
        /// Index of the shape in the list of geometry.
        shape: usize,
        /// Reason, in words that follow the shape's name.
        why: &'static str,
    },
}

/// A result of this crate.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// Exit code of the program: 2 for bad input or usage, 3 for input and output, 4 for a limit or a missing back end,
    /// 130 for an interruption. (0 is success, and 1 a comparison or check with a negative result, which is no error.)
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Input { .. } | Self::File { .. } | Self::Usage(_) | Self::Unsupported(_) => 2,
            Self::Io { .. } => 3,
            Self::Limit(_) | Self::Unavailable(_) | Self::TooLarge(_) => 4,
            Self::Interrupted => 130,
        }
    }

    /// Returns true if the request itself is refused, as unsound or too large; a study goes on without it. Failures of
    /// input and output, and interruptions, are not refusals.
    #[must_use]
    pub fn is_refusal(&self) -> bool {
        matches!(
            self,
            Self::Usage(_) | Self::Unsupported(_) | Self::Limit(_) | Self::Unavailable(_) | Self::TooLarge(_)
        )
    }

    /// Creates the error of a wrong file.
    pub fn file(file: impl Into<PathBuf>, message: impl Into<String>) -> Self {
        Self::File { file: file.into(), message: message.into() }
    }

    /// Creates the error of a wrong line in `file`.
    pub fn at(file: impl Into<PathBuf>, line: usize, message: impl Into<String>) -> Self {
        Self::Input { file: file.into(), line, column: None, message: message.into() }
    }

    /// Creates the error of a system that failed to `action` the file.
    pub fn io(file: impl Into<PathBuf>, action: &'static str, source: std::io::Error) -> Self {
        Self::Io { file: file.into(), action, source }
    }
}
