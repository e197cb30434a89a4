//! Embree 3 by its C interface, loaded when the benchmark runs: Debian's `libembree3-3`. Layouts and
//! constants are those of `rtcore_ray.h`, `rtcore_common.h`, `rtcore_buffer.h` and `rtcore_geometry.h` of
//! version 3.13, built for one level of instances, as it is by default.
#![expect(unsafe_code, reason = "a C library, loaded at run time, has no safe interface")]

use anyhow::{Context, Result, ensure};
use deepshade::shared::rays::{Ray, Rival};
use deepshade_render::scene::Scene;
use libloading::Library;
use std::ffi::{c_char, c_uint, c_void};
use std::ptr;
use std::time::Instant;

/// The library's name without its path.
const LIBRARY: &str = if cfg!(windows) {
    "embree3.dll"
} else if cfg!(target_os = "macos") {
    "libembree3.3.dylib"
} else {
    "libembree3.so.3"
};

/// `RTC_GEOMETRY_TYPE_TRIANGLE`, `RTC_BUFFER_TYPE_INDEX`, `RTC_BUFFER_TYPE_VERTEX`, `RTC_FORMAT_UINT3`,
/// `RTC_FORMAT_FLOAT3`, `RTC_INVALID_GEOMETRY_ID`.
const TRIANGLES: c_uint = 0;
const INDICES: c_uint = 0;
const VERTICES: c_uint = 1;
const UINT3: c_uint = 0x5003;
const FLOAT3: c_uint = 0x9003;
const NOTHING: c_uint = !0;

/// `RTCDevice`, `RTCScene`, `RTCGeometry`: pointers to what only Embree knows.
type Handle = *mut c_void;

/// `RTCRay`.
#[repr(C, align(16))]
struct RtcRay {
    origin: [f32; 3],
    near: f32,
    direction: [f32; 3],
    time: f32,
    far: f32,
    mask: c_uint,
    id: c_uint,
    flags: c_uint,
}

/// `RTCHit`.
#[repr(C, align(16))]
struct RtcHit {
    normal: [f32; 3],
    barycentric: [f32; 2],
    triangle: c_uint,
    geometry: c_uint,
    instance: c_uint,
}

/// `RTCRayHit`.
#[repr(C)]
struct RtcRayHit {
    ray: RtcRay,
    hit: RtcHit,
}

/// `RTCIntersectContext`.
#[repr(C)]
struct Context3 {
    flags: c_uint,
    filter: *const c_void,
    instance: c_uint,
}

impl Context3 {
    /// `rtcInitIntersectContext`.
    const fn new() -> Self {
        Self { flags: 0, filter: ptr::null(), instance: NOTHING }
    }
}

type Intersect = unsafe extern "C" fn(Handle, *mut Context3, *mut RtcRayHit);
type Occluded = unsafe extern "C" fn(Handle, *mut Context3, *mut RtcRay);
type Release = unsafe extern "C" fn(Handle);

/// A scene in Embree.
pub struct Embree {
    device: Handle,
    scene: Handle,
    intersect: Intersect,
    occluded: Occluded,
    release_scene: Release,
    release_device: Release,
    build_seconds: f64,
}

// SAFETY: Embree lets any number of threads trace rays through a committed scene, which nothing here changes.
unsafe impl Sync for Embree {}

impl Embree {
    /// Builds Embree's hierarchy, with all its settings as they are by default.
    ///
    /// # Errors
    /// If there is no Embree 3, or it refuses.
    pub fn new(scene: &Scene) -> Result<Self> {
        // SAFETY: Embree and what it loads have no conditions on being loaded.
        let library = unsafe { Library::new(LIBRARY) }.with_context(|| LIBRARY.to_owned())?;
        // Its functions are used and its threads live for as long as the program does: it is never unloaded.
        let library: &'static Library = Box::leak(Box::new(library));
        let new_device: unsafe extern "C" fn(*const c_char) -> Handle = function(library, "rtcNewDevice")?;
        let new_scene: unsafe extern "C" fn(Handle) -> Handle = function(library, "rtcNewScene")?;
        let commit: unsafe extern "C" fn(Handle) = function(library, "rtcCommitScene")?;
        let (intersect, occluded) = (function(library, "rtcIntersect1")?, function(library, "rtcOccluded1")?);
        let (release_scene, release_device): (Release, Release) =
            (function(library, "rtcReleaseScene")?, function(library, "rtcReleaseDevice")?);
        // SAFETY: no settings are allowed, and the device is released by `drop`.
        let device = unsafe { new_device(ptr::null()) };
        ensure!(!device.is_null(), "Embree makes no device");
        // SAFETY: the device is one.
        let handle = unsafe { new_scene(device) };
        let mut embree = Self {
            device,
            scene: handle,
            intersect,
            occluded,
            release_scene,
            release_device,
            build_seconds: 0.0,
        };
        embree.attach(library, scene)?;
        let start = Instant::now();
        // SAFETY: the scene is one, and its geometry is committed.
        unsafe { commit(handle) };
        embree.build_seconds = start.elapsed().as_secs_f64();
        Ok(embree)
    }

    /// Gives Embree all triangles as one geometry.
    fn attach(&self, library: &Library, scene: &Scene) -> Result<()> {
        type NewBuffer = unsafe extern "C" fn(Handle, c_uint, c_uint, c_uint, usize, usize) -> *mut c_void;
        let new: unsafe extern "C" fn(Handle, c_uint) -> Handle = function(library, "rtcNewGeometry")?;
        let buffer: NewBuffer = function(library, "rtcSetNewGeometryBuffer")?;
        let commit: unsafe extern "C" fn(Handle) = function(library, "rtcCommitGeometry")?;
        let attach: unsafe extern "C" fn(Handle, Handle) -> c_uint = function(library, "rtcAttachGeometry")?;
        let release: Release = function(library, "rtcReleaseGeometry")?;
        let (mut vertices, mut triangles): (Vec<[f32; 3]>, Vec<[u32; 3]>) = (vec![], vec![]);
        for mesh in &scene.meshes {
            let first = vertices.len() as u32;
            vertices.extend(mesh.positions.iter().map(|position| position.to_array()));
            triangles.extend(mesh.triangles.iter().map(|corners| corners.map(|corner| first + corner)));
        }
        // SAFETY: the device is one. Embree makes the buffers as large as is asked for, or returns null, and
        // what is copied is as large. The scene holds the geometry after it is released here.
        unsafe {
            let geometry = new(self.device, TRIANGLES);
            let to = buffer(geometry, VERTICES, 0, FLOAT3, size_of::<[f32; 3]>(), vertices.len());
            ensure!(!to.is_null(), "Embree has no memory for {} vertices", vertices.len());
            ptr::copy_nonoverlapping(vertices.as_ptr(), to.cast(), vertices.len());
            let to = buffer(geometry, INDICES, 0, UINT3, size_of::<[u32; 3]>(), triangles.len());
            ensure!(!to.is_null(), "Embree has no memory for {} triangles", triangles.len());
            ptr::copy_nonoverlapping(triangles.as_ptr(), to.cast(), triangles.len());
            commit(geometry);
            attach(self.scene, geometry);
            release(geometry);
        }
        Ok(())
    }
}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: both are what they are called, and nobody uses them after this.
        unsafe {
            (self.release_scene)(self.scene);
            (self.release_device)(self.device);
        }
    }
}

impl Rival for Embree {
    fn name(&self) -> &'static str {
        "Embree"
    }

    fn build_seconds(&self) -> f64 {
        self.build_seconds
    }

    #[inline]
    fn nearest(&self, ray: &Ray) -> Option<(f32, u32)> {
        let hit = RtcHit {
            normal: [0.0; 3],
            barycentric: [0.0; 2],
            triangle: NOTHING,
            geometry: NOTHING,
            instance: NOTHING,
        };
        let mut query = RtcRayHit { ray: RtcRay::from(ray), hit };
        // SAFETY: the scene is committed; context and query are as Embree wants them.
        unsafe { (self.intersect)(self.scene, &mut Context3::new(), &mut query) };
        (query.hit.geometry != NOTHING).then_some((query.ray.far, query.hit.triangle))
    }

    #[inline]
    fn blocked(&self, ray: &Ray) -> bool {
        let mut query = RtcRay::from(ray);
        // SAFETY: the scene is committed; context and query are as Embree wants them.
        unsafe { (self.occluded)(self.scene, &mut Context3::new(), &mut query) };
        // Minus infinity where something is met.
        query.far < 0.0
    }
}

impl From<&Ray> for RtcRay {
    fn from(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.to_array(),
            near: 0.0,
            direction: ray.direction.to_array(),
            time: 0.0,
            far: ray.reach,
            mask: !0,
            id: 0,
            flags: 0,
        }
    }
}

/// A function of the library.
fn function<F: Copy>(library: &Library, name: &str) -> Result<F> {
    // SAFETY: every caller gives the type that Embree's headers give the name.
    let function = unsafe { library.get::<F>(name) }.with_context(|| format!("{LIBRARY}: {name}"))?;
    Ok(*function)
}
