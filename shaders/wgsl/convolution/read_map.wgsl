// Reads a map of the same frame: what the layer above has pooled, or all of it. Rust binds `source`.

#import convolution/layer

fn texel(block: u32, at: vec2<i32>) -> vec4<f32> {
    if (!inside(at)) {
        return vec4(0.0);
    }
    return vec4<f32>(source[(block * layer.height + u32(at.y)) * layer.width + u32(at.x)]);
}
