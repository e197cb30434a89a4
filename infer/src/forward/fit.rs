//! Whether an image's feature maps, and what a head works on, have room on a device, and in which tiles.

use super::map_layout::{MapLayout, SizedMap};
use super::maps;
use super::packing::BLOCK;
use super::tiles::Tiling;
use super::{ForwardError, InputKind, Network, OutputKind, Precision, Variant};
use crate::Layer;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::TILE;

/// Bytes of feature maps with which it is no use to go on where a device has no memory left.
const LEAST: u64 = 1 << 20;

/// The largest tiles of an image of `[height, width]` with which all takes at most that many bytes and for
/// which `make` gets memory for their frame, maps and layout, and what it makes. Where the device has too
/// little left, half as much is tried.
///
/// # Errors
/// If no tile is small enough, the device has not even memory for a mebibyte, or it refuses for another
/// reason.
pub fn largest<T>(
    network: &Network,
    size: [usize; 2],
    mut limit: u64,
    mut make: impl FnMut([usize; 2], Vec<SizedMap>, MapLayout) -> Result<T, GpuError>,
) -> Result<(Tiling, T), ForwardError> {
    loop {
        let [height, width] = size;
        let too_little = ForwardError::Memory { width, height, limit };
        let Some(tiling) = Tiling::new(&network.spec, size, |frame| fits(network, size, frame, limit)) else {
            return Err(too_little);
        };
        let maps = sized_maps(network, tiling.frame);
        let layout = layout(network, &maps).ok_or(too_little)?;
        let half = bytes(network, size, tiling.frame, &layout) / 2;
        match make(tiling.frame, maps, layout) {
            Err(GpuError::Memory { .. }) if half >= LEAST => limit = half,
            made => return Ok((tiling, made?)),
        }
    }
}

/// The maps of a network whose frame on level 0 has that size.
pub fn sized_maps(network: &Network, frame: [usize; 2]) -> Vec<SizedMap> {
    let sized = |map: maps::Map| SizedMap {
        blocks: map.channels.next_multiple_of(network.device_layers[map.born].outputs) / BLOCK,
        frame: frame.map(|size| size >> map.level),
        map,
    };
    maps::maps(&network.layers).into_iter().map(sized).collect()
}

/// Where they lie; none if one is beyond the device's limits.
pub fn layout(network: &Network, maps: &[SizedMap]) -> Option<MapLayout> {
    let scalar = match network.precision {
        Precision::F32 => 4,
        Precision::F16 => 2,
    };
    match network.variant {
        Variant::Software => Some(MapLayout::in_textures(maps)),
        Variant::Gpu(_) => MapLayout::in_arena(maps, scalar, &network.device.limits()),
    }
}

/// Bytes of an image's run in tiles of that frame, whose maps lie so.
fn bytes(network: &Network, size: [usize; 2], frame: [usize; 2], layout: &MapLayout) -> u64 {
    let [kernels, pyramid] = head_bytes(network, size, frame);
    layout.bytes() + kernels + pyramid
}

/// Of those the ones of a head: of a tile's kernels, and of the image's pyramid.
fn head_bytes(network: &Network, size: [usize; 2], frame: [usize; 2]) -> [u64; 2] {
    network.head.as_ref().map_or([0; 2], |passes| passes.bytes(&network.spec, frame, size))
}

/// Whether an image can be run in tiles of a frame, within the device's limits and that many bytes.
pub fn fits(network: &Network, size: [usize; 2], frame: [usize; 2], most: u64) -> bool {
    let limits = network.device.limits();
    let textures = network.variant == Variant::Software;
    let side = limits.max_texture_dimension_2d as usize;
    let [kernels, _] = head_bytes(network, size, frame);
    let maps = sized_maps(network, frame);
    !(textures && frame.into_iter().any(|size| size > side))
        && dispatches(&limits, frame)
        && kernels <= limits.max_storage_buffer_binding_size
        && layout(network, &maps).is_some_and(|layout| bytes(network, size, frame, &layout) <= most)
}

/// Whether a device dispatches enough workgroups for a frame; no pass has any that make fewer than [`TILE`]
/// pixels along an axis.
fn dispatches(limits: &wgpu::Limits, frame: [usize; 2]) -> bool {
    frame
        .into_iter()
        .all(|size| size.div_ceil(TILE as usize) <= limits.max_compute_workgroups_per_dimension as usize)
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
    let bytes = |channels: usize| (channels * height * width * size_of::<f32>()) as u64;
    let [_, pyramid] = head_bytes(network, [height, width], [0; 2]);
    let buffers = [
        (first, bytes(spec.input_channels()), network.input == InputKind::Buffer),
        (last, bytes(spec.output_channels()), network.output == OutputKind::Buffer),
        (last, pyramid, network.head.is_some()),
    ];
    let limit = limits.max_storage_buffer_binding_size;
    let mut bound = buffers.into_iter().filter(|(_, _, is_bound)| *is_bound);
    if let Some((layer, bytes, _)) = bound.find(|(_, bytes, _)| *bytes > limit) {
        return error(layer, format!("binds a buffer of {bytes} bytes; the device allows {limit}"));
    }
    // The pyramid is not made in tiles.
    if network.head.is_some() && !dispatches(&limits, [height, width]) {
        return error(last, "has more pixels along an axis than the device dispatches".to_owned());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ChannelOrder, NetSpec, Reach, Weights};
    use deepshade_shaders::Effect;
    use deepshade_shaders::gpu::Gpu;

    const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

    fn network(variant: Option<Variant>) -> Network {
        let gpu = Gpu::new().expect("an adapter; a software one will do");
        let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH).reshaped(|net| net.levels = 2);
        let variant =
            variant.unwrap_or_else(|| Variant::gpu(&gpu.device.limits(), &spec, OutputKind::Buffer));
        let options = crate::forward::Options { variant: Some(variant), ..Default::default() };
        Network::with(&gpu.device, &spec, &Weights::random(&spec, 1), &options).expect("compiles")
    }

    /// What a device gives that has so many bytes left.
    fn with_left(
        left: u64,
        tried: &mut Vec<u64>,
    ) -> impl FnMut([usize; 2], Vec<SizedMap>, MapLayout) -> Result<u64, GpuError> {
        move |_, _, layout| {
            let bytes = layout.bytes();
            tried.push(bytes);
            let label = "maps".to_owned();
            if bytes <= left { Ok(bytes) } else { Err(GpuError::Memory { label, bytes }) }
        }
    }

    #[test]
    fn less_is_tried_until_the_device_has_it() {
        for network in [network(Some(Variant::Software)), network(None)] {
            let mut tried = Vec::new();
            let (whole, bytes) =
                largest(&network, [600, 900], u64::MAX, with_left(1 << 40, &mut tried)).expect("fits");
            assert_eq!((whole.tiles.len(), &tried[..]), (1, &[bytes][..]));
            let mut tried = Vec::new();
            let (tiling, taken) =
                largest(&network, [600, 900], u64::MAX, with_left(bytes / 3, &mut tried)).expect("in tiles");
            assert!(tiling.tiles.len() > 1 && taken <= bytes / 3);
            assert!(tried[0] == bytes && tried.windows(2).all(|two| two[1] <= two[0] / 2), "{tried:?}");
        }
    }

    #[test]
    fn predicted_kernels_have_room_within_the_limits_of_webgpu() {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
        let device = adapter.expect("an adapter");
        let device = pollster::block_on(device.request_device(&wgpu::DeviceDescriptor::default()));
        let (device, _) = device.expect("a device of WebGPU's limits");
        let dof = NetSpec::published(Effect::Dof, ChannelOrder::Interleaved, REACH).expect("it has one");
        let spec = dof.predicting_kernels().expect("it reads light");
        for size in [[2160, 3840], [1080, 1920]] {
            let variant = Some(Variant::gpu(&device.limits(), &spec, OutputKind::Buffer));
            let options =
                crate::forward::Options { variant, input: InputKind::Textures, ..Default::default() };
            let network =
                Network::with(&device, &spec, &Weights::random(&spec, 1), &options).expect("compiles");
            check_size(&network, size[0], size[1]).expect("no buffer of the whole image is too large");
            let most = 400_000_000;
            let mut taken = 0;
            let make = |frame, _, layout: MapLayout| {
                taken = bytes(&network, size, frame, &layout);
                Ok(())
            };
            let (tiling, ()) = largest(&network, size, most, make).expect("in tiles");
            let [kernels, _] = head_bytes(&network, size, tiling.frame);
            assert!(tiling.tiles.len() > 1 && taken <= most);
            assert!(kernels <= device.limits().max_storage_buffer_binding_size);
        }
    }

    #[test]
    fn a_frame_beyond_what_a_device_dispatches_is_cut() {
        let network = network(None);
        let most = network.device.limits().max_compute_workgroups_per_dimension as usize;
        let width = 2 * most * TILE as usize;
        let (tiling, _) =
            largest(&network, [1, width], u64::MAX, with_left(1 << 40, &mut Vec::new())).expect("in tiles");
        assert!(tiling.tiles.len() > 1 && tiling.frame[1].div_ceil(TILE as usize) <= most);
    }

    #[test]
    fn a_device_without_memory_is_an_error_before_long() {
        let network = network(None);
        let mut tried = Vec::new();
        let error = largest(&network, [600, 900], u64::MAX, with_left(0, &mut tried)).expect_err("no memory");
        assert!(matches!(error, ForwardError::Gpu(GpuError::Memory { .. })), "{error}");
        assert!((2..8).contains(&tried.len()) && tried.last() < Some(&(2 * LEAST)), "{tried:?}");
        let refuse = |_, _, _| -> Result<(), GpuError> {
            Err(GpuError::Refused { label: "maps".to_owned(), what: "for another reason".to_owned() })
        };
        let error = largest(&network, [600, 900], u64::MAX, refuse).expect_err("not memory");
        assert!(error.to_string().contains("for another reason"), "{error}");
    }
}
