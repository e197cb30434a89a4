//! What stands before and after a network: what [`InputPasses`](crate::forward::InputPasses) and
//! [`ImagePass`](crate::forward::ImagePass) do.

use crate::NetSpec;
use crate::forward::{image_pass, input_passes};
use crate::input::RELIEF_LEVELS;
use deepshade_shaders::Attribute;
use deepshade_shaders::host::{
    Extent, FrameNumber, HostBinding, HostBuffer, HostPart, HostPass, HostPasses, HostValue,
};
use deepshade_shaders::wgsl::TILE;
use deepshade_shaders::wgsl::net_input::{FIRST_ATTRIBUTE, SQUARES, VALID, WRITTEN};
use deepshade_shaders::wgsl::uniforms::NetFrame;

/// The passes that write a network's `input` of the buffers of attributes.
pub fn input(spec: &NetSpec) -> HostPasses {
    let mut all = HostPasses::default();
    let parts = input_passes::passes(spec, input_passes::MOST_BUFFERS);
    if parts.iter().any(|part| part.reads_squares()) {
        squares(spec, &mut all);
    }
    let mut attributes = vec![Attribute::Valid];
    for (index, part) in parts.iter().enumerate() {
        let mut pass = told(spec, HostPass::new(format!("input{index}"), part.source(), Extent::IMAGE, TILE))
            .bind(WRITTEN, HostBinding::written("input"))
            .bind(VALID, HostBinding::read(Attribute::Valid.name()));
        if part.reads_squares() {
            pass = pass.bind(SQUARES, HostBinding::written("squares"));
        }
        for (binding, attribute) in (FIRST_ATTRIBUTE..).zip(part.attributes()) {
            pass = pass.bind(binding, HostBinding::read(attribute.name()));
            attributes.push(attribute);
        }
        all.passes.push(HostPass { each_run: spec.runs() > 1, ..pass });
    }
    all.add_attributes(&attributes);
    all.add("input", HostBuffer::Made(vec![HostPart::floats(Extent::IMAGE, spec.input_channels())]));
    all
}

/// The sums over squares of pixels.
fn squares(spec: &NetSpec, all: &mut HostPasses) {
    let sources = input_passes::squares_sources();
    for (level, source) in sources.into_iter().enumerate() {
        let over = Extent::squares(RELIEF_LEVELS[level] as u32);
        let pass = HostPass::new(format!("squares{level}"), source, over, TILE);
        let mut pass = told(spec, pass).bind(SQUARES, HostBinding::written("squares"));
        if level == 0 {
            pass = pass.bind(VALID, HostBinding::read(Attribute::Valid.name()));
            pass = pass.bind(FIRST_ATTRIBUTE, HostBinding::read(Attribute::Position.name()));
        }
        all.passes.push(pass);
    }
    let part = |level: &usize| HostPart { over: Extent::squares(*level as u32), planes: 1, bytes: 8 };
    all.add("squares", HostBuffer::Made(RELIEF_LEVELS.iter().map(part).collect()));
}

/// The pass that makes the effect's `image` of the network's `output`.
pub fn image(spec: &NetSpec) -> HostPasses {
    let mut all = HostPasses::default();
    let source = image_pass::finished(spec).source();
    let pass = told(spec, HostPass::new("image", source, Extent::IMAGE, TILE))
        .bind(1, HostBinding::read("output"))
        .bind(2, HostBinding::written("image"))
        .bind(3, HostBinding::read(Attribute::Valid.name()));
    all.passes.push(HostPass { each_run: spec.runs() > 1, ..pass });
    all.add_attributes(&[Attribute::Valid]);
    all.add("image", HostBuffer::Made(vec![HostPart::floats(Extent::IMAGE, spec.effect.channels())]));
    all
}

/// A pass that is told of the frame.
fn told(spec: &NetSpec, pass: HostPass) -> HostPass {
    let radius = f64::from(spec.reach.radius);
    pass.told(&NetFrame::LAYOUT, |field| match field {
        "width" => HostValue::Columns(Extent::IMAGE),
        "height" => HostValue::Rows(Extent::IMAGE),
        "focal_length" => HostValue::Times(FrameNumber::FocalLength, 1.0),
        "radius" => HostValue::Times(FrameNumber::Radius, 1.0),
        "length_scale" => HostValue::Over(radius, FrameNumber::Radius),
        "light_scale" => HostValue::Times(FrameNumber::Exposure, 1.0),
        "run" => HostValue::Times(FrameNumber::Run, 1.0),
        other => unreachable!("a frame's field {other}"),
    })
}
