//! `deepshade bench store`: megabytes and requests a second that an object store takes from this machine, for `deepshade farm cost`.
//!
//! One machine is no farm: what a store takes of many is at least that, and a store on this machine shares its cores.

use crate::figures::Figures;
use crate::place::{Load, Place};
use anyhow::Result;
use std::path::PathBuf;

/// Megabytes and requests a second that an object store takes from this machine.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade bench store s3://bucket/probe --json store.json\n\n\
    Objects of noise are written below the address, read and deleted. What `deepshade farm cost` is then told by \
    --store-megabytes and --store-requests is what one machine can ask for; a store of a cloud takes more of many.")]
pub struct Args {
    /// An address where nothing is.
    address: Place,
    /// How many objects.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(8..=1_000_000))]
    objects: u32,
    /// Size of each, kilobytes.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    kilobytes: u32,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Measures and prints.
///
/// # Errors
/// If the place is a folder, or the store cannot be reached or refuses something.
pub fn run(args: &Args) -> Result<()> {
    let load = Load { objects: args.objects, bytes: 1000 * args.kilobytes as usize };
    let rates = args.address.measure(load)?;
    let mut figures = Figures::new("bench store");
    figures.set("megabytes_per_second_written", 1e-6 * rates.written);
    figures.set("megabytes_per_second_read", 1e-6 * rates.read);
    figures.set("requests_per_second", rates.requests);
    figures.set("objects", args.objects.into());
    figures.set("kilobytes", args.kilobytes.into());
    figures.write(args.json.as_deref())?;
    say!(
        "{:.1} MB/s written, {:.1} MB/s read, {:.0} requests/s",
        1e-6 * rates.written,
        1e-6 * rates.read,
        rates.requests
    )
}
