//! Timestamps of the passes of a frame, read back some frames later without waiting.

use super::{GpuError, allocate};
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};
use wgpu::BufferUsages;

/// Frames whose timestamps may be on their way.
const IN_FLIGHT: usize = 4;

/// Where the begin and the end of a pass are written.
#[derive(Clone, Copy, Debug)]
pub struct Stamps<'a> {
    queries: &'a wgpu::QuerySet,
    first: u32,
}

impl<'a> Stamps<'a> {
    /// For a compute pass.
    pub fn of_compute(&self) -> wgpu::ComputePassTimestampWrites<'a> {
        wgpu::ComputePassTimestampWrites {
            query_set: self.queries,
            beginning_of_pass_write_index: Some(self.first),
            end_of_pass_write_index: Some(self.first + 1),
        }
    }

    /// For the first or last of several compute passes that are timed together.
    pub fn of_one_compute(
        &self,
        is_first: bool,
        is_last: bool,
    ) -> Option<wgpu::ComputePassTimestampWrites<'a>> {
        (is_first || is_last).then(|| wgpu::ComputePassTimestampWrites {
            query_set: self.queries,
            beginning_of_pass_write_index: is_first.then_some(self.first),
            end_of_pass_write_index: is_last.then_some(self.first + 1),
        })
    }

    /// For a raster pass.
    pub fn of_raster(&self) -> wgpu::RenderPassTimestampWrites<'a> {
        wgpu::RenderPassTimestampWrites {
            query_set: self.queries,
            beginning_of_pass_write_index: Some(self.first),
            end_of_pass_write_index: Some(self.first + 1),
        }
    }

    /// For the first or last of several raster passes that are timed together.
    pub fn of_one_raster(
        &self,
        is_first: bool,
        is_last: bool,
    ) -> Option<wgpu::RenderPassTimestampWrites<'a>> {
        (is_first || is_last).then(|| wgpu::RenderPassTimestampWrites {
            query_set: self.queries,
            beginning_of_pass_write_index: is_first.then_some(self.first),
            end_of_pass_write_index: is_last.then_some(self.first + 1),
        })
    }
}

/// Timestamps around a fixed number of passes a frame. Everything is allocated once.
#[derive(Debug)]
pub struct PassClock {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: Vec<(wgpu::Buffer, Arc<AtomicBool>, bool)>,
    passes: u32,
    period: f64,
}

impl PassClock {
    /// A clock for so many passes; `None` where the device has no timestamps, or is software, whose
    /// timestamps mean nothing ([`super::Timing::by_gpu`]).
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, passes: usize) -> Result<Option<Self>, GpuError> {
        let software = device.adapter_info().device_type == wgpu::DeviceType::Cpu;
        if software || !device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return Ok(None);
        }
        let count = 2 * passes as u32;
        let bytes = u64::from(count) * u64::from(wgpu::QUERY_SIZE);
        let buffer = |label: &str, usage| {
            let descriptor =
                wgpu::BufferDescriptor { label: Some(label), size: bytes, usage, mapped_at_creation: false };
            allocate(device, label, bytes, || device.create_buffer(&descriptor))
        };
        let staging = (0..IN_FLIGHT).map(|_| {
            let buffer = buffer("deepshade.clock.staging", BufferUsages::MAP_READ | BufferUsages::COPY_DST)?;
            Ok((buffer, Arc::new(AtomicBool::new(false)), false))
        });
        Ok(Some(Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("deepshade.clock"),
                ty: wgpu::QueryType::Timestamp,
                count,
            }),
            resolved: buffer(
                "deepshade.clock.resolved",
                BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
            )?,
            staging: staging.collect::<Result<_, GpuError>>()?,
            passes: passes as u32,
            period: f64::from(queue.get_timestamp_period()),
        }))
    }

    /// Where a pass writes its timestamps.
    pub fn stamps(&self, pass: usize) -> Stamps<'_> {
        Stamps { queries: &self.queries, first: 2 * pass as u32 }
    }

    /// Once a frame's passes are submitted: sends their timestamps on their way, and gives the milliseconds
    /// of each pass of a frame before, where they have arrived.
    pub fn collect(&mut self, device: &wgpu::Device, queue: &wgpu::Queue) -> Option<Vec<f64>> {
        let arrived = self.arrived();
        if let Some((buffer, done, busy)) = self.staging.iter_mut().find(|(_, _, busy)| !*busy) {
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.resolve_query_set(&self.queries, 0..2 * self.passes, &self.resolved, 0);
            encoder.copy_buffer_to_buffer(&self.resolved, 0, buffer, 0, self.resolved.size());
            queue.submit([encoder.finish()]);
            *busy = true;
            let done = Arc::clone(done);
            buffer.map_async(wgpu::MapMode::Read, .., move |result| {
                done.store(result.is_ok(), Ordering::Release)
            });
        }
        arrived
    }

    /// The milliseconds of all frames that have arrived and were not given yet.
    pub fn arrived_all(&mut self) -> Vec<Vec<f64>> {
        std::iter::from_fn(|| self.arrived()).collect()
    }

    fn arrived(&mut self) -> Option<Vec<f64>> {
        let (buffer, done, busy) =
            self.staging.iter_mut().find(|(_, done, busy)| *busy && done.load(Ordering::Acquire))?;
        let milliseconds = buffer.get_mapped_range(..).ok().map(|mapped| {
            let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(&mapped);
            ticks
                .chunks_exact(2)
                .map(|pass| pass[1].saturating_sub(pass[0]) as f64 * self.period * 1e-6)
                .collect()
        });
        buffer.unmap();
        done.store(false, Ordering::Release);
        *busy = false;
        milliseconds
    }
}
