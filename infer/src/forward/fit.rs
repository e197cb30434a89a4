//! Whether an image's feature maps have room on a device, and in which tiles.

use super::maps;
use super::packing::BLOCK;
use super::room::{Room, SizedMap};
use super::{ForwardError, InputKind, Network, OutputKind, Precision, Variant};
use crate::Layer;

/// The maps of a network whose frame on level 0 has that size.
pub fn sized_maps(network: &Network, frame: [usize; 2]) -> Vec<SizedMap> {
    let sized = |map: maps::Map| SizedMap {
        blocks: map.channels.next_multiple_of(network.stages[map.born].outputs) / BLOCK,
        frame: frame.map(|size| size >> map.level),
        map,
    };
    maps::maps(&network.layers).into_iter().map(sized).collect()
}

/// Where they lie; none if one is beyond the device's limits.
pub fn room(network: &Network, maps: &[SizedMap]) -> Option<Room> {
    let scalar = match network.precision {
        Precision::F32 => 4,
        Precision::F16 => 2,
    };
    match network.variant {
        Variant::Software => Some(Room::in_textures(maps)),
        Variant::Gpu(_) => Room::in_arena(maps, scalar, &network.device.limits()),
    }
}

/// Whether a frame's feature maps are within the device's limits and that many bytes.
pub fn fits(network: &Network, frame: [usize; 2], bytes: u64) -> bool {
    let most = network.device.limits().max_texture_dimension_2d as usize;
    let textures = network.variant == Variant::Software;
    let maps = sized_maps(network, frame);
    !(textures && frame.into_iter().any(|size| size > most))
        && room(network, &maps).is_some_and(|room| room.bytes() <= bytes)
}

/// Checks what tiles cannot help.
pub fn check_size(network: &Network, height: usize, width: usize) -> Result<(), ForwardError> {
    let (limits, spec) = (network.device.limits(), &network.spec);
    let error =
        |layer: &Layer, reason| Err(ForwardError::Size { width, height, layer: layer.name.clone(), reason });
    let (first, last) = (&network.layers[0], &network.layers[network.layers.len() - 1]);
    if height == 0 || width == 0 {
        return error(first, "has no pixel to read".to_owned());
    }
    let buffers = [network.input == InputKind::Buffer, network.output == OutputKind::Buffer];
    let ends = [(first, spec.input_channels()), (last, spec.output_channels())];
    for (layer, channels) in ends.into_iter().zip(buffers).filter(|(_, buffer)| *buffer).map(|(end, _)| end) {
        let bytes = (channels as u64) * (height as u64) * (width as u64) * size_of::<f32>() as u64;
        let limit = limits.max_storage_buffer_binding_size;
        if bytes > limit {
            return error(layer, format!("binds a buffer of {bytes} bytes; the device allows {limit}"));
        }
    }
    Ok(())
}
