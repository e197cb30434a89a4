//! From a g-buffer to what a network reads, and from what it makes to an effect's image: the one place where radius
//! and background are dealt with, for training and for every way of running.

use crate::NetSpec;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes};

impl NetSpec {
    /// What the network reads of a g-buffer, `[input channels, height, width]`, so that an effect of `radius` metres
    /// looks to it like the one it was trained for: lengths are multiplied by
    /// [`Reach::position_scale`](crate::Reach::position_scale).
    ///
    /// # Errors
    /// If the g-buffer lacks one of the network's inputs.
    pub fn input(&self, gbuffer: &GBuffer, radius: f32) -> Result<Planes, MissingAttribute> {
        let mut input = gbuffer.select(&self.inputs)?;
        let scale = self.reach.position_scale(radius);
        let channels = self.inputs.iter().flat_map(|attribute| attribute.channels());
        for (plane, channel) in channels.enumerate() {
            if is_length(channel.attribute) {
                input.plane_mut(plane).iter_mut().for_each(|value| *value *= scale);
            }
        }
        Ok(input)
    }

    /// Puts the effect's background where the g-buffer shows no surface: where `valid` is 0.
    ///
    /// # Errors
    /// If the g-buffer has no `valid`.
    ///
    /// # Panics
    /// If image and g-buffer differ in size.
    pub fn set_background(&self, gbuffer: &GBuffer, image: &mut Planes) -> Result<(), MissingAttribute> {
        assert_eq!((image.height(), image.width()), (gbuffer.height(), gbuffer.width()), "sizes");
        let valid = gbuffer.planes().plane(gbuffer.first_plane(Attribute::Valid)?);
        for channel in 0..image.channels() {
            for (value, valid) in image.plane_mut(channel).iter_mut().zip(valid) {
                if *valid == 0.0 {
                    *value = self.effect.background();
                }
            }
        }
        Ok(())
    }
}

/// Whether an attribute is in metres.
const fn is_length(attribute: Attribute) -> bool {
    use Attribute::{Depth, FocalDistance, MeanFreePath, Position};
    matches!(attribute, Position | Depth | FocalDistance | MeanFreePath)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ChannelOrder, Reach};

    const REACH: Reach = Reach { radius: 2.0, diagonal_share: 0.05, height: 512 };

    #[test]
    fn only_lengths_are_scaled() {
        let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH);
        let planes = Planes::from_fn(6, 1, 2, |c, _, x| (10 * c + x) as f32);
        let gbuffer = GBuffer::new(vec![Attribute::Position, Attribute::Normal], planes);
        let input = spec.input(&gbuffer, 4.0).expect("everything is there");
        assert_eq!(input.data(), &[30.0, 31.0, 40.0, 41.0, 50.0, 51.0, 0.0, 0.5, 5.0, 5.5, 10.0, 10.5]);
    }

    #[test]
    fn nothing_seen_gets_the_background() {
        let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH);
        let valid = GBuffer::new(vec![Attribute::Valid], Planes::from_data(1, 1, 3, vec![1.0, 0.0, 1.0]));
        let mut image = Planes::filled(1, 1, 3, 0.25);
        spec.set_background(&valid, &mut image).expect("has a mask");
        assert_eq!(image.data(), &[0.25, 1.0, 0.25]);
        let blind = GBuffer::new(vec![Attribute::Depth], Planes::filled(1, 1, 3, 1.0));
        assert!(spec.set_background(&blind, &mut image).is_err());
    }
}
