//! A [`Correction`] on the processor: rows in parallel.

use super::filter::{Light, padded, planar, unfold_row};
use crate::spec::channels;
use crate::{Correction, NetSpec};
use deepshade_shaders::Planes;
use rayon::prelude::*;

/// The network's image of its input, given what its last block makes, on its level.
pub fn corrected(spec: &NetSpec, correction: Correction, input: &Planes, made: &Planes) -> Planes {
    let estimate = channels(input, &spec.channels_of(correction.of));
    let over = channels(input, &spec.pyramid_channels());
    let pyramid =
        (correction.levels > 0).then(|| Light::new(correction.filter(), padded(&over, spec.alignment())));
    let row = Row {
        correction,
        range: spec.effect.range(),
        level: spec.last_level(),
        estimate: &estimate,
        over: &over,
        pyramid: pyramid.as_ref(),
        biases: correction.bias_count(estimate.channels()),
        gain: correction.gain.then(|| correction.filter().tap_count()),
        made,
    };
    let (height, width) = (input.height(), input.width());
    let rows: Vec<Vec<f32>> = (0..height).into_par_iter().map(|y| row.corrected(y)).collect();
    Planes::from_data(estimate.channels(), height, width, planar(&rows, width))
}

/// What the rows of an image are made of.
struct Row<'a> {
    correction: Correction,
    range: [f32; 2],
    level: usize,
    estimate: &'a Planes,
    over: &'a Planes,
    pyramid: Option<&'a Light>,
    /// Channels of a pixel that are biases, before the weights.
    biases: usize,
    /// Which channel is the gain.
    gain: Option<usize>,
    made: &'a Planes,
}

impl Row<'_> {
    /// A row of the image, `[channels, width]`.
    fn corrected(&self, y: usize) -> Vec<f32> {
        let (channels, width) = (self.estimate.channels(), self.estimate.width());
        let begun = |channel: usize| &self.estimate.plane(channel)[y * width..][..width];
        let mut weights = vec![0.0; width];
        let mut image: Vec<f32> = (0..channels).flat_map(begun).copied().collect();
        for channel in 0..self.biases {
            unfold_row(self.made, self.level, channel, y, &mut weights);
            let image = &mut image[channel * width..][..width];
            image.iter_mut().zip(&weights).for_each(|(image, bias)| *image += bias);
        }
        if let Some(pyramid) = self.pyramid {
            pyramid.visit_taps(y, width, |tap, channel, there| {
                unfold_row(self.made, self.level, self.biases + tap, y, &mut weights);
                let (image, begun) = (&mut image[channel * width..][..width], begun(channel));
                for x in 0..width {
                    image[x] += weights[x] * (there[x] - begun[x]);
                }
            });
        }
        if let Some(gain) = self.gain {
            unfold_row(self.made, self.level, gain, y, &mut weights);
            for channel in 0..channels {
                let image = &mut image[channel * width..][..width];
                image
                    .iter_mut()
                    .zip(begun(channel))
                    .zip(&weights)
                    .for_each(|((image, begun), gain)| *image += gain * begun);
            }
        }
        if self.correction.gated {
            self.gate(y, &mut image);
        }
        let [least, most] = self.range;
        image.iter_mut().for_each(|value| *value = value.clamp(least, most));
        image
    }

    /// Leaves so much of what was corrected in a row of the image as [`Correction::gate`] says.
    fn gate(&self, y: usize, image: &mut [f32]) {
        let width = self.estimate.width();
        let row = |of: &'_ Planes, channel: usize, x: usize| of.plane(channel)[y * width + x];
        for x in 0..width {
            let channels = 0..self.estimate.channels();
            let difference = |c: usize| (row(self.over, c, x) - row(self.estimate, c, x)).abs();
            let share = self.correction.gate(channels.clone().map(difference).fold(0.0, f32::max));
            for channel in channels {
                let (begun, value) = (row(self.estimate, channel, x), &mut image[channel * width + x]);
                *value = begun + share * (*value - begun);
            }
        }
    }
}
