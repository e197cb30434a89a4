//! The passes that write a network's input, put together for what the network reads: a buffer an attribute,
//! and what is made of positions and the effect's radius.

use super::TILE;
use super::convolution::TextureChannel;
use super::import::Product;
use crate::Attribute;
use std::fmt::Write;

/// Binding of what a pass writes.
pub const WRITTEN: u32 = 1;
/// Binding of the sums over squares of pixels, which `net/squares` writes.
pub const SQUARES: u32 = 2;
/// Binding of the g-buffer's `valid`.
pub const VALID: u32 = 3;
/// Binding of the first of the other attributes.
pub const FIRST_ATTRIBUTE: u32 = 4;

/// A channel of a network's input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputChannel {
    /// One of an attribute, scaled.
    Of(Attribute, TextureChannel),
    /// The same, where no surface is seen, too.
    Everywhere(Attribute, TextureChannel),
    /// [`Attribute::Relief`] at one of its scales, from 0.
    Relief(u32),
    /// [`Attribute::PixelRadius`].
    PixelRadius,
    /// [`Attribute::Border`].
    Border,
    /// [`Attribute::SignedCircle`].
    SignedCircle,
    /// A component of [`Attribute::Movement`].
    Movement(usize),
    /// A component of [`Attribute::FreePathPixels`], or that which the run makes.
    FreePathPixels(Option<usize>),
}

/// A pass that writes some channels of a network's input, one after the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputPass {
    /// Index of the first channel that it writes.
    pub first: u32,
    /// The channels.
    pub channels: Vec<InputChannel>,
}

impl InputPass {
    /// The attributes that it reads besides `valid`: bound to [`FIRST_ATTRIBUTE`] and on.
    pub fn attributes(&self) -> Vec<Attribute> {
        let mut attributes = Vec::new();
        for channel in &self.channels {
            for attribute in channel.reads() {
                if *attribute != Attribute::Valid && !attributes.contains(attribute) {
                    attributes.push(*attribute);
                }
            }
        }
        attributes
    }

    /// Whether it reads sums over squares of pixels.
    pub fn reads_squares(&self) -> bool {
        self.channels.iter().any(|channel| matches!(channel, InputChannel::Relief(_)))
    }

    /// How many storage buffers it binds.
    pub fn buffers(&self) -> usize {
        2 + usize::from(self.reads_squares()) + self.attributes().len()
    }

    /// The whole source. It reads a [`NetFrame`](super::uniforms::NetFrame) in binding 0.
    pub fn source(&self) -> String {
        let product = Product::of(&self.files());
        let mut source = format!("const TILE = {TILE}u;\n");
        for (binding, attribute) in (FIRST_ATTRIBUTE..).zip(self.attributes()) {
            let planes = planes(attribute);
            writeln!(source, "@group(0) @binding({binding}) var<storage, read> {planes}: array<f32>;")
                .expect("writing to a string");
        }
        source + &self.writes() + &product.text
    }

    fn files(&self) -> Vec<&'static str> {
        let mut files = vec!["net/input"];
        if self.reads_squares() {
            files.push("shared/net_relief");
        }
        let in_pixels = |channel: &InputChannel| {
            matches!(
                channel,
                InputChannel::PixelRadius | InputChannel::Border | InputChannel::FreePathPixels(_)
            )
        };
        if self.channels.iter().any(in_pixels) {
            files.push("shared/net_pixel_radius");
        }
        let of_filters = |channel: &InputChannel| {
            matches!(channel, InputChannel::SignedCircle | InputChannel::Movement(_))
        };
        if self.channels.iter().any(of_filters) {
            files.push("shared/net_filters");
        }
        files
    }

    /// The function that writes the channels of a pixel.
    fn writes(&self) -> String {
        let mut body = "    let seen = surface_valid(pixel);\n".to_owned();
        if self.channels.iter().any(|channel| channel.made_of().contains(&Attribute::Position)) {
            let position = planes(Attribute::Position);
            writeln!(body, "    let depth = select(0.0, -{position}[pixel + 2u * pixels], seen);")
                .expect("writing to a string");
        }
        for (index, channel) in (self.first..).zip(&self.channels) {
            let value = match channel {
                InputChannel::Everywhere(..) => channel.value(),
                _ => format!("select(0.0, {}, seen)", channel.value()),
            };
            writeln!(body, "    input[pixel + {index}u * pixels] = {value};").expect("writing to a string");
        }
        format!("\nfn write_channels(at: vec2u, pixel: u32, pixels: u32) {{\n{body}}}\n")
    }
}

impl InputChannel {
    /// The attributes that it is read from.
    fn reads(&self) -> &[Attribute] {
        match self {
            Self::Of(attribute, _) | Self::Everywhere(attribute, _) => std::slice::from_ref(attribute),
            _ => self.made_of(),
        }
    }

    /// The attributes that it is made of, where it is no attribute of a renderer's or a method's.
    const fn made_of(&self) -> &'static [Attribute] {
        match self {
            Self::Of(..) | Self::Everywhere(..) => &[],
            Self::Relief(_) => Attribute::Relief.made_of(),
            Self::PixelRadius => Attribute::PixelRadius.made_of(),
            Self::Border => Attribute::Border.made_of(),
            Self::SignedCircle => Attribute::SignedCircle.made_of(),
            Self::Movement(_) => Attribute::Movement.made_of(),
            Self::FreePathPixels(_) => Attribute::FreePathPixels.made_of(),
        }
    }

    /// Its value in WGSL where a surface is seen.
    fn value(self) -> String {
        match self {
            Self::Of(attribute, channel) | Self::Everywhere(attribute, channel) => {
                format!("{}{}", channel.factor("frame"), element(attribute, channel.component))
            }
            Self::Relief(level) => format!("relief({level}u, at, depth)"),
            Self::PixelRadius => "pixel_radius(depth)".to_owned(),
            Self::Border => "border(at, depth)".to_owned(),
            Self::SignedCircle => {
                let [blurriness, depth] =
                    [Attribute::Blurriness, Attribute::Depth].map(|of| element(of, Some(0)));
                format!("signed_circle({blurriness}, {depth})")
            }
            Self::Movement(component) => {
                let [direction, length] = [0, 1].map(|of| element(Attribute::Motion, Some(of)));
                format!("movement({direction}, {length})[{component}]")
            }
            Self::FreePathPixels(component) => {
                format!("logarithm_of_pixels({}, depth)", element(Attribute::MeanFreePath, component))
            }
        }
    }
}

/// A pixel's number in a plane of an attribute, or in that of the run's colour.
fn element(attribute: Attribute, component: Option<usize>) -> String {
    let plane = component.map_or_else(|| "frame.run".to_owned(), |c| format!("{c}u"));
    format!("{}[pixel + {plane} * pixels]", planes(attribute))
}

/// What an attribute's buffer is called.
fn planes(attribute: Attribute) -> String {
    match attribute {
        // As `shared/surface_valid` has it.
        Attribute::Valid => "valid_plane".to_owned(),
        _ => format!("{}_planes", attribute.name()),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::wgsl::convolution::Scale;
    use crate::wgsl::tests::{agrees, parse};
    use crate::wgsl::uniforms::NetFrame;

    fn passes() -> Vec<InputPass> {
        let channel = |component, scale, exponent| TextureChannel { component, scale, exponent };
        let of = |attribute, component, scale| InputChannel::Of(attribute, channel(component, scale, -3));
        let light = [
            of(Attribute::Light, None, Scale::Light),
            of(Attribute::Position, Some(2), Scale::Length),
            of(Attribute::Valid, Some(0), Scale::One),
        ];
        let made = [InputChannel::Relief(2), InputChannel::PixelRadius, InputChannel::Border];
        let filters =
            [InputChannel::SignedCircle, InputChannel::Movement(1), InputChannel::FreePathPixels(None)];
        let estimate = channel(Some(1), Scale::Light, 0);
        let filters = [&filters[..], &[InputChannel::Everywhere(Attribute::Estimate, estimate)]].concat();
        [&light[..], &made[..1], &made[1..], &[&light[..], &made].concat(), &filters]
            .map(|channels| InputPass { first: 5, channels: channels.to_vec() })
            .to_vec()
    }

    pub(crate) fn sources() -> Vec<String> {
        passes().iter().map(InputPass::source).collect()
    }

    #[test]
    fn every_pass_is_valid_and_binds_what_it_counts() {
        for pass in passes() {
            let source = pass.source();
            let module = parse(&source).map_err(|e| format!("{e}\n{source}")).expect("valid");
            assert_eq!(agrees(&NetFrame::LAYOUT, &module), Ok(()), "{source}");
            let is_storage = |space| matches!(space, naga::AddressSpace::Storage { .. });
            let bound = module.global_variables.iter().filter(|(_, variable)| is_storage(variable.space));
            assert_eq!(bound.count(), pass.buffers(), "{source}");
        }
    }

    #[test]
    fn positions_are_bound_once_and_valid_in_its_own_place() {
        let all = &passes()[3];
        assert_eq!(all.attributes(), [Attribute::Light, Attribute::Position]);
        assert_eq!(all.buffers(), 5);
    }
}
