//! From a g-buffer to what a network reads, and from what it makes to an effect's image, in plain Rust: for
//! training, and where the processor runs a network. Radius and background are dealt with here.
//!
//! [`InputPasses`](crate::forward::InputPasses) and [`ImagePass`](crate::forward::ImagePass) do the same on
//! the GPU, before and after [`Plan::encode`](crate::Plan::encode). Estimates are attributes of the g-buffer
//! by then: the crate of the methods makes them.

mod made;

pub use made::{RELIEF_LEVELS, with_made};

use crate::{Colour, NetSpec};
use deepshade_shaders::wgsl::convolution::Scale;
use deepshade_shaders::{
    Attribute, AttributeKind, Channel, Effect, GBuffer, MissingAttribute, Planes, exposure,
};

/// The most that an estimate comes to under its exposure, over the network's brightness. Frames of training
/// come to some tens. A network has made light out of nothing of one that came to millions.
const BRIGHTEST: f32 = 64.0;

/// What a frame's lengths and its light are multiplied by, so that the frame is to the network like those
/// that it was trained with (thesis 7.5.1, "Range of Values" and "Effect Radius").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaling {
    /// Factor of lengths in metres: [`Reach::position_scale`](crate::Reach::position_scale) of the wanted
    /// radius.
    pub length: f32,
    /// Factor of radiance; what the network makes is divided by it. 1 where it reads none: then its light is
    /// one it knows.
    pub light: f32,
}

impl NetSpec {
    /// A g-buffer with what the network reads that is made of it, for an effect that reaches `radius` metres.
    /// What methods estimate must be there already.
    ///
    /// # Errors
    /// If what it is made of is not there.
    pub fn prepared(&self, gbuffer: &GBuffer, radius: f32) -> Result<GBuffer, MissingAttribute> {
        with_made(gbuffer, &self.inputs, radius)
    }

    /// What a frame of a g-buffer is multiplied by, for an effect that reaches `radius` metres: light such
    /// that 99 % of what is not black is at most [`NetSpec::brightness`]. Where an estimate is all light that
    /// is read, nothing comes to more than 64 times that.
    ///
    /// # Errors
    /// If the g-buffer lacks light that the network reads.
    pub fn scaling(&self, gbuffer: &GBuffer, radius: f32) -> Result<Scaling, MissingAttribute> {
        let lights: Vec<Attribute> = self.lights().collect();
        let light = match lights[..] {
            [] => 1.0,
            [Attribute::Estimate] => self.brightness() * exposure_of_estimate(&gbuffer.select(&lights)?),
            _ => self.brightness() * exposure::of_values(gbuffer.select(&lights)?.data().iter().copied()),
        };
        Ok(Scaling { light, ..self.scaling_of_lengths(radius) })
    }

    /// As [`NetSpec::scaling`], of any frame, for a network that [reads no light](NetSpec::reads_light).
    pub fn scaling_of_lengths(&self, radius: f32) -> Scaling {
        Scaling { length: self.reach.position_scale(radius), light: 1.0 }
    }

    /// Whether it reads light, so that frames have to be exposed alike.
    pub fn reads_light(&self) -> bool {
        self.lights().next().is_some()
    }

    /// By which light frames are exposed. An estimate that is made of the frame's light is made after that.
    pub(crate) fn lights(&self) -> impl Iterator<Item = Attribute> {
        let lights = self.inputs.iter().copied().filter(|input| unit(*input).scale == Scale::Light);
        let follows = self.effect.definition().filters_light;
        lights.filter(move |light| *light != Attribute::Estimate || !follows)
    }

    /// How bright light is to the network. Light of one bounce is some six times fainter than that which it
    /// comes from (the median of the training frames of `gi-paper.toml`). Weights that make so faint an image
    /// are harder to learn, as an optimiser's steps are alike for all.
    pub fn brightness(&self) -> f32 {
        if self.effect == Effect::Gi { 8.0 } else { 1.0 }
    }

    /// What one of the network's [runs](NetSpec::runs) reads of a g-buffer,
    /// `[input channels, height, width]`, so that the frame looks to it like those that it was trained with:
    /// its numbers multiplied by [`Scaling`] and by the powers of two of [`factor`](NetSpec::factor). Of
    /// colours a mono network reads the channel that the run makes. Where no surface is seen every channel is
    /// 0, as in training, whatever the renderer has put there, but for what is [seen](NetSpec::is_everywhere)
    /// there, too.
    ///
    /// # Errors
    /// If the g-buffer lacks one of the network's inputs or `valid`.
    pub fn input(&self, gbuffer: &GBuffer, scaling: Scaling, run: usize) -> Result<Planes, MissingAttribute> {
        let all = gbuffer.select(&self.inputs)?;
        let seen = gbuffer.seen()?;
        let channels = self.inputs.iter().flat_map(|attribute| attribute.channels());
        let mut data = Vec::with_capacity(self.input_channels() * all.pixels());
        for (plane, channel) in channels.enumerate().filter(|(_, channel)| self.reads(channel, run)) {
            let factor = Self::factor(&channel, scaling);
            let everywhere = self.is_everywhere(channel.attribute);
            let values = all.plane(plane).iter().zip(&seen);
            data.extend(values.map(|(value, seen)| if *seen || everywhere { factor * *value } else { 0.0 }));
        }
        Ok(Planes::from_data(self.input_channels(), all.height(), all.width(), data))
    }

    /// What a channel is multiplied by: lengths and light by the frame's factors; pixels and mean free paths
    /// also by a power of two, which makes their numbers about as large as the components of normals.
    pub fn factor(channel: &Channel, scaling: Scaling) -> f32 {
        let Unit { scale, exponent } = channel_unit(channel);
        let factor = match scale {
            Scale::One => 1.0,
            Scale::Length => scaling.length,
            Scale::Light => scaling.light,
        };
        factor * 2f32.powi(exponent)
    }

    /// Whether an input is read where no surface is seen, too: the estimate of an effect that reaches beyond
    /// the surface's pixel.
    pub fn is_everywhere(&self, attribute: Attribute) -> bool {
        attribute == Attribute::Estimate && self.effect.background().is_none()
    }

    /// Whether a run reads a channel of one of the network's inputs.
    fn reads(&self, channel: &Channel, run: usize) -> bool {
        let is_colour = channel.attribute.kind() == AttributeKind::Colour;
        !(self.colour == Colour::Mono && is_colour) || channel.component == run
    }

    /// The effect's image, `[effect's channels, height, width]`, of what the runs made, in their order, in
    /// the light that the frame had before it was scaled, within the [range](Effect::range) of the effect.
    ///
    /// # Panics
    /// If they are not as many as [`NetSpec::runs`], or of different sizes.
    pub fn image(&self, runs: &[Planes], scaling: Scaling) -> Planes {
        assert_eq!(runs.len(), self.runs(), "runs of a network");
        let [least, most] = self.effect.range();
        let values = runs.iter().flat_map(|run| run.data());
        let data = values.map(|value| (value / scaling.light).clamp(least, most)).collect();
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

/// What a number of a g-buffer is in, to a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Unit {
    /// Which of the frame's factors it is multiplied by.
    pub scale: Scale,
    /// And by this power of two.
    pub exponent: i32,
}

/// Pixels count by the eight: circles of confusion and movements have some dozens of them.
const PIXELS: i32 = -3;
/// Mean free paths are some hundredths of the lengths that positions have.
const MEAN_FREE_PATHS: i32 = 5;

/// The unit of an attribute's numbers, but for a movement's direction.
const fn unit(attribute: Attribute) -> Unit {
    use Attribute::{
        Blurriness, CircleOfConfusion, Depth, DiffuseLight, Emission, Estimate, FocalDistance, Light,
        MeanFreePath, Motion, Position,
    };
    let (scale, exponent) = match attribute {
        Position | Depth | FocalDistance => (Scale::Length, 0),
        MeanFreePath => (Scale::Length, MEAN_FREE_PATHS),
        // Metres times pixels; over depth it is pixels again.
        Blurriness => (Scale::Length, PIXELS),
        CircleOfConfusion | Motion => (Scale::One, PIXELS),
        Light | DiffuseLight | Estimate | Emission => (Scale::Light, 0),
        _ => (Scale::One, 0),
    };
    Unit { scale, exponent }
}

/// The unit of a channel.
pub(crate) fn channel_unit(channel: &Channel) -> Unit {
    let is_direction = channel.attribute == Attribute::Motion && channel.component == 0;
    if is_direction { Unit { scale: Scale::One, exponent: 0 } } else { unit(channel.attribute) }
}

/// The exposure of an estimate that is all light of a frame. Where a lamp lights little of it the rest may be
/// dimmer by any number, and more than 99 % of what is not black.
fn exposure_of_estimate(estimate: &Planes) -> f32 {
    let values = || estimate.data().iter().copied().filter(|value| value.is_finite());
    let brightest = values().fold(0.0, f32::max);
    exposure::of_values(values()).min(BRIGHTEST / brightest.max(f32::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ChannelOrder, Reach};
    use deepshade_shaders::Effect;

    const REACH: Reach = Reach { radius: 2.0, diagonal_share: 0.05, height: 512 };

    /// A frame whose lengths are multiplied by this and whose light is as it is.
    const fn lengths(length: f32) -> Scaling {
        Scaling { length, light: 1.0 }
    }

    #[test]
    fn only_lengths_are_scaled() {
        let inputs = vec![Attribute::Normal, Attribute::Position, Attribute::Depth];
        let spec = NetSpec { inputs, ..NetSpec::ao(ChannelOrder::Interleaved, REACH) };
        let planes = Planes::from_fn(8, 1, 2, |c, _, x| (10 * c + x + 1) as f32);
        let attributes = vec![Attribute::Valid, Attribute::Position, Attribute::Normal, Attribute::Depth];
        let input =
            spec.input(&GBuffer::new(attributes, planes), lengths(0.5), 0).expect("everything is there");
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
            (0..3).map(|run| spec.input(&gbuffer, lengths(1.0), run).expect("everything is there")).collect();
        assert_eq!(
            runs.iter().map(|run| run.data().to_vec()).collect::<Vec<_>>(),
            [[4.0, 1.0], [4.0, 2.0], [4.0, 3.0]]
        );
        let made: Vec<Planes> =
            runs.iter().map(|run| Planes::from_data(1, 1, 1, vec![run.data()[1]])).collect();
        assert_eq!(spec.image(&made, lengths(1.0)).data(), [1.0, 2.0, 3.0]);
        assert_eq!(spec.image(&made, Scaling { length: 1.0, light: 4.0 }).data(), [0.25, 0.5, 0.75]);
        let multi = NetSpec::published(Effect::Multi, ChannelOrder::Interleaved, REACH).expect("it has one");
        assert_eq!((multi.input_channels(), multi.runs()), (11, 1));
    }

    #[test]
    fn light_is_exposed_and_lengths_follow_the_radius() {
        let spec = NetSpec::published(Effect::Dof, ChannelOrder::Interleaved, REACH).expect("it has one");
        let attributes = vec![Attribute::Blurriness, Attribute::Depth, Attribute::Light, Attribute::Valid];
        let frame = |light: f32| {
            let value = |c: usize, x: usize| match c {
                0 => 8.0,
                1 => 3.0,
                5 => 1.0,
                _ => light * (c as f32 + x as f32 / 1000.0),
            };
            GBuffer::new(attributes.clone(), Planes::from_fn(6, 1, 50, |c, _, x| value(c, x)))
        };
        let read = |light: f32, radius: f32| {
            let gbuffer = frame(light);
            let scaling = spec.scaling(&gbuffer, radius).expect("everything is there");
            (scaling, spec.input(&gbuffer, scaling, 2).expect("everything is there"))
        };
        let ((dim, a), (bright, b)) = (read(0.5, 2.0), read(64.0, 2.0));
        assert_eq!(a.data(), b.data(), "a dim scene looks like a bright one");
        assert_eq!(dim.light, 128.0 * bright.light);
        assert_eq!((a.at(0, 0, 0), a.at(1, 0, 0)), (1.0, 3.0), "pixels count by the eight");
        assert!((a.plane(2)[48] - 1.0).abs() < 2e-2 && a.plane(2).iter().all(|light| *light < 1.01));
        let (_, wide) = read(0.5, 4.0);
        assert_eq!((wide.at(0, 0, 0), wide.at(1, 0, 0)), (0.5, 1.5), "the circle, their ratio, stays");
        let ao = NetSpec::ao(ChannelOrder::Interleaved, REACH);
        assert_eq!(ao.scaling(&frame(9.0), 4.0), Ok(lengths(0.5)), "no light is read");
        assert_eq!(ao.scaling_of_lengths(4.0), lengths(0.5));
        assert!(spec.reads_light() && !ao.reads_light());
        let brighter = NetSpec { effect: Effect::Gi, ..spec.clone() };
        let light = brighter.scaling(&frame(0.5), 2.0).map(|scaling| scaling.light);
        assert_eq!(light, Ok(8.0 * dim.light), "to make an image of fainter light");
        assert!(
            spec.scaling(&GBuffer::new(vec![Attribute::Valid], Planes::filled(1, 1, 1, 1.0)), 1.0).is_err()
        );
    }

    #[test]
    fn a_faint_rest_does_not_make_a_lit_spot_too_bright() {
        let inputs = vec![Attribute::Estimate];
        let spec = NetSpec { inputs, ..NetSpec::ao(ChannelOrder::Interleaved, REACH) };
        let exposed = |rest: f32| {
            let value = |x: usize| if x == 0 { 0.5 } else { rest };
            let planes = Planes::from_fn(3, 1, 1000, |_, _, x| value(x));
            spec.scaling(&GBuffer::new(spec.inputs.clone(), planes), 2.0).map(|scaling| scaling.light)
        };
        assert_eq!(exposed(0.0), Ok(2.0));
        assert_eq!(exposed(0.125), Ok(8.0), "99 % come to 1");
        assert_eq!([1e-9, 1e-3].map(exposed), [Ok(128.0), Ok(128.0)], "the spot comes to 64");
        assert_eq!(exposed(f32::NAN), Ok(2.0));
    }

    #[test]
    fn the_direction_of_a_movement_is_an_angle() {
        let factor = |attribute, component| NetSpec::factor(&Channel { attribute, component }, lengths(0.5));
        assert_eq!([0, 1].map(|component| factor(Attribute::Motion, component)), [1.0, 0.125]);
        assert_eq!(factor(Attribute::MeanFreePath, 2), 16.0);
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
        let input = spec
            .input(&GBuffer::new(attributes, planes.clone()), lengths(1.0), 0)
            .expect("everything is there");
        assert_eq!(input.data(), [1.0, 0.0, 0.0, 0.0].repeat(6));
        let blind = vec![Attribute::Normal, Attribute::Position, Attribute::Depth];
        let error = spec.input(&GBuffer::new(blind, planes), lengths(1.0), 0).expect_err("no mask");
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
