// A coarser level of the pyramid that a head reads: the means of 2x2 pixels of the level above. The frame is
// that of the means; levels lie one after the other, planar `[CHANNELS, height, width]`,
// after ESTIMATES planes of the finest level's frame.

#template
#import uniforms/net_layer

@group(0) @binding(0) var<uniform> layer: NetLayer;
@group(0) @binding(3) var<storage, read_write> pyramid: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= layer.width || id.y >= layer.height) {
        return;
    }
    let pixels = layer.height * layer.width;
    // Every level above has four times the pixels of the one below it.
    var below = ESTIMATES * (pixels << (2u * LEVEL));
    for (var level = LEVEL; level > 0u; level--) {
        below += CHANNELS * (pixels << (2u * level));
    }
    let above = below - 4u * CHANNELS * pixels;
    let row = 2u * layer.width;
    for (var c = 0u; c < CHANNELS; c++) {
        let at = above + (2u * (c * layer.height + id.y)) * row + 2u * id.x;
        let sum = pyramid[at] + pyramid[at + 1u] + pyramid[at + row] + pyramid[at + row + 1u];
        pyramid[below + (c * layer.height + id.y) * layer.width + id.x] = 0.25 * sum;
    }
}
