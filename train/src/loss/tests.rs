//! DSSIM against the book, gradients against slopes, masks, and what tells the losses apart.

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

/// A target without noise, all of which is seen.
fn exact(image: &Tensor<4>) -> Target {
    Target { image: image.clone(), variance: image.zeros_like(), valid: ones(image.dims(), &image.device()) }
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
                let (vx, vy, vxy) = (moment(&x, mx, &x, mx), moment(&y, my, &y, my), moment(&x, mx, &y, my));
                sum += (2.0 * mx * my + C1) * (2.0 * vxy + C2) / ((mx * mx + my * my + C1) * (vx + vy + C2));
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
    let same: f32 = Loss::Dssim.of(a.clone(), exact(&a)).into_scalar();
    assert!(same.abs() < 1e-6, "{same}");
    let (x, y) = (0.3, 0.8);
    let (a, b) = (image(shape, |_| x as f32, &device), image(shape, |_| y as f32, &device));
    let loss: f32 = Loss::Dssim.of(a, exact(&b)).into_scalar();
    let expected = (1.0 - (2.0 * x * y + C1) / (x * x + y * y + C1)) / 2.0;
    assert!((f64::from(loss) - expected).abs() < 1e-6, "{loss} is not {expected}");
}

#[test]
fn agrees_with_the_naive_sum_and_leaves_out_partial_tiles() {
    let device = crate::device();
    let shape = [2, 3, 27, 18];
    let (a, b) = (noise(shape, 1, &device), noise(shape, 2, &device));
    let loss: f32 = Loss::Dssim.of(a.clone(), exact(&b)).into_scalar();
    assert!((f64::from(loss) - naive(&a, &b)).abs() < 1e-6);
}

#[test]
fn the_gradient_is_the_slope() {
    let device = crate::device().autodiff();
    let shape = [1, 1, 8, 16];
    let (a, b) = (noise(shape, 1, &device), noise(shape, 2, &device));
    let leaf = a.clone().require_grad();
    let grads = Loss::Dssim.of(leaf.clone(), exact(&b)).backward();
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
    let loss = Loss::Dssim.of(leaf.clone(), Target { valid, ..exact(&b) });
    let gradient =
        leaf.grad(&loss.backward()).expect("a gradient").to_data().try_into_vec::<f32>().expect("f32");
    let loss: f32 = loss.into_scalar();
    assert!((f64::from(loss) - naive(&repaired, &b)).abs() < 1e-6);
    assert!(gradient[..32].iter().any(|g| *g != 0.0) && gradient[32..].iter().all(|g| *g == 0.0));
}

#[test]
fn every_loss_is_what_its_name_says() {
    let device = crate::device();
    let shape = [2, 3, 128, 136];
    let (a, b) = (noise(shape, 1, &device), noise(shape, 2, &device));
    let of = |loss: Loss| f64::from(loss.of(a.clone(), exact(&b)).into_scalar::<f32>());
    let numbers = |t: &Tensor<4>| t.to_data().try_into_vec::<f32>().expect("f32");
    let differences: Vec<f64> =
        numbers(&a).iter().zip(numbers(&b)).map(|(a, b)| f64::from(a - b).abs()).collect();
    let l2 = differences.iter().map(|d| d * d).sum::<f64>() / differences.len() as f64;
    // Tiles lie one after the other within bands of eight rows.
    let (tiles, width) = (differences.len() / 64, shape[3]);
    let mut of_tiles = vec![0.0; tiles];
    for (i, (a, b)) in numbers(&a).iter().zip(numbers(&b)).enumerate() {
        of_tiles[i / width / TILE * (width / TILE) + i % width / TILE] += f64::from(a - b) / 64.0;
    }
    let of_means = of_tiles.iter().map(|mean| mean.abs()).sum::<f64>() / tiles as f64;
    let dssim = naive(&a, &b);
    let expected =
        [(Loss::DssimL2Means, dssim + l2 + of_means), (Loss::Dssim, dssim), (Loss::DssimL2, dssim + l2)];
    for (loss, expected) in expected {
        assert!((of(loss) - expected).abs() < 1e-5, "{loss:?} {} is not {expected}", of(loss));
    }
}

#[test]
fn every_loss_falls_along_its_gradient_and_masks_what_is_not_seen() {
    let device = crate::device().autodiff();
    let shape = [1, 2, 128, 128];
    let valid = image([1, 1, 128, 128], |i| if i % 128 < 64 { 1.0 } else { 0.0 }, &device);
    let target = Target { valid, ..exact(&noise(shape, 2, &device)) };
    for loss in [Loss::Dssim, Loss::DssimL2, Loss::DssimL2Means] {
        let start = noise(shape, 1, &device).require_grad();
        let before = loss.of(start.clone(), target.clone());
        let gradient = start.grad(&before.backward()).expect("a gradient");
        let unseen = gradient.clone().narrow(3, 64, 64).abs().max().into_scalar::<f32>();
        assert_eq!(unseen, 0.0, "{loss:?}");
        let length = gradient.clone().abs().max().into_scalar::<f32>();
        let moved = Tensor::from_data(start.to_data(), &device)
            - Tensor::from_data(gradient.to_data(), &device) * (0.01 / length);
        let after = loss.of(moved, target.clone()).into_scalar::<f32>();
        assert!(length > 0.0 && after < before.clone().into_scalar::<f32>(), "{loss:?}");
    }
}

/// A slope, and what so many samples of 0 or 1 in two independent halves make of it, with the variance that
/// they estimate.
fn slope_and_samples(samples: usize, device: &Device) -> (Tensor<4>, Target) {
    const EDGE: usize = 256;
    let shape = [1, 1, EDGE, EDGE];
    // As steep in every tile, from 0.4 to 0.6.
    let value = |i: usize| 0.5 + 0.2 * ((i % TILE + i / EDGE % TILE) as f32 / (2 * TILE - 2) as f32 - 0.5);
    let mut rng = Rng::new(7, Purpose::Crop, 0);
    let mut half = |i: usize| {
        let hits = (0..samples / 2).filter(|_| rng.unit() < f64::from(value(i))).count();
        hits as f32 / (samples / 2) as f32
    };
    let halves: Vec<[f32; 2]> = (0..EDGE * EDGE).map(|i| [half(i), half(i)]).collect();
    let mean = image(shape, |i| 0.5 * (halves[i][0] + halves[i][1]), device);
    let variance = image(shape, |i| (0.5 * (halves[i][0] - halves[i][1])).powi(2), device);
    (image(shape, value, device), Target { variance, ..exact(&mean) })
}

#[test]
fn truth_loses_less_where_the_noise_is_known_and_never_less_than_nothing() {
    for samples in [4, 16, 64] {
        let (truth, noisy) = slope_and_samples(samples, &crate::device());
        let of = |target: Target| Loss::Dssim.of(truth.clone(), target).into_scalar::<f32>();
        let [known, unknown] = [noisy.clone(), exact(&noisy.image)].map(of);
        assert!((0.0..0.7 * unknown).contains(&known), "{samples} samples: {known}, {unknown}");
    }
}

#[test]
fn noise_that_is_known_asks_for_the_contrast_of_truth() {
    for samples in [4, 16, 64] {
        let (truth, noisy) = slope_and_samples(samples, &crate::device());
        let best = |target: &Target| {
            let loss = |tenths: usize| {
                let contrast = (truth.clone() - 0.5) * (0.1 * tenths as f32) + 0.5;
                Loss::Dssim.of(contrast, target.clone()).into_scalar::<f32>()
            };
            (3..40).min_by(|a, b| loss(*a).total_cmp(&loss(*b))).expect("some")
        };
        let [known, unknown] = [noisy.clone(), exact(&noisy.image)].map(|target| best(&target));
        assert!(
            (8..=12).contains(&known) && unknown >= 15,
            "{samples} samples: {known} and {unknown} tenths"
        );
    }
}

#[test]
fn what_is_not_seen_counts_as_right_with_its_noise() {
    let device = crate::device();
    let (_, noisy) = slope_and_samples(16, &device);
    let anything = noise(noisy.image.dims(), 3, &device);
    for loss in [Loss::Dssim, Loss::DssimL2] {
        let unseen = Target { valid: noisy.valid.zeros_like(), ..noisy.clone() };
        let value = loss.of(anything.clone(), unseen).into_scalar::<f32>();
        assert!(value.abs() < 1e-5, "{loss}: {value}");
    }
}

#[test]
fn a_highlight_counts_no_more_than_white_does() {
    let device = crate::device();
    let shape = [1, 1, 16, 16];
    let black = image(shape, |_| 0.0, &device);
    let l2 = |highlight: f32| {
        let target = || exact(&image(shape, |pixel| if pixel == 40 { highlight } else { 0.0 }, &device));
        let loss = |loss: Loss| -> f32 { loss.of(black.clone(), target()).into_scalar() };
        loss(Loss::DssimL2) - loss(Loss::Dssim)
    };
    assert!((l2(0.5) - 0.25 / 256.0).abs() < 1e-6, "{}", l2(0.5));
    for highlight in [1.0, 30.0, 1000.0] {
        assert!((l2(highlight) - 1.0 / 256.0).abs() < 1e-6, "{highlight}: {}", l2(highlight));
    }
}
