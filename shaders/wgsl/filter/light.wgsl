// The finest level of the pyramid that a network filters: the light that it reads, continued at bottom and right by its
// last row and column up to the frame.

@group(0) @binding(0) var<uniform> layer: NetLayer;
@group(0) @binding(3) var<storage, read_write> pyramid: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= layer.width || id.y >= layer.height) {
        return;
    }
    let pixel = min(id.xy, vec2(layer.image_width, layer.image_height) - 1u);
    for (var c = 0u; c < CHANNELS; c++) {
        let channel = FIRST + c;
        let light = input_channels(channel / 4u, pixel)[channel % 4u];
        pyramid[(c * layer.height + id.y) * layer.width + id.x] = light;
    }
}
