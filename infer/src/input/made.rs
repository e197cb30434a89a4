//! What networks read that no renderer gives, made for the whole image, before any part is cut out of it: of
//! positions and the effect's radius, and of what filters of light go by. A network so reads nothing that
//! depends on where the camera stands or how large the scene is.
//!
//! In a shader each of them is a few lines: `forward/host.md` says for other engines what they hold.

mod filters;

use deepshade_shaders::{Attribute, GBuffer, MissingAttribute};
use rayon::prelude::*;

/// Levels of the pyramid of depth whose means [`Attribute::Relief`] is against: of 4, 16 and 64 pixels
/// squared.
pub const RELIEF_LEVELS: [usize; 3] = [2, 4, 6];
/// What logarithms of pixels are divided by in [`Attribute::PixelRadius`].
const OCTAVES: f32 = 8.0;
/// The smallest radius in pixels that is told from smaller ones.
const LEAST_PIXELS: f32 = 0.25;

/// The g-buffer with what is made of it, as far as `wanted` has it and the g-buffer has not, for an effect
/// that reaches `radius` metres. What was there before comes first.
///
/// # Errors
/// If something is wanted and what it is made of is not there.
pub fn with_made(gbuffer: &GBuffer, wanted: &[Attribute], radius: f32) -> Result<GBuffer, MissingAttribute> {
    let is_missing =
        |attribute: &&Attribute| !attribute.made_of().is_empty() && !gbuffer.attributes().contains(attribute);
    let missing: Vec<Attribute> = wanted.iter().filter(is_missing).copied().collect();
    if missing.is_empty() {
        return Ok(gbuffer.clone());
    }
    let seen = gbuffer.seen()?;
    let of_positions = missing.iter().any(|attribute| attribute.made_of().contains(&Attribute::Position));
    let points = if of_positions { Some(Points::of(gbuffer, &seen)?) } else { None };
    let mut data = Vec::new();
    for attribute in &missing {
        data.extend(match (attribute, &points) {
            (Attribute::SignedCircle, _) => filters::signed_circles(gbuffer, &seen)?,
            (Attribute::Movement, _) => filters::movements(gbuffer, &seen)?,
            (Attribute::Relief, Some(points)) => points.relief(radius),
            (Attribute::PixelRadius, Some(points)) => points.pixel_radii(radius),
            (Attribute::Border, Some(points)) => points.borders(radius),
            (_, Some(points)) => points.free_paths(gbuffer)?,
            (_, None) => Vec::new(),
        });
    }
    Ok(gbuffer.with(&missing, &data))
}

/// What is seen, as positions say.
struct Points {
    height: usize,
    width: usize,
    /// Depths, metres; 0 where nothing is seen.
    depth: Vec<f32>,
    focal_length: f32,
}

impl Points {
    fn of(gbuffer: &GBuffer, seen: &[bool]) -> Result<Self, MissingAttribute> {
        let z = gbuffer.planes().plane(gbuffer.first_plane(Attribute::Position)? + 2);
        let depth = z.iter().zip(seen).map(|(z, seen)| if *seen { -z } else { 0.0 }).collect();
        let focal_length = gbuffer.focal_length()?;
        Ok(Self { height: gbuffer.height(), width: gbuffer.width(), depth, focal_length })
    }

    /// A plane, row by row: each is written from its depths and its number.
    fn plane(&self, write: impl Fn(&[f32], usize, &mut [f32]) + Sync) -> Vec<f32> {
        let mut plane = vec![0.0; self.height * self.width];
        let rows = plane.par_chunks_exact_mut(self.width).enumerate();
        rows.for_each(|(y, out)| write(&self.depth[y * self.width..][..self.width], y, out));
        plane
    }

    fn relief(&self, radius: f32) -> Vec<f32> {
        let pyramid = Pyramid::of(&self.depth, self.height, self.width);
        let at = |level| {
            let level = pyramid.level(level, self.width);
            self.plane(|depths, y, out| level.relief(depths, y, radius, out))
        };
        RELIEF_LEVELS.into_iter().flat_map(at).collect()
    }

    fn pixel_radii(&self, radius: f32) -> Vec<f32> {
        self.plane(|depths, _, out| {
            for (out, depth) in out.iter_mut().zip(depths).filter(|(_, depth)| **depth > 0.0) {
                *out = logarithm(pixels(*depth, radius, self.focal_length));
            }
        })
    }

    fn borders(&self, radius: f32) -> Vec<f32> {
        self.plane(|depths, y, out| {
            for (x, (out, depth)) in out.iter_mut().zip(depths).enumerate() {
                let border = y.min(x).min(self.height - 1 - y).min(self.width - 1 - x) as f32 + 0.5;
                let share = border / pixels(*depth, radius, self.focal_length);
                *out = if *depth > 0.0 { share.min(1.0) } else { 0.0 };
            }
        })
    }

    fn free_paths(&self, gbuffer: &GBuffer) -> Result<Vec<f32>, MissingAttribute> {
        let of = gbuffer.select(&[Attribute::MeanFreePath])?;
        let value = |(path, depth): (&f32, &f32)| match *depth > 0.0 {
            true => logarithm(pixels(*depth, *path, self.focal_length)),
            false => 0.0,
        };
        Ok((0..of.channels()).flat_map(|c| of.plane(c).iter().zip(&self.depth).map(value)).collect())
    }
}

/// A number of pixels as networks read those that range over many octaves.
fn logarithm(pixels: f32) -> f32 {
    pixels.max(LEAST_PIXELS).log2() / OCTAVES
}

/// How many pixels a length covers at a depth.
fn pixels(depth: f32, length: f32, focal_length: f32) -> f32 {
    focal_length * length / depth.max(f32::MIN_POSITIVE)
}

/// A number as one between -1 and 1, small ones as they are.
fn compressed(value: f32) -> f32 {
    value / (1.0 + value.abs())
}

/// Sums of depth over squares, of what is seen alone: level l has those of `1 << l` pixels squared.
struct Pyramid {
    levels: Vec<Level>,
}

/// Sums over squares of pixels.
struct Level {
    height: usize,
    width: usize,
    depth: Vec<f32>,
    weight: Vec<f32>,
}

/// A level, read bilinearly between the middles of its squares.
struct Between<'a> {
    level: &'a Level,
    /// Pixels of a square along an axis.
    side: usize,
    /// For each column of the image the two of the level beside it, and the share of the second.
    columns: Vec<(usize, usize, f32)>,
}

impl Pyramid {
    /// Of depths that are 0 where nothing is seen.
    fn of(depth: &[f32], height: usize, width: usize) -> Self {
        let weight = depth.iter().map(|depth| f32::from(u8::from(*depth > 0.0))).collect();
        let mut levels = vec![Level { height, width, depth: depth.to_vec(), weight }];
        for _ in 0..RELIEF_LEVELS[RELIEF_LEVELS.len() - 1] {
            levels.push(levels[levels.len() - 1].halved());
        }
        Self { levels }
    }

    /// A level, as an image of so many columns reads it.
    fn level(&self, index: usize, width: usize) -> Between<'_> {
        let (level, side) = (&self.levels[index], 1 << index);
        Between { level, side, columns: (0..width).map(|x| between(x, side, level.width)).collect() }
    }
}

/// The two squares between whose middles a pixel lies, beyond the outermost that one twice, and the share of
/// the second.
fn between(at: usize, side: usize, size: usize) -> (usize, usize, f32) {
    let position = (at as f32 + 0.5) / side as f32 - 0.5;
    let inside = |index: isize| index.clamp(0, size as isize - 1) as usize;
    let first = position.floor();
    (inside(first as isize), inside(first as isize + 1), position - first)
}

impl Between<'_> {
    /// A row of depths against their means, over the radius; 0 where nothing is seen.
    fn relief(&self, depths: &[f32], y: usize, radius: f32, out: &mut [f32]) {
        let Level { height, width, depth, weight } = self.level;
        let (upper, lower, low) = between(y, self.side, *height);
        let row = |of: &[f32]| -> Vec<f32> {
            let (upper, lower) = (&of[upper * width..][..*width], &of[lower * width..][..*width]);
            upper.iter().zip(lower).map(|(upper, lower)| (1.0 - low) * upper + low * lower).collect()
        };
        let (sums, weights) = (row(depth), row(weight));
        let at =
            |of: &[f32], (left, right, far): (usize, usize, f32)| (1.0 - far) * of[left] + far * of[right];
        for ((out, depth), columns) in out.iter_mut().zip(depths).zip(&self.columns) {
            let mean = at(&sums, *columns) / at(&weights, *columns).max(f32::MIN_POSITIVE);
            *out = if *depth > 0.0 { compressed((depth - mean) / radius) } else { 0.0 };
        }
    }
}

impl Level {
    /// The sums over squares of four, a last row or column alone where there is no second one.
    fn halved(&self) -> Self {
        let (height, width) = (self.height.div_ceil(2), self.width.div_ceil(2));
        let sums = |of: &[f32]| {
            let mut sums = vec![0.0; height * width];
            for (y, row) in of.chunks_exact(self.width).enumerate() {
                let sums = &mut sums[y / 2 * width..][..width];
                row.chunks(2).zip(sums).for_each(|(two, sum)| *sum += two.iter().sum::<f32>());
            }
            sums
        };
        Self { height, width, depth: sums(&self.depth), weight: sums(&self.weight) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_shaders::Planes;

    /// A wall at a depth, seen with a focal length, its right half missing where `cut`.
    fn wall(height: usize, width: usize, depth: f32, focal_length: f32, cut: bool) -> GBuffer {
        let attributes = vec![Attribute::Position, Attribute::Valid];
        let value = |c: usize, y: usize, x: usize| match c {
            0 => (x as f32 + 0.5 - 0.5 * width as f32) * depth / focal_length,
            1 => (0.5 * height as f32 - 0.5 - y as f32) * depth / focal_length,
            2 => -depth,
            _ => f32::from(u8::from(!cut || 2 * x < width)),
        };
        GBuffer::new(attributes, Planes::from_fn(4, height, width, value))
    }

    fn made(gbuffer: &GBuffer, attribute: Attribute, radius: f32) -> Planes {
        let with = with_made(gbuffer, &[attribute], radius).expect("positions are there");
        with.select(&[attribute]).expect("it was made")
    }

    #[test]
    fn a_wall_has_no_relief_and_a_step_has_that_of_its_height() {
        assert!(
            made(&wall(70, 90, 3.0, 80.0, true), Attribute::Relief, 0.5)
                .data()
                .iter()
                .all(|v| v.abs() < 1e-5)
        );
        let mut planes = wall(128, 128, 2.0, 80.0, false).planes().clone();
        // The right half is a metre further away.
        (0..128 * 128).filter(|i| i % 128 >= 64).for_each(|i| planes.plane_mut(2)[i] = -3.0);
        let step = GBuffer::new(vec![Attribute::Position, Attribute::Valid], planes);
        let relief = made(&step, Attribute::Relief, 0.5);
        // Just left of the edge the mean over the coarsest squares is about half a metre further away: -1
        // radius.
        let at_edge = relief.at(2, 64, 63);
        assert!((at_edge + 0.5).abs() < 0.02, "{at_edge}");
        assert!(relief.at(0, 64, 20).abs() < 1e-6 && relief.at(2, 64, 63) < -0.4);
        let twice = made(&step, Attribute::Relief, 1.0).at(2, 64, 63);
        assert!((twice + 1.0 / 3.0).abs() < 0.02, "half as many radii: {twice}");
    }

    #[test]
    fn what_is_made_does_not_depend_on_units() {
        let metres = wall(40, 56, 3.0, 60.0, false);
        let mut planes = metres.planes().clone();
        (0..3).for_each(|c| planes.plane_mut(c).iter_mut().for_each(|value| *value *= 100.0));
        let centimetres = GBuffer::new(metres.attributes().to_vec(), planes);
        for attribute in [Attribute::Relief, Attribute::PixelRadius, Attribute::Border] {
            let [a, b] = [(&metres, 0.4), (&centimetres, 40.0)].map(|(g, radius)| made(g, attribute, radius));
            assert!(a.data().iter().zip(b.data()).all(|(a, b)| (a - b).abs() < 1e-4), "{attribute:?}");
        }
    }

    #[test]
    fn pixels_of_the_radius_and_the_border_are_as_the_camera_has_them() {
        let gbuffer = wall(64, 64, 2.0, 64.0, false);
        // 0.25 m at 2 m, focal length 64: 8 pixels, whose logarithm is 3.
        assert!(made(&gbuffer, Attribute::PixelRadius, 0.25).data().iter().all(|v| (v - 0.375).abs() < 1e-4));
        let border = made(&gbuffer, Attribute::Border, 0.25);
        assert!((border.at(0, 32, 3) - 3.5 / 8.0).abs() < 1e-4 && border.at(0, 32, 32) == 1.0);
        assert_eq!(border.at(0, 32, 60), border.at(0, 32, 3));
    }

    #[test]
    fn nothing_is_made_where_nothing_is_seen_or_of_nothing() {
        let gbuffer = wall(16, 16, 2.0, 16.0, true);
        for attribute in [Attribute::Relief, Attribute::PixelRadius, Attribute::Border] {
            assert_eq!(made(&gbuffer, attribute, 0.5).at(0, 3, 12), 0.0);
        }
        let blind = GBuffer::new(vec![Attribute::Valid], Planes::filled(1, 2, 2, 1.0));
        assert!(with_made(&blind, &[Attribute::Relief], 1.0).is_err());
        assert_eq!(with_made(&blind, &[Attribute::Valid], 1.0), Ok(blind));
    }
}
