//! Which kernel a layer has on a GPU: a function of the spec and of what the caller wants, without a device.

use super::head;
use super::io::{self, InputKind};
use super::maps::has_means;
use super::packing::BLOCK;
use super::{ForwardError, Options, Precision};
use crate::{BlockSource, Layer, NetSpec};
use deepshade_shaders::wgsl::convolution::{Convolution, Reading, Shape, Writing};

/// The kernel of the layer of that index, of that shape; its weights are
/// [`Packed`](super::packing::Packed) for as many outputs at a time.
///
/// # Errors
/// If the network's image does not go into such a texture.
pub fn convolution(
    spec: &NetSpec,
    index: usize,
    shape: Shape,
    options: &Options<'_>,
) -> Result<Convolution, ForwardError> {
    let layers = spec.layers();
    Ok(Convolution {
        kernel: layers[index].kernel as u32,
        shape,
        half: options.precision == Precision::F16,
        arena: true,
        reading: reading(spec, &layers[index], options),
        folded: folded(spec, &layers[index]),
        writing: writing(spec, &layers, index, options)?,
    })
}

fn reading(spec: &NetSpec, layer: &Layer, options: &Options<'_>) -> Reading {
    match (layer.source, options.input) {
        (BlockSource::Input | BlockSource::Folded, InputKind::Buffer) => Reading::Planes,
        (BlockSource::Input | BlockSource::Folded, InputKind::Textures) => {
            Reading::Textures(io::texture_channels(spec))
        }
        (BlockSource::Plain(_) | BlockSource::Pooled(_), _) => Reading::Map,
        (BlockSource::Joined { .. }, _) => Reading::Joined,
    }
}

/// Blocks of four channels of the network's input, where a layer reads it space to depth.
fn folded(spec: &NetSpec, layer: &Layer) -> Option<u32> {
    (layer.source == BlockSource::Folded).then(|| spec.input_channels().div_ceil(BLOCK) as u32)
}

fn writing(
    spec: &NetSpec,
    layers: &[Layer],
    index: usize,
    options: &Options<'_>,
) -> Result<Writing, ForwardError> {
    let format = options.output.format(spec)?.filter(|_| head::of(spec).is_none());
    Ok(match (layers[index].activation, format) {
        (true, _) if has_means(layers, index) => Writing::MapAndMeans,
        (true, _) => Writing::Map,
        (false, None) => Writing::Planes,
        (false, Some(format)) => Writing::Texture(format),
    })
}
