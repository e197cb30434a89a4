//! A compute pass: a shader, what is bound to it, and how many workgroups run.

use super::{GpuError, PipelineCache, catch};
use crate::wgsl::{Shader, located};

/// What every label begins with.
const LABEL: &str = "deepshade.";

/// A compiled compute shader with one entry point and one bind group.
#[derive(Clone, Debug)]
pub struct Pass {
    label: String,
    pipeline: wgpu::ComputePipeline,
}

/// A pass with its resources, ready to run as often as wanted.
#[derive(Clone, Debug)]
pub struct BoundPass {
    label: String,
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
}

impl Pass {
    /// Compiles WGSL source under the name `deepshade.<label>`. The layout of group 0 follows from the
    /// source.
    ///
    /// Workgroup memory is not cleared beforehand, which costs time: a shader writes it before it reads it.
    ///
    /// # Errors
    /// If the source or the pipeline is not valid.
    pub fn new(device: &wgpu::Device, label: &str, wgsl: &str) -> Result<Self, GpuError> {
        Self::cached(device, label, wgsl, None)
    }

    /// Compiles a shader under its name, with other values for some of its constants.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn of(device: &wgpu::Device, shader: Shader, constants: &[(&str, u32)]) -> Result<Self, GpuError> {
        Self::new(device, &shader.name(), &shader.specialised(constants))
    }

    /// As [`Pass::new`], with what a cache remembers of the same source.
    ///
    /// # Errors
    /// If the source or the pipeline is not valid.
    pub fn cached(
        device: &wgpu::Device,
        label: &str,
        wgsl: &str,
        cache: Option<&PipelineCache>,
    ) -> Result<Self, GpuError> {
        let label = format!("{LABEL}{label}");
        let pipeline = catch(device, || {
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(&label),
                source: wgpu::ShaderSource::Wgsl(wgsl.into()),
            });
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(&label),
                layout: None,
                module: &module,
                entry_point: None,
                compilation_options: wgpu::PipelineCompilationOptions {
                    zero_initialize_workgroup_memory: false,
                    ..Default::default()
                },
                cache: cache.and_then(PipelineCache::get),
            })
        })
        .map_err(|what| GpuError::Shader { label: label.clone(), what: located(&what, wgsl) })?;
        Ok(Self { label, pipeline })
    }

    /// Binds resources to bindings 0, 1, 2, ... of group 0.
    ///
    /// # Errors
    /// If they are not what the shader declares and uses.
    pub fn bind(
        &self,
        device: &wgpu::Device,
        resources: &[wgpu::BindingResource<'_>],
    ) -> Result<BoundPass, GpuError> {
        self.bind_at(device, (0..).zip(resources.iter().cloned()))
    }

    /// Binds resources to bindings of group 0 by their numbers.
    ///
    /// # Errors
    /// If they are not what the shader declares and uses.
    pub fn bind_at<'a>(
        &self,
        device: &wgpu::Device,
        resources: impl IntoIterator<Item = (u32, wgpu::BindingResource<'a>)>,
    ) -> Result<BoundPass, GpuError> {
        let entries: Vec<_> = resources
            .into_iter()
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let group = catch(device, || {
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(&self.label),
                layout: &self.pipeline.get_bind_group_layout(0),
                entries: &entries,
            })
        })
        .map_err(|what| GpuError::Refused { label: self.label.clone(), what })?;
        Ok(BoundPass { label: self.label.clone(), pipeline: self.pipeline.clone(), group })
    }
}

impl BoundPass {
    /// Records the pass, `workgroups` in x, y and z.
    pub fn dispatch(&self, encoder: &mut wgpu::CommandEncoder, workgroups: [u32; 3]) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(&self.label),
            timestamp_writes: None,
        });
        self.dispatch_in(&mut pass, workgroups);
    }

    /// Records the pass within a compute pass of wgpu's, which holds as many as wanted one after the other.
    pub fn dispatch_in(&self, pass: &mut wgpu::ComputePass<'_>, workgroups: [u32; 3]) {
        let [x, y, z] = workgroups;
        self.set_in(pass);
        pass.dispatch_workgroups(x, y, z);
    }

    /// As [`BoundPass::dispatch_in`], with as many workgroups as three words of a buffer say that an earlier
    /// pass has written.
    pub fn dispatch_counted_in(&self, pass: &mut wgpu::ComputePass<'_>, counts: &wgpu::Buffer, offset: u64) {
        self.set_in(pass);
        pass.dispatch_workgroups_indirect(counts, offset);
    }

    /// The shader's name, after that of the part that it belongs to.
    pub fn name(&self) -> &str {
        self.label.strip_prefix(LABEL).unwrap_or(&self.label)
    }

    /// Whether it runs the shader of that name, whatever part it belongs to.
    pub fn is_of(&self, shader: &str) -> bool {
        self.name().rsplit('/').next() == Some(shader)
    }

    /// The same pass as one of a part of a method.
    #[must_use]
    pub fn within(self, part: &str) -> Self {
        Self { label: format!("{LABEL}{part}/{}", self.name()), ..self }
    }

    fn set_in(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
    }
}

/// Workgroups of `tile` x `tile` invocations that cover an image.
pub const fn groups(height: usize, width: usize, tile: u32) -> [u32; 3] {
    [(width as u32).div_ceil(tile), (height as u32).div_ceil(tile), 1]
}

/// Records work and submits it, without waiting for it.
///
/// # Errors
/// If what was recorded is not valid, or the device is out of memory; `label` names it.
pub fn submit(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    record: impl FnOnce(&mut wgpu::CommandEncoder),
) -> Result<(), GpuError> {
    let label = format!("deepshade.{label}");
    catch(device, || {
        let mut encoder =
            device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(&label) });
        record(&mut encoder);
        queue.submit([encoder.finish()]);
    })
    .map_err(|what| GpuError::Refused { label: label.clone(), what })
}
