//! Facts about the Embree library of this machine.

/// Description of a loaded library that passed all checks.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Installed {
    /// Major, minor and patch.
    pub version: String,
    /// Widest instructions that it traces packets with.
    pub isa: &'static str,
    /// Its tasking system.
    pub tasking: &'static str,
    /// The file it was loaded from.
    pub file: String,
    /// The rule that found the file.
    pub found_by: &'static str,
}
