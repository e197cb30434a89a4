//! Buffers that are filled once, written by passes, and read back.

use super::{GpuError, allocate, catch, wait};
use bytemuck::Pod;
use wgpu::BufferUsages;

const STORAGE: BufferUsages =
    BufferUsages::STORAGE.union(BufferUsages::COPY_SRC).union(BufferUsages::COPY_DST);

/// A storage buffer `deepshade.<label>` that holds `contents`.
///
/// # Errors
/// If the device has no room for it.
pub fn storage<T: Pod>(device: &wgpu::Device, label: &str, contents: &[T]) -> Result<wgpu::Buffer, GpuError> {
    let bytes = bytemuck::cast_slice(contents);
    filled_within(device, label, bytes, STORAGE, binding_limit(device, STORAGE))
}

/// A uniform buffer `deepshade.<label>` that holds `contents`.
///
/// # Errors
/// If the device has no room for it.
pub fn uniform<T: Pod>(device: &wgpu::Device, label: &str, contents: &T) -> Result<wgpu::Buffer, GpuError> {
    uniforms(device, label, std::slice::from_ref(contents))
}

/// A uniform buffer `deepshade.<label>` that holds the elements of `contents` one after the other.
///
/// # Errors
/// If the device has no room for it.
pub fn uniforms<T: Pod>(
    device: &wgpu::Device,
    label: &str,
    contents: &[T],
) -> Result<wgpu::Buffer, GpuError> {
    let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
    filled_within(device, label, bytemuck::cast_slice(contents), usage, binding_limit(device, usage))
}

/// A storage buffer `deepshade.<label>` with room for `count` elements, all zero.
///
/// # Errors
/// If the device has no room for it.
pub fn empty<T: Pod>(device: &wgpu::Device, label: &str, count: usize) -> Result<wgpu::Buffer, GpuError> {
    create_within(
        device,
        label,
        (count * size_of::<T>()) as u64,
        STORAGE,
        false,
        binding_limit(device, STORAGE),
    )
}

/// Overwrites a buffer that [`storage`] or [`empty`] made from its beginning on, before any work that is
/// submitted later.
///
/// # Errors
/// If the buffer is smaller, or the device is lost.
pub fn write<T: Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    buffer: &wgpu::Buffer,
    contents: &[T],
) -> Result<(), GpuError> {
    catch(device, || queue.write_buffer(buffer, 0, bytemuck::cast_slice(contents)))
        .map_err(|what| GpuError::Refused { label: "deepshade.write".to_owned(), what })
}

/// What a buffer that [`storage`] or [`empty`] made holds once all submitted work is done.
///
/// # Errors
/// If the device is lost or its memory exhausted.
pub fn read<T: Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    buffer: &wgpu::Buffer,
) -> Result<Vec<T>, GpuError> {
    wait(read_async(device, queue, buffer))?
}

/// As [`read`], awaited.
///
/// # Errors
/// If the device is lost or its memory exhausted.
pub async fn read_async<T: Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    buffer: &wgpu::Buffer,
) -> Result<Vec<T>, GpuError> {
    read_part_async(device, queue, buffer, 0, buffer.size()).await
}

/// As [`read`], `bytes` from `offset` on, both multiples of four.
///
/// # Errors
/// If the buffer is smaller, the device is lost or its memory exhausted.
pub fn read_part<T: Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    buffer: &wgpu::Buffer,
    offset: u64,
    bytes: u64,
) -> Result<Vec<T>, GpuError> {
    wait(read_part_async(device, queue, buffer, offset, bytes))?
}

async fn read_part_async<T: Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    buffer: &wgpu::Buffer,
    offset: u64,
    bytes: u64,
) -> Result<Vec<T>, GpuError> {
    let failed = |what: String| GpuError::Readback { label: "deepshade.readback".to_owned(), what };
    let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
    let staging = create_within(device, "readback", bytes, usage, false, binding_limit(device, usage))?;
    catch(device, || {
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(buffer, offset, &staging, 0, bytes);
        queue.submit([encoder.finish()]);
    })
    .map_err(failed)?;
    let (sender, receiver) = futures_channel::oneshot::channel();
    // The receiver is alive until the map is done or given up; either way nobody misses the message.
    catch(device, || staging.map_async(wgpu::MapMode::Read, .., move |result| drop(sender.send(result))))
        .map_err(failed)?;
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| failed(e.to_string()))?;
    receiver.await.map_err(|e| failed(e.to_string()))?.map_err(|e| failed(e.to_string()))?;
    let mapped = staging.get_mapped_range(..).map_err(|e| failed(e.to_string()))?;
    Ok(bytemuck::pod_collect_to_vec(&mapped))
}

/// A buffer `deepshade.<label>` that holds `bytes` and may be used as `usage` says. Where it is bound, each
/// part that is, not the whole, has to meet the device's limit of a binding.
///
/// # Errors
/// If the device has no room for it.
pub fn filled(
    device: &wgpu::Device,
    label: &str,
    bytes: &[u8],
    usage: BufferUsages,
) -> Result<wgpu::Buffer, GpuError> {
    filled_within(device, label, bytes, usage, device.limits().max_buffer_size)
}

fn filled_within(
    device: &wgpu::Device,
    label: &str,
    bytes: &[u8],
    usage: BufferUsages,
    limit: u64,
) -> Result<wgpu::Buffer, GpuError> {
    let buffer = create_within(device, label, bytes.len() as u64, usage, true, limit)?;
    let refused = |what: String| GpuError::Refused { label: format!("deepshade.{label}"), what };
    let mut mapped = buffer.get_mapped_range_mut(..).map_err(|e| refused(e.to_string()))?;
    mapped.slice(..bytes.len()).copy_from_slice(bytes);
    drop(mapped);
    buffer.unmap();
    Ok(buffer)
}

/// A storage buffer `deepshade.<label>` of that many bytes, all zero, of which parts are bound: each, not the
/// whole, has to meet the device's limit of a binding.
///
/// # Errors
/// If the device has no room for it.
pub fn arena(device: &wgpu::Device, label: &str, bytes: u64) -> Result<wgpu::Buffer, GpuError> {
    create_within(device, label, bytes, STORAGE, false, device.limits().max_buffer_size)
}

/// Most bytes of a buffer that is bound as a whole.
fn binding_limit(device: &wgpu::Device, usage: BufferUsages) -> u64 {
    let limits = device.limits();
    let mut limit = limits.max_buffer_size;
    if usage.contains(BufferUsages::STORAGE) {
        limit = limit.min(limits.max_storage_buffer_binding_size);
    }
    if usage.contains(BufferUsages::UNIFORM) {
        limit = limit.min(limits.max_uniform_buffer_binding_size);
    }
    limit
}

/// A buffer of at least one word, since bindings may not be empty.
fn create_within(
    device: &wgpu::Device,
    label: &str,
    bytes: u64,
    usage: BufferUsages,
    mapped_at_creation: bool,
    limit: u64,
) -> Result<wgpu::Buffer, GpuError> {
    let label = format!("deepshade.{label}");
    let size = bytes.next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT).max(wgpu::COPY_BUFFER_ALIGNMENT);
    if size > limit {
        return Err(GpuError::TooLarge { label, bytes: size, limit });
    }
    let descriptor = wgpu::BufferDescriptor { label: Some(&label), size, usage, mapped_at_creation };
    allocate(device, &label, size, || device.create_buffer(&descriptor))
}
