//! `deepshade-studies store`: megabytes and requests a second that an object store, or a folder that machines
//! share, takes from this machine, for `deepshade farm cost`.
//!
//! One machine is no farm: what a store takes of many is at least that, and a store on this machine shares
//! its cores.

use anyhow::{Context, Result, ensure};
use deepshade::shared::figures::Figures;
use deepshade::shared::place::{Objects, Place, TRANSFERS};
use rayon::{ThreadPool, ThreadPoolBuilder, prelude::*};
use std::path::PathBuf;
use std::time::Instant;

/// Megabytes and requests a second that an object store or a folder takes from this machine.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade-studies store s3://bucket/probe --json store.json\n\n\
    Objects of noise are written there, read and deleted. What `deepshade farm cost` is then told by \
    --store-megabytes and --store-requests is what one machine can ask for; a store of a cloud takes more of \
    many.")]
pub struct Args {
    /// An address, or a folder.
    place: Place,
    /// How many objects.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(8..=1_000_000))]
    objects: u32,
    /// Size of each, kilobytes.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    kilobytes: u32,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = deepshade::shared::arguments::written_file)]
    json: Option<PathBuf>,
}

/// What was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rates {
    /// Bytes a second, written.
    written: f64,
    /// Bytes a second, read.
    read: f64,
    /// Requests a second that write next to nothing.
    requests: f64,
}

/// Measures and prints.
///
/// # Errors
/// If the place cannot be reached or refuses something, or gives back other bytes.
pub fn run(args: &Args) -> Result<()> {
    let rates = measured(&*args.place.objects()?, args.objects, 1000 * args.kilobytes as usize)?;
    let [written, read] = [rates.written, rates.read].map(|bytes| 1e-6 * bytes);
    let mut figures = Figures::new("store");
    figures.set("megabytes_per_second_written", written);
    figures.set("megabytes_per_second_read", read);
    figures.set("requests_per_second", rates.requests);
    figures.set("objects", args.objects.into());
    figures.set("kilobytes", args.kilobytes.into());
    figures.write(args.json.as_deref())?;
    say!("{written:.1} MB/s written, {read:.1} MB/s read, {:.0} requests/s", rates.requests)
}

/// Writes, reads and deletes so many objects of so many bytes.
fn measured(place: &dyn Objects, count: u32, bytes: usize) -> Result<Rates> {
    let pool = ThreadPoolBuilder::new().num_threads(TRANSFERS).build().context("threads for transfers")?;
    let name = |number: u32| format!("deepshade-probe-{number}");
    // Nothing that could be made smaller on the way.
    let noise = |number: u32| -> Vec<u8> {
        let mut noise = vec![0; bytes];
        blake3::Hasher::new().update(&number.to_le_bytes()).finalize_xof().fill(&mut noise);
        noise
    };
    let contents: Vec<Vec<u8>> = (0..TRANSFERS as u32).map(noise).collect();
    let content = |number: u32| &contents[number as usize % TRANSFERS];
    let written = timed(&pool, count, |number| place.put(&name(number), content(number).clone()))?;
    let read = timed(&pool, count, |number| {
        let found = place.get(&name(number), bytes as u64)?;
        ensure!(found.as_ref() == Some(content(number)), "{}: other bytes", name(number));
        Ok(())
    })?;
    let small = timed(&pool, count, |number| place.put(&name(number), vec![number as u8]))?;
    timed(&pool, count, |number| place.delete(&name(number)))?;
    let all = f64::from(count) * bytes as f64;
    Ok(Rates { written: all / written, read: all / read, requests: f64::from(count) / small })
}

/// Seconds that so many requests take.
fn timed(pool: &ThreadPool, count: u32, request: impl Fn(u32) -> Result<()> + Sync) -> Result<f64> {
    let start = Instant::now();
    pool.install(|| (0..count).into_par_iter().try_for_each(&request))?;
    Ok(start.elapsed().as_secs_f64().max(1e-6))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_measured_and_nothing_is_left_in_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = Place::Folder(folder.path().join("new"));
        let rates = measured(&*place.objects().expect("made"), 20, 1000).expect("measured");
        for rate in [rates.written, rates.read, rates.requests] {
            assert!(rate.is_finite() && rate > 0.0, "{rates:?}");
        }
        assert_eq!(std::fs::read_dir(folder.path().join("new")).expect("listed").count(), 0);
    }

    /// A place that loses every byte.
    struct Forgetful;

    impl Objects for Forgetful {
        fn put(&self, _: &str, _: Vec<u8>) -> Result<()> {
            Ok(())
        }

        fn get(&self, _: &str, _: u64) -> Result<Option<Vec<u8>>> {
            Ok(Some(Vec::new()))
        }

        fn delete(&self, _: &str) -> Result<()> {
            Ok(())
        }
    }

    #[test]
    fn other_bytes_are_noticed() {
        let error = measured(&Forgetful, 8, 10).expect_err("other bytes").to_string();
        assert!(error.contains("other bytes"), "{error}");
    }
}
