// Writes the network's image into a buffer, planar `[channels, image_height, image_width]`.

#import shared/net_window

const AT_ONCE = min(OUTPUTS, 4u);

@group(0) @binding(3) var<storage, read_write> made: array<f32>;

fn activate(sums: ptr<function, Sums>) {}

fn store_vector(at: vec2<i32>, block: u32, value: vec4<f32>) {
    let pixel = image_pixel(at);
    if (!kept(pixel)) {
        return;
    }
    let first = AT_ONCE * block;
    for (var i = 0u; i < min(AT_ONCE, layer.channels - first); i++) {
        let row = (first + i) * layer.image_height + u32(pixel.y);
        made[row * layer.image_width + u32(pixel.x)] = value[i];
    }
}
