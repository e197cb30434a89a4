//! The canvas: two images beside a border, drawn where the device has them.

use crate::render::picture::{Curve, Exposure};
use anyhow::{Context, Result};
use deepshade_shaders::Effect;
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::wgsl::uniforms::Wipe;
use web_sys::HtmlCanvasElement;

/// What draws.
const LABEL: &str = "frame.wipe";

/// Every browser's canvas has it.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Bgra8Unorm;

/// A canvas with what draws on it.
pub struct Canvas {
    element: HtmlCanvasElement,
    surface: wgpu::Surface<'static>,
    pipeline: wgpu::RenderPipeline,
}

/// What is drawn.
#[derive(Clone, Copy)]
pub struct Drawing<'a> {
    /// Images of one effect: to the left and to the right of the border.
    pub images: [&'a wgpu::Buffer; 2],
    /// Which effect.
    pub effect: Effect,
    /// Rows and columns.
    pub size: [usize; 2],
    /// Where the border is, a share of the width.
    pub border: f32,
    /// How light becomes that of a screen.
    pub exposure: Exposure,
}

impl Canvas {
    /// Takes hold of a canvas.
    ///
    /// # Errors
    /// If the browser does not give it away.
    pub fn new(instance: &wgpu::Instance, gpu: &Gpu, element: HtmlCanvasElement) -> Result<Self> {
        let surface = instance.create_surface(wgpu::SurfaceTarget::Canvas(element.clone()))?;
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(LABEL),
            source: wgpu::ShaderSource::Wgsl(Shader::at("frame/wipe").source().into()),
        });
        let compilation_options = wgpu::PipelineCompilationOptions::default();
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(LABEL),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options: compilation_options.clone(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options,
                targets: &[Some(FORMAT.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Ok(Self { element, surface, pipeline })
    }

    /// Makes the canvas as large as images of so many rows and columns.
    pub fn resize(&self, gpu: &Gpu, [height, width]: [usize; 2]) {
        let [height, width] = [height, width].map(|pixels| pixels as u32);
        self.element.set_width(width);
        self.element.set_height(height);
        self.surface.configure(
            &gpu.device,
            &wgpu::SurfaceConfiguration {
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
                format: FORMAT,
                color_space: wgpu::SurfaceColorSpace::default(),
                width,
                height,
                present_mode: wgpu::PresentMode::Fifo,
                desired_maximum_frame_latency: 2,
                alpha_mode: wgpu::CompositeAlphaMode::Opaque,
                view_formats: Vec::new(),
            },
        );
    }

    /// Draws, after all that was submitted.
    ///
    /// # Errors
    /// If the canvas is gone.
    pub fn draw(&self, gpu: &Gpu, drawing: &Drawing<'_>) -> Result<()> {
        let [height, width] = drawing.size.map(|pixels| pixels as u32);
        let Curve { scale, compression, stretch } = drawing.exposure.curve();
        let wipe = Wipe {
            width,
            height,
            channels: drawing.effect.channels() as u32,
            border: drawing.border * width as f32,
            scale,
            compression,
            stretch,
        };
        let wipe = gpu::uniform(&gpu.device, "wipe", &wipe)?;
        let [left, right] = drawing.images;
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(LABEL),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: left.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: right.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: wipe.as_entire_binding() },
            ],
        });
        let frame = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(frame) | wgpu::CurrentSurfaceTexture::Suboptimal(frame) => {
                Some(frame)
            }
            _ => None,
        };
        let frame = frame.context("the canvas is gone")?;
        let view = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
        gpu::submit(&gpu.device, &gpu.queue, "wipe", |encoder| {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(LABEL),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations::default(),
                })],
                ..Default::default()
            });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.draw(0..3, 0..1);
        })?;
        gpu.queue.present(frame);
        Ok(())
    }
}
