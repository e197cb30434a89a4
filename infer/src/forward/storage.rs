//! Feature maps on a device.

use super::map_layout::{MapLayout, SizedMap, position};
use super::maps::MapId;
use super::packing::BLOCK;
use super::{ForwardError, Precision};
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{self, GpuError};
use half::f16;
use wgpu::BindingResource;

/// Feature maps on a device.
#[derive(Debug)]
pub struct Storage {
    maps: Vec<SizedMap>,
    layout: MapLayout,
    precision: Precision,
    textures: Vec<wgpu::Texture>,
    views: Vec<wgpu::TextureView>,
    buffers: Vec<wgpu::Buffer>,
}

impl Storage {
    /// Makes what holds the maps.
    pub fn new(
        device: &wgpu::Device,
        maps: Vec<SizedMap>,
        layout: MapLayout,
        precision: Precision,
    ) -> Result<Self, GpuError> {
        let (mut textures, mut buffers) = (Vec::new(), Vec::new());
        match &layout {
            MapLayout::Textures { sizes, .. } => {
                for (index, [blocks, rows, columns]) in sizes.iter().enumerate() {
                    let label = format!("net.maps{index}");
                    textures.push(gpu::texture_array(device, &label, *blocks, *rows, *columns)?);
                }
            }
            MapLayout::Arena { sizes, .. } => {
                for (index, bytes) in sizes.iter().enumerate() {
                    buffers.push(gpu::arena(device, &format!("net.arena{index}"), *bytes)?);
                }
            }
        }
        let views = textures.iter().map(gpu::array_view).collect();
        Ok(Self { maps, layout, precision, textures, views, buffers })
    }

    /// All bytes.
    pub fn bytes(&self) -> u64 {
        self.layout.bytes()
    }

    /// A map, to be bound.
    pub fn binding(&self, id: MapId) -> BindingResource<'_> {
        let index = position(&self.maps, id);
        match &self.layout {
            MapLayout::Textures { of_map, .. } => BindingResource::TextureView(&self.views[of_map[index]]),
            MapLayout::Arena { regions, .. } => {
                let region = regions[index];
                BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: &self.buffers[region.buffer],
                    offset: region.offset,
                    size: wgpu::BufferSize::new(region.bytes),
                })
            }
        }
    }

    /// What a map holds now, `[channels, rows, columns]`.
    pub fn read(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        id: MapId,
    ) -> Result<Planes, ForwardError> {
        let index = position(&self.maps, id);
        let elements = match &self.layout {
            MapLayout::Textures { of_map, .. } => {
                gpu::read_texture_array::<f32>(device, queue, &self.textures[of_map[index]])?
            }
            MapLayout::Arena { regions, .. } => {
                let region = regions[index];
                let buffer = &self.buffers[region.buffer];
                match self.precision {
                    Precision::F32 => gpu::read_part(device, queue, buffer, region.offset, region.bytes)?,
                    Precision::F16 => {
                        let halves: Vec<f16> =
                            gpu::read_part(device, queue, buffer, region.offset, region.bytes)?;
                        halves.into_iter().map(f16::to_f32).collect()
                    }
                }
            }
        };
        let SizedMap { map, frame: [rows, columns], .. } = &self.maps[index];
        Ok(Planes::from_fn(map.channels, *rows, *columns, |c, y, x| {
            elements[(((c / BLOCK) * rows + y) * columns + x) * BLOCK + c % BLOCK]
        }))
    }
}
