//! Declarations of the Embree 4 structs and functions that the back end uses.
//!
//! The structs are those of 4.3 and later, whose hits end with `instPrimID` (headers `rtcore_ray.h`,
//! `rtcore_geometry.h`, `rtcore_scene.h`). An older library writes less, which is harmless. A library that writes more,
//! because it was built for several instance levels, is detected when it is opened. Names are those of C in Rust's
//! spelling.

#![allow(unsafe_code, reason = "the types and functions of the Embree library")]

use std::ffi::{c_char, c_int, c_uint, c_void};

/// Value of `geom_id` on a miss.
pub const INVALID_GEOMETRY: u32 = u32::MAX;

/// Device: an opaque object of Embree, known by address only.
pub type RtcDevice = *mut c_void;
/// Scene; see [`RtcDevice`].
pub type RtcScene = *mut c_void;
/// Geometry; see [`RtcDevice`].
pub type RtcGeometry = *mut c_void;

/// `RTC_DEVICE_PROPERTY_VERSION`: major * 10000 + minor * 100 + patch.
pub const PROPERTY_VERSION: c_int = 0;
/// `RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED`: not 0 if 16-wide packets are traversed 16 wide.
pub const PROPERTY_NATIVE_RAY16: c_int = 34;
/// `RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED`: not 0 if ray masks are tested.
pub const PROPERTY_RAY_MASK: c_int = 64;
/// `RTC_DEVICE_PROPERTY_BACKFACE_CULLING_ENABLED`: not 0 if back faces are culled; such a library is refused.
pub const PROPERTY_BACKFACE_CULLING: c_int = 65;
/// `RTC_DEVICE_PROPERTY_TASKING_SYSTEM`: 0 for Embree's own, 1 for TBB, 2 for PPL.
pub const PROPERTY_TASKING_SYSTEM: c_int = 128;

/// `RTC_GEOMETRY_TYPE_TRIANGLE`.
pub const TYPE_TRIANGLE: c_int = 0;
/// `RTC_GEOMETRY_TYPE_SPHERE_POINT`.
pub const TYPE_SPHERE_POINT: c_int = 50;
/// `RTC_GEOMETRY_TYPE_USER`.
pub const TYPE_USER: c_int = 120;

/// `RTC_BUFFER_TYPE_INDEX`.
pub const BUFFER_INDEX: c_int = 0;
/// `RTC_BUFFER_TYPE_VERTEX`.
pub const BUFFER_VERTEX: c_int = 1;

/// `RTC_FORMAT_UINT3`.
pub const FORMAT_UINT3: c_int = 0x5003;
/// `RTC_FORMAT_FLOAT3`.
pub const FORMAT_FLOAT3: c_int = 0x9003;
/// `RTC_FORMAT_FLOAT4`.
pub const FORMAT_FLOAT4: c_int = 0x9004;

/// `RTC_SCENE_FLAG_ROBUST`.
pub const SCENE_ROBUST: c_int = 1 << 2;

/// `RTC_RAY_QUERY_FLAG_INCOHERENT`.
pub const QUERY_INCOHERENT: c_int = 0;
/// `RTC_RAY_QUERY_FLAG_COHERENT`.
pub const QUERY_COHERENT: c_int = 1 << 16;

/// `RTC_FEATURE_FLAG_ALL`.
pub const FEATURE_ALL: c_int = -1;

/// Lane mask of a packet call: -1 for active lanes, else 0. Aligned for the widest packet.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub struct Valid<const N: usize>(pub [c_int; N]);

/// Declares rays, hits, and rays with hits, `$n` wide. Single rays have arrays of length 1.
macro_rules! packet {
    ($n:literal, $align:literal, $ray:ident, $hit:ident, $ray_hit:ident, $ray_size:literal, $ray_hit_size:literal) => {
        #[doc = concat!("`RTCRay", $n, "` (`RTCRay` for 1).")]
        #[derive(Clone, Copy, bytemuck::Zeroable)]
        #[repr(C, align($align))]
        pub struct $ray {
            pub org_x: [f32; $n],
            pub org_y: [f32; $n],
            pub org_z: [f32; $n],
            /// Smallest parameter, inclusive in robust mode, exclusive in fast mode.
            pub tnear: [f32; $n],
            pub dir_x: [f32; $n],
            pub dir_y: [f32; $n],
            pub dir_z: [f32; $n],
            pub time: [f32; $n],
            /// Largest parameter, inclusive. On return, that of the hit, or -inf if an occlusion call hit anything.
            pub tfar: [f32; $n],
            pub mask: [u32; $n],
            pub id: [u32; $n],
            pub flags: [u32; $n],
        }

        #[doc = concat!("`RTCHit", $n, "` (`RTCHit` for 1), 4.3 and later.")]
        #[derive(Clone, Copy, bytemuck::Zeroable)]
        #[repr(C, align($align))]
        pub struct $hit {
            pub ng_x: [f32; $n],
            pub ng_y: [f32; $n],
            pub ng_z: [f32; $n],
            /// Barycentric weight of the second corner.
            pub u: [f32; $n],
            /// Barycentric weight of the third corner.
            pub v: [f32; $n],
            pub prim_id: [u32; $n],
            pub geom_id: [u32; $n],
            pub inst_id: [u32; $n],
            /// Field that 4.2 does not have.
            pub inst_prim_id: [u32; $n],
        }

        #[doc = concat!("`RTCRayHit", $n, "` (`RTCRayHit` for 1).")]
        #[derive(Clone, Copy, bytemuck::Zeroable)]
        #[repr(C)]
        pub struct $ray_hit {
            pub ray: $ray,
            pub hit: $hit,
        }

        const _: () = assert!(size_of::<$ray>() == $ray_size && align_of::<$ray>() == $align);
        const _: () = assert!(size_of::<$ray_hit>() == $ray_hit_size && align_of::<$ray_hit>() == $align);
        const _: () = assert!(std::mem::offset_of!($ray_hit, hit) == 12 * 4 * $n);
        const _: () = assert!(std::mem::offset_of!($hit, inst_prim_id) == 8 * 4 * $n);
    };
}

packet!(1, 16, RtcRay1, RtcHit1, RtcRayHit1, 48, 96);
packet!(8, 32, RtcRay8, RtcHit8, RtcRayHit8, 384, 672);
packet!(16, 64, RtcRay16, RtcHit16, RtcRayHit16, 768, 1344);

/// Size in bytes of a ray with hit, for widths 1, 8 and 16. A library may write no byte from there on. (A single hit
/// has padding at its end, which libraries do not write.)
pub const RAY_HIT_ENDS: [usize; 3] = [84, size_of::<RtcRayHit8>(), size_of::<RtcRayHit16>()];

/// The same sizes in 4.2 and in the crate `embree4-rs` 0.0.16: too small by 4, 32 and 64 bytes.
pub const RAY_HIT_ENDS_4_2: [usize; 3] = [80, 640, 1280];

/// `RTCIntersectArguments` and `RTCOccludedArguments`, which have the same layout.
#[repr(C)]
pub struct QueryArguments {
    pub flags: c_int,
    pub feature_mask: c_int,
    pub context: *mut c_void,
    pub filter: *mut c_void,
    pub callback: *mut c_void,
    /// Present only in libraries built with `RTC_MIN_WIDTH`; others do not read it.
    pub min_width_distance_factor: f32,
}

impl QueryArguments {
    /// Creates arguments with these flags and no callbacks.
    #[must_use]
    pub fn new(flags: c_int) -> Self {
        let none = std::ptr::null_mut();
        Self {
            flags,
            feature_mask: FEATURE_ALL,
            context: none,
            filter: none,
            callback: none,
            min_width_distance_factor: 0.0,
        }
    }
}

/// `RTCBounds`.
#[repr(C, align(16))]
pub struct RtcBounds {
    pub lower: [f32; 3],
    pub align0: f32,
    pub upper: [f32; 3],
    pub align1: f32,
}

/// `RTCBoundsFunctionArguments`.
#[repr(C)]
pub struct BoundsArguments {
    pub user: *mut c_void,
    pub prim_id: c_uint,
    pub time_step: c_uint,
    pub bounds: *mut RtcBounds,
}

/// `RTCIntersectFunctionNArguments` and `RTCOccludedFunctionNArguments`. They have the same layout, but `rays` points
/// at rays with hits in the former and at rays alone in the latter.
#[repr(C)]
pub struct CallbackArguments {
    pub valid: *mut c_int,
    pub user: *mut c_void,
    pub prim_id: c_uint,
    pub context: *mut c_void,
    pub rays: *mut f32,
    pub n: c_uint,
    pub geom_id: c_uint,
}

const _: () = assert!(size_of::<QueryArguments>() == 40 && size_of::<RtcBounds>() == 32);
const _: () = assert!(size_of::<BoundsArguments>() == 24 && size_of::<CallbackArguments>() == 48);

/// `RTCErrorFunction`.
pub type ErrorFunction = unsafe extern "C" fn(user: *mut c_void, code: c_int, message: *const c_char);
/// `RTCMemoryMonitorFunction`.
pub type MemoryFunction = unsafe extern "C" fn(user: *mut c_void, bytes: isize, post: bool) -> bool;
/// `RTCBoundsFunction`.
pub type BoundsFunction = unsafe extern "C" fn(*const BoundsArguments);
/// `RTCIntersectFunctionN` and `RTCOccludedFunctionN`.
pub type CallbackFunction = unsafe extern "C" fn(*const CallbackArguments);

/// Declares a struct of functions that are looked up by name in a library.
macro_rules! functions {
    ($($name:ident = $symbol:literal: fn($($arg:ty),*) $(-> $ret:ty)?;)*) => {
        /// Functions of one loaded library.
        pub struct Api {
            $(#[doc = concat!("`", $symbol, "`.")] pub $name: unsafe extern "C" fn($($arg),*) $(-> $ret)?,)*
        }

        impl Api {
            /// Names that a library must have.
            pub const SYMBOLS: &[&str] = &[$($symbol),*];

            /// Looks up all functions.
            ///
            /// # Errors
            /// The name that the library lacks.
            ///
            /// # Safety
            /// `library` must be Embree 4 or lack one of the names, and must stay loaded while the result is used.
            pub unsafe fn load(library: &libloading::Library) -> Result<Self, &'static str> {
                $(
                    // SAFETY: the caller vouches that the library is Embree 4, whose headers declare the symbol so.
                    let $name = *unsafe { library.get($symbol) }.map_err(|_| $symbol)?;
                )*
                Ok(Self { $($name),* })
            }
        }
    };
}

functions! {
    new_device = "rtcNewDevice": fn(*const c_char) -> RtcDevice;
    release_device = "rtcReleaseDevice": fn(RtcDevice);
    device_property = "rtcGetDeviceProperty": fn(RtcDevice, c_int) -> isize;
    device_error = "rtcGetDeviceError": fn(RtcDevice) -> c_int;
    set_error_function = "rtcSetDeviceErrorFunction": fn(RtcDevice, ErrorFunction, *mut c_void);
    set_memory_function = "rtcSetDeviceMemoryMonitorFunction": fn(RtcDevice, MemoryFunction, *mut c_void);
    new_scene = "rtcNewScene": fn(RtcDevice) -> RtcScene;
    release_scene = "rtcReleaseScene": fn(RtcScene);
    set_scene_flags = "rtcSetSceneFlags": fn(RtcScene, c_int);
    set_scene_quality = "rtcSetSceneBuildQuality": fn(RtcScene, c_int);
    attach_by_id = "rtcAttachGeometryByID": fn(RtcScene, RtcGeometry, c_uint);
    commit_scene = "rtcCommitScene": fn(RtcScene);
    new_geometry = "rtcNewGeometry": fn(RtcDevice, c_int) -> RtcGeometry;
    release_geometry = "rtcReleaseGeometry": fn(RtcGeometry);
    commit_geometry = "rtcCommitGeometry": fn(RtcGeometry);
    set_mask = "rtcSetGeometryMask": fn(RtcGeometry, c_uint);
    new_buffer = "rtcSetNewGeometryBuffer": fn(RtcGeometry, c_int, c_uint, c_int, usize, usize) -> *mut c_void;
    set_user_count = "rtcSetGeometryUserPrimitiveCount": fn(RtcGeometry, c_uint);
    set_user_data = "rtcSetGeometryUserData": fn(RtcGeometry, *mut c_void);
    set_bounds = "rtcSetGeometryBoundsFunction": fn(RtcGeometry, BoundsFunction, *mut c_void);
    set_intersect = "rtcSetGeometryIntersectFunction": fn(RtcGeometry, CallbackFunction);
    set_occluded = "rtcSetGeometryOccludedFunction": fn(RtcGeometry, CallbackFunction);
    intersect1 = "rtcIntersect1": fn(RtcScene, *mut RtcRayHit1, *const QueryArguments);
    intersect8 = "rtcIntersect8": fn(*const c_int, RtcScene, *mut RtcRayHit8, *const QueryArguments);
    intersect16 = "rtcIntersect16": fn(*const c_int, RtcScene, *mut RtcRayHit16, *const QueryArguments);
    occluded1 = "rtcOccluded1": fn(RtcScene, *mut RtcRay1, *const QueryArguments);
    occluded8 = "rtcOccluded8": fn(*const c_int, RtcScene, *mut RtcRay8, *const QueryArguments);
    occluded16 = "rtcOccluded16": fn(*const c_int, RtcScene, *mut RtcRay16, *const QueryArguments);
}
