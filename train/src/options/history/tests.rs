//! Networks with a memory, on films whose truth stays as it is while what they read is noisy.

use super::*;
use deepshade_infer::{ChannelOrder, Reach, parity};
use std::path::PathBuf;

const EDGE: usize = 16;
const FRAMES: usize = 3;

/// Frames that move by a pixel to the right, of a truth that moves along.
struct Noisy;

fn still(film: usize, frame: usize) -> Still {
    let truth = |y: usize, x: usize| 0.5 + 0.4 * ((y + x + EDGE - frame) as f32 * 0.7 + film as f32).sin();
    let seed = (FRAMES * film + frame) as u32;
    let taps = (0..EDGE * EDGE).map(|at| {
        let seen = frame > 0 && at % EDGE > 0;
        let mut taps = [(0, 0.0); 4];
        taps[1] = (at.saturating_sub(1), f32::from(u8::from(seen)));
        taps
    });
    Still {
        input: parity::noise(6, EDGE, EDGE, seed),
        target: Planes::from_fn(1, EDGE, EDGE, |_, y, x| truth(y, x)),
        variance: Planes::filled(1, EDGE, EDGE, 0.0),
        valid: Planes::filled(1, EDGE, EDGE, 1.0),
        carry: Carry(taps.collect()),
    }
}

impl Films for Noisy {
    fn count(&self) -> usize {
        2
    }

    fn frames(&self, film: usize) -> Result<Vec<Still>, String> {
        Ok((0..FRAMES).map(|frame| still(film, frame)).collect())
    }
}

fn config(steps: usize) -> TrainConfig {
    let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
    let spec = NetSpec { levels: 2, ..NetSpec::ao(ChannelOrder::Interleaved, reach) };
    TrainConfig { batch: 2, crop: EDGE, steps, ..TrainConfig::new(spec, PathBuf::new()) }
}

#[test]
fn what_is_carried_is_what_was_there_and_says_where_it_was_seen() {
    let [first, second] = [0, 1].map(|frame| still(0, frame));
    let carried = second.carry.carried(&first.target);
    for (y, x) in (0..EDGE).flat_map(|y| (1..EDGE).map(move |x| (y, x))) {
        assert!((carried.at(0, y, x) - second.target.at(0, y, x)).abs() < 1e-5, "{y}, {x}");
        assert_eq!(carried.at(1, y, x), 1.0);
    }
    assert_eq!((carried.at(0, 3, 0), carried.at(1, 3, 0)), (0.0, 0.0), "came into the image");
    let nothing = Carry::nothing(EDGE * EDGE).carried(&first.target);
    assert_eq!(nothing, Planes::filled(2, EDGE, EDGE, 0.0));
}

#[test]
fn only_a_network_with_a_memory_heeds_it() {
    let [dark, bright] = [0.0, 1.0].map(|value| Planes::filled(1, EDGE, EDGE, value));
    for memory in [Memory::None, Memory::Image, Memory::Kept] {
        let network = Recurrent::train(memory, &config(2), &Noisy).expect("trains");
        let image = |before: &Planes| network.image(&still(0, 1), Some(before));
        assert_eq!(image(&dark) == image(&bright), memory == Memory::None, "{memory:?}");
    }
}

#[test]
fn what_changes_and_truth_does_not_is_a_loss() {
    let device = crate::device();
    let frames = Noisy.frames(0).expect("frames");
    let before = [Some([frames[0].target.clone(), frames[0].target.clone()])];
    let loss = |image: &Planes| -> f32 {
        let target = to_tensor(&[&frames[1].target], &device);
        change(to_tensor(&[image], &device), target, &[&frames[1]], &before, &device).into_scalar()
    };
    assert!(loss(&frames[1].target) < 1e-6);
    let brighter = Planes::from_fn(1, EDGE, EDGE, |_, y, x| frames[1].target.at(0, y, x) + 0.1);
    // Of 16 columns one is new.
    assert!((loss(&brighter) - 0.1 * 15.0 / 16.0).abs() < 1e-5, "{}", loss(&brighter));
}
