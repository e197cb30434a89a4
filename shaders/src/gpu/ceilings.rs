//! What a device can do at best: the ceilings under which everything else is measured.

use super::{GpuError, Pass, empty, storage, time};
use crate::wgsl;

/// Bytes that are copied at a time: far more than caches hold, and within every device's limits.
const COPIED: usize = 1 << 26;
/// Invocations that multiply and add.
const INVOCATIONS: usize = 1 << 17;
/// Turns of each, and sums a turn.
const TURNS: usize = 256;
const SUMS: usize = 32;
/// Runs that are timed.
const RUNS: usize = 5;

/// What a device can do at best.
#[derive(Clone, Copy, Debug)]
pub struct Ceilings {
    /// Bytes a second that a copy reads and writes, both counted.
    pub copy: f64,
    /// Floating-point operations a second in 32-bit multiplications with additions, two each.
    pub multiply_add: f64,
}

/// Measures a device's ceilings, in well under a second on a GPU and some seconds on a software adapter.
///
/// # Errors
/// If the device has no room for two buffers of 64 MiB, or is lost.
pub fn ceilings(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Ceilings, GpuError> {
    Ok(Ceilings { copy: copy(device, queue)?, multiply_add: multiply_add(device, queue)? })
}

fn copy(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<f64, GpuError> {
    let source = storage(device, "ceilings.source", &vec![1.0f32; COPIED / size_of::<f32>()])?;
    let made = empty::<u8>(device, "ceilings.made", COPIED)?;
    let pass = Pass::new(device, wgsl::COPY.name, &wgsl::COPY.source())?;
    let pass = pass.bind(device, &[source.as_entire_binding(), made.as_entire_binding()])?;
    let timing = time(device, queue, "copy", 2, RUNS, |encoder| pass.dispatch(encoder, [1 << 14, 1, 1]))?;
    Ok(2.0 * COPIED as f64 / (timing.milliseconds * 1e-3))
}

fn multiply_add(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<f64, GpuError> {
    let made = empty::<[f32; 4]>(device, "ceilings.sums", INVOCATIONS)?;
    let pass = Pass::new(device, wgsl::FMA.name, &wgsl::FMA.specialised(&[("TURNS", TURNS as u32)]))?;
    let pass = pass.bind(device, &[made.as_entire_binding()])?;
    let workgroups = [INVOCATIONS as u32 / 64, 1, 1];
    let timing = time(device, queue, "fma", 2, RUNS, |encoder| pass.dispatch(encoder, workgroups))?;
    Ok((2 * INVOCATIONS * TURNS * SUMS) as f64 / (timing.milliseconds * 1e-3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::Gpu;

    #[test]
    fn ceilings_are_plausible() {
        let gpu = Gpu::new().expect("an adapter; lavapipe will do");
        let Ceilings { copy, multiply_add } = ceilings(&gpu.device, &gpu.queue).expect("runs");
        // From a single slow core to ten times the fastest GPU of today.
        assert!((1e8..1e14).contains(&copy), "{copy} bytes a second");
        assert!((1e8..1e15).contains(&multiply_add), "{multiply_add} operations a second");
    }
}
