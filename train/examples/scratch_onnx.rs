//! scratch
use deepshade_infer::*;
use deepshade_train::*;
fn main() {
    let out = std::path::PathBuf::from("/tmp/onnx");
    for order in [ChannelOrder::Contiguous, ChannelOrder::Interleaved] {
        let spec = NetSpec::ao(order, Reach { radius: 1.0, diagonal_share: 0.05, height: 512 });
        let model = Model { weights: Weights::random(&spec, 1), spec };
        for (i, (h, w)) in [(16, 16), (203, 117), (256, 256), (75, 101)].into_iter().enumerate() {
            let dir = out.join(format!("{order:?}{i}"));
            model.save(&dir).unwrap();
            std::fs::write(dir.join("model.onnx"), export::onnx::encode(&model)).unwrap();
            let input = parity::noise(6, h, w, 3);
            let output = reference::forward(&model.spec, &model.weights, &input);
            Parity { input, output }.save(&dir).unwrap();
        }
    }
}
