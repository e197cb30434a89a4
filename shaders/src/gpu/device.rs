//! The device of programs that have none of their own.

use super::{GpuError, wait};
use wgpu::Features;

/// A device and its queue. Clones share both.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// Makes buffers and pipelines.
    pub device: wgpu::Device,
    /// Takes the work.
    pub queue: wgpu::Queue,
    /// Name, driver and kind of the adapter; every figure states it.
    pub info: wgpu::AdapterInfo,
}

impl Gpu {
    /// Opens the fastest adapter there is; a software one will do.
    ///
    /// The limits are those that WebGPU guarantees, but for memory, of which the device may use as much as
    /// the adapter offers: of a buffer, of a binding, and of what a workgroup shares. The only optional
    /// features are timestamps ([`super::time`]), half floats and pipeline caches ([`super::PipelineCache`]),
    /// each requested where it is offered.
    ///
    /// # Errors
    /// If there is no adapter, or it offers less than WebGPU's limits.
    pub fn new() -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        wait(Self::of(&instance))?
    }

    /// As [`Gpu::new`], of an instance that may have surfaces too, awaited.
    ///
    /// # Errors
    /// If there is no adapter, or it offers less than WebGPU's limits.
    pub async fn of(instance: &wgpu::Instance) -> Result<Self, GpuError> {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = instance.request_adapter(&options).await.map_err(GpuError::NoAdapter)?;
        let info = adapter.get_info();
        let optional = Features::TIMESTAMP_QUERY
            | Features::TIMESTAMP_QUERY_INSIDE_ENCODERS
            | Features::SHADER_F16
            | Features::PIPELINE_CACHE;
        let offered = adapter.limits();
        let required_limits = wgpu::Limits {
            max_buffer_size: offered.max_buffer_size,
            max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size,
            max_compute_workgroup_storage_size: offered.max_compute_workgroup_storage_size,
            ..wgpu::Limits::default()
        };
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("deepshade"),
            required_limits,
            required_features: adapter.features() & optional,
            ..Default::default()
        };
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|source| GpuError::Device { adapter: info.name.clone(), source })?;
        Ok(Self { device, queue, info })
    }

    /// Whether the adapter is software, which computes on the processor.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }
}

/// An adapter with its driver, in one line: whose measurements and compiled shaders something is.
pub fn adapter_key(info: &wgpu::AdapterInfo) -> String {
    let wgpu::AdapterInfo { name, vendor, device, driver, driver_info, backend, .. } = info;
    format!("{name} {vendor:x}:{device:x} {backend:?} {driver} {driver_info}").replace('\n', " ")
}
