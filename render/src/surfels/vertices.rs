//! A scene's vertices in camera space on the GPU, 12 bytes each where those that are drawn have 64: what all
//! passes over a scene's surface read, and bind as a whole where those that are drawn are too many for a
//! binding.

use crate::raster::geometry::POSED;
use crate::raster::groups;
use crate::screen::{Device, MethodStep, PassDispatch, Workgroups};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;
use std::num::NonZeroU64;

/// Bytes of a vertex that is drawn.
const DRAWN: u64 = 4 * POSED as u64;
/// Bytes of a vertex in camera space.
const PLACED: u64 = 12;
/// Parts begin at multiples of so many vertices: bindings begin at multiples of 256 bytes.
const ALIGNMENT: u64 = 64;

/// Room for the vertices of a scene that is drawn from `posed`, `[vertices, 3]` f32.
///
/// # Errors
/// If the device has no room, or cannot bind that many.
pub fn room(device: &wgpu::Device, posed: &wgpu::Buffer) -> Result<wgpu::Buffer, GpuError> {
    gpu::empty::<[f32; 3]>(device, "surfels.vertices", (posed.size() / DRAWN) as usize)
}

/// The pass bound to as many vertices at a time as one binding can hold; `view` is that of the camera.
///
/// # Errors
/// If the device refuses the pass or a binding.
pub fn steps(
    device: &Device,
    [view, posed, vertices]: [&wgpu::Buffer; 3],
) -> Result<Vec<MethodStep>, GpuError> {
    let pass = device.pass(Shader::at("surfels/vertices"), &[])?;
    let count = posed.size() / DRAWN;
    let at_once = device.limits().max_storage_buffer_binding_size / DRAWN / ALIGNMENT * ALIGNMENT;
    let part = |first: u64| {
        let here = at_once.min(count - first);
        let of = |buffer, bytes: u64| {
            let size = NonZeroU64::new(here * bytes);
            wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: first * bytes, size })
        };
        let resources = [view.as_entire_binding(), of(posed, DRAWN), of(vertices, PLACED)];
        let workgroups = Workgroups::Known(groups(here as usize));
        let step = PassDispatch { pass: pass.bind(device, &resources)?, workgroups };
        Ok(MethodStep { step, writes: vec![vertices.clone()] })
    };
    (0..count).step_by(at_once as usize).map(part).collect()
}
