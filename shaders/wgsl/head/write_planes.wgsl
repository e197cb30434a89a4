// Writes a pixel into a buffer, planar `[CHANNELS, image_height, image_width]`.

@group(0) @binding(3) var<storage, read_write> made: array<f32>;

fn store(pixel: vec2<u32>, value: vec4<f32>) {
    for (var c = 0u; c < CHANNELS; c++) {
        made[(c * layer.image_height + pixel.y) * layer.image_width + pixel.x] = value[c];
    }
}
