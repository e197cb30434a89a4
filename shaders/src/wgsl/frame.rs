//! The passes that make a frame: vertices, g-buffer, light.

mod attributes;

pub use attributes::{ATTRIBUTES_A_PASS, attributes_source};

use super::{Shader, uniforms};

table! {
    /// Moves the vertices that are animated.
    POSE: "frame.pose", file "frame/pose", constants [], uniforms [Pose], shared [];
    /// The g-buffer's raster pass.
    SURFACE: "frame.surface", file "frame/surface", constants [], uniforms [FrameView, MaterialRecord],
        shared ["view", "packing"];
    /// A shadow map of what has no holes.
    DEPTH: "frame.depth", file "frame/depth", constants [], uniforms [FrameView], shared ["view"];
    /// A shadow map of what may have holes.
    DEPTH_MASKED: "frame.depth_masked", file "frame/depth_masked", constants [], uniforms [FrameView, MaterialRecord],
        shared ["view"];
    /// Direct light.
    LIGHT: "frame.light", file "frame/light", constants [LIGHTS = 1], uniforms [FrameView, MaterialRecord, LightRecord],
        shared ["view", "packing", "material", "seen", "lights", "shadow"];
    /// A reflective shadow map.
    REFLECTIVE: "frame.reflective", file "frame/reflective", constants [],
        uniforms [FrameView, MaterialRecord, LightRecord, Chosen],
        shared ["view", "packing", "material", "seen", "lights"];
    /// How far surfaces moved in the image since the frame before.
    SINCE: "frame.since", file "frame/since", constants [], uniforms [FrameView, MaterialRecord],
        shared ["view", "packing", "material", "seen"];
    /// Mixes a frame with the one before.
    REPROJECT: "frame.reproject", file "frame/reproject", constants [CHANNELS = 1], uniforms [Reprojection], shared [];
    /// An image of fewer pixels in full size.
    UPSAMPLE: "frame.upsample", file "frame/upsample",
        constants [CHANNELS = 1], uniforms [Upsampling], shared ["surface", "surface_valid"];
    /// Two images of one effect on the screen.
    WIPE: "frame.wipe", file "frame/wipe", constants [], uniforms [Wipe], shared [];
}
