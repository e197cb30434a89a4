//! A run on certain buffers or textures of the caller's, ready to be recorded.

use super::plan::{Kernel, Plan, Step};
use super::tiles::Tile;
use super::{ForwardError, Input, Output};
use deepshade_shaders::gpu::{self, BoundPass};
use deepshade_shaders::wgsl::uniforms::NetLayer;
use wgpu::BindingResource;

/// A network on an image that the caller keeps in buffers or textures. Recording it makes nothing anew.
#[derive(Debug)]
pub struct Recording {
    dispatches: Vec<Dispatch>,
}

/// A kernel, and how many workgroups of it run.
#[derive(Debug)]
pub(super) struct Dispatch {
    /// Index of the layer.
    pub layer: usize,
    kernel: BoundPass,
    workgroups: [u32; 3],
}

impl Recording {
    pub(super) fn new(plan: &Plan, input: Input<'_>, output: Output<'_>) -> Result<Self, ForwardError> {
        input.check(&plan.spec, plan.kinds.0, plan.size)?;
        output.check(&plan.spec, plan.kinds.1, plan.size)?;
        let layers = plan.spec.layers();
        let made = plan.filter.as_ref().map_or(output, |(_, room)| Output::Buffer(&room.kernels));
        let mut dispatches = Vec::new();
        for (tile, step) in plan.tiles.iter().flat_map(|tile| plan.steps.iter().map(move |step| (tile, step)))
        {
            let kernel = match &step.kernel {
                Kernel::Bound(bound) => bound.clone(),
                Kernel::Open { .. } => {
                    let uniform = uniform(step, tile, input);
                    let label = format!("net.{}", layers[step.layer].name);
                    let uniform = gpu::uniform(&plan.device, &label, &uniform)?;
                    plan.bound(&layers, step, &uniform, callers(step, input, made))?
                }
            };
            dispatches.push(Dispatch { layer: step.layer, kernel, workgroups: step.workgroups });
        }
        if let Some((passes, room)) = &plan.filter {
            let layer = layers.len() - 1;
            let bound = passes.bind(&plan.device, room, input, output)?.into_iter();
            dispatches.extend(bound.map(|(kernel, workgroups)| Dispatch { layer, kernel, workgroups }));
        }
        Ok(Self { dispatches })
    }

    /// Records the run. As many networks as wanted go into one encoder.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        encode(self.dispatches.iter(), encoder);
    }

    /// Records one layer of the run.
    pub(super) fn encode_layer(&self, layer: usize, encoder: &mut wgpu::CommandEncoder) {
        encode(self.dispatches.iter().filter(|dispatch| dispatch.layer == layer), encoder);
    }
}

fn encode<'a>(dispatches: impl Iterator<Item = &'a Dispatch>, encoder: &mut wgpu::CommandEncoder) {
    let descriptor = wgpu::ComputePassDescriptor { label: Some("deepshade.net"), timestamp_writes: None };
    let mut pass = encoder.begin_compute_pass(&descriptor);
    for Dispatch { kernel, workgroups, .. } in dispatches {
        kernel.dispatch_in(&mut pass, *workgroups);
    }
}

/// What the kernel of a step is told for a tile.
fn uniform(step: &Step, tile: &Tile, input: Input<'_>) -> NetLayer {
    let [top, left] = tile.origin.map(|at| at as u32);
    let [rows, columns] = &tile.keep;
    let (scaling, run) = input.scaling();
    NetLayer {
        length_scale: scaling.length,
        light_scale: scaling.light,
        run,
        origin_x: left,
        origin_y: top,
        keep_left: columns.start as u32,
        keep_right: columns.end as u32,
        keep_top: rows.start as u32,
        keep_bottom: rows.end as u32,
        ..step.uniform
    }
}

/// What a step binds of the caller's; `made` is where the last convolution writes.
fn callers<'a>(step: &Step, input: Input<'a>, made: Output<'a>) -> Vec<(u32, BindingResource<'a>)> {
    let mut resources = if step.callers[0] { input.bindings() } else { Vec::new() };
    if step.callers[1] {
        resources.push((3, made.binding()));
    }
    resources
}
