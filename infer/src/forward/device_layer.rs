//! A layer on a device: its kernel and its weights.

use super::packing::Packed;
use super::{ForwardError, Options, kernel};
use crate::{BlockSource, Layer, NetSpec, Weights};
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::convolution::{Shape, WORKGROUP};
use deepshade_shaders::wgsl::{Shader, TILE};
use std::collections::HashMap;

/// Outputs that a software kernel makes of a feature map at a time.
const SOFTWARE_OUTPUTS: usize = 8;
/// Floats of a software kernel's uniform buffer: 64 KiB, what every device offers. `WEIGHTS` of the shaders
/// is as many.
const SOFTWARE_ROOM: usize = 16_384;

/// One layer on a device.
#[derive(Debug)]
pub struct DeviceLayer {
    /// The layer.
    pub layer: Layer,
    /// Its kernel.
    pub pass: Pass,
    /// Outputs that an invocation makes.
    pub outputs: usize,
    /// Columns and rows of pixels that a workgroup makes.
    pub tile: [u32; 2],
    /// Its dispatches: blocks of outputs whose weights are in one buffer.
    pub parts: Vec<OutputBlocks>,
    /// Weights between the first ones of two blocks of outputs, in the kernel's unit.
    pub stride: usize,
    /// Bytes of all weights.
    pub bytes: u64,
}

/// Some blocks of outputs.
#[derive(Debug)]
pub struct OutputBlocks {
    /// Index of the first block.
    pub first: usize,
    /// How many.
    pub count: usize,
    /// What each reads.
    pub reads: wgpu::Buffer,
    /// Their weights.
    pub weights: wgpu::Buffer,
}

/// Compiles the layers of a network, each source once.
pub struct LayerCompiler<'a> {
    /// The device.
    pub device: &'a wgpu::Device,
    /// The network.
    pub spec: &'a NetSpec,
    /// Its weights.
    pub weights: &'a Weights,
    /// What the caller wants.
    pub options: &'a Options<'a>,
    /// What is compiled by now.
    pub compiled: HashMap<String, Pass>,
}

impl LayerCompiler<'_> {
    /// A layer for software adapters.
    pub fn software(&mut self, index: usize, layer: &Layer) -> Result<DeviceLayer, ForwardError> {
        check_channels(self.device, layer)?;
        let outputs = if layer.activation { SOFTWARE_OUTPUTS } else { 1 };
        let packed = Packed::new(self.spec, index, &self.weights.0[index], outputs);
        if packed.stride > SOFTWARE_ROOM {
            let [bytes, limit] = [packed.stride, SOFTWARE_ROOM].map(|floats| floats * size_of::<f32>());
            return Err(ForwardError::Weights { layer: layer.name.clone(), bytes, limit });
        }
        let pass = self.pass(&software_shader(self.spec, layer).name(), software_source(self.spec, layer))?;
        let at_once = SOFTWARE_ROOM / packed.stride;
        let parts = (0..packed.reads.len()).step_by(at_once).map(|first| {
            let end = packed.reads.len().min(first + at_once);
            let mut weights = packed.weights[first * packed.stride..end * packed.stride].to_vec();
            weights.resize(SOFTWARE_ROOM, 0.0);
            Ok(OutputBlocks {
                first,
                count: end - first,
                reads: gpu::storage(
                    self.device,
                    &format!("net.{}.reads", layer.name),
                    &packed.reads[first..end],
                )?,
                weights: gpu::uniforms(self.device, &format!("net.{}.weights", layer.name), &weights)?,
            })
        });
        let parts = parts.collect::<Result<Vec<_>, GpuError>>()?;
        let bytes = parts.iter().map(|part| part.weights.size()).sum();
        let stride = packed.stride / (4 * outputs);
        Ok(DeviceLayer { layer: layer.clone(), pass, outputs, tile: [2 * TILE; 2], parts, stride, bytes })
    }

    /// A layer for GPUs, its kernel of that shape.
    pub fn gpu(&mut self, index: usize, layer: &Layer, shape: Shape) -> Result<DeviceLayer, ForwardError> {
        let convolution = kernel::convolution(self.spec, index, shape, self.options)?;
        let pass = self.pass(&format!("net.{}", layer.name), convolution.source())?;
        let packed = Packed::new(self.spec, index, &self.weights.0[index], shape.outputs as usize);
        let part = OutputBlocks {
            first: 0,
            count: packed.reads.len(),
            reads: gpu::storage(self.device, &format!("net.{}.reads", layer.name), &packed.reads)?,
            weights: gpu::storage(self.device, &format!("net.{}.weights", layer.name), &packed.weights)?,
        };
        Ok(DeviceLayer {
            layer: layer.clone(),
            pass,
            outputs: packed.outputs,
            tile: shape.pixels.map(|pixels| WORKGROUP * pixels),
            bytes: part.weights.size(),
            parts: vec![part],
            stride: packed.stride / 4,
        })
    }

    fn pass(&mut self, label: &str, source: String) -> Result<Pass, GpuError> {
        if let Some(pass) = self.compiled.get(&source) {
            return Ok(pass.clone());
        }
        let pass = Pass::cached(self.device, label, &source, self.options.cache)?;
        self.compiled.insert(source, pass.clone());
        Ok(pass)
    }
}

/// The source of a layer's software kernel.
pub fn software_source(spec: &NetSpec, layer: &Layer) -> String {
    software_shader(spec, layer).specialised(&[("KERNEL", layer.kernel as u32)])
}

/// The software kernel of a layer.
fn software_shader(spec: &NetSpec, layer: &Layer) -> Shader {
    Shader::at(match (layer.source, layer.activation) {
        (BlockSource::Input | BlockSource::Folded, _) if spec.levels() == 1 => "net/only",
        (BlockSource::Input | BlockSource::Folded, _) => "net/first",
        (BlockSource::Plain(_), _) => "net/plain",
        (BlockSource::Pooled(_), _) if layer.level + 1 == spec.levels() => "net/bottom",
        (BlockSource::Pooled(_), _) => "net/down",
        (BlockSource::Joined { .. }, true) => "net/up",
        (BlockSource::Joined { .. }, false) => "net/image",
    })
}

fn check_channels(device: &wgpu::Device, layer: &Layer) -> Result<(), ForwardError> {
    let limit = 4 * device.limits().max_texture_array_layers as usize;
    match layer.outputs.next_multiple_of(SOFTWARE_OUTPUTS) <= limit {
        true => Ok(()),
        false => Err(ForwardError::Channels { layer: layer.name.clone(), channels: layer.outputs, limit }),
    }
}
