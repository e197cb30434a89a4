//! Structural similarity (Wang, Bovik, Sheikh and Simoncelli 2004) over tiles that do not overlap, as the
//! thesis uses it for loss and evaluation (7.3.3).
//!
//! A tile is 8x8 values of one channel under a uniform window; variances are biased (divided by 64), the
//! range of the values is taken as 1. The result is the mean over tiles and channels. Only whole tiles count:
//! where height or width is not a multiple of 8, the remainder at the bottom or right is ignored.

use super::assert_same_shape;
use deepshade_shaders::Planes;
use deepshade_shaders::similarity::{C1, C2, TILE};

/// Structural similarity of two images: 1 where equal, lower where they differ; the mean over tiles and
/// channels. NaN where an image is smaller than a tile.
///
/// # Panics
/// If the images differ in shape.
pub fn ssim(a: &Planes, b: &Planes) -> f64 {
    let tiles = ssim_tiles(a, b);
    tiles.iter().sum::<f64>() / tiles.len() as f64
}

/// Structural similarity tile by tile, `[channels, height / 8, width / 8]`.
fn ssim_tiles(a: &Planes, b: &Planes) -> Vec<f64> {
    assert_same_shape(a, b);
    let (rows, columns) = (a.height() / TILE, a.width() / TILE);
    let mut tiles = Vec::with_capacity(a.channels() * rows * columns);
    for channel in 0..a.channels() {
        for row in 0..rows {
            for column in 0..columns {
                tiles.push(tile_ssim(&tile(a, channel, row, column), &tile(b, channel, row, column)));
            }
        }
    }
    tiles
}

/// The values of one whole tile, row by row.
fn tile(image: &Planes, channel: usize, row: usize, column: usize) -> [f32; TILE * TILE] {
    let mut values = [0.0; TILE * TILE];
    for (y, line) in values.chunks_exact_mut(TILE).enumerate() {
        let start = (row * TILE + y) * image.width() + column * TILE;
        line.copy_from_slice(&image.plane(channel)[start..start + TILE]);
    }
    values
}

/// Structural similarity of two tiles.
fn tile_ssim(a: &[f32; TILE * TILE], b: &[f32; TILE * TILE]) -> f64 {
    let mean =
        |values: &[f32; TILE * TILE]| values.iter().map(|v| f64::from(*v)).sum::<f64>() / a.len() as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut variance_a, mut variance_b, mut covariance) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let (da, db) = (f64::from(*a) - mean_a, f64::from(*b) - mean_b);
        variance_a += da * da;
        variance_b += db * db;
        covariance += da * db;
    }
    let share = 1.0 / a.len() as f64;
    let means = (2.0 * mean_a * mean_b + C1) / (mean_a * mean_a + mean_b * mean_b + C1);
    let spreads = (2.0 * share * covariance + C2) / (share * (variance_a + variance_b) + C2);
    means * spreads
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constant_images_have_the_closed_form_of_their_means() {
        let (x, y) = (0.5, 0.25);
        let a = Planes::filled(1, 16, 24, x as f32);
        let b = Planes::filled(1, 16, 24, y as f32);
        let expected = (2.0 * x * y + C1) / (x * x + y * y + C1);
        assert!((ssim(&a, &b) - expected).abs() < 1e-12);
    }

    #[test]
    fn a_stripe_against_its_inverse_has_the_closed_form_of_its_variance() {
        let stripe = |x: usize| if x.is_multiple_of(2) { 0.75 } else { 0.25 };
        let a = Planes::from_fn(1, 8, 8, |_, _, x| stripe(x));
        let b = Planes::from_fn(1, 8, 8, |_, _, x| stripe(x + 1));
        // Means agree; variances are 1/16, biased; the covariance is -1/16.
        let expected = (-0.125 + C2) / (0.125 + C2);
        assert!((ssim(&a, &b) - expected).abs() < 1e-12);
    }

    #[test]
    fn tiles_come_channel_by_channel_and_row_by_row() {
        let a = Planes::filled(2, 16, 24, 0.5);
        let mut b = a.clone();
        // One pixel in channel 1, tile row 1, tile column 2.
        b.plane_mut(1)[(8 + 3) * 24 + 16 + 5] = 0.9;
        let tiles = ssim_tiles(&a, &b);
        let different: Vec<usize> = (0..tiles.len()).filter(|i| tiles[*i] < 1.0 - 1e-9).collect();
        assert_eq!(tiles.len(), 12);
        assert_eq!(different, vec![6 + 3 + 2]);
    }

    #[test]
    fn what_is_not_a_whole_tile_is_ignored() {
        let a = Planes::filled(1, 21, 19, 0.5);
        let mut b = a.clone();
        b.plane_mut(0)[20 * 19] = 0.0;
        b.plane_mut(0)[18] = 0.0;
        assert_eq!(ssim_tiles(&a, &b).len(), 4);
        assert!((ssim(&a, &b) - 1.0).abs() < 1e-12);
        b.plane_mut(0)[15 * 19 + 15] = 0.0;
        assert!(ssim(&a, &b) < 0.9);
        assert!(ssim(&Planes::filled(1, 7, 64, 0.5), &Planes::filled(1, 7, 64, 0.5)).is_nan());
    }
}
