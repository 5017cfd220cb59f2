//! Memory that this process may still take: the smallest of the limits that the system sets.
//!
//! Nothing here allocates, so that it can be read when an allocation has just failed.

use std::fmt;

/// A limit on memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// `RLIMIT_AS`, set by `ulimit -v`.
    AddressSpace,
    /// `RLIMIT_DATA`, set by `ulimit -d`.
    Data,
    /// The memory controller of a control group.
    Group,
    /// Memory and swap of the machine that nothing else uses.
    Machine,
}

impl Bound {
    /// Every bound.
    const ALL: [Self; 4] = [Self::AddressSpace, Self::Data, Self::Group, Self::Machine];

    /// The bounds that count memory when it is mapped. The others count it when it is first written.
    const OF_MAPPINGS: [Self; 2] = [Self::AddressSpace, Self::Data];

    /// A way to raise it, as the start of a cure.
    #[must_use]
    pub fn cure(self) -> &'static str {
        match self {
            Self::AddressSpace => "raise the limit (`ulimit -v`)",
            Self::Data => "raise the limit (`ulimit -d`)",
            Self::Group => "raise the memory limit of the control group",
            Self::Machine => "end other programs",
        }
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AddressSpace => "under the limit on address space",
            Self::Data => "under the limit on data",
            Self::Group => "in the control group",
            Self::Machine => "on this machine",
        })
    }
}

/// Bytes that are left, and the bound that leaves the fewest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Left {
    /// Bytes.
    pub bytes: u64,
    /// The bound.
    pub bound: Bound,
}

/// Bytes that this process may still take. `None` where the system tells of no limit.
#[must_use]
pub fn left() -> Option<Left> {
    least(&Bound::ALL)
}

/// Bytes that this process may still map, written or not. `None` where no limit is set.
#[must_use]
pub fn left_to_map() -> Option<Left> {
    least(&Bound::OF_MAPPINGS)
}

fn least(bounds: &[Bound]) -> Option<Left> {
    let known = bounds.iter().filter_map(|&bound| Some(Left { bytes: by(bound)?, bound }));
    known.min_by_key(|left| left.bytes)
}

/// Returns true if a limit on address space is set.
#[must_use]
pub fn address_space_is_limited() -> bool {
    #[cfg(target_os = "linux")]
    return linux::limit(rustix::process::Resource::As).is_some();
    #[cfg(not(target_os = "linux"))]
    false
}

#[cfg(not(target_os = "linux"))]
fn by(_: Bound) -> Option<u64> {
    None
}

#[cfg(target_os = "linux")]
fn by(bound: Bound) -> Option<u64> {
    use rustix::process::Resource;
    let below = |limit: u64, used: Option<u64>| Some(limit.saturating_sub(used?));
    match bound {
        Bound::AddressSpace => below(linux::limit(Resource::As)?, linux::pages(0)),
        // The sixth column is data and stack; the kernel counts a little less.
        Bound::Data => below(linux::limit(Resource::Data)?, linux::pages(5)),
        Bound::Group => linux::group(),
        Bound::Machine => linux::machine(),
    }
}

#[cfg(target_os = "linux")]
mod linux {
    use std::fs::File;
    use std::io::Read as _;

    use rustix::process::{Resource, getrlimit};

    /// Longest path of a control group's file that is read.
    const LONGEST_PATH: usize = 300;

    pub(super) fn limit(resource: Resource) -> Option<u64> {
        getrlimit(resource).current
    }

    /// A column of `/proc/self/statm`, in bytes.
    pub(super) fn pages(column: usize) -> Option<u64> {
        let mut buffer = [0; 256];
        let count: u64 = text(b"/proc/self/statm", &mut buffer)?.split_ascii_whitespace().nth(column)?.parse().ok()?;
        Some(count * rustix::param::page_size() as u64)
    }

    pub(super) fn machine() -> Option<u64> {
        let mut buffer = [0; 4096];
        let text = text(b"/proc/meminfo", &mut buffer)?;
        let kibibytes = |name: &str| value(text, name);
        let free = kibibytes("MemAvailable:")? + kibibytes("SwapFree:").unwrap_or(0);
        // Where the system promises no more memory than it has, what is promised to all counts.
        let mut buffer = [0; 16];
        let strict = self::text(b"/proc/sys/vm/overcommit_memory", &mut buffer).is_some_and(|mode| mode.trim() == "2");
        let promised = kibibytes("CommitLimit:").zip(kibibytes("Committed_AS:")).filter(|_| strict);
        Some(promised.map_or(free, |(limit, used)| free.min(limit.saturating_sub(used))) << 10)
    }

    /// The least that this process's control group, or one that holds it, leaves.
    pub(super) fn group() -> Option<u64> {
        let mut buffer = [0; 4096];
        let groups = text(b"/proc/self/cgroup", &mut buffer)?;
        let mut least = None;
        for line in groups.lines() {
            // `0::/path` for version 2, `4:memory:/path` for version 1.
            let mut parts = line.splitn(3, ':').skip(1);
            let (Some(controllers), Some(path)) = (parts.next(), parts.next()) else { continue };
            let files = match controllers {
                "" => &VERSION_2,
                list if list.split(',').any(|name| name == "memory") => &VERSION_1,
                _ => continue,
            };
            let mut path = path.trim_end_matches('/');
            loop {
                let left = files.left(path);
                least = least.into_iter().chain(left).min();
                let Some(parent) = path.rfind('/') else { break };
                path = &path[..parent];
            }
        }
        least
    }

    /// Names of a control group's files.
    struct Files {
        roots: &'static [&'static str],
        limit: &'static str,
        used: &'static str,
        /// Entries of `memory.stat` that count as used and are given back on demand.
        cache: [&'static str; 2],
    }

    const VERSION_2: Files = Files {
        roots: &["/sys/fs/cgroup"],
        limit: "memory.max",
        used: "memory.current",
        cache: ["inactive_file", "active_file"],
    };

    const VERSION_1: Files = Files {
        roots: &["/sys/fs/cgroup/memory"],
        limit: "memory.limit_in_bytes",
        used: "memory.usage_in_bytes",
        cache: ["total_inactive_file", "total_active_file"],
    };

    impl Files {
        /// Bytes that the group at `path` leaves; none where it has no limit.
        fn left(&self, path: &str) -> Option<u64> {
            self.roots.iter().find_map(|root| {
                let mut buffer = [0; 8192];
                let mut read = |name: &str| -> Option<u64> {
                    let mut file = [0; LONGEST_PATH];
                    text(joined([root, path, "/", name], &mut file)?, &mut buffer)?.trim().parse().ok()
                };
                let (limit, used) = (read(self.limit)?, read(self.used)?);
                let mut file = [0; LONGEST_PATH];
                let stat = joined([root, path, "/", "memory.stat"], &mut file).and_then(|f| text(f, &mut buffer));
                let cache = |name| stat.and_then(|text| value(text, name)).unwrap_or(0);
                let cached = cache(self.cache[0]) + cache(self.cache[1]);
                Some(limit.saturating_sub(used.saturating_sub(cached)))
            })
        }
    }

    /// The number behind `name` at the start of a line.
    fn value(text: &str, name: &str) -> Option<u64> {
        text.lines().find_map(|line| {
            let mut words = line.split_ascii_whitespace();
            (words.next() == Some(name)).then(|| words.next()?.parse().ok())?
        })
    }

    fn joined<'b>(parts: [&str; 4], buffer: &'b mut [u8; LONGEST_PATH]) -> Option<&'b [u8]> {
        let mut end = 0;
        for part in parts {
            buffer.get_mut(end..end + part.len())?.copy_from_slice(part.as_bytes());
            end += part.len();
        }
        Some(&buffer[..end])
    }

    /// As much of a file's text as the buffer holds.
    fn text<'b>(path: &[u8], buffer: &'b mut [u8]) -> Option<&'b str> {
        use std::os::unix::ffi::OsStrExt as _;
        let path = std::path::Path::new(std::ffi::OsStr::from_bytes(path));
        let mut file = File::open(path).ok()?;
        let mut end = 0;
        while end < buffer.len() {
            match file.read(&mut buffer[end..]).ok()? {
                0 => break,
                n => end += n,
            }
        }
        std::str::from_utf8(&buffer[..end]).ok()
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn a_number_is_found_by_its_name_at_the_start_of_a_line() {
            let text = "MemTotal:  100 kB\nMemAvailable:   42 kB\ninactive_file 7\n";
            assert_eq!((value(text, "MemAvailable:"), value(text, "inactive_file")), (Some(42), Some(7)));
            assert_eq!((value(text, "Mem"), value(text, "SwapFree:")), (None, None));
        }

        #[test]
        fn parts_that_are_longer_than_a_path_are_not_joined() {
            let mut buffer = [0; LONGEST_PATH];
            assert_eq!(joined(["/a", "/b", "/", "c"], &mut buffer), Some(&b"/a/b/c"[..]));
            assert_eq!(joined([&"a".repeat(LONGEST_PATH), "/b", "/", "c"], &mut buffer), None);
        }

        #[test]
        fn what_is_mapped_counts_as_used() {
            let before = pages(0).unwrap();
            let room = std::hint::black_box(Vec::<u8>::with_capacity(64 << 20));
            assert!(pages(0).unwrap() >= before + (64 << 20));
            drop(room);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn a_machine_leaves_some_memory_and_says_which_bound_leaves_the_least() {
        let least = left().unwrap();
        assert!(least.bytes > 0);
        for bound in Bound::ALL {
            assert!(by(bound).is_none_or(|bytes| bytes > 0), "{bound:?}");
        }
    }
}
