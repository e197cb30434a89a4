//! Textures that passes write and later passes read: array layers of four 32-bit floats a texel.

use super::{GpuError, allocate, catch, read};
use bytemuck::Pod;
use wgpu::{BufferUsages, TextureUsages};

/// A texture array `deepshade.<label>` of `layers` x `height` x `width` texels of `rgba32float`.
///
/// # Errors
/// If the device allows none of that size or has no room for it.
pub fn texture_array(
    device: &wgpu::Device,
    label: &str,
    layers: usize,
    height: usize,
    width: usize,
) -> Result<wgpu::Texture, GpuError> {
    let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC;
    create(device, label, wgpu::TextureFormat::Rgba32Float, [layers, height, width], usage)
}

/// A texture `deepshade.<label>`, `layers` x `height` x `width`.
pub(super) fn create(
    device: &wgpu::Device,
    label: &str,
    format: wgpu::TextureFormat,
    [layers, height, width]: [usize; 3],
    usage: TextureUsages,
) -> Result<wgpu::Texture, GpuError> {
    let label = format!("deepshade.{label}");
    let size =
        wgpu::Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: layers as u32 };
    let descriptor = wgpu::TextureDescriptor {
        label: Some(&label),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    };
    let bytes = format.theoretical_memory_footprint(size);
    allocate(device, &label, bytes, || device.create_texture(&descriptor))
}

/// A texture `deepshade.<label>` of `height` x `width` texels that holds `bytes`, row by row.
///
/// # Errors
/// If the device allows none of that size or has no room for it.
pub fn sent_texture(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    format: wgpu::TextureFormat,
    [height, width]: [usize; 2],
    bytes: &[u8],
) -> Result<wgpu::Texture, GpuError> {
    let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
    let texture = create(device, label, format, [1, height, width], usage)?;
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some((bytes.len() / height) as u32),
        rows_per_image: None,
    };
    catch(device, || queue.write_texture(texture.as_image_copy(), bytes, layout, texture.size()))
        .map_err(|what| GpuError::Refused { label: format!("deepshade.{label}"), what })?;
    Ok(texture)
}

/// A texture `deepshade.<label>` of `[x, y, z]` cells of one 32-bit float each, x fastest.
///
/// # Errors
/// If the device allows none of that size or has no room for it.
pub fn sent_volume(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    [width, height, depth]: [usize; 3],
    values: &[f32],
) -> Result<wgpu::Texture, GpuError> {
    let label = format!("deepshade.{label}");
    let size =
        wgpu::Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: depth as u32 };
    let descriptor = wgpu::TextureDescriptor {
        label: Some(&label),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format: wgpu::TextureFormat::R32Float,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        view_formats: &[],
    };
    let texture = allocate(device, &label, 4 * values.len() as u64, || device.create_texture(&descriptor))?;
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(4 * width as u32),
        rows_per_image: Some(height as u32),
    };
    let bytes = bytemuck::cast_slice(values);
    catch(device, || queue.write_texture(texture.as_image_copy(), bytes, layout, size))
        .map_err(|what| GpuError::Refused { label, what })?;
    Ok(texture)
}

/// All of a texture array, to be bound.
pub fn array_view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}

/// What a texture holds once all submitted work is done, `[layers, height, width, components]` of its format.
///
/// # Errors
/// If the device is lost or its memory exhausted.
pub fn read_texture_array<T: Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
) -> Result<Vec<T>, GpuError> {
    let failed = |what| GpuError::Readback { label: "deepshade.texture".to_owned(), what };
    let size = texture.size();
    let texel = texture.format().block_copy_size(None).unwrap_or(0);
    let row = (size.width * texel) as usize;
    let pitch = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
    let rows = (size.height * size.depth_or_array_layers) as usize;
    let buffer = catch(device, || {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("deepshade.texture_rows"),
            size: (pitch * rows) as u64,
            usage: BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(pitch as u32),
            rows_per_image: Some(size.height),
        };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
            size,
        );
        queue.submit([encoder.finish()]);
        buffer
    })
    .map_err(failed)?;
    let padded: Vec<u8> = read(device, queue, &buffer)?;
    let rows: Vec<u8> = padded.chunks_exact(pitch).flat_map(|padded| &padded[..row]).copied().collect();
    Ok(bytemuck::pod_collect_to_vec(&rows))
}
