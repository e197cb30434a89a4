//! How long recorded work takes on the GPU.

use super::{GpuError, idle, read_async, submit, wait};
use crate::lists;
use std::time::Duration;
use web_time::Instant;
use wgpu::{BufferUsages, Features};

/// Most runs that a query set has room for, at two timestamps a run.
const MOST_RUNS: usize = wgpu::QUERY_SET_MAX_QUERIES as usize / 2;

/// How long a run takes.
#[derive(Clone, Copy, Debug)]
pub struct Timing {
    /// Median of the timed runs.
    pub milliseconds: f64,
    /// 95th percentile of the timed runs, milliseconds.
    pub p95: f64,
    /// Whether timestamps of the GPU measured it. Where the device has none it is the wall clock, from
    /// submission until the device is idle; on the CPU too, because lavapipe takes timestamps when it pleases
    /// (seen: 0.05 ms for 130 ms of work, after a pass that had read a texture).
    pub by_gpu: bool,
}

impl Timing {
    /// From the milliseconds of every run.
    ///
    /// # Panics
    /// If there is no run.
    pub fn new(runs: Vec<f64>, by_gpu: bool) -> Self {
        Self { milliseconds: lists::median(runs.clone()), p95: lists::quantile(runs, 0.95), by_gpu }
    }
}

/// How long a software adapter, on which a run may take minutes, is measured.
pub const PATIENCE: Duration = Duration::from_secs(10);

/// Runs recorded work `warm_up` times unmeasured and then `timed` times (at least 1, at most 2048), each run
/// a submission of its own, and takes the median. Software adapters begin no further run, of either kind,
/// once [`PATIENCE`] is over.
///
/// Timestamps need the features `TIMESTAMP_QUERY` and `TIMESTAMP_QUERY_INSIDE_ENCODERS`.
///
/// # Errors
/// If what was recorded is not valid, or the timestamps cannot be read; `label` names it.
pub fn time(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    warm_up: usize,
    timed: usize,
    record: impl FnMut(&mut wgpu::CommandEncoder),
) -> Result<Timing, GpuError> {
    wait(time_async(device, queue, label, warm_up, timed, record))?
}

/// As [`time`], awaited. In a browser the clock is on the wall.
///
/// # Errors
/// If what was recorded is not valid, or the timestamps cannot be read; `label` names it.
pub async fn time_async(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    warm_up: usize,
    timed: usize,
    mut record: impl FnMut(&mut wgpu::CommandEncoder),
) -> Result<Timing, GpuError> {
    let timed = timed.clamp(1, MOST_RUNS);
    let by_gpu = device.adapter_info().device_type != wgpu::DeviceType::Cpu
        && device.features().contains(Features::TIMESTAMP_QUERY | Features::TIMESTAMP_QUERY_INSIDE_ENCODERS);
    let start = Instant::now();
    for _ in 0..warm_up {
        submit(device, queue, label, &mut record)?;
        if !by_gpu {
            idle(device, queue, label).await?;
            if start.elapsed() > PATIENCE {
                break;
            }
        }
    }
    idle(device, queue, label).await?;
    let runs = if by_gpu {
        by_timestamps(device, queue, label, timed, record).await?
    } else {
        by_wall_clock(device, queue, label, timed, record).await?
    };
    Ok(Timing::new(runs, by_gpu))
}

async fn by_timestamps(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    timed: usize,
    mut record: impl FnMut(&mut wgpu::CommandEncoder),
) -> Result<Vec<f64>, GpuError> {
    let count = 2 * timed as u32;
    let queries = device.create_query_set(&wgpu::QuerySetDescriptor {
        label: Some("deepshade.timestamps"),
        ty: wgpu::QueryType::Timestamp,
        count,
    });
    for run in (0..count).step_by(2) {
        submit(device, queue, label, |encoder| {
            encoder.write_timestamp(&queries, run);
            record(encoder);
            encoder.write_timestamp(&queries, run + 1);
        })?;
    }
    let resolved = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("deepshade.resolved_timestamps"),
        size: u64::from(count) * u64::from(wgpu::QUERY_SIZE),
        usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    // In a submission of its own: wgpu may resolve queries of the same submission before they are written
    // (wgpu issue 6406).
    submit(device, queue, label, |encoder| encoder.resolve_query_set(&queries, 0..count, &resolved, 0))?;
    let ticks: Vec<u64> = read_async(device, queue, &resolved).await?;
    let period = f64::from(queue.get_timestamp_period());
    Ok(ticks.chunks_exact(2).map(|run| run[1].saturating_sub(run[0]) as f64 * period * 1e-6).collect())
}

async fn by_wall_clock(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    timed: usize,
    mut record: impl FnMut(&mut wgpu::CommandEncoder),
) -> Result<Vec<f64>, GpuError> {
    let (first, mut runs) = (Instant::now(), Vec::with_capacity(timed));
    while runs.len() < timed && (runs.is_empty() || first.elapsed() < PATIENCE) {
        let start = Instant::now();
        submit(device, queue, label, &mut record)?;
        idle(device, queue, label).await?;
        runs.push(start.elapsed().as_secs_f64() * 1e3);
    }
    Ok(runs)
}
