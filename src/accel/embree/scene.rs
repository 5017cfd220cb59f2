//! Embree's scenes as owning types: filled, committed, traced. Everything here is safe to call.

#![allow(unsafe_code, reason = "calls into the Embree library")]

use std::ffi::{c_int, c_void};
use std::sync::Arc;

use glam::{Vec3, Vec4};

use super::device::Device;
use super::options::Quality;
use super::sys::{self, BoundsArguments, CallbackArguments, QueryArguments, RtcBounds, Valid};
use crate::error::{Error, Result, Unavailable};
use crate::geometry::Aabb;

/// Shapes whose intersection tests are callbacks from Embree.
pub trait UserGeometry: Send + Sync {
    /// Number of shapes, above zero.
    fn count(&self) -> u32;
    /// Bounding box of shape `i`, rounded outwards.
    fn bounds(&self, i: u32) -> Aabb;
    /// Intersects rays with shape `i`. For each hit before `tfar` it writes `tfar`, u, v and the ids.
    fn intersect(&self, i: u32, rays: UserRays);
    /// Sets `tfar` of rays that hit shape `i` to -inf.
    fn occluded(&self, i: u32, rays: UserRays);
}

/// Rays in a callback: `n` lanes, one array per field, in the order of `RTCRay` and `RTCHit`.
pub struct UserRays<'a> {
    /// Number of lanes.
    pub n: usize,
    /// -1 for active lanes, else 0.
    pub valid: &'a [c_int],
    /// Arrays of `n` numbers: 12 fields of the rays and, for `intersect`, 7 of the hits. Ids are stored as their bits.
    pub fields: &'a mut [f32],
}

/// Scene that geometry can be added to.
pub struct SceneBuilder(Scene);

/// Committed scene, ready for rays from any thread.
pub struct Scene {
    raw: sys::RtcScene,
    /// Shapes with callbacks, at fixed addresses; freed after the scene.
    users: Vec<Arc<dyn UserGeometry>>,
    device: Arc<Device>,
}

// SAFETY: rays may be traced through a committed scene by any number of threads (API manual, rtcIntersect1); before
// that a scene has one owner.
unsafe impl Send for Scene {}
// SAFETY: as above; user geometries are Sync.
unsafe impl Sync for Scene {}

impl SceneBuilder {
    /// Creates an empty scene.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if Embree cannot create one.
    pub fn new(device: &Arc<Device>, robust: bool, quality: Quality) -> Result<Self> {
        let api = device.api();
        // SAFETY: the device lives.
        let raw = unsafe { (api.new_scene)(device.raw()) };
        if raw.is_null() {
            return Err(refused(device, "makes no scene"));
        }
        // SAFETY: the scene was just made.
        unsafe {
            (api.set_scene_flags)(raw, if robust { sys::SCENE_ROBUST } else { 0 });
            (api.set_scene_quality)(raw, quality as c_int);
        }
        Ok(Self(Scene { raw, users: Vec::new(), device: device.clone() }))
    }

    /// Adds triangles as geometry `id`. Embree drops those whose indices are out of range.
    ///
    /// # Errors
    /// A limit if memory runs out.
    pub fn triangles(&mut self, id: u32, mask: u32, positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<()> {
        let geometry = NewGeometry::new(&self.0.device, sys::TYPE_TRIANGLE)?;
        geometry.buffer(sys::BUFFER_VERTEX, sys::FORMAT_FLOAT3, positions)?;
        geometry.buffer(sys::BUFFER_INDEX, sys::FORMAT_UINT3, triangles)?;
        geometry.attach(&self.0, id, mask);
        Ok(())
    }

    /// Adds Embree's own spheres, given as centre and radius, as geometry `id`.
    ///
    /// # Errors
    /// A limit if memory runs out.
    pub fn sphere_points(&mut self, id: u32, mask: u32, spheres: &[Vec4]) -> Result<()> {
        let geometry = NewGeometry::new(&self.0.device, sys::TYPE_SPHERE_POINT)?;
        geometry.buffer(sys::BUFFER_VERTEX, sys::FORMAT_FLOAT4, spheres)?;
        geometry.attach(&self.0, id, mask);
        Ok(())
    }

    /// Adds shapes with callbacks as geometry `id`.
    ///
    /// # Errors
    /// A limit if memory runs out.
    pub fn user<T: UserGeometry + 'static>(&mut self, id: u32, mask: u32, user: T) -> Result<()> {
        let geometry = NewGeometry::new(&self.0.device, sys::TYPE_USER)?;
        let user = Arc::new(user);
        let address: *mut c_void = Arc::as_ptr(&user).cast_mut().cast();
        let api = self.0.device.api();
        // SAFETY: the geometry lives; the shapes are kept beside the scene until after its release, and the callbacks,
        // made for this very type, only ever share it.
        unsafe {
            (api.set_user_count)(geometry.raw, user.count());
            (api.set_user_data)(geometry.raw, address);
            (api.set_bounds)(geometry.raw, bounds_callback::<T>, address);
            (api.set_intersect)(geometry.raw, intersect_callback::<T>);
            (api.set_occluded)(geometry.raw, occluded_callback::<T>);
        }
        self.0.users.push(user);
        geometry.attach(&self.0, id, mask);
        Ok(())
    }

    /// Builds the hierarchy.
    ///
    /// # Errors
    /// A limit if memory runs out; [`Unavailable::Failed`] with any other error of Embree.
    pub fn commit(self) -> Result<Scene> {
        // SAFETY: scene and device live.
        unsafe { (self.0.device.api().commit_scene)(self.0.raw) };
        self.0.device.check()?;
        Ok(self.0)
    }
}

impl Scene {
    /// Address of the scene, valid while `self` lives.
    pub(super) fn raw(&self) -> sys::RtcScene {
        self.raw
    }

    /// Calls `rtcIntersect1`: the nearest hit before `tfar` is written to `tfar` and the fields of the hit.
    #[inline]
    pub fn intersect1(&self, ray: &mut sys::RtcRayHit1, query: &QueryArguments) {
        // SAFETY: the scene is committed; the struct has Embree's layout and alignment, and opening the library has
        // shown that no more than it is written.
        unsafe { (self.device.api().intersect1)(self.raw, ray, query) }
    }

    /// Calls `rtcIntersect8` for the lanes with -1 in `valid`.
    #[inline]
    pub fn intersect8(&self, valid: &Valid<8>, rays: &mut sys::RtcRayHit8, query: &QueryArguments) {
        // SAFETY: as in `intersect1`; the mask has eight lanes and is aligned to 64.
        unsafe { (self.device.api().intersect8)(valid.0.as_ptr(), self.raw, rays, query) }
    }

    /// Calls `rtcIntersect16` for the lanes with -1 in `valid`.
    #[inline]
    pub fn intersect16(&self, valid: &Valid<16>, rays: &mut sys::RtcRayHit16, query: &QueryArguments) {
        // SAFETY: as in `intersect8`, with sixteen.
        unsafe { (self.device.api().intersect16)(valid.0.as_ptr(), self.raw, rays, query) }
    }

    /// Calls `rtcOccluded1`: `tfar` becomes -inf if anything is hit.
    #[inline]
    pub fn occluded1(&self, ray: &mut sys::RtcRay1, query: &QueryArguments) {
        // SAFETY: as in `intersect1`.
        unsafe { (self.device.api().occluded1)(self.raw, ray, query) }
    }

    /// Calls `rtcOccluded8` for the lanes with -1 in `valid`.
    #[inline]
    pub fn occluded8(&self, valid: &Valid<8>, rays: &mut sys::RtcRay8, query: &QueryArguments) {
        // SAFETY: as in `intersect8`.
        unsafe { (self.device.api().occluded8)(valid.0.as_ptr(), self.raw, rays, query) }
    }

    /// Calls `rtcOccluded16` for the lanes with -1 in `valid`.
    #[inline]
    pub fn occluded16(&self, valid: &Valid<16>, rays: &mut sys::RtcRay16, query: &QueryArguments) {
        // SAFETY: as in `intersect16`.
        unsafe { (self.device.api().occluded16)(valid.0.as_ptr(), self.raw, rays, query) }
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: released once, before the user geometries and the device, which are fields.
        unsafe { (self.device.api().release_scene)(self.raw) }
    }
}

/// Geometry that is not yet attached to a scene.
struct NewGeometry {
    raw: sys::RtcGeometry,
    device: Arc<Device>,
}

impl NewGeometry {
    fn new(device: &Arc<Device>, kind: c_int) -> Result<Self> {
        // SAFETY: the device lives.
        let raw = unsafe { (device.api().new_geometry)(device.raw(), kind) };
        if raw.is_null() { Err(refused(device, "makes no geometry")) } else { Ok(Self { raw, device: device.clone() }) }
    }

    /// Copies `items` to a buffer that Embree allocates, with the padding that its loads need.
    fn buffer<T: Copy>(&self, which: c_int, format: c_int, items: &[T]) -> Result<()> {
        let api = self.device.api();
        // SAFETY: the geometry lives; all items have the size of the format.
        let start = unsafe { (api.new_buffer)(self.raw, which, 0, format, size_of::<T>(), items.len()) };
        if start.is_null() {
            return Err(refused(&self.device, "gives no buffer"));
        }
        // SAFETY: Embree has just made room for as many items there; bytes need no alignment.
        unsafe { std::ptr::copy_nonoverlapping(items.as_ptr().cast::<u8>(), start.cast::<u8>(), size_of_val(items)) };
        Ok(())
    }

    fn attach(self, scene: &Scene, id: u32, mask: u32) {
        let api = self.device.api();
        // SAFETY: geometry and scene live and have one owner.
        unsafe {
            (api.set_mask)(self.raw, mask);
            (api.commit_geometry)(self.raw);
            (api.attach_by_id)(scene.raw, self.raw, id);
        }
    }
}

impl Drop for NewGeometry {
    fn drop(&mut self) {
        // SAFETY: gives up this side's hold; the scene has its own.
        unsafe { (self.device.api().release_geometry)(self.raw) }
    }
}

/// Returns the error that Embree reported, or else `what`.
fn refused(device: &Device, what: &str) -> Error {
    device.check().err().unwrap_or_else(|| Unavailable::Failed(what.into()).into())
}

unsafe extern "C" fn bounds_callback<T: UserGeometry>(arguments: *const BoundsArguments) {
    // SAFETY: Embree hands over one set of arguments, with the address that was set together with this function.
    let (arguments, user) = unsafe { (&*arguments, &*(*arguments).user.cast::<T>()) };
    let Aabb { lo, hi } = user.bounds(arguments.prim_id);
    let bounds = RtcBounds { lower: lo.to_array(), align0: 0.0, upper: hi.to_array(), align1: 0.0 };
    // SAFETY: the place for the answer, aligned to 16.
    unsafe { arguments.bounds.write(bounds) };
}

unsafe extern "C" fn intersect_callback<T: UserGeometry>(arguments: *const CallbackArguments) {
    // SAFETY: as in `bounds_callback`; behind a lane of rays there are its hits.
    let (user, i, rays) = unsafe { callback_parts::<T>(arguments, 19) };
    user.intersect(i, rays);
}

unsafe extern "C" fn occluded_callback<T: UserGeometry>(arguments: *const CallbackArguments) {
    // SAFETY: as in `bounds_callback`; there are rays only.
    let (user, i, rays) = unsafe { callback_parts::<T>(arguments, 12) };
    user.occluded(i, rays);
}

/// # Safety
/// `arguments` must come from Embree, for a geometry whose user data is a `T`, with at least `fields` fields a lane.
unsafe fn callback_parts<'a, T>(arguments: *const CallbackArguments, fields: usize) -> (&'a T, u32, UserRays<'a>) {
    // SAFETY: the caller's word; Embree lends mask and rays for the call alone and does not touch them meanwhile.
    unsafe {
        let arguments = &*arguments;
        let n = arguments.n as usize;
        let valid = std::slice::from_raw_parts(arguments.valid, n);
        let fields = std::slice::from_raw_parts_mut(arguments.rays, fields * n);
        (&*arguments.user.cast::<T>(), arguments.prim_id, UserRays { n, valid, fields })
    }
}
