/// What the passes of `net` read about a part of a layer.
struct NetLayer {
    /// Columns of the layer's frame: what it makes, before the image is cropped.
    width: u32,
    /// Rows of the layer's frame.
    height: u32,
    /// Columns of the network's input and image.
    image_width: u32,
    /// Rows of the network's input and image.
    image_height: u32,
    /// Channels of the network's input; in its last layer those of its image.
    channels: u32,
    /// Index of the first group of outputs that this part makes.
    first: u32,
    /// Weights a group of outputs has, with what fills it up.
    stride: u32,
    /// Factor of negative values in the leaky ReLU.
    leak: f32,
    /// Factor of lengths in the network's input, where it is read from textures.
    length_scale: f32,
    /// Factor of light in the network's input, where it is read from textures.
    light_scale: f32,
    /// Column of the image where the layer's frame begins.
    origin_x: u32,
    /// Row of the image where the layer's frame begins.
    origin_y: u32,
    /// First column of the image that is kept.
    keep_left: u32,
    /// First row of the image that is kept.
    keep_top: u32,
    /// Column of the image after the last one that is kept.
    keep_right: u32,
    /// Row of the image after the last one that is kept.
    keep_bottom: u32,
    /// Which colour channel a mono network's run makes, where its input is read from textures.
    run: u32,
}
