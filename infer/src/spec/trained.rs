//! What a network was trained on, and what of a frame lies outside of that.

use deepshade_shaders::{Attribute, GBuffer, MissingAttribute};
use serde::{Deserialize, Serialize};
use std::fmt;

/// The environment that all images of training had, which the network knows by heart.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrainedUnder {
    /// The clear sky of a number.
    Sky(u32),
    /// The map in a file of this BLAKE3 hash, in hexadecimal.
    File(String),
}

/// Ranges of the training data: of pixels all but the outermost hundredth at each end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trained {
    /// Radius of the effect in pixels at a pixel's depth, least and most.
    pub pixels: [f32; 2],
    /// Depth of a pixel in radii of the effect.
    pub depths: [f32; 2],
    /// Rows of the frames.
    pub rows: [usize; 2],
}

/// What of a frame a network has not seen the like of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outside {
    /// Share of the pixels that show a surface whose radius in pixels is out of range.
    pub pixels: f32,
    /// Share of them whose depth is.
    pub depths: f32,
    /// Whether the frame has far fewer or more rows.
    pub rows: bool,
}

/// Share of the pixels that is left out at each end of a range.
const LEFT_OUT: f32 = 0.01;
/// By this factor a frame may go beyond a range of pixels or depths before that is said.
const SLACK: f32 = 1.25;
/// By this factor it may have fewer or more rows: what matters is how many pixels the effect reaches.
const SLACK_OF_ROWS: usize = 2;
/// From this share of the pixels on it is said.
const NOTICEABLE: f32 = 0.05;

impl fmt::Display for TrainedUnder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sky(number) => write!(f, "a clear sky, number {number}"),
            Self::File(hash) => write!(f, "an environment map whose file has the BLAKE3 hash {hash}"),
        }
    }
}

impl Trained {
    /// The ranges of some frames, each with its effect's radius, metres; none where no surface is seen.
    ///
    /// # Errors
    /// If a frame has no positions.
    pub fn of<'a>(
        frames: impl IntoIterator<Item = (&'a GBuffer, f32)>,
    ) -> Result<Option<Self>, MissingAttribute> {
        let (mut pixels, mut depths, mut rows) = (Vec::new(), Vec::new(), [usize::MAX, 0]);
        for (gbuffer, radius) in frames {
            let (in_pixels, in_depths) = of_pixels(gbuffer, radius)?;
            pixels.extend(in_pixels);
            depths.extend(in_depths);
            rows = [rows[0].min(gbuffer.height()), rows[1].max(gbuffer.height())];
        }
        let ranges = most_of(pixels).zip(most_of(depths));
        Ok(ranges.map(|(pixels, depths)| Self { pixels, depths, rows }))
    }

    /// What of a frame is outside, for an effect that reaches `radius` metres.
    ///
    /// # Errors
    /// If the frame has no positions.
    pub fn outside(&self, gbuffer: &GBuffer, radius: f32) -> Result<Outside, MissingAttribute> {
        let (pixels, depths) = of_pixels(gbuffer, radius)?;
        let share = |values: &[f32], [least, most]: [f32; 2]| {
            let outside = values.iter().filter(|value| !(least / SLACK..=most * SLACK).contains(*value));
            outside.count() as f32 / values.len().max(1) as f32
        };
        let height = gbuffer.height();
        let [least, most] = self.rows;
        let rows = height * SLACK_OF_ROWS < least || height > most.saturating_mul(SLACK_OF_ROWS);
        Ok(Outside { pixels: share(&pixels, self.pixels), depths: share(&depths, self.depths), rows })
    }
}

impl Outside {
    /// What is to be said of it, in words; nothing where the frame is like those of training.
    pub fn warning(&self, trained: &Trained) -> Option<String> {
        let percent = |share: f32| (100.0 * share).round();
        let range = |[least, most]: [f32; 2]| format!("{least:.0} to {most:.0}");
        let mut parts = Vec::new();
        if self.pixels > NOTICEABLE {
            let share = percent(self.pixels);
            let range = range(trained.pixels);
            parts.push(format!("the radius of {share} % of the pixels is not {range} pixels"));
        }
        if self.depths > NOTICEABLE {
            let (share, range) = (percent(self.depths), range(trained.depths));
            parts.push(format!("the depth of {share} % of them is not {range} radii"));
        }
        if self.rows {
            let [least, most] = trained.rows;
            parts.push(format!("images had {least} to {most} rows"));
        }
        (!parts.is_empty()).then(|| format!("unlike what the network was trained on: {}", parts.join("; ")))
    }
}

/// Of every pixel that shows a surface the radius in pixels, and the depth in radii.
fn of_pixels(gbuffer: &GBuffer, radius: f32) -> Result<(Vec<f32>, Vec<f32>), MissingAttribute> {
    let focal_length = gbuffer.focal_length()?;
    let z = gbuffer.planes().plane(gbuffer.first_plane(Attribute::Position)? + 2);
    let seen = gbuffer.seen()?;
    let depths = || z.iter().zip(&seen).filter(|(z, seen)| **seen && **z < 0.0).map(|(z, _)| -z / radius);
    Ok((depths().map(|depth| focal_length / depth).collect(), depths().collect()))
}

/// The least and the most of values, without the outermost.
fn most_of(mut values: Vec<f32>) -> Option<[f32; 2]> {
    values.sort_unstable_by(f32::total_cmp);
    let left_out = (LEFT_OUT * values.len() as f32) as usize;
    Some([*values.get(left_out)?, *values.get(values.len().checked_sub(left_out + 1)?)?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_shaders::Planes;

    /// A wall at a depth, seen with a focal length of 64.
    fn wall(side: usize, depth: f32) -> GBuffer {
        let middle = |at: usize| at as f32 + 0.5 - 0.5 * side as f32;
        let value = |c: usize, y: usize, x: usize| match c {
            0 => middle(x) * depth / 64.0,
            1 => -middle(y) * depth / 64.0,
            2 => -depth,
            _ => 1.0,
        };
        GBuffer::new(vec![Attribute::Position, Attribute::Valid], Planes::from_fn(4, side, side, value))
    }

    #[test]
    fn what_was_trained_on_is_inside_and_what_is_far_from_it_is_not() {
        let (near, far) = (wall(64, 1.0), wall(96, 4.0));
        let trained = Trained::of([(&near, 0.5), (&far, 0.5)]).expect("positions").expect("surfaces");
        assert_eq!(trained.rows, [64, 96]);
        let close = |[a, b]: [f32; 2], [c, d]: [f32; 2]| (a - c).abs() < 1e-3 && (b - d).abs() < 1e-3;
        assert!(close(trained.pixels, [8.0, 32.0]) && close(trained.depths, [2.0, 8.0]), "{trained:?}");
        let inside = trained.outside(&near, 0.4).expect("positions");
        assert_eq!((inside.pixels, inside.rows, inside.warning(&trained)), (0.0, false, None));
        let rows =
            [31, 32, 192, 193].map(|rows| trained.outside(&wall(rows, 1.0), 0.5).expect("positions").rows);
        assert_eq!(rows, [true, false, false, true], "half and twice as many are like those");
        let outside = trained.outside(&wall(31, 1.0), 5.0).expect("positions");
        assert_eq!((outside.pixels, outside.depths, outside.rows), (1.0, 1.0, true));
        let warning = outside.warning(&trained).expect("it is unlike");
        assert!(warning.contains("radius of 100 % of the pixels is not 8 to 32 pixels"), "{warning}");
        assert!(warning.contains("64 to 96 rows"), "{warning}");
    }

    #[test]
    fn nothing_seen_has_no_range() {
        let nothing = GBuffer::new(vec![Attribute::Position, Attribute::Valid], Planes::filled(4, 2, 2, 0.0));
        assert_eq!(Trained::of([(&nothing, 1.0)]), Ok(None));
    }
}
