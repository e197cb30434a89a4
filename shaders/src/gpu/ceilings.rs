//! What a device can do at best: the ceilings under which everything else is measured.

use super::{BoundPass, GpuError, Pass, empty, storage, time};
use crate::wgsl::Shader;
use std::time::Duration;
use web_time::Instant;

/// Bytes that are copied at a time, where the device's limits allow: more than caches hold.
const COPIED: u64 = 1 << 27;
/// Invocations that multiply and add.
const INVOCATIONS: usize = 1 << 17;
const WORKGROUPS: [u32; 3] = [INVOCATIONS as u32 / 64, 1, 1];
/// Turns that each makes at first, and at most; sums a turn.
const TURNS: u32 = 256;
const MOST_TURNS: u32 = 1 << 22;
const SUMS: usize = 32;
/// Milliseconds that a run takes at least, so that its beginning and its end do not count.
const LEAST: f64 = 10.0;
/// Runs that are timed.
const RUNS: usize = 5;
/// How long a device is busy before it is measured.
const WARM_UP_TIME: Duration = Duration::from_millis(500);
/// Runs that keep a device busy while the next ones are recorded.
const WARM_UP_RUNS: usize = 64;

/// What a device can do at best.
#[derive(Clone, Copy, Debug)]
pub struct Ceilings {
    /// Bytes a second that a copy reads and writes, both counted.
    pub copy: f64,
    /// Floating-point operations a second in 32-bit multiplications with additions, two each.
    pub multiply_add: f64,
}

/// Measures a device's ceilings, in about a second on a GPU and some seconds on a software adapter.
///
/// # Errors
/// If the device has no room for two buffers of 128 MiB, or of what its limits allow, or is lost.
pub fn ceilings(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Ceilings, GpuError> {
    warm_up(device, queue, WARM_UP_TIME)?;
    Ok(Ceilings { copy: copy(device, queue)?, multiply_add: multiply_add(device, queue)? })
}

/// Keeps a GPU busy for so long: one that has idled runs at a fraction of its clock, and gets up to it in
/// some tenths of a second (an H100 took 0.99 ms for a network that it runs in 0.23 ms when it is awake).
///
/// # Errors
/// If the device has no room for two megabytes, or is lost.
pub fn warm_up(device: &wgpu::Device, queue: &wgpu::Queue, time: Duration) -> Result<(), GpuError> {
    if device.adapter_info().device_type == wgpu::DeviceType::Cpu {
        return Ok(());
    }
    let work = multiply_adds(device, TURNS)?;
    let began = Instant::now();
    while began.elapsed() < time {
        super::time(device, queue, "wake", 0, WARM_UP_RUNS, |encoder| work.dispatch(encoder, WORKGROUPS))?;
    }
    Ok(())
}

fn copy(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<f64, GpuError> {
    let limits = device.limits();
    let bytes = COPIED.min(limits.max_storage_buffer_binding_size).min(limits.max_buffer_size) as usize;
    let source = storage(device, "ceilings.source", &vec![1.0f32; bytes / size_of::<f32>()])?;
    let made = empty::<f32>(device, "ceilings.made", bytes / size_of::<f32>())?;
    let pass = Pass::of(device, Shader::at("ceilings/copy"), &[])?;
    let pass = pass.bind(device, &[source.as_entire_binding(), made.as_entire_binding()])?;
    let timing = time(device, queue, "copy", 2, RUNS, |encoder| pass.dispatch(encoder, [1 << 14, 1, 1]))?;
    Ok(2.0 * bytes as f64 / (timing.milliseconds * 1e-3))
}

fn multiply_add(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<f64, GpuError> {
    let mut turns = TURNS;
    loop {
        let work = multiply_adds(device, turns)?;
        let timing = time(device, queue, "fma", 2, RUNS, |encoder| work.dispatch(encoder, WORKGROUPS))?;
        if timing.milliseconds >= LEAST || turns >= MOST_TURNS {
            let operations = 2.0 * INVOCATIONS as f64 * f64::from(turns) * SUMS as f64;
            return Ok(operations / (timing.milliseconds * 1e-3));
        }
        turns *= 2;
    }
}

/// A pass that does nothing but multiply and add, in so many turns, with [`WORKGROUPS`].
fn multiply_adds(device: &wgpu::Device, turns: u32) -> Result<BoundPass, GpuError> {
    let made = empty::<[f32; 4]>(device, "ceilings.sums", INVOCATIONS)?;
    let pass = Pass::of(device, Shader::at("ceilings/fma"), &[("TURNS", turns)])?;
    pass.bind(device, &[made.as_entire_binding()])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::Gpu;

    #[test]
    fn registers_are_faster_than_memory() {
        let gpu = Gpu::new().expect("an adapter; lavapipe will do");
        let Ceilings { copy, multiply_add } = ceilings(&gpu.device, &gpu.queue).expect("runs");
        // Each multiplication with addition, two operations, reads three numbers of four bytes.
        let registers = 6.0 * multiply_add;
        assert!(copy > 0.0 && copy < registers, "{copy} bytes a second, registers {registers}");
    }
}
