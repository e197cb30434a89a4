//! A raster pass: a vertex and perhaps a fragment shader over triangles, with a depth buffer in which what is
//! near is large.

use super::{GpuError, catch};
use crate::wgsl::{Shader, located};

/// Format of depth buffers.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// A compiled raster pipeline of triangles, seen from both sides.
#[derive(Clone, Debug)]
pub struct RasterPass {
    label: String,
    pipeline: wgpu::RenderPipeline,
}

impl RasterPass {
    /// Compiles WGSL source under the name `deepshade.<label>`: the vertex shader `corner`, and the fragment
    /// shader `fragment` if there is one, which writes `targets`. Layouts of bind groups follow from the
    /// source.
    ///
    /// # Errors
    /// If the source or the pipeline is not valid.
    pub fn new(
        device: &wgpu::Device,
        shader: Shader,
        buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
        fragment: Option<&str>,
        targets: &[wgpu::TextureFormat],
    ) -> Result<Self, GpuError> {
        let (label, wgsl) = (format!("deepshade.{}", shader.name()), shader.source());
        let targets: Vec<_> = targets.iter().map(|format| Some((*format).into())).collect();
        let pipeline = catch(device, || {
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(&label),
                source: wgpu::ShaderSource::Wgsl((&wgsl).into()),
            });
            let compilation_options = wgpu::PipelineCompilationOptions::default();
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(&label),
                layout: None,
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("corner"),
                    compilation_options: compilation_options.clone(),
                    buffers,
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH_FORMAT,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::Greater),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState::default(),
                fragment: fragment.map(|name| wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(name),
                    compilation_options,
                    targets: &targets,
                }),
                multiview_mask: None,
                cache: None,
            })
        })
        .map_err(|what| GpuError::Shader { label: label.clone(), what: located(&what, &wgsl) })?;
        Ok(Self { label, pipeline })
    }

    /// Binds resources to bindings of a group by their numbers.
    ///
    /// # Errors
    /// If they are not what the shader declares and uses.
    pub fn bind<'a>(
        &self,
        device: &wgpu::Device,
        group: u32,
        resources: impl IntoIterator<Item = (u32, wgpu::BindingResource<'a>)>,
    ) -> Result<wgpu::BindGroup, GpuError> {
        let entries: Vec<_> = resources
            .into_iter()
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        catch(device, || {
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(&self.label),
                layout: &self.pipeline.get_bind_group_layout(group),
                entries: &entries,
            })
        })
        .map_err(|what| GpuError::Refused { label: self.label.clone(), what })
    }

    /// Its label.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// The pipeline, to be set in a render pass.
    pub const fn pipeline(&self) -> &wgpu::RenderPipeline {
        &self.pipeline
    }
}

/// A texture `deepshade.<label>` that raster passes write and later passes read, `size` being layers, rows
/// and columns.
///
/// # Errors
/// If the device allows none of that size or has no room for it.
pub fn target(
    device: &wgpu::Device,
    label: &str,
    format: wgpu::TextureFormat,
    size: [usize; 3],
) -> Result<wgpu::Texture, GpuError> {
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
    super::texture::create(device, label, format, size, usage)
}
