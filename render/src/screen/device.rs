//! A device with the passes that were compiled for it.

use deepshade_shaders::gpu::{GpuError, Pass};
use deepshade_shaders::wgsl::Shader;
use std::collections::HashMap;
use std::ops::Deref;
use std::sync::{Arc, Mutex, PoisonError};

/// A shader and the constants that are not as it has them.
type Program = (Shader, Vec<(&'static str, u32)>);

/// A device that compiles each pass once. Clones remember the same passes.
#[derive(Clone, Debug)]
pub struct Device {
    device: wgpu::Device,
    compiled: Arc<Mutex<HashMap<Program, Pass>>>,
}

impl Device {
    /// One that remembers nothing yet.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { device: device.clone(), compiled: Arc::default() }
    }

    /// The pass of a shader with other values for some of its constants.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn pass(&self, shader: Shader, constants: &[(&'static str, u32)]) -> Result<Pass, GpuError> {
        // What is there is whole, whatever happened to another thread.
        let mut compiled = self.compiled.lock().unwrap_or_else(PoisonError::into_inner);
        let program = (shader, constants.to_vec());
        if let Some(pass) = compiled.get(&program) {
            return Ok(pass.clone());
        }
        let pass = Pass::of(&self.device, shader, constants)?;
        compiled.insert(program, pass.clone());
        Ok(pass)
    }
}

impl Deref for Device {
    type Target = wgpu::Device;

    fn deref(&self) -> &wgpu::Device {
        &self.device
    }
}
