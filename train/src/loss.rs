//! The loss: structural dissimilarity over non-overlapping 8x8 tiles.
//!
//! SSIM (Wang et al. 2004, equation 13) with a uniform window, biased variance, `C1 = 0.01^2`, `C2 = 0.03^2` and a
//! range of 1, on raw linear output, averaged over tiles and channels; `DSSIM = (1 - SSIM) / 2`, the loss of the
//! thesis (7.3.3).

use burn::tensor::Tensor;
use burn::tensor::module::avg_pool2d;
use burn::tensor::ops::AvgPoolOptions;
use deepshade_shaders::similarity::{C1, C2, TILE};

/// DSSIM of predictions and targets, averaged over images, tiles and channels: `[1]`.
///
/// Where `valid` is 0 nothing was seen: there a prediction counts as right whatever it is, and has no gradient. Rows
/// and columns beyond the last whole tile do not count.
///
/// # Shapes
/// `prediction` and `target` `[batch, channels, height, width]`, `valid` `[batch, 1, height, width]`.
pub fn dssim(prediction: Tensor<4>, target: Tensor<4>, valid: Tensor<4>) -> Tensor<1> {
    let prediction = target.clone() + (prediction - target.clone()) * valid;
    (1.0 - ssim_tiles(prediction, target).mean()) * 0.5
}

/// SSIM of every tile: `[batch, channels, height / 8, width / 8]`.
fn ssim_tiles(a: Tensor<4>, b: Tensor<4>) -> Tensor<4> {
    let [_, _, height, width] = a.dims();
    let (height, width) = (height / TILE * TILE, width / TILE * TILE);
    let a = a.narrow(2, 0, height).narrow(3, 0, width);
    let b = b.narrow(2, 0, height).narrow(3, 0, width);
    // Differences from the tile's mean, not differences of squares, which lose digits in flat tiles.
    let (mean_a, mean_b) = (tile_means(a.clone()), tile_means(b.clone()));
    let a = a - spread(mean_a.clone());
    let b = b - spread(mean_b.clone());
    let variances = tile_means(a.clone() * a.clone() + b.clone() * b.clone());
    let covariance = tile_means(a * b);
    let product = mean_a.clone() * mean_b.clone();
    let squares = mean_a.clone() * mean_a + mean_b.clone() * mean_b;
    (product * 2.0 + C1) * (covariance * 2.0 + C2) / ((squares + C1) * (variances + C2))
}

fn tile_means(x: Tensor<4>) -> Tensor<4> {
    avg_pool2d(x, AvgPoolOptions::new([TILE; 2]))
}

/// A value a tile as a value a pixel.
fn spread(tiles: Tensor<4>) -> Tensor<4> {
    let [batch, channels, rows, columns] = tiles.dims();
    tiles
        .reshape([batch, channels, rows, 1, columns, 1])
        .expand([batch, channels, rows, TILE, columns, TILE])
        .reshape([batch, channels, rows * TILE, columns * TILE])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, Rng};
    use burn::tensor::{Device, TensorData};

    fn image(shape: [usize; 4], value: impl FnMut(usize) -> f32, device: &Device) -> Tensor<4> {
        let data: Vec<f32> = (0..shape.iter().product()).map(value).collect();
        Tensor::from_data(TensorData::new(data, shape), device)
    }

    fn noise(shape: [usize; 4], seed: u64, device: &Device) -> Tensor<4> {
        let mut rng = Rng::new(seed, Purpose::Crop, 0);
        image(shape, |_| rng.unit() as f32, device)
    }

    fn ones([batch, _, height, width]: [usize; 4], device: &Device) -> Tensor<4> {
        Tensor::ones([batch, 1, height, width], device)
    }

    /// DSSIM by the book, in f64.
    fn naive(a: &Tensor<4>, b: &Tensor<4>) -> f64 {
        let [batch, channels, height, width] = a.dims();
        let numbers = |t: &Tensor<4>| t.to_data().try_into_vec::<f32>().expect("f32");
        let (a, b) = (numbers(a), numbers(b));
        let (mut sum, mut count) = (0.0, 0.0);
        for plane in 0..batch * channels {
            for top in (0..height / TILE).map(|t| t * TILE) {
                for left in (0..width / TILE).map(|t| t * TILE) {
                    let at = |i: usize| (plane * height + top + i / TILE) * width + left + i % TILE;
                    let tile = |x: &[f32]| (0..64).map(|i| f64::from(x[at(i)])).collect::<Vec<_>>();
                    let (x, y) = (tile(&a), tile(&b));
                    let mean = |v: &[f64]| v.iter().sum::<f64>() / 64.0;
                    let (mx, my) = (mean(&x), mean(&y));
                    let moment = |p: &[f64], mp: f64, q: &[f64], mq: f64| {
                        p.iter().zip(q).map(|(p, q)| (p - mp) * (q - mq)).sum::<f64>() / 64.0
                    };
                    let (vx, vy, vxy) =
                        (moment(&x, mx, &x, mx), moment(&y, my, &y, my), moment(&x, mx, &y, my));
                    sum +=
                        (2.0 * mx * my + C1) * (2.0 * vxy + C2) / ((mx * mx + my * my + C1) * (vx + vy + C2));
                    count += 1.0;
                }
            }
        }
        (1.0 - sum / count) / 2.0
    }

    #[test]
    fn equal_images_lose_nothing_and_constant_ones_what_the_formula_says() {
        let device = crate::device();
        let shape = [1, 1, 16, 16];
        let a = noise(shape, 1, &device);
        let same: f32 = dssim(a.clone(), a, ones(shape, &device)).into_scalar();
        assert!(same.abs() < 1e-6, "{same}");
        let (x, y) = (0.3, 0.8);
        let (a, b) = (image(shape, |_| x as f32, &device), image(shape, |_| y as f32, &device));
        let loss: f32 = dssim(a, b, ones(shape, &device)).into_scalar();
        let expected = (1.0 - (2.0 * x * y + C1) / (x * x + y * y + C1)) / 2.0;
        assert!((f64::from(loss) - expected).abs() < 1e-6, "{loss} is not {expected}");
    }

    #[test]
    fn agrees_with_the_naive_sum_and_leaves_out_partial_tiles() {
        let device = crate::device();
        let shape = [2, 3, 27, 18];
        let (a, b) = (noise(shape, 1, &device), noise(shape, 2, &device));
        let loss: f32 = dssim(a.clone(), b.clone(), ones(shape, &device)).into_scalar();
        assert!((f64::from(loss) - naive(&a, &b)).abs() < 1e-6);
    }

    #[test]
    fn the_gradient_is_the_slope() {
        let device = crate::device().autodiff();
        let shape = [1, 1, 8, 16];
        let (a, b) = (noise(shape, 1, &device), noise(shape, 2, &device));
        let leaf = a.clone().require_grad();
        let grads = dssim(leaf.clone(), b.clone(), ones(shape, &device)).backward();
        let gradient = leaf.grad(&grads).expect("a gradient").to_data().try_into_vec::<f32>().expect("f32");
        for at in [0, 9, 77, 127] {
            let moved = |by: f32| {
                let mut data = a.to_data().try_into_vec::<f32>().expect("f32");
                data[at] += by;
                naive(&Tensor::from_data(TensorData::new(data, shape), &device), &b)
            };
            let slope = (moved(1e-3) - moved(-1e-3)) / 2e-3;
            let difference = (f64::from(gradient[at]) - slope).abs();
            assert!(difference < 1e-5 + 1e-2 * slope.abs(), "pixel {at}: {} is not {slope}", gradient[at]);
        }
    }

    #[test]
    fn invalid_pixels_count_as_right_and_have_no_gradient() {
        let device = crate::device().autodiff();
        let shape = [1, 1, 8, 8];
        let (a, b) = (noise(shape, 1, &device), noise(shape, 2, &device));
        let valid = image(shape, |i| if i < 32 { 1.0 } else { 0.0 }, &device);
        let repaired = a.clone() * valid.clone() + b.clone() * (1.0 - valid.clone());
        let leaf = a.require_grad();
        let loss = dssim(leaf.clone(), b.clone(), valid);
        let gradient =
            leaf.grad(&loss.backward()).expect("a gradient").to_data().try_into_vec::<f32>().expect("f32");
        let loss: f32 = loss.into_scalar();
        assert!((f64::from(loss) - naive(&repaired, &b)).abs() < 1e-6);
        assert!(gradient[..32].iter().any(|g| *g != 0.0) && gradient[32..].iter().all(|g| *g == 0.0));
    }
}
