//! Running compute passes on a GPU: device, buffers, passes, clock.
//!
//! Everything but [`Gpu::new`] takes a plain `wgpu::Device` and `wgpu::Queue`, so that a program with a
//! device of its own can run the same passes. What wgpu would report to its uncaptured-error handler, which
//! panics, comes back as a [`GpuError`] that names the buffer or pass.

mod buffer;
mod ceilings;
mod device;
mod pass;
mod pipeline_cache;
mod raster;
mod stamps;
mod texture;
mod timing;
mod waiting;

pub use buffer::{arena, empty, filled, read, read_async, read_part, storage, uniform, uniforms, write};
pub use ceilings::{Ceilings, ceilings, warm_up};
pub use device::{Gpu, adapter_key};
pub use pass::{BoundPass, Pass, groups, submit};
pub use pipeline_cache::PipelineCache;
pub use raster::{DEPTH_FORMAT, RasterPass, target};
pub use stamps::{PassClock, Stamps};
pub use texture::{array_view, read_texture_array, sent_texture, sent_volume, texture_array};
pub use timing::{PATIENCE, Timing, time, time_async};
pub use waiting::{idle, wait};

use thiserror::Error;

/// Why something on the GPU did not work.
#[derive(Clone, Debug, Error)]
pub enum GpuError {
    /// No adapter at all.
    #[error(
        "no Vulkan, Metal or DirectX 12 adapter ({0}); on Debian or Ubuntu `apt install mesa-vulkan-drivers \
         libvulkan1` installs a software one"
    )]
    NoAdapter(wgpu::RequestAdapterError),
    /// The adapter gave no device.
    #[error("adapter `{adapter}` gives no device: {source}")]
    Device {
        /// Name of the adapter.
        adapter: String,
        /// What it lacks.
        source: wgpu::RequestDeviceError,
    },
    /// A shader does not compile.
    #[error("shader `{label}`: {what}")]
    Shader {
        /// Label of the pass.
        label: String,
        /// What the compiler says.
        what: String,
    },
    /// A buffer is larger than the device allows.
    #[error("buffer `{label}` of {bytes} bytes; the device allows {limit}")]
    TooLarge {
        /// Label of the buffer.
        label: String,
        /// Size asked for.
        bytes: u64,
        /// Largest size allowed.
        limit: u64,
    },
    /// The device has no memory left for a buffer or a texture.
    #[error("`{label}`: the device has no room for {bytes} bytes more")]
    Memory {
        /// Label of the buffer or texture.
        label: String,
        /// Size asked for.
        bytes: u64,
    },
    /// The device refused a buffer, a binding or a submission.
    #[error("`{label}`: {what}")]
    Refused {
        /// Label of the buffer or pass.
        label: String,
        /// Why.
        what: String,
    },
    /// A buffer could not be read back.
    #[error("reading buffer `{label}` back: {what}")]
    Readback {
        /// Label of the buffer.
        label: String,
        /// Why.
        what: String,
    },
    /// A web page was to wait.
    #[error("a web page cannot wait for the device")]
    Page,
}

/// Runs `work`; whatever the device finds wrong with it is the error, in words.
fn catch<T>(device: &wgpu::Device, work: impl FnOnce() -> T) -> Result<T, String> {
    caught(device, work).map_err(|error| error.to_string())
}

/// Makes something that takes that many bytes of the device's memory.
fn allocate<T>(
    device: &wgpu::Device,
    label: &str,
    bytes: u64,
    make: impl FnOnce() -> T,
) -> Result<T, GpuError> {
    caught(device, make).map_err(|error| match error {
        wgpu::Error::OutOfMemory { .. } => GpuError::Memory { label: label.to_owned(), bytes },
        error => GpuError::Refused { label: label.to_owned(), what: error.to_string() },
    })
}

/// Runs `work`; whatever the device finds wrong with it is the error. What a driver's compiler refuses is
/// internal to it.
#[cfg(not(target_arch = "wasm32"))]
fn caught<T>(device: &wgpu::Device, work: impl FnOnce() -> T) -> Result<T, wgpu::Error> {
    let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let done = work();
    let invalid = pollster::block_on(validation.pop());
    let exhausted = pollster::block_on(memory.pop());
    let failed = pollster::block_on(internal.pop());
    invalid.or(exhausted).or(failed).map_or(Ok(done), Err)
}

/// Runs `work`. What a browser's device finds wrong it says later, to the handler of uncaptured errors.
#[cfg(target_arch = "wasm32")]
fn caught<T>(_: &wgpu::Device, work: impl FnOnce() -> T) -> Result<T, wgpu::Error> {
    Ok(work())
}

#[cfg(test)]
mod tests;
