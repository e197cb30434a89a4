//! Where networks are trained: chosen by cargo feature, here and nowhere else.

use burn::tensor::Device;

#[cfg(not(feature = "vulkan"))]
pub(crate) use crate::kernels as ops;
#[cfg(feature = "vulkan")]
pub(crate) use crate::plain as ops;

/// The processor, or with the feature `vulkan` the first GPU.
pub fn device() -> Device {
    #[cfg(feature = "vulkan")]
    return Device::vulkan(Default::default());
    #[cfg(not(feature = "vulkan"))]
    return Device::flex();
}

/// So many devices, or how many there are. The processor stands for as many as are wanted: burn's `flex` has one device,
/// which takes work from several threads.
pub(crate) fn devices(count: usize) -> Result<Vec<Device>, usize> {
    if count == 1 {
        return Ok(vec![device()]);
    }
    #[cfg(feature = "vulkan")]
    {
        let found: Vec<Device> = Device::enumerate(burn::tensor::DeviceType::Vulkan).into_iter().collect();
        if found.len() < count { Err(found.len()) } else { Ok(found.into_iter().take(count).collect()) }
    }
    #[cfg(not(feature = "vulkan"))]
    Ok(vec![device(); count])
}
