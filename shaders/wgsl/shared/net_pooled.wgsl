// Reads the layer above, which has pooled its image already.

#import shared/net_layer

@group(0) @binding(4) var pooled: texture_2d_array<f32>;

fn texel(block: u32, at: vec2<i32>) -> vec4<f32> {
    let last = vec2(i32(layer.width), i32(layer.height)) - 1;
    let value = textureLoad(pooled, clamp(at, vec2(0), last), block, 0);
    return select(vec4(0.0), value, inside(at));
}
