//! The passes that make a frame: vertices, g-buffer, light.

mod attributes;

pub use attributes::{ATTRIBUTES_A_PASS, attributes_source};

use super::Shader;

shaders! {
    table FRAME;
    /// Moves the vertices that are animated.
    POSE: "frame.pose", "frame/pose";
    /// The g-buffer's raster pass.
    SURFACE: "frame.surface", "frame/surface";
    /// A shadow map of what has no holes.
    DEPTH: "frame.depth", "frame/depth";
    /// A shadow map of what may have holes.
    DEPTH_MASKED: "frame.depth_masked", "frame/depth_masked";
    /// Direct light.
    LIGHT: "frame.light", "frame/light";
    /// A reflective shadow map.
    REFLECTIVE: "frame.reflective", "frame/reflective";
    /// How far surfaces moved in the image since the frame before.
    SINCE: "frame.since", "frame/since";
    /// Mixes a frame with the one before.
    REPROJECT: "frame.reproject", "frame/reproject";
    /// An image of fewer pixels in full size.
    UPSAMPLE: "frame.upsample", "frame/upsample";
    /// Two images of one effect on the screen.
    WIPE: "frame.wipe", "frame/wipe";
}
