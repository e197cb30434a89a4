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
