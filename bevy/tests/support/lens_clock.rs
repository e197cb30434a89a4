//! What Bevy's depth of field takes on the device: its passes recorded again as they were in the frame.

use super::clock::{TIMED, WARM_UP};
use super::headless::Headless;
use bevy::post_process::dof::{
    AuxiliaryDepthOfFieldTexture, DepthOfFieldGlobalBindGroup, DepthOfFieldPipelines, DepthOfFieldUniform,
};
use bevy::render::extract_component::DynamicUniformIndex;
use bevy::render::render_resource::{CachedRenderPipelineId, PipelineCache};
use bevy::render::view::{ViewDepthStencilTexture, ViewTarget, ViewUniformOffset, ViewUniforms};
use deepshade_shaders::gpu;
use std::error::Error;
use wgpu::{BindGroup, BindGroupEntry, BindingResource, RenderPipeline, TextureView};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

type Made<'a> = (
    &'a ViewTarget,
    &'a ViewDepthStencilTexture,
    &'a DepthOfFieldPipelines,
    &'a AuxiliaryDepthOfFieldTexture,
    &'a DynamicUniformIndex<DepthOfFieldUniform>,
    &'a ViewUniformOffset,
);

/// A pass: what runs, what it reads, and onto what it draws.
type Pass<'a> = (&'a RenderPipeline, BindGroup, Vec<&'a TextureView>);

/// Milliseconds of the passes of a frame with Bevy's depth of field in its mode `Bokeh`.
///
/// # Errors
/// If the last frame had none, or the device fails.
pub fn bevys(bevy: &mut Headless) -> Result<f64> {
    let (device, queue) = bevy.device();
    let (device, queue) = (device.clone(), queue.clone());
    let world = bevy.world_mut();
    let mut query = world.query::<Made<'_>>();
    let (target, depth, pipelines, auxiliary, lens, view) =
        query.iter(world).next().ok_or("none of Bevy's depth of field")?;
    let depth = depth.attachment.depth_stencil_views().depth_only_view().ok_or("no depth")?;
    let DepthOfFieldPipelines::Bokeh { pass_0, pass_1 } = pipelines else {
        return Err("another mode".into());
    };
    let cache = world.resource::<PipelineCache>();
    let compiled = |id: CachedRenderPipelineId| cache.get_render_pipeline(id).ok_or("no pipeline");
    let seen = world.resource::<ViewUniforms>().uniforms.binding().ok_or("no view")?;
    let common = world.resource::<DepthOfFieldGlobalBindGroup>().as_ref().ok_or("no lens")?;
    let [first, second, auxiliary]: [&TextureView; 3] =
        [target.main_texture_view(), target.main_texture_other_view(), &auxiliary.default_view];
    let bound = |id, read: &[&TextureView], onto| -> Result<Pass<'_>> {
        let pipeline: &RenderPipeline = compiled(id)?;
        let textures = read.iter().map(|view| BindingResource::TextureView(view));
        let resources = [seen.clone(), BindingResource::TextureView(depth)].into_iter().chain(textures);
        let entries: Vec<BindGroupEntry<'_>> =
            (0..).zip(resources).map(|(binding, resource)| BindGroupEntry { binding, resource }).collect();
        let layout = &pipeline.get_bind_group_layout(0);
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout, entries: &entries };
        Ok((pipeline, device.create_bind_group(&descriptor), onto))
    };
    let passes = [
        bound(*pass_0, &[first], vec![second, auxiliary])?,
        bound(*pass_1, &[second, auxiliary], vec![first])?,
    ];
    let record = |encoder: &mut wgpu::CommandEncoder| {
        for (pipeline, group, onto) in &passes {
            let attachment = |view| {
                let ops = wgpu::Operations::default();
                Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
            };
            let onto: Vec<_> = onto.iter().map(|view| attachment(*view)).collect();
            let descriptor = wgpu::RenderPassDescriptor { color_attachments: &onto, ..Default::default() };
            let mut pass = encoder.begin_render_pass(&descriptor);
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, group, &[view.offset]);
            pass.set_bind_group(1, &**common, &[lens.index()]);
            pass.draw(0..3, 0..1);
        }
    };
    Ok(gpu::time(&device, &queue, "dof", WARM_UP, TIMED, record)?.milliseconds)
}
