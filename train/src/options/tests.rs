//! What the options promise, beside the paper's network.

use super::space_to_depth::{to_depth, to_space};
use super::*;
use deepshade_infer::{ChannelOrder, Comparison, Reach, parity};
use deepshade_shaders::Effect;

fn dof() -> NetSpec {
    let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
    let published = NetSpec::published(Effect::Dof, ChannelOrder::Interleaved, reach).expect("it has one");
    NetSpec { levels: 3, ..published }
}

/// The first image of a network of a kind.
fn first_image(kind: Kind, input: &Planes, seen: &[bool]) -> Planes {
    let net = kind.first(&dof(), 3, &crate::device());
    Variant { kind, net }.image(input, seen)
}

#[test]
fn squares_become_channels_and_pixels_again() {
    let image = Planes::from_fn(2, 4, 6, |c, y, x| (100 * c + 10 * y + x) as f32);
    let x = to_tensor(&[&image], &crate::device());
    let depth = to_planes(to_depth(x.clone()));
    assert_eq!([4, 5, 6, 7].map(|c| depth.at(c, 1, 2)), [124.0, 125.0, 134.0, 135.0]);
    assert_eq!(to_planes(to_space(to_depth(x))), image);
}

#[test]
fn the_stem_keeps_the_light_that_the_network_begins_with() {
    let noise = parity::noise(3, 21, 35, 1);
    let input = Planes::from_fn(3, 21, 35, |c, y, x| noise.at(c, y, x).abs());
    let image = first_image(Kind::SpaceToDepth, &input, &[true; 21 * 35]);
    let differences = image.data().iter().zip(input.plane(2)).map(|(a, b)| (a - b).abs());
    let largest = differences.fold(0.0, f32::max);
    assert!(largest > 0.0 && largest < 0.4, "{largest}");
}

#[test]
fn what_is_masked_does_not_count() {
    let input = parity::noise(3, 24, 24, 1);
    let seen: Vec<bool> = (0..24 * 24).map(|at| at % 24 < 13).collect();
    let mut other = input.clone();
    for (at, seen) in seen.iter().enumerate().filter(|(_, seen)| !**seen) {
        (0..3).for_each(|c| other.plane_mut(c)[at] += if *seen { 0.0 } else { 5.0 });
    }
    let image = |input: &Planes, seen: &[bool]| first_image(Kind::Masked, input, seen);
    assert_eq!(image(&input, &seen), image(&other, &seen));
    assert_ne!(image(&input, &[true; 24 * 24]), image(&other, &[true; 24 * 24]));
}

#[test]
fn masks_of_nothing_change_only_the_edge() {
    let spec = NetSpec { levels: 1, ..dof() };
    let net = UNet::random(&spec, 3, &crate::device());
    let input = parity::noise(3, 16, 16, 1);
    let seen = Tensor::ones([1, 1, 16, 16], &crate::device());
    let x = to_tensor(&[&input], &crate::device());
    let inside = |image: Tensor<4>| to_planes(image).window(2, 2, 12, 12);
    let (plain, masked) = (net.forward(x.clone()), masked::forward(&net, x, seen));
    assert!(!Comparison::new(&to_planes(plain.clone()), &to_planes(masked.clone())).agrees(), "the edge");
    assert!(Comparison::new(&inside(plain), &inside(masked)).agrees());
}

#[test]
fn half_the_resolution_takes_a_quarter_of_the_sums() {
    let [paper, squares] = [Kind::Masked, Kind::SpaceToDepth].map(|kind| kind.multiply_adds(&dof()));
    let ends = (3 * 16 * 9 + 48 * 9) as f64;
    assert_eq!(squares, (paper - ends) / 4.0 + ends);
}
