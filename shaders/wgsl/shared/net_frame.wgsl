// What a pass before or after a network is told of the frame.

/// What the passes before and after a network read about a frame.
struct NetFrame {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Distance in pixels, at depth 1, of two points one unit apart.
    focal_length: f32,
    /// How far the effect reaches, metres.
    radius: f32,
    /// Factor of lengths in the network's input.
    length_scale: f32,
    /// Factor of light in the network's input; its image is divided by it.
    light_scale: f32,
    /// Which colour channel a mono network's run makes.
    run: u32,
}

@group(0) @binding(0) var<uniform> frame: NetFrame;
