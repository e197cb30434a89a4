//! What Bevy's passes and ours take on the device: each set by itself, recorded again as it was in the frame.

use super::headless::Headless;
use bevy::pbr::{SsaoBindGroups, SsaoPipelineId};
use bevy::render::camera::ExtractedCamera;
use bevy::render::render_resource::PipelineDescriptor;
use bevy::render::render_resource::{CachedPipelineState, ComputePipeline, Pipeline, PipelineCache};
use bevy::render::view::ViewUniformOffset;
use deepshade_bevy::LearnedShading;
use deepshade_shaders::gpu;
use std::error::Error;

/// Runs before the clock counts.
pub(super) const WARM_UP: usize = 1;
/// Runs of which the median is taken.
pub(super) const TIMED: usize = 7;

/// Milliseconds of the passes of a frame for a component of ours.
///
/// # Errors
/// If the last frame had none, or the device fails.
pub fn learned<E: Send + Sync + 'static>(bevy: &mut Headless) -> Result<f64, Box<dyn Error>> {
    let (device, queue) = bevy.device();
    let (device, queue) = (device.clone(), queue.clone());
    let world = bevy.world_mut();
    let mut query = world.query::<&LearnedShading<E>>();
    let shading = query.iter(world).next().ok_or("no learned effect")?;
    let record = |encoder: &mut wgpu::CommandEncoder| shading.encode(encoder);
    Ok(gpu::time(&device, &queue, "learned", WARM_UP, TIMED, record)?.milliseconds)
}

/// Milliseconds of the passes of a frame with Bevy's own occlusion.
///
/// # Errors
/// If the last frame had none, or the device fails.
pub fn bevys(bevy: &mut Headless) -> Result<f64, Box<dyn Error>> {
    let (device, queue) = bevy.device();
    let (device, queue) = (device.clone(), queue.clone());
    let world = bevy.world_mut();
    let mut query = world.query::<(&ExtractedCamera, &SsaoPipelineId, &SsaoBindGroups, &ViewUniformOffset)>();
    let (camera, id, groups, offset) = query.iter(world).next().ok_or("none of Bevy's occlusion")?;
    let size = camera.physical_viewport_size.ok_or("no viewport")?;
    let cache = world.resource::<PipelineCache>();
    let occlusion = cache.get_compute_pipeline(id.0).ok_or("no pipeline")?;
    let steps = [
        (labelled(cache, "ssao_preprocess_depth_pipeline")?, &groups.preprocess_depth_bind_group, 16),
        (occlusion, &groups.ssao_bind_group, 8),
        (labelled(cache, "ssao_spatial_denoise_pipeline")?, &groups.spatial_denoise_bind_group, 8),
    ];
    let record = |encoder: &mut wgpu::CommandEncoder| {
        for (pipeline, group, tile) in steps {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &**group, &[]);
            pass.set_bind_group(1, &*groups.common_bind_group, &[offset.offset]);
            pass.dispatch_workgroups(size.x.div_ceil(tile), size.y.div_ceil(tile), 1);
        }
    };
    Ok(gpu::time(&device, &queue, "ssao", WARM_UP, TIMED, record)?.milliseconds)
}

/// Bevy's compute pipeline of a label.
fn labelled<'a>(cache: &'a PipelineCache, label: &str) -> Result<&'a ComputePipeline, String> {
    let of_label = cache.pipelines().find(|cached| match &cached.descriptor {
        PipelineDescriptor::ComputePipelineDescriptor(descriptor) => {
            descriptor.label.as_deref() == Some(label)
        }
        _ => false,
    });
    match of_label.map(|cached| &cached.state) {
        Some(CachedPipelineState::Ok(Pipeline::ComputePipeline(pipeline))) => Ok(pipeline),
        _ => Err(format!("no pipeline {label}")),
    }
}
