//! What a measured time is of: a layer's kernels on images of about a size.

use super::device_layer::software_source;
use super::head;
use super::maps::has_means;
use super::variant::shapes;
use super::{Options, OutputKind, Precision, kernel};
use crate::{BlockSource, NetSpec};

/// Every layer in words: all that its kernels' times depend on. Its size counts by its power of two, rounded:
/// kernels that are fastest on a small image need not be on a large one. The sources and the device's limits
/// stand for themselves by their hash, so that what was measured of others is not taken for theirs.
pub fn keys(
    spec: &NetSpec,
    precision: Precision,
    [height, width]: [usize; 2],
    limits: &wgpu::Limits,
) -> Vec<String> {
    let layers = spec.layers();
    let key = |(index, layer): (usize, &crate::Layer)| {
        let source = match layer.source {
            BlockSource::Input => "input",
            BlockSource::Folded => "folded input",
            BlockSource::Plain(_) => "map",
            BlockSource::Pooled(_) => "means",
            BlockSource::Joined { .. } => "joined",
        };
        let kept = match layer.activation {
            true if has_means(&layers, index) => "map and means",
            true => "map",
            false if head::of(spec).is_some() => "kernels and image",
            false => "image",
        };
        let power = ((height * width) as f64).log2().round();
        let joined = match layer.source {
            BlockSource::Joined { groups, .. } => groups,
            _ => 1,
        };
        format!(
            "{source} {} to {kept} {}, {} groups joined in {}, kernel {}, {precision:?}, level {} of 2^{power} pixels, {}",
            layer.inputs,
            layer.outputs,
            layer.groups,
            joined,
            layer.kernel,
            layer.level,
            hash(spec, index, precision, limits)
        )
    };
    layers.iter().enumerate().map(key).collect()
}

/// What stands for a whole network whose layers have these keys.
pub fn network_key(layers: &[String]) -> String {
    short(&blake3::hash(layers.join("\n").as_bytes()))
}

/// A hash of the sources of all kernels that a layer may have, from buffers to buffers, and of a device's
/// limits.
fn hash(spec: &NetSpec, index: usize, precision: Precision, limits: &wgpu::Limits) -> String {
    let options = Options { precision, ..Options::default() };
    let mut hasher = blake3::Hasher::new();
    hasher.update(format!("{limits:?}").as_bytes());
    hasher.update(software_source(spec, &spec.layers()[index]).as_bytes());
    for shape in shapes(spec, index, OutputKind::Buffer, limits.max_compute_workgroup_storage_size) {
        let kernel = kernel::convolution(spec, index, shape, &options).expect("an image goes into a buffer");
        hasher.update(kernel.source().as_bytes());
    }
    short(&hasher.finalize())
}

fn short(hash: &blake3::Hash) -> String {
    hash.to_hex()[..16].to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ChannelOrder, Reach};

    const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
    #[test]
    fn what_decides_a_time_is_in_the_key() {
        let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH).reshaped(|net| net.levels = 3);
        let limits = wgpu::Limits::default();
        let key = |spec: &NetSpec, precision, size| keys(spec, precision, size, &limits).swap_remove(1);
        let one = key(&spec, Precision::F32, [512, 768]);
        assert_eq!(one, key(&spec, Precision::F32, [500, 800]), "about as large");
        let kernel = spec.clone().reshaped(|net| net.kernel = 5);
        let others = [
            key(&spec, Precision::F32, [2160, 3840]),
            key(&spec, Precision::F32, [1080, 1920]),
            key(&spec, Precision::F16, [512, 768]),
            key(&kernel, Precision::F32, [512, 768]),
        ];
        others.iter().for_each(|other| assert_ne!(one, *other));
    }

    #[test]
    fn other_sources_and_limits_have_another_hash() {
        let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH).reshaped(|net| net.levels = 3);
        let limits = wgpu::Limits::default();
        let hash = |index, precision, limits| hash(&spec, index, precision, limits);
        let one = hash(1, Precision::F32, &limits);
        assert_eq!(one, hash(1, Precision::F32, &limits));
        let fewer = wgpu::Limits { max_storage_buffers_per_shader_stage: 4, ..limits.clone() };
        for other in [
            hash(0, Precision::F32, &limits),
            hash(1, Precision::F16, &limits),
            hash(1, Precision::F32, &fewer),
        ] {
            assert_ne!(one, other);
        }
    }

    #[test]
    fn a_network_is_all_of_its_layers() {
        let network = |levels| {
            let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH).reshaped(|net| net.levels = levels);
            let keys = keys(&spec, Precision::F32, [512, 768], &wgpu::Limits::default());
            (keys[0].clone(), network_key(&keys))
        };
        let ((first, three), (same, four)) = (network(3), network(4));
        assert!(first == same && three != four);
    }
}
