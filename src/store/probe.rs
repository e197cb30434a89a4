//! What a store takes from one machine: objects of noise, written, read and deleted, several at a time.

use super::remote::Remote;
use crate::place::{Address, Load, Rates, TRANSFERS};
use anyhow::{Context, Result, ensure};
use rayon::{ThreadPool, ThreadPoolBuilder, prelude::*};
use std::time::Instant;

/// Measures a store below an address, where nothing else may be; what was written there is deleted.
///
/// # Errors
/// If the store cannot be reached or refuses something, or gives back other bytes.
pub fn measure(address: &Address, load: Load) -> Result<Rates> {
    on(&Remote::open(address)?, load)
}

fn on(remote: &Remote, Load { objects, bytes }: Load) -> Result<Rates> {
    let pool = ThreadPoolBuilder::new().num_threads(TRANSFERS).build().context("threads for transfers")?;
    let name = |number: u32| format!("probe/{number}");
    // Nothing that a store on the way could make smaller, and no two alike.
    let noise = |number: u32| -> Vec<u8> {
        let mut noise = vec![0; bytes];
        blake3::Hasher::new().update(&number.to_le_bytes()).finalize_xof().fill(&mut noise);
        noise
    };
    let contents: Vec<Vec<u8>> = (0..TRANSFERS as u32).map(noise).collect();
    let content = |number: u32| &contents[number as usize % TRANSFERS];
    let written = timed(&pool, objects, |number| remote.put(&name(number), content(number).clone()))?;
    let read = timed(&pool, objects, |number| {
        let found = remote.get(&name(number), bytes as u64)?;
        ensure!(found.as_ref() == Some(content(number)), "{}: other bytes", remote.name(&name(number)));
        Ok(())
    })?;
    let small = timed(&pool, objects, |number| remote.put(&name(number), vec![number as u8]))?;
    timed(&pool, objects, |number| remote.delete(&name(number)))?;
    let all = f64::from(objects) * bytes as f64;
    Ok(Rates { written: all / written, read: all / read, requests: f64::from(objects) / small })
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
    use crate::place::Place;
    use object_store::memory::InMemory;
    use std::sync::Arc;

    #[test]
    fn nothing_is_left_behind() {
        let Ok(Place::Store(address)) = "s3://bucket/probe".parse() else { unreachable!("an address") };
        let remote = Remote::on(Arc::new(InMemory::new()), &address).expect("a remote");
        let rates = on(&remote, Load { objects: 20, bytes: 1000 }).expect("measured");
        for rate in [rates.written, rates.read, rates.requests] {
            assert!(rate.is_finite() && rate > 0.0, "{rates:?}");
        }
        for number in 0..20 {
            assert_eq!(remote.size(&format!("probe/{number}")).expect("asked"), None);
        }
    }
}
