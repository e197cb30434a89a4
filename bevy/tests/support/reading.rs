//! What lies on Bevy's device, in main memory.

use bevy::render::renderer::{RenderDevice, RenderQueue};
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use wgpu::{BindingResource, TextureView};

/// Puts a texture's first components into a buffer: Bevy's occlusion cannot be copied from.
const COPY: &str = "
@group(0) @binding(0) var source: texture_2d<f32>;
@group(0) @binding(1) var<storage, read_write> values: array<f32>;

@compute @workgroup_size(8, 8)
fn copy(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(source);
    if (any(id.xy >= size)) { return; }
    let pixels = size.x * size.y;
    let texel = textureLoad(source, id.xy, 0);
    for (var c = 0u; c < arrayLength(&values) / pixels; c++) {
        values[c * pixels + id.y * size.x + id.x] = texel[c];
    }
}";

/// The first components of a texture, `[channels, height, width]`.
///
/// # Errors
/// If the device fails.
pub fn texture(
    device: &RenderDevice,
    queue: &RenderQueue,
    view: &TextureView,
    channels: usize,
) -> Result<Planes, GpuError> {
    let [height, width] = [view.texture().height() as usize, view.texture().width() as usize];
    let device = device.wgpu_device();
    let values = gpu::empty::<f32>(device, "test.values", channels * height * width)?;
    let pass = Pass::new(device, "test.copy", COPY)?;
    let bound = pass.bind(device, &[BindingResource::TextureView(view), values.as_entire_binding()])?;
    gpu::submit(device, queue, "test.copy", |encoder| {
        bound.dispatch(encoder, gpu::groups(height, width, 8));
    })?;
    planes(device, queue, &values, [channels, height, width])
}

/// Planes in a buffer, `[channels, height, width]`.
///
/// # Errors
/// If the device fails.
pub fn planes(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    buffer: &wgpu::Buffer,
    [channels, height, width]: [usize; 3],
) -> Result<Planes, GpuError> {
    Ok(Planes::from_data(channels, height, width, gpu::read(device, queue, buffer)?))
}
