//! What a network was trained on, and what of a frame lies outside of that.

use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute};
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
    /// How many pixels the effect reaches at a pixel's depth, least and most: the radius, or what a filter of
    /// light goes by, its circle of confusion, movement or mean free path.
    pub pixels: [f32; 2],
    /// Depth of a pixel in radii of the effect, where it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depths: Option<[f32; 2]>,
    /// Rows of the frames.
    pub rows: [usize; 2],
}

/// What of a frame a network has not seen the like of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outside {
    /// Share of the pixels that show a surface at which the effect's reach is out of range.
    pub pixels: f32,
    /// Share of them whose depth is.
    pub depths: f32,
    /// The frame's rows where they are far fewer or more.
    pub rows: Option<usize>,
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
    /// The ranges of some frames of an effect, each with its radius, metres; none where no surface is seen or
    /// nothing tells how far the effect reaches.
    ///
    /// # Errors
    /// If a frame has not what tells that.
    pub fn of<'a>(
        effect: Effect,
        frames: impl IntoIterator<Item = (&'a GBuffer, f32)>,
    ) -> Result<Option<Self>, MissingAttribute> {
        let (mut pixels, mut depths, mut rows) = (Vec::new(), Vec::new(), [usize::MAX, 0]);
        for (gbuffer, radius) in frames {
            let reach = ReachOfPixels::of(effect, gbuffer, radius)?;
            pixels.extend(reach.pixels);
            depths.extend(reach.depths);
            rows = [rows[0].min(gbuffer.height()), rows[1].max(gbuffer.height())];
        }
        let depths = most_of(depths);
        // What a filter hardly changes is like what it leaves as it is.
        let least = |[least, most]: [f32; 2]| [if depths.is_some() { least } else { 0.0 }, most];
        Ok(most_of(pixels).map(|pixels| Self { pixels: least(pixels), depths, rows }))
    }

    /// What of a frame is outside, for an effect that reaches `radius` metres.
    ///
    /// # Errors
    /// If the frame has not what tells how far the effect reaches.
    pub fn outside(
        &self,
        effect: Effect,
        gbuffer: &GBuffer,
        radius: f32,
    ) -> Result<Outside, MissingAttribute> {
        let ReachOfPixels { pixels, depths } = ReachOfPixels::of(effect, gbuffer, radius)?;
        let share = |values: &[f32], [least, most]: [f32; 2]| {
            let outside = values.iter().filter(|value| !(least / SLACK..=most * SLACK).contains(*value));
            outside.count() as f32 / values.len().max(1) as f32
        };
        let height = gbuffer.height();
        let [least, most] = self.rows;
        let is_like = height * SLACK_OF_ROWS >= least && height <= most.saturating_mul(SLACK_OF_ROWS);
        let rows = (!is_like).then_some(height);
        let depths = self.depths.map_or(0.0, |range| share(&depths, range));
        Ok(Outside { pixels: share(&pixels, self.pixels), depths, rows })
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
            parts.push(format!("the effect's reach at {share} % of the pixels is not {range} pixels"));
        }
        if let Some(depths) = trained.depths.filter(|_| self.depths > NOTICEABLE) {
            let (share, range) = (percent(self.depths), range(depths));
            parts.push(format!("the depth of {share} % of them is not {range} radii"));
        }
        if let Some(rows) = self.rows {
            let [least, most] = trained.rows;
            let known = if least == most { most.to_string() } else { format!("{least} to {most}") };
            parts.push(format!("the image has {rows} rows, not {known}"));
        }
        (!parts.is_empty()).then(|| format!("unlike what the network was trained on: {}", parts.join("; ")))
    }
}

/// How far an effect reaches at the pixels that show a surface.
struct ReachOfPixels {
    /// In pixels.
    pixels: Vec<f32>,
    /// Their depths in radii, of an effect that has a radius.
    depths: Vec<f32>,
}

impl ReachOfPixels {
    fn of(effect: Effect, gbuffer: &GBuffer, radius: f32) -> Result<Self, MissingAttribute> {
        let filter = |pixels| Self { pixels, depths: Vec::new() };
        match effect {
            Effect::Aa => Ok(filter(Vec::new())),
            Effect::Dof => {
                let of = [Attribute::Blurriness, Attribute::Depth];
                where_seen(gbuffer, &of, |of| (of[0] / of[1]).abs()).map(filter)
            }
            Effect::MotionBlur => where_seen(gbuffer, &[Attribute::Motion], |of| of[1]).map(filter),
            Effect::Sss => {
                let focal_length = gbuffer.focal_length()?;
                let of = [Attribute::MeanFreePath, Attribute::Position];
                let longest = |of: &[f32]| of[0].max(of[1]).max(of[2]) * focal_length / -of[5];
                where_seen(gbuffer, &of, longest).map(filter)
            }
            _ => {
                let focal_length = gbuffer.focal_length()?;
                let depths = where_seen(gbuffer, &[Attribute::Position], |of| -of[2] / radius)?;
                let depths: Vec<f32> = depths.into_iter().filter(|depth| *depth > 0.0).collect();
                let pixels = depths.iter().map(|depth| focal_length / depth).collect();
                Ok(Self { pixels, depths })
            }
        }
    }
}

/// What the numbers of attributes come to at each pixel that shows a surface, where that is finite and not
/// negative.
fn where_seen(
    gbuffer: &GBuffer,
    of: &[Attribute],
    value: impl Fn(&[f32]) -> f32,
) -> Result<Vec<f32>, MissingAttribute> {
    let planes = gbuffer.select(of)?;
    let seen = gbuffer.seen()?;
    let mut numbers = vec![0.0; planes.channels()];
    let mut values = Vec::new();
    for pixel in (0..seen.len()).filter(|pixel| seen[*pixel]) {
        for (channel, number) in numbers.iter_mut().enumerate() {
            *number = planes.plane(channel)[pixel];
        }
        values.push(value(&numbers));
    }
    values.retain(|value| value.is_finite() && *value >= 0.0);
    Ok(values)
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
        let frames = [(&near, 0.5), (&far, 0.5)];
        let trained = Trained::of(Effect::Ao, frames).expect("positions").expect("surfaces");
        let depths = trained.depths.expect("there is a radius");
        let outside =
            |gbuffer: &GBuffer, radius| trained.outside(Effect::Ao, gbuffer, radius).expect("positions");
        assert_eq!(trained.rows, [64, 96]);
        let close = |[a, b]: [f32; 2], [c, d]: [f32; 2]| (a - c).abs() < 1e-3 && (b - d).abs() < 1e-3;
        assert!(close(trained.pixels, [8.0, 32.0]) && close(depths, [2.0, 8.0]), "{trained:?}");
        let inside = outside(&near, 0.4);
        assert_eq!((inside.pixels, inside.rows, inside.warning(&trained)), (0.0, None, None));
        let rows = [31, 32, 192, 193].map(|rows| outside(&wall(rows, 1.0), 0.5).rows);
        assert_eq!(rows, [Some(31), None, None, Some(193)], "half and twice as many are like those");
        let outside = outside(&wall(31, 1.0), 5.0);
        assert_eq!((outside.pixels, outside.depths, outside.rows), (1.0, 1.0, Some(31)));
        let warning = outside.warning(&trained).expect("it is unlike");
        assert!(warning.contains("reach at 100 % of the pixels is not 8 to 32 pixels"), "{warning}");
        assert!(warning.contains("the image has 31 rows, not 64 to 96"), "{warning}");
    }

    #[test]
    fn nothing_seen_has_no_range() {
        let nothing = GBuffer::new(vec![Attribute::Position, Attribute::Valid], Planes::filled(4, 2, 2, 0.0));
        assert_eq!(Trained::of(Effect::Ao, [(&nothing, 1.0)]), Ok(None));
    }

    #[test]
    fn a_lens_that_blurs_farther_than_those_of_training_is_outside_and_one_in_focus_is_not() {
        let frame = |circle: f32| {
            let value = |c: usize, _: usize, x: usize| [circle * x as f32 / 63.0 * 2.0, 2.0, 1.0][c];
            let attributes = vec![Attribute::Blurriness, Attribute::Depth, Attribute::Valid];
            GBuffer::new(attributes, Planes::from_fn(3, 64, 64, value))
        };
        let trained = Trained::of(Effect::Dof, [(&frame(16.0), 1.0)]).expect("a lens").expect("surfaces");
        assert_eq!((trained.pixels[0], trained.depths), (0.0, None));
        assert!((15.0..=16.0).contains(&trained.pixels[1]), "{trained:?}");
        let outside = |circle: f32| trained.outside(Effect::Dof, &frame(circle), 1.0).expect("a lens").pixels;
        assert_eq!((outside(0.0), outside(16.0)), (0.0, 0.0));
        assert!((0.7..0.8).contains(&outside(-80.0)), "{}", outside(-80.0));
        assert_eq!(Trained::of(Effect::Aa, [(&frame(16.0), 1.0)]), Ok(None), "nothing of a frame matters");
    }
}
