//! What it all runs on.

use crate::simd::level;

/// The machine and the build, as reports have them.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Machine {
    /// The CPU's own name, by CPUID.
    pub cpu: String,
    /// Processors that this process may use.
    pub processors: usize,
    /// What the binary was built for.
    pub simd: &'static str,
    /// The version of this program.
    pub vitrum: &'static str,
    /// Embree, where it takes part.
    pub embree: Option<Embree>,
}

/// The Embree that was found.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Embree {
    /// Major, minor and patch.
    pub version: String,
    /// The widest instructions that it traces packets with.
    pub isa: &'static str,
    /// Its tasking system.
    pub tasking: &'static str,
    /// The file it was loaded from.
    pub file: String,
    /// How that was found.
    pub found_by: &'static str,
}

impl Machine {
    /// This one.
    #[must_use]
    pub fn this(embree: Option<Embree>) -> Self {
        Self {
            cpu: cpu(),
            processors: std::thread::available_parallelism().map_or(1, usize::from),
            simd: level::BUILT,
            vitrum: env!("CARGO_PKG_VERSION"),
            embree,
        }
    }
}

/// The CPU's name for itself, or else its maker, or else the architecture.
#[must_use]
pub fn cpu() -> String {
    #[cfg(target_arch = "x86_64")]
    {
        let id = raw_cpuid::CpuId::new();
        let brand = id.get_processor_brand_string().map(|b| b.as_str().trim().to_owned());
        let vendor = || id.get_vendor_info().map(|v| v.as_str().to_owned());
        if let Some(name) = brand.filter(|name| !name.is_empty()).or_else(vendor) {
            return name;
        }
    }
    std::env::consts::ARCH.to_owned()
}

/// Loads Embree.
///
/// # Errors
/// [`crate::Error::Limit`] where the library is missing or unfit, or the program was built without the back end.
pub fn embree() -> crate::Result<Embree> {
    #[cfg(feature = "embree")]
    {
        let library = crate::accel::embree::device::Library::open(None)?;
        let [major, minor, patch] = library.version;
        let isa = match () {
            () if library.native16 => "AVX-512",
            #[cfg(target_arch = "x86_64")]
            () if std::arch::is_x86_feature_detected!("avx2") => "AVX2",
            () => "narrower than AVX2",
        };
        Ok(Embree {
            version: format!("{major}.{minor}.{patch}"),
            isa,
            tasking: library.tasking,
            file: library.file.display().to_string(),
            found_by: library.because,
        })
    }
    #[cfg(not(feature = "embree"))]
    Err(crate::Error::Limit(String::from(
        "Embree: this program was built without it; build with `cargo build --release --features embree`",
    )))
}
