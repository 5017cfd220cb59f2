//! The instruction set that this binary was built for, and the check that the machine has it.
//!
//! `wide` chooses its instructions at compile time, so that a binary built for one machine may hit an illegal instruction on
//! another. `is_x86_feature_detected!` cannot detect this: for a feature that the compiler assumes it is the constant `true`,
//! and the check is compiled away. So this module executes CPUID and XGETBV itself.
//!
//! [`check`] must run on a machine that lacks every feature. It processes one 32-bit word at a time, in functions that are not
//! inlined, with masks computed at compile time. So the compiler has no use for instructions beyond baseline x86-64.

#![allow(unsafe_code, reason = "CPUID and XGETBV")]

/// The instruction set this binary was built for, as reports name it.
pub const BUILT: &str = match (
    cfg!(target_arch = "x86_64"),
    cfg!(all(target_feature = "avx512f", target_feature = "avx512vl")),
    cfg!(target_feature = "avx2"),
    cfg!(target_feature = "avx"),
    cfg!(target_feature = "fma"),
) {
    (true, true, _, _, true) => "AVX-512 + FMA",
    (true, _, true, _, true) => "AVX2 + FMA",
    (true, _, true, _, false) => "AVX2 without FMA",
    (true, _, _, true, true) => "AVX + FMA",
    (true, _, _, true, false) => "AVX without FMA",
    (true, ..) => "SSE2 halves without FMA",
    _ if cfg!(target_arch = "aarch64") => "NEON halves",
    _ => "portable",
};

/// The cure if the build uses less than the machine offers.
pub const CURE: &str = "build with RUSTFLAGS=\"-C target-cpu=native\"";

/// Bits of `build` that `cpu` lacks; both in the layout of one CPUID register.
#[must_use]
pub fn missing(build: u32, cpu: u32) -> u32 {
    // Kept apart: NOT and AND would be combined into ANDN, which is one of the instructions in question.
    build & std::hint::black_box(!cpu)
}

/// Stops a binary on a machine that cannot run it. Call it before any vector code.
///
/// # Errors
/// The names of the missing features go to standard error, and the caller is to end with [`EXIT_CODE`].
#[inline(never)]
pub fn check() -> Result<(), Unfit> {
    #[cfg(target_arch = "x86_64")]
    x86::check()?;
    Ok(())
}

/// The error of [`check`], which has already printed the message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unfit;

/// Exit code of the program if [`check`] fails: a limit of this machine.
pub const EXIT_CODE: u8 = 4;

/// Names of the features that this binary needs; each is true if the machine has it.
#[must_use]
pub fn needed() -> Vec<(&'static str, bool)> {
    #[cfg(target_arch = "x86_64")]
    return x86::needed();
    #[cfg(not(target_arch = "x86_64"))]
    Vec::new()
}

/// The best instruction set that this machine supports, in the words of [`BUILT`].
#[must_use]
pub fn available() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    return x86::available();
    #[cfg(not(target_arch = "x86_64"))]
    BUILT
}

/// Returns, for 256-bit and for 512-bit registers, true if the operating system saves them (XCR0, by XGETBV). False if the
/// CPU has none.
#[must_use]
pub fn saved() -> [bool; 2] {
    #[cfg(target_arch = "x86_64")]
    return x86::saved();
    #[cfg(not(target_arch = "x86_64"))]
    [false; 2]
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::io::Write as _;

    use super::{Unfit, missing};

    /// The registers that hold feature bits, by CPUID leaf (Intel SDM vol. 2A, CPUID; AMD APM vol. 3, appendix E).
    #[derive(Clone, Copy, PartialEq, Eq)]
    enum Register {
        /// Leaf 1, ECX.
        C1,
        /// Leaf 7, EBX.
        B7,
        /// Leaf 7, ECX.
        C7,
        /// Leaf 7, EDX.
        D7,
        /// Leaf 7, sub-leaf 1, EAX.
        A71,
        /// Leaf 7, sub-leaf 1, EDX.
        D71,
        /// Leaf 0x8000_0001, ECX.
        C8,
    }

    use Register::{A71, B7, C1, C7, C8, D7, D71};

    const REGISTERS: [Register; 7] = [C1, B7, C7, D7, A71, D71, C8];

    /// The registers that the operating system must save on a task switch for a feature to be usable.
    #[derive(Clone, Copy, PartialEq, Eq)]
    enum State {
        /// Nothing beyond what every x86-64 system does.
        Base,
        /// XMM and YMM.
        Ymm,
        /// XMM, YMM, opmasks and ZMM.
        Zmm,
    }

    use State::{Base, Ymm, Zmm};

    struct Feature {
        name: &'static str,
        register: Register,
        /// Its bit, alone.
        mask: u32,
        state: State,
        needed: bool,
    }

    macro_rules! features {
        ($($name:tt $register:ident $bit:literal $state:ident,)*) => {
            &[$(Feature {
                name: $name,
                register: $register,
                mask: 1 << $bit,
                state: $state,
                needed: cfg!(target_feature = $name),
            },)*]
        };
    }

    /// Everything a stable compiler may assume of a CPU and put to use, kernel instructions apart.
    const FEATURES: &[Feature] = features![
        "sse3" C1 0 Base, "pclmulqdq" C1 1 Base, "ssse3" C1 9 Base, "fma" C1 12 Ymm, "cmpxchg16b" C1 13 Base,
        "sse4.1" C1 19 Base, "sse4.2" C1 20 Base, "movbe" C1 22 Base, "popcnt" C1 23 Base, "aes" C1 25 Base,
        "avx" C1 28 Ymm, "f16c" C1 29 Ymm, "rdrand" C1 30 Base,
        "bmi1" B7 3 Base, "avx2" B7 5 Ymm, "bmi2" B7 8 Base, "avx512f" B7 16 Zmm, "avx512dq" B7 17 Zmm,
        "rdseed" B7 18 Base, "adx" B7 19 Base, "avx512ifma" B7 21 Zmm, "avx512cd" B7 28 Zmm, "sha" B7 29 Base,
        "avx512bw" B7 30 Zmm, "avx512vl" B7 31 Zmm,
        "avx512vbmi" C7 1 Zmm, "avx512vbmi2" C7 6 Zmm, "gfni" C7 8 Base, "vaes" C7 9 Ymm, "vpclmulqdq" C7 10 Ymm,
        "avx512vnni" C7 11 Zmm, "avx512bitalg" C7 12 Zmm, "avx512vpopcntdq" C7 14 Zmm,
        "avx512vp2intersect" D7 8 Zmm, "avx512fp16" D7 23 Zmm,
        "sha512" A71 0 Ymm, "sm3" A71 1 Ymm, "sm4" A71 2 Ymm, "avxvnni" A71 4 Ymm, "avx512bf16" A71 5 Zmm,
        "avxifma" A71 23 Ymm,
        "avxvnniint8" D71 4 Ymm, "avxneconvert" D71 5 Ymm, "avxvnniint16" D71 10 Ymm,
        "lzcnt" C8 5 Base, "sse4a" C8 6 Base, "tbm" C8 21 Base,
    ];

    const fn needed_bits() -> [u32; 7] {
        let mut bits = [0; 7];
        let mut i = 0;
        while i < FEATURES.len() {
            let f = &FEATURES[i];
            if f.needed {
                bits[f.register as usize] |= f.mask;
            }
            i += 1;
        }
        bits
    }

    const fn all_but(state: State) -> [u32; 7] {
        let mut bits = [u32::MAX; 7];
        let mut i = 0;
        while i < FEATURES.len() {
            let f = &FEATURES[i];
            if f.state as u8 == state as u8 {
                bits[f.register as usize] &= !f.mask;
            }
            i += 1;
        }
        bits
    }

    /// For each register, the bits of the features that this build needs.
    static BUILD: [u32; 7] = needed_bits();
    /// All bits but those of features that need YMM to be saved.
    static WITHOUT_YMM: [u32; 7] = all_but(Ymm);
    /// All bits but those of features that need ZMM to be saved.
    static WITHOUT_ZMM: [u32; 7] = all_but(Zmm);

    /// Feature bits of the CPU, without those whose registers the operating system does not save.
    #[inline(never)]
    fn cpu(register: Register) -> u32 {
        usable(raw(register), register, state_saved())
    }

    /// `cpuid` with the bits taken out for which `xcr0`, the set of register states the system saves, is not enough.
    fn usable(cpuid: u32, register: Register, xcr0: u32) -> u32 {
        let mut bits = cpuid;
        if xcr0 & 0x06 != 0x06 {
            bits &= WITHOUT_YMM[register as usize];
        }
        if xcr0 & 0xe6 != 0xe6 {
            bits &= WITHOUT_ZMM[register as usize];
        }
        bits
    }

    /// The register as CPUID gives it; 0 where the CPU does not have the leaf.
    #[inline(never)]
    fn raw(register: Register) -> u32 {
        let (leaf, sub_leaf) = match register {
            C1 => (1, 0),
            B7 | C7 | D7 => (7, 0),
            A71 | D71 => (7, 1),
            C8 => (0x8000_0001, 0),
        };
        if cpuid_max(leaf & 0x8000_0000) < leaf || (sub_leaf == 1 && raw_cpuid::cpuid!(7_u32, 0_u32).eax < 1) {
            return 0;
        }
        let answer = raw_cpuid::cpuid!(leaf, sub_leaf);
        match register {
            A71 => answer.eax,
            B7 => answer.ebx,
            C1 | C7 | C8 => answer.ecx,
            D7 | D71 => answer.edx,
        }
    }

    /// The largest leaf of a range of leaves (0 or 0x8000_0000).
    #[inline(never)]
    fn cpuid_max(range: u32) -> u32 {
        raw_cpuid::cpuid!(range, 0_u32).eax
    }

    /// The low half of XCR0; 0 where the system has not enabled XGETBV.
    #[inline(never)]
    fn state_saved() -> u32 {
        const OSXSAVE: u32 = 1 << 27;
        if raw(C1) & OSXSAVE == 0 {
            return 0;
        }
        // SAFETY: XGETBV exists where CPUID.1:ECX.OSXSAVE is set, as was just seen; register 0 (XCR0) always does then.
        (unsafe { xgetbv() }) as u32
    }

    /// # Safety
    /// CPUID.1:ECX.OSXSAVE is set.
    #[target_feature(enable = "xsave")]
    #[inline(never)]
    unsafe fn xgetbv() -> u64 {
        // SAFETY: the caller's promise.
        unsafe { core::arch::x86_64::_xgetbv(0) }
    }

    #[inline(never)]
    pub(super) fn check() -> Result<(), Unfit> {
        let mut fit = true;
        for register in REGISTERS {
            fit &= missing(BUILD[register as usize], cpu(register)) == 0;
        }
        if fit { Ok(()) } else { Err(complain()) }
    }

    /// Writes piece by piece, without formatting: that would be compiled into this crate, with its instruction set.
    #[cold]
    #[inline(never)]
    fn complain() -> Unfit {
        say("error: this machine lacks");
        for f in FEATURES {
            if f.needed && missing(f.mask, cpu(f.register)) != 0 {
                say(" ");
                say(f.name);
            }
        }
        say(", which this program was built for; build it on this machine with RUSTFLAGS=\"-C target-cpu=native\"\n");
        Unfit
    }

    fn say(text: &str) {
        // Where standard error is closed, the exit code still tells.
        let _ = std::io::stderr().write_all(text.as_bytes());
    }

    pub(super) fn available() -> &'static str {
        let has = |name| FEATURES.iter().any(|f| f.name == name && missing(f.mask, cpu(f.register)) == 0);
        match (has("avx512f") && has("avx512vl"), has("avx2"), has("avx"), has("fma")) {
            (true, _, _, true) => "AVX-512 + FMA",
            (_, true, _, true) => "AVX2 + FMA",
            (_, true, _, false) => "AVX2 without FMA",
            (_, _, true, true) => "AVX + FMA",
            (_, _, true, false) => "AVX without FMA",
            _ => "SSE2 halves without FMA",
        }
    }

    pub(super) fn saved() -> [bool; 2] {
        let xcr0 = state_saved();
        [xcr0 & 0x06 == 0x06, xcr0 & 0xe6 == 0xe6]
    }

    pub(super) fn needed() -> Vec<(&'static str, bool)> {
        FEATURES.iter().filter(|f| f.needed).map(|f| (f.name, missing(f.mask, cpu(f.register)) == 0)).collect()
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn no_two_features_share_a_bit() {
            for (i, a) in FEATURES.iter().enumerate() {
                for b in &FEATURES[..i] {
                    assert!(a.register != b.register || a.mask != b.mask, "{} and {}", a.name, b.name);
                }
            }
        }

        #[test]
        fn what_the_system_does_not_save_counts_as_absent() {
            let (avx2, bmi2, avx512f) = (1 << 5, 1 << 8, 1 << 16);
            let all = avx2 | bmi2 | avx512f;
            assert_eq!(usable(all, B7, 0xe7), all);
            assert_eq!(usable(all, B7, 0x07), avx2 | bmi2);
            assert_eq!(usable(all, B7, 0x03), bmi2);
            assert_eq!(usable(all, B7, 0), bmi2);
        }

        /// On a build for less than this machine has, `is_x86_feature_detected!` asks the machine and is a second
        /// opinion; for the features the build assumes it is constant, and so are these tests' own instructions.
        #[test]
        fn the_standard_library_sees_the_same_machine() {
            macro_rules! agree {
                ($($name:tt)*) => {$({
                    let f = FEATURES.iter().find(|f| f.name == $name).unwrap();
                    let here = missing(f.mask, cpu(f.register)) == 0;
                    assert_eq!(here, std::is_x86_feature_detected!($name), "{}", $name);
                })*};
            }
            agree!("sse3" "ssse3" "sse4.1" "sse4.2" "popcnt" "avx" "avx2" "fma" "f16c" "bmi1" "bmi2" "lzcnt" "movbe");
            agree!("avx512f" "avx512dq" "avx512bw" "avx512vl" "avx512cd" "avx512vbmi" "avx512ifma" "aes" "sha" "adx");
            agree!("sse4a" "tbm" "rdrand" "rdseed" "pclmulqdq" "cmpxchg16b" "gfni" "vaes" "vpclmulqdq");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_is_what_the_build_has_and_the_cpu_has_not() {
        assert_eq!(missing(0b1100, 0b1010), 0b0100);
        assert_eq!(missing(0, 0), 0);
        assert_eq!(missing(u32::MAX, u32::MAX), 0);
        assert_eq!(missing(0, u32::MAX), 0);
    }

    #[test]
    fn the_machine_that_runs_this_test_is_fit_for_it() {
        assert_eq!(check(), Ok(()));
        assert!(needed().iter().all(|&(_, there)| there));
        let fma = needed().iter().any(|&(name, _)| name == "fma");
        assert_eq!(fma, BUILT.ends_with("+ FMA"), "{BUILT}");
    }
}
