//! Results of commands.

/// Result of a command that met no error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Done, or a check that succeeded.
    Done,
    /// A comparison or check that failed.
    Negative,
}
