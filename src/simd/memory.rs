//! Hints to the memory system: prefetches and large pages.

#![allow(unsafe_code, reason = "hints to the operating system about memory")]

/// Prefetches `value` into the L1 cache. No-op on targets without a prefetch instruction.
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

/// Allocates an empty vector with capacity for `count` values, and asks the operating system for large pages. Traversal of a
/// tree of many megabytes then causes fewer TLB misses. On systems without large pages the hint is left out.
#[must_use]
pub fn room_for<T>(count: usize) -> Vec<T> {
    let room = Vec::with_capacity(count);
    #[cfg(target_os = "linux")]
    {
        /// The largest page size of Linux systems; the range of the hint must begin and end at a page.
        const PAGE: usize = 65_536;
        let start = room.as_ptr() as usize;
        let (first, end) = (start.next_multiple_of(PAGE), (start + count * size_of::<T>()) / PAGE * PAGE);
        if first < end {
            // SAFETY: the pages lie within the vector's own memory, and the call changes nothing that a program can read
            // in them. The result is ignored: the call is only a hint.
            unsafe { libc::madvise(std::ptr::without_provenance_mut(first), end - first, libc::MADV_HUGEPAGE) };
        }
    }
    room
}

#[cfg(test)]
mod tests {
    #[test]
    fn there_is_room_for_what_was_asked_for() {
        for count in [0, 1, 1000, 3_000_000] {
            let mut room = super::room_for::<u64>(count);
            assert!(room.capacity() >= count);
            let before = room.as_ptr();
            room.extend(0..count as u64);
            assert!(room.as_ptr() == before && room.iter().zip(0..).all(|(&x, i)| x == i));
        }
        assert_eq!(super::room_for::<()>(7), []);
    }

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
