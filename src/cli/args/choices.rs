//! Choices that several commands have.

use clap::ValueEnum;

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(in crate::cli) enum FresnelArg {
    /// The Fresnel equations
    Exact,
    /// The Fresnel equations, polarisation carried along every path
    Polarised,
    /// Schlick's approximation
    Schlick,
    /// The reflectance at normal incidence for every angle
    Off,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum RefractionArg {
    /// Snell's law, stable at every index ratio
    Stable,
    /// Snell's law by arc sine and arc cosine
    Trigonometric,
    /// Heckbert's method
    Heckbert,
    /// Bec's method
    Bec,
    /// The lighting slides' vector form
    Slides,
    /// Oliveira's approximation
    Oliveira,
    /// No bending at all
    Straight,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(in crate::cli) enum ShadowsArg {
    /// They block light
    Opaque,
    /// Light goes straight through, weakened
    Straight,
}

/// Embree's own LOW, MEDIUM and HIGH stand in where Embree traces.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(in crate::cli) enum BvhArg {
    /// Quickest to build, slower to trace: previews
    Fast,
    /// By the surface area heuristic
    Default,
    /// Several times as long to build: long renders where large and small triangles mix
    High,
}
