//! Draws what the camera, or a light, sees: the nearest surface of each pixel in eight words and a depth.

use super::geometry::Geometry;
use super::material;
use super::texture::Textures;
use crate::scene::Material;
use deepshade_shaders::gpu::{self, DEPTH_FORMAT, GpuError, RasterPass};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::wgsl::uniforms::FrameView;

/// Two targets of four words.
const WORDS: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;

/// The pass, with a bind group a material.
#[derive(Debug)]
pub struct SurfacePass {
    pass: RasterPass,
    materials: Vec<wgpu::BindGroup>,
}

/// What is drawn into: an image of words.
#[derive(Debug)]
pub struct SurfaceImage {
    /// From where it is seen.
    pub view: wgpu::Buffer,
    /// What is known of each pixel.
    pub words: [wgpu::TextureView; 2],
    /// How far away it is.
    pub depth: wgpu::TextureView,
    group: wgpu::BindGroup,
}

impl SurfacePass {
    /// Compiles the pass and binds all materials.
    ///
    /// # Errors
    /// If the device refuses.
    pub fn new(device: &wgpu::Device, materials: &[Material], textures: &Textures) -> Result<Self, GpuError> {
        let shader = Shader::at("frame/surface");
        let pass = RasterPass::new(device, shader, &Geometry::LAYOUTS, Some("surface"), &[WORDS; 2])?;
        let bind = |material: &Material| material::bind(device, &pass, material, textures, false);
        let materials = materials.iter().map(bind).collect::<Result<_, GpuError>>()?;
        Ok(Self { pass, materials })
    }

    /// An image to draw into.
    ///
    /// # Errors
    /// If the device allows no image of that size or has no room.
    pub fn image(
        &self,
        device: &wgpu::Device,
        height: usize,
        width: usize,
    ) -> Result<SurfaceImage, GpuError> {
        let target = |label: &str, format| {
            let texture = gpu::target(device, label, format, [1, height, width])?;
            Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
        };
        let empty: FrameView = bytemuck::Zeroable::zeroed();
        let view = gpu::uniform(device, "frame.view", &empty)?;
        let group = self.pass.bind(device, 0, [(0, view.as_entire_binding())])?;
        Ok(SurfaceImage {
            view,
            words: [target("frame.first_words", WORDS)?, target("frame.second_words", WORDS)?],
            depth: target("frame.depth", DEPTH_FORMAT)?,
            group,
        })
    }

    /// Draws all meshes.
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        geometry: &Geometry,
        image: &SurfaceImage,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let cleared = |view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(self.pass.label()),
            color_attachments: &[cleared(&image.words[0]), cleared(&image.words[1])],
            depth_stencil_attachment: Some(cleared_depth(&image.depth)),
            timestamp_writes: timestamps,
            ..Default::default()
        });
        pass.set_pipeline(self.pass.pipeline());
        pass.set_bind_group(0, &image.group, &[]);
        set_buffers(&mut pass, geometry);
        for draw in &geometry.draws {
            pass.set_bind_group(1, &self.materials[draw.material as usize], &[]);
            pass.draw_indexed(draw.indices.clone(), draw.first_vertex as i32, draw.mesh..draw.mesh + 1);
        }
    }
}

impl SurfaceImage {
    /// Says from where the next frame is seen.
    pub fn set(&self, queue: &wgpu::Queue, view: &FrameView) {
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(view));
    }
}

/// A depth buffer that begins infinitely far away.
pub(super) fn cleared_depth(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
        stencil_ops: None,
    }
}

/// Binds vertices and indices.
pub(super) fn set_buffers(pass: &mut wgpu::RenderPass<'_>, geometry: &Geometry) {
    pass.set_vertex_buffer(0, geometry.posed.slice(..));
    pass.set_vertex_buffer(1, geometry.staying.slice(..));
    pass.set_index_buffer(geometry.indices.slice(..), wgpu::IndexFormat::Uint32);
}
