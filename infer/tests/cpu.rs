//! The CPU's forward pass equals the reference, layer by layer and element by element, on random asymmetric
//! weights.

use deepshade_infer::forward::ForwardError;
use deepshade_infer::parity::{first_difference, noise, rms};
use deepshade_infer::{
    ChannelOrder, Colour, Correction, Filter, Head, NetSpec, Reach, Weights, cpu, reference,
};
use deepshade_shaders::{Attribute, Effect};
use std::time::Instant;

const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
const ORDERS: [ChannelOrder; 2] = [ChannelOrder::Contiguous, ChannelOrder::Interleaved];

fn assert_agrees(spec: &NetSpec, sizes: &[(usize, usize)]) {
    let weights = Weights::random(spec, 11);
    let network = network(spec, &weights);
    for (height, width) in sizes {
        let input = noise(spec.input_channels(), *height, *width, 7);
        let expected = reference::layers(spec, &weights, &input);
        let mut plan = network.plan(*height, *width).expect("room");
        let made = plan.run_layers(&input).expect("runs").expect("as a whole");
        let what = format!("{spec:?} at {height}x{width}");
        assert_eq!(first_difference(&expected, &made), None, "{what}");
        let last = &expected[expected.len() - 1].planes;
        // A filter averages what is random.
        let least = if spec.filter().is_some() { 0.05 } else { 0.3 };
        let proves = last.pixels() < 100 || (least..3.0).contains(&rms(last));
        assert!(proves, "{what}: an image of rms {} proves little", rms(last));
    }
}

fn network(spec: &NetSpec, weights: &Weights) -> cpu::Network {
    cpu::Network::new(spec, weights).expect("they fit")
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
    let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH).reshaped(|net| net.levels = 2);
    let widths: Vec<(usize, usize)> = (1..70).map(|width| (1 + width % 7, width)).collect();
    assert_agrees(&spec, &widths);
    assert_agrees(&spec, &[(71, 5), (130, 3)]);
}

#[test]
fn numbers_of_channels_that_fill_no_block() {
    let ao = NetSpec::ao(ChannelOrder::Interleaved, REACH);
    for (u0, levels) in [(1, 1), (3, 1), (5, 1), (2, 2), (6, 2), (10, 2), (12, 2)] {
        for kernel in [3, 5, 7] {
            assert_agrees(
                &ao.clone().reshaped(|net| (net.u0, net.levels, net.kernel) = (u0, levels, kernel)),
                &[(19, 37)],
            );
        }
    }
}

/// A network that corrects an estimate by taps of so many levels.
fn correcting(levels: usize, kernel: usize) -> NetSpec {
    let (of, over) = (Attribute::Openness, Attribute::RawOpenness);
    let inputs = vec![Attribute::Normal, of, over];
    let correction = Correction { of, over, levels, kernel, gain: levels != 1, gated: levels > 1 };
    NetSpec::correcting(Effect::Ao, inputs, Vec::new(), correction, 8, REACH)
}

#[test]
fn networks_that_correct_an_estimate() {
    for (levels, kernel) in [(0, 1), (1, 5), (3, 3)] {
        assert_agrees(&correcting(levels, kernel), &[(19, 37), (64, 33), (1, 1)]);
    }
    let spec = correcting(2, 3);
    let network = network(&spec, &Weights::random(&spec, 3));
    let input = noise(spec.input_channels(), 333, 900, 1);
    let mut plan = network.plan_within(333, 900, 20_000_000).expect("tiles are small enough");
    assert!(plan.tiles() > 1);
    assert_eq!(plan.run(&input).expect("runs"), network.run(&input).expect("runs"), "in tiles");
}

/// Networks that predict kernels, of one colour channel and of three.
fn filtering() -> [NetSpec; 6] {
    let spec = |effect, levels, kernel, colour| {
        let published = NetSpec::published(effect, ChannelOrder::Interleaved, REACH).expect("it has one");
        NetSpec { colour, ..published }.with_head(Head::Filter(Filter { levels, kernel, black: false }))
    };
    let multi = NetSpec::published(Effect::Multi, ChannelOrder::Interleaved, REACH).expect("it has one");
    [
        spec(Effect::Dof, 5, 1, Colour::Rgb),
        spec(Effect::Dof, 5, 3, Colour::Mono),
        spec(Effect::MotionBlur, 2, 5, Colour::Mono),
        spec(Effect::Aa, 1, 3, Colour::Rgb),
        spec(Effect::Dof, 5, 3, Colour::Rgb),
        multi.predicting_kernels().expect("it reads light"),
    ]
}

#[test]
fn networks_that_predict_kernels() {
    for spec in filtering() {
        assert_agrees(&spec, &[(32, 64), (37, 83), (1, 1), (17, 3)]);
    }
}

#[test]
fn a_filter_is_timed_with_the_last_layer() {
    // Kernels of one pixel, and 49 taps: the filter takes nine tenths of the time, the layers alone one.
    let head = Head::Filter(Filter { levels: 1, kernel: 7, black: false });
    let spec = filtering()[3].clone().with_head(head).reshaped(|net| net.kernel = 1);
    let mut plan = network(&spec, &Weights::random(&spec, 3)).plan(256, 256).expect("room");
    let input = noise(spec.input_channels(), 256, 256, 1);
    let least = |of: &mut dyn FnMut() -> f64| (0..5).map(|_| of()).fold(f64::INFINITY, f64::min);
    let layers = least(&mut || plan.layer_times(&input).expect("runs").iter().map(|(_, time)| time).sum());
    let whole = least(&mut || {
        let start = Instant::now();
        plan.run(&input).expect("runs");
        start.elapsed().as_secs_f64() * 1e3
    });
    assert!(layers > 0.3 * whole, "layers take {layers} ms, the whole {whole}");
}

#[test]
fn a_plan_runs_again_and_again() {
    let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH).reshaped(|net| net.levels = 3);
    let network = network(&spec, &Weights::random(&spec, 3));
    let mut plan = network.plan(21, 34).expect("room");
    for seed in 0..3 {
        let input = noise(spec.input_channels(), 21, 34, seed);
        let (again, anew) = (plan.run(&input).expect("runs"), network.run(&input).expect("runs"));
        assert_eq!(again, anew, "what was there before leaves no trace");
    }
}

#[test]
fn tiles_make_the_same_as_the_whole() {
    for (effect, levels, bytes) in
        [(Effect::Ao, 3, 1_000_000), (Effect::Do, 2, 1_500_000), (Effect::Aa, 1, 300_000)]
    {
        let published = NetSpec::published(effect, ChannelOrder::Interleaved, REACH).expect("it has one");
        let spec = published.reshaped(|net| net.levels = levels);
        let network = network(&spec, &Weights::random(&spec, 3));
        let input = noise(spec.input_channels(), 133, 187, 1);
        let mut plan = network.plan_within(133, 187, bytes).expect("tiles are small enough");
        assert!(plan.tiles() > 1, "{effect}");
        assert_eq!(plan.run(&input).expect("runs"), network.run(&input).expect("runs"), "{effect}");
        assert_eq!(plan.run_layers(&input).expect("runs"), None);
    }
    let head = Head::Filter(Filter { levels: 2, kernel: 3, black: false });
    let spec = filtering()[0].clone().with_head(head).reshaped(|net| net.levels = 2);
    let network = network(&spec, &Weights::random(&spec, 3));
    let input = noise(spec.input_channels(), 133, 187, 1);
    let mut plan = network.plan_within(133, 187, 1_500_000).expect("tiles are small enough");
    assert!(plan.tiles() > 1);
    assert_eq!(plan.run(&input).expect("runs"), network.run(&input).expect("runs"), "with a filter");
}

#[test]
fn the_bits_do_not_depend_on_threads() {
    let [.., filtering] = filtering();
    for spec in [NetSpec::ao(ChannelOrder::Interleaved, REACH), filtering] {
        let network = network(&spec, &Weights::random(&spec, 3));
        let input = noise(spec.input_channels(), 75, 130, 1);
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| network.run(&input).expect("runs"))
        };
        assert_eq!(run(1), run(3), "{}", spec.effect);
    }
}

#[test]
fn a_wrong_layer_is_found_where_it_is() {
    let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH).reshaped(|net| net.levels = 3);
    let weights = Weights::random(&spec, 3);
    let input = noise(spec.input_channels(), 24, 24, 1);
    let expected = reference::layers(&spec, &weights, &input);
    for (index, layer) in spec.layers().iter().enumerate() {
        let mut wrong = weights.clone();
        wrong.0[index].weight.reverse();
        let mut plan = network(&spec, &wrong).plan(24, 24).expect("room");
        let made = plan.run_layers(&input).expect("runs").expect("as a whole");
        let (found, _) = first_difference(&expected, &made).expect("the weights are reversed");
        assert_eq!(found, layer.name);
    }
}

#[test]
fn what_cannot_run_is_an_error() {
    let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH);
    let weights = Weights::random(&spec, 3);
    let network = network(&spec, &weights);
    let message = |result: Result<(), ForwardError>| result.expect_err("refused").to_string();
    assert_eq!(
        message(network.run(&noise(5, 8, 8, 1)).map(drop)),
        "the input has 5 channels; the network reads 6"
    );
    assert!(message(network.plan(0, 8).map(drop)).contains("8x0"));
    assert!(message(network.plan_within(512, 512, 1000).map(drop)).contains("1000"));
    let other = spec.clone().reshaped(|net| net.u0 = 16);
    assert!(message(cpu::Network::new(&other, &weights).map(drop)).contains("do not fit"));
    let invalid = spec.reshaped(|net| net.levels = 0);
    assert!(cpu::Network::new(&invalid, &weights).is_err());
}
