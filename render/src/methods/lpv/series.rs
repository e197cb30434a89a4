//! The passes by which the last iteration stands for all that would follow: [`crate::lpv::series`].

use super::volume_buffers::VolumeBuffers;
use crate::lpv::series::LOOKED_AT;
use crate::screen::{Device, MethodStep};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;

/// Parts of the cells whose energies are summed apart.
const PARTS: u32 = 64;

/// Iterations of light that goes on and on, with the passes that measure and weigh; of other light, and where
/// there are too few to tell, they are as they come.
///
/// # Errors
/// If the device refuses a pass.
pub fn with_end(
    room: &VolumeBuffers,
    device: &Device,
    iterations: Vec<MethodStep>,
) -> Result<Vec<MethodStep>, GpuError> {
    let Some(first) = iterations.len().checked_sub(LOOKED_AT + 1).filter(|_| room.kinds.goes_on()) else {
        return Ok(iterations);
    };
    let buffer = || gpu::empty::<[f32; 4]>(device, "lpv.energies", PARTS as usize * room.kinds.count());
    let energies = [buffer()?, buffer()?, buffer()?];
    let constants = [&room.constants()[..], &[room.scheme.lobes_constant()]].concat();
    let energy = device.pass(Shader::at("methods/lpv/energy"), &constants)?;
    let series = device.pass(Shader::at("methods/lpv/series"), &room.constants())?;
    let mut steps = Vec::new();
    for (number, iteration) in iterations.into_iter().enumerate() {
        let measured = number.checked_sub(first).filter(|looked_at| *looked_at < LOOKED_AT);
        if number == first + LOOKED_AT {
            let [first, second, third] = &energies;
            let (reads, written) = ([(1, first), (2, second), (3, third)], [(4, &room.weights)]);
            steps.push(MethodStep::bind_at(device, &series, [1, 1, 1], &reads, &written)?);
        }
        steps.push(iteration);
        if let Some(looked_at) = measured {
            let reads = [&room.record, room.state_after(number)];
            let written = [&energies[looked_at]];
            steps.push(MethodStep::bind(device, &energy, [PARTS, 1, 1], &reads, &written)?);
        }
    }
    Ok(steps)
}
