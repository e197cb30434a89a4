//! A network on images of one size.

use super::device_layer::{DeviceLayer, OutputBlocks};
use super::fit::{check_size, largest};
use super::head;
use super::maps::{self, MapId};
use super::storage::Storage;
use super::tiles::Tile;
use super::{ForwardError, Input, InputKind, Network, Output, OutputKind, Recording};
use crate::{Layer, NetSpec};
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{self, BoundPass, GpuError};
use deepshade_shaders::wgsl::uniforms::NetLayer;
use wgpu::BindingResource;

/// A network on images of one size: its feature maps and what is bound to its kernels.
#[derive(Debug)]
pub struct Plan {
    pub(super) device: wgpu::Device,
    pub(super) spec: NetSpec,
    pub(super) kinds: (InputKind, OutputKind),
    pub(super) size: [usize; 2],
    pub(super) tiles: Vec<Tile>,
    pub(super) storage: Storage,
    pub(super) steps: Vec<TileDispatch>,
    /// What makes the image of what the last block makes of a tile, where that is not the image.
    pub(super) head: Option<(head::Passes, head::HeadBuffers)>,
    weights: u64,
}

/// One dispatch of a tile.
#[derive(Debug)]
pub struct TileDispatch {
    /// Index of its layer.
    pub layer: usize,
    /// Whether it reads the caller's input and makes what the caller gets, or the head.
    pub callers: [bool; 2],
    /// What the kernel is told, but for where the tile lies.
    pub uniform: NetLayer,
    /// How many workgroups run.
    pub workgroups: [u32; 3],
    /// Its kernel with what it binds besides the caller's.
    pub kernel: Kernel,
}

/// A kernel with what it binds.
#[derive(Debug)]
pub enum Kernel {
    /// All of it.
    Bound(BoundPass),
    /// All but the uniform and what is the caller's.
    Open {
        /// The kernel.
        pass: gpu::Pass,
        /// What its blocks of outputs read.
        reads: wgpu::Buffer,
        /// Their weights.
        weights: wgpu::Buffer,
    },
}

/// Memory of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bytes {
    /// Feature maps, and what the head works on.
    pub activations: u64,
    /// Weights.
    pub weights: u64,
}

impl Plan {
    pub(super) fn new(
        network: &Network,
        height: usize,
        width: usize,
        limit: u64,
    ) -> Result<Self, ForwardError> {
        check_size(network, height, width)?;
        let (tiling, (storage, head)) = largest(network, [height, width], limit, |frame, maps, layout| {
            let storage = Storage::new(&network.device, maps, layout, network.precision)?;
            Ok((storage, head_of(network, [height, width], frame)?))
        })?;
        let mut plan = Self {
            device: network.device.clone(),
            spec: network.spec.clone(),
            kinds: (network.input, network.output),
            size: [height, width],
            storage,
            tiles: tiling.tiles,
            steps: Vec::new(),
            head,
            weights: network.device_layers.iter().map(|device_layer| device_layer.bytes).sum(),
        };
        for (index, device_layer) in network.device_layers.iter().enumerate() {
            for part in &device_layer.parts {
                let step = plan.step(network, tiling.frame, index, device_layer, part)?;
                plan.steps.push(step);
            }
        }
        Ok(plan)
    }

    /// Memory of the device that runs take.
    pub fn bytes(&self) -> Bytes {
        let head = self.head.as_ref().map_or(0, |(_, buffers)| buffers.bytes());
        Bytes { activations: self.storage.bytes() + head, weights: self.weights }
    }

    /// Number of tiles in which the image is run; 1 if as a whole.
    pub fn tiles(&self) -> usize {
        self.tiles.len()
    }

    /// Prepares runs from `input` to `output`, which belong to the network's device.
    ///
    /// # Errors
    /// If one is too small or not what the network was made for.
    pub fn bind(&self, input: Input<'_>, output: Output<'_>) -> Result<Recording, ForwardError> {
        Recording::new(self, input, output)
    }

    /// Records a run from one storage buffer to another: [`Plan::bind`] and [`Recording::encode`] in one. Who
    /// runs more than once with the same buffers keeps the [`Recording`].
    ///
    /// # Errors
    /// If a buffer is too small or no storage buffer.
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        input: &wgpu::Buffer,
        output: &wgpu::Buffer,
    ) -> Result<(), ForwardError> {
        self.bind(Input::Buffer(input), Output::Buffer(output))?.encode(encoder);
        Ok(())
    }

    /// The network's image, `[output channels, height, width]`, as the last run left it in `output`.
    ///
    /// # Errors
    /// If the device is lost or its memory exhausted.
    pub fn image(&self, queue: &wgpu::Queue, output: &wgpu::Buffer) -> Result<Planes, ForwardError> {
        gpu::wait(self.image_async(queue, output))?
    }

    /// As [`Plan::image`], awaited.
    pub(super) async fn image_async(
        &self,
        queue: &wgpu::Queue,
        output: &wgpu::Buffer,
    ) -> Result<Planes, ForwardError> {
        let ([height, width], channels) = (self.size, self.spec.output_channels());
        let mut data: Vec<f32> = gpu::read_async(&self.device, queue, output).await?;
        data.truncate(channels * height * width);
        Ok(Planes::from_data(channels, height, width, data))
    }

    fn step(
        &self,
        network: &Network,
        frame: [usize; 2],
        index: usize,
        device_layer: &DeviceLayer,
        part: &OutputBlocks,
    ) -> Result<TileDispatch, ForwardError> {
        let layer = &device_layer.layer;
        let [rows, columns] = frame.map(|size| (size >> layer.level) as u32);
        let callers = [layer.source.is_input(), !layer.activation];
        let channels = if callers[1] { self.spec.last_channels() } else { self.spec.input_channels() };
        let uniform = NetLayer {
            width: columns,
            height: rows,
            image_width: self.size[1] as u32,
            image_height: self.size[0] as u32,
            channels: channels as u32,
            first: part.first as u32,
            stride: device_layer.stride as u32,
            leak: self.spec.leak,
            ..bytemuck::Zeroable::zeroed()
        };
        let [x, y] = device_layer.tile;
        let workgroups = [columns.div_ceil(x), rows.div_ceil(y), part.count as u32];
        let (reads, weights) = (part.reads.clone(), part.weights.clone());
        let open = Kernel::Open { pass: device_layer.pass.clone(), reads, weights };
        let mut step = TileDispatch { layer: index, callers, uniform, workgroups, kernel: open };
        if callers == [false; 2] {
            let uniform = gpu::uniform(&network.device, &format!("net.{}", layer.name), &uniform)?;
            step.kernel = Kernel::Bound(self.bound(&network.layers, &step, &uniform, Vec::new())?);
        }
        Ok(step)
    }

    /// A step's kernel with all that it binds; `callers` is what is the caller's.
    pub(super) fn bound(
        &self,
        layers: &[Layer],
        step: &TileDispatch,
        uniform: &wgpu::Buffer,
        callers: Vec<(u32, BindingResource<'_>)>,
    ) -> Result<BoundPass, GpuError> {
        let (pass, reads, weights) = match &step.kernel {
            Kernel::Bound(bound) => return Ok(bound.clone()),
            Kernel::Open { pass, reads, weights } => (pass, reads, weights),
        };
        let mut resources = vec![
            (0, uniform.as_entire_binding()),
            (1, reads.as_entire_binding()),
            (2, weights.as_entire_binding()),
        ];
        let index = step.layer;
        if !step.callers[1] {
            resources.push((3, self.storage.binding(MapId::Made(index))));
        }
        let sources = maps::read_by(&layers[index]);
        resources.extend((4..).zip(sources.into_iter().map(|id| self.storage.binding(id))));
        if maps::has_means(layers, index) {
            resources.push((5, self.storage.binding(MapId::Means(index))));
        }
        pass.bind_at(&self.device, resources.into_iter().chain(callers))
    }
}

/// The passes of a network's head with their buffers, for images of a size in tiles of a frame.
fn head_of(
    network: &Network,
    size: [usize; 2],
    frame: [usize; 2],
) -> Result<Option<(head::Passes, head::HeadBuffers)>, GpuError> {
    let Some(passes) = &network.head else { return Ok(None) };
    Ok(Some((passes.clone(), passes.buffers(&network.device, &network.spec, size, frame)?)))
}
