//! scratch
use burn::tensor::Tensor;
use deepshade_infer::*;
use deepshade_train::*;
use burn::optim::*;
fn main() {
    let order = ChannelOrder::Interleaved;
    let spec = NetSpec::ao(order, Reach { radius: 1.0, diagonal_share: 0.05, height: 512 });
    let device = device().autodiff();
    for (batch, crop) in [(1usize, 256usize), (4, 256), (16, 128)] {
        let mut net = UNet::random(&spec, 1, &device);
        let mut optim = AdamWConfig::new().init();
        let x = Tensor::<4>::random([batch, 6, crop, crop], burn::tensor::Distribution::Default, &device);
        let y = Tensor::<4>::random([batch, 1, crop, crop], burn::tensor::Distribution::Default, &device);
        let v = Tensor::<4>::ones([batch, 1, crop, crop], &device);
        for rep in 0..8 {
            let t = std::time::Instant::now();
            let out = net.forward(x.clone());
            let t1 = t.elapsed();
            let l = loss::dssim(out, y.clone(), v.clone());
            let t2 = t.elapsed();
            let g = l.backward();
            let t3 = t.elapsed();
            let g = GradientsParams::from_grads(g, &net);
            net = optim.step(1e-3, net, g);
            if rep > 4 { println!("{batch}x{crop}: fwd {t1:?} loss {:?} bwd {:?} opt {:?} total {:?}", t2 - t1, t3 - t2, t.elapsed() - t3, t.elapsed()); }
        }
    }
}
