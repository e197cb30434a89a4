//! Closed forms, on data without any symmetry.

use super::*;
use crate::parity::noise;
use crate::{ChannelOrder, Correction, Reach};
use deepshade_shaders::{Attribute, Effect};

const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

fn close(a: f32, b: f32) -> bool {
    (a - b).abs() < 1e-5
}

fn plain(inputs: usize, outputs: usize, groups: usize) -> Layer {
    Layer {
        name: "plain".to_owned(),
        level: 0,
        source: BlockSource::Input,
        kernel: 3,
        inputs,
        outputs,
        groups,
        activation: false,
    }
}

#[test]
fn a_delta_kernel_shifts_and_brings_in_zeros() {
    let image = noise(1, 6, 9, 1);
    for (ky, kx) in [(0, 0), (0, 2), (1, 1), (2, 0), (2, 1)] {
        let mut weights = LayerWeights { weight: vec![0.0; 9], bias: vec![0.25] };
        weights.weight[ky * 3 + kx] = 2.0;
        let made = convolved(&image, &plain(1, 1, 1), &weights);
        for (y, x) in (0..6).flat_map(|y| (0..9).map(move |x| (y, x))) {
            let inside = (1..=6).contains(&(y + ky)) && (1..=9).contains(&(x + kx));
            let value = if inside { image.at(0, y + ky - 1, x + kx - 1) } else { 0.0 };
            assert!(close(made.at(0, y, x), 2.0 * value + 0.25), "tap ({ky}, {kx}) at ({y}, {x})");
        }
    }
}

#[test]
fn a_kernel_wider_than_the_image_sees_all_of_it() {
    let image = noise(1, 2, 2, 1);
    let weights = LayerWeights { weight: (0..49).map(|i| i as f32).collect(), bias: vec![0.0] };
    let made = convolved(&image, &Layer { kernel: 7, ..plain(1, 1, 1) }, &weights);
    let tap = |ky: usize, kx: usize| (ky * 7 + kx) as f32;
    let expected = tap(3, 2) * image.at(0, 0, 0)
        + tap(3, 3) * image.at(0, 0, 1)
        + tap(4, 2) * image.at(0, 1, 0)
        + tap(4, 3) * image.at(0, 1, 1);
    assert!((made.at(0, 0, 1) - expected).abs() < 1e-4);
}

#[test]
fn weights_are_output_input_row_column() {
    let image = Planes::from_fn(2, 3, 3, |c, y, x| (100 * c + 10 * y + x) as f32);
    let weight: Vec<f32> = (0..36).map(|i| i as f32).collect();
    let weights = LayerWeights { weight, bias: vec![0.0; 2] };
    let made = convolved(&image, &plain(2, 2, 1), &weights);
    let mut expected = 0.0;
    for (c, y, x) in (0..2).flat_map(|c| (0..3).flat_map(move |y| (0..3).map(move |x| (c, y, x)))) {
        expected += (18 + 9 * c + 3 * y + x) as f32 * image.at(c, y, x);
    }
    assert_eq!(made.at(1, 1, 1), expected);
}

#[test]
fn groups_see_their_own_channels_only() {
    let image = noise(4, 5, 4, 2);
    let weight = (0..4 * 2 * 9).map(|i| (i as f32).sin()).collect();
    let weights = LayerWeights { weight, bias: vec![0.0; 4] };
    let mut changed = image.clone();
    changed.plane_mut(3).fill(9.0);
    let made = convolved(&image, &plain(4, 4, 2), &weights);
    let other = convolved(&changed, &plain(4, 4, 2), &weights);
    for output in 0..4 {
        assert_eq!(made.plane(output) == other.plane(output), output < 2, "output {output}");
    }
}

#[test]
fn pooling_is_the_mean_of_four() {
    let image = Planes::from_fn(2, 4, 6, |c, y, x| (100 * c + 10 * y + x) as f32);
    let made = pooled(&image);
    assert_eq!((made.height(), made.width()), (2, 3));
    assert_eq!(made.at(1, 1, 2), 100.0 + 25.0 + 4.5);
    assert_eq!(made.at(0, 0, 1), 5.0 + 2.5);
}

#[test]
fn doubling_keeps_a_ramp_a_ramp_inside_and_its_edge_values() {
    let (height, width) = (5, 7);
    let image = Planes::from_fn(1, height, width, |_, y, x| 3.0 * y as f32 - 2.0 * x as f32);
    let made = doubled(&image);
    assert_eq!((made.height(), made.width()), (10, 14));
    // Half-pixel centres: new pixel x lies at old coordinate x / 2 - 1/4.
    let position = |at: usize, size: usize| (at as f32 / 2.0 - 0.25).clamp(0.0, (size - 1) as f32);
    for (y, x) in (0..10).flat_map(|y| (0..14).map(move |x| (y, x))) {
        let expected = 3.0 * position(y, height) - 2.0 * position(x, width);
        assert!(close(made.at(0, y, x), expected), "({y}, {x})");
    }
}

#[test]
fn joining_follows_the_order_of_the_spec() {
    let coarse = Planes::from_fn(4, 2, 2, |c, _, _| c as f32);
    let skip = Planes::from_fn(2, 2, 2, |c, _, _| 10.0 + c as f32);
    let channels = |groups| -> Vec<f32> {
        let made = joined(&coarse, &skip, groups);
        (0..6).map(|c| made.at(c, 1, 0)).collect()
    };
    assert_eq!(channels(1), [0.0, 1.0, 2.0, 3.0, 10.0, 11.0]);
    assert_eq!(channels(2), [0.0, 1.0, 10.0, 2.0, 3.0, 11.0]);
}

#[test]
fn unfolding_undoes_folding() {
    let image = noise(3, 8, 12, 5);
    let small = folded(&image);
    assert_eq!((small.channels(), small.height(), small.width()), (12, 4, 6));
    // Second row and first column of a square: the third pixel of four.
    assert_eq!(small.at(2 * 3 + 1, 2, 4), image.at(1, 5, 8));
    assert_eq!(unfolded(&small, 1), image);
    assert_eq!(unfolded(&image, 0), image);
}

#[test]
fn a_gated_correction_leaves_what_its_method_left() {
    let (of, over) = (Attribute::Estimate, Attribute::Light);
    let correction = Correction { of, over, levels: 2, kernel: 3, gain: true, gated: true };
    let spec = NetSpec::correcting(Effect::MotionBlur, vec![over, of], Vec::new(), correction, 8, REACH);
    let weights = Weights::random(&spec, 1);
    let light = noise(3, 20, 28, 2).map(|value| 0.5 + 0.25 * value);
    // The method changed the right half alone.
    let value = |c: usize, y: usize, x: usize| {
        let light = light.at(c % 3, y, x);
        if c >= 3 && x >= 14 { light + 0.1 } else { light }
    };
    let image = forward(&spec, &weights, &Planes::from_fn(6, 20, 28, value));
    let change = |x: usize| (image.at(1, 9, x) - value(4, 9, x)).abs();
    assert!((0..14).all(|x| change(x) == 0.0), "what was left is left");
    assert!((14..28).any(|x| change(x) > 1e-3), "what was changed is corrected");
}

#[test]
fn a_correction_of_nothing_is_the_estimate_and_one_of_a_tap_brings_it_there() {
    let (of, over) = (Attribute::Openness, Attribute::RawOpenness);
    let correction = Correction { of, over, levels: 2, kernel: 3, gain: false, gated: false };
    let inputs = vec![Attribute::Normal, of, over];
    let spec = NetSpec::correcting(Effect::Ao, inputs, Vec::new(), correction, 8, REACH);
    let mut weights = Weights::random(&spec, 1);
    let last = weights.0.last_mut().expect("a layer");
    last.weight.fill(0.0);
    last.bias.fill(0.0);
    // As it comes from a method: within the effect's range.
    let input = noise(5, 21, 34, 2).map(|value| 0.5 + 0.25 * value);
    let begun = forward(&spec, &weights, &input);
    assert_eq!(begun.data(), input.plane(3));
    // The bias of every pixel's own raw estimate, the fifth of the finest level's taps.
    let count = spec.head_channels();
    (0..4).for_each(|pixel| weights.0.last_mut().expect("a layer").bias[pixel * count + 1 + 4] = 1.0);
    let moved = forward(&spec, &weights, &input);
    assert!(moved.data().iter().zip(input.plane(4)).all(|(a, b)| close(*a, *b)));
    // Far beyond the range.
    (0..4).for_each(|pixel| weights.0.last_mut().expect("a layer").bias[pixel * count] = -9.0);
    assert!(forward(&spec, &weights, &input).data().iter().all(|value| *value == 0.0));
}

#[test]
fn padding_repeats_the_last_row_and_column() {
    let image = noise(1, 17, 5, 1);
    let made = padded(&image, 16);
    assert_eq!((made.height(), made.width()), (32, 16));
    assert_eq!(made.at(0, 31, 3), image.at(0, 16, 3));
    assert_eq!(made.at(0, 4, 15), image.at(0, 4, 4));
    assert_eq!(made.at(0, 31, 15), image.at(0, 16, 4));
}

#[test]
fn any_size_gives_an_image_of_that_size_and_names_every_layer() {
    let spec = NetSpec::ao(ChannelOrder::Contiguous, REACH);
    let weights = Weights::random(&spec, 1);
    let input = noise(6, 37, 53, 2);
    let image = forward(&spec, &weights, &input);
    assert_eq!((image.channels(), image.height(), image.width()), (1, 37, 53));
    let layers = layers(&spec, &weights, &input);
    let names: Vec<_> = layers.iter().map(|made| made.layer.as_str()).collect();
    assert_eq!(names.join(" "), "down0 down1 down2 down3 down4 down5 up4 up3 up2 up1 up0");
    assert_eq!(layers[10].planes, image);
    assert_eq!(
        (layers[5].planes.channels(), layers[5].planes.height(), layers[5].planes.width()),
        (256, 2, 2)
    );
}

#[test]
fn a_network_of_one_level_is_two_convolutions() {
    let spec = NetSpec::ao(ChannelOrder::Contiguous, REACH).reshaped(|net| net.levels = 1);
    let weights = Weights::random(&spec, 1);
    let input = noise(6, 8, 8, 2);
    let image = forward(&spec, &weights, &input);
    let [down, up] = [0, 1].map(|layer| spec.layers()[layer].clone());
    let mut made = convolved(&input, &down, &weights.0[0]);
    made.data_mut().iter_mut().for_each(|value| *value = leaky(*value, spec.leak));
    assert_eq!(image, convolved(&made, &up, &weights.0[1]));
    assert!(image.data().iter().any(|value| *value < -0.5), "the image has no activation");
}

#[test]
fn the_leak_scales_negative_values_only() {
    assert_eq!([leaky(-2.0, 0.01), leaky(3.0, 0.01), leaky(0.0, 0.01)], [-0.02, 3.0, 0.0]);
}
