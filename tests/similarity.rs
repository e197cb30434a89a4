//! The loss that networks are trained with and the metric that they are measured with are the same
//! similarity.
#![cfg(feature = "train")]

use deepshade_render::metrics::ssim;
use deepshade_shaders::{Planes, random::random};
use deepshade_train::loss::{Loss, Target};
use deepshade_train::net::to_tensor;

#[test]
fn the_loss_is_the_metric() {
    let device = deepshade_train::device();
    // Rows and columns beyond the last whole tile count in neither.
    let [height, width] = [45, 70];
    let image = |seed: u32, contrast: f32| {
        Planes::from_fn(1, height, width, |_, y, x| {
            let wave = 0.5 + 0.3 * (0.2 * x as f32 + 0.1 * y as f32).sin();
            wave + contrast * (random(x as u32, y as u32, seed, 0) - 0.5)
        })
    };
    let seen = to_tensor(&[&Planes::filled(1, height, width, 1.0)], &device);
    let mut last = 1.0;
    for contrast in [0.0, 0.05, 0.3, 1.0] {
        let (a, b) = (image(1, contrast), image(2, contrast));
        let image = to_tensor(&[&b], &device);
        let target = Target { variance: image.zeros_like(), image, valid: seen.clone() };
        let loss: f32 = Loss::Dssim.of(to_tensor(&[&a], &device), target).into_scalar();
        let (from_loss, metric) = (1.0 - 2.0 * f64::from(loss), ssim(&a, &b));
        assert!((from_loss - metric).abs() < 1e-5, "contrast {contrast}: {from_loss} and {metric}");
        assert!(metric < last || contrast == 0.0, "contrast {contrast}: {metric} after {last}");
        last = metric;
    }
}
