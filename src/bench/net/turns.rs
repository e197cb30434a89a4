//! Engines of one processor by turns, so that what disturbs the machine disturbs all of them.

use anyhow::Result;
use deepshade_shaders::gpu::Timing;
use std::time::{Duration, Instant};

/// How long and how often an engine is measured.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Time for each engine's runs, after one that does not count.
    pub time: Duration,
    /// Most runs that count.
    pub most: usize,
}

/// Fewest runs that count.
pub const FEWEST: usize = 3;
/// Turns that engines take, and the pause before each.
const TURNS: usize = 3;
const PAUSE: Duration = Duration::from_millis(100);

/// A run of an engine.
pub type EngineRun<'a> = Box<dyn FnMut() -> Result<()> + 'a>;

/// Runs the engines in turns. One that fails has no further ones, which is no other's fault.
pub fn in_turns<'a>(
    engines: Vec<(&'a str, Result<EngineRun<'_>>)>,
    effort: Effort,
) -> Vec<(&'a str, Result<Timing>)> {
    let ready = |(name, work): (&'a str, Result<_>)| (name, work.map(|work| (work, Vec::new())));
    let mut engines: Vec<_> = engines.into_iter().map(ready).collect();
    for _ in 0..TURNS {
        for (_, engine) in &mut engines {
            let Ok((work, times)) = engine else { continue };
            if let Err(error) = turn(work, effort, times) {
                *engine = Err(error);
            }
        }
    }
    let timing = |(_, times)| Timing::new(times, false);
    engines.into_iter().map(|(name, engine)| (name, engine.map(timing))).collect()
}

/// A turn of an engine. It begins with a pause, since onnxruntime's threads wait for more work by spinning,
/// and with a run that does not count.
fn turn(work: &mut EngineRun<'_>, effort: Effort, times: &mut Vec<f64>) -> Result<()> {
    std::thread::sleep(PAUSE);
    work()?;
    let turn = Instant::now();
    let (fewest, most) = (FEWEST.div_ceil(TURNS), effort.most.div_ceil(TURNS));
    for run in 0..most {
        if run >= fewest && turn.elapsed() > effort.time / TURNS as u32 {
            break;
        }
        let start = Instant::now();
        work()?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::bail;

    #[test]
    fn an_engine_that_fails_costs_no_other_its_figures() {
        let effort = Effort { time: Duration::from_millis(1), most: 6 };
        let mut left = 2;
        let failing = move || {
            left -= 1;
            if left == 0 { bail!("no memory") } else { Ok(()) }
        };
        let engines: Vec<(&str, Result<EngineRun<'_>>)> = vec![
            ("missing", Err(anyhow::anyhow!("no library"))),
            ("sound", Ok(Box::new(|| Ok(())))),
            ("failing", Ok(Box::new(failing))),
        ];
        let made = in_turns(engines, effort);
        let names: Vec<&str> = made.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["missing", "sound", "failing"]);
        assert!(made[1].1.is_ok());
        let error = |index: usize| made[index].1.as_ref().expect_err("it failed").to_string();
        assert_eq!([error(0), error(2)], ["no library", "no memory"]);
    }
}
