//! From a g-buffer to what a network reads, and from what it makes to an effect's image: the one place where radius
//! and background are dealt with, for training and for every way of running.
//!
//! A renderer that keeps its g-buffer on the GPU does the same there, before and after
//! [`Plan::encode`](crate::Plan::encode).

use crate::{Colour, NetSpec};
use deepshade_shaders::{Attribute, AttributeKind, Channel, GBuffer, MissingAttribute, Planes};

impl NetSpec {
    /// What one of the network's [runs](NetSpec::runs) reads of a g-buffer, `[input channels, height, width]`, so that
    /// an effect of `radius` metres looks to it like the one it was trained for: lengths are multiplied by
    /// [`Reach::position_scale`](crate::Reach::position_scale). Of colours a mono network reads the channel that the
    /// run makes. Where no surface is seen every channel is 0, as in training, whatever the renderer has put there.
    ///
    /// # Errors
    /// If the g-buffer lacks one of the network's inputs or `valid`.
    pub fn input(&self, gbuffer: &GBuffer, radius: f32, run: usize) -> Result<Planes, MissingAttribute> {
        let all = gbuffer.select(&self.inputs)?;
        let seen = gbuffer.seen()?;
        let scale = self.reach.position_scale(radius);
        let channels = self.inputs.iter().flat_map(|attribute| attribute.channels());
        let mut data = Vec::with_capacity(self.input_channels() * all.pixels());
        for (plane, channel) in channels.enumerate().filter(|(_, channel)| self.reads(channel, run)) {
            let factor = if is_length(channel.attribute) { scale } else { 1.0 };
            let values = all.plane(plane).iter().zip(&seen);
            data.extend(values.map(|(value, seen)| if *seen { factor * *value } else { 0.0 }));
        }
        Ok(Planes::from_data(self.input_channels(), all.height(), all.width(), data))
    }

    /// Whether a run reads a channel of one of the network's inputs.
    fn reads(&self, channel: &Channel, run: usize) -> bool {
        let is_colour = channel.attribute.kind() == AttributeKind::Colour;
        !(self.colour == Colour::Mono && is_colour) || channel.component == run
    }

    /// The effect's image, `[effect's channels, height, width]`, of what the runs made, in their order.
    ///
    /// # Panics
    /// If they are not as many as [`NetSpec::runs`], or of different sizes.
    pub fn image(&self, runs: &[Planes]) -> Planes {
        assert_eq!(runs.len(), self.runs(), "runs of a network");
        let data = runs.iter().flat_map(|run| run.data()).copied().collect();
        Planes::from_data(self.effect.channels(), runs[0].height(), runs[0].width(), data)
    }

    /// Puts the effect's background, where it has one, where the g-buffer shows no surface.
    ///
    /// # Errors
    /// If the g-buffer has no `valid`.
    ///
    /// # Panics
    /// If image and g-buffer differ in size.
    pub fn set_background(&self, gbuffer: &GBuffer, image: &mut Planes) -> Result<(), MissingAttribute> {
        assert_eq!((image.height(), image.width()), (gbuffer.height(), gbuffer.width()), "sizes");
        let Some(background) = self.effect.background() else { return Ok(()) };
        let seen = gbuffer.seen()?;
        for channel in 0..image.channels() {
            for (value, seen) in image.plane_mut(channel).iter_mut().zip(&seen) {
                if !seen {
                    *value = background;
                }
            }
        }
        Ok(())
    }
}

/// Whether an attribute is in metres.
pub(crate) const fn is_length(attribute: Attribute) -> bool {
    use Attribute::{Depth, FocalDistance, MeanFreePath, Position};
    matches!(attribute, Position | Depth | FocalDistance | MeanFreePath)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ChannelOrder, Reach};
    use deepshade_shaders::Effect;

    const REACH: Reach = Reach { radius: 2.0, diagonal_share: 0.05, height: 512 };

    #[test]
    fn only_lengths_are_scaled() {
        let inputs = vec![Attribute::Normal, Attribute::Position, Attribute::Depth];
        let spec = NetSpec { inputs, ..NetSpec::ao(ChannelOrder::Interleaved, REACH) };
        let planes = Planes::from_fn(8, 1, 2, |c, _, x| (10 * c + x + 1) as f32);
        let attributes = vec![Attribute::Valid, Attribute::Position, Attribute::Normal, Attribute::Depth];
        let input = spec.input(&GBuffer::new(attributes, planes), 4.0, 0).expect("everything is there");
        let normal = [41.0, 42.0, 51.0, 52.0, 61.0, 62.0];
        let lengths = [5.5, 6.0, 10.5, 11.0, 15.5, 16.0, 35.5, 36.0];
        assert_eq!(input.data(), [&normal[..], &lengths].concat());
    }

    #[test]
    fn a_run_of_a_mono_network_reads_its_own_colour_channel() {
        let spec = NetSpec::published(Effect::Aa, ChannelOrder::Interleaved, REACH).expect("it has one");
        let planes = Planes::from_fn(5, 1, 1, |c, _, _| (c + 1) as f32);
        let gbuffer = GBuffer::new(vec![Attribute::Light, Attribute::Depth, Attribute::Valid], planes);
        let runs: Vec<Planes> =
            (0..3).map(|run| spec.input(&gbuffer, 2.0, run).expect("everything is there")).collect();
        assert_eq!(
            runs.iter().map(|run| run.data().to_vec()).collect::<Vec<_>>(),
            [[4.0, 1.0], [4.0, 2.0], [4.0, 3.0]]
        );
        let made: Vec<Planes> =
            runs.iter().map(|run| Planes::from_data(1, 1, 1, vec![run.data()[1]])).collect();
        assert_eq!(spec.image(&made).data(), [1.0, 2.0, 3.0]);
        let multi = NetSpec::published(Effect::Multi, ChannelOrder::Interleaved, REACH).expect("it has one");
        assert_eq!((multi.input_channels(), multi.runs()), (11, 1));
    }

    #[test]
    fn nothing_seen_is_read_as_zeros() {
        let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH);
        // What renderers leave behind the last surface: a far plane, infinity, nonsense.
        let planes = Planes::from_fn(7, 1, 4, |c, _, x| match (c, x) {
            (6, _) => [1.0, 0.0, 0.25, 0.0][x],
            (_, 0) => 1.0,
            _ => [0.0, 1e6, f32::INFINITY, f32::NAN][x],
        });
        let attributes = vec![Attribute::Normal, Attribute::Position, Attribute::Valid];
        let input =
            spec.input(&GBuffer::new(attributes, planes.clone()), 2.0, 0).expect("everything is there");
        assert_eq!(input.data(), [1.0, 0.0, 0.0, 0.0].repeat(6));
        let blind = vec![Attribute::Normal, Attribute::Position, Attribute::Depth];
        let error = spec.input(&GBuffer::new(blind, planes), 2.0, 0).expect_err("no mask");
        assert_eq!(error.wanted, "valid");
    }

    #[test]
    fn nothing_seen_gets_the_background() {
        let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH);
        let valid = GBuffer::new(vec![Attribute::Valid], Planes::from_data(1, 1, 3, vec![1.0, 0.25, 1.0]));
        let mut image = Planes::filled(1, 1, 3, 0.25);
        spec.set_background(&valid, &mut image).expect("has a mask");
        assert_eq!(image.data(), &[0.25, 1.0, 0.25]);
        let blind = GBuffer::new(vec![Attribute::Depth], Planes::filled(1, 1, 3, 1.0));
        assert!(spec.set_background(&blind, &mut image).is_err());
    }
}
