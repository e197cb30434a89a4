// The image of a network that predicts kernels (Bako et al. 2017, over several resolutions after Vogels et al. 2018): the
// light, weighted by the softmax of what the last convolution makes. Of what a tile keeps.

@group(0) @binding(0) var<uniform> layer: NetLayer;
// Planar `[LEVELS * KERNEL * KERNEL + BLACK, rows, columns]` of the pixels that are kept.
@group(0) @binding(1) var<storage, read> kernels: array<f32>;
// Level after level, planar `[CHANNELS, height, width]` of the level's frame.
@group(0) @binding(2) var<storage, read> pyramid: array<f32>;

const AREA = KERNEL * KERNEL;
const RADIUS = i32(KERNEL / 2u);

struct Level {
    // Where it begins.
    first: u32,
    size: vec2<i32>,
    // The pixel before the image's pixel, and the share of the next one.
    pixel: vec2<i32>,
    share: vec2<f32>,
}

fn level_at(index: u32, first: u32, pixel: vec2<u32>) -> Level {
    let position = (vec2<f32>(pixel) + 0.5) / f32(1u << index) - 0.5;
    let size = vec2<i32>(vec2(layer.width, layer.height) >> vec2(index));
    return Level(first, size, vec2<i32>(floor(position)), fract(position));
}

// A pixel of a level, beyond its edge that at the edge.
fn texel(level: Level, at: vec2<i32>) -> vec4<f32> {
    let inside = clamp(at, vec2(0), level.size - 1);
    var light = vec4(0.0);
    for (var c = 0u; c < CHANNELS; c++) {
        light[c] = pyramid[level.first + (c * u32(level.size.y) + u32(inside.y)) * u32(level.size.x) + u32(inside.x)];
    }
    return light;
}

fn between(level: Level, offset: vec2<i32>) -> vec4<f32> {
    let at = level.pixel + offset;
    let upper = mix(texel(level, at), texel(level, at + vec2(1, 0)), level.share.x);
    let lower = mix(texel(level, at + vec2(0, 1)), texel(level, at + vec2(1, 1)), level.share.x);
    return mix(upper, lower, level.share.y);
}

fn made_by_net(tap: u32, pixel: vec2<u32>) -> f32 {
    let first = vec2(layer.keep_left, layer.keep_top);
    let size = vec2(layer.keep_right, layer.keep_bottom) - first;
    let at = pixel - first;
    return kernels[(tap * size.y + at.y) * size.x + at.x];
}

// What is subtracted before powers are taken, so that none overflows.
fn largest(pixel: vec2<u32>) -> f32 {
    var most = made_by_net(0u, pixel);
    for (var tap = 1u; tap < LEVELS * AREA + BLACK; tap++) {
        most = max(most, made_by_net(tap, pixel));
    }
    return most;
}

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = id.xy + vec2(layer.keep_left, layer.keep_top);
    if (pixel.x >= layer.keep_right || pixel.y >= layer.keep_bottom) {
        return;
    }
    let most = largest(pixel);
    var light = vec4(0.0);
    var weights = 0.0;
    if (BLACK == 1u) {
        weights = exp(made_by_net(LEVELS * AREA, pixel) - most);
    }
    var first = 0u;
    for (var index = 0u; index < LEVELS; index++) {
        let level = level_at(index, first, pixel);
        for (var tap = 0u; tap < AREA; tap++) {
            let weight = exp(made_by_net(index * AREA + tap, pixel) - most);
            let offset = vec2(i32(tap % KERNEL), i32(tap / KERNEL)) - RADIUS;
            light += weight * between(level, offset);
            weights += weight;
        }
        first += CHANNELS * u32(level.size.x * level.size.y);
    }
    store(pixel, light / weights);
}
