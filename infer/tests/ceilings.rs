//! No network is faster than what its device can do at best.

use deepshade_infer::forward::{Options, OutputKind, Variant};
use deepshade_infer::parity::noise;
use deepshade_infer::{ChannelOrder, Cost, Model, NetSpec, Network, Reach, Weights};
use deepshade_shaders::gpu::{Ceilings, Gpu, ceilings};

const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

#[test]
fn no_network_computes_or_moves_more_than_the_ceilings() {
    let gpu = Gpu::new().expect("an adapter; a software one will do");
    let Ceilings { copy, multiply_add } = ceilings(&gpu.device, &gpu.queue).expect("runs");
    let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH).reshaped(|net| net.levels = 4);
    let model = Model { weights: Weights::random(&spec, 1), spec };
    let [height, width] = [256, 384];
    let input = noise(model.spec.input_channels(), height, width, 1);
    let cost: Cost = model.spec.costs(height, width).into_iter().sum();
    let variant = Some(Variant::gpu(&gpu.device.limits(), &model.spec, OutputKind::Buffer));
    let options = Options { variant, ..Options::default() };
    let network = Network::with(&gpu.device, &model.spec, &model.weights, &options).expect("compiles");
    let (_, staged) = network.run_timed(&gpu.queue, &input, 1, 3).expect("runs");
    let seconds = staged.milliseconds * 1e-3;
    let (computed, moved) =
        (2.0 * cost.multiply_adds as f64 / seconds, 4.0 * cost.numbers() as f64 / seconds);
    assert!(computed < multiply_add, "{computed} operations a second of {multiply_add}");
    assert!(moved < copy, "{moved} bytes a second of {copy}");
    // A ceiling that nothing comes near is none.
    assert!(computed > 1e-4 * multiply_add, "{computed} operations a second of {multiply_add}");
}
