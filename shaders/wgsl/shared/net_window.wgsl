// Where the frame of a layer on level 0 lies in the network's image. A whole image is its own frame; a tile
// of a larger one begins at an origin, and keeps what it sees enough around of.

fn image_pixel(at: vec2<i32>) -> vec2<i32> {
    return at + vec2(i32(layer.origin_x), i32(layer.origin_y));
}

fn kept(pixel: vec2<i32>) -> bool {
    let first = vec2(i32(layer.keep_left), i32(layer.keep_top));
    let end = vec2(i32(layer.keep_right), i32(layer.keep_bottom));
    return all(pixel >= first) && all(pixel < end);
}
