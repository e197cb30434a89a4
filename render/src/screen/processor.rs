//! Methods on the processor, where they have a version in vector instructions.

use super::{PlainInputs, Technique, View, Written};
use crate::method::{Clock, Repeats, Shaded};
use crate::processor::processor_name;
use deepshade_shaders::{MissingAttribute, Planes, lists};
use web_time::Instant;

/// A method's image of what it reads, timed; `None` if it has no such version.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn shade(
    technique: &dyn Technique,
    inputs: &PlainInputs<'_>,
    view: &View,
    repeats: Repeats,
) -> Option<Result<Shaded, MissingAttribute>> {
    let mut times = Vec::new();
    let mut image = Vec::new();
    for run in 0..repeats.warm_up + repeats.timed.max(1) {
        let start = Instant::now();
        let written: Written = match technique.on_processor(inputs, view)? {
            Ok(written) => written,
            Err(missing) => return Some(Err(missing)),
        };
        if run >= repeats.warm_up {
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        image = written.into_iter().next_back().unwrap_or_default();
    }
    Some(Ok(Shaded {
        image: Planes::from_data(technique.about().effect.channels(), view.height, view.width, image),
        milliseconds: lists::median(times),
        clock: Clock::Cpu,
        device: processor_name().unwrap_or_else(|| "unknown processor".to_owned()),
    }))
}
