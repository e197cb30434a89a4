//! A pass that computes every pixel of a texture that can be drawn to and not stored to, as Bevy's pictures.

use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, CommandEncoder, Device, FragmentState,
    LoadOp, MultisampleState, Operations, PrimitiveState, RenderPassColorAttachment, RenderPassDescriptor,
    RenderPipeline, RenderPipelineDescriptor, ShaderModuleDescriptor, ShaderSource, StoreOp, TextureFormat,
    TextureView, VertexState,
};

/// A compiled pass.
pub(super) struct Draw {
    label: String,
    pipeline: RenderPipeline,
}

/// A pass with its resources, onto a texture.
pub(crate) struct BoundDraw {
    label: String,
    pipeline: RenderPipeline,
    group: BindGroup,
    onto: TextureView,
}

impl Draw {
    /// Compiles WGSL source with the entry points `corner`, of three vertices of one triangle over all of the
    /// image, and `pixel`, onto textures of a format. The source is one of this crate's, so that a device has
    /// nothing to refuse.
    pub fn new(device: &Device, label: &str, wgsl: &str, format: TextureFormat) -> Self {
        let label = format!("deepshade.{label}");
        let module = device.create_shader_module(ShaderModuleDescriptor {
            label: Some(&label),
            source: ShaderSource::Wgsl(wgsl.into()),
        });
        let pipeline = device.create_render_pipeline(&RenderPipelineDescriptor {
            label: Some(&label),
            layout: None,
            vertex: VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: PrimitiveState::default(),
            depth_stencil: None,
            multisample: MultisampleState::default(),
            fragment: Some(FragmentState {
                module: &module,
                entry_point: Some("pixel"),
                compilation_options: Default::default(),
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { label, pipeline }
    }

    /// Binds resources to bindings 0, 1, 2, ... of group 0.
    pub fn bind(&self, device: &Device, resources: &[BindingResource<'_>], onto: &TextureView) -> BoundDraw {
        let entries: Vec<BindGroupEntry<'_>> = (0..)
            .zip(resources)
            .map(|(binding, resource)| BindGroupEntry { binding, resource: resource.clone() })
            .collect();
        let group = device.create_bind_group(&BindGroupDescriptor {
            label: Some(&self.label),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        BoundDraw { label: self.label.clone(), pipeline: self.pipeline.clone(), group, onto: onto.clone() }
    }
}

impl BoundDraw {
    /// Records the pass.
    pub fn encode(&self, encoder: &mut CommandEncoder) {
        let onto = RenderPassColorAttachment {
            view: &self.onto,
            depth_slice: None,
            resolve_target: None,
            ops: Operations { load: LoadOp::Clear(Default::default()), store: StoreOp::Store },
        };
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some(&self.label),
            color_attachments: &[Some(onto)],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
