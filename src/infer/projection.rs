//! Whether positions fall on the pixels that they are of.
//!
//! Whatever the lens, what is seen further to the right of the image lies further to the right of the
//! camera, and what is seen higher lies higher. Seen through a pinhole, x and y over the depth are straight
//! functions of column and row. Through a fisheye this holds nearly of x and y over the distance, and
//! without perspective of x and y themselves. Of positions in another space none of the three holds.

use glam::{DVec2, DVec3};

/// How well positions fall on their pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// The share of the spread of directions that columns and rows explain, 0 to 1: the lesser of both axes.
    pub explained: f64,
    /// Whether what is further to the right of the image has the smaller x.
    pub mirrored: bool,
    /// Whether what is higher in the image has the smaller y.
    pub upside_down: bool,
}

/// A point and its pixel: column and row, from the middle of the image, the row upwards.
pub struct ProjectedPoint {
    pub pixel: DVec2,
    pub point: DVec3,
}

/// The fewest points that say something, and the least spread in pixels.
const FEWEST: usize = 16;
const LEAST_SPREAD: f64 = 1.0;

/// How points that a camera sees which looks down -z fall on their pixels. None where too few do lie before
/// it, or they do not say.
pub fn of(points: &[ProjectedPoint]) -> Option<Projection> {
    let before: Vec<&ProjectedPoint> = points.iter().filter(|seen| seen.point.z < 0.0).collect();
    if before.len() < FEWEST {
        return None;
    }
    let divisors: [fn(DVec3) -> f64; 3] = [|point| -point.z, DVec3::length, |_| 1.0];
    let fits = divisors.iter().filter_map(|divisor| {
        let slopes = before.iter().map(|seen| (seen.pixel, seen.point.truncate() / divisor(seen.point)));
        fitted(&slopes.collect::<Vec<_>>())
    });
    fits.max_by(|a, b| a.explained.total_cmp(&b.explained))
}

/// Least squares of both slopes as straight functions of the pixel.
fn fitted(slopes: &[(DVec2, DVec2)]) -> Option<Projection> {
    let count = slopes.len() as f64;
    let sum = slopes.iter().fold((DVec2::ZERO, DVec2::ZERO), |sum, one| (sum.0 + one.0, sum.1 + one.1));
    let (pixel, slope) = (sum.0 / count, sum.1 / count);
    // Moments: of the pixels, of the slopes, and of each slope with each pixel's coordinate.
    let (mut columns, mut rows, mut both) = (0.0, 0.0, 0.0);
    let (mut spread, mut with_column, mut with_row) = (DVec2::ZERO, DVec2::ZERO, DVec2::ZERO);
    for (at, value) in slopes {
        let (at, value) = (*at - pixel, *value - slope);
        columns += at.x * at.x;
        rows += at.y * at.y;
        both += at.x * at.y;
        spread += value * value;
        with_column += value * at.x;
        with_row += value * at.y;
    }
    let determinant = columns * rows - both * both;
    let is_flat = columns < LEAST_SPREAD * count || rows < LEAST_SPREAD * count;
    // On a line of pixels both coordinates say the same.
    if is_flat || determinant < 0.01 * columns * rows || spread.min_element() <= 0.0 {
        return None;
    }
    let by_column = (with_column * rows - with_row * both) / determinant;
    let by_row = (with_row * columns - with_column * both) / determinant;
    let explained = (by_column * with_column + by_row * with_row) / spread;
    Some(Projection {
        explained: explained.min_element(),
        mirrored: by_column.x < 0.0,
        upside_down: by_row.y < 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a camera sees of a bumpy surface, each point moved by `moved`.
    fn seen(lens: impl Fn(DVec2) -> DVec3, moved: impl Fn(DVec3) -> DVec3) -> Vec<ProjectedPoint> {
        let pixel = |index: usize| DVec2::new((index % 40) as f64 - 19.5, 14.5 - (index / 40) as f64);
        let distance = |at: DVec2| 3.0 + (0.3 * at.x).sin() + (0.2 * at.y).cos();
        (0..1200)
            .map(pixel)
            .map(|at| ProjectedPoint { pixel: at, point: moved(lens(at / 20.0) * distance(at)) })
            .collect()
    }

    fn pinhole(at: DVec2) -> DVec3 {
        at.extend(-1.0)
    }

    #[test]
    fn a_camera_explains_its_own_positions_whatever_its_lens() {
        let explained = |points: &[ProjectedPoint]| of(points).expect("points enough").explained;
        assert!(explained(&seen(pinhole, |point| point)) > 0.999_999);
        let fisheye = |at: DVec2| {
            let (axis, angle) = (at.normalize(), at.length());
            (axis * angle.sin()).extend(-angle.cos())
        };
        assert!(explained(&seen(fisheye, |point| point)) > 0.95);
        let parallel = seen(pinhole, |point| DVec3::new(-point.x / point.z, -point.y / point.z, point.z));
        assert!(explained(&parallel) > 0.999_999);
    }

    #[test]
    fn positions_of_another_space_are_not_explained_and_turned_ones_are_told() {
        let turned = |point: DVec3| DVec3::new(point.z + 4.0, point.x, point.y - 6.0);
        assert!(of(&seen(pinhole, turned)).expect("points enough").explained < 0.3);
        let upside_down = of(&seen(pinhole, |point| point * DVec3::new(1.0, -1.0, 1.0))).expect("points");
        assert!(upside_down.upside_down && !upside_down.mirrored && upside_down.explained > 0.99);
        let mirrored = of(&seen(pinhole, |point| point * DVec3::new(-1.0, 1.0, 1.0))).expect("points");
        assert!(!mirrored.upside_down && mirrored.mirrored);
        assert_eq!(of(&seen(pinhole, |point| -point)), None, "all behind");
        assert_eq!(of(&seen(pinhole, |_| DVec3::NEG_Z)), None, "one point");
    }
}
