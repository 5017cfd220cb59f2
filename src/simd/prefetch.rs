//! Asking for memory before it is needed.

/// Asks the caches for a value that will soon be read. Says nothing else: nothing is read, and where a CPU knows no
/// such wish, nothing is done.
#[inline(always)]
pub fn prefetch<T>(value: &T) {
    #[cfg(target_arch = "x86_64")]
    for line in 0..size_of::<T>().div_ceil(64) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let start = std::ptr::from_ref(value).cast::<i8>();
        // SAFETY: a hint to the cache on an address within `value`, or up to 63 bytes past its end; it never faults.
        unsafe { _mm_prefetch(start.wrapping_add(64 * line), _MM_HINT_T0) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = value;
}

#[cfg(test)]
mod tests {
    #[test]
    fn any_value_may_be_asked_for() {
        let values = [7_u64; 100];
        for value in &values {
            super::prefetch(value);
        }
        super::prefetch(&values);
        super::prefetch(&());
        assert_eq!(values, [7; 100]);
    }
}
