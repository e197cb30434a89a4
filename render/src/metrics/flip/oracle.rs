//! FLIP against its authors' own program, through the crate `nv-flip`.

use super::{PIXELS_PER_DEGREE, flip, flip_map_at};
use deepshade_shaders::Planes;
use nv_flip::FlipImageRgb8;

const HEIGHT: usize = 61;
const WIDTH: usize = 83;
/// Both compute in 32-bit floats. Where colours hardly differ and edges do, the exponents make 1e-3 of a
/// rounding error (grey discs: 9.6e-4); everywhere else pixels agree to 1e-5.
const PIXEL_TOLERANCE: f32 = 2e-3;
const MEAN_TOLERANCE: f64 = 1e-5;

/// An 8-bit sRGB image of three channels, interleaved.
type Bytes = Vec<u8>;

/// The linear image that the bytes encode.
fn linear(bytes: &Bytes) -> Planes {
    Planes::from_fn(3, HEIGHT, WIDTH, |c, y, x| {
        let encoded = f32::from(bytes[(y * WIDTH + x) * 3 + c]) / 255.0;
        if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    })
}

fn oracle_map(a: &Bytes, b: &Bytes, pixels_per_degree: f32) -> Vec<f32> {
    let image = |bytes: &Bytes| FlipImageRgb8::with_data(WIDTH as u32, HEIGHT as u32, bytes);
    nv_flip::flip(image(a), image(b), pixels_per_degree).to_vec()
}

fn from_fn(value: impl Fn(usize, usize, usize) -> f32) -> Bytes {
    let byte = |i: usize| (value(i % 3, i / 3 / WIDTH, i / 3 % WIDTH).clamp(0.0, 1.0) * 255.0).round() as u8;
    (0..HEIGHT * WIDTH * 3).map(byte).collect()
}

/// A repeatable value in [0, 1) for each index (a step of the generator PCG by O'Neill).
fn noise(index: usize, seed: u32) -> f32 {
    let state = (index as u32).wrapping_mul(747_796_405).wrapping_add(seed.wrapping_mul(2_891_336_453));
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    ((word >> 22) ^ word) as f32 / (u32::MAX as f32 + 256.0)
}

/// Pairs of random, structured, grey and extreme images.
fn pairs() -> Vec<(&'static str, Bytes, Bytes)> {
    let random = |seed: u32| from_fn(move |c, y, x| noise((y * WIDTH + x) * 3 + c, seed));
    let waves = |phase: f32| {
        from_fn(move |c, y, x| {
            0.5 + 0.4 * (0.2 * x as f32 + phase).sin() * (0.1 * (y * (c + 1)) as f32).cos()
        })
    };
    let disc = |radius: usize| {
        from_fn(
            move |_, y, x| {
                if x.abs_diff(40).pow(2) + y.abs_diff(30).pow(2) < radius * radius { 0.9 } else { 0.3 }
            },
        )
    };
    let checks = |size: usize| {
        from_fn(move |c, y, x| if (x / size + y / size + c).is_multiple_of(3) { 1.0 } else { 0.0 })
    };
    let primary = |channel: usize| from_fn(move |c, _, _| f32::from(u8::from(c == channel)));
    vec![
        ("random", random(1), random(2)),
        ("waves", waves(0.0), waves(0.3)),
        ("grey discs", disc(15), disc(17)),
        ("checks", checks(5), checks(6)),
        ("green and blue", primary(1), primary(2)),
        ("black and white", from_fn(|_, _, _| 0.0), from_fn(|_, _, _| 1.0)),
        ("waves and random", waves(0.0), random(3)),
    ]
}

fn mean(map: &[f32]) -> f64 {
    map.iter().map(|value| f64::from(*value)).sum::<f64>() / map.len() as f64
}

#[test]
fn maps_and_means_agree_with_the_authors_program() {
    for pixels_per_degree in [PIXELS_PER_DEGREE, 31.0] {
        for (name, a, b) in pairs() {
            let ours = flip_map_at(&linear(&a), &linear(&b), pixels_per_degree);
            let theirs = oracle_map(&a, &b, pixels_per_degree);
            let worst = ours.data().iter().zip(&theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            let between_means = (mean(ours.data()) - mean(&theirs)).abs();
            println!("{name} at {pixels_per_degree}: worst pixel {worst:e}, means {between_means:e}");
            assert!(worst < PIXEL_TOLERANCE, "{name}: a pixel differs by {worst}");
            assert!(between_means < MEAN_TOLERANCE, "{name}: means differ by {between_means}");
        }
    }
}

#[test]
fn the_comparison_would_notice_another_image() {
    for (name, a, b) in pairs() {
        let theirs = mean(&oracle_map(&a, &b, PIXELS_PER_DEGREE));
        let mut brighter = linear(&b);
        brighter.data_mut().iter_mut().for_each(|value| *value = 0.99 * *value + 0.005);
        let ours = flip(&linear(&a), &brighter);
        assert!((ours - theirs).abs() > MEAN_TOLERANCE, "{name}: {ours} passes for {theirs}");
    }
}
