//! scratch
use deepshade_infer::*;
use deepshade_train::*;
fn main() {
    for order in [ChannelOrder::Contiguous, ChannelOrder::Interleaved] {
        let spec = NetSpec::ao(order, Reach { radius: 1.0, diagonal_share: 0.05, height: 512 });
        for (batch, crop) in [(1usize, 256usize), (4, 256), (8, 128), (16, 128)] {
            let config = TrainConfig { batch, crop, ..TrainConfig::new(spec.clone(), "x".into()) };
            println!("{order:?} {batch}x{crop}: {:?}", bench::bench(&config, 9));
        }
    }
}
