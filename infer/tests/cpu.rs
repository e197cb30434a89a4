//! The CPU's forward pass equals the reference, layer by layer and element by element, on random asymmetric weights.

use deepshade_infer::parity::{first_difference, noise, rms};
use deepshade_infer::{ChannelOrder, NetSpec, Reach, Weights, cpu, reference};
use deepshade_shaders::Effect;

const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
const ORDERS: [ChannelOrder; 2] = [ChannelOrder::Contiguous, ChannelOrder::Interleaved];

fn assert_agrees(spec: &NetSpec, sizes: &[(usize, usize)]) {
    let weights = Weights::random(spec, 11);
    let network = cpu::Network::new(spec, &weights);
    for (height, width) in sizes {
        let input = noise(spec.input_channels(), *height, *width, 7);
        let expected = reference::layers(spec, &weights, &input);
        let mut plan = network.plan(*height, *width);
        let image = plan.run(&network, &input);
        let made = plan.layers(&network);
        let what = format!("{spec:?} at {height}x{width}");
        assert_eq!(first_difference(&expected, &made), None, "{what}");
        let last = &expected[expected.len() - 1].planes;
        assert_eq!(image, made[made.len() - 1].planes);
        let proves = last.pixels() < 100 || (0.3..3.0).contains(&rms(last));
        assert!(proves, "{what}: an image of rms {} proves little", rms(last));
    }
}

#[test]
fn every_published_network_at_whole_and_odd_sizes() {
    for effect in Effect::ALL {
        for order in ORDERS {
            if let Some(spec) = NetSpec::published(effect, order, REACH) {
                assert_agrees(&spec, &[(32, 64), (37, 83)]);
            }
        }
    }
}

#[test]
fn every_number_of_vectors_and_rows() {
    let spec = NetSpec { levels: 2, ..NetSpec::ao(ChannelOrder::Interleaved, REACH) };
    let widths: Vec<(usize, usize)> = (1..70).map(|width| (1 + width % 7, width)).collect();
    assert_agrees(&spec, &widths);
    assert_agrees(&spec, &[(71, 5), (130, 3)]);
}

#[test]
fn numbers_of_channels_that_fill_no_block() {
    let ao = NetSpec::ao(ChannelOrder::Interleaved, REACH);
    for (u0, levels) in [(1, 1), (3, 1), (5, 1), (2, 2), (6, 2), (10, 2), (12, 2)] {
        for kernel in [3, 5, 7] {
            assert_agrees(&NetSpec { u0, levels, kernel, ..ao.clone() }, &[(19, 37)]);
        }
    }
}

#[test]
fn a_plan_runs_again_and_again() {
    let spec = NetSpec { levels: 3, ..NetSpec::ao(ChannelOrder::Interleaved, REACH) };
    let weights = Weights::random(&spec, 3);
    let network = cpu::Network::new(&spec, &weights);
    let mut plan = network.plan(21, 34);
    for seed in 0..3 {
        let input = noise(spec.input_channels(), 21, 34, seed);
        assert_eq!(plan.run(&network, &input), network.run(&input), "what was there before leaves no trace");
    }
}

#[test]
fn the_bits_do_not_depend_on_threads() {
    let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH);
    let network = cpu::Network::new(&spec, &Weights::random(&spec, 3));
    let input = noise(spec.input_channels(), 75, 130, 1);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| network.run(&input))
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn a_wrong_layer_is_found_where_it_is() {
    let spec = NetSpec { levels: 3, ..NetSpec::ao(ChannelOrder::Interleaved, REACH) };
    let weights = Weights::random(&spec, 3);
    let input = noise(spec.input_channels(), 24, 24, 1);
    let expected = reference::layers(&spec, &weights, &input);
    for (index, layer) in spec.layers().iter().enumerate() {
        let mut wrong = weights.clone();
        wrong.0[index].weight.reverse();
        let network = cpu::Network::new(&spec, &wrong);
        let mut plan = network.plan(24, 24);
        plan.run(&network, &input);
        let (found, _) =
            first_difference(&expected, &plan.layers(&network)).expect("the weights are reversed");
        assert_eq!(found, layer.name);
    }
}
