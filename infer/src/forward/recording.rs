//! A run on certain buffers or textures of the caller's, ready to be recorded.

use super::plan::{Kernel, Plan, TileDispatch};
use super::tiles::{self, Tile};
use super::{ForwardError, Input, Output};
use crate::{Layer, Scaling};
use deepshade_shaders::gpu::{self, BoundPass, GpuError};
use deepshade_shaders::wgsl::uniforms::NetLayer;
use wgpu::{BindingResource, Buffer, Device, Queue};

/// A network on an image that the caller keeps in buffers or textures. Recording it makes nothing anew.
#[derive(Debug)]
pub struct Recording {
    dispatches: Vec<Dispatch>,
    /// What kernels are told that read the caller's textures.
    told: Vec<TileUniform>,
}

/// A kernel, and how many workgroups of it run.
#[derive(Debug)]
pub(super) struct Dispatch {
    /// Index of the layer.
    pub layer: usize,
    kernel: BoundPass,
    workgroups: [u32; 3],
}

/// What a kernel is told that reads the caller's input.
#[derive(Debug)]
pub(super) struct TileUniform {
    uniform: Buffer,
    layer: NetLayer,
}

impl Recording {
    pub(super) fn new(plan: &Plan, input: Input<'_>, output: Output<'_>) -> Result<Self, ForwardError> {
        input.check(&plan.spec, plan.kinds.0, plan.size)?;
        output.check(&plan.spec, plan.kinds.1, plan.size)?;
        let layers = plan.spec.layers();
        let last = layers.len() - 1;
        let mut recording = Self { dispatches: Vec::new(), told: Vec::new() };
        if let Some((passes, buffers)) = &plan.head {
            let (bound, told) = passes.bind_pyramid(&plan.device, buffers, input)?;
            recording.told.extend(told);
            recording.dispatches.extend(bound.into_iter().map(|(kernel, workgroups)| Dispatch {
                layer: last,
                kernel,
                workgroups,
            }));
        }
        for tile in &plan.tiles {
            for step in &plan.steps {
                recording.add(plan, &layers, tile, step, input, output)?;
            }
            if let Some((passes, buffers)) = &plan.head {
                let (kernel, workgroups) = passes.bind_image(&plan.device, buffers, tile, output)?;
                recording.dispatches.push(Dispatch { layer: last, kernel, workgroups });
            }
        }
        Ok(recording)
    }

    /// Adds a step of a tile.
    fn add(
        &mut self,
        plan: &Plan,
        layers: &[Layer],
        tile: &Tile,
        step: &TileDispatch,
        input: Input<'_>,
        output: Output<'_>,
    ) -> Result<(), ForwardError> {
        let kernel = match &step.kernel {
            Kernel::Bound(bound) => bound.clone(),
            Kernel::Open { .. } => {
                let (made, layer) = match &plan.head {
                    Some((_, buffers)) if step.callers[1] => {
                        (Output::Buffer(&buffers.kernels), tiles::alone(step.uniform))
                    }
                    _ => (output, tile.placed(step.uniform)),
                };
                let label = format!("net.{}", layers[step.layer].name);
                let told = TileUniform::new(&plan.device, &label, input, layer)?;
                let kernel = plan.bound(layers, step, &told.uniform, callers(step, input, made))?;
                self.told.extend(step.callers[0].then_some(told));
                kernel
            }
        };
        self.dispatches.push(Dispatch { layer: step.layer, kernel, workgroups: step.workgroups });
        Ok(())
    }

    /// What lengths and light are multiplied by from the next submission on, as they are read from textures:
    /// what a renderer changes from frame to frame. Nothing is made anew. A buffer holds what is scaled
    /// already, so that it changes nothing.
    pub fn set_scaling(&self, queue: &Queue, scaling: Scaling) {
        for TileUniform { uniform, layer } in &self.told {
            let Scaling { length: length_scale, light: light_scale } = scaling;
            let layer = NetLayer { length_scale, light_scale, ..*layer };
            queue.write_buffer(uniform, 0, bytemuck::bytes_of(&layer));
        }
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

impl TileUniform {
    /// Of a kernel that reads `input`: how it is scaled, too.
    pub fn new(device: &Device, label: &str, input: Input<'_>, layer: NetLayer) -> Result<Self, GpuError> {
        let (Scaling { length: length_scale, light: light_scale }, run) = input.scaling();
        let layer = NetLayer { length_scale, light_scale, run, ..layer };
        Ok(Self { uniform: gpu::uniform(device, label, &layer)?, layer })
    }

    /// What its kernel binds.
    pub fn binding(&self) -> BindingResource<'_> {
        self.uniform.as_entire_binding()
    }
}

fn encode<'a>(dispatches: impl Iterator<Item = &'a Dispatch>, encoder: &mut wgpu::CommandEncoder) {
    let descriptor = wgpu::ComputePassDescriptor { label: Some("deepshade.net"), timestamp_writes: None };
    let mut pass = encoder.begin_compute_pass(&descriptor);
    for Dispatch { kernel, workgroups, .. } in dispatches {
        kernel.dispatch_in(&mut pass, *workgroups);
    }
}

/// What a step binds of the caller's; `made` is where the last convolution writes.
fn callers<'a>(step: &TileDispatch, input: Input<'a>, made: Output<'a>) -> Vec<(u32, BindingResource<'a>)> {
    let mut resources = if step.callers[0] { input.bindings() } else { Vec::new() };
    if step.callers[1] {
        resources.push((3, made.binding()));
    }
    resources
}
