//! What a device must allow for a network's kernels to run at all, whatever the image. WebGPU's default
//! limits do; wgpu's `downlevel_defaults` have one storage buffer too few for most networks.

use super::head;
use super::maps::{has_means, read_by};
use super::{ForwardError, InputKind, Options, OutputKind, Variant};
use crate::NetSpec;
use deepshade_shaders::wgsl::TILE;
use deepshade_shaders::wgsl::convolution::WORKGROUP;

/// Checks them.
///
/// # Errors
/// [`ForwardError::Limit`] with the first that is too low.
pub fn check(
    limits: &wgpu::Limits,
    spec: &NetSpec,
    variant: &Variant,
    options: &Options<'_>,
) -> Result<(), ForwardError> {
    let allowed = [
        ("max_compute_invocations_per_workgroup", limits.max_compute_invocations_per_workgroup),
        ("max_storage_buffers_per_shader_stage", limits.max_storage_buffers_per_shader_stage),
        ("max_storage_textures_per_shader_stage", limits.max_storage_textures_per_shader_stage),
    ];
    let needed = match variant {
        // What blocks of outputs read, and the network's input or its image; a map, and its means.
        Variant::Software => [TILE * TILE, 2, 2],
        Variant::Gpu(_) => [WORKGROUP * WORKGROUP, most_buffers(spec, options), 0],
    };
    let mut pairs = allowed.into_iter().zip(needed);
    match pairs.find(|((_, allowed), needed)| needed > allowed) {
        Some(((name, allowed), needed)) => Err(ForwardError::Limit { name, needed, allowed }),
        None => Ok(()),
    }
}

/// Most storage buffers that a kernel for GPUs binds.
fn most_buffers(spec: &NetSpec, options: &Options<'_>) -> u32 {
    let layers = spec.layers();
    let buffers = |(index, layer): (usize, &crate::Layer)| {
        let input = layer.source.is_input() && options.input == InputKind::Buffer;
        let makes_texture =
            !layer.activation && head::of(spec).is_none() && options.output != OutputKind::Buffer;
        // What blocks of outputs read and their weights; what is read; what is made, with its means.
        2 + u32::from(input)
            + read_by(layer).len() as u32
            + u32::from(!makes_texture)
            + u32::from(has_means(&layers, index))
    };
    layers.iter().enumerate().map(buffers).max().unwrap_or(0)
}
