//! The machine and the build, for reports.

use crate::accel::embree::Installed;
use crate::simd::level;

/// The machine and the build that measured.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Machine {
    /// The CPU's own name, by CPUID.
    pub cpu: String,
    /// Processors that this process may use.
    pub processors: usize,
    /// The instruction set that the binary was built for.
    pub simd: &'static str,
    /// The version of this program.
    pub vitrum: &'static str,
    /// Embree, where it takes part.
    pub embree: Option<Installed>,
}

impl Machine {
    /// Describes this machine.
    #[must_use]
    pub fn this(embree: Option<Installed>) -> Self {
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
