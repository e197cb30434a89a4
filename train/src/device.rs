//! Where networks are trained: chosen by cargo feature, here and nowhere else.

use crate::TrainError;
use burn::tensor::Device;

#[cfg(feature = "vulkan")]
pub(crate) use crate::gpu as ops;
#[cfg(not(feature = "vulkan"))]
pub(crate) use crate::kernels as ops;

/// The processor, or with the feature `vulkan` the first GPU.
pub fn device() -> Device {
    #[cfg(feature = "vulkan")]
    return Device::vulkan(Default::default());
    #[cfg(not(feature = "vulkan"))]
    return Device::flex();
}

/// So many devices. The processor stands for as many as are wanted: burn's `flex` has one device, which takes work from several
/// threads.
///
/// # Errors
/// If there are fewer GPUs.
pub(crate) fn devices(count: usize) -> Result<Vec<Device>, TrainError> {
    #[cfg(feature = "vulkan")]
    {
        // burn panics when it is given a GPU that is not there.
        let found: Vec<Device> = Device::enumerate(burn::tensor::DeviceType::Vulkan).into_iter().collect();
        if found.len() < count {
            let problem = format!("is {count}, and Vulkan finds {}", found.len());
            return Err(TrainError::Config { field: "devices", problem });
        }
        Ok(if count == 1 { vec![device()] } else { found.into_iter().take(count).collect() })
    }
    #[cfg(not(feature = "vulkan"))]
    Ok(vec![device(); count])
}

#[cfg(test)]
mod tests;
