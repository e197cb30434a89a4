//! Where networks are trained: chosen by cargo feature, here and nowhere else.

use crate::TrainError;
use burn::tensor::Device;

#[cfg(feature = "vulkan")]
pub(crate) use crate::gpu as ops;
#[cfg(not(feature = "vulkan"))]
pub(crate) use crate::kernels as ops;

/// The processor, or with the feature `vulkan` the fastest of the adapters that Vulkan finds, which may be a
/// software one.
///
/// # Panics
/// If there is none, which [`devices`] says first.
pub fn device() -> Device {
    #[cfg(feature = "vulkan")]
    return Device::vulkan(Default::default());
    #[cfg(not(feature = "vulkan"))]
    return Device::flex();
}

/// What [`device`] is called.
///
/// # Errors
/// If there is none.
pub fn device_name() -> Result<String, TrainError> {
    #[cfg(feature = "vulkan")]
    return Ok(devices(1)?.remove(0).identity().map_or_else(|| "a GPU".to_owned(), |identity| identity.name));
    #[cfg(not(feature = "vulkan"))]
    return Ok(format!("{} threads", rayon::current_num_threads()));
}

/// [`device`], or so many. The processor stands for as many as are wanted: burn's `flex` has one device,
/// which takes work from several threads.
///
/// # Errors
/// If there are fewer adapters.
pub(crate) fn devices(count: usize) -> Result<Vec<Device>, TrainError> {
    #[cfg(feature = "vulkan")]
    {
        let found: Vec<Device> = Device::enumerate(burn::tensor::DeviceType::Vulkan).into_iter().collect();
        if found.is_empty() {
            return Err(TrainError::Device("there is no Vulkan adapter".to_owned()));
        }
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
