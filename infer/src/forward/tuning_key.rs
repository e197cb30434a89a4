//! What a measured time is of: a layer's kernels on images of about a size.

use super::maps::has_means;
use super::stage::software_source;
use super::variant::shapes;
use super::{Options, OutputKind, Precision, kernel};
use crate::{NetSpec, Source};

/// Every layer in words: all that its kernels' times depend on. Its size counts by its power of two, rounded: kernels that
/// are fastest on a small image need not be on a large one. The sources stand for themselves by their hash, so that times
/// of older ones are not taken for theirs.
pub fn keys(
    spec: &NetSpec,
    precision: Precision,
    [height, width]: [usize; 2],
    workgroup_bytes: u32,
) -> Vec<String> {
    let layers = spec.layers();
    let key = |(index, layer): (usize, &crate::Layer)| {
        let source = match layer.source {
            Source::Input => "input",
            Source::Plain(_) => "map",
            Source::Pooled(_) => "means",
            Source::Joined { .. } => "joined",
        };
        let kept = match layer.activation {
            true if has_means(&layers, index) => "map and means",
            true => "map",
            false => "image",
        };
        let power = ((height * width) as f64).log2().round();
        format!(
            "{source} {} to {kept} {}, {} groups {:?}, kernel {}, {precision:?}, level {} of 2^{power} pixels, {}",
            layer.inputs,
            layer.outputs,
            layer.groups,
            spec.channel_order,
            spec.kernel,
            layer.level,
            sources(spec, index, precision, workgroup_bytes)
        )
    };
    layers.iter().enumerate().map(key).collect()
}

/// A hash of the sources of all kernels that a layer may have, from buffers to buffers.
fn sources(spec: &NetSpec, index: usize, precision: Precision, workgroup_bytes: u32) -> String {
    let options = Options { precision, ..Options::default() };
    let mut hasher = blake3::Hasher::new();
    hasher.update(software_source(spec, &spec.layers()[index]).as_bytes());
    for shape in shapes(spec, index, OutputKind::Buffer, workgroup_bytes) {
        let kernel = kernel::convolution(spec, index, shape, &options).expect("an image goes into a buffer");
        hasher.update(kernel.source().as_bytes());
    }
    hasher.finalize().to_hex()[..16].to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ChannelOrder, Reach};

    const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
    const ROOM: u32 = 1 << 14;

    #[test]
    fn what_decides_a_time_is_in_the_key() {
        let spec = NetSpec { levels: 3, ..NetSpec::ao(ChannelOrder::Interleaved, REACH) };
        let key = |spec: &NetSpec, precision, size, room| keys(spec, precision, size, room).swap_remove(1);
        let one = key(&spec, Precision::F32, [512, 768], ROOM);
        assert_eq!(one, key(&spec, Precision::F32, [500, 800], ROOM), "about as large");
        let kernel = NetSpec { kernel: 5, ..spec.clone() };
        let others = [
            key(&spec, Precision::F32, [2160, 3840], ROOM),
            key(&spec, Precision::F32, [1080, 1920], ROOM),
            key(&spec, Precision::F16, [512, 768], ROOM),
            key(&kernel, Precision::F32, [512, 768], ROOM),
        ];
        others.iter().for_each(|other| assert_ne!(one, *other));
    }

    #[test]
    fn other_sources_have_another_hash() {
        let spec = NetSpec { levels: 3, ..NetSpec::ao(ChannelOrder::Interleaved, REACH) };
        let hash = |index, precision, room| sources(&spec, index, precision, room);
        let one = hash(1, Precision::F32, ROOM);
        assert_eq!(one, hash(1, Precision::F32, ROOM));
        for other in
            [hash(0, Precision::F32, ROOM), hash(1, Precision::F16, ROOM), hash(1, Precision::F32, 0)]
        {
            assert_ne!(one, other);
        }
    }
}
