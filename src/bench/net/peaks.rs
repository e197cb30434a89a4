//! What the devices can do at best, and which share of that an engine reached.

use super::measurement::{Device, Measurement};
use anyhow::Result;
use deepshade_infer::cpu;
use deepshade_shaders::gpu::{self, Ceilings, Gpu};

/// What each device can do at best.
#[derive(Clone, Copy, Debug)]
pub struct Peaks {
    /// The device of WGSL.
    pub adapter: Ceilings,
    /// The processor, with all threads of the run.
    pub processor: Ceilings,
}

impl Peaks {
    /// Measures both.
    ///
    /// # Errors
    /// If the adapter fails.
    pub fn measured(gpu: &Gpu) -> Result<Self> {
        Ok(Self { adapter: gpu::ceilings(&gpu.device, &gpu.queue)?, processor: of_processor() })
    }

    /// Says of every measurement which share of its device's peak it reached. A peak that was exceeded was
    /// taken in a bad moment, and is measured once more; what is above it still kept its numbers in caches.
    pub fn set_shares(&mut self, gpu: &Gpu, made: &mut [Measurement]) {
        let again = || gpu::ceilings(&gpu.device, &gpu.queue).ok();
        set_shares(Device::Adapter, &mut self.adapter, made, again);
        set_shares(Device::Processor, &mut self.processor, made, || Some(of_processor()));
    }
}

fn of_processor() -> Ceilings {
    Ceilings { multiply_add: cpu::ceilings::multiply_add(), copy: cpu::ceilings::copy() }
}

fn set_shares(
    device: Device,
    peak: &mut Ceilings,
    made: &mut [Measurement],
    again: impl FnOnce() -> Option<Ceilings>,
) {
    let shares = |row: &Measurement, peak: &Ceilings| {
        [row.gflops * 1e9 / peak.multiply_add, row.gigabytes * 1e9 / peak.copy]
    };
    let exceeds = |row: &Measurement| shares(row, peak).into_iter().any(|share| share > 1.0);
    let is_exceeded = made.iter().any(|row| row.device == Some(device) && exceeds(row));
    if let Some(anew) = is_exceeded.then(again).flatten() {
        peak.multiply_add = peak.multiply_add.max(anew.multiply_add);
        peak.copy = peak.copy.max(anew.copy);
    }
    for row in made.iter_mut().filter(|row| row.device == Some(device)) {
        let [flops, bytes] = shares(row, peak);
        (row.share_flops, row.share_bytes) = (Some(flops), Some(bytes));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(device: Option<Device>, gflops: f64, gigabytes: f64) -> Measurement {
        Measurement {
            network: "ao".to_owned(),
            trained: true,
            size: [256, 256],
            engine: "cpu".to_owned(),
            milliseconds: 1.0,
            p95: 1.0,
            clock: "wall clock",
            device,
            gflops,
            gigabytes,
            share_flops: None,
            share_bytes: None,
        }
    }

    #[test]
    fn shares_are_of_the_devices_own_peak() {
        let mut peak = Ceilings { multiply_add: 100e9, copy: 10e9 };
        let mut made =
            [Some(Device::Processor), Some(Device::Adapter), None].map(|device| row(device, 50.0, 8.0));
        // No peak is exceeded, and none is measured again.
        let again = || Some(Ceilings { multiply_add: 1e15, copy: 1e15 });
        set_shares(Device::Processor, &mut peak, &mut made, again);
        assert_eq!([made[0].share_flops, made[0].share_bytes], [Some(0.5), Some(0.8)]);
        assert!(made[1..].iter().all(|row| row.share_flops.is_none() && row.share_bytes.is_none()));
    }

    #[test]
    fn a_peak_that_is_exceeded_is_measured_again_and_never_falls() {
        let mut peak = Ceilings { multiply_add: 100e9, copy: 10e9 };
        let mut made = [row(Some(Device::Processor), 50.0, 12.0)];
        let again = || Some(Ceilings { multiply_add: 90e9, copy: 16e9 });
        set_shares(Device::Processor, &mut peak, &mut made, again);
        assert_eq!([peak.multiply_add, peak.copy], [100e9, 16e9]);
        assert_eq!([made[0].share_flops, made[0].share_bytes], [Some(0.5), Some(0.75)]);
    }
}
