//! What an engine took for a network, and the line of the table that says so.

use serde::Serialize;

/// A device whose peak is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Device {
    /// That of WGSL.
    Adapter,
    /// The processor.
    Processor,
}

/// What an engine took for a network.
#[derive(Clone, Debug, Serialize)]
pub struct Measurement {
    /// The network.
    pub network: String,
    /// Whether its weights are trained; else they are random.
    pub trained: bool,
    /// Columns and rows of the image.
    pub size: [usize; 2],
    /// The engine.
    pub engine: String,
    /// Median, milliseconds.
    pub milliseconds: f64,
    /// 95th percentile, milliseconds.
    pub p95: f64,
    /// Which clock: `timestamps` or `wall clock`.
    pub clock: &'static str,
    /// What it ran on, where that has a peak here.
    #[serde(skip)]
    pub device: Option<Device>,
    /// Billions of floating-point operations a second.
    pub gflops: f64,
    /// Billions of bytes a second, of those that must move at least.
    pub gigabytes: f64,
    /// The first rate as a share of what the device can do at best, once that is known
    /// ([`Peaks::set_shares`](super::peaks::Peaks::set_shares)).
    pub share_flops: Option<f64>,
    /// The second rate as such a share; above 1 where what moves stays in caches.
    pub share_bytes: Option<f64>,
}

impl Measurement {
    /// Where the weights are from, in a word.
    pub const fn weights(&self) -> &'static str {
        if self.trained { "trained" } else { "random" }
    }

    /// The share of the peak of operations, in words.
    pub fn of_peak_flops(&self) -> String {
        per_cent(self.share_flops)
    }

    /// The share of the peak of bytes, in words.
    pub fn of_peak_bytes(&self) -> String {
        per_cent(self.share_bytes)
    }
}

fn per_cent(share: Option<f64>) -> String {
    share.map_or_else(|| "-".to_owned(), |share| format!("{:.1} %", 100.0 * share))
}

impl std::fmt::Display for Measurement {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { network, size: [width, height], engine, milliseconds, p95, gflops, gigabytes, .. } = self;
        let (flops, bytes) = (self.of_peak_flops(), self.of_peak_bytes());
        let (weights, size) = (self.weights(), format!("{width}x{height}"));
        write!(
            f,
            "{network:<12} {weights:<7} {size:<10} {engine:<18} {milliseconds:>8.2} {p95:>8.2} {gflops:>8.1} {flops:>8} {gigabytes:>7.1} {bytes:>8}"
        )
    }
}
