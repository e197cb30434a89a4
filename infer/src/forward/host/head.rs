//! The passes of a network's [`Head`](crate::Head).

use super::{LayerTold, frame};
use crate::NetSpec;
use crate::forward::head;
use deepshade_shaders::host::{Extent, HostBinding, HostBuffer, HostPart, HostPass, HostPasses, HostValue};
use deepshade_shaders::wgsl::TILE;
use deepshade_shaders::wgsl::convolution::{Reading, Writing};
use deepshade_shaders::wgsl::uniforms::NetLayer;

/// The passes that make `output` of `kernels`, which the last block makes, and of the network's input.
pub fn passes(spec: &NetSpec) -> HostPasses {
    let mut all = HostPasses::default();
    let Some(head) = head::of(spec) else { return all };
    let inputs = HostValue::Constant(spec.input_channels() as f64);
    let none = HostValue::Constant(0.0);
    let told = |level, channels, stride| LayerTold {
        over: frame(spec, level),
        image: Extent::IMAGE,
        channels,
        stride,
        leak: spec.leak,
    };
    let pass = |name: String, source, told: &LayerTold| {
        HostPass::new(name, source, told.over, TILE).told(&NetLayer::LAYOUT, |field| told.value(field))
    };
    // Rows and columns of what the last block makes.
    let last = frame(spec, spec.last_level());
    let image = told(0, HostValue::Rows(last), HostValue::Columns(last));
    let mut image = pass("output".to_owned(), head.image(Writing::Planes), &image)
        .bind(1, HostBinding::read("kernels"))
        .bind(3, HostBinding::written("output"));
    if head.has_pyramid() {
        let light = pass("light".to_owned(), head.light(&Reading::Planes), &told(0, inputs, none))
            .bind(3, HostBinding::written("pyramid"))
            .bind(4, HostBinding::read("input"));
        all.passes.push(light);
        for level in 1..head.levels {
            let halve = pass(format!("light{level}"), head.halve(level), &told(level as usize, inputs, none));
            all.passes.push(halve.bind(3, HostBinding::written("pyramid")));
        }
        image = image.bind(2, HostBinding::read("pyramid"));
        all.add("pyramid", HostBuffer::Made(pyramid(spec, &head)));
    }
    all.passes.push(image);
    all.add("kernels", HostBuffer::Made(vec![HostPart::floats(last, spec.last_channels())]));
    all
}

/// The estimate, and level after level.
fn pyramid(spec: &NetSpec, head: &deepshade_shaders::wgsl::head::Head) -> Vec<HostPart> {
    let levels =
        (0..head.levels as usize).map(|level| HostPart::floats(frame(spec, level), head.channels as usize));
    let estimate =
        (head.estimates() > 0).then(|| HostPart::floats(frame(spec, 0), head.estimates() as usize));
    estimate.into_iter().chain(levels).collect()
}
