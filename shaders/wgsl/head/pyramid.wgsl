// What heads read: what the last block makes, and a pyramid of an input at pixels between those of its
// levels.

#template
#import uniforms/net_layer

@group(0) @binding(0) var<uniform> layer: NetLayer;
// Planar, of the tile's frame on the last block's level: `layer.channels` rows of `layer.stride` columns.
@group(0) @binding(1) var<storage, read> kernels: array<f32>;
// The estimate where there is one, then level after level, planar `[CHANNELS, height, width]` of the level's
// frame.
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
    var value = vec4(0.0);
    for (var c = 0u; c < CHANNELS; c++) {
        value[c] = pyramid[level.first + (c * u32(level.size.y) + u32(inside.y)) * u32(level.size.x) + u32(inside.x)];
    }
    return value;
}

fn between(level: Level, offset: vec2<i32>) -> vec4<f32> {
    let at = level.pixel + offset;
    let upper = mix(texel(level, at), texel(level, at + vec2(1, 0)), level.share.x);
    let lower = mix(texel(level, at + vec2(0, 1)), texel(level, at + vec2(1, 1)), level.share.x);
    return mix(upper, lower, level.share.y);
}

fn offset_of(tap: u32) -> vec2<i32> {
    return vec2(i32(tap % KERNEL), i32(tap / KERNEL)) - RADIUS;
}

// A channel of what the last block makes for a pixel, of the COUNT that it makes for each of a square of
// SQUARE x SQUARE.
fn made_by_net(channel: u32, pixel: vec2<u32>) -> f32 {
    let local = pixel - vec2(layer.origin_x, layer.origin_y);
    let at = local / SQUARE;
    let within = local % SQUARE;
    let plane = (within.y * SQUARE + within.x) * COUNT + channel;
    return kernels[(plane * layer.channels + at.y) * layer.stride + at.x];
}

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = id.xy + vec2(layer.keep_left, layer.keep_top);
    if (pixel.x >= layer.keep_right || pixel.y >= layer.keep_bottom) {
        return;
    }
    store(pixel, image_at(pixel));
}
