//! The passes of a network as files have them: what a [`Plan`](super::Plan) and the passes around it bind on
//! a device, in terms of any frame.

mod around;
mod head;
mod layers;

pub use around::{image, input};
pub use layers::network;

use crate::NetSpec;
use deepshade_shaders::host::{Extent, HostValue};

/// The frame of a level of the network.
fn frame(spec: &NetSpec, level: usize) -> Extent {
    Extent { align: spec.alignment(), shift: level as u32 }
}

/// What a field of [`NetLayer`](deepshade_shaders::wgsl::uniforms::NetLayer) holds in a pass over an extent
/// that works on the whole of an image's extent.
struct LayerTold {
    over: Extent,
    image: Extent,
    channels: HostValue,
    stride: HostValue,
    leak: f32,
}

impl LayerTold {
    fn value(&self, field: &str) -> HostValue {
        match field {
            "width" => HostValue::Columns(self.over),
            "height" => HostValue::Rows(self.over),
            "image_width" | "keep_right" => HostValue::Columns(self.image),
            "image_height" | "keep_bottom" => HostValue::Rows(self.image),
            "channels" => self.channels,
            "stride" => self.stride,
            "leak" => HostValue::Constant(f64::from(self.leak)),
            // Input comes from a buffer, scaled already.
            _ => HostValue::Constant(0.0),
        }
    }
}
