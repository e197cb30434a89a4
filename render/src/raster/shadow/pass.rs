//! Draws the maps.

use super::MapPlan;
use crate::raster::geometry::Geometry;
use crate::raster::material;
use crate::raster::surface::{cleared_depth, set_buffers};
use crate::raster::texture::Textures;
use crate::scene::{AlphaMode, Material};
use deepshade_shaders::gpu::{self, DEPTH_FORMAT, GpuError, RasterPass};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::wgsl::uniforms::FrameView;

/// The passes that draw the maps, and the maps.
#[derive(Debug)]
pub struct ShadowPass {
    opaque: RasterPass,
    masked: RasterPass,
    /// Of each material that has holes.
    holes: Vec<Option<wgpu::BindGroup>>,
    /// For each map its layer, what the passes know of it, and where that is.
    layers: Vec<Layer>,
    /// All layers.
    pub maps: wgpu::TextureView,
}

#[derive(Debug)]
struct Layer {
    target: wgpu::TextureView,
    view: wgpu::Buffer,
    opaque: wgpu::BindGroup,
    masked: wgpu::BindGroup,
}

impl ShadowPass {
    /// Compiles the passes and makes the maps.
    ///
    /// # Errors
    /// If the device refuses or has no room.
    pub fn new(
        device: &wgpu::Device,
        plan: &MapPlan,
        materials: &[Material],
        textures: &Textures,
    ) -> Result<Self, GpuError> {
        let layouts = Geometry::LAYOUTS;
        let opaque = RasterPass::new(device, Shader::at("frame/depth"), &layouts, None, &[])?;
        let masked = RasterPass::new(device, Shader::at("frame/depth_masked"), &layouts, Some("holes"), &[])?;
        let holes = materials.iter().map(|material| {
            let has_holes = material.alpha != AlphaMode::Opaque;
            has_holes.then(|| material::bind(device, &masked, material, textures, true)).transpose()
        });
        let holes = holes.collect::<Result<_, GpuError>>()?;
        let texture =
            gpu::target(device, "frame.shadow_maps", DEPTH_FORMAT, [plan.maps.max(1), plan.size, plan.size])?;
        let layer = |index: usize| {
            let view = gpu::uniform::<FrameView>(device, "frame.map_view", &bytemuck::Zeroable::zeroed())?;
            let bind = |pass: &RasterPass| pass.bind(device, 0, [(0, view.as_entire_binding())]);
            let (opaque, masked) = (bind(&opaque)?, bind(&masked)?);
            let target = texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: index as u32,
                array_layer_count: Some(1),
                ..Default::default()
            });
            Ok(Layer { target, view, opaque, masked })
        };
        let layers = (0..plan.maps).map(layer).collect::<Result<_, GpuError>>()?;
        Ok(Self { opaque, masked, holes, layers, maps: gpu::array_view(&texture) })
    }

    /// Says from where the maps look.
    pub fn set(&self, queue: &wgpu::Queue, views: &[FrameView]) {
        for (layer, view) in self.layers.iter().zip(views) {
            queue.write_buffer(&layer.view, 0, bytemuck::bytes_of(view));
        }
    }

    /// Draws a map.
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        geometry: &Geometry,
        map: usize,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let layer = &self.layers[map];
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.opaque.label()),
            depth_stencil_attachment: Some(cleared_depth(&layer.target)),
            timestamp_writes: timestamps,
            ..Default::default()
        });
        set_buffers(&mut pass, geometry);
        for (has_holes, raster, group) in
            [(false, &self.opaque, &layer.opaque), (true, &self.masked, &layer.masked)]
        {
            pass.set_pipeline(raster.pipeline());
            pass.set_bind_group(0, group, &[]);
            for draw in &geometry.draws {
                let holes = &self.holes[draw.material as usize];
                if holes.is_some() != has_holes {
                    continue;
                }
                if let Some(material) = holes {
                    pass.set_bind_group(1, material, &[]);
                }
                pass.draw_indexed(draw.indices.clone(), draw.first_vertex as i32, 0..1);
            }
        }
    }
}
