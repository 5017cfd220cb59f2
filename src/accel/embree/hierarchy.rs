//! Embree's hierarchy over shapes, and the tracing of ray streams.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Instant;

use super::device::Device;
use super::fill::{Filling, Renamed};
use super::installed::Installed;
use super::library::Library;
use super::options::{Mode, Options, Width};
use super::packet::{self, Interval};
use super::reach;
use super::scene::{Scene, SceneBuilder};
use super::sys::{self, QueryArguments};
use crate::accel::{BuildStats, Coherence, Counts, Intersector};
use crate::error::Result;
use crate::geometry::{Geometry, GeometryMask, Hit, Hit8, Ray8};
use crate::simd::{Mask8, set_lanes};
use crate::system::memory;

/// Bytes that a build takes for each primitive: positions, indices, references and nodes.
const BYTES_EACH: usize = 320;

/// Embree's hierarchy over shapes. Clones share it.
#[derive(Clone)]
pub struct Embree {
    /// One scene with all shapes. If the library ignores masks, one scene for each mask that occurs.
    pub(super) parts: Arc<[(GeometryMask, Scene)]>,
    /// Geometry ids of Embree whose hits get other ids.
    renamed: Arc<[Renamed]>,
    pub(super) mode: Mode,
    width: Width,
    native16: bool,
    stats: BuildStats,
    library: &'static Library,
}

/// Structs for calls to Embree. Only some of their fields change between calls.
pub struct Scratch {
    one: sys::RtcRayHit1,
    eight: sys::RtcRayHit8,
    sixteen: sys::RtcRayHit16,
}

impl Default for Scratch {
    fn default() -> Self {
        use bytemuck::Zeroable;
        Self { one: sys::RtcRayHit1::zeroed(), eight: sys::RtcRayHit8::zeroed(), sixteen: sys::RtcRayHit16::zeroed() }
    }
}

impl Embree {
    /// Builds a hierarchy over the meshes and spheres of `geometry`. Planes are ignored;
    /// [`Unbounded`](crate::accel::unbounded::Unbounded) adds them.
    ///
    /// # Errors
    /// [`Unavailable`](crate::error::Unavailable) if the library is missing or unfit, if a shape reaches beyond
    /// [`reach::MOST`], or if all meshes lie within [`reach::LEAST`]; a limit if memory runs out.
    pub fn build(geometry: &[Geometry], options: &Options) -> Result<Self> {
        let library = Library::open(options.library.as_deref())?;
        Self::build_with(geometry, options, library, library.masks)
    }

    /// Builds as [`Embree::build`] does. Without `masks`, each mask that occurs gets a scene of its own.
    pub(super) fn build_with(
        geometry: &[Geometry],
        options: &Options,
        library: &'static Library,
        masks: bool,
    ) -> Result<Self> {
        if !options.even_lost {
            reach::check(geometry)?;
        }
        let counts = Counts::of(geometry);
        let bytes = (counts.triangles + counts.spheres).saturating_mul(BYTES_EACH);
        memory::need(&counts.named("Embree's hierarchy over"), bytes as u64, counts.cure())?;
        let device = Device::open(library, options.threads, options.frequency, options.isa)?;
        let start = Instant::now();
        let kinds: BTreeSet<u8> = geometry.iter().map(|g| g.mask.0).collect();
        let mut filling = Filling { options, stats: BuildStats::default(), renamed: Vec::new(), copied: 0 };
        let mut scenes: Vec<(GeometryMask, SceneBuilder)> = Vec::new();
        // Groups of spheres get the ids after those of the list.
        for (group, kind) in (geometry.len() as u32..).zip(kinds.into_iter().map(GeometryMask)) {
            if scenes.is_empty() || !masks {
                let scene = SceneBuilder::new(&device, options.mode == Mode::Robust, options.quality)?;
                scenes.push((if masks { GeometryMask(u8::MAX) } else { kind }, scene));
            }
            if let Some((_, scene)) = scenes.last_mut() {
                filling.fill(scene, geometry, kind, group)?;
            }
        }
        let parts = scenes.into_iter().map(|(kind, scene)| Ok((kind, scene.commit()?))).collect::<Result<Arc<_>>>()?;
        let Filling { mut stats, renamed, copied, .. } = filling;
        stats.bytes = device.bytes().saturating_sub(copied);
        stats.time = start.elapsed();
        Ok(Self {
            parts,
            renamed: renamed.into(),
            mode: options.mode,
            width: options.width,
            native16: device.native16(),
            stats,
            library,
        })
    }

    /// Returns the same hierarchy, traced by calls of this width.
    #[must_use]
    pub fn with_width(&self, width: Width) -> Self {
        Self { width, ..self.clone() }
    }

    /// Description of the library.
    #[must_use]
    pub fn library(&self) -> Installed {
        self.library.installed()
    }
}

impl Intersector for Embree {
    type Scratch = Scratch;

    fn closest(&self, rays: &[Ray8], hits: &mut [Hit8], coherence: Coherence, scratch: &mut Scratch) {
        assert_eq!(rays.len(), hits.len(), "as many packets of hits as of rays");
        let query = query(coherence);
        if self.takes_pairs(coherence) {
            let (pairs, rest) = rays.as_chunks::<2>();
            let (hit_pairs, hit_rest) = hits.as_chunks_mut::<2>();
            for (pair, hits) in pairs.iter().zip(hit_pairs) {
                self.closest16(pair, hits, &query, scratch);
            }
            for (packet, hits) in rest.iter().zip(hit_rest) {
                self.closest8(packet, hits, &query, scratch);
            }
        } else {
            for (packet, hits) in rays.iter().zip(hits.iter_mut()) {
                self.closest8(packet, hits, &query, scratch);
            }
        }
        if !self.renamed.is_empty() {
            for (packet, hits) in rays.iter().zip(hits) {
                self.rename(packet.active, hits);
            }
        }
    }

    fn occluded(&self, rays: &[Ray8], blocked: &mut [Mask8], coherence: Coherence, scratch: &mut Scratch) {
        assert_eq!(rays.len(), blocked.len(), "as many masks as packets of rays");
        let query = query(coherence);
        if self.takes_pairs(coherence) {
            let (pairs, rest) = rays.as_chunks::<2>();
            let (blocked_pairs, blocked_rest) = blocked.as_chunks_mut::<2>();
            for (pair, blocked) in pairs.iter().zip(blocked_pairs) {
                *blocked = self.occluded16(pair, &query, scratch);
            }
            for (packet, blocked) in rest.iter().zip(blocked_rest) {
                *blocked = self.occluded8(packet, &query, scratch);
            }
        } else {
            for (packet, blocked) in rays.iter().zip(blocked) {
                *blocked = self.occluded8(packet, &query, scratch);
            }
        }
    }

    /// Embree does not report its nodes, leaves and depth, so these are 0. `bytes` is the memory that it holds beyond
    /// the coordinates and indices that were copied to it.
    fn build_stats(&self) -> BuildStats {
        self.stats
    }
}

impl Embree {
    /// Returns true if packets are traced in pairs, by sixteen-wide calls.
    #[inline]
    fn takes_pairs(&self, coherence: Coherence) -> bool {
        match self.width {
            Width::Auto => self.native16 && coherence == Coherence::Coherent,
            width => width == Width::Sixteen,
        }
    }

    /// Scenes with shapes that rays with this mask can hit.
    #[inline(always)]
    fn parts(&self, admits: GeometryMask) -> impl Iterator<Item = &Scene> {
        self.parts.iter().filter(move |(kind, _)| kind.meets(admits)).map(|(_, scene)| scene)
    }

    /// Traces a pair of packets. Hits in earlier scenes shorten the rays for later ones.
    #[inline(always)]
    fn closest16(&self, rays: &[Ray8; 2], hits: &mut [Hit8; 2], query: &QueryArguments, scratch: &mut Scratch) {
        let intervals = [Interval::of(&rays[0], self.mode), Interval::of(&rays[1], self.mode)];
        let [a, b] = intervals.map(|i| i.live);
        if a == 0 || b == 0 || rays[0].admits != rays[1].admits {
            self.closest8(&rays[0], &mut hits[0], query, scratch);
            self.closest8(&rays[1], &mut hits[1], query, scratch);
            return;
        }
        let sixteen = &mut scratch.sixteen;
        sixteen.hit.clear();
        for half in 0..2 {
            sixteen.ray.load(half, &rays[half], &intervals[half]);
        }
        let valid = packet::valid(u16::from_le_bytes([a, b]));
        for scene in self.parts(rays[0].admits) {
            scene.intersect16(&valid, sixteen, query);
        }
        for half in 0..2 {
            sixteen.hit.store(&sixteen.ray, half, rays[half].active, &mut hits[half]);
        }
    }

    /// Traces one packet, by one call or ray by ray.
    #[inline(always)]
    fn closest8(&self, rays: &Ray8, hits: &mut Hit8, query: &QueryArguments, scratch: &mut Scratch) {
        let interval = Interval::of(rays, self.mode);
        if self.goes_singly(interval.live) {
            for i in set_lanes(rays.active & !interval.live) {
                hits.set_lane(i, &Hit::MISS);
            }
            for i in set_lanes(interval.live) {
                let one = &mut scratch.one;
                one.load(i, rays, &interval);
                for scene in self.parts(rays.admits) {
                    scene.intersect1(one, query);
                }
                hits.set_lane(i, &one.hit());
            }
            return;
        }
        let eight = &mut scratch.eight;
        eight.hit.clear();
        eight.ray.load(0, rays, &interval);
        let valid = packet::valid(interval.live.into());
        for scene in self.parts(rays.admits) {
            scene.intersect8(&valid, eight, query);
        }
        eight.hit.store(&eight.ray, 0, rays.active, hits);
    }

    /// Tests a pair of packets for occlusion.
    #[inline(always)]
    fn occluded16(&self, rays: &[Ray8; 2], query: &QueryArguments, scratch: &mut Scratch) -> [Mask8; 2] {
        let intervals = [Interval::of(&rays[0], self.mode), Interval::of(&rays[1], self.mode)];
        let [a, b] = intervals.map(|i| i.live);
        if a == 0 || b == 0 || rays[0].admits != rays[1].admits {
            return [self.occluded8(&rays[0], query, scratch), self.occluded8(&rays[1], query, scratch)];
        }
        let sixteen = &mut scratch.sixteen.ray;
        for half in 0..2 {
            sixteen.load(half, &rays[half], &intervals[half]);
        }
        let valid = packet::valid(u16::from_le_bytes([a, b]));
        for scene in self.parts(rays[0].admits) {
            scene.occluded16(&valid, sixteen, query);
        }
        [sixteen.blocked(0, a), sixteen.blocked(1, b)]
    }

    /// Tests one packet for occlusion, by one call or ray by ray.
    #[inline(always)]
    fn occluded8(&self, rays: &Ray8, query: &QueryArguments, scratch: &mut Scratch) -> Mask8 {
        let interval = Interval::of(rays, self.mode);
        if self.goes_singly(interval.live) {
            let mut blocked = 0;
            for i in set_lanes(interval.live) {
                let one = &mut scratch.one;
                one.load(i, rays, &interval);
                for scene in self.parts(rays.admits) {
                    scene.occluded1(&mut one.ray, query);
                }
                blocked |= u8::from(one.ray.tfar[0] < 0.0) << i;
            }
            return Mask8::from_bits(blocked);
        }
        let eight = &mut scratch.eight.ray;
        eight.load(0, rays, &interval);
        let valid = packet::valid(interval.live.into());
        for scene in self.parts(rays.admits) {
            scene.occluded8(&valid, eight, query);
        }
        eight.blocked(0, interval.live)
    }

    /// Returns true if the active lanes of a packet are traced one by one.
    #[inline(always)]
    fn goes_singly(&self, live: u8) -> bool {
        self.width == Width::One || live & live.wrapping_sub(1) == 0
    }

    /// Replaces Embree's ids by those of the caller's list.
    pub(super) fn rename(&self, active: u8, hits: &mut Hit8) {
        for i in set_lanes(active) {
            if let Some(renamed) = self.renamed.iter().find(|r| r.id == hits.geometry[i]) {
                (hits.geometry[i], hits.primitive[i]) = renamed.names[hits.primitive[i] as usize];
            }
        }
    }
}

/// Query arguments with the flag for this coherence.
pub(super) fn query(coherence: Coherence) -> QueryArguments {
    QueryArguments::new(match coherence {
        Coherence::Coherent => sys::QUERY_COHERENT,
        Coherence::Incoherent => sys::QUERY_INCOHERENT,
    })
}
