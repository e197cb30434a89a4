//! What all kernels are started with: sizes of the work, room for what is made, numbers in their order.

use super::Gpu;
use burn::backend::TensorMetadata;
use burn_cubecl::kernel::into_contiguous;
use burn_cubecl::ops::numeric::empty_device_contiguous_dtype;
use cubecl::{calculate_cube_count_elemwise, prelude::*};

/// Most units of a cube.
pub const UNITS: usize = 256;
/// Most cubes along an axis. Units of kernels whose work is larger take several pixels.
const MOST_CUBES: usize = 65_535;

/// Units of a cube for so much work.
pub fn units(work: usize) -> CubeDim {
    CubeDim::new_1d(work.next_power_of_two().clamp(32, UNITS) as u32)
}

/// Cubes of [`units`] for so much work along x, so many times along y and z.
pub fn cubes(work: usize, y: usize, z: usize) -> CubeCount {
    let units = units(work).x as usize;
    CubeCount::Static(work.div_ceil(units).min(MOST_CUBES) as u32, y as u32, z as u32)
}

/// Cubes of [`units`] for so many numbers, along all axes.
pub fn each(like: &Gpu, numbers: usize) -> CubeCount {
    calculate_cube_count_elemwise(&like.client, numbers, units(numbers))
}

/// The largest divisor that is at most so large.
pub fn divisor(number: usize, most: usize) -> usize {
    (1..=most.min(number)).rev().find(|divisor| number.is_multiple_of(*divisor)).unwrap_or(1)
}

/// A tensor's shape.
pub fn dims<const D: usize>(tensor: &Gpu) -> [usize; D] {
    tensor.shape().dims()
}

/// Room for a tensor.
pub fn empty<const D: usize>(like: &Gpu, shape: [usize; D]) -> Gpu {
    empty_device_contiguous_dtype(like.client.clone(), like.device.clone(), shape.into(), like.dtype)
}

/// A tensor's numbers in their order.
pub fn buffer(tensor: &Gpu) -> BufferArg {
    into_contiguous(tensor.clone()).into_buffer_arg()
}
