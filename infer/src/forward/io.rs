//! What a network reads from the caller and writes for the caller.

use super::ForwardError;
use crate::input::channel_unit;
use crate::{Colour, NetSpec, Scaling};
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::convolution::{FIRST_TEXTURE, TextureChannel};
use deepshade_shaders::{Attribute, AttributeKind, Channel};
use wgpu::BindingResource;

/// Where a network's input is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InputKind {
    /// In a buffer.
    #[default]
    Buffer,
    /// In textures.
    Textures,
}

/// Where a network's image goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OutputKind {
    /// Into a buffer.
    #[default]
    Buffer,
    /// Into a texture of that format: `R32Float` for one channel, `Rgba16Float` or `Rgba32Float` for up to
    /// four.
    Texture(wgpu::TextureFormat),
}

/// A network's input.
#[derive(Clone, Copy, Debug)]
pub enum Input<'a> {
    /// A storage buffer, planar `[input channels, height, width]` f32: what [`NetSpec::input`] makes of a
    /// g-buffer, or a pass of the caller's that does the same: every channel multiplied by its
    /// [`NetSpec::factor`], and 0 where no surface is seen but for what is read
    /// [everywhere](NetSpec::is_everywhere).
    Buffer(&'a wgpu::Buffer),
    /// The g-buffer itself.
    Textures {
        /// A texture for each of [`NetSpec::inputs`], in their order: its channels are the first components.
        /// Any float format that can be sampled, such as `Rgba16Float` or `Rgba32Float`; no filtering is
        /// needed. A view shows mip 0, which has at least the image's rows and columns; what lies beyond
        /// these is not read.
        ///
        /// Every channel must be 0 where no surface is seen, but for what is read
        /// [everywhere](NetSpec::is_everywhere): lengths and light are scaled as they are read,
        /// but nothing tells the network which pixels those are. A g-buffer that holds something else there
        /// is cleared by its owner.
        views: &'a [wgpu::TextureView],
        /// What lengths and light are multiplied by as they are read. The image is that of scaled light: who
        /// uses it divides by [`Scaling::light`].
        scaling: Scaling,
        /// Which of [`NetSpec::runs`], and so which colour channel a mono network reads.
        run: usize,
    },
}

/// A network's image. What it makes where no surface is seen means nothing, if the effect has a background;
/// [`NetSpec::set_background`], or the caller's own pass, puts the effect's
/// [`background`](deepshade_shaders::Effect::background) there.
#[derive(Clone, Copy, Debug)]
pub enum Output<'a> {
    /// A storage buffer, planar `[output channels, height, width]` f32.
    Buffer(&'a wgpu::Buffer),
    /// A storage texture, of which the view shows mip 0, with at least the image's rows and columns.
    /// Components that the image has not are 0, alpha 1.
    Texture(&'a wgpu::TextureView),
}

impl OutputKind {
    /// The format's name in WGSL.
    ///
    /// # Errors
    /// If the network's image does not go into such a texture.
    pub(super) fn format(self, spec: &NetSpec) -> Result<Option<&'static str>, ForwardError> {
        use wgpu::TextureFormat::{R32Float, Rgba16Float, Rgba32Float};
        match self {
            Self::Buffer => Ok(None),
            Self::Texture(R32Float) if spec.output_channels() == 1 => Ok(Some("r32float")),
            Self::Texture(Rgba16Float) => Ok(Some("rgba16float")),
            Self::Texture(Rgba32Float) => Ok(Some("rgba32float")),
            Self::Texture(format) => Err(refused(
                "output",
                format!("an image of {} channels does not go into {format:?}", spec.output_channels()),
            )),
        }
    }
}

impl Input<'_> {
    /// Checks that it is what a network of that kind reads.
    pub(super) fn check(
        &self,
        spec: &NetSpec,
        kind: InputKind,
        size: [usize; 2],
    ) -> Result<(), ForwardError> {
        match (self, kind) {
            (Self::Buffer(buffer), InputKind::Buffer) => {
                check_buffer("input", buffer, spec.input_channels(), size)
            }
            (Self::Textures { run, .. }, InputKind::Textures) if *run >= spec.runs() => {
                Err(refused("input", format!("run {run} of {}", spec.runs())))
            }
            (Self::Textures { views, .. }, InputKind::Textures) => {
                if views.len() != spec.inputs.len() {
                    let what = format!("{} textures; the network reads {}", views.len(), spec.inputs.len());
                    return Err(refused("input", what));
                }
                views.iter().try_for_each(|view| check_texture("input", view, size))
            }
            _ => Err(refused("input", format!("the network was made for {kind:?}"))),
        }
    }
}

impl<'a> Input<'a> {
    /// What lengths and light are multiplied by as they are read, and which run reads.
    pub(super) const fn scaling(&self) -> (Scaling, u32) {
        match self {
            Self::Buffer(_) => (Scaling { length: 1.0, light: 1.0 }, 0),
            Self::Textures { scaling, run, .. } => (*scaling, *run as u32),
        }
    }

    /// What a pass that reads it binds, and where.
    pub(super) fn bindings(&self) -> Vec<(u32, BindingResource<'a>)> {
        match self {
            Self::Buffer(buffer) => vec![(4, buffer.as_entire_binding())],
            Self::Textures { views, .. } => {
                (FIRST_TEXTURE..).zip(views.iter().map(BindingResource::TextureView)).collect()
            }
        }
    }
}

impl<'a> Output<'a> {
    /// What a pass that writes it binds.
    pub(super) fn binding(&self) -> BindingResource<'a> {
        match self {
            Self::Buffer(buffer) => buffer.as_entire_binding(),
            Self::Texture(view) => BindingResource::TextureView(view),
        }
    }
}

impl Output<'_> {
    /// Checks that it is what a network of that kind writes.
    pub(super) fn check(
        &self,
        spec: &NetSpec,
        kind: OutputKind,
        size: [usize; 2],
    ) -> Result<(), ForwardError> {
        match (self, kind) {
            (Self::Buffer(buffer), OutputKind::Buffer) => {
                check_buffer("output", buffer, spec.output_channels(), size)
            }
            (Self::Texture(view), OutputKind::Texture(format)) if view.texture().format() == format => {
                check_texture("output", view, size)
            }
            _ => Err(refused("output", format!("the network was made for {kind:?}"))),
        }
    }
}

/// What a network reads of each of its textures, or of the buffers of its attributes.
pub(super) fn texture_channels(spec: &NetSpec) -> Vec<Vec<TextureChannel>> {
    let read = |channel: Channel, component| {
        let unit = channel_unit(&channel);
        TextureChannel { component, scale: unit.scale, exponent: unit.exponent }
    };
    let channels = |attribute: &Attribute| match (spec.colour, attribute.kind()) {
        (Colour::Mono, AttributeKind::Colour) => {
            vec![read(Channel { attribute: *attribute, component: 0 }, None)]
        }
        _ => attribute.channels().map(|channel| read(channel, Some(channel.component))).collect(),
    };
    spec.inputs.iter().map(channels).collect()
}

/// Checks that a buffer has room for so many planes.
pub(super) fn check_buffer(
    label: &str,
    buffer: &wgpu::Buffer,
    channels: usize,
    [height, width]: [usize; 2],
) -> Result<(), ForwardError> {
    let needed = (channels * height * width * size_of::<f32>()) as u64;
    match buffer.size() < needed {
        true => Err(refused(label, format!("a buffer of {} bytes; {needed} are needed", buffer.size()))),
        false => Ok(()),
    }
}

fn check_texture(label: &str, view: &wgpu::TextureView, size: [usize; 2]) -> Result<(), ForwardError> {
    let found = [view.texture().height() as usize, view.texture().width() as usize];
    match found[0] < size[0] || found[1] < size[1] {
        true => Err(refused(label, format!("a texture of {found:?} rows and columns; {size:?} are needed"))),
        false => Ok(()),
    }
}

/// Something of the caller's that will not do.
pub(super) fn refused(label: &str, what: String) -> ForwardError {
    GpuError::Refused { label: format!("deepshade.net.{label}"), what }.into()
}
