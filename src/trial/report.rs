//! Results of a trial, in the form of `--json`.

use serde::Serialize;

use super::contender::Mode;
use crate::accel::Backend;
use crate::measure::Machine;

/// All results.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Machine that it ran on.
    pub machine: Machine,
    /// Rays per second.
    pub rows: Vec<Row>,
    /// Build times.
    pub builds: Vec<Build>,
    /// Comparisons of native with Embree.
    pub ratios: Vec<Ratio>,
}

/// Rays per second of one contender.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Name of the mesh or scene.
    pub mesh: String,
    /// Number of triangles that can be hit.
    pub triangles: usize,
    /// Kind of rays.
    pub rays: &'static str,
    /// Back end.
    #[serde(serialize_with = "mode_name")]
    pub backend: Backend,
    /// Kernel, or `auto`.
    pub mode: Mode,
    /// Number of threads that traced.
    pub threads: usize,
    /// Millions of rays per second: median over the rounds.
    pub mrays_per_s: f64,
    /// Its 10th and 90th percentile.
    pub spread: [f64; 2],
}

/// Build time of one hierarchy.
#[derive(Clone, Debug, Serialize)]
pub struct Build {
    /// Name of the mesh or scene.
    pub mesh: String,
    /// Back end.
    #[serde(serialize_with = "mode_name")]
    pub backend: Backend,
    /// Build quality: `fast`, `default` or `high` (native), `medium` (Embree's name).
    pub quality: &'static str,
    /// Number of threads that built.
    pub threads: usize,
    /// Milliseconds: median over the builds.
    pub ms: f64,
    /// Bytes held after the build, per triangle or sphere.
    pub bytes_per_triangle: f64,
}

/// Comparison of the native path, as renders use it, with the fastest mode of Embree.
#[derive(Clone, Debug, Serialize)]
pub struct Ratio {
    /// Name of the mesh or scene.
    pub mesh: String,
    /// Kind of rays.
    pub rays: &'static str,
    /// Number of threads that traced.
    pub threads: usize,
    /// Embree in one of its modes.
    #[serde(serialize_with = "mode_name")]
    pub against: Backend,
    /// The mode of Embree with the highest median.
    pub embree_mode: Mode,
    /// Native rays per second relative to Embree's: median of the rounds' ratios. Above 1 native is faster.
    pub ratio: f64,
    /// Its 10th and 90th percentile.
    pub spread: [f64; 2],
}

impl Report {
    /// Returns the names of the meshes, in order.
    #[must_use]
    pub fn meshes(&self) -> Vec<&str> {
        distinct(self.builds.iter().map(|b| b.mesh.as_str()))
    }

    /// Returns the back ends, in order.
    #[must_use]
    pub fn backends(&self) -> Vec<Backend> {
        distinct(self.rows.iter().map(|r| r.backend))
    }

    /// Returns the numbers of threads, in order.
    #[must_use]
    pub fn threads(&self) -> Vec<usize> {
        distinct(self.builds.iter().map(|b| b.threads))
    }

    /// Returns the kinds of rays, in order.
    #[must_use]
    pub fn kinds(&self) -> Vec<&'static str> {
        distinct(self.rows.iter().map(|r| r.rays))
    }

    /// Returns the rows of one mesh, kind and number of threads.
    pub fn rows_of<'a>(&'a self, mesh: &'a str, rays: &'a str, threads: usize) -> impl Iterator<Item = &'a Row> {
        self.rows.iter().filter(move |r| r.mesh == mesh && r.rays == rays && r.threads == threads)
    }

    /// Returns the ratios of one mesh, kind and number of threads.
    pub fn ratios_of<'a>(&'a self, mesh: &'a str, rays: &'a str, threads: usize) -> impl Iterator<Item = &'a Ratio> {
        self.ratios.iter().filter(move |r| r.mesh == mesh && r.rays == rays && r.threads == threads)
    }

    /// Returns the number of triangles of a mesh.
    #[must_use]
    pub fn triangles(&self, mesh: &str) -> usize {
        self.rows.iter().find(|r| r.mesh == mesh).map_or(0, |r| r.triangles)
    }
}

/// Writes a back end by its name in comparisons.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
pub(super) fn mode_name<S: serde::Serializer>(backend: &Backend, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(backend.mode_name())
}

/// Returns each item once, in the order of first appearance.
pub(super) fn distinct<T: PartialEq>(items: impl Iterator<Item = T>) -> Vec<T> {
    let mut seen = Vec::new();
    for item in items {
        if !seen.contains(&item) {
            seen.push(item);
        }
    }
    seen
}

/// A constructed report, for tests of its presentations.
#[cfg(test)]
pub(super) fn example() -> Report {
    let embree = crate::accel::embree::Installed {
        version: "4.4.0".into(),
        isa: "AVX-512",
        tasking: "TBB",
        file: "libembree4.so.4".into(),
        found_by: "system",
    };
    let mesh = || String::from("a<b");
    let row = |rays, backend, mode, mrays_per_s| Row {
        mesh: mesh(),
        triangles: 69_630,
        rays,
        backend,
        mode,
        threads: 1,
        mrays_per_s,
        spread: [mrays_per_s * 0.9, mrays_per_s * 1.1],
    };
    let build =
        |backend, quality, ms| Build { mesh: mesh(), backend, quality, threads: 1, ms, bytes_per_triangle: 64.25 };
    let ratio = |rays, against, ratio| Ratio {
        mesh: mesh(),
        rays,
        threads: 1,
        against,
        embree_mode: Mode::Only("16c"),
        ratio,
        spread: [ratio - 0.05, ratio + 0.05],
    };
    Report {
        machine: Machine { cpu: "A CPU".into(), processors: 2, simd: "AVX2 + FMA", vitrum: "0", embree: Some(embree) },
        rows: vec![
            row("primary", Backend::Native, Mode::Auto, 20.0),
            row("primary", Backend::Native, Mode::Only("single"), 8.0),
            row("primary", Backend::Embree, Mode::Auto, 15.0),
            row("primary", Backend::Embree, Mode::Only("16c"), 16.0),
            row("primary", Backend::EmbreeFast, Mode::Only("16c"), 25.0),
            row("diffuse", Backend::Native, Mode::Auto, 4.0),
            row("diffuse", Backend::Embree, Mode::Only("16c"), 5.0),
        ],
        builds: vec![build(Backend::Native, "default", 50.0), build(Backend::Embree, "medium", 40.0)],
        ratios: vec![
            ratio("primary", Backend::Embree, 1.25),
            ratio("primary", Backend::EmbreeFast, 0.8),
            ratio("diffuse", Backend::Embree, 0.8),
        ],
    }
}
