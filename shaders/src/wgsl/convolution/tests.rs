//! naga accepts every kernel, and lays its memory out as Rust counts it.

use super::*;
use crate::wgsl::tests::{agrees, parse};
use crate::wgsl::uniforms::NetLayer;

/// Every kernel that a network may ask for.
fn all() -> Vec<Convolution> {
    let channel = |component, scale, exponent| TextureChannel { component, scale, exponent };
    let textures = vec![
        [0, 1, 2].map(|component| channel(Some(component), Scale::Length, 0)).to_vec(),
        vec![channel(None, Scale::Light, 0)],
        vec![channel(None, Scale::Length, 5)],
        vec![channel(Some(0), Scale::One, 0), channel(Some(1), Scale::One, -3)],
    ];
    let readings = [Reading::Planes, Reading::Textures(textures), Reading::Map, Reading::Joined];
    let writings = [
        Writing::Map,
        Writing::MapAndMeans,
        Writing::Planes,
        Writing::Texture("r32float"),
        Writing::Texture("rgba16float"),
    ];
    let mut all = Vec::new();
    for (reading, writing) in readings.iter().flat_map(|r| writings.iter().map(move |w| (r, w))) {
        let outputs: &[u32] = match writing {
            Writing::Map | Writing::MapAndMeans => &[4, 8, 16],
            Writing::Planes => &[1, 4, 8, 16],
            Writing::Texture(_) => &[1, 4],
        };
        for (outputs, pixels) in outputs.iter().flat_map(|o| [[2, 1], [2, 2], [4, 2]].map(|p| (*o, p))) {
            for (staged, half, kernel) in
                [(true, false, 3), (false, true, 5), (true, true, 1), (false, false, 7)]
            {
                let shape = Shape { outputs, pixels, staged };
                let (reading, writing) = (reading.clone(), *writing);
                let (pools, arena) = (writing == Writing::MapAndMeans, half != staged);
                if !pools || (pixels[1] == 2 && reading != Reading::Joined) {
                    let is_input = matches!(reading, Reading::Planes | Reading::Textures(_));
                    let folded = (is_input && half).then_some(3);
                    all.push(Convolution { kernel, shape, half, arena, reading, folded, writing });
                }
            }
        }
    }
    all
}

pub(crate) fn sources() -> Vec<String> {
    all().iter().map(Convolution::source).collect()
}

#[test]
fn every_kernel_is_valid_and_reads_the_layer_as_rust_wrote_it() {
    for kernel in all() {
        let module = parse(&kernel.source()).map_err(|e| format!("{kernel:?}: {e}")).expect("valid");
        assert_eq!(module.entry_points.len(), 1, "{kernel:?}");
        assert_eq!(agrees(&NetLayer::LAYOUT, &module), Ok(()), "{kernel:?}");
    }
}

#[test]
fn only_maps_in_one_buffer_are_read_from_a_buffer_that_is_written() {
    let shape = Shape { outputs: 4, pixels: [2, 2], staged: true };
    for (reading, maps) in [(Reading::Map, 1), (Reading::Joined, 2)] {
        for arena in [true, false] {
            let (reading, writing) = (reading.clone(), Writing::Map);
            let source =
                Convolution { kernel: 3, shape, half: false, arena, reading, folded: None, writing }.source();
            let written = if arena { maps + 1 } else { 1 };
            assert_eq!(source.matches("var<storage, read_write>").count(), written, "{source}");
        }
    }
}

#[test]
fn workgroup_memory_is_what_the_kernel_declares() {
    for kernel in all() {
        let module = parse(&kernel.source()).expect("valid");
        let mut layouter = naga::proc::Layouter::default();
        layouter.update(module.to_ctx()).expect("types have a size");
        let shared = |v: &naga::GlobalVariable| v.space == naga::AddressSpace::WorkGroup;
        let variables = module.global_variables.iter().filter(|(_, v)| shared(v));
        let bytes: u32 = variables.map(|(_, v)| layouter[v.ty].size).sum();
        assert_eq!(bytes, kernel.workgroup_bytes(), "{kernel:?}");
    }
}
